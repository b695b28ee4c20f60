"""Tables that grow in time, in a file that is whole at every moment and never written anew (docs/decisions/0006).

Two files take turns. The one under the name is whole, and nobody writes to it. The other, hidden beside it, gets the
rows of the last two commits, then takes the name; the former becomes the hidden one, a commit behind. So the rows of a
commit are written twice and no others, and a file that a kill leaves half-written is still hidden. `close` packs all
into the compressed file that stays.
"""

from __future__ import annotations

import contextlib
import os
import shutil
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from houle.output.atomic import DAMAGES, Sink, put_aside, regular, remove, replacing, reported, told
from houle.output.child import NO_END, in_child
from houle.output.lock import TAKEN, lock
from houle.output.netcdf import CACHE, TIME, Table, Variable, append, fill, pieces

OF_THE_FORMAT = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "coordinates")  # attributes of netCDF
BUFFER = 16e6  # bytes of rows in memory, from which on they go to the file


class Rows:
    """Rows in memory: an array for each name, its first axis that of the rows."""

    def __init__(self) -> None:
        self.count, self._row, self._columns = 0, 0, dict[str, NDArray]()

    def add(self, row: Mapping[str, Any]) -> None:
        """Adds a row of numbers and arrays. Every row has the same names and shapes."""
        if not self._columns:
            self._columns = {name: np.empty((64, *np.shape(value))) for name, value in row.items()}
            self._row = sum(values[0].nbytes for values in self._columns.values())
        if self.count == len(next(iter(self._columns.values()))):
            self._columns = {name: np.concatenate([c, np.empty_like(c)]) for name, c in self._columns.items()}
        for name, value in row.items():
            column = self._columns[name]
            if getattr(value, "shape", ()) != column.shape[1:]:
                raise RuntimeError(f"internal error: {name!r} has another shape than in the rows before")
            column[self.count] = value
        self.count += 1

    @property
    def columns(self) -> dict[str, NDArray]:
        """The rows so far: an array (count, ...) for each name."""
        return {name: values[: self.count] for name, values in self._columns.items()}

    @property
    def size(self) -> int:
        """Bytes of the rows so far."""
        return self.count * self._row


class Growing(ABC):
    """A table that grows by rows in time: append, commit, close; truncate_after goes on with what a file holds."""

    def __init__(self, path: Path, attributes: Mapping[str, str]) -> None:
        self.path, self.attributes = path, {"Conventions": "CF-1.11", **attributes}
        self.hidden = path.with_name(f".{path.stem}.next{path.suffix}")
        self._fresh, self._behind = Rows(), Rows()  # rows in no file yet; rows in the file that the hidden one lacks
        self._begun = False  # the file under the name is of this run
        self._hidden = False  # so is the hidden one
        self._grows = False  # the file under the name has not been packed

    @abstractmethod
    def table_of(self, columns: Mapping[str, NDArray]) -> Table:
        """The rows as a table, from columns[TIME] and the values that `add` was given, along a first axis of time."""

    def add(self, time: float, row: Mapping[str, Any]) -> None:
        """Adds the row of a time [s]; when there are many in memory they go to the file."""
        self._fresh.add({**row, TIME: float(time)})
        if self._fresh.size > BUFFER:
            self.commit()

    def commit(self) -> None:
        """Brings everything appended into the file."""
        if not self._fresh.count:
            return
        with reported(self.path):
            try:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self._grow()
                self._take_the_name()
            except BaseException:
                self._forget_hidden()
                raise
        self._behind, self._fresh, self._begun, self._grows = self._fresh, Rows(), True, True

    def close(self) -> None:
        """Commits, and packs the rows into the file that stays."""
        self.commit()
        if self._begun and self._grows:
            with replacing(self.path) as temporary, _opened(self.path) as source:
                fill(temporary, _table_in(source))
            self._grows = False
        self._forget_hidden()

    def truncate_after(
        self, time: float, like: Mapping[str, Any] | None = None, hashes: Collection[str] = ()
    ) -> list[str]:
        """Goes on with the rows of the file that are not after `time` [s]. Returns in words what is lost.

        like: a row as it will be appended; hashes: those of the cases whose file it may be. A file that does not fit
        gets another name.
        """
        self._forget_hidden()
        self._fresh, self._behind, self._begun, self._grows = Rows(), Rows(), False, True
        problem = self._problem(like, hashes)
        if problem is not None:
            put_aside(self.path)
            return [f"{self.path.name} {problem}: its rows up to t = {time:.4g} s are lost"]
        with _opened(self.path) as source:
            keep = _count_until(source, time)
            last = float(source[TIME][keep - 1]) if keep else -np.inf
        if keep:
            with replacing(self.path) as temporary, _opened(self.path) as source:
                fill(temporary, replace(_table_in(source, keep), attrs=self.attributes), grows=True)
        self._begun = keep > 0
        if last >= time - 1e-9 * abs(time):
            return []
        return [
            f"{self.path.name} ends at t = {max(last, 0.0):.4g} s: its rows from there to t = {time:.4g} s are lost"
        ]

    # ---- the two files -------------------------------------------------------------------------------------------

    def _grow(self) -> None:
        """Brings all rows into the hidden file: it gets those that it lacks, or is made anew."""
        if not self._begun:
            fill(self.hidden, self.table_of(self._fresh.columns), grows=True)
            return
        more = [self._behind, self._fresh]
        if not (self._hidden and self.hidden.exists()):
            self._copy()
            more = [self._fresh]
        with contextlib.ExitStack() as stack:
            if not stack.enter_context(_alone(self.hidden)):  # somebody has it open since it had the name
                self._copy()
                more = [self._fresh]
            with Sink(self.hidden, "r+b") as sink, h5py.File(sink, "r+", rdcc_nbytes=CACHE) as file:
                for rows in more:
                    if rows.count:
                        append(file, self.table_of(rows.columns))

    def _copy(self) -> None:
        """Makes the hidden file a copy of the one under the name, in the form that grows."""
        remove(self.hidden)
        if self._grows:
            shutil.copyfile(self.path, self.hidden)
        else:
            with _opened(self.path) as source:
                fill(self.hidden, _table_in(source), grows=True)

    def _take_the_name(self) -> None:
        """The hidden file takes the name; the former file becomes the hidden one, if it can be kept."""
        former = self.path.with_name(f".{self.path.stem}.former{self.path.suffix}")
        remove(former)
        kept = self._begun and self._grows
        if kept:
            try:
                os.link(self.path, former)
            except OSError:  # a file system without hard links
                kept = False
        os.replace(self.hidden, self.path)
        if kept:
            os.replace(former, self.hidden)
        self._hidden = kept

    def _forget_hidden(self) -> None:
        self._hidden = False
        with contextlib.suppress(OSError):
            self.hidden.unlink()

    # ---- what lies there -----------------------------------------------------------------------------------------

    def _problem(self, like: Mapping[str, Any] | None, hashes: Collection[str]) -> str | None:
        """The reason why no rows can be added to the file; None if there is none."""
        if not self.path.exists():
            return "is not there"
        wanted = None if like is None else self.table_of(_as_columns(like))
        found = in_child(lambda: self._look(wanted, hashes), self.path)
        return NO_END if found is None else found or None

    def _look(self, wanted: Table | None, hashes: Collection[str]) -> str:
        """The reason why no rows can be added to the file; "" if there is none. It reads every number."""
        try:
            with _opened(self.path) as source:
                found = _table_in(source)
                times = source[TIME][...]
                if not (np.isfinite(times).all() and (np.diff(times) > 0).all()):
                    return "is damaged (its times do not increase)"
                if hashes and found.attrs.get("case_hash") not in hashes:
                    return "is that of another case"
                if wanted is not None and not _same(found, wanted):
                    return "does not hold what this case observes"
                for variable in found.values():
                    for piece in pieces(variable):
                        variable.values[piece]
        except DAMAGES as error:
            return f"is damaged ({told(error)})"
        return ""


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[h5py.File]:
    with h5py.File(regular(path), "r", rdcc_nbytes=CACHE) as file:
        yield file


def _table_in(source: h5py.File, keep: int | None = None) -> Table:
    """The table of a file, its first rows if `keep` says how many; what grows is left in the file."""
    found = {name: _variable_in(stored, keep) for name, stored in source.items()}
    beside = {word for stored in source.values() for word in stored.attrs.get("coordinates", "").split()}
    coordinates = {name: v for name, v in found.items() if name in v.dims or name in beside}
    return Table({name: v for name, v in found.items() if name not in coordinates}, coordinates, _attributes(source))


def _variable_in(stored: h5py.Dataset, keep: int | None) -> Variable:
    name = stored.name.lstrip("/")
    dims = (name,) if stored.is_scale else tuple(d[0].name.lstrip("/") for d in stored.dims)
    words = h5py.check_string_dtype(stored.dtype) is not None
    values: Any = stored.asstr()[...] if words else _First(stored, dims, keep) if TIME in dims else stored[...]
    return Variable(dims, values, _attributes(stored))


def _attributes(node: Any) -> dict[str, Any]:
    """The attributes of a file or variable, without those that netCDF and HDF5 keep for themselves."""
    return {key: value for key, value in node.attrs.items() if not (key in OF_THE_FORMAT or key.startswith("_"))}


class _First:
    """The first rows of a variable in an open file, read like an array."""

    def __init__(self, stored: h5py.Dataset, dims: Sequence[str], keep: int | None) -> None:
        self.stored, self.axis = stored, dims.index(TIME)
        self.dtype = stored.dtype
        self.shape = tuple(n if d != TIME or keep is None else keep for d, n in zip(dims, stored.shape, strict=True))
        self.size = int(np.prod(self.shape, dtype=float))

    def __getitem__(self, piece: tuple[slice, ...]) -> NDArray:
        begin, end, _ = piece[self.axis].indices(self.shape[self.axis])
        return self.stored[(*piece[: self.axis], slice(begin, end), *piece[self.axis + 1 :])]


def _count_until(source: h5py.File, time: float) -> int:
    return int(np.searchsorted(source[TIME][...], time * (1 + 1e-12), side="right"))


def _as_columns(row: Mapping[str, Any]) -> dict[str, NDArray]:
    return {TIME: np.zeros(1), **{name: np.asarray(value, float)[None] for name, value in row.items()}}


def _same(found: Table, wanted: Table) -> bool:
    """True if both hold the same names over the same dimensions, apart from time, and the same places."""
    if set(found) != set(wanted):
        return False
    for name in wanted:
        one, other = found[name], wanted[name]
        if one.dims != other.dims:
            return False
        shapes = [[n for d, n in zip(v.dims, v.values.shape, strict=True) if d != TIME] for v in (one, other)]
        if shapes[0] != shapes[1] or (TIME not in one.dims and not np.array_equal(one.values, other.values)):
            return False
    return True


@contextlib.contextmanager
def _alone(path: Path) -> Iterator[bool]:
    """Yields True if nobody else has the file: HDF5 locks what it reads, and no backup has given it a second name."""
    with open(path, "r+b", buffering=0) as file:
        try:
            lock(file)
            alone = os.fstat(file.fileno()).st_nlink == 1
        except OSError as error:
            alone = error.errno not in TAKEN
        yield alone
