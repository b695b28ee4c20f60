"""A lifting gate: a thin plate across the tank that is lifted, and so opens from the floor up.

The plate stands on the nearest face of the grid, and its lower edge on the nearest grid line: through a face that is a
little open the pressure would drive the water of a whole cell, which cannot pass. For particles, fill, levels and
velocities the gate is a wall between the two columns beside it, above its lower edge (docs/decisions/0020).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from houle.flow.boundaries import BOUNDARIES, Boundary, BoundaryKind, Row, Surroundings, Tank
from houle.flow.component import State
from houle.flow.particles import Particles
from houle.grid import FloatArray, Grid, SingleFaces
from houle.medium.medium import Medium


class Gate(Boundary):
    """A gate that rises at constant speed from a given time on.

    face  number along x of the face on which it stands; x: position of that face [m]
    row   row of cells, counted from the floor, at whose lower face the lower edge is now; the gate is shut from it up
    """

    def __init__(self, grid: Grid, x: float, speed: float, start: float = 0.0, name: str = "gate") -> None:
        """A gate at x [m] whose lower edge rises with this speed [m/s] from the time `start` [s] on."""
        self.grid, self.speed, self.start, self.name = grid, speed, start, name
        self.face = round(x / grid.spacing[0])
        self.x = self.face * grid.spacing[0]
        self.row = self._row_at(0.0)

    def _row_at(self, t: float) -> int:
        """The row whose lower face is the grid line nearest to the lower edge at the time t [s]."""
        return math.floor(max(0.0, (t - self.start) * self.speed) / self.grid.spacing[-1] + 0.5)

    def openness(self, faces: SingleFaces) -> None:
        faces[0][self.face][..., self.row :] *= 0.0

    def gates(self) -> Sequence[Row]:
        return [(self.x, self.row * self.grid.spacing[-1])]

    def begin(self, tank: Tank, dt: float) -> None:
        """Puts the gate where it stands at the start of the step; it stays there throughout the step."""
        self.row = self._row_at(tank.time)

    def state(self) -> State:
        return {"row": np.array(self.row)}

    def restore(self, state: Mapping[str, FloatArray]) -> None:
        self.row = int(state["row"])


def _make(
    case: Surroundings, grid: Grid, medium: Medium, water: Particles, *, x: float, speed: float, start: float
) -> Gate:
    return Gate(grid, x, speed, start)


BOUNDARIES.add(
    BoundaryKind(
        "gate",
        "A thin plate across the tank that is lifted.",
        "docs/decisions/0020",
        _make,
        place=0,
        full_height=False,
        divides=True,
    )
)
