"""Overtopping: mean discharge, and the volume of each wave that comes over, from the volume so far."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError


@dataclass(frozen=True)
class Overtopping:
    """`volumes` (N,) [m3/m], in 3D [m3], that came over in `times` (N, 2), start and end [s]; `duration` [s] in all.

    q: mean discharge [m3/s/m]. `waves`: incident waves, None if not given. `ignored`: in pieces below the threshold.
    """

    volumes: NDArray[np.float64]
    times: NDArray[np.float64]
    duration: float
    waves: int | None
    total: float

    @property
    def q(self) -> float:
        return self.total / self.duration

    @property
    def V_max(self) -> float:
        return float(self.volumes.max(initial=0.0))

    @property
    def ignored(self) -> float:
        return self.total - float(self.volumes.sum())

    @property
    def probability(self) -> float:
        """Part of the incident waves that came over; NaN if their number was not given."""
        return len(self.volumes) / self.waves if self.waves else float("nan")

    def __str__(self) -> str:
        part = f", {100 * self.probability:.1f} % of the waves" if self.waves else ""
        return f"overtopping: q {self.q:.4g} m3/s/m, {len(self.volumes)} events{part}, V_max {self.V_max:.4g} m3/m"


def overtopping_events(
    time: ArrayLike, volume: ArrayLike, *, waves: int | None = None, threshold: float = 0.0, pause: float = 0.0
) -> Overtopping:
    """Events of a cumulative volume (T,): stretches in which it rises, joined across pauses up to `pause` [s].

    Events of no more than `threshold` [m3/m] are noise. Water that flows back counts against the event it follows.
    Raises AnalysisError.
    """
    t, v = np.asarray(time, dtype=float), np.asarray(volume, dtype=float)
    if t.shape != v.shape or t.ndim != 1 or len(t) < 2 or not (np.all(np.isfinite(v)) and np.all(np.diff(t) > 0)):
        raise AnalysisError("overtopping: time must rise, volume must be as long as time and without gaps")
    rising = np.flatnonzero(np.diff(v) > 0)
    if len(rising) == 0:
        return Overtopping(np.empty(0), np.empty((0, 2)), float(np.ptp(t)), waves, float(v[-1] - v[0]))
    apart = np.flatnonzero(t[rising[1:]] - t[rising[:-1] + 1] > pause + 1e-12 * np.ptp(t))
    first, last = rising[np.append(0, apart + 1)], rising[np.append(apart, len(rising) - 1)] + 1
    until = np.append(first[1:], len(v) - 1)  # what flows back before the next one
    volumes = v[until] - v[first]
    keep = volumes > threshold
    if waves is not None and keep.sum() > waves:
        raise AnalysisError(f"{keep.sum()} events from {waves} waves: raise threshold or pause, or correct waves")
    times = np.column_stack([t[first], t[last]])
    return Overtopping(volumes[keep], times[keep], float(np.ptp(t)), waves, float(v[-1] - v[0]))
