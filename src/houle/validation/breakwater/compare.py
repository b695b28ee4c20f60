"""Reflection, transmission and phreatic line of a rubble-mound breakwater, beside a design formula."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from houle import reflection
from houle.validation.check import Check, report
from houle.validation.measure import largest

if TYPE_CHECKING:
    from houle.runner import Run

HEIGHT = 10.0  # %: of some 22 waves; the scatter of so few is about as large
SLOPE = 0.5  # tangent


def compare(run: Run) -> list[Check]:
    waves = run.case.waves
    assert waves is not None and waves.height is not None and waves.period is not None
    found, time = reflection.measure(run), run.series.time.values
    low, high = found.interval_R
    late = time > found.window.start
    inside = {name: run.series.eta.sel(gauge=name).values[late] for name in ("I1", "I2", "I3")}
    head = {name: run.series.pressure.sel(sensor=name).values[late] for name in ("P1", "P2")}
    weight = run.case.fluid.density * run.case.fluid.gravity
    formula = permeable_rock(found.H_I, waves.period, SLOPE, run.case.fluid.gravity)
    return [
        Check("incident H_m0 off the target", 100 * abs(found.H_I / waves.height - 1), "%", HEIGHT),
        report("C_R", found.C_R, note=f"{low:.3f} to {high:.3f}; {found.window.periods} peak periods",
               peers={"Zanuttigh & van der Meer 2008": f"{formula:.2f}"}),
        report("C_T", found.C_T, note="through and over, one gauge"),
        report("set-up of the level in the core", 1e3 * float(np.nanmean(inside["I2"]) - waves.depth), "mm"),
        report("level in the core, standard deviation", 1e3 * float(np.nanstd(inside["I2"])), "mm"),
        report("head in the core below the front, standard deviation", 1e3 * float(head["P1"].std()) / weight, "mm"),
        report("the same below the middle", 1e3 * float(head["P2"].std()) / weight, "mm"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]  # fmt: skip


def permeable_rock(height: float, peak_period: float, slope: float, gravity: float) -> float:
    """K_r = tanh(a xi^b), a = 0.12, b = 0.87 for permeable rock, xi with T_m-1,0 = T_p / 1.1.

    Zanuttigh & van der Meer (2008), Coastal Engineering 55, 771-779; the coefficients as we remember them.
    """
    steepness = 2 * math.pi * height / (gravity * (peak_period / 1.1) ** 2)
    return math.tanh(0.12 * (slope / math.sqrt(steepness)) ** 0.87)
