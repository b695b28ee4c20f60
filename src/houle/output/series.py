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
from houle.output.growing import Growing
from houle.output.netcdf import TIME, Table, Variable

if TYPE_CHECKING:
    import xarray

NAME = "series.nc"
# What is not a scalar of the ledger, and where it is observed
OBSERVED = {"eta": "gauge", "pressure": "sensor", "velocity": "sensor"} | {
    field.name: place
    for place in ("runup", "overtopping", "flux", "phreatic", "structure", "paddle")
    for field in at(place)
}

Points = Sequence[tuple[str, Sequence[float]]]  # names and positions
Stations = Mapping[str, tuple[Sequence[str], Mapping[str, Sequence[float]]]]


class SeriesWriter(Growing):
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
        self._names: set[str] | None = None  # of every row

    def append(self, time: float, sample: Mapping[str, Any]) -> None:
        """One row [s]: what Simulation.sample() returns. Every row has the same names, each in the table of fields."""
        for name in sample if self._names is None else sample.keys() ^ self._names:
            self._field(name)
            if self._names is not None:
                raise RuntimeError(f"internal error: {name!r} is not in every row of the series")
        self._names = set(sample)
        self.add(time, sample)

    def table_of(self, columns: Mapping[str, NDArray]) -> Table:
        names = [name for name, values in columns.items() if name != TIME and values[0].size]
        variables = {name: self._variable(name, columns[name]) for name in names}
        times = Variable((TIME,), columns[TIME], describe(find(TIME), self.dimension))
        coordinates = {TIME: times, **_points("gauge", self.gauges), **_points("sensor", self.sensors)}
        coordinates |= {k: v for kind, entry in self.stations.items() for k, v in _stations(kind, *entry).items()}
        if any("axis" in v.dims for v in variables.values()):
            letters = np.array(list(axes(self.dimension)), dtype=object)
            coordinates["axis"] = Variable(("axis",), letters, {"long_name": "axis, z is up"})
        return Table(variables, coordinates, self.attributes)

    def _field(self, name: str) -> Field:
        return find(name, OBSERVED.get(name, "run"))  # type: ignore[arg-type]

    def _variable(self, name: str, values: NDArray) -> Variable:
        attributes = describe(self._field(name), self.dimension)
        place = OBSERVED.get(name)
        if place is None:
            return Variable((TIME,), values, attributes)
        tail = ("axis",) if values.ndim == 3 else ()
        return Variable((place, TIME, *tail), np.moveaxis(values, 0, 1), attributes)


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
