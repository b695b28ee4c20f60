"""A relaxation zone: leads the flow towards a wave of theory, the more firmly the nearer to the side of the tank.

It adds sigma (s u_wave - u) to the acceleration of the water, (26) in docs/theory.md. The part sigma s u_wave is a push
on the faces. The part -sigma u is a linear resistance, which enters the implicit drag, solved together with the
pressure, and so limits no time step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from houle.boundary.sponge import damping
from houle.errors import CaseError
from houle.flow.boundaries import BOUNDARIES, Boundaries, Boundary, BoundaryKind, Surroundings, Tank
from houle.flow.particles import Particles
from houle.grid import Faces, FloatArray, Grid
from houle.medium.medium import Medium
from houle.waves.wave import Wave, WaveError, ramp

FIRM, HARD = 2.0, 8.0  # sigma_m over that of a sponge as long; factor of xi^6 beside xi^2 where a wall stands


@dataclass(eq=False)
class RelaxationZone(Boundary):
    """Leads the flow towards the wave: du/dt = ... + sigma (s u_wave - u), sigma = sigma_m (xi^2 + 8 xi^6).

    xi is 0 at the end of the zone where the waves leave it and 1 at its start. Waves that come back from the structure
    are damped on their way in, by a sigma that grows gently enough to reflect little.

    Where the zone starts at a wall, the wave of theory cannot cross it. So the share s of the wave grows from 0 to 1
    over the first third, where the water that the wave needs comes from the level, and sigma has its second term, so
    that the flow follows. An open side lets the wave pass: there s is 1 and the second term is left out. The vertical
    velocity is the one that continuity asks for with the horizontal one.

    faces, cells  ranges along x of the faces and of the cells that it covers
    x, z          positions of these faces, and of the cell centres along the last axis [m]
    steep         spacing of the last axis over that of the first [-]
    sigma         sigma on these faces and at the centres of these cells [1/s]
    share         s on these faces [-]
    duration      time in which the wave grows from nothing [s]; up: number of the last axis
    """

    wave: Wave
    faces: slice
    cells: slice
    x: FloatArray
    z: FloatArray
    steep: float
    sigma: tuple[FloatArray, FloatArray]
    share: FloatArray
    duration: float
    up: int

    def push(self, t: float, acceleration: Faces) -> None:
        grown = float(ramp(t, self.duration))
        u = self.share[:, None] * self.wave.along_on(self.x, self.z, t)
        w = np.pad(np.cumsum(u[:-1] - u[1:], axis=1), ((0, 0), (1, 0))) * self.steep
        pairs = ((0, self.faces, u), (len(acceleration) - 1, self.cells, w))
        for (axis, where, velocity), sigma in zip(pairs, self.sigma, strict=True):
            force = (grown * sigma)[:, None] * velocity
            acceleration[axis][where] += force[:, None, :] if acceleration[axis].ndim == 3 else force

    def touches(self) -> dict[int, slice]:
        return {0: self.faces, self.up: self.cells}

    @classmethod
    def of(cls, x: tuple[float, float], wave: Wave, grid: Grid, duration: float, wall: bool = True) -> RelaxationZone:
        """The zone from x[0], at the side of the tank, to x[1] [m]. Raises WaveError for oblique waves.

        wall: True where this side of the tank is a wall, False where it is open.
        """
        start, end = x
        h, n = grid.spacing[0], grid.shape[0]
        if grid.dimension == 3 and wave.direction:
            raise WaveError("waves.zone leads waves along x only; take waves.source for oblique waves")
        faces = slice(max(0, round(start / h)), min(n, round(end / h)) + 1)
        cells = slice(faces.start, faces.stop - 1)
        points = (grid.axis_points(0, on_faces=True)[faces], grid.axis_points(0)[cells])
        firm = FIRM * damping(wave.group_velocity, end - start)
        inwards = [(end - p) / (end - start) for p in points]  # 0 where the waves leave the zone, 1 at its start
        at_faces, at_centres = (firm * (s**2 + (HARD * s**6 if wall else 0.0)) for s in inwards)
        up = grid.dimension - 1
        return cls(
            wave, faces, cells, points[0], grid.axis_points(up), grid.spacing[up] / h,
            sigma=(at_faces, at_centres),
            share=smooth(3 * (1 - inwards[0])) if wall else np.ones(len(points[0])),
            duration=duration, up=up,
        )  # fmt: skip

    def join(self, tank: Tank, boundaries: Boundaries) -> None:
        """Raises CaseError where a moving wall or another zone stands in it: the wave of theory would go through it."""
        h = tank.grid.spacing[0]
        low, high = self.faces.start * h, (self.faces.stop - 1) * h
        for other in boundaries:
            if isinstance(other, RelaxationZone) and other is not self:
                first, end = max(self.faces.start, other.faces.start), min(self.faces.stop, other.faces.stop)
                if first < end:
                    raise CaseError(f"two zones lead the water around x = {first * h:.3g} m: it follows one wave only")
            for x, _ in other.images():
                if low < x < high:
                    raise CaseError(
                        f"waves.zone leads the water from x = {low:.3g} to {high:.3g} m as if nothing stood there, but "
                        f"{other.name} does, at x = {x:.4g} m: move one of them"
                    )

    def resist(self, rate: Faces) -> None:
        """Adds sigma to the linear resistance of the faces [1/s]."""
        last = len(rate) - 1
        for axis, r in enumerate(rate):
            where, sigma = (self.faces, self.sigma[0]) if axis == 0 else (self.cells, self.sigma[1])
            r[where] += sigma.reshape((-1,) + (1,) * last)


def smooth(s: FloatArray) -> FloatArray:
    """Smooth step: 0 for s below 0, 1 above 1, between them a polynomial with two continuous derivatives."""
    s = np.clip(s, 0, 1)
    return s**3 * (10 - 15 * s + 6 * s**2)


def _make(
    case: Surroundings, grid: Grid, medium: Medium, water: Particles, *, x: tuple[float, float]
) -> RelaxationZone:
    assert case.wave is not None
    return RelaxationZone.of(x, case.wave, grid, case.ramp, wall=not case.open_left)


BOUNDARIES.add(
    BoundaryKind(
        "zone",
        "Relaxation zone at the left wall, one and a half wavelengths: makes every wave of theory along x, and absorbs "
        "the waves that come back.",
        "after Jacobsen, Fuhrman & Fredsoe (2012)",
        _make,
        place=4,
    )
)
