"""The force of the water on the grains of a porous body (theory, section 14): buoyancy, pressure gradient, drag."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from houle.flow import Flow
from houle.grid import FloatArray
from houle.moments import Measure, over_cells
from houle.observe.profile import Indices
from houle.observe.surfaces import Load, moment
from houle.porous import partition


class BodyLoad:
    """Per density and volume: -(1 - n) g + (1 - n/C_r) e + (n/C_r) R u_d, with e = g - grad p / rho and R = a + b|u_d|.

    Summed over the cells, each with the volume of the body in it that is under water. The velocity is the mean of
    those before and after the forces of the step: the one of the instant of the pressure.
    """

    def __init__(self, flow: Flow, number: int, about: FloatArray) -> None:
        grid, medium = flow.grid, flow.medium
        self.body = medium.bodies[number]
        parts = partition(grid, medium.bodies, medium.solids)
        share = Measure.of(grid, [(s, areas[number]) for s, _, areas in parts]).mean([over_cells] * grid.dimension)
        where = np.nonzero(share > 1e-12)
        if len(where[0]) == 0:
            where = tuple(np.zeros(1, int) for _ in grid.shape)
        low, high = [int(w.min()) for w in where], [int(w.max()) + 1 for w in where]
        self.cells = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
        self.volume = share[self.cells] * grid.cell_volume
        self.arm = grid.points()[self.cells] - about
        self.sides = [self._sides(flow, a, low[a], high[a]) for a in range(grid.dimension)]

    def _sides(self, flow: Flow, a: int, low: int, high: int) -> tuple[Indices, NDArray[np.bool_]]:
        """Numbers of the cells from one before to one after, and which faces are closed, along an axis."""
        n = flow.grid.shape[a]
        index = np.arange(low - 1, high + 1)
        index = index % n if flow.grid.periodic[a] else np.clip(index, 0, n - 1)
        faces = tuple(slice(low, high + 1) if b == a else s for b, s in enumerate(self.cells))
        closed = np.moveaxis(flow.medium.open_faces[a][faces] == 0.0, a, 0).copy()
        if not flow.grid.periodic[a]:
            closed[0] |= low == 0
            closed[-1] |= high == n
        return index, closed

    def load(self, flow: Flow) -> tuple[Load, FloatArray]:
        """Force and moment, and the part of the force that is drag."""
        body, d = self.body, flow.grid.dimension
        n, share = body.porosity, body.porosity / body.inertia
        gravity = np.asarray(flow.gravity)
        u = np.stack([self._velocity(flow, a) for a in range(d)], axis=-1)
        speed = np.sqrt((u * u).sum(axis=-1, keepdims=True))
        resistance = (body.a + body.b * speed) * u
        driving = np.stack([self._driving(flow, a) for a in range(d)], axis=-1)
        wet = np.clip(flow.depth[self.cells] + 0.5, 0.0, 1.0) * self.volume
        total = (1.0 - share) * driving + share * resistance - (1.0 - n) * gravity
        force = (wet[..., None] * total).reshape(-1, d)
        drag = n * (wet[..., None] * resistance).reshape(-1, d).sum(axis=0)
        return (force.sum(axis=0), moment(self.arm.reshape(-1, d), force)), drag

    def _velocity(self, flow: Flow, a: int) -> FloatArray:
        """Darcy velocity along axis a at the centres."""
        low = self.cells
        high = tuple(slice(s.start + 1, s.stop + 1) if b == a else s for b, s in enumerate(low))
        old, new = flow.old_velocity[a], flow.velocity[a]
        return 0.25 * (old[low] + old[high] + new[low] + new[high])

    def _driving(self, flow: Flow, a: int) -> FloatArray:
        """g - grad p / rho along axis a at the centres: the mean of the faces that tell.

        On a closed face it is 0 (nothing moves there); one towards the air says nothing. A cell that is less than half
        under water has no pressure, and takes what the one below it has.
        """
        index, closed = self.sides[a]
        g = flow.gravity[a]
        window = tuple(slice(None) if b == a else s for b, s in enumerate(self.cells))
        p = np.moveaxis(flow.pressure[window], a, 0)[index]
        wet = p != 0.0
        tells = (wet[1:] & wet[:-1]) | closed
        e = np.where(tells & ~closed, g - (p[1:] - p[:-1]) / flow.grid.spacing[a], 0.0)
        count = tells[1:].astype(float) + tells[:-1]
        mean = (e[1:] + e[:-1]) / np.maximum(count, 1.0)
        mean = np.moveaxis(np.where(wet[1:-1], mean, 0.0), 0, a)
        lower = np.concatenate([mean[..., :1], mean[..., :-1]], axis=-1)
        return np.where(np.moveaxis(wet[1:-1], 0, a), mean, lower)
