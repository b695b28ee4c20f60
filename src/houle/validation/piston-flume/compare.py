"""Waves of a piston: height, free harmonics, and what absorbing walls send back, at the end and at the piston."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.results.reflection import wave_of
from houle.validation.check import Check, Variant, report
from houle.validation.flume import piston
from houle.validation.measure import largest
from houle.validation.waves import card, second_harmonic

if TYPE_CHECKING:
    from houle.results.run import Run

HEIGHT, SPURIOUS, CELERITY = 2.0, 2.0, 0.5  # %
FREE, LEVEL = 2.0, 0.1  # % of H, mm
HELD, WALL = 4.0, 0.98  # % of the height; C_R

VARIANTS = (
    Variant(),
    *(Variant(f"T-{period:g}-s-H-10-mm", piston(period, 0.01), quick=period == 1.5) for period in (1.0, 1.5, 2.0)),
    Variant("dx-10-mm", {"domain.spacing": 0.01}, quick=False),
    Variant("wall", piston(1.5, 0.01, wall=True)),
)


def compare(run: Run) -> list[Check]:
    case, wave, found = run.case, wave_of(run.case), card(run)
    closed = not case.absorber
    stroke = run.series.paddle_position.isel(paddle=0)
    rows = [
        Check("height over the target", 100 * abs(found.height / found.target - 1), "%", HELD if closed else HEIGHT),
        Check("celerity off theory", 100 * abs(found.celerity), "%", CELERITY),
        Check("mean level, drift in the window", 1e3 * abs(found.drift), "mm", LEVEL),
        report("H over stroke", wave.height / float(stroke.max() - stroke.min())),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]
    if closed:
        return [*rows, Check("C_R of the fixed wall", found.reflection, "", WALL, "min")]
    _, free, back = 2 * second_harmonic(run, back=True)
    return [
        *rows,
        Check("reflection of the absorbing wall", 100 * found.reflection, "%", SPURIOUS),
        Check("free second harmonic sent out, of H", 100 * free / wave.height, "%", FREE),
        report("free second harmonic sent back by the wall, of H", 100 * back / wave.height, "%"),
        report("way of the absorbing wall from rest", 1e3 * _way(run), "mm"),
    ]


def _way(run: Run) -> float:
    """Furthest way [m] of the wall at the end from where it stands at rest."""
    series = run.series.isel(paddle=1)
    return float(np.abs(series.paddle_position - series.paddle_rest).max())
