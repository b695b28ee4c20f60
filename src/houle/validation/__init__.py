"""Validation: the shipped cases, each with its source, data and comparison, and the engine of `houle validate`.

A case is a folder with case.toml, README.md, data/*.csv and compare.py. compare.py has

    compare(run) -> list[Check]      comparison of one run with its targets; it reads the case from the run, and so
                                     serves a run with other values as well
    VARIANTS: tuple[Variant, ...]    optional: the runs of `houle validate`; left out, the case as it stands
    across(runs) -> list[Check]      optional: comparison of all variants, name -> run (order of convergence)

To add a case, copy the nearest folder. Targets are the project's, stated before the numbers were measured, and are not
moved.
"""

from houle.validation.check import Check, Variant
from houle.validation.engine import cases, comparison, validate

__all__ = ["Check", "Variant", "cases", "comparison", "validate"]
