"""A recorded series of elevations at one place: a laboratory wave, a ship's drawdown and secondary waves.

The record is led back to still water on both sides by half cosines (nothing between its first and last time is
changed), followed by two durations of rest, and made into Fourier components, each of which travels by linear
dispersion. Very long components are kept: k d -> 0 is the long wave with u = sqrt(g/d) times the elevation, and the
mean is one of them, so that the water is at rest before and after the event. The smallest components are left out
(`tolerance`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from houle.waves.current import wave_number
from houle.waves.linear import Linear
from houle.waves.wave import KINDS, Array, Components, Kind, WaveError

LEAD = 0.15  # share of the duration over which the record is led back to 0, on each side
REST = 2.0  # durations of still water after it, before the Fourier series begins again
SHORT = 10  # percentile of the steps of an uneven record that is the step on which it is interpolated
TOLERANCE = 1e-3  # rms of what is left out, relative to the rms of the record


def series(
    time: Array,
    eta: Array,
    depth: float,
    gravity: float,
    direction: float = 0.0,
    place: float = 0.0,
    tolerance: float = TOLERANCE,
    current: float = 0.0,
) -> Linear:
    """The wave whose elevation at x = `place` [m] is the record: times (N,) rising [s], elevations (N,) [m].

    Evenly spaced times are kept; uneven ones are interpolated linearly on a step that few of theirs are shorter than.
    The height of the wave is the highest minus the lowest level, its period that of the largest component.
    """
    if not -depth < eta.min() <= eta.max() < 2 * depth:
        raise WaveError(
            f"waves.file: elevations from {eta.min():g} to {eta.max():g} m do not fit a depth of {depth:g} m: they are "
            "heights above still water in metres"
        )
    if not np.ptp(eta):
        raise WaveError(f"waves.file: all elevations are {eta[0]:g} m: a wave has to move")
    t, samples, dt = _padded(time, eta)
    spectrum = np.fft.rfft(samples) / len(samples)
    size = np.abs(spectrum) * np.where(np.arange(len(spectrum)) == 0, 1.0, 2.0)
    if len(samples) % 2 == 0:
        size[-1] /= 2
    energy = size**2 * np.where(np.arange(len(size)) == 0, 1.0, 0.5)
    kept = np.sort(_largest(energy, tolerance))
    omega: Array = np.asarray(2 * np.pi / (len(samples) * dt) * kept, dtype=float)
    k = wave_number(omega, depth, gravity, current)
    phase = np.asarray(omega * t[0] - np.angle(spectrum[kept]) - k * place)  # cos(k x - omega t + phase)
    peak = 2 * np.pi / float(omega[np.argmax(np.where(omega > 0, size[kept], 0))])
    parts = Components(np.asarray(size[kept]), omega, k, phase, np.full(len(kept), direction))
    height = float(np.ptp(eta))
    return Linear.of("series", height, peak, depth, gravity, parts, max(1.2 * float(eta.max()), 0.05 * height), current)


def _padded(time: Array, eta: Array) -> tuple[Array, Array, float]:
    """Evenly spaced times [s], the samples led back to 0 on both sides [m], and the step [s]."""
    steps = np.diff(time)
    dt = float(time[-1] - time[0]) / (len(time) - 1)
    if np.ptp(steps) > 1e-6 * dt:
        dt = float(time[-1] - time[0]) / int(np.ceil((time[-1] - time[0]) / np.percentile(steps, SHORT)))
        even = time[0] + dt * np.arange(round((time[-1] - time[0]) / dt) + 1)
        time, eta = even, np.interp(even, time, eta)
    lead = max(4, round(LEAD * len(eta)))
    fade = 0.5 + 0.5 * np.cos(np.pi * np.arange(1, lead + 1) / lead)
    return (
        time[0] + dt * (np.arange(len(eta) + 2 * lead + round(REST * len(eta))) - lead),
        np.concatenate([eta[0] * fade[::-1], eta, eta[-1] * fade, np.zeros(round(REST * len(eta)))]),
        dt,
    )


def _largest(energy: Array, tolerance: float) -> NDArray[np.int64]:
    """Indices of the fewest components that leave less than tolerance^2 of the energy out."""
    order = np.argsort(energy, kind="stable")[::-1]
    left = energy.sum() - np.cumsum(energy[order])
    count = int(np.argmax(left <= tolerance**2 * energy.sum())) + 1 if tolerance > 0 else len(order)
    return np.asarray(order[:count], dtype=np.int64)


KINDS.add(
    Kind(
        "series",
        "Elevations from a CSV file with columns t_s, eta_m, by linear dispersion; a ship's drawdown and its secondary "
        "waves.",
        "linear; long waves too",
        "Fourier components; docs/waves.md",
        needs=("file",),
        takes=("start", "gap", "order"),
        place=6,
    )
)
