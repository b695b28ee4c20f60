"""[[sensor]]: pressure and Darcy velocity at points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from houle.fields import Field, Stations
from houle.flow.observer import Instrument, Now, Observer, Remark, Sample, Site, along, outside
from houle.flow.state import Flow
from houle.grid import FloatArray, axes
from houle.medium.plate_sides import behind_plates, on_their_side
from houle.observe.levels import around
from houle.observe.points import cell_below, still_gravity, velocity_at


@dataclass(frozen=True)
class Sensor(Instrument):
    """A sensor at a point [m], the last number upwards."""

    name: str
    at: tuple[float, ...]

    def check(self, site: Site) -> Iterator[Remark]:
        """The sensor stands in the tank and in no solid."""
        for axis, value in enumerate(self.at):
            yield from outside(site, "at", value, axis)
        if inside := [name for name, solid in site.solid.items() if solid.distance(np.array(self.at)) < 0]:
            yield Remark("error", "at", f"= {list(self.at)} lies in solid.{inside[0]}: move it into the water")

    @property
    def highest(self) -> float:
        return self.at[-1]


class Sensors(Observer[Sensor]):
    """Pressure and Darcy velocity at fixed points (N, d), up to the very floor, wall or free surface.

    The pressure beyond that of water at rest, p/rho - g.x, is interpolated linearly: it has no gradient towards a fixed
    wall, and goes on above the last cell of the water to the surface. A dry sensor reads 0.
    One on a thin plate reads the water on its side (`houle.medium.plate_sides`).
    """

    table = "sensor"
    instrument = Sensor
    fields = (
        Field(
            "pressure",
            "p",
            "Pa",
            "sensor",
            "pressure of the water above that of the air, inside a porous body that of the water in its pores",
            instant="pressure",
        ),
        Field(
            "velocity",
            "u_d",
            "m s-1",
            "sensor",
            "Darcy velocity: flow rate of the water over the whole area, pores and grains",
            vector=True,
            instant="velocity",
        ),
    )

    def __init__(self, instruments: Sequence[Sensor], site: Site, flow: Flow) -> None:
        grid, g = flow.grid, still_gravity(flow)
        points = np.array([sensor.at for sensor in instruments], float)
        self.density = site.density
        self.seen = on_their_side(grid, flow.medium.solids, points)
        self.cell, self.weight = around(self.seen, grid)
        open_ = flow.medium.open_cells.ravel()[self.cell] > 0.0
        hidden = behind_plates(
            grid, flow.medium.solids, self.seen, grid.points().reshape(-1, grid.dimension)[self.cell]
        )
        self.weight = np.where(open_ & ~hidden, self.weight, 0.0)
        self.below = cell_below(self.cell, grid)
        rest = (grid.points() @ g).ravel()
        self.rest, self.rest_here, self.rest_below = points @ g, rest[self.cell], rest[self.below]
        self.moved = self.seen @ g - self.rest

    @classmethod
    def stations(cls, instruments: Sequence[Sensor], site: Site) -> Stations:
        places = along("sensor", [sensor.at for sensor in instruments], axes(site.grid.dimension))
        return Stations([sensor.name for sensor in instruments], places, cls.fields)

    def sample(self, now: Now) -> Sample:
        return {"pressure": self.density * self.pressure(now.flow), "velocity": velocity_at(now.flow, self.seen)}

    def pressure(self, flow: Flow) -> FloatArray:
        """Kinematic pressure p/rho (N,) [m2/s2] in the present flow."""
        p = flow.pressure.ravel()
        here, below = p[self.cell], p[self.below]
        wet = here != 0.0
        beyond = np.where(wet, here - self.rest_here, below - self.rest_below)
        weight = np.where(wet | (below != 0.0), self.weight, 0.0)
        total = weight.sum(axis=1)
        found = (weight * beyond).sum(axis=1) / np.where(total > 0.0, total, 1.0) + self.rest
        at_surface = (~wet & (self.weight > 0.0)).any(axis=1) | (found + self.moved >= 0.0)  # no suction there
        return np.where(total > 0.0, np.where(at_surface, np.maximum(found, 0.0), found), 0.0)
