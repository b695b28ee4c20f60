"""One instant of a run as the writers and the pictures see it: particles, cells, and the profile of the surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from houle.fields import Field
from houle.flow.state import Flow
from houle.grid import FloatArray, Grid
from houle.observe.points import at_points

WET = 1e-3  # fill of a cell [-], from which on its velocity means something

PARTICLES = (
    Field("position", "x", "m", "particle", "position of the particle, the last axis upwards", vector=True),
    Field(
        "velocity",
        "u",
        "m s-1",
        "particle",
        "pore velocity of the water, with which it moves: Darcy velocity over porosity",
        vector=True,
    ),
    Field(
        "volume",
        "V",
        "m3",
        "particle",
        "volume of water that the particle carries, constant between remeshings",
        unit_2d="m2",
    ),
    Field(
        "porosity",
        "n",
        "1",
        "particle",
        "pore volume over total volume that the particle moves with, 1 in clear water; it is fitted to what the cells "
        "hold, so that within two cells of a face it differs from that of the body by up to a quarter of the step, and "
        "may be above 1",
    ),
    Field("pressure", "p", "Pa", "particle", "pressure of the water above that of the air, interpolated from the grid"),
)
FACES = (
    Field(
        "velocity",
        "u_d",
        "m s-1",
        "face",
        "Darcy velocity normal to the face: flow rate of the water over the whole area",
        vector=True,
    ),
)
CELLS = (
    Field(
        "velocity", "u_d", "m s-1", "centre", "Darcy velocity of the water, mean of the two faces of each axis",
        vector=True,
    ),
    Field("pressure", "p", "Pa", "centre", "pressure of the water above that of the air, as the projection gives it"),
    Field("fill", r"\varphi", "1", "centre", "volume of water over the pore volume of the cell"),
    Field("porosity", "n", "1", "centre", "mean porosity of the open part of the cell"),
)  # fmt: skip


@dataclass(frozen=True)
class Snapshot:
    """Particles: position, velocity (N, d), volume, porosity, pressure (N,). Cells: grid.shape, velocity (..., d).

    The quantities are those of PARTICLES and CELLS, whose names here begin with `cell_`; eta is that of the profile.
    """

    time: float
    step: int
    position: FloatArray
    velocity: FloatArray  # pore velocity u_d / n [m/s]
    volume: FloatArray
    porosity: FloatArray
    pressure: FloatArray
    cell_pressure: FloatArray
    cell_fill: FloatArray
    cell_velocity: FloatArray  # Darcy velocity [m/s]
    cell_porosity: FloatArray
    eta: FloatArray  # level of the free surface above z = 0 [m], grid.shape[:-1], NaN where dry


class Snapshots:
    """Takes frames of a flow on the grid of the whole tank: above the rows of cells that the flow keeps is air."""

    def __init__(self, flow: Flow, grid: Grid, density: float) -> None:
        self.flow, self.grid, self.density = flow, grid, density

    def take(self, time: float, step: int, eta: FloatArray) -> Snapshot:
        """Everything the writers and the pictures need of the present flow, as copies; eta is the profile [m]."""
        flow, p, rho = self.flow, self.flow.particles, self.density
        pressure, _ = at_points(flow, p.position)
        centre = [0.5 * (np.delete(u, 0, axis=a) + np.delete(u, -1, axis=a)) for a, u in enumerate(flow.velocity)]
        velocity = [self._whole(np.where(flow.fill > WET, u, 0.0)) for u in centre]
        return Snapshot(
            time=time,
            step=step,
            position=p.position.copy(),
            velocity=p.velocity / flow.porosity[:, None],
            volume=p.volume.copy(),
            porosity=np.array(flow.porosity),
            pressure=rho * pressure,
            cell_pressure=self._whole(rho * flow.pressure),
            cell_fill=self._whole(flow.fill),
            cell_velocity=np.stack(velocity, axis=-1),
            cell_porosity=self._whole(flow.medium.porosity, air=1.0),
            eta=eta,
        )

    def _whole(self, values: FloatArray, air: float = 0.0) -> FloatArray:
        """A field on the cells of the flow as one on those of the tank, in a new array."""
        found = np.full(self.grid.shape, air)
        found[..., : values.shape[-1]] = values
        return found
