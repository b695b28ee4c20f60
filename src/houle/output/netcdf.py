"""netCDF-4 files as tables of variables over named dimensions: written, appended to in time (growing.py), read.

h5netcdf writes and reads them. xarray is imported only for a Dataset: its import takes half a second.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5netcdf
import h5py
import numpy as np
from numpy.typing import NDArray

from houle import fields
from houle.output.atomic import DAMAGES, OutputError, Sink, told

if TYPE_CHECKING:
    import xarray

TIME = fields.TIME.name
PIECE = 1 << 20  # values that are copied at a time
CACHE = 1 << 20  # bytes of chunks of a variable that HDF5 keeps in memory, however long the file is
COMPRESSED = 1000  # values from which on a variable is compressed
NOT_OF_A_RUN = "is this the folder of a run?"


@dataclass(frozen=True)
class Variable:
    """Values (numbers, or an object array of str) over named dimensions, in memory or in an open file."""

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


def times(values: NDArray) -> Variable:
    """The coordinate of the rows of a table that grows: their times (N,) [s]."""
    return Variable((TIME,), values, fields.TIME.attributes(3))


def fill(path: Path, table: Table, grows: bool = False) -> None:
    """Writes a table to a new file, piece by piece: its values may lie in a file themselves.

    Every dimension has a coordinate. Missing values are NaN; coordinates have none.
    grows: rows can be appended in time; else large variables are compressed.
    """
    with Sink(path) as sink:
        with h5netcdf.File(sink, "w") as file:
            _describe(file, table, grows)
        # not with h5netcdf, which looks at all variables for the length of one that grows
        with h5py.File(sink, "r+", rdcc_nbytes=CACHE) as file:
            for name, variable in table.items():
                for piece in pieces(variable):
                    file[name][piece] = variable.values[piece]


def _describe(file: h5netcdf.File, table: Table, grows: bool) -> None:
    """Writes the names, dimensions, types and attributes of a table, without its values."""
    sizes = table.sizes
    file.attrs.update(table.attrs)
    file.dimensions = {name: None if grows and name == TIME else size for name, size in sizes.items()}
    if grows:
        file.resize_dimension(TIME, sizes[TIME])
    for name, variable in table.items():
        words, measured = variable.values.dtype == object, name in table.variables
        options: dict[str, Any] = {"fillvalue": np.nan} if measured else {}
        if grows and TIME in variable.dims:
            options["chunks"] = _chunk(variable)
        elif variable.values.size > COMPRESSED:
            options |= {"compression": "gzip", "compression_opts": 1, "shuffle": True}
        kind = h5py.string_dtype() if words else variable.values.dtype
        stored = file.create_variable(name, variable.dims, kind, **options)
        stored.attrs.update(variable.attrs)
        beside = {n for n, c in table.coordinates.items() if n not in sizes and set(c.dims) <= set(variable.dims)}
        if measured and beside:
            stored.attrs["coordinates"] = " ".join(sorted(beside))


def append(file: h5py.File, table: Table) -> None:
    """Writes the rows of the table behind those of a file that grows."""
    for name, variable in table.items():
        if TIME not in variable.dims:
            continue
        stored, axis = file[name], variable.dims.index(TIME)
        before = stored.shape[axis]
        stored.resize(before + variable.values.shape[axis], axis)
        stored[(slice(None),) * axis + (slice(before, None),)] = variable.values


def pieces(variable: Variable) -> Iterator[tuple[slice, ...]]:
    """Slices that cover a variable: stretches of time, one after the other, that take little memory."""
    shape = variable.values.shape
    if TIME not in variable.dims or variable.values.size <= PIECE:
        yield (slice(None),) * len(shape)
        return
    axis = variable.dims.index(TIME)
    step = max(1, PIECE * shape[axis] // variable.values.size)
    for begin in range(0, shape[axis], step):
        yield (slice(None),) * axis + (slice(begin, begin + step),)


def _chunk(variable: Variable) -> tuple[int, ...]:
    """Shape of a chunk of a variable that grows: of 32 k values, or of 1024 rows if that is less."""
    axis, shape = variable.dims.index(TIME), variable.values.shape
    others = max(1, variable.values.size // max(1, shape[axis]))
    rows = min(1024, max(1, 32 * 1024 // others))
    return (*shape[:axis], rows, *shape[axis + 1 :])


def read(path: Path) -> Table:
    """Reads a file that `fill` made into memory, and closes it. OutputError when it cannot be read."""
    try:
        with h5netcdf.File(path, "r", decode_vlen_strings=True) as file:
            beside = {
                word for stored in file.variables.values() for word in stored.attrs.get("coordinates", "").split()
            }
            found = {name: _load(stored) for name, stored in file.variables.items()}
            attrs = dict(file.attrs)
    except DAMAGES as error:
        raise OutputError(path, told(error), NOT_OF_A_RUN, verb="read") from error
    coordinates = {name: v for name, v in found.items() if name in v.dims or name in beside}
    return Table({name: v for name, v in found.items() if name not in coordinates}, coordinates, attrs)


def _load(stored: Any) -> Variable:
    attrs = {key: value for key, value in stored.attrs.items() if key not in ("coordinates", "_FillValue")}
    return Variable(stored.dimensions, stored[...], attrs)


def read_dataset(path: Path) -> xarray.Dataset:
    """Reads a file that `fill` made, as an xarray.Dataset. OutputError when it cannot be read."""
    import xarray

    try:
        return xarray.load_dataset(path, engine="h5netcdf", decode_times=False)
    except DAMAGES as error:
        raise OutputError(path, told(error), NOT_OF_A_RUN, verb="read") from error
