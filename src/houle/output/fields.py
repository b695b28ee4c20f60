"""fields.vtkhdf: particles and grid at each output time, readable at any moment of the run (structure: vtkhdf.py).

HDF5 cannot append safely: a process killed while it writes may leave a file that nobody opens. So frames are kept in
memory, compressed; `commit` puts them whole into a new file in the hidden folder `.fields` and replaces fields.vtkhdf
by an index of virtual datasets that point there (a few kilobytes); `close` packs everything into one real file by
copying the compressed chunks as they are, then removes the folder. The cost of an index grows with the number of
frames, so that of a long run is written less often. `read_fields` finds the frames that it does not show yet.
"""

from __future__ import annotations

import os
import shutil
import time as clock
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from numbers import Integral
from pathlib import Path

import h5py
import numpy as np

from houle.errors import CaseError
from houle.flow.snapshot import Snapshot
from houle.grid import FloatArray, Grid
from houle.output.atomic import DAMAGES, OutputError, put_aside, regular, remove, reported, told
from houle.output.child import NO_END, in_child
from houle.output.netcdf import Table
from houle.output.surface import surface_table
from houle.output.vtkhdf import (
    CELL_DATA,
    PARTS,
    POINT_DATA,
    POINTS,
    Stored,
    assemble,
    compress,
    frames_in,
    read_values,
    which_are_whole,
)

NAME = "fields.vtkhdf"
PACKED, INDEX = "packed", "index"  # the two forms of fields.vtkhdf
SHARE = 20.0  # pause between two indices of a run, over the time that writing one takes
MOST = 64e6  # bytes of compressed frames in memory


class NoFrameError(CaseError, IndexError):
    """A frame was asked for that is not there."""


class FieldsWriter:
    """Writes fields.vtkhdf: append(frame), commit(), close(); truncate_after(time) goes on with an earlier stretch."""

    def __init__(self, directory: Path, grid: Grid, attributes: Mapping[str, str]) -> None:
        self.path = Path(directory) / NAME
        self.parts = self.path.with_name(PARTS)
        self.grid, self.attributes = grid, dict(attributes)
        self.frames: list[Stored] = []  # frames on the disk, in parts
        self.pending: list[Stored] = []  # later frames, in memory
        self._bytes, self._indexed = 0, 0  # bytes in memory; frames that the index shows
        self._due = 0.0  # time at which a new index may be written
        self._started = False

    def append(self, frame: Snapshot) -> None:
        """Adds a frame, float32 and compressed; when there are many in memory they go to the disk."""
        self.pending.append(compress(frame))
        self._bytes += self.pending[-1].size
        if self._bytes > MOST:
            self._part()

    def commit(self) -> None:
        """Brings every frame to the disk. The index shows them at once, or later if writing it takes long."""
        if self.pending:
            self._part()
        begin = clock.monotonic()
        if self._indexed != len(self.frames) and begin >= self._due:
            self._index()
            end = clock.monotonic()
            self._due = end + SHARE * (end - begin)

    def close(self) -> None:
        """Packs every frame into fields.vtkhdf, which then needs no other file. On a full disk the index stays."""
        if not self.pending and not self.parts.exists():
            return
        frames = [*self.frames, *self.pending]
        try:
            assemble(self.path, frames, self.grid, self.attributes, packed=True)
        except OutputError:
            self.commit()
            raise
        self.frames, self.pending = frames_in(self.path), []
        shutil.rmtree(self.parts, ignore_errors=True)

    def truncate_after(self, time: float, wanted: Sequence[float] = (), hashes: Collection[str] = ()) -> list[str]:
        """Goes on with the frames on the disk that are not after `time` [s]; later ones are removed.

        wanted: times of the frames that should be there; hashes: those of the cases whose files they may be.
        Returns in words what is lost.
        """
        self._started = True
        problems = self._unpack()
        stored, damaged = self._stored(hashes)
        self.frames = [frame for frame in stored if frame.time <= time * (1 + 1e-12)]
        if self.frames:
            self._index()  # before the later ones go: the file must not point at what is not there
        else:
            remove(self.path)
        if self.parts.exists():
            with reported(self.parts):
                for path in set(self.parts.glob("*")) - {frame.path for frame in self.frames}:
                    path.unlink()
        there = np.array([frame.time for frame in self.frames])
        lost = sum(not np.isclose(there, t, rtol=1e-9, atol=1e-12).any() for t in wanted if t <= time * (1 + 1e-12))
        if not lost:
            return []
        reason = "; ".join([*problems, *damaged]) or "is not there"
        return [f"{NAME} {reason}: {lost} of its frames up to t = {time:.4g} s are lost"]

    def _unpack(self) -> list[str]:
        """Makes a packed file the first part. A damaged one is renamed; returns in words what is wrong with it."""
        found = in_child(lambda: _look(self.path), self.path) if self.path.exists() else INDEX
        if found == INDEX:
            return []
        if found != PACKED:
            if self.parts.exists():
                return []  # an index, then; the frames are there
            put_aside(self.path)
            return [found or NO_END]
        shutil.rmtree(self.parts, ignore_errors=True)
        with reported(self.parts):
            self.parts.mkdir()
            _link(self.path, self._part_of(0))
        return []

    def _part(self) -> None:
        """Writes the frames in memory to a part of their own. The first of a new run removes those of an older one."""
        if not self._started:
            with reported(self.parts):
                shutil.rmtree(self.parts, ignore_errors=True)
            self._started = True
        path = self._part_of(len(self.frames))
        assemble(path, self.pending, self.grid, self.attributes, packed=True)
        self.frames += frames_in(path)
        self.pending, self._bytes = [], 0

    def _index(self) -> None:
        """Writes the index of all frames on the disk."""
        assemble(self.path, self.frames, self.grid, self.attributes, packed=False)
        self._indexed = len(self.frames)

    def _part_of(self, number: int) -> Path:
        """Path of the part that begins with the frame of this number."""
        return self.parts / f"{number:06d}.h5"

    def _stored(self, hashes: Collection[str]) -> tuple[list[Stored], list[str]]:
        """The whole frames of all parts, and in words what is wrong with other parts."""
        found, problems = [], []
        for path in _parts(self.parts):
            try:
                found.append(_whole(path, self.grid, hashes))
            except ValueError as error:
                problems.append(str(error))
        return _in_order(found), list(dict.fromkeys(problems))


def _parts(folder: Path) -> list[Path]:
    return sorted(folder.glob("[!.]*.h5"))


def _since(time: float, parts: Sequence[Path]) -> list[Stored]:
    """The frames of the parts that begin after a time [s]: fields.vtkhdf does not show them yet."""
    later: list[list[Stored]] = []
    for part in map(frames_in, reversed(parts)):
        if part[0].time <= time:
            break
        later.append(part)
    return [frame for part in reversed(later) for frame in part]


def _in_order(parts: Sequence[list[Stored]]) -> list[Stored]:
    """The frames of all parts in the order of time: of frames that a later part holds again, the later ones."""
    found: list[Stored] = []
    for part in parts:
        if part:
            found = [frame for frame in found if frame.time < part[0].time] + part
    return found


@dataclass(frozen=True)
class FieldsReader:
    """The frames of a run: times [s], and frame(i) as float64 in the shapes of houle, packed or not."""

    path: Path
    grid: Grid
    times: FloatArray
    stored: tuple[Stored, ...]

    def __len__(self) -> int:
        return len(self.times)

    def nearest(self, time: float) -> int:
        """Index of the frame nearest to a time [s]."""
        return int(np.argmin(np.abs(self.times - time)))

    def frame(self, i: int) -> Snapshot:
        """Snapshot i; negative i count from the end. eta comes from surface.nc, NaN when that file has no such time."""
        count = len(self.stored)
        if not isinstance(i, Integral) or isinstance(i, bool) or not -count <= i < count:
            raise NoFrameError(
                f"frame({i!r}): {self.path} holds frames 0 to {count - 1} (or -{count} to -1, from the end); "
                "nearest(time) is the number of that nearest to a time [s]"
            )
        stored = self.stored[int(i)]
        try:
            with h5py.File(stored.path) as file:
                values = read_values(file, stored, self.grid.dimension)
        except DAMAGES as error:
            raise OutputError(stored.path, f"frame {i} is damaged ({told(error)})", verb="read") from error
        return Snapshot(
            time=stored.time,
            step=stored.step,
            position=values[POINTS],
            velocity=values[f"{POINT_DATA}/velocity"],
            volume=values[f"{POINT_DATA}/volume"],
            porosity=values[f"{POINT_DATA}/porosity"],
            pressure=values[f"{POINT_DATA}/pressure"],
            cell_pressure=values[f"{CELL_DATA}/pressure"],
            cell_fill=values[f"{CELL_DATA}/fill"],
            cell_velocity=values[f"{CELL_DATA}/velocity"],
            cell_porosity=values[f"{CELL_DATA}/porosity"],
            eta=self._eta(stored.time),
        )

    @cached_property
    def _surface(self) -> Table | None:
        try:
            return surface_table(self.path.parent)
        except OutputError:
            return None

    def _eta(self, time: float) -> FloatArray:
        """The profile of surface.nc at a time, NaN when there is none."""
        if self._surface is not None:
            near = np.flatnonzero(np.isclose(self._surface["time"].values, time, rtol=1e-12, atol=1e-12))
            if near.size:
                return self._surface["eta"].values[near[0]].T
        return self.grid.cells(np.nan)[..., 0]


def read_fields(directory: Path) -> FieldsReader:
    """The frames of a run, finished or not. OutputError when there are none."""
    path = Path(directory) / NAME
    try:
        with h5py.File(regular(path)) as file:
            shape, spacing = tuple(map(int, file.attrs["shape"])), tuple(map(float, file.attrs["spacing"]))
            parts = [] if file.attrs["packed"] else _parts(path.with_name(PARTS))
        stored = frames_in(path)
        stored += _since(stored[-1].time, parts)
        grid = Grid(shape, spacing, (False,) * len(shape))
    except DAMAGES as error:
        raise OutputError(path, told(error), "is this the folder of a run?", verb="read") from error
    return FieldsReader(path, grid, np.array([frame.time for frame in stored]), tuple(stored))


def _look(path: Path) -> str:
    """PACKED or INDEX, the form of a file, or in words what is wrong with it."""
    try:
        with h5py.File(regular(path)) as file:
            return PACKED if file.attrs["packed"] else INDEX
    except DAMAGES as error:
        return f"is damaged ({told(error)})"


def _whole(path: Path, grid: Grid, hashes: Collection[str]) -> list[Stored]:
    """The frames of a part that are whole. Raises ValueError, in words, where nothing of it can be relied on."""

    def look() -> str:
        try:
            return "".join("01"[whole] for whole in which_are_whole(path, grid, hashes))
        except DAMAGES as error:
            return f"is damaged ({told(error)})"

    found = in_child(look, path)
    if found is None or found.strip("01"):
        raise ValueError(found or NO_END)
    return [frame for frame, whole in zip(frames_in(path), found, strict=True) if whole == "1"]


def _link(source: Path, target: Path) -> None:
    """A second name for a file; a copy where the file system has no hard links."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)
