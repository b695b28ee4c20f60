"""The force of the water on the grains of a porous body: buoyancy, drag and inertia (docs/theory.md, section 15)."""

from __future__ import annotations

import numpy as np

from houle.flow.state import Flow
from houle.grid import FloatArray
from houle.medium.integrals import Measure, over_cells
from houle.medium.sections import partition
from houle.observe.profile import wet_share
from houle.observe.surfaces import Load, moment


class BodyLoad:
    """Per density and volume: -(1 - n) g + (a + b|u_d|) u_d + (C_r/n - 1) D u_d/Dt.

    Summed over the cells, each with the volume of the body in it that is under water. u_d is the mean of the velocities
    before and after the forces of the step and D u_d/Dt their difference over its length: both are of the instant of
    the pressure. Where the added mass stands before du/dt alone that difference is the acceleration less its share
    1 - 1/C_r of (u . grad) u_d, which the water has besides: so much less is left for the grains.
    """

    def __init__(self, flow: Flow, number: int, about: FloatArray) -> None:
        grid, medium = flow.grid, flow.medium
        self.body = medium.bodies[number]
        parts = partition(grid, medium.bodies, medium.solids)
        share = Measure.of(grid, [(s, areas[number]) for s, _, areas in parts]).mean([over_cells] * grid.dimension)
        reach = [
            np.flatnonzero(share.max(axis=tuple(b for b in range(share.ndim) if b != a))) for a in range(share.ndim)
        ]
        self.cells = tuple(slice(int(r[0]), int(r[-1]) + 1) if len(r) else slice(0, 0) for r in reach)
        self.spacing = grid.spacing
        self.volume = share[self.cells] * grid.cell_volume
        self.arm = (grid.points()[self.cells] - about).reshape(-1, grid.dimension)

    def load(self, flow: Flow) -> tuple[Load, FloatArray]:
        """Force and moment, and the part of the force that is drag."""
        body, d = self.body, flow.grid.dimension
        before, after = (self._at_centres(u) for u in (flow.old_velocity, flow.velocity))
        u = 0.5 * (before + after)
        drag = (body.a + body.b * np.sqrt((u * u).sum(axis=0))) * u
        total = drag + (body.inertia / body.porosity - 1.0) / flow.kick * (after - before)
        if body.convective != body.inertia:
            total -= (1.0 - body.convective / body.inertia) / body.porosity * self._convection(u)
        total -= (1.0 - body.porosity) * np.reshape(flow.gravity, (d,) + (1,) * d)
        wet = (wet_share(flow, self.cells[:-1])[..., self.cells[-1]] * self.volume).ravel()
        force = (total.reshape(d, -1) * wet).T
        return (force.sum(axis=0), moment(self.arm, force)), (drag.reshape(d, -1) * wet).sum(axis=1)

    def _convection(self, u: FloatArray) -> FloatArray:
        """(u . grad) u of a field (d, ...) of the cells."""
        found = np.zeros_like(u)
        for b, h in enumerate(self.spacing):
            if u.shape[1 + b] > 1:
                found += u[b] * np.gradient(u, h, axis=1 + b)
        return found

    def _at_centres(self, velocity: list[FloatArray]) -> FloatArray:
        """(d, ...) from the two faces of each axis."""
        found = []
        for a, u in enumerate(velocity):
            s = self.cells[a]
            above = tuple(slice(s.start + 1, s.stop + 1) if b == a else c for b, c in enumerate(self.cells))
            found.append(0.5 * (u[self.cells] + u[above]))
        return np.stack(found)
