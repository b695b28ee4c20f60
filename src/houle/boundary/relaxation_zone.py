"""A relaxation zone: the flow is led towards a wave, the harder the further in.

What it leads with is an acceleration; what it damps with is a linear resistance, which enters the implicit drag with
the pressure and limits no time step.
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

FIRM, HARD = 2.0, 8.0  # of a zone where it begins to damp, in the strength of a sponge; and at the wall, in that


@dataclass(eq=False)
class RelaxationZone(Boundary):
    """The flow is led towards the wave, the harder the further in: du/dt = ... + sigma (u_wave - u).

    What comes back from the structure is damped on its way in, by a sigma that grows gently enough to send little back.
    Where the zone begins at a wall, the wave of theory would cross it: over the first third the wave grows from
    nothing, so that the water it needs comes from the level there, and sigma grows faster, so that the flow follows. An
    open side lets the wave pass, and needs neither. The vertical velocity is what continuity asks for.

    faces, cells  of axis 0, those it covers
    """

    wave: Wave
    faces: slice
    cells: slice
    x: FloatArray  # of the faces of axis 0 [m]
    z: FloatArray  # of the centres along the last axis [m]
    steep: float  # spacing of the last axis over that of axis 0
    sigma: tuple[FloatArray, FloatArray]  # on faces and centres [1/s]
    share: FloatArray  # of the wave, on faces, 0 at a wall
    duration: float
    up: int  # the last axis

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
        """Between x[0], where the wave is complete, and x[1] [m]; wall: whether the side of the tank is a wall."""
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
        """CaseError where a moving wall stands in it: the wave of theory goes through it from its start to its end."""
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
    """0 below 0, 1 above 1, smooth between (two continuous derivatives)."""
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
        "Relaxation zone at the left wall, one and a half wavelengths: every wave of theory along x, takes up what "
        "comes back.",
        "after Jacobsen, Fuhrman & Fredsoe (2012)",
        _make,
        place=4,
    )
)
