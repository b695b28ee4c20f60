"""Overtopping: mean discharge, and the volume of each wave that comes over, from the volume so far."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError
from houle.analysis.staircase import SURE, Fall, Floats, Stairs, emptyings, steps_of

NAMED = 5  # instants that a note or a message lists


@dataclass(frozen=True)
class Overtopping:
    """Overtopping events: `volumes` (N,) [m3/m], in 3D [m3], that came over in `times` (N, 2), start and end [s].

    `duration` of the record [s]; `total` volume; q: mean discharge [m3/s/m]. `waves`: number of incident waves, None if
    not given. `ignored`: volume of the events below the threshold.
    `errors` (N,) and `q_error` are standard errors, from the `noise` of the record itself, its standard deviation
    between the events [m3/m]; 0 without noise. `notes`: what was done to the record, a sentence each.
    """

    volumes: NDArray[np.float64]
    times: NDArray[np.float64]
    duration: float
    waves: int | None
    total: float
    errors: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    q_error: float = 0.0
    noise: float = 0.0
    notes: tuple[str, ...] = ()

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
        sure = f" +- {SURE * self.q_error:.2g}" if self.q_error else ""
        line = (
            f"overtopping: q {self.q:.4g}{sure} m3/s/m, {len(self.volumes)} events{part}, V_max {self.V_max:.4g} m3/m"
        )
        return "\n".join([line, *self.notes])


def overtopping_events(
    time: ArrayLike,
    volume: ArrayLike,
    *,
    waves: int | None = None,
    threshold: float = 0.0,
    pause: float = 0.0,
    emptied: Literal["bridge", "refuse", "ignore"] = "bridge",
) -> Overtopping:
    """Overtopping events of a cumulative volume (T,) [m3/m], from houle or a tank gauge: stretches of lasting rise.

    They are joined across pauses up to `pause` [s]. Events of no more than `threshold` [m3/m], or of less than three
    of their standard errors, are noise. Water that flows back counts against the event it follows.

    The noise of a gauge is told from the record itself: it stands still where it does not rise for good, however its
    gauge trembles, swings or counts in steps; a drift between the events is taken off. Where the tank was emptied the
    record is bridged, the time taken off `duration`, or, with "refuse", the instants are named in an AnalysisError;
    with "ignore" the fall counts as water that flows back. Raises AnalysisError.
    """
    t, v = np.asarray(time, dtype=float), np.asarray(volume, dtype=float)
    if t.shape != v.shape or t.ndim != 1 or len(t) < 2 or not np.all(np.diff(t) > 0):
        raise AnalysisError("overtopping: time must rise, volume must be as long as time and without gaps")
    if not np.all(np.isfinite(v)):
        raise AnalysisError(f"overtopping: no volume at {_instants(t[~np.isfinite(v)])}: cut there, or fill the gap")
    if emptied not in ("bridge", "refuse", "ignore"):
        raise AnalysisError(f'overtopping: emptied = {emptied!r} is none of "bridge", "refuse", "ignore"')
    falls = [] if emptied == "ignore" else emptyings(t, v, pause)
    if falls and emptied == "refuse":
        at = _instants([t[f.start] for f in falls])
        raise AnalysisError(f"overtopping: the tank was emptied at {at}: give the parts one by one, or bridge them")
    v, out = _bridged(t, v, falls)
    found, slope, slope_error = steps_of(t, v, pause)
    errors, whole_error = _with_falls(found, falls)
    keep = found.heights > threshold
    if waves is not None and keep.sum() > waves:
        raise AnalysisError(f"{keep.sum()} events from {waves} waves: raise threshold or pause, or correct waves")
    times, duration = np.column_stack([t[found.first], t[found.last]])[keep], float(np.ptp(t)) - out
    return Overtopping(
        found.heights[keep],
        times,
        duration,
        waves,
        found.whole,
        errors[keep],
        float(np.hypot(whole_error / duration, slope_error)),
        found.noise,
        tuple(_notes(t, falls, found, slope)),
    )


def _bridged(t: Floats, v: Floats, falls: list[Fall]) -> tuple[Floats, float]:
    """The record with the emptied volume put back, and the duration of the emptying [s], in which it stands still."""
    v, back = v.copy(), 0.0
    for fall in falls:
        v[fall.start + 1 : fall.end] = fall.level + back
        v[fall.end :] += fall.height
        back += fall.height
    return v, sum(float(t[fall.end] - t[fall.start]) for fall in falls)


def _with_falls(found: Stairs, falls: list[Fall]) -> tuple[Floats, float]:
    """Standard errors of each step and of the whole, with those of the falls in the pauses beside them."""
    variance = np.zeros(len(found.first) + 1)  # variance of the record in each pause
    for fall in falls:
        variance[np.searchsorted(found.first, fall.start)] += fall.error**2
    errors = np.sqrt(found.errors**2 + variance[1:] + variance[:-1])
    return errors, float(np.sqrt(found.whole_error**2 + variance.sum()))


def _notes(t: Floats, falls: list[Fall], found: Stairs, slope: float) -> list[str]:
    notes = []
    if falls:
        at, height = _instants([t[f.start] for f in falls]), sum(f.height for f in falls)
        notes.append(
            f"the tank was emptied at {at} of {height:.4g} m3/m in all: bridged, what came over meanwhile is not in"
        )
    if slope:
        notes.append(f"between the events the record drifts by {slope:.2g} m3/s/m: taken off")
    if found.noise > 0.0:
        notes.append(f"the record trembles by {found.noise:.2g} m3/m (standard deviation)")
    return notes


def _instants(times: ArrayLike) -> str:
    t = np.asarray(times, dtype=float)
    return ", ".join(f"{s:.6g}" for s in t[:NAMED]) + (", ..." if len(t) > NAMED else "") + " s"
