"""Steady periodic waves as a Fourier series, the form in which Stokes and stream function theory give them.

    elevation = sum E_j cos(j theta)                          theta = k (x - c t) + phase
    u = U + sum C_j cosh(j k z) cos(j theta)    w = sum C_j sinh(j k z) sin(j theta)

so that u - i w = U + sum C_j cos(j (theta + i k z)) is one complex series, summed by Clenshaw's recurrence. U is the
return current of a CLOSED flume: the mean over a period of the integral of u from bed to surface is zero (Stokes'
second definition of the wave speed; Fenton 1985, section 5). The celerity c is measured in that flume.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from houle.waves.wave import Array, Components, Wave

PHASES = 512  # points of a period over which the mass flux is averaged: exact for 255 harmonics


def transport(k: float, depth: float, elevation: Array, velocity: Array) -> float:
    """Mean discharge per metre of width [m2/s] of the velocity sum C_j cosh(jkz) cos(j theta), from bed to surface.

    elevation (N,): E_j [m], harmonics of the surface; velocity (N,): C_j [m/s].
    """
    j = np.arange(1, len(elevation) + 1)[:, None]
    theta = np.arange(PHASES) * (2 * np.pi / PHASES)
    cos = np.cos(j * theta)
    level = depth + (elevation[:, None] * cos).sum(0)
    return float((velocity[:, None] * np.sinh(j * k * level) / (j * k) * cos).sum(0).mean())


@dataclass(frozen=True, eq=False)  # equal, and one key, if equal as `Wave`
class Steady(Wave):
    """A steady wave: heights E_j [m] and speeds C_j [m/s] (N,) from j = 1, current U [m/s]."""

    heights: Array
    speeds: Array
    current: float

    @property
    def crest(self) -> float:
        return float(self.heights.sum())

    def components(self) -> Components:
        """The harmonics of the elevation. They are bound to the first: all travel with its celerity."""
        j = np.arange(1.0, len(self.heights) + 1)
        return Components(
            self.heights, j * self.omega, j * self.k, j * self.phase, np.full(len(self.heights), self.direction)
        )

    def elevation(self, x: ArrayLike, t: ArrayLike) -> Array:
        cos = np.cos(self._theta(x, t))
        b1 = b2 = np.zeros(cos.shape)
        for coefficient in self.heights[::-1]:
            b1, b2 = coefficient + 2 * cos * b1 - b2, b1
        return b1 * cos - b2

    def velocity(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        theta, z = np.broadcast_arrays(self._theta(x, t), self._kz(z))
        cos = np.empty(theta.shape, dtype=complex)
        cos.real = np.cos(theta) * np.cosh(z)
        cos.imag = -np.sin(theta) * np.sinh(z)
        double = 2 * cos
        b1, b2 = np.zeros_like(cos), np.zeros_like(cos)
        for coefficient in self.speeds[::-1]:  # b1, b2 = coefficient + double b1 - b2, b1, without new arrays
            np.subtract(coefficient, b2, out=b2)
            b2 += double * b1
            b1, b2 = b2, b1
        total = b1 * cos - b2
        return self.current + total.real, -total.imag

    def velocity_on(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        return self.along_on(x, z, t), self.up_on(x, z, t)

    def along_on(self, x: ArrayLike, z: ArrayLike, t: float) -> Array:
        theta, kz = self._harmonics(x, z, t)
        return self.current + np.einsum("xj,zj->xz", np.cos(theta), self.speeds * np.cosh(kz), optimize=False)

    def up_on(self, x: ArrayLike, z: ArrayLike, t: float) -> Array:
        theta, kz = self._harmonics(x, z, t)
        return np.einsum("xj,zj->xz", np.sin(theta), self.speeds * np.sinh(kz), optimize=False)

    def _harmonics(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        """j theta (nx, N) and j k z (nz, N)."""
        j = np.arange(1, len(self.speeds) + 1)
        return self._theta(np.asarray(x), t)[:, None] * j, self._kz(np.asarray(z))[:, None] * j

    def _theta(self, x: ArrayLike, t: ArrayLike) -> Array:
        return self.k * np.asarray(x, dtype=float) - self.omega * np.asarray(t, dtype=float) + self.phase

    def _kz(self, z: ArrayLike) -> Array:
        return self.k * np.clip(np.asarray(z, dtype=float), 0, self.depth + self.crest)
