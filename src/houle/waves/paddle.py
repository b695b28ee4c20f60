"""A paddle that moves as a laboratory recorded it: displacement or velocity against time, from a file.

Between samples the displacement is the natural cubic spline: of all curves through the samples the one with the least
mean square acceleration (Holladay 1957, Math. Tables Aids Comput. 11, 233-243), and its acceleration has no jumps, to
which the pressure on the wall would answer at once. Smoother splines (of fifth order) swing more between samples that
are rounded or noisy; monotone ones (PCHIP) and straight lines have jumps in acceleration or velocity at each sample. A
velocity goes along such a spline too, and the displacement is its exact integral. Nothing is smoothed: the wall is
where the file says, to rounding. What noise of some 0.1 mm makes are waves of two samples, too short for the grid.

The record knows no wave. To tell what comes of it, and for what else in a case has to know a wave, the elevation at the
paddle is found to first order: each frequency of the velocity by the transfer of Biesel & Suquet (1951).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from houle.waves.dispersion import wave_number
from houle.waves.linear import Linear
from houle.waves.piston import Reading, biesel
from houle.waves.wave import KINDS, Array, Kind, WaveError, ramp

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

SHORT = 10  # percentile of the steps of a record that is the step on which its wave is found
BETWEEN = 8  # instants to a step of the record at which its extremes are looked for
DRY = 2.0  # sqrt(g d): water does not follow a wall that goes away faster (Stoker 1957, Water Waves)


@dataclass(frozen=True)
class RecordedMotion:
    """The law of a piston that moves as a record says, from where it stands when the run begins.

    time      samples (N,) on the clock of the run [s], rising
    curve     displacement against this time [m], piecewise polynomials between the samples, its zero that of the record
    quantity  what was recorded, "displacement" or "velocity"
    leaves    velocity with which the wall still moves at the last sample [m/s]
    duration  time in which the motion grows from the start of the run, and in which a wall that still moves at the last
              sample stops [s]; 0: at once

    `displacement` and `velocity` are those of the run: from where the wall stands at its start, ramped.
    """

    time: Array
    curve: PPoly
    quantity: str
    leaves: float
    duration: float

    @classmethod
    def of(cls, time: Array, values: Array, quantity: str, rests: bool, duration: float) -> RecordedMotion:
        """The motion through samples (N,) of the quantity "displacement" [m] or "velocity" [m/s] at times (N,) [s].

        rests: the wall is at rest at the end of the record; else it slows down over `duration` [s], or stops at once.
        """
        from scipy.interpolate import CubicSpline

        spline = CubicSpline(time, values, bc_type="natural")
        curve = spline.antiderivative() if quantity == "velocity" else spline
        return cls(time, curve, quantity, 0.0 if rests else float(curve(time[-1], 1)), duration)

    def recorded(self, t: Array) -> Array:
        """The recorded quantity [m] or [m/s] at times within the record [s]."""
        return np.asarray(self.curve(t, 1 if self.quantity == "velocity" else 0))

    @property
    def zero(self) -> float:
        """Displacement in the record when the run begins [m]."""
        return float(self.curve(np.clip(0.0, self.time[0], self.time[-1])))

    def displacement(self, t: ArrayLike) -> Array:
        """Displacement [m] at times t >= 0 [s] from where the wall stands when the run begins."""
        t = np.asarray(t, dtype=float)
        way = ramp(t, self.duration) * (self.curve(np.clip(t, self.time[0], self.time[-1])) - self.zero)
        if self.leaves and self.duration > 0:
            after = np.clip(t - self.time[-1], 0.0, self.duration)
            way = way + self.leaves / 2 * (after + self.duration / pi * np.sin(pi * after / self.duration))
        return np.asarray(way)

    def velocity(self, t: ArrayLike) -> Array:
        """Velocity [m/s] at times t >= 0 [s]."""
        t = np.asarray(t, dtype=float)
        first, last = self.time[0], self.time[-1]
        speed = np.where((t >= first) & (t <= last), ramp(t, self.duration) * self.curve(np.clip(t, first, last), 1), 0)
        if self.duration > 0:
            growth = np.where(t < self.duration, pi / (2 * self.duration) * np.sin(pi * t / self.duration), 0.0)
            speed = speed + growth * (self.curve(np.clip(t, first, last)) - self.zero)
            fade = np.where((t > last) & (t < last + self.duration), 1 - ramp(t - last, self.duration), 0.0)
            speed = speed + self.leaves * fade
        return np.asarray(speed)

    def way(self, t: float, dt: float, offset: float) -> float:
        """Way of the piston [m] from where it stands, so that rounding does not add up over the steps."""
        return float(self.displacement(t + dt)) - offset

    def expected(self, t: float, offset: float, read: Reading) -> float:
        """Raises NotImplementedError: a record does not tell it, and a case that would absorb by it is refused."""
        raise NotImplementedError("a record of a paddle does not tell the pressure on it")

    @cached_property
    def instants(self) -> Array:
        """Times of the run [s] at which extremes are looked for: samples and BETWEEN points to each step."""
        parts = np.arange(BETWEEN) / BETWEEN
        fine = (self.time[:-1, None] + np.diff(self.time)[:, None] * parts).ravel()
        after = self.time[-1] + self.duration * np.linspace(0.0, 1.0, 4 * BETWEEN + 1)
        return np.unique(np.concatenate([[0.0], np.maximum(fine, 0.0), np.maximum(after, 0.0)]))

    @property
    def reach(self) -> tuple[float, float]:
        way = self.displacement(self.instants)
        return min(float(way.min()), 0.0), max(float(way.max()), 0.0)

    @cached_property
    def fastest(self) -> float:
        """Largest speed [m/s]."""
        return float(np.abs(self.velocity(self.instants)).max())

    @cached_property
    def hardest(self) -> float:
        """Largest acceleration [m/s2], but for that of a start or stop at once."""
        inside = self.instants[self.instants <= max(self.time[-1], 0.0)]
        return float(np.abs(np.gradient(self.velocity(inside), inside)).max()) if len(inside) > 2 else 0.0

    @property
    def coarse(self) -> float:
        """Largest distance of the curve of what was recorded from straight lines between its samples, over its range.

        For a sine sampled N times to a period 2.5 / N^2; the curve itself is then off it by about 4 / N^4.
        """
        middles = (self.time[1:] + self.time[:-1]) / 2
        values, between = self.recorded(self.time), self.recorded(middles)
        return float(np.abs(between - (values[1:] + values[:-1]) / 2).max() / (np.ptp(values) or 1.0))

    @property
    def step(self) -> float:
        """Time between samples of the record [s]: few of its steps are shorter."""
        return float(np.percentile(np.diff(self.time), SHORT))

    @property
    def samples(self) -> str:
        """The number of samples and the times between them, in words."""
        steps = np.diff(self.time)
        apart = f"{steps.min():.3g} to {steps.max():.3g} s apart"
        return (
            f"{len(self.time)} samples, {apart if np.ptp(steps) > 0.01 * self.step else f'one every {self.step:.3g} s'}"
        )

    @property
    def theory(self) -> str:
        return f"moves as the file says, {self.samples}, at most {self.fastest:.3g} m/s and {self.hardest:.3g} m/s2"


@dataclass(frozen=True)
class PaddleWave(Linear):
    """The wave that a recorded motion sends out, to first order."""

    motion: RecordedMotion

    @classmethod
    def sent_by(cls, motion: RecordedMotion, wave: Linear) -> PaddleWave:
        """This wave, as the one that the motion sends out."""
        reason = "linear wave maker theory, of the motion in the file"
        return cls(**{**vars(wave), "name": "paddle", "reason": reason}, motion=motion)


def require_moves(motion: RecordedMotion, depth: float, gravity: float) -> None:
    """Raises WaveError for a motion that there is not, and for one that no water follows."""
    low, high = motion.reach
    if high <= low:
        raise WaveError(
            "waves.file: the paddle does not move after the start of the run; waves.start is the time in the file that "
            "is t = 0 of the run"
        )
    if motion.fastest > (most := DRY * sqrt(max(gravity, 1e-12) * depth)):
        raise WaveError(
            f"waves.file: the paddle moves at up to {motion.fastest:.3g} m/s, above {DRY:g} sqrt(g d) = {most:.3g} m/s "
            f"for d = {depth:g} m, the fastest that water follows: are its units those in the header, m, cm, mm or m/s?"
        )


def elevation(motion: RecordedMotion, depth: float, gravity: float) -> tuple[Array, Array]:
    """Times [s] and elevations [m] at the paddle of the waves that run off from it, by linear theory.

    A component of the velocity makes c_0 / omega times itself, which is sqrt(d/g) for long waves.
    """
    first = max(float(motion.time[0]), 0.0)
    count = max(4, int(np.ceil((float(motion.time[-1]) + motion.duration - first) / motion.step)) + 1)
    time: Array = first + motion.step * np.arange(count, dtype=float)
    omega = 2 * pi * np.fft.rfftfreq(2 * count, motion.step)
    moved = np.where(omega > 0, omega, 1.0)
    transfer = biesel(np.asarray(wave_number(moved, depth, gravity)) * depth) / moved
    transfer[0] = sqrt(depth / gravity)
    eta = np.fft.irfft(transfer * np.fft.rfft(motion.velocity(time), 2 * count), 2 * count)[:count]
    return time, np.clip(eta, -0.95 * depth, 1.95 * depth)


KINDS.add(
    Kind(
        "paddle",
        "What a piston sends out that moves as a CSV file says: columns t_s and displacement_m or velocity_m_s.",
        "made by piston = {x = ...}, without absorb",
        "natural cubic splines; docs/waves.md",
        needs=("file",),
        takes=("start", "gap"),
        place=7,
    )
)
