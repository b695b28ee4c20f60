"""netCDF-4 files as tables of variables over named dimensions, and tables that grow in time.

A netCDF-4 file is an HDF5 file whose coordinates are dimension scales (NetCDF User's Guide, appendix "File format
specifications"): h5py writes it in a fifth of the time that h5netcdf takes. xarray takes half a second to be imported:
only who asks for a Dataset pays for that.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
from numpy.typing import NDArray

from houle.output.atomic import OutputError, Sink, replacing

if TYPE_CHECKING:
    import xarray

COMPRESSED = 1000  # values, from which on a variable is worth it
OF_THE_FORMAT = (
    "CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "_Netcdf4Coordinates", "_Netcdf4Dimid", "_FillValue",
    "coordinates",
)  # fmt: skip
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
    number = {dimension: i for i, dimension in enumerate(sizes)}
    with replacing(path) as temporary, Sink(temporary) as sink, h5py.File(sink, "w", track_order=True) as file:
        file.attrs.update(table.attrs)
        file.attrs["_NCProperties"] = np.bytes_(f"version=2,h5py={h5py.__version__},hdf5={h5py.version.hdf5_version}")
        stored = {name: _store(file, name, variable, name in table.variables) for name, variable in table.items()}
        for dimension in sizes:
            stored[dimension].make_scale(dimension)
        for name, variable in table.items():
            numbers = np.array([number[dimension] for dimension in variable.dims], np.int32)
            stored[name].attrs.update(_Netcdf4Coordinates=numbers, _Netcdf4Dimid=numbers[0])
            for i, dimension in enumerate(variable.dims if name not in sizes else ()):
                stored[name].dims[i].attach_scale(stored[dimension])
            beside = {n for n, c in table.coordinates.items() if n not in sizes and set(c.dims) <= set(variable.dims)}
            if name in table.variables and beside:
                stored[name].attrs["coordinates"] = " ".join(sorted(beside))


def _store(file: h5py.File, name: str, variable: Variable, measured: bool) -> h5py.Dataset:
    """The values and what they mean; measured ones may be missing."""
    values = variable.values
    options: dict[str, Any] = {"fillvalue": np.nan} if measured else {}
    if values.size > COMPRESSED:
        options |= {"compression": "gzip", "compression_opts": 1, "shuffle": True}
    kind = h5py.string_dtype() if values.dtype == object else values.dtype
    stored = file.create_dataset(name, values.shape, kind, values, track_order=True, **options)
    stored.attrs.update({"_FillValue": np.array([np.nan]), **variable.attrs} if measured else variable.attrs)
    return stored


def read(path: Path) -> Table:
    """A file of `write`, in memory and closed. OutputError when it cannot be read."""
    try:
        with h5py.File(path, "r") as file:
            scales = {number: name for name, stored in file.items() if (number := _scale(stored)) is not None}
            beside = {word for stored in file.values() for word in stored.attrs.get("coordinates", "").split()}
            found = {name: _load(stored, scales) for name, stored in file.items()}
            attrs = {key: value for key, value in file.attrs.items() if key != "_NCProperties"}
    except (OSError, KeyError, RuntimeError) as error:
        raise OutputError(path, str(error), NOT_OF_A_RUN, verb="read") from error
    coordinates = {name: v for name, v in found.items() if name in v.dims or name in beside}
    return Table({name: v for name, v in found.items() if name not in coordinates}, coordinates, attrs)


def _scale(stored: h5py.Dataset) -> int | None:
    """The number of the dimension that a coordinate lies along; None of all else."""
    return int(stored.attrs["_Netcdf4Dimid"]) if "CLASS" in stored.attrs else None


def _load(stored: h5py.Dataset, scales: Mapping[int, str]) -> Variable:
    dimensions = tuple(scales[number] for number in stored.attrs["_Netcdf4Coordinates"])
    values = stored.asstr()[...] if h5py.check_string_dtype(stored.dtype) else stored[...]
    return Variable(dimensions, values, {k: v for k, v in stored.attrs.items() if k not in OF_THE_FORMAT})


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
