"""Reflection and transmission of a vertical porous block against linear (eigenfunction) theory."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from houle.results import reflection
from houle.validation import coefficients, separation
from houle.validation.check import Check, Variant, report
from houle.validation.flume import block, linear
from houle.validation.measure import largest

if TYPE_CHECKING:
    from houle.results.run import Run

LINEAR, QUADRATIC = 0.02, 0.05  # absolute, of C_R and C_T: linear drag, Darcy-Forchheimer drag made linear
SMALL = 0.005  # m, height of the waves of the table
ROCK = {
    "porosity": 0.45,
    "grain_diameter": 0.0159,
    "resistance": {"law": "jensen-2014", "alpha": 500.0, "beta": 2.0},
    "added_mass": 0.34,
}


QUICK = (1.0, 0.5, 0.45, True)
# Coarse cells, steps as long as the surface allows, and little written: 10 to 20 s of computing for a block. Cells of
# 20 mm and half the step give the same coefficients within 0.005.
CHEAP = {"domain.spacing": 0.025, "time.courant": 1.0, "output.every": 10.0}


def one(period: float, friction: float, porosity: float, wall: bool = False) -> Variant:
    """Waves of 5 mm on a block with linear drag."""
    name = f"T-{period:g}-s-f-{friction:g}-n-{porosity:g}" + ("-wall" if wall else "")
    flume = block(period, SMALL, linear(friction, period, porosity), wall=wall, echo=porosity < 0.5)
    return Variant(name, {**flume, **CHEAP}, (period, friction, porosity, wall) == QUICK)


def rock(height: float, wall: bool) -> Variant:
    """Waves on crushed rock."""
    name = f"rock-{1e3 * height:g}-mm" + ("-wall" if wall else "")
    return Variant(name, {**block(1.5, height, ROCK, wall=wall), **CHEAP}, False)


VARIANTS = (
    Variant("", {"reflection.twin": False}),
    *(
        one(period, friction, porosity, wall)
        for porosity in (0.85, 0.45)
        for period in (1.5, 1.0, 2.0)
        for friction in (0.5, 0.25, 1.0)
        for wall in (False, True)
    ),
    *(rock(height, wall) for height in (0.02, 0.04) for wall in (False, True)),
    Variant("dx-10-mm", {"domain.spacing": 0.01, "reflection.twin": False}, quick=False),
)


def compare(run: Run) -> list[Check]:
    found = reflection.measure(run)
    known = reflection.theory(run.case, found.H_I)
    assert known is not None
    resistance = run.case.porous[0].resistance
    limit = LINEAR if resistance.b == 0.0 else QUADRATIC
    off: dict[str, Any] = {
        "C_R": (found.C_R, found.interval_R, known.C_R),
        "C_T": (found.C_T, found.interval_T, known.C_T),
    }
    checks = []
    for name, (value, (low, high), exact) in off.items():
        if math.isfinite(value):
            note = f"measured {value:.3f} ({low:.3f} to {high:.3f}), theory {exact:.3f}, f = {known.friction:.3g}"
            checks.append(Check(f"{name}, distance from theory", abs(value - exact), "", limit, note=note))
    return [
        *checks,
        report("incident height over the target", found.H_I / reflection.first_harmonic(reflection.wave_of(run.case))),
        report("unexplained by two waves", 100.0 * found.residual, "%"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]


def across(runs: Mapping[str, Run]) -> list[Check]:
    """Checks of the separation by itself, and of the blocks farthest from theory: with linear drag, of crushed rock."""
    rows = [coefficients.Row.of(name, run) for name, run in runs.items()]
    checks = separation.checks(next(iter(runs.values()))) if runs else []
    for words, quadratic, limit in (("linear drag", False, LINEAR), ("Darcy-Forchheimer drag", True, QUADRATIC)):
        for name in ("C_R", "C_T"):
            off = {row.variant: row.off[name] for row in rows if row.forchheimer == quadratic and name in row.off}
            if len(off) > 1:
                worst = max(off, key=lambda variant: off[variant])
                near = sum(distance <= limit for distance in off.values())
                note = f"{worst or 'the case as it stands'}; {near} of {len(off)} within {limit:g}"
                checks.append(Check(f"{name}, {words}, farthest from theory", off[worst], "", limit, note=note))
    return checks


def overview(runs: Mapping[str, Run], folder: Path) -> None:
    """wave-block-coefficients.csv, .md and .png: every run so far beside theory."""
    rows = [coefficients.Row.of(name, run) for name, run in runs.items()]
    coefficients.write(folder / "wave-block-coefficients", "Waves on a vertical porous block", rows)
