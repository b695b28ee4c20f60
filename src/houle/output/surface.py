"""surface.nc: level of the free surface over the plan at each output time, eta(time, x), in 3D eta(time, y, x)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from houle.fields import find
from houle.frame import Frame
from houle.grid import Grid
from houle.output.series import describe, read_dataset, write_dataset

NAME = "surface.nc"


class SurfaceWriter:
    """The profiles are kept and the whole file is written at each commit."""

    def __init__(self, directory: Path, grid: Grid, attributes: Mapping[str, str]) -> None:
        self.path = Path(directory) / NAME
        self.grid, self.attributes = grid, dict(attributes)
        self.times: list[float] = []
        self.rows: list[NDArray] = []
        self._committed = -1

    def append(self, frame: Frame) -> None:
        """One profile; plan axes are turned round, so that x is the last one as in other gridded data."""
        self.times.append(float(frame.time))
        self.rows.append(np.array(frame.eta, dtype=float).T)

    def dataset(self) -> xr.Dataset:
        """All profiles so far."""
        plan = ("y", "x") if self.grid.dimension == 3 else ("x",)
        shape = (len(self.rows), *self.grid.shape[:-1][::-1])
        eta = np.stack(self.rows) if self.rows else np.zeros(shape)
        coordinates: dict[str, Any] = {"time": ("time", self.times, describe(find("time"), self.grid.dimension))}
        for axis, name in enumerate(plan[::-1]):
            attributes = {"units": "m", "long_name": f"{name} of the cell centres", "axis": name.upper()}
            coordinates[name] = (name, self.grid.axis_points(axis), attributes)
        variables = {"eta": (("time", *plan), eta, describe(find("eta", "surface"), self.grid.dimension))}
        return xr.Dataset(variables, coordinates, {"Conventions": "CF-1.11", **self.attributes})

    def commit(self) -> None:
        """Everything appended is in the file."""
        if self._committed != len(self.rows):
            write_dataset(self.path, self.dataset())
            self._committed = len(self.rows)

    close = commit

    def truncate_after(self, time: float) -> None:
        """Go on with the profiles of the file that are not after `time` [s]."""
        stored = read_surface(self.path.parent)
        keep = int(np.searchsorted(stored.time.values, time * (1 + 1e-12), side="right"))
        self.times = stored.time.values[:keep].tolist()
        self.rows = list(stored.eta.values[:keep])
        self._committed = -1


def read_surface(directory: Path) -> xr.Dataset:
    """The profiles of a run, in memory. OutputError when there are none."""
    return read_dataset(Path(directory) / NAME)
