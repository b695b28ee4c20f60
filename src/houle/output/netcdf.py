"""netCDF-4 files as tables of variables over named dimensions, and tables that grow in time.

h5netcdf writes and reads them; xarray, on top of it, takes half a second to be imported: only who asks for a Dataset
pays for that.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5netcdf
import h5py
import numpy as np
from numpy.typing import NDArray

from houle.output.atomic import OutputError, Sink, replacing

if TYPE_CHECKING:
    import xarray

COMPRESSED = 1000  # values, from which on a variable is worth it
NOT_OF_A_RUN = "is this the folder of a run?"


@dataclass(frozen=True)
class Variable:
    """Values (numbers, or an object array of str) over named dimensions."""

    dims: tuple[str, ...]
    values: NDArray
    attrs: Mapping[str, str]


@dataclass(frozen=True)
class Table(Mapping[str, Variable]):
    """Variables and coordinates by name, read like an xarray.Dataset: table["eta"].values. A coordinate of the name of
    a dimension lies along it."""

    variables: Mapping[str, Variable]
    coordinates: Mapping[str, Variable]
    attrs: Mapping[str, str]

    def __getitem__(self, name: str) -> Variable:
        return self.coordinates[name] if name in self.coordinates else self.variables[name]

    def __iter__(self) -> Iterator[str]:
        return iter({**self.coordinates, **self.variables})

    def __len__(self) -> int:
        return len(self.coordinates) + len(self.variables)

    @property
    def sizes(self) -> dict[str, int]:
        """Length of each dimension."""
        return {d: n for v in self.values() for d, n in zip(v.dims, v.values.shape, strict=True)}


def write(path: Path, table: Table) -> None:
    """The whole file or nothing; every dimension has a coordinate. Missing values are NaN, coordinates have none."""
    sizes = table.sizes
    with replacing(path) as temporary, Sink(temporary) as sink, h5netcdf.File(sink, "w") as file:
        file.attrs.update(table.attrs)
        file.dimensions = sizes
        for name, variable in table.items():
            words, measured = variable.values.dtype == object, name in table.variables
            options: dict[str, Any] = {"fillvalue": np.nan} if measured else {}
            if variable.values.size > COMPRESSED:
                options |= {"compression": "gzip", "compression_opts": 1, "shuffle": True}
            kind = h5py.string_dtype() if words else variable.values.dtype
            stored = file.create_variable(name, variable.dims, kind, data=variable.values, **options)
            stored.attrs.update(variable.attrs)
            beside = {n for n, c in table.coordinates.items() if n not in sizes and set(c.dims) <= set(variable.dims)}
            if measured and beside:
                stored.attrs["coordinates"] = " ".join(sorted(beside))


def read(path: Path) -> Table:
    """A file of `write`, in memory and closed. OutputError when it cannot be read."""
    try:
        with h5netcdf.File(path, "r", decode_vlen_strings=True) as file:
            beside = {
                word for stored in file.variables.values() for word in stored.attrs.get("coordinates", "").split()
            }
            found = {name: _load(stored) for name, stored in file.variables.items()}
            attrs = dict(file.attrs)
    except (OSError, KeyError, RuntimeError) as error:
        raise OutputError(path, str(error), NOT_OF_A_RUN, verb="read") from error
    coordinates = {name: v for name, v in found.items() if name in v.dims or name in beside}
    return Table({name: v for name, v in found.items() if name not in coordinates}, coordinates, attrs)


def _load(stored: Any) -> Variable:
    attrs = {key: value for key, value in stored.attrs.items() if key not in ("coordinates", "_FillValue")}
    return Variable(stored.dimensions, stored[...], attrs)


def read_dataset(path: Path) -> xarray.Dataset:
    """The same as an xarray.Dataset."""
    import xarray

    try:
        return xarray.load_dataset(path, engine="h5netcdf", decode_times=False)
    except (OSError, ValueError, KeyError) as error:
        raise OutputError(path, str(error), NOT_OF_A_RUN, verb="read") from error


class Growing(ABC):
    """A table that grows by rows in time: all are kept (a run has some thousands), and written whole at each commit."""

    def __init__(self, path: Path, attributes: Mapping[str, str]) -> None:
        self.path, self.attributes = path, {"Conventions": "CF-1.11", **attributes}
        self.times: list[float] = []
        self.rows: list[Any] = []
        self._committed = -1

    @abstractmethod
    def table(self) -> Table:
        """All rows so far."""

    @abstractmethod
    def rows_of(self, stored: Table, count: int) -> list[Any]:
        """The first rows of a table, as they were appended."""

    def commit(self) -> None:
        """Everything appended is in the file."""
        if self._committed != len(self.rows):
            write(self.path, self.table())
            self._committed = len(self.rows)

    close = commit

    def truncate_after(self, time: float) -> None:
        """Go on with the rows of the file that are not after `time` [s]; the next commit drops the others."""
        stored = read(self.path)
        times = stored["time"].values
        keep = int(np.searchsorted(times, time * (1 + 1e-12), side="right"))
        self.times, self.rows = times[:keep].tolist(), self.rows_of(stored, keep)
        self._committed = -1
