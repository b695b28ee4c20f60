"""Reflection, transmission and phreatic line of a rubble-mound breakwater, beside a design formula."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from houle import analysis
from houle.results import reflection
from houle.validation.check import Check, report
from houle.validation.measure import largest

if TYPE_CHECKING:
    from houle.results.run import Run

HEIGHT = 10.0  # %: of some 50 waves; 8 seeds at the gauges scatter by 3 % (of 22 waves: by 8 %)
MADE = 5.0  # %, off the same sea by theory in the same window
SLOPE = 0.5  # tangent
CORE, FULL = 0.42, 1e-3  # m, top of the core; what lies this near to it is at it


def compare(run: Run) -> list[Check]:
    waves = run.case.waves
    assert waves is not None and waves.height is not None and waves.period is not None
    found, time = reflection.measure(run), run.series.time.values
    low, high = found.interval_R
    late, made = time > found.window.start, reflection.as_made(run.case, found)
    inside = run.series.eta.sel(gauge="I2").values[late]
    core = run.series.phreatic_level.transpose("time", ...).values[late, 1]  # never above the core
    climbed = analysis.run_up(time[late], run.series.runup_level.transpose("time", ...).values[late, 0] - waves.depth)
    over = run.series.overtopping_volume.transpose("time", ...).values[late, 0]
    head = {name: run.series.pressure.sel(sensor=name).values[late] for name in ("P1", "P2")}
    weight = run.case.fluid.density * run.case.fluid.gravity
    formula = permeable_rock(found.H_I, waves.period, SLOPE, run.case.fluid.gravity)
    return [
        Check("incident H_m0 off the target", 100 * abs(found.H_I / waves.height - 1), "%", HEIGHT),
        Check("incident H_m0 off that of the same sea by theory", 100 * abs(found.H_I / made - 1), "%", MADE,
              note=f"{1e3 * found.H_I:.1f} mm, by theory {1e3 * made:.1f} mm in this window and band"),
        report("C_R", found.C_R, note=f"{low:.3f} to {high:.3f}; {found.window.periods} peak periods",
               peers={"Zanuttigh & van der Meer 2008": f"{formula:.2f}"}),
        report("C_T", found.C_T, note="through and over, one gauge"),
        report("highest run-up on the front", 1e3 * climbed.R_max, "mm", note=f"{len(climbed.peaks)} run-ups"),
        report("overtopping", 1e6 * float(over[-1] - over[0]) / float(time[late][-1] - time[late][0]), "ml/s per m"),
        report("set-up of the level under the crest", 1e3 * float(np.nanmean(inside) - waves.depth), "mm"),
        report("level under the crest, standard deviation", 1e3 * float(np.nanstd(inside)), "mm"),
        report("core full to its top, part of the time", 100 * float(np.mean(core > CORE - FULL)), "%"),
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
