"""Stream function waves: the full equations of steady waves, solved by Fourier series.

Rienecker & Fenton (1981), J. Fluid Mech. 104; Fenton (1988), Computers & Geosciences 14. In the frame of the crest,
with lengths in depths and speeds in sqrt(g d), the stream function

    psi = -U z + sum B_j sinh(j k z)/cosh(j k) cos(j k x)

satisfies Laplace's equation and the bed; at N + 1 points between crest and trough the surface must be a streamline,
psi = -Q, and carry constant pressure, (u^2 + w^2)/2 + eta = R. With the mean depth, the height and the period given
these are 2N + 5 equations for eta_m, B_j, U, Q, R, k: Newton's method, from a low wave in steps of the height.
The flume is closed: no net mass transport, so that the crests pass with c = Q/d (Fenton 1988, current criterion 2).

Written here and not taken from raschii (whose waves the tests compare with) because raschii has zero mean Eulerian
velocity instead of zero transport, takes seconds from period to length and iterates to 1e-8 only.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, pi, sqrt

import numpy as np

from houle.waves import dispersion, limits
from houle.waves.steady import Steady
from houle.waves.wave import THEORIES, Array, Theory, WaveError

ORDERS = (8, 12, 18, 27, 40, 60, 90, 128)  # tried until the last harmonics are negligible
NEGLIGIBLE = 1e-9  # last harmonic of the surface relative to the height
CONVERGED = 1e-13  # residual of the equations at which Newton's method ends
ITERATIONS = 25
LONGER = 1.2  # largest ratio of the length of a steep wave to that of the linear one
DEEPEST = 600.0  # largest N k d: cosh(N k d) must be a number


class NotConverged(WaveError):
    """No stream function wave was found: too long or too near breaking."""


@dataclass
class _Solution:
    """The unknowns eta_m, B_j, U (mean), Q (flow), R (head) and k of the text above, in depths and sqrt(g d)."""

    eta: Array
    b: Array
    mean: float
    flow: float
    head: float
    k: float

    @classmethod
    def unpack(cls, v: Array) -> _Solution:
        n = (len(v) - 5) // 2
        return cls(v[: n + 1], v[n + 1 : 2 * n + 1], *(float(s) for s in v[2 * n + 1 :]))

    def pack(self) -> Array:
        return np.concatenate([self.eta, self.b, [self.mean, self.flow, self.head, self.k]])

    def harmonics(self) -> Array:
        """E_j, j = 0..N, of the surface: eta = sum E_j cos(j k x)."""
        n = len(self.b)
        m = np.arange(n + 1)
        weight = np.where((m == 0) | (m == n), 0.5, 1.0)
        return (2 / n) * weight * (weight * self.eta * np.cos(np.outer(m, m) * pi / n)).sum(-1)

    def refined(self, order: int) -> _Solution:
        """The same wave with more harmonics."""
        e, m = self.harmonics(), np.arange(order + 1)
        eta = (e * np.cos(np.outer(m, np.arange(len(e))) * pi / order)).sum(-1)
        return _Solution(eta, np.pad(self.b, (0, order - len(self.b))), self.mean, self.flow, self.head, self.k)


def _linear(height: float, omega: float, order: int) -> _Solution:
    """The linear wave, with which Newton's method begins."""
    k = float(dispersion.wave_number(omega, 1.0, 1.0))
    c = omega / k
    b = np.zeros(order)
    b[0] = height / (2 * c * k)
    return _Solution(1 + height / 2 * np.cos(np.arange(order + 1) * pi / order), b, c, c, 1 + c * c / 2, k)


def _equations(v: Array, height: float, omega: float) -> tuple[Array, Array]:
    """Residuals (2N + 5,) of the equations, and their derivatives (2N + 5, 2N + 5) by the unknowns."""
    s = _Solution.unpack(v)
    n, k = len(s.b), s.k
    j, m = np.arange(1, n + 1), np.arange(n + 1)
    cos, sin = np.cos(np.outer(m, j) * pi / n), np.sin(np.outer(m, j) * pi / n)
    eta = s.eta[:, None]
    growth, decay = np.exp(j * k * (eta - 1)), np.exp(-j * k * (eta + 1))
    scale = 1 + np.exp(-2 * j * k)
    sinh, cosh = (growth - decay) / scale, (growth + decay) / scale  # over cosh(jk)
    tanh = np.tanh(j * k)
    sinh_k, cosh_k = j * (eta * cosh - tanh * sinh), j * (eta * sinh - tanh * cosh)  # their derivatives by k
    jkb = j * k * s.b
    u, w = -s.mean + (jkb * cosh * cos).sum(1), (jkb * sinh * sin).sum(1)
    u_z, w_z = (j * k * jkb * sinh * cos).sum(1), (j * k * jkb * cosh * sin).sum(1)
    u_k, w_k = ((j * s.b * (v_ + k * v_k) * f).sum(1) for v_, v_k, f in ((cosh, cosh_k, cos), (sinh, sinh_k, sin)))
    weight = np.where((m == 0) | (m == n), 0.5, 1.0) / n

    f = np.empty(2 * n + 5)
    f[: n + 1] = -s.mean * s.eta + (s.b * sinh * cos).sum(1) + s.flow
    f[n + 1 : 2 * n + 2] = (u * u + w * w) / 2 + s.eta - s.head
    f[-3:] = (weight * s.eta).sum() - 1, s.eta[0] - s.eta[-1] - height, s.flow * k - omega

    d = np.zeros((2 * n + 5, 2 * n + 5))
    stream, press = slice(0, n + 1), slice(n + 1, 2 * n + 2)
    by_b, by_mean, by_flow, by_head, by_k = slice(n + 1, 2 * n + 1), 2 * n + 1, 2 * n + 2, 2 * n + 3, 2 * n + 4
    d[m, m] = u
    d[stream, by_b], d[stream, by_mean], d[stream, by_flow] = sinh * cos, -s.eta, 1
    d[stream, by_k] = (s.b * sinh_k * cos).sum(1)
    d[n + 1 + m, m] = 1 + u * u_z + w * w_z
    d[press, by_b] = j * k * (u[:, None] * cosh * cos + w[:, None] * sinh * sin)
    d[press, by_mean], d[press, by_head], d[press, by_k] = -u, -1, u * u_k + w * w_k
    d[-3, : n + 1] = weight
    d[-2, 0], d[-2, n] = 1, -1
    d[-1, by_flow], d[-1, by_k] = k, s.flow
    return f, d


def _newton(guess: _Solution, height: float, omega: float) -> _Solution | None:
    """The wave near the guess, or nothing. It must have one crest and stay above the bed."""
    v = guess.pack()
    for _ in range(ITERATIONS):
        with np.errstate(over="ignore", invalid="ignore"):  # a guess that runs away is found out below
            f, d = _equations(v, height, omega)
        try:
            step = np.linalg.solve(d, -f)
        except np.linalg.LinAlgError:
            return None
        v = v + step
        s = _Solution.unpack(v)
        if not np.all(np.isfinite(v)) or s.k <= 0 or s.eta.min() < 0.05 or s.eta.max() > 2.5:
            return None
        if np.abs(step).max() < CONVERGED * 10 or np.abs(f).max() < CONVERGED:
            return s if np.all(np.diff(s.eta) < 1e-9) else None
    return None


def _climb(height: float, omega: float, order: int) -> _Solution | None:
    """The wave of this height, reached from a low, nearly linear one in steps, shorter ones where Newton fails."""
    k = float(dispersion.wave_number(omega, 1.0, 1.0))
    low = min(height, 0.3 * limits.ursell_height(k), 0.05 * 2 * pi / k)
    now, at = _newton(_linear(low, omega, order), low, omega), low
    before, step = None, low
    while now is not None and at < height:
        to = min(height, at + step)
        guess = now.pack() if before is None else now.pack() + (now.pack() - before[0].pack()) * (to - at) / before[1]
        found = _newton(_Solution.unpack(guess), to, omega)
        if found is None:
            step /= 2
            if step < 0.01 * height:
                return None
            continue
        before, now, at, step = (now, to - at), found, to, step * 1.7
    return now


def solve(height: float, omega: float) -> _Solution:
    """The wave of this height [depths] and angular frequency [sqrt(g/d)]. Raises NotConverged."""
    k = float(dispersion.wave_number(omega, 1.0, 1.0))
    start = min(40, ceil(2.5 * (height / limits.ursell_height(k)) ** 0.5))
    found: _Solution | None = None
    possible = height < limits.williams(LONGER * 2 * pi / k, 1.0)
    for order in (o for o in ORDERS if o >= start and o * k < DEEPEST and possible):
        found = _climb(height, omega, order) if found is None else _newton(found.refined(order), height, omega) or found
        if found is not None and np.abs(found.harmonics()[-2:]).max() < NEGLIGIBLE * height:
            return found
    if found is None or np.abs(found.harmonics()[-2:]).max() > 1e-4 * height:
        highest = limits.williams(2 * pi / k, 1.0)
        raise NotConverged(
            f"fenton: no stream function wave of H/d = {height:.3g} and L/d near {2 * pi / k:.3g}, where the highest "
            f"is {highest:.3g} d ({height / highest:.0%} of it is asked for): give a lower height, or a shorter period"
        )
    return found


def fenton(height: float, period: float, depth: float, gravity: float, phase: float, direction: float) -> Steady:
    """The stream function wave of this height [m] and period [s] in a closed flume. Raises NotConverged."""
    speed = sqrt(gravity * depth)
    s = solve(height / depth, 2 * pi / period * depth / speed)
    j = np.arange(1, len(s.b) + 1)
    celerity = s.flow * speed
    omega = 2 * pi / period
    return Steady(
        name="fenton",
        reason="",
        height=height,
        period=period,
        length=celerity * period,
        depth=depth,
        celerity=celerity,
        group_velocity=float(dispersion.group_velocity(dispersion.wave_number(omega, depth, gravity), depth, gravity)),
        gravity=gravity,
        phase=phase,
        direction=direction,
        heights=s.harmonics()[1:] * depth,
        speeds=j * s.k * s.b / np.cosh(j * s.k) * speed,
        current=(s.flow - s.mean) * speed,
    )


THEORIES.add(
    Theory(
        "fenton",
        "Stream function: Fourier series of the full equations, as many harmonics as matter, closed flume.",
        "regular waves up to 94 % of the highest for L/d below 50, 85 % at 90, 55 % at 180",
        "Rienecker & Fenton (1981); Fenton (1988)",
        fenton,
        place=6,
    )
)
