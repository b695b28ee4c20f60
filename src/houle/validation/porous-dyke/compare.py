"""Discharge through the dyke, phreatic line and exit point against the exact ones; levels; the balance of the water."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle import design
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
    (face, back), cell = (corner[0] for corner in body.box), 1e3 * run.case.domain.grid.spacing[-1]
    seepage = design.seepage_dam(
        upstream=left.level, downstream=right.level, length=back - face,
        conductivity=run.case.fluid.gravity / body.resistance.a,
    )  # fmt: skip
    exact = seepage.discharge
    late = run.series.sel(time=slice(float(run.series.time[-1]) - LATE, None))
    duration = float(late.time[-1] - late.time[0])
    came, went = (float(v[-1] - v[0]) / duration for v in (late.inflow, late.outflow))
    inside = float(late.discharge.sel(flux="dyke").mean())
    levels = {str(g): float(late.eta.sel(gauge=g).mean()) for g in late.gauge.values}
    line = late.phreatic_level.mean("time").values
    off = 1e3 * (line - np.interp(late.phreatic_x.values - face, *seepage.line))
    return [
        Check("discharge into the tank off Dupuit's", 100 * abs(came / exact - 1), "%", DISCHARGE),
        Check("discharge out of the tank off Dupuit's", 100 * abs(went / exact - 1), "%", DISCHARGE),
        Check("discharge in the middle of the dyke off Dupuit's", 100 * abs(inside / exact - 1), "%", DISCHARGE),
        Check("level on the left off its own", 1e3 * abs(levels["left"] - left.level), "mm", LEVEL),
        Check("level on the right off its own", 1e3 * abs(levels["right"] - right.level), "mm", LEVEL),
        Check("phreatic line off the exact one, at most", float(np.abs(off).max()), "mm", cell),
        Check("level before the exit off the exact exit point", 1e3 * abs(float(line[-1]) - seepage.exit), "mm", cell),
        report("phreatic line off the exact one, root of the mean square", float(np.sqrt(np.mean(off**2))), "mm"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]
