"""Volumes of single overtopping waves, from a record of the volume so far without noise, such as that of a run.

`overtopping_events` parts a record where it stands still. That of a run hardly does: drops fall and films run off a
crest long after a wave, so that one wave joins the next. Here waves are told by their discharge, the mean over a
quarter of a mean period. One begins where the discharge rises above that of one least volume in a period, and two
are parted where it falls to a fifth of the lower of their peaks. What drips between them belongs to the former, water
that flows back is taken off it, and so the volumes add up to all that came over, but for waves below the least volume.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError

Real = NDArray[np.float64]
OVER = 0.25  # mean periods over which the discharge is taken
PARTED = 0.2  # share of the lower of two peaks to which the discharge falls between two waves


@dataclass(frozen=True)
class Volumes:
    """`volumes` (N,) [m3/m] of the overtopping waves, each above the least; `times` (N,) [s] of their peak discharge.

    total: all that came over; duration of the record [s].
    """

    volumes: Real
    times: Real
    total: float
    duration: float

    @property
    def q(self) -> float:
        """Mean discharge [m3/s/m]."""
        return self.total / self.duration


def wave_volumes(time: ArrayLike, volume: ArrayLike, *, period: float, least: float) -> Volumes:
    """Volumes of the waves in a cumulative record (T,) [m3/m] at rising times [s].

    period: mean period of the waves [s]; least: volume of the smallest wave that counts [m3/m]. Raises AnalysisError.
    """
    t, v = np.asarray(time, dtype=float), np.asarray(volume, dtype=float)
    if t.shape != v.shape or t.ndim != 1 or len(t) < 2 or not (np.isfinite(v).all() and (np.diff(t) > 0).all()):
        raise AnalysisError("overtopping: needs two rows of numbers of one length, without gaps, times rising")
    if not (period > 0.0 and least > 0.0):
        raise AnalysisError(f"overtopping: period = {period:g} s and least = {least:g} m3/m must be above 0")
    half = 0.5 * OVER * period
    rate = (np.interp(t + half, t, v) - np.interp(t - half, t, v)) / (2 * half)
    peaks, starts = _waves(rate, least / period)
    begin = np.interp(t[starts] - half, t, v)  # the water that the mean already sees has not come yet
    sizes = np.diff(np.append(begin, v[-1]))
    kept = sizes >= least
    return Volumes(sizes[kept], t[peaks][kept], float(v[-1] - v[0]), float(np.ptp(t)))


def _waves(rate: Real, least: float) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Sample of the peak discharge (N,) of each wave, and of its start: where it rises, or is least before it."""
    peaks: list[int] = []
    starts: list[int] = []
    top, start, low, quiet = -1, 0, 0, 0  # peak and start of the present wave; since then least and last quiet sample
    for i, value in enumerate(rate.tolist()):
        if top < 0:
            if value > least:
                top, start, low, quiet = i, i, i, i
            continue
        if value <= max(least, rate[low]):
            low, quiet = (i if value < rate[low] else low), i
        elif rate[low] <= PARTED * min(value, rate[top]):
            peaks, starts = [*peaks, top], [*starts, start]
            top, start, low, quiet = i, quiet, i, i
        elif value > rate[top]:
            top, low, quiet = i, i, i
    if top >= 0:
        peaks, starts = [*peaks, top], [*starts, start]
    return np.array(peaks, dtype=np.intp), np.array(starts, dtype=np.intp)
