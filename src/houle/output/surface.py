"""surface.nc: level of the free surface over the plan at each output time, eta(time, x), in 3D eta(time, y, x)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from houle.flow.snapshot import ETA, Snapshot
from houle.grid import Grid
from houle.output import netcdf
from houle.output.growing import Growing
from houle.output.netcdf import TIME, Table, Variable, times

if TYPE_CHECKING:
    import xarray

NAME = "surface.nc"


class SurfaceWriter(Growing):
    """Appends profiles of the surface, the axes in plan turned round: x is the last one, as in other gridded data."""

    def __init__(self, directory: Path, grid: Grid, attributes: Mapping[str, str]) -> None:
        super().__init__(Path(directory) / NAME, attributes)
        self.grid = grid

    def append(self, frame: Snapshot) -> None:
        """Adds the profile of a frame."""
        self.add(frame.time, {ETA.name: np.asarray(frame.eta, dtype=float).T})

    @property
    def blank(self) -> dict[str, NDArray]:
        """A profile of zeros, with which the rows of a file are compared."""
        return {ETA.name: np.zeros(self.grid.shape[:-1]).T}

    def table_of(self, columns: Mapping[str, NDArray]) -> Table:
        d, plan = self.grid.dimension, ("y", "x")[3 - self.grid.dimension :]
        coordinates = {TIME: times(columns[TIME])}
        for axis, name in enumerate(plan[::-1]):
            attributes = {
                "units": "m",
                "long_name": f"position of cell centres along {name}",
                "axis": name.upper(),
            }
            coordinates[name] = Variable((name,), self.grid.axis_points(axis), attributes)
        variables = {ETA.name: Variable((TIME, *plan), columns[ETA.name], ETA.attributes(d))}
        return Table(variables, coordinates, self.attributes)


def read_surface(directory: Path) -> xarray.Dataset:
    """The profiles of a run, in memory. OutputError when there are none."""
    return netcdf.read_dataset(Path(directory) / NAME)


def surface_table(directory: Path) -> Table:
    """The profiles of a run as a Table, without xarray. OutputError when there are none."""
    return netcdf.read(Path(directory) / NAME)
