"""The phase of regular waves over a window: a wrong period lets it turn, and the mean over periods loses height.

Amplitudes of single periods, taken at a period that is off by dT, turn by 2 pi dT / T from one period to the next, and
their mean falls as sinc(n dT / T): by 8 % for 1.33 s instead of 1.3333 s over 90 periods. The turn that all gauges have
in common is measured here (the largest line of the periods' spectrum, Rife & Boorstyn 1974). Little is left alone, some
is followed by the period that fits, much is refused.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle.analysis.errors import AnalysisError
from houle.analysis.levels import Gauges

ROUND_OFF = 1e-13  # share of the highest level at the gauges: a smaller amplitude counts as none
SMALL = 0.15  # turn over the window [rad] that is left alone: it costs 1e-3 of the height
MOST = np.pi  # largest turn over the window [rad] that is followed
OFF = 0.02  # largest change of the period that is followed, as a share
SURE = 3.0  # a turn counts from so many of its standard errors on
LOST = 0.02  # part of the height that a mean over periods may lose before a note is due
WIDE = 10.0  # the period that fits is looked for among those up to so many times shorter and longer
AWAY = 4.0  # another period is the right one if it holds so many times the energy


@dataclass(frozen=True)
class Turn:
    """Turn of the phase [rad per period], its standard error, share of the amplitude in the mean that follows it."""

    rate: float
    error: float
    coherence: float


def turn(F: NDArray[Any]) -> Turn:
    """The common turn of amplitudes F (periods, G) from period to period: exp(i rate j)."""
    n = len(F)
    size = max(64, 16 * n)
    lines = np.sum(np.abs(np.fft.fft(F, size, axis=0)) ** 2, axis=1)
    best, number = int(np.argmax(lines)), np.arange(n)
    rate = 2 * np.pi * (best - size if best > size // 2 else best) / size
    total = float(np.sum(np.abs(F) ** 2))
    if total == 0.0 or n < 2:
        return Turn(0.0, float("inf"), 1.0)
    for _ in range(20):  # Newton's steps to the top of |sum F exp(-i rate j)|^2
        still = F * np.exp(-1j * rate * number)[:, None]
        s, first, second = still.sum(axis=0), (-1j * number @ still), (-(number**2) @ still)
        slope = 2 * np.sum((np.conj(s) * first).real)
        bend = 2 * np.sum(np.abs(first) ** 2 + (np.conj(s) * second).real)
        step = -slope / bend if bend < 0 else 0.0
        rate += float(np.clip(step, -1.0 / n, 1.0 / n))
        if abs(step) < 1e-14:
            break
    still = F * np.exp(-1j * rate * number)[:, None]
    mean = still.mean(axis=0)
    held = float(np.sum(np.abs(mean) ** 2))
    noise = float(np.sum(np.abs(still - mean) ** 2)) / max(1, (n - 1) * F.shape[1])
    error = np.sqrt(6 * noise / max(held * n * (n**2 - 1), 1e-300))
    return Turn(float(rate), float(error), float(np.sqrt(n * held / total)))


def followed(
    amplitudes: Callable[[float, int], NDArray[Any]], omega: float, start: float, end: float, record: Gauges
) -> tuple[float, list[str]]:
    """The frequency [rad/s] whose phase stands still in the window, and notes.

    amplitudes(omega, periods): first harmonics (periods, G) of whole periods from `start` on. Raises AnalysisError,
    with the period that fits, when the one given is too far off.
    """
    given, within = omega, record.between(start, end)
    notes: list[str] = []
    if np.ptp(within.eta, axis=1).max() <= ROUND_OFF * np.abs(within.eta).max():
        return omega, notes  # still water
    _require_the_wave(within, given)
    for _ in range(6):
        length = 2 * np.pi / omega
        periods = int(np.floor((end - start) / length + 1e-6))
        if periods < 2:
            break
        found = turn(amplitudes(omega, periods))
        over = found.rate * periods
        if abs(over) < (SMALL if omega == given else 1e-6) or abs(found.rate) < SURE * found.error:
            break
        fits = omega - found.rate / length
        if abs(fits / given - 1) > OFF or abs((fits - given) * (end - start)) > MOST:
            _refuse(given, fits, end - start)
        omega = fits
    if omega != given:
        notes.append(
            f"the phase turns by {(given - omega) * (end - start):+.2f} rad in the window at T = "
            f"{2 * np.pi / given:.6g} s: followed, as of waves of T = {2 * np.pi / omega:.6g} s (if the period given "
            "is exact, they are not steady)"
        )
    if periods > 2 and 1.0 - found.coherence > LOST:
        notes.append(
            f"the mean over {periods} periods holds {100 * found.coherence:.0f} % of the amplitude of single ones: "
            "they differ in height or phase (noise, waves that are not steady, or of more than one period)"
        )
    return omega, notes


def _refuse(given: float, fits: float, length: float) -> None:
    raise AnalysisError(
        f"the phase turns by {abs(fits - given) * length:.3g} rad in the window of {length:.4g} s at T = "
        f"{2 * np.pi / given:.6g} s: the period that fits is {2 * np.pi / fits:.6g} s. Give it, or leave the period "
        "out to have it found"
    )


def _require_the_wave(g: Gauges, omega: float) -> None:
    """Raises AnalysisError when waves of another period hold most of the energy: half, double, or just another one."""
    rows = (g.eta - g.eta.mean(axis=1, keepdims=True)) * np.hanning(len(g.time))
    size = 8 * len(g.time)
    power = np.sum(np.abs(np.fft.rfft(rows, size, axis=1)) ** 2, axis=0)
    line = 2 * np.pi / (size * g.step)  # rad/s
    low, high = int(0.4 * omega / line), int(2.6 * omega / line) + 1
    width = max(1, round(0.25 * omega / line))
    here = round(omega / line)
    own = float(power[max(0, here - width) : here + width + 1].max(initial=0.0))
    near = power[low:high]
    if len(near) and float(near.max()) > AWAY * own:
        low, high = max(1, int(omega / (WIDE * line))), int(WIDE * omega / line) + 1
        fits = line * (low + int(np.argmax(power[low:high])))  # this may be the flank of a wave farther off
        _refuse(omega, fits, float(g.time[-1] - g.time[0]))
