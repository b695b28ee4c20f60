"""Discharge through the dyke against Dupuit's; levels; water that came in, went out and is there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from houle.validation.check import Check, Variant, report
from houle.validation.measure import largest

if TYPE_CHECKING:
    from houle.results.run import Run

LATE = 4.0  # time at the end over which means are taken [s]
DISCHARGE, LEVEL = 2.0, 1.0  # %, mm

VARIANTS = (
    Variant("dx-20-mm", {"domain.spacing": 0.02}),
    Variant("", quick=False),
)


def compare(run: Run) -> list[Check]:
    body, (left, right) = run.case.porous[0], run.case.open
    assert body.box is not None and body.resistance.a is not None and left.level and right.level
    exact = run.case.fluid.gravity / body.resistance.a * (left.level**2 - right.level**2)
    exact /= 2 * (body.box[1][0] - body.box[0][0])
    late = run.series.sel(time=slice(float(run.series.time[-1]) - LATE, None))
    duration = float(late.time[-1] - late.time[0])
    came, went = (float(v[-1] - v[0]) / duration for v in (late.inflow, late.outflow))
    inside = float(late.discharge.sel(flux="dyke").mean())
    levels = {str(g): float(late.eta.sel(gauge=g).mean()) for g in late.gauge.values}
    exit_level = float(late.phreatic_level[-1].mean())
    return [
        Check("discharge into the tank off Dupuit's", 100 * abs(came / exact - 1), "%", DISCHARGE),
        Check("discharge out of the tank off Dupuit's", 100 * abs(went / exact - 1), "%", DISCHARGE),
        Check("discharge in the middle of the dyke off Dupuit's", 100 * abs(inside / exact - 1), "%", DISCHARGE),
        Check("level on the left off its own", 1e3 * abs(levels["left"] - left.level), "mm", LEVEL),
        Check("level on the right off its own", 1e3 * abs(levels["right"] - right.level), "mm", LEVEL),
        report("surface 20 mm before the exit, above the level", 1e3 * (exit_level - right.level), "mm"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]
