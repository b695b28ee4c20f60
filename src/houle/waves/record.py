"""A recorded series of elevations at one place: a laboratory wave, a ship's drawdown and secondary waves.

The record is led back to still water on both sides by half cosines (nothing between its first and last time is
changed), followed by two durations of rest, and made into Fourier components, each of which travels by linear
dispersion. Very long components are kept: k d -> 0 is the long wave with u = sqrt(g/d) times the elevation, and the
mean is one of them, so that the water is at rest before and after the event. The smallest components are left out
(`tolerance`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from houle.waves.current import wave_number
from houle.waves.linear import Linear
from houle.waves.second_order import SecondOrder
from houle.waves.wave import KINDS, Array, Components, Kind, WaveError

LEAD = 0.15  # share of the duration over which the record is led back to 0, on each side
REST = 2.0  # durations of still water after it, before the Fourier series begins again
SHORT = 10  # percentile of the steps of an uneven record that is the step on which it is interpolated
TOLERANCE = 1e-3  # rms of what is left out, relative to the rms of the record
FOUND: dict[tuple[object, ...], SecondOrder] = {}  # the last wave of second order, which takes seconds to find
ENDS, LASTS = 0.1, 0.3  # share of a record at each end, and of its range that a sea has there
ITERATIONS, TAKEN = 40, 0.5  # substitutions that find what is bound in a record, to `TOLERANCE`; share of each change


def series(
    time: Array,
    eta: Array,
    depth: float,
    gravity: float,
    direction: float = 0.0,
    place: float = 0.0,
    tolerance: float = TOLERANCE,
    current: float = 0.0,
    order: int = 1,
) -> Linear:
    """The wave whose elevation at x = `place` [m] is the record: times (N,) rising [s], elevations (N,) [m].

    To second order (order = 2) the waves bound to others are found in the record, and the rest of it is free.

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
    height = float(np.ptp(eta))
    highest = max(1.2 * float(eta.max()), 0.05 * height)

    def linear(samples: Array) -> Linear:
        size, omega, turn = _lines(samples, dt, tolerance)
        k = wave_number(omega, depth, gravity, current)
        phase = np.asarray(omega * t[0] - turn - k * place)  # cos(k x - omega t + phase)
        parts = Components(size, omega, k, phase, np.full(len(size), direction))
        peak = 2 * np.pi / float(omega[np.argmax(np.where(omega > 0, size, 0))])
        return Linear.of("series", height, peak, depth, gravity, parts, highest, current)

    if order == 1:
        return linear(samples)
    key = samples.tobytes(), float(t[0]), dt, depth, gravity, direction, place, tolerance, current
    if key not in FOUND:
        FOUND.clear()
        FOUND[key] = _without_bound(linear, samples, place, float(t[0]), dt)
    return FOUND[key]


def _lines(samples: Array, dt: float, tolerance: float) -> tuple[Array, Array, Array]:
    """Sizes [m], frequencies [rad/s] and angles [rad] of the lines of a record that are kept."""
    spectrum = np.fft.rfft(samples) / len(samples)
    size = np.abs(spectrum) * np.where(np.arange(len(spectrum)) == 0, 1.0, 2.0)
    if len(samples) % 2 == 0:
        size[-1] /= 2
    energy = size**2 * np.where(np.arange(len(size)) == 0, 1.0, 0.5)
    kept = np.sort(_largest(energy, tolerance))
    omega: Array = np.asarray(2 * np.pi / (len(samples) * dt) * kept, dtype=float)
    return np.asarray(size[kept]), omega, np.angle(spectrum[kept])


def _without_bound(
    linear: Callable[[Array], Linear], samples: Array, place: float, start: float, dt: float
) -> SecondOrder:
    """The wave of second order whose elevation at `place` is the record: what is bound in it is taken off the record.

    By substitution, as the bound waves depend on what remains. A record that is in motion at both ends is a piece of a
    sea, one that begins and ends at rest a group that passes. Raises WaveError where it does not converge.
    """
    closed, step = _lasts(samples), 2 * np.pi / (len(samples) * dt)
    middle = _middle(linear(samples).parts.moving)
    bound, allowed = np.zeros_like(samples), TOLERANCE * float(np.std(samples))
    for _ in range(ITERATIONS):
        wave = SecondOrder.of_linear(linear(samples - bound), closed, middle, step)
        change = wave.bound_record(place, start, dt, len(samples)) - bound
        bound = bound + TAKEN * change
        if not (size := float(np.std(change))) < 2 * float(np.std(samples)):
            break
        if size < allowed:
            return wave
    raise WaveError(
        f"waves.order = 2: the bound waves of this record in {wave.depth:g} m of water cannot be told from the rest: "
        "they are not small beside it; take order = 1, or a record from deeper water"
    )


def _lasts(samples: Array) -> bool:
    """True for a record whose ends move nearly as much as the whole of it: a piece of a sea."""
    count = round(len(samples) / (1 + 2 * LEAD + REST))
    lead = round(LEAD * count)
    there = samples[lead : lead + count]
    ends = max(4, round(ENDS * count))
    return bool(min(np.ptp(there[:ends]), np.ptp(there[-ends:])) > LASTS * np.ptp(there))


def _middle(parts: Components) -> float:
    """Frequency [rad/s] below which half of the energy is: close to the peak, and the same for records much alike."""
    energy = np.cumsum(parts.amplitude**2)
    return float(parts.omega[np.searchsorted(energy, energy[-1] / 2)])


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
