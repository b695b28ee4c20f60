"""series.nc: the values of all observers of a run against time, netCDF-4 with CF-1.11 attributes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from houle.fields import RUN, Field, Stations
from houle.grid import axes
from houle.output import netcdf
from houle.output.growing import Growing
from houle.output.netcdf import TIME, Table, Variable, times

if TYPE_CHECKING:
    import xarray

NAME = "series.nc"


class SeriesWriter(Growing):
    """Appends rows of samples; every name in them is a field of one of the stations.

    dimension   of the run, 2 or 3
    stations    where the values of each observer stand
    attributes  global ones of the file
    """

    def __init__(
        self, directory: Path, dimension: int, stations: Sequence[Stations], attributes: Mapping[str, str]
    ) -> None:
        super().__init__(Path(directory) / NAME, attributes)
        self.dimension, self.stations = dimension, list(stations)
        self.fields = {field.name: field for entry in stations for field in entry.fields}
        self._names: set[str] | None = None  # names in every row

    def append(self, time: float, sample: Mapping[str, Any]) -> None:
        """Adds the row of a time [s], a sample of Simulation.sample(). Every row has the same names."""
        for name in sample if self._names is None else sample.keys() ^ self._names:
            if name not in self.fields:
                raise RuntimeError(f"internal error: {name!r} is a field of no observer of this run")
            if self._names is not None:
                raise RuntimeError(f"internal error: {name!r} is not in every row of the series")
        self._names = set(sample)
        self.add(time, sample)

    def table_of(self, columns: Mapping[str, NDArray]) -> Table:
        variables = {name: self._variable(self.fields[name], v) for name, v in columns.items() if name != TIME}
        coordinates = {TIME: times(columns[TIME])}
        coordinates |= {k: v for entry in self.stations for k, v in _coordinates(entry).items()}
        if any("axis" in v.dims for v in variables.values()):
            letters = np.array(list(axes(self.dimension)), dtype=object)
            words = {"long_name": "axis of the components of a vector, z upwards"}
            coordinates["axis"] = Variable(("axis",), letters, words)
        return Table(variables, coordinates, self.attributes)

    def _variable(self, field: Field, values: NDArray) -> Variable:
        attributes = field.attributes(self.dimension)
        if field.place == RUN:
            return Variable((TIME,), values, attributes)
        tail = ("axis",) if values.ndim == 3 else ()
        return Variable((field.place, TIME, *tail), np.moveaxis(values, 0, 1), attributes)


def read_series(directory: Path) -> xarray.Dataset:
    """The series of a run, in memory. OutputError when there are none."""
    return netcdf.read_dataset(Path(directory) / NAME)


def series_table(directory: Path) -> Table:
    """The series of a run as a Table, without xarray. OutputError when there are none."""
    return netcdf.read(Path(directory) / NAME)


def _coordinates(stations: Stations) -> dict[str, Variable]:
    """The coordinates gauge, gauge_x, ... of stations along a dimension; none for values of the whole run."""
    kind = stations.dimension
    if kind == RUN:
        return {}
    names = np.array(stations.names, dtype=object)
    found = {kind: Variable((kind,), names, {"long_name": f"name of the {kind}"})}
    for word, (sentence, values) in stations.coordinates.items():
        found[f"{kind}_{word}"] = Variable((kind,), np.array(values, float), {"units": "m", "long_name": sentence})
    return found
