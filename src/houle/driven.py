"""Faces whose velocity is prescribed: of a moving wall, of an open side. Hook of the projection, `flow.driven`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from houle.grid import FloatArray

if TYPE_CHECKING:
    from houle.flow import Flow


class Driven(Protocol):
    """What `operations.project` asks of each entry of `flow.driven`, in this order."""

    def feed(self, flow: Flow) -> None:
        """After the pressure system: adds the flux through its faces into the cells, flow.work.rhs [1/s]."""

    def impose(self, flow: Flow) -> None:
        """After the pressure gradient was taken off: sets the velocity of its faces and marks them valid."""

    def power(self, flow: Flow) -> float:
        """What the pressure takes through it, pressure / density times flux [m^d m2/s3]: booked as work of sources."""


@dataclass
class DrivenFaces:
    """The faces of one plane across an axis, with water on one side and a prescribed velocity.

    They carry no pressure gradient: at a side of the domain that is so; inside, flow.open_faces must be 0 there.
    axis, face   the plane: face number `face` of that axis
    water        +1: the water is on its far side, -1: on its near side
    velocity     along the axis [m/s], one number or an array of the plane, shape without that axis
    """

    axis: int
    face: int
    water: int
    velocity: float | FloatArray = 0.0

    def cells(self, flow: Flow) -> tuple[slice | int, ...]:
        """The layer of cells behind the faces."""
        return _plane(self.axis, self.face if self.water > 0 else self.face - 1, flow.grid.dimension)

    def feed(self, flow: Flow) -> None:
        layer = self.cells(flow)
        inflow = self.water * np.asarray(self.velocity, float)
        flow.work.rhs[layer] += flow.active[layer] * inflow / flow.grid.spacing[self.axis]

    def impose(self, flow: Flow) -> None:
        plane = _plane(self.axis, self.face, flow.grid.dimension)
        flow.velocity[self.axis][plane] = self.velocity
        flow.work.valid[self.axis][plane] = 1

    def power(self, flow: Flow) -> float:
        layer, grid = self.cells(flow), flow.grid
        flux = self.water * np.asarray(self.velocity, float) * grid.cell_volume / grid.spacing[self.axis]
        return float(np.sum(flow.active[layer] * flow.pressure[layer] * flux))


def _plane(axis: int, number: int, dimension: int) -> tuple[slice | int, ...]:
    return tuple(number if a == axis else slice(None) for a in range(dimension))
