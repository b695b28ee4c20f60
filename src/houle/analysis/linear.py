"""Linear waves over a flat bottom: omega^2 = g k tanh(k d), the phase and the group velocity (Airy)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError

GRAVITY = 9.81  # m/s2


def wave_number(omega: ArrayLike, depth: float, gravity: float = GRAVITY) -> NDArray[np.float64]:
    """k [rad/m] of omega [rad/s] in water of a depth [m], to rounding; same shape as omega. Raises AnalysisError.

    Newton on y tanh(y) = x, y = k d, x = omega^2 d / g; y tanh(y) is convex where it counts and the start lies above
    the root.
    """
    w = np.asarray(omega, dtype=float)
    if not (depth > 0 and gravity > 0 and np.all(w >= 0)):
        raise AnalysisError(f"omega = {w} rad/s, depth = {depth:g} m: omega >= 0, depth > 0 and gravity > 0 are needed")
    x = w**2 * depth / gravity
    y = np.maximum(np.maximum(x, np.sqrt(x)), 1e-300)
    for _ in range(30):
        t = np.tanh(y)
        step = (y * t - x) / (t + y * (1.0 - t * t))
        y = np.maximum(y - step, 1e-300)
        if np.all(np.abs(step) <= 4e-16 * y):
            break
    return np.where(x > 0, y / depth, 0.0)


def celerity(omega: float, depth: float, gravity: float = GRAVITY) -> float:
    """Phase velocity omega / k [m/s]."""
    return float(omega / wave_number(omega, depth, gravity))


def group_velocity(omega: float, depth: float, gravity: float = GRAVITY) -> float:
    """c_g = c / 2 (1 + 2 k d / sinh(2 k d)) [m/s]: the speed of the front of a wave train."""
    y = 2.0 * float(wave_number(omega, depth, gravity)) * depth
    return 0.5 * celerity(omega, depth, gravity) * (1.0 + (y / np.sinh(y) if y < 600.0 else 0.0))
