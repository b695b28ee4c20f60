"""Snapshots of a run for the writers and the pictures: particles, cells, and the profile of the surface."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from houle.flow.snapshot import Snapshot
from houle.flow.state import Flow
from houle.grid import FloatArray, Grid
from houle.observe.levels import Columns
from houle.observe.points import at_points

WET = 1e-3  # fill of a cell [-], from which on its velocity means something


class Profile:
    """Level of the free surface [m] at the centres of all columns of cells, as gauges there would read it.

    It has no level where a solid stands on the floor up to the water; NaN there and where it is dry.
    """

    def __init__(self, flow: Flow) -> None:
        self.flow = flow

    def levels(self) -> FloatArray:
        """The levels [m] in the present flow, grid.shape[:-1], in a new array."""
        level, _, buried = self._columns.levels(self.flow)
        level[buried] = np.nan
        return level.reshape(self.flow.eta.shape)

    @cached_property
    def _columns(self) -> Columns:
        return Columns(self.flow, np.arange(self.flow.eta.size))


class Snapshots:
    """Takes snapshots of a flow on the grid of the whole tank: above the rows of cells that the flow keeps is air."""

    def __init__(self, flow: Flow, grid: Grid, density: float) -> None:
        self.flow, self.grid, self.density = flow, grid, density
        self.profile = Profile(flow)

    def take(self, step: int) -> Snapshot:
        """Everything the writers and the pictures need of the present flow, after so many steps, as copies."""
        flow, p, rho = self.flow, self.flow.particles, self.density
        pressure, _ = at_points(flow, p.position)
        centre = [0.5 * (np.delete(u, 0, axis=a) + np.delete(u, -1, axis=a)) for a, u in enumerate(flow.velocity)]
        velocity = [self._whole(np.where(flow.fill > WET, u, 0.0)) for u in centre]
        return Snapshot(
            time=flow.time,
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
            eta=self.profile.levels(),
        )

    def _whole(self, values: FloatArray, air: float = 0.0) -> FloatArray:
        """A field on the cells of the flow as one on those of the tank, in a new array."""
        found = np.full(self.grid.shape, air)
        found[..., : values.shape[-1]] = values
        return found
