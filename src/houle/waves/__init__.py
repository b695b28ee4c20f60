"""Wave theories behind one interface: elevation, velocity, components, limits. docs/waves.md has the equations.

`theories.regular` and its neighbours make a `wave.Wave` from numbers, `houle.case.wave.make` from the table [waves] of
a case file. `houle.check.wave_theory` says whether theory and grid can carry it.
"""
