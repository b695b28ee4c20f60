"""Impacts: largest pressure of a record, its duration and its impulse.

Water that closes a void, or meets a wall, stops. Where neither air nor water yields it stops in one step of the
computation: the impulse is the momentum that was stopped, the pressure is that impulse over the step. A largest value
of one sample depends on the length of the step; a structure feels the impulse, and the pressure that lasts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from houle.analysis.errors import AnalysisError
from houle.grid import FloatArray


@dataclass(frozen=True)
class Impact:
    """The `largest` value of a pressure record [Pa], at `time` [s].

    duration: time [s] around the largest value in which the pressure stays above half of it. impulse: integral of the
    pressure [Pa s] over that time and, on both sides, on to where it stops falling. lasting: largest mean of the
    pressure [Pa] over a time of `window` [s].
    """

    largest: float
    time: float
    duration: float
    impulse: float
    lasting: float
    window: float

    def __str__(self) -> str:
        return (
            f"{self.largest:.4g} Pa at {self.time:.4g} s, for {1e3 * self.duration:.3g} ms: impulse "
            f"{self.impulse:.3g} Pa s; over {1e3 * self.window:.3g} ms at most {self.lasting:.4g} Pa"
        )


def largest_pressure(time: ArrayLike, pressure: ArrayLike, *, window: float | None = None) -> Impact:
    """Largest value of a record, its duration and impulse, and the largest mean over a window.

    time, pressure (T,) [s, Pa]: rising times, straight lines between them. `window` [s] of the lasting pressure: five
    samples, where they are widest, if None; a longer one depends on the structure. Raises AnalysisError.
    """
    t, p = np.asarray(time, dtype=float), np.asarray(pressure, dtype=float)
    if t.shape != p.shape or t.ndim != 1 or len(t) < 2 or not (np.isfinite(p).all() and (np.diff(t) > 0).all()):
        raise AnalysisError("largest pressure: needs two rows of numbers of one length, without gaps, times rising")
    window = 5.0 * float(np.diff(t).max()) if window is None else float(window)
    if not window > 0.0:
        raise AnalysisError(f"largest pressure: window = {window:g} s must be above 0")
    window = min(window, float(t[-1] - t[0]))
    top = int(np.argmax(p))
    (begin, foot), (end, tail) = (_sides(t, p, top, way) for way in (-1, 1))
    total = _Integral(t, p)
    starts = np.concatenate([t[t <= t[-1] - window], t[t >= t[0] + window] - window])  # a window ends on a sample
    means = total(np.append(starts, t[0]) + window) - total(np.append(starts, t[0]))
    return Impact(
        largest=float(p[top]), time=float(t[top]), duration=end - begin,
        impulse=float(total(tail) - total(foot)), lasting=float(means.max()) / window, window=window,
    )  # fmt: skip


def _sides(t: FloatArray, p: FloatArray, top: int, way: int) -> tuple[float, float]:
    """Times [s] on one side of the largest value: where the record is at half of it, and where it stops falling."""
    half, i = p[top] / 2, top
    if half <= 0.0:  # dry
        return float(t[top]), float(t[top])
    while 0 <= i + way < len(p) and p[i + way] > half:
        i += way
    if not 0 <= i + way < len(p):
        return float(t[i]), float(t[i])
    crossing = float(t[i] + (t[i + way] - t[i]) * (p[i] - half) / (p[i] - p[i + way]))
    while 0 <= i + way < len(p) and p[i + way] < p[i]:
        i += way
    return crossing, float(t[i])


class _Integral:
    """Integral of a record, by straight lines between its samples, from the first one on."""

    def __init__(self, t: FloatArray, p: FloatArray) -> None:
        self.t, self.p, self.slope = t, p, np.diff(p) / np.diff(t)
        self.total = np.concatenate([[0.0], np.cumsum(np.diff(t) * (p[1:] + p[:-1]) / 2)])

    def __call__(self, at: FloatArray | float) -> FloatArray:
        i = np.clip(np.searchsorted(self.t, at, side="right") - 1, 0, len(self.t) - 2)
        rest = at - self.t[i]
        return np.asarray(self.total[i] + rest * (self.p[i] + rest * self.slope[i] / 2))
