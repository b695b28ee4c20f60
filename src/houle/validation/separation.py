"""Test of the separation on signals with known waves at the gauges of a run: exact ones, and with noise."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle import analysis
from houle.results import reflection
from houle.validation.check import Check, report

if TYPE_CHECKING:
    from houle.grid import FloatArray
    from houle.results.run import Run

C_R, PHASE = 0.25, 0.7  # ratio and phase of the reflected wave
EXACT = 1e-8
NOISE, RECORDS, PERIODS, STEP = 0.05, 40, 5, 0.02  # standard deviation over H; records; periods of each; sampling [s]
BIAS = 2.5  # standard errors of the mean of the records: larger by chance once in 80


def checks(run: Run, seed: int = 1) -> list[Check]:
    """Checks of C_R: error without noise; with noise mean error, scatter, and share of 95 % intervals that hold it."""
    case, wave = run.case, reflection.wave_of(run.case)
    assert case.reflection is not None
    asked = set(case.reflection.gauges)
    x: FloatArray = np.array([gauge.x for gauge in case.gauge if gauge.name in asked])
    time = np.arange(0.0, (PERIODS + 0.1) * wave.period, STEP)
    phase, way = wave.omega * time, wave.k * (x[:, None] - x.mean())
    eta = 0.5 * wave.height * (np.cos(way - phase) + C_R * np.cos(way + phase + PHASE))

    def separated(levels: FloatArray) -> analysis.Reflection:
        window = (0.0, PERIODS * wave.period)
        return analysis.reflection(
            (time, x, levels), depth=wave.depth, period=wave.period, wave_number=wave.k, window=window, towards=1.0
        )

    random = np.random.default_rng(seed)
    found = [separated(eta + NOISE * wave.height * random.standard_normal(eta.shape)) for _ in range(RECORDS)]
    off = np.array([f.C_R for f in found]) - C_R
    sure = BIAS * float(off.std(ddof=1)) / RECORDS**0.5
    held = sum(f.interval_R[0] <= C_R <= f.interval_R[1] for f in found) / RECORDS
    words = f"{RECORDS} records of {PERIODS} periods at {len(x)} gauges, C_R = {C_R:g}"
    percent = f"{100 * NOISE:g} % noise"
    note = f"{words}; limit: {BIAS:g} standard errors of their mean"
    return [
        Check("separation of a synthetic signal, error of C_R", abs(separated(eta).C_R - C_R), "", EXACT),
        Check(f"separation, {percent}, mean error of C_R", abs(float(off.mean())), "", sure, note=note),
        report(f"separation, {percent}, scatter of C_R", float(off.std(ddof=1))),
        report(f"separation, {percent}, 95 % intervals that hold", 100 * held, "%"),
    ]
