"""Waves in the place where their theory holds, and their errors at the surface."""

import numpy as np

from houle.waves.wave import THEORIES

DEPTH, GRAVITY = 0.25, 9.81
# theory: height [m], period [s] where it holds
PLACES = {
    "airy": (0.002, 1.2),
    "stokes-2": (0.02, 1.2),
    "stokes-3": (0.04, 1.2),
    "stokes-4": (0.04, 1.2),
    "stokes-5": (0.06, 1.2),
    "fenton": (0.08, 1.5),
    "cnoidal": (0.04, 4.0),
}
REGULAR = [name for name, theory in THEORIES.items() if theory.make and not theory.single]
assert list(PLACES) == REGULAR


def surface_errors(wave):
    """Largest error in the kinematic and the dynamic condition at the surface, in sqrt(g d) and d."""
    x = np.linspace(-wave.length / 2, wave.length / 2, 1001)
    level = wave.depth + wave.elevation(x, 0.0)
    u, w = wave.velocity(x, level, 0.0)
    dx = 1e-5 * wave.length
    slope = (wave.elevation(x + dx, 0.0) - wave.elevation(x - dx, 0.0)) / (2 * dx)
    kinematic = np.abs((u - wave.celerity) * slope - w).max()
    head = ((u - wave.celerity) ** 2 + w**2) / (2 * wave.gravity) + level
    return kinematic / np.sqrt(wave.gravity * wave.depth), np.ptp(head) / wave.depth
