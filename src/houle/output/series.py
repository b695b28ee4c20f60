"""series.nc: gauges, sensors and ledger against time, netCDF-4 with CF-1.11 attributes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from houle.fields import Field, at, find
from houle.grid import axes
from houle.output import netcdf
from houle.output.netcdf import Table, Variable

if TYPE_CHECKING:
    import xarray

NAME = "series.nc"
# What is not a scalar of the ledger, and where it is observed
OBSERVED = {"eta": "gauge", "pressure": "sensor", "velocity": "sensor"} | {
    field.name: place
    for place in ("runup", "overtopping", "flux", "phreatic", "structure", "paddle")
    for field in at(place)
}
ALWAYS = ("gauge", "sensor")  # their values are in every row, if only as empty arrays

Row = dict[str, NDArray]
Points = Sequence[tuple[str, Sequence[float]]]  # names and positions
Stations = Mapping[str, tuple[Sequence[str], Mapping[str, Sequence[float]]]]


class SeriesWriter(netcdf.Growing):
    """gauges: (name, (x,) or (x, y)) each; sensors: (name, position) each; attributes: global ones of the file;
    stations: names and coordinates [m] of what else is observed, by dimension (`houle.observe.stations`)."""

    def __init__(
        self,
        directory: Path,
        gauges: Points,
        sensors: Points,
        dimension: int,
        attributes: Mapping[str, str],
        stations: Stations | None = None,
    ) -> None:
        super().__init__(Path(directory) / NAME, attributes)
        self.dimension, self.gauges, self.sensors = dimension, list(gauges), list(sensors)
        self.stations = stations or {}

    def append(self, time: float, sample: Mapping[str, Any]) -> None:
        """One row [s]: what Simulation.sample() returns. Every row has the same names, each in the table of fields."""
        row = {name: np.asarray(value, dtype=float) for name, value in sample.items()}
        for name in row if not self.rows else row.keys() ^ self.rows[0].keys():
            self._field(name)
            if self.rows:
                raise RuntimeError(f"internal error: {name!r} is not in every row of the series")
        self.times.append(float(time))
        self.rows.append(row)

    def table(self) -> Table:
        names = self.rows[0] if self.rows else {}
        variables = {name: self._variable(name) for name in names if names[name].size}
        times = Variable(("time",), np.array(self.times), describe(find("time"), self.dimension))
        coordinates = {"time": times, **_points("gauge", self.gauges), **_points("sensor", self.sensors)}
        coordinates |= {k: v for kind, entry in self.stations.items() for k, v in _stations(kind, *entry).items()}
        if any("axis" in v.dims for v in variables.values()):
            letters = np.array(list(axes(self.dimension)), dtype=object)
            coordinates["axis"] = Variable(("axis",), letters, {"long_name": "axis, z is up"})
        return Table(variables, coordinates, self.attributes)

    def rows_of(self, stored: Table, count: int) -> list[Row]:
        columns = {name: v.values for name, v in stored.variables.items() if name not in OBSERVED}
        columns |= {n: self._observed(stored, n) for n, p in OBSERVED.items() if n in stored or p in ALWAYS}
        return [{name: np.asarray(column[i]) for name, column in columns.items()} for i in range(count)]

    def _observed(self, stored: Table, name: str) -> NDArray:
        """(time, ...) values of an observation; it is not in the file when there is no gauge or no sensor."""
        if name in stored:
            return np.moveaxis(stored[name].values, 1, 0)
        rows = len(stored["time"].values)
        return np.zeros((rows, 0, self.dimension) if name == "velocity" else (rows, 0))

    def _field(self, name: str) -> Field:
        return find(name, OBSERVED.get(name, "run"))  # type: ignore[arg-type]

    def _variable(self, name: str) -> Variable:
        values = np.array([row[name] for row in self.rows])
        attributes = describe(self._field(name), self.dimension)
        place = OBSERVED.get(name)
        if place is None:
            return Variable(("time",), values, attributes)
        tail = ("axis",) if values.ndim == 3 else ()
        return Variable((place, "time", *tail), np.moveaxis(values, 0, 1), attributes)


def describe(field: Field, dimension: int) -> dict[str, str]:
    """CF attributes of a field."""
    attributes = {"units": field.unit_in(dimension), "long_name": field.description, "symbol": field.symbol}
    return attributes | ({"standard_name": field.standard_name} if field.standard_name else {})


def read_series(directory: Path) -> xarray.Dataset:
    """The series of a run, in memory. OutputError when there are none."""
    return netcdf.read_dataset(Path(directory) / NAME)


def series_table(directory: Path) -> Table:
    """The same without xarray."""
    return netcdf.read(Path(directory) / NAME)


def _points(kind: str, points: Points) -> dict[str, Variable]:
    """Coordinates gauge, gauge_x, ... of named points; gauges lie in plan (x or x, y), sensors in the full space."""
    if not points:
        return {}
    names = {1: "x", 2: "xy" if kind == "gauge" else "xz", 3: "xyz"}[len(points[0][1])]
    words = np.array([name for name, _ in points], dtype=object)
    result = {kind: Variable((kind,), words, {"long_name": f"name of the {kind}"})}
    for a, axis in enumerate(names):
        attributes = {"units": "m", "long_name": f"{axis} of the {kind}"}
        result[f"{kind}_{axis}"] = Variable((kind,), np.array([float(at[a]) for _, at in points]), attributes)
    return result


def _stations(kind: str, names: Sequence[str], coordinates: Mapping[str, Sequence[float]]) -> dict[str, Variable]:
    """Coordinates runup, runup_from, ... of what is observed along a dimension."""
    result = {kind: Variable((kind,), np.array(names, dtype=object), {"long_name": f"name of the {kind}"})}
    for word, values in coordinates.items():
        attributes = {"units": "m", "long_name": f"{word.replace('_', ' ')} of the {kind}"}
        result[f"{kind}_{word}"] = Variable((kind,), np.array(values, dtype=float), attributes)
    return result
