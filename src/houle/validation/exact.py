"""Exact solutions to compare the solver with, in NumPy: no dependency beyond the package, no solver of ours inside.

A rigid porous medium of porosity n resists with a u_d + b |u_d| u_d per unit mass and has the inertia coefficient C_r
(1 without added mass). With the Darcy velocity q = u_d = n u the one-dimensional momentum balance is

    (C_r / n) dq/dt = -(1/rho) dp/dx + G - a q - b |q| q,

and crossing a face between water and the medium keeps p + rho K u^2 / 2 (Bernoulli with the pore velocity u = q / n).
K = C_r, for the water that the grains move has inertia, too; K = 1 where the added mass is on the rate alone
(docs/theory.md, section 1).

References: Tadjbakhsh & Keller, J. Fluid Mech. 8 (1960) 442-451 for the standing wave; Dommermuth & Yue, J. Fluid Mech.
184 (1987) 267-288 for the fully non-linear one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from houle.grid import FloatArray


@dataclass(frozen=True)
class PorousMedium:
    """A porous medium: porosity [-], a [1/s] and b [1/m] of the drag a u_d + b |u_d| u_d, inertia C_r [-].

    on_rate: true if the added mass stands before du/dt alone.
    """

    porosity: float
    a: float
    b: float
    inertia: float = 1.0
    on_rate: bool = False

    @property
    def convective(self) -> float:
        """K of the convective acceleration."""
        return 1.0 if self.on_rate else self.inertia


def runge_kutta(slope: Callable[[float, FloatArray], FloatArray], start: FloatArray, times: FloatArray) -> FloatArray:
    """Classical fourth-order Runge-Kutta with the given times (T,) as its steps: states (T, ...)."""
    states = np.empty((len(times), *np.shape(start)))
    states[0] = y = np.asarray(start, float)
    for i, (t, dt) in enumerate(zip(times[:-1], np.diff(times), strict=True)):
        k1 = slope(t, y)
        k2 = slope(t + dt / 2, y + dt / 2 * k1)
        k3 = slope(t + dt / 2, y + dt / 2 * k2)
        k4 = slope(t + dt, y + dt * k3)
        states[i + 1] = y = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return states


def duct_flow(
    time: FloatArray, medium: PorousMedium, acceleration: float, length: float = 1.0, plug: float | None = None
) -> FloatArray:
    """Darcy velocity q(t) [m/s] in a periodic duct of this length [m], driven from rest by an acceleration [m/s2].

    The medium fills the duct, or a plug of this length [m], saturated; clear water resists nothing. Integrated once
    round the duct the pressure drops out: (L - B + B C_r/n) dq/dt = G L - B (a q + b q^2), a Riccati equation.
    """
    share = 1.0 if plug is None else plug / length
    mass = 1.0 - share + share * medium.inertia / medium.porosity
    a, b, g = share * medium.a, share * medium.b, acceleration
    if b == 0.0:
        return g / a * -np.expm1(-a / mass * time) if a > 0.0 else g / mass * time
    root = np.sqrt(a * a + 4.0 * b * g)
    rising, falling = (-a + root) / (2.0 * b), (-a - root) / (2.0 * b)
    decay = np.exp(-root / mass * time)
    return rising * (1.0 - decay) / (1.0 - rising / falling * decay)


def bernoulli_jump(darcy_velocity: float, porosity: float, inertia: float = 1.0) -> float:
    """Pressure drop over density [m2/s2] from clear water into a medium, q^2/2 (K/n^2 - 1); regained on the way out.

    inertia: K, which is C_r, or 1 without added mass and where it is on the rate alone.
    """
    return 0.5 * darcy_velocity**2 * (inertia / porosity**2 - 1.0)


def column_infiltration(
    times: FloatArray, medium: PorousMedium, layer: float, gravity: float = 9.81, step: float = 2e-4
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """A water layer [m] standing on a dry porous bed, both surfaces at p = 0, falls into it from t = 0.

    Returns wetted depth s [m], layer left h [m] and Darcy velocity q [m/s] at the times (T,) [s], NaN once the layer is
    used up. n ds/dt = q, h + n s = layer, and from surface to wetting front
    (h + C_r s/n) dq/dt = g (h + s) - q^2/2 (K/n^2 - 1) - s (a q + b q^2).
    """
    n, a, b, inertia = medium.porosity, medium.a, medium.b, medium.inertia

    def slope(_: float, y: FloatArray) -> FloatArray:
        s, q = y
        h = layer - n * s
        drive = gravity * (h + s) - bernoulli_jump(q, n, medium.convective) - s * (a * q + b * q * abs(q))
        return np.array([q / n, drive / (h + inertia * s / n)])

    fine = np.linspace(0.0, times[-1], max(2, round(times[-1] / step) + 1))
    s, q = runge_kutta(slope, np.zeros(2), fine).T
    left = layer - n * s
    s, q, left = (np.where(left > 0.0, v, np.nan) for v in (s, q, left))
    return np.interp(times, fine, s), np.interp(times, fine, left), np.interp(times, fine, q)


def dispersion(wave_number: float, depth: float, gravity: float = 9.81) -> float:
    """Angular frequency [rad/s] of a small wave: omega^2 = g k tanh(k d)."""
    return float(np.sqrt(gravity * wave_number * np.tanh(wave_number * depth)))


def wave_number(frequency: float, depth: float, gravity: float = 9.81) -> float:
    """Wave number [rad/m] of a small wave of this frequency [rad/s]: omega^2 = g k tanh(k d) solved to round-off."""
    target = frequency**2 / gravity
    k = target / np.sqrt(np.tanh(target * depth))
    for _ in range(50):
        t = np.tanh(k * depth)
        change = (k * t - target) / (t + k * depth * (1.0 - t * t))
        k -= change
        if abs(change) < 1e-15 * k:
            break
    return float(k)


def standing_wave_frequency(amplitude: float, wave_number: float, depth: float, gravity: float = 9.81) -> float:
    """Angular frequency [rad/s] of a periodic standing wave, third order (Tadjbakhsh & Keller 1960).

    With w0^2 = tanh kd: omega = sqrt(g k) (w0 + (k a)^2/64 (9 w0^-7 - 12 w0^-3 - 3 w0 - 2 w0^5)). In deep water the
    factor is 1 - (ka)^2/8; the sign turns at kd = 1.06, shallower waves are faster than small ones. A wave released at
    rest from a cosine is not periodic (it carries a free second mode): `released_wave` has that one.
    """
    w = np.sqrt(np.tanh(wave_number * depth))
    correction = (9.0 * w**-7 - 12.0 * w**-3 - 3.0 * w - 2.0 * w**5) / 64.0
    return float(np.sqrt(gravity * wave_number) * (w + (wave_number * amplitude) ** 2 * correction))


def released_wave(
    times: FloatArray,
    amplitude: float,
    length: float,
    depth: float,
    gravity: float = 9.81,
    modes: int = 16,
    order: int = 5,
) -> FloatArray:
    """Amplitudes (T, modes) [m] of cos(j pi x/length), j = 1, 2, ..., of the surface of a basin, fully non-linear.

    Released at rest at times[0] from a cosine of this amplitude [m]. Potential flow by the high-order spectral method
    (Dommermuth & Yue 1987, their order M; velocity at the surface ordered as in West et al. 1987), mirrored into a
    periodic basin of twice the length. The times (T,) are evenly spaced; the step inside resolves the shortest mode.
    """
    points = 4 * modes
    x = np.arange(2 * points) * length / points
    k = np.pi / length * np.arange(points + 1)
    keep = np.arange(points + 1) <= modes

    def vertical(potential: FloatArray, power: int) -> FloatArray:
        """d^power/dz^power of the harmonic function with this value at z = 0, floor at z = -depth."""
        factor = k**power * (np.tanh(k * depth) if power % 2 else 1.0)
        return np.fft.irfft(factor * np.fft.rfft(potential))

    def along(f: FloatArray) -> FloatArray:
        return np.fft.irfft(1j * k * np.fft.rfft(f) * (np.arange(points + 1) < points))

    def slope(_: float, y: FloatArray) -> FloatArray:
        eta, surface = y
        part, rising = [surface], vertical(surface, 1)
        lift = [eta**j / np.prod(np.arange(1.0, j + 1.0)) for j in range(order)]
        for m in range(1, order):
            part.append(-sum(lift[j] * vertical(part[m - j], j) for j in range(1, m + 1)))
            rising = rising + sum(lift[j] * vertical(part[m - j], j + 1) for j in range(m + 1))
        steep = 1.0 + along(eta) ** 2
        change = np.array(
            [
                rising * steep - along(surface) * along(eta),
                -gravity * eta - 0.5 * along(surface) ** 2 + 0.5 * rising**2 * steep,
            ]
        )
        return np.fft.irfft(np.fft.rfft(change) * keep)

    inside = max(1, int(np.ceil((times[1] - times[0]) * dispersion(k[modes], depth, gravity) / 0.5)))
    fine = np.linspace(times[0], times[-1], (len(times) - 1) * inside + 1)
    start = np.array([amplitude * np.cos(np.pi * x / length), np.zeros_like(x)])
    eta = runge_kutta(slope, start, fine)[::inside, 0]
    return np.fft.rfft(eta)[:, 1 : modes + 1].real / points
