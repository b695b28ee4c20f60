"""series.nc: gauges, sensors and ledger against time, netCDF-4 with CF-1.11 attributes.

A row is a few hundred bytes and a run has some thousands of them: the writer keeps them all, and writes the whole file
at each commit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from houle.fields import Field, find
from houle.output.atomic import OutputError, Sink, replacing

NAME = "series.nc"
OBSERVED = {"eta": "gauge", "pressure": "sensor", "velocity": "sensor"}  # what is not a scalar of the ledger


class SeriesWriter:
    """gauges: (name, (x,) or (x, y)) each; sensors: (name, position) each; attributes: global ones of the file."""

    def __init__(
        self,
        directory: Path,
        gauges: Sequence[tuple[str, Sequence[float]]],
        sensors: Sequence[tuple[str, Sequence[float]]],
        dimension: int,
        attributes: Mapping[str, str],
    ) -> None:
        self.path = Path(directory) / NAME
        self.dimension, self.attributes = dimension, dict(attributes)
        self.gauges, self.sensors = list(gauges), list(sensors)
        self.times: list[float] = []
        self.rows: list[dict[str, NDArray]] = []
        self._committed = -1

    def append(self, time: float, sample: Mapping[str, Any]) -> None:
        """One row [s]: what Simulation.sample() returns. Every row has the same names, each in the table of fields."""
        row = {name: np.asarray(value, dtype=float) for name, value in sample.items()}
        for name in row if not self.rows else row.keys() ^ self.rows[0].keys():
            self._field(name)
            if self.rows:
                raise RuntimeError(f"internal error: {name!r} is not in every row of the series")
        self.times.append(float(time))
        self.rows.append(row)

    def dataset(self) -> xr.Dataset:
        """All rows so far."""
        names = self.rows[0] if self.rows else {}
        variables = {name: self._variable(name) for name in names if self._size(name) != 0}
        coordinates: dict[str, Any] = {"time": ("time", self.times, describe(find("time"), self.dimension))}
        coordinates |= _points("gauge", self.gauges) | _points("sensor", self.sensors)
        if "velocity" in variables:
            coordinates["axis"] = ("axis", list(axes(self.dimension)), {"long_name": "axis, z is up"})
        return xr.Dataset(variables, coordinates, {"Conventions": "CF-1.11", **self.attributes})

    def commit(self) -> None:
        """Everything appended is in the file."""
        if self._committed != len(self.rows):
            write_dataset(self.path, self.dataset())
            self._committed = len(self.rows)

    close = commit

    def truncate_after(self, time: float) -> None:
        """Go on with the rows of the file that are not after `time` [s]; the next commit drops the others."""
        stored = read_series(self.path.parent)
        keep = int(np.searchsorted(stored.time.values, time * (1 + 1e-12), side="right"))
        self.times = stored.time.values[:keep].tolist()
        names = [name for name in stored.data_vars if name not in OBSERVED]
        columns = {str(name): stored[name].values for name in names}
        columns |= {name: self._stored(stored, name) for name in OBSERVED}
        self.rows = [{name: np.asarray(column[i]) for name, column in columns.items()} for i in range(keep)]
        self._committed = -1

    def _stored(self, stored: xr.Dataset, name: str) -> NDArray:
        """(time, ...) values of an observation; it is not in the file when there is no gauge or no sensor."""
        if name in stored:
            return stored[name].transpose("time", ...).values
        return np.zeros((stored.sizes["time"], 0, self.dimension) if name == "velocity" else (stored.sizes["time"], 0))

    def _field(self, name: str) -> Field:
        return find(name, OBSERVED.get(name, "run"))  # type: ignore[arg-type]

    def _size(self, name: str) -> int:
        return int(self.rows[0][name].size)

    def _variable(self, name: str) -> tuple[tuple[str, ...], NDArray, dict[str, str]]:
        values = np.stack([row[name] for row in self.rows])
        attributes = describe(self._field(name), self.dimension)
        place = OBSERVED.get(name)
        if place is None:
            return ("time",), values, attributes
        tail = ("axis",) if name == "velocity" else ()
        return (place, "time", *tail), np.moveaxis(values, 0, 1), attributes


def axes(dimension: int) -> str:
    """Names of the axes: "xz" in 2D, "xyz" in 3D."""
    return "xz" if dimension == 2 else "xyz"


def describe(field: Field, dimension: int) -> dict[str, str]:
    """CF attributes of a field."""
    attributes = {"units": field.unit_in(dimension), "long_name": field.description, "symbol": field.symbol}
    return attributes | ({"standard_name": field.standard_name} if field.standard_name else {})


def write_dataset(path: Path, data: xr.Dataset) -> None:
    """netCDF-4, the whole file or nothing; missing values are NaN, coordinates have none."""
    beside = " ".join(str(name) for name in data.coords if name not in data.dims)
    with replacing(path) as temporary, Sink(temporary) as sink, h5netcdf.File(sink, "w") as file:
        file.dimensions = {str(name): size for name, size in data.sizes.items()}
        file.attrs.update(data.attrs)
        for name, variable in data.variables.items():
            words = variable.dtype.kind in "OU"
            options: dict[str, Any] = {} if words or name in data.coords else {"fillvalue": np.nan}
            if variable.size > 1000:
                options |= {"compression": "gzip", "compression_opts": 1, "shuffle": True}
            dtype = h5py.string_dtype() if words else variable.dtype
            values = variable.values.astype(object) if words else variable.values
            stored = file.create_variable(str(name), variable.dims, dtype, data=values, **options)
            stored.attrs.update(variable.attrs)
            if beside and name not in data.coords:
                stored.attrs["coordinates"] = beside


def read_series(directory: Path) -> xr.Dataset:
    """The series of a run, in memory. OutputError when there are none."""
    return read_dataset(Path(directory) / NAME)


def read_dataset(path: Path) -> xr.Dataset:
    """A netCDF file, in memory and closed."""
    try:
        return xr.load_dataset(path, engine="h5netcdf", decode_times=False)
    except (OSError, ValueError, KeyError) as error:
        raise OutputError(path, str(error), "is this the folder of a run?", verb="read") from error


def _points(dimension: str, points: Sequence[tuple[str, Sequence[float]]]) -> dict[str, Any]:
    """Coordinates gauge, gauge_x, ... of named points; gauges lie in plan (x or x, y), sensors in the full space."""
    if not points:
        return {}
    width = len(points[0][1])
    names = {1: "x", 2: "xy" if dimension == "gauge" else "xz", 3: "xyz"}[width]
    result: dict[str, Any] = {
        dimension: (dimension, [name for name, _ in points], {"long_name": f"name of the {dimension}"})
    }
    for a, axis in enumerate(names):
        attributes = {"units": "m", "long_name": f"{axis} of the {dimension}"}
        result[f"{dimension}_{axis}"] = (dimension, [float(at[a]) for _, at in points], attributes)
    return result
