"""Linear superposition: Airy waves, random seas, focused groups, recorded series.

Each component obeys omega^2 = g k tanh(k d) and moves the water by (Airy 1845; Dean & Dalrymple 1991)

    u = a c k cosh(k z) / sinh(k d) cos(theta)    w = a c k sinh(k z) / sinh(k d) sin(theta)    c = omega / k

up to the still water level d. Above it the velocity goes on linearly, u(d) + (z - d) du/dz(d): the second-order
accurate continuation, without the blow-up of cosh(k z) in the short components under a high crest (Rodenbusch &
Forristall 1986 compare the choices). A component with k = 0 (the mean of a record, or a very long wave) is the limit
of long waves, u = a sqrt(g/d): the water is at rest where and when the sum of all components is. No return flow is
added: in linear theory the mass transport is of second order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from houle.waves import dispersion
from houle.waves.wave import THEORIES, Array, Components, Theory, Wave

BLOCK = 1 << 14  # numbers in a temporary array of `velocity`: they stay in the cache


def profiles(k: Array, z: Array, depth: float) -> tuple[Array, Array]:
    """k cosh(k z)/sinh(k d) and k sinh(k z)/sinh(k d) [1/m], with the linear continuation above z = d.

    k (N,), z any shape; result shape (*z.shape, N).
    """
    below, above = np.minimum(z, depth)[..., None], np.maximum(z - depth, 0)[..., None]
    x = np.where(k > 0, k * depth, 1.0)
    front = np.where(k > 0, x / -np.expm1(-2 * x), 0.5) / depth  # k / (1 - exp(-2kd))
    up, down = np.exp(k * (below - depth)), np.exp(-k * (below + depth))
    cosh, sinh = front * (up + down), front * (up - down)
    return cosh + k * above * sinh, sinh + k * above * cosh


@dataclass(frozen=True)
class Linear(Wave):
    """A sum of Airy waves, its components `parts`; no crest is expected to pass the level `highest` [m]."""

    parts: Components
    highest: float

    @classmethod
    def of(
        cls,
        name: str,
        height: float,
        period: float,
        depth: float,
        gravity: float,
        parts: Components,
        highest: float,
        current: float,
    ) -> Linear:
        """The sum of these components; length and speeds are those of the period [s] on the current [m/s]."""
        k = float(dispersion.wave_number(2 * np.pi / period, depth, gravity, current))
        return cls(
            name=name,
            reason="",
            height=height,
            period=period,
            length=float(2 * np.pi / k),
            depth=depth,
            celerity=float(dispersion.celerity(k, depth, gravity)) + current,
            group_velocity=float(dispersion.group_velocity(k, depth, gravity)) + current,
            gravity=gravity,
            phase=0.0,
            direction=float(parts.direction[0]),
            parts=parts,
            highest=highest,
        )

    @property
    def crest(self) -> float:
        return self.highest

    def components(self) -> Components:
        return self.parts

    def elevation(self, x: ArrayLike, t: ArrayLike) -> Array:
        x, t = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(t, dtype=float))
        out = np.empty(x.size)
        p, rows = self.parts, max(1, BLOCK // len(self.parts.k))
        for i in range(0, x.size, rows):
            theta = p.k * x.flat[i : i + rows][:, None] - p.omega * t.flat[i : i + rows][:, None] + p.phase
            out[i : i + rows] = (p.amplitude * np.cos(theta)).sum(-1)
        return out.reshape(x.shape)

    def velocity(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        x, z = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(z, dtype=float))
        u, w = np.empty(x.size), np.empty(x.size)
        rows = max(1, BLOCK // len(self.parts.k))
        for i in range(0, x.size, rows):
            cos, sin = self._columns(x.flat[i : i + rows], t)
            cosh, sinh = profiles(self.parts.k, self._level(z.flat[i : i + rows]), self.depth)
            u[i : i + rows] = np.einsum("ij,ij->i", cos, cosh, optimize=False)
            w[i : i + rows] = np.einsum("ij,ij->i", sin, sinh, optimize=False)
        return u.reshape(x.shape), w.reshape(x.shape)

    def velocity_on(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        cos, sin = self._columns(np.asarray(x, dtype=float), t)
        cosh, sinh = profiles(self.parts.k, self._level(np.asarray(z, dtype=float)), self.depth)
        return _product(cos, cosh), _product(sin, sinh)

    def along_on(self, x: ArrayLike, z: ArrayLike, t: float) -> Array:
        cosh = profiles(self.parts.k, self._level(np.asarray(z, dtype=float)), self.depth)[0]
        return _product(self._columns(np.asarray(x, dtype=float), t)[0], cosh)

    def up_on(self, x: ArrayLike, z: ArrayLike, t: float) -> Array:
        sinh = profiles(self.parts.k, self._level(np.asarray(z, dtype=float)), self.depth)[1]
        return _product(self._columns(np.asarray(x, dtype=float), t)[1], sinh)

    def _columns(self, x: Array, t: float) -> tuple[Array, Array]:
        """a c cos(theta) and a c sin(theta) [m2/s], (nx, N)."""
        p = self.parts
        theta = p.k * x[:, None] - p.omega * t + p.phase
        size = p.amplitude * dispersion.celerity(p.k, self.depth, self.gravity)
        return size * np.cos(theta), size * np.sin(theta)

    def _level(self, z: Array) -> Array:
        return np.minimum(z, self.depth + self.highest)


def _product(columns: Array, levels: Array) -> Array:
    """Product (nx, N), (nz, N) -> (nx, nz), without BLAS: its threads would wait in a loop."""
    return np.einsum("xj,zj->xz", columns, levels, optimize=False)


def airy(height: float, period: float, depth: float, gravity: float, phase: float, direction: float) -> Linear:
    """The linear wave of this height [m] and period [s]."""
    omega = np.array([2 * np.pi / period])
    k = dispersion.wave_number(omega, depth, gravity)
    return Linear(
        name="airy",
        reason="",
        height=height,
        period=period,
        length=float(2 * np.pi / k[0]),
        depth=depth,
        celerity=float(omega[0] / k[0]),
        group_velocity=float(dispersion.group_velocity(k[0], depth, gravity)),
        gravity=gravity,
        phase=phase,
        direction=direction,
        parts=Components(np.array([height / 2]), omega, k, np.array([phase]), np.array([direction])),
        highest=height / 2,
    )


THEORIES.add(
    Theory("airy", "One cosine, linear.", "H so small that crests and troughs are alike", "Airy (1845)", airy, place=1)
)
