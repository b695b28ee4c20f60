"""Wave theories behind one interface: elevation, velocity, components, limits. docs/waves.md has the equations.

`table.make` turns the table [waves] of a case file into a `wave.Wave`; `theories.regular` and its neighbours make one
from numbers; `check.assess` says whether theory and grid can carry it.
"""
