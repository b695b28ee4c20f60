"""Cnoidal waves of third order, and the solitary wave of third and fifth as their limit m = 1.

Fenton (1999), "The cnoidal theory of water waves", in Herbich (ed.), Developments in Offshore Engineering, Gulf,
Houston: eqs (A.1)-(A.3), after Fenton (1979), J. Fluid Mech. 94. With h the depth under the trough, e = H/h, cn the
elliptic function of parameter m and delta = 4/3 alpha^2:

    level / h = 1 + e cn^2 + e^2 (...) + e^3 (...)        alpha = sqrt(3 e / 4 m) (1 + e (...) + e^2 (...))
    U / sqrt(g h) = -1 + delta (...) + delta^2 (...) + delta^3 (...)      polynomials in cn^2 and (z/h)^2

in the frame of the crest. Taken from the series: these three. What follows from them is computed, not expanded again:
w by continuity (so the field has no divergence), the trough depth from the mean level, the celerity from zero mean mass
transport in a closed flume, the wavelength 2 K h / alpha from the period of cn^2. The tests look at the order of the
error in the equations at the surface.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from houle.waves import dispersion
from houle.waves.wave import KINDS, THEORIES, Array, Components, Kind, Theory, Wave, WaveError

RATIOS = (0.9, 50.0)  # range of K(m)/K(1 - m) that is searched: m = 0.43 to 1 - 1e-67
PHASES = 2048  # points of a period, for means and harmonics


def parameter(ratio: float) -> tuple[float, float, float]:
    """Parameter m, K(m) and K(1 - m) for a ratio K(m)/K(1 - m) >= 0.5, by theta functions of the complementary nome q.

    DLMF 20.9: m = (theta_4/theta_3)^4, K(1-m) = pi/2 theta_3^2. Infinite ratio: m = 1.
    """
    q = np.exp(-pi * ratio)
    theta3, theta4 = 1 + 2 * (q + q**4 + q**9 + q**16), 1 + 2 * (-q + q**4 - q**9 + q**16)
    return float((theta4 / theta3) ** 4), float(ratio * pi / 2 * theta3**2), float(pi / 2 * theta3**2)


def elliptic(v: Array, ratio: float) -> tuple[Array, Array]:
    """cn^2(v) and sn(v) cn(v) dn(v): sums over solitary waves, exact for any m and best for m near 1.

    cn = pi/(2 k K') sum (-1)^n sech(pi (v - 2 n K)/(2 K')), sn the same with tanh (Poisson sums of DLMF 22.11).
    """
    if ratio == inf:
        sech2 = np.cosh(np.minimum(np.abs(v), 350.0)) ** -2.0
        return sech2, np.tanh(v) * sech2
    m, k, kc = parameter(ratio)
    v = np.remainder(v + 2 * k, 4 * k) - 2 * k  # a period of sn and cn
    factor, spacing = pi / (2 * kc), pi * ratio
    cn, sn = np.zeros_like(v), np.zeros_like(v)
    images = int(np.ceil(40 / spacing)) + 2
    for n in range(-images, images + 1):
        e = np.exp(-np.abs(factor * v - n * spacing))
        sign = 1.0 if n % 2 == 0 else -1.0
        cn += sign * 2 * e / (1 + e * e)
        sn += sign * np.sign(factor * v - n * spacing) * (1 - e * e) / (1 + e * e)
    cn, sn = cn * factor / sqrt(m), sn * factor / sqrt(m)
    return cn * cn, sn * cn * np.sqrt(np.maximum(1 - m + m * cn * cn, 0))


def surface(e: float, m: float) -> tuple[float, float, float]:
    """Coefficients of cn^2, cn^4, cn^6 in level/h - 1, Fenton (1999) eq. (A.1). Their sum is e exactly."""
    return (
        e - 0.75 * e**2 + e**3 * (111 / 80 - 61 / (80 * m)),
        0.75 * e**2 + e**3 * (-53 / 20 + 61 / (80 * m)),
        e**3 * 101 / 80,
    )


def scale(e: float, m: float) -> float:
    """alpha, Fenton (1999) eq. (A.2)."""
    r = e / m
    return sqrt(0.75 * r) * (1 + r * (1 / 4 - 7 / 8 * m) + r**2 * (1 / 32 - 11 / 32 * m + 111 / 128 * m**2))


def velocity_terms(delta: float, m: float) -> Array:
    """Coefficients (4, 3) of cn^(2i) (z/h)^(2j) in U/sqrt(g h), Fenton (1999) eq. (A.3)."""
    m2, m3 = m * m, m**3
    first = np.array([[0.5 - m, 0, 0], [m, 0, 0], [0, 0, 0], [0, 0, 0]])
    second = np.array(
        [
            [-19 / 40 + 79 / 40 * m - 79 / 40 * m2, 0.75 * (m2 - m), 0],
            [3 * m2 - 1.5 * m, 1.5 * m - 3 * m2, 0],
            [-m2, 2.25 * m2, 0],
            [0, 0, 0],
        ]
    )
    third = np.array(
        [
            [
                55 / 112 - 3471 / 1120 * m + 7113 / 1120 * m2 - 2371 / 560 * m3,
                9 / 8 * m - 27 / 8 * m2 + 9 / 4 * m3,
                -3 / 16 * m + 9 / 16 * m2 - 3 / 8 * m3,
            ],
            [
                71 / 40 * m - 339 / 40 * m2 + 339 / 40 * m3,
                -9 / 4 * m + 27 / 2 * m2 - 27 / 2 * m3,
                3 / 8 * m - 51 / 16 * m2 + 51 / 16 * m3,
            ],
            [27 / 10 * m2 - 27 / 5 * m3, -75 / 8 * m2 + 75 / 4 * m3, 45 / 16 * m2 - 45 / 8 * m3],
            [6 / 5 * m3, -15 / 2 * m3, 45 / 16 * m3],
        ]
    )
    total = delta * first + delta**2 * second + delta**3 * third
    total[0, 0] -= 1
    return total


def polynomial(coefficients: Sequence[Any] | Array, x: Array) -> Array:
    """c_0 + c_1 x + c_2 x^2 + ..., the c_i numbers or arrays."""
    total = np.asarray(coefficients[-1], dtype=float)
    for c in reversed(coefficients[:-1]):
        total = c + x * total
    return total


def integrals(flow: Array, y: Array) -> list[Array]:
    """Integrals from the bed up to y = z/h of the rows of `flow`, polynomials in y^2."""
    odd = 2 * np.arange(flow.shape[1]) + 1
    return [y * polynomial(row / odd, y * y) for row in flow]


@dataclass(frozen=True, eq=False)  # equal, and one key, if equal as `Wave`
class Cnoidal(Wave):
    """A cnoidal wave, or a solitary one as its limit, of order n.

    ratio   K(m)/K(1 - m), infinite for the solitary wave
    trough  depth h under the trough [m]
    alpha   wave number of the elliptic functions, per trough depth
    shape   (n,) coefficients of the surface: powers cn^2, cn^4, ...
    flow    (n + 1, n) coefficients of the velocity in the frame of the crest, in sqrt(g h): powers of cn^2 from 0 and
            of (z/h)^2 from 0
    drift   [m/s] is added to that
    """

    ratio: float
    trough: float
    alpha: float
    shape: tuple[float, ...]
    flow: Array
    drift: float

    @property
    def crest(self) -> float:
        return self.trough * (1 + sum(self.shape)) - self.depth

    def components(self) -> Components | None:
        """The harmonics of the elevation, as many as count (1e-10 of the height); None of a solitary wave."""
        if self.ratio == inf:
            return None
        x = np.arange(PHASES) * (self.length / PHASES) - self.phase / self.k
        spectrum = np.fft.rfft(self.elevation(x, 0.0)).real * 2 / PHASES
        count = int(np.flatnonzero(np.abs(spectrum) > 1e-10 * self.height).max()) + 1
        j = np.arange(1.0, count)
        return Components(
            spectrum[1:count], j * self.omega, j * self.k, j * self.phase, np.full(len(j), self.direction)
        )

    def elevation(self, x: ArrayLike, t: ArrayLike) -> Array:
        c2, _ = self._elliptic(x, t)
        return self.trough * (1 + c2 * polynomial(self.shape, c2)) - self.depth

    def velocity(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        (c2, slope), y = self._elliptic(x, t), self._level(z)
        speed = sqrt(self.gravity * self.trough)
        u = polynomial([polynomial(row, y * y) for row in self.flow], c2)
        sums = integrals(self.flow, y)
        w = 2 * self.alpha * slope * polynomial([i * sums[i] for i in range(1, len(sums))], c2)
        return self.drift + speed * u, speed * w

    def velocity_on(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        return self.velocity(np.asarray(x, dtype=float)[:, None], np.asarray(z, dtype=float)[None, :], t)

    def _elliptic(self, x: ArrayLike, t: ArrayLike) -> tuple[Array, Array]:
        along = np.asarray(x, dtype=float) - self.celerity * np.asarray(t, dtype=float) + self.phase / self.k
        return elliptic(np.asarray(along * (self.alpha / self.trough)), self.ratio)

    def _level(self, z: ArrayLike) -> Array:
        return np.clip(np.asarray(z, dtype=float), 0, self.depth + self.crest) / self.trough


def _wave_of(ratio: float, height: float, depth: float, gravity: float) -> tuple[float, float, float, float]:
    """Trough depth h, alpha, celerity and length [m, -, m/s, m] of the wave with this ratio."""
    m, k, _ = parameter(ratio)
    c2, _ = elliptic(np.linspace(0, 2 * k, PHASES, endpoint=False), ratio)
    trough = depth
    for _ in range(100):
        level = 1 + c2 * polynomial(surface(height / trough, m), c2)
        before, trough = trough, depth / float(level.mean())
        if abs(trough - before) < 1e-15 * depth:
            break
    alpha = scale(height / trough, m)
    p = velocity_terms(4 / 3 * alpha**2, m)
    flow = float(polynomial(integrals(p, level), c2).mean())
    celerity = -flow * trough / depth * sqrt(gravity * trough)
    return trough, alpha, celerity, 2 * k * trough / alpha


def cnoidal(height: float, period: float, depth: float, gravity: float, phase: float, direction: float) -> Cnoidal:
    """The cnoidal wave of this height [m] and period [s] in a closed flume. Raises WaveError where there is none."""

    def period_of(ratio: float) -> float:
        _, _, celerity, length = _wave_of(ratio, height, depth, gravity)
        return length / celerity if celerity > 0 else inf

    low, high = RATIOS
    shortest, longest = period_of(low), period_of(high)
    if not shortest <= period <= longest:
        raise WaveError(
            f"cnoidal: a period of {period:g} s is outside {shortest:.3g} to {longest:.3g} s, what the theory gives "
            f'for height {height:g} m in {depth:g} m of water; use theory = "fenton"'
        )
    for _ in range(60):
        middle = sqrt(low * high)
        low, high = (middle, high) if period_of(middle) < period else (low, middle)
    ratio = sqrt(low * high)
    trough, alpha, celerity, length = _wave_of(ratio, height, depth, gravity)
    m = parameter(ratio)[0]
    linear = dispersion.wave_number(2 * pi / period, depth, gravity)
    return Cnoidal(
        name="cnoidal",
        reason="",
        height=height,
        period=length / celerity,
        length=length,
        depth=depth,
        celerity=celerity,
        group_velocity=float(dispersion.group_velocity(linear, depth, gravity)),
        gravity=gravity,
        phase=phase,
        direction=direction,
        ratio=ratio,
        trough=trough,
        alpha=alpha,
        shape=surface(height / trough, m),
        flow=velocity_terms(4 / 3 * alpha**2, m),
        drift=celerity,
    )


# Fenton (1999) to fifth order for m = 1: what (A.1) to (A.3) become for the solitary wave
SURFACE_5 = (
    (1, 0, 0, 0, 0),
    (-3 / 4, 3 / 4, 0, 0, 0),
    (5 / 8, -151 / 80, 101 / 80, 0, 0),
    (-8209 / 6000, 11641 / 3000, -112393 / 24000, 17367 / 8000, 0),
    (364671 / 196000, -2920931 / 392000, 2001361 / 156800, -17906339 / 1568000, 1331817 / 313600),
)  # rows: powers of e from 1; columns: powers of sech^2 from 1
SCALE_5 = (1, -5 / 8, 71 / 128, -100627 / 179200, 16259737 / 28672000)
CELERITY_5 = (1, 1 / 2, -3 / 20, 3 / 56, -309 / 5600, 12237 / 616000)
VELOCITY_5 = (
    ((-1 / 2,), (1,)),
    ((-19 / 40,), (3 / 2, -3 / 2), (-1, 9 / 4)),
    ((-55 / 112,), (71 / 40, -9 / 4, 3 / 8), (-27 / 10, 75 / 8, -45 / 16), (6 / 5, -15 / 2, 45 / 16)),
    (
        (-11813 / 22400,),
        (53327 / 42000, -213 / 80, 9 / 16, -3 / 80),
        (-13109 / 3000, 3231 / 160, -327 / 32, 189 / 160),
        (1763 / 375, -729 / 20, 915 / 32, -63 / 16),
        (-197 / 125, 189 / 10, -315 / 16, 189 / 64),
    ),
    (
        (-57159 / 98560,),
        (-144821 / 156800, -53327 / 28000, 213 / 320, -9 / 160, 9 / 4480),
        (-1131733 / 294000, 1628189 / 56000, -13563 / 640, 267 / 64, -459 / 1792),
        (757991 / 73500, -192481 / 2000, 68643 / 640, -987 / 32, 567 / 256),
        (-298481 / 36750, 11187 / 100, -5481 / 32, 7875 / 128, -1215 / 256),
        (13438 / 6125, -5319 / 125, 1701 / 20, -567 / 16, 729 / 256),
    ),
)  # powers of delta from 1, of sech^2 from 0, of (z/h)^2 from 0


def _fifth(e: float) -> tuple[float, tuple[float, ...], Array, float]:
    """alpha, shape, flow and c/sqrt(g d) of the fifth-order solitary wave."""
    alpha = sqrt(0.75 * e) * sum(c * e**n for n, c in enumerate(SCALE_5))
    shape = tuple(sum(row[j] * e ** (n + 1) for n, row in enumerate(SURFACE_5)) for j in range(5))
    flow = np.zeros((6, 5))
    flow[0, 0] = -1
    for n, block in enumerate(VELOCITY_5):
        for i, row in enumerate(block):
            flow[i, : len(row)] += (4 / 3 * alpha**2) ** (n + 1) * np.array(row)
    return alpha, shape, flow, sum(c * e**n for n, c in enumerate(CELERITY_5))


def _third(e: float) -> tuple[float, tuple[float, ...], Array, float]:
    """alpha, shape, flow and c/sqrt(g d) of the third-order solitary wave."""
    alpha = scale(e, 1.0)
    return alpha, surface(e, 1.0), velocity_terms(4 / 3 * alpha**2, 1.0), sqrt(1 + e - e**2 / 20 - 3 * e**3 / 70)


EDGE = 0.01  # share of the height at which a solitary wave is said to begin and end


def solitary(
    height: float, depth: float, gravity: float, crest: float = 0.0, direction: float = 0.0, order: int = 5
) -> Cnoidal:
    """The solitary wave of third or fifth order with its crest at x = `crest` [m] at t = 0.

    Third: c^2/(g d) = 1 + e - e^2/20 - 3 e^3/70 (Grimshaw 1971, J. Fluid Mech. 46; Fenton 1972, J. Fluid Mech. 53).
    Fifth: Fenton (1999); its error at the surface is a twentieth at H/d = 0.2 and less than half at 0.6. The
    velocity is Fenton's (1999) series in delta, less its value far away, where the water is at rest. A solitary wave
    carries water with it: its transport is not zero. `length` is the distance over which the elevation is above 1 % of
    the height, `period` the time in which that passes.
    """
    e = height / depth
    alpha, shape, flow, froude = _third(e) if order == 3 else _fifth(e)
    speed = sqrt(gravity * depth)
    celerity = speed * froude
    length = 2 * float(np.arccosh(1 / sqrt(EDGE))) * depth / alpha
    return Cnoidal(
        name=f"solitary-{order}",
        reason="",
        height=height,
        period=length / celerity,
        length=length,
        depth=depth,
        celerity=celerity,
        group_velocity=celerity,
        gravity=gravity,
        phase=-2 * pi * crest / length,
        direction=direction,
        ratio=inf,
        trough=depth,
        alpha=alpha,
        shape=shape,
        flow=flow,
        drift=-float(flow[0, 0]) * speed,
    )


THEORIES.add(
    Theory(
        "cnoidal",
        "Third order in H/h with elliptic functions, closed flume.",
        "L/d above 8, H/d below 0.4",
        "Fenton (1979, 1999)",
        cnoidal,
        place=7,
    )
)
THEORIES.add(
    Theory(
        "solitary-3",
        "A single crest, third order.",
        "H/d below 0.3",
        "Grimshaw (1971); Fenton (1972, 1999)",
        partial(solitary, order=3),
        place=8,
        single=True,
    )
)
THEORIES.add(
    Theory(
        "solitary-5",
        "A single crest, fifth order.",
        "H/d below 0.5",
        "Fenton (1999)",
        partial(solitary, order=5),
        place=9,
        single=True,
    )
)
KINDS.add(
    Kind(
        "solitary",
        "A single crest; theory solitary-5 unless told.",
        "H/d below 0.5",
        "see there",
        needs=("height",),
        takes=("theory", "focus"),
        place=1,
    )
)
