"""Stability of a bank: exit gradient against the critical one, Shields number at the face, lag of the phreatic line.

Exit gradient: water that leaves a bank with the hydraulic gradient i lifts the grains when i exceeds
i_c = (s - 1) (1 - n) (Terzaghi), s = density of the grains over that of water.

Shields number theta = u*^2 / ((s - 1) g d). The friction velocity u* comes from a velocity U at a height z above the
face by the logarithmic law of a rough wall, U = (u* / 0.40) ln(z / z0), z0 = d / 12 (grain roughness 2.5 d, over 30):
Soulsby, Dynamics of Marine Sands (1997), eqs (24)-(25); that of a current with the mean U over the depth h from
U = (u* / 0.40) (ln(h / z0) - 1). Friction velocities normal to each other add as their squares. Grains on a level bed
move above theta_c = 0.30 / (1 + 1.2 D*) + 0.055 (1 - exp(-0.020 D*)), D* = d ((s - 1) g / nu^2)^(1/3): Soulsby &
Whitehouse (1997), eq. (77) there. Down a slope of angle beta, theta_c is multiplied with sin(phi - beta) / sin(phi),
phi the angle of repose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError
from houle.analysis.waves import harmonics
from houle.waves.dispersion import GRAVITY

Real = NDArray[np.float64]
KARMAN = 0.40
SHALLOWEST = 10.0  # grains in the depth of a current that rubs over them
ALIKE = 0.01  # peaks of a correlation that differ by less are as high as each other


def critical_gradient(porosity: float, relative_density: float = 2.65) -> float:
    """Critical exit gradient i_c = (s - 1) (1 - n) [-], s the density of the grains over that of water."""
    if not (0 < porosity < 1 and relative_density > 1):
        raise AnalysisError(f"porosity = {porosity:g}, s = {relative_density:g}: 0 < porosity < 1 and s > 1 are needed")
    return (relative_density - 1.0) * (1.0 - porosity)


@dataclass(frozen=True)
class Exit:
    """Exit gradient (T,), positive outwards; its `critical` value; `time_above` [s], in which that was exceeded."""

    gradient: Real
    critical: float
    time_above: float

    @property
    def largest(self) -> float:
        return float(self.gradient.max())

    @property
    def safety(self) -> float:
        """Critical over largest gradient; infinite when water never leaves."""
        return self.critical / self.largest if self.largest > 0 else float("inf")

    def __str__(self) -> str:
        return (
            f"exit gradient: largest {self.largest:.3g}, critical {self.critical:.3g}, safety {self.safety:.3g}, "
            f"above for {self.time_above:.3g} s"
        )


def exit_gradient(
    time: ArrayLike,
    inside: ArrayLike,
    outside: ArrayLike,
    place_inside: ArrayLike,
    place_outside: ArrayLike,
    porosity: float,
    *,
    relative_density: float = 2.65,
    density: float = 1000.0,
    gravity: float = GRAVITY,
) -> Exit:
    """Gradient of the head h = p / (rho g) + z between two pressure sensors (T,) [Pa], from inside to the face.

    Places (d,) [m], the last axis is up. The two should be a few grains apart, along the normal of the face. Raises
    AnalysisError.
    """
    t, a, b = (np.asarray(v, dtype=float) for v in (time, place_inside, place_outside))
    head_in = np.asarray(inside, dtype=float) / (density * gravity) + a[-1]
    head_out = np.asarray(outside, dtype=float) / (density * gravity) + b[-1]
    distance = float(np.linalg.norm(b - a))
    if not (distance > 0 and head_in.shape == head_out.shape == t.shape):
        raise AnalysisError("exit gradient: two different places, and pressures as long as the times, are needed")
    gradient = (head_in - head_out) / distance
    critical = critical_gradient(porosity, relative_density)
    above = float(np.sum(np.diff(t) * 0.5 * ((gradient[1:] > critical) * 1.0 + (gradient[:-1] > critical))))
    return Exit(gradient, critical, above)


@dataclass(frozen=True)
class Shields:
    """Shields number (T,), its `critical` value and the friction velocity (T,) [m/s]."""

    number: Real
    critical: float
    friction_velocity: Real

    @property
    def largest(self) -> float:
        return float(self.number.max())

    @property
    def moving(self) -> float:
        """Part of the samples in which grains move."""
        return float(np.mean(self.number > self.critical))

    def __str__(self) -> str:
        return (
            f"Shields: largest {self.largest:.3g}, critical {self.critical:.3g}, moving {100 * self.moving:.3g} % of "
            "the time"
        )


def shields(
    velocity: ArrayLike,
    height: float,
    grain_diameter: float,
    *,
    slope: float = 0.0,
    repose: float = np.radians(32.0),
    relative_density: float = 2.65,
    viscosity: float = 1.0e-6,
    gravity: float = GRAVITY,
    across: ArrayLike = 0.0,
    depth: ArrayLike = np.inf,
) -> Shields:
    """Shields number from the velocity along the face (T,) [m/s] at `height` [m] above it; formulas at the head.

    across  velocity, mean over the depth, of a current normal to that one (T,) [m/s], such as the return current of a
            ship; depth of the water (T,) [m], in which less than ten grains count as none

    slope, repose [rad]; the law holds for turbulent flow over rough grains, u* d / nu > 30 or so, and height > 2 d.
    Raises AnalysisError.
    """
    d, s = grain_diameter, relative_density
    if not (d > 0 and s > 1 and height > 0.5 * d):
        raise AnalysisError(
            f"height = {height:g} m, grain = {d:g} m, s = {s:g}: height > d / 2 > 0 and s > 1 are needed"
        )
    if not 0 <= slope < repose:
        raise AnalysisError(f"slope = {slope:g} rad must be at least 0 and under the angle of repose {repose:g} rad")
    friction = KARMAN * np.abs(np.asarray(velocity, dtype=float)) / np.log(12.0 * height / d)
    friction = np.hypot(friction, _friction_of_current(across, depth, d))
    star = d * ((s - 1.0) * gravity / viscosity**2) ** (1.0 / 3.0)
    level = 0.30 / (1.0 + 1.2 * star) + 0.055 * (1.0 - np.exp(-0.020 * star))
    critical = float(level * np.sin(repose - slope) / np.sin(repose))
    return Shields(friction**2 / ((s - 1.0) * gravity * d), critical, friction)


def _friction_of_current(mean: ArrayLike, depth: ArrayLike, grain_diameter: float) -> Real:
    """Friction velocity [m/s] of a current with this mean over the depth: U = (u* / 0.40) (ln(depth / z0) - 1)."""
    h = np.asarray(depth, dtype=float)
    enough = (h >= SHALLOWEST * grain_diameter) & np.isfinite(h)
    log = np.log(12.0 * np.where(enough, h, 1e3 * grain_diameter) / grain_diameter) - 1.0
    return np.asarray(np.where(enough, KARMAN * np.abs(np.asarray(mean, dtype=float)) / log, 0.0))


def lag(time: ArrayLike, outside: ArrayLike, inside: ArrayLike, period: float | None = None) -> float:
    """The time [s] by which the level inside follows the one outside, (T,) each, evenly spaced.

    With a period: phase between the first harmonics, in (-T/2, T/2]. Without: highest cross-correlation of the two
    less their means, a parabola between samples, within a quarter of the record; of peaks of one height, which a
    periodic level has one period apart, the one nearest to no lag. Raises AnalysisError.
    """
    t, a, b = (np.asarray(v, dtype=float) for v in (time, outside, inside))
    if not (t.shape == a.shape == b.shape and np.all(np.isfinite(a)) and np.all(np.isfinite(b))):
        raise AnalysisError("lag: the two levels must be as long as the times and without gaps (dry?)")
    if period is not None:
        omega = 2 * np.pi / period
        F = harmonics(t, np.array([a, b]), omega)[:, 1]
        return float(np.angle(F[1] / F[0]) / omega)
    step, reach = (t[-1] - t[0]) / (len(t) - 1), len(t) // 4
    match = np.array([_correlation(a, b, shift) for shift in range(-reach, reach + 1)])
    best = _first_peak(match)
    if not 0 < best < 2 * reach or not match[best] > 0:
        raise AnalysisError("the two levels have no common signal within a quarter of the record: give the period")
    left, top, right = match[best - 1 : best + 2]
    return float(step * (best - reach + 0.5 * (left - right) / (left - 2 * top + right)))


def _first_peak(match: Real) -> int:
    """Index of the peak nearest to no lag (the middle), among those within `ALIKE` of the highest."""
    highest = match.max()
    peaks = [i for i in range(1, len(match) - 1) if match[i - 1] < match[i] >= match[i + 1]]
    peaks = [i for i in peaks if match[i] >= (1.0 - ALIKE) * highest]
    return min(peaks, key=lambda i: abs(i - len(match) // 2)) if highest > 0 and peaks else int(np.argmax(match))


def _correlation(a: Real, b: Real, shift: int) -> float:
    """Correlation of a(t) and b(t + shift), where both are known."""
    p, q = (a[: len(a) - shift], b[shift:]) if shift >= 0 else (a[-shift:], b[: len(b) + shift])
    p, q = p - p.mean(), q - q.mean()
    size = np.sqrt(np.sum(p**2) * np.sum(q**2))
    return float(np.sum(p * q) / size) if size > 0 else 0.0
