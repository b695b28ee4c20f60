"""Waves of a piston: height, free harmonics, and what absorbing walls send back, at the end and at the piston."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle import analysis
from houle.reflection import first_harmonic, wave_of
from houle.validation.check import Check, Variant, report
from houle.validation.flume import PERIODS, piston
from houle.validation.measure import largest

if TYPE_CHECKING:
    from houle.runner import Run
    from houle.waves.wave import Wave

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
    case, wave = run.case, wave_of(run.case)
    assert case.waves is not None
    card = analysis.quality_card(
        run,
        depth=case.waves.depth,
        period=wave.period,
        height=first_harmonic(wave),
        window=_window(run, wave),
        still_water=case.waves.depth,
        reference=wave.k,
    )
    closed = not case.absorber
    stroke = run.series.paddle_position.isel(paddle=0)
    rows = [
        Check("height over the target", 100 * abs(card.height / card.target - 1), "%", HELD if closed else HEIGHT),
        Check("celerity off theory", 100 * abs(card.celerity), "%", CELERITY),
        Check("mean level, drift in the window", 1e3 * abs(card.drift), "mm", LEVEL),
        report("H over stroke", wave.height / float(stroke.max() - stroke.min())),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]
    if closed:
        return [*rows, Check("C_R of the fixed wall", card.reflection, "", WALL, "min")]
    free, back = _free(run, wave)
    return [
        *rows,
        Check("reflection of the absorbing wall", 100 * card.reflection, "%", SPURIOUS),
        Check("free second harmonic sent out, of H", 100 * free / wave.height, "%", FREE),
        report("free second harmonic sent back by the wall, of H", 100 * back / wave.height, "%"),
        report("way of the absorbing wall from rest", 1e3 * _way(run), "mm"),
    ]


def _window(run: Run, wave: Wave) -> tuple[float, float]:
    """The last periods [s]."""
    end = float(run.series.time[-1])
    return end - PERIODS * wave.period - 0.01 * wave.period, end


def _free(run: Run, wave: Wave) -> tuple[float, float]:
    """Heights [m] of the free waves at twice the frequency, to the right and to the left, beside the bound one."""
    late = run.series.sel(time=slice(*_window(run, wave)))
    eta, time, x = late.eta.transpose("time", "gauge").values, late.time.values[:, None], late.gauge_x.values
    waves = [f(n * wave.omega * time) for n in (1, 2, 3) for f in (np.cos, np.sin)]
    found = np.linalg.lstsq(np.concatenate([np.ones_like(time), *waves], axis=1), eta, rcond=None)[0]
    k = float(analysis.wave_number(2 * wave.omega, wave.depth))
    modes = np.stack([np.exp(-1j * q * x) for q in (2 * wave.k, k, -k)], axis=1)
    heights = 2 * np.abs(np.linalg.lstsq(modes, found[3] - 1j * found[4], rcond=None)[0])
    return float(heights[1]), float(heights[2])


def _way(run: Run) -> float:
    """Furthest way [m] of the wall at the end from where it stands at rest."""
    series = run.series.isel(paddle=1)
    return float(np.abs(series.paddle_position - series.paddle_rest).max())
