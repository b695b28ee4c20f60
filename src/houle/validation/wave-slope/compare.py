"""Reflection of a porous block with a sloping front, and by how much it is lower than that of an upright one."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot
from typing import TYPE_CHECKING

from houle.case.model import load
from houle.results import reflection
from houle.validation.check import Check, Variant, report
from houle.validation.flume import block
from houle.validation.measure import largest

if TYPE_CHECKING:
    from houle.results.run import Run

UPRIGHT, STEEP = "upright", "80-mm"
BODY = load("wave-slope").porous[0].model_dump(include={"porosity", "grain_diameter", "added_mass", "resistance"})
BODY["resistance"] = {key: value for key, value in BODY["resistance"].items() if value is not None}

LONG = block(1.2, 0.04, BODY, slope=1.0, echo=True)["time.end"]  # s
CHEAP = {"time.courant": 1.0, "output.every": 10.0}  # steps as long as the surface allows, little written

VARIANTS = (
    Variant("", {"reflection.twin": False, "time.end": LONG, **CHEAP}),
    Variant(UPRIGHT, {**block(1.2, 0.04, BODY, echo=True), **CHEAP}),
    Variant(STEEP, {**block(1.2, 0.08, BODY, slope=1.0, echo=True), **CHEAP}, quick=False),
    Variant(f"{UPRIGHT}-{STEEP}", {**block(1.2, 0.08, BODY, echo=True), **CHEAP}, quick=False),
)


def compare(run: Run) -> list[Check]:
    found = reflection.measure(run)
    sides = {
        "C_R": (found.C_R, found.interval_R),
        "C_T": (found.C_T, found.interval_T),
        "C_D": (found.C_D, found.interval_D),
    }
    known = reflection.beside(run.case, found.H_I)["theory"]
    return [
        *(report(name, value, note=f"{low:.3f} to {high:.3f}") for name, (value, (low, high)) in sides.items()),
        report("C_R by linear theory", known["C_R"]),
        report("incident height", 1e3 * found.H_I, "mm"),
        report("unexplained by two waves", 100.0 * found.residual, "%"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]


def across(runs: Mapping[str, Run]) -> list[Check]:
    """The slope reflects less; the difference must be larger than its uncertainty."""
    checks = []
    for slope, upright in (("", UPRIGHT), (STEEP, f"{UPRIGHT}-{STEEP}")):
        if slope in runs and upright in runs:
            one, other = reflection.measure(runs[upright]), reflection.measure(runs[slope])
            sure = hypot(one.interval_R[1] - one.C_R, other.interval_R[1] - other.C_R)
            note = f"upright {one.C_R:.3f}, 45 degrees {other.C_R:.3f}, difference +- {sure:.3f}"
            name = f"C_R upright less C_R at 45 degrees, H = {1e3 * other.H_I:.0f} mm"
            checks.append(Check(name, one.C_R - other.C_R, "", sure, "min", note=note))
    return checks
