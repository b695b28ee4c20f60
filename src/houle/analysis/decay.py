"""Decay of the wave pressure in a porous structure along its inside, from sensors at one level.

The pressure falls as p = p_0 exp(-rate x), x the way from the seaward face (Oumeraci & Partenscky 1990, Proc. 22nd
ICCE; Burcharth, Liu & Troch 1999). Its size at a sensor is the root mean square about the level at rest, which goes
with the amplitude and needs no waves to be told apart; the line through its logarithms gives rate and p_0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from houle.analysis.errors import AnalysisError
from houle.analysis.events import Real, interval, rest_level

FEWEST = 3  # waves


@dataclass(frozen=True)
class Decay:
    """Decay of the wave pressure along a way.

    rate    [1/m], with its interval of 90 %, low to high, by the stationary block bootstrap of the waves
    p_0     root mean square of the pressure at the beginning of the way [Pa]
    rms     (N,) of the pressure at the sensors [Pa]
    misfit  largest distance of a sensor from the line, as a share of its pressure; 0 of two sensors
    """

    rate: float
    low: float
    high: float
    p_0: float
    rms: Real
    misfit: float


def pressure_decay(time: ArrayLike, pressure: ArrayLike, x: ArrayLike, *, waves: int, window: float) -> Decay:
    """Decay of the pressures (N, T) [Pa] of sensors at ways x (N,) [m] inside, at rising times (T,) [s].

    waves: number in the record; window: of the level at rest [s], ten waves say. Raises AnalysisError for fewer than
    two places, three waves, or a sensor at which the pressure stands still.
    """
    t, p, way = (np.asarray(values, dtype=float) for values in (time, pressure, x))
    if p.shape != (len(way), len(t)) or len(np.unique(way)) < 2 or waves < FEWEST or len(t) < waves:
        raise AnalysisError(
            f"pressure decay: {p.shape} pressures at {len(np.unique(way))} places, {waves} waves: needs (sensors, "
            f"times), 2 places and {FEWEST} waves at least"
        )
    moving = np.stack([record - rest_level(t, record, window) for record in p])
    square = np.stack([part.mean(axis=1) for part in np.array_split(moving**2, waves, axis=1)])  # (waves, N)
    if not (square.mean(axis=0) > 0.0).all():
        raise AnalysisError("pressure decay: the pressure stands still at a sensor")
    weight = (way - way.mean()) / np.sum((way - way.mean()) ** 2)

    def rate(chosen: Real) -> Real:
        """Rates (R,) of chosen waves (R, W), by their numbers."""
        with np.errstate(divide="ignore"):
            return np.asarray(-0.5 * np.log(square[chosen.astype(np.intp)].mean(axis=1)) @ weight)

    rms = np.sqrt(square.mean(axis=0))
    found = float(rate(np.arange(waves, dtype=float)[None])[0])
    start = float(np.exp(np.mean(np.log(rms) + found * way)))
    low, high = interval(np.arange(waves, dtype=float), rate)
    misfit = float(np.max(np.abs(start * np.exp(-found * way) / rms - 1.0)))
    return Decay(found, low, high, start, rms, misfit)
