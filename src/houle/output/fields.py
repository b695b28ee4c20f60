"""fields.vtkhdf: particles and grid at each output time, readable at any moment of the run (structure: vtkhdf.py).

HDF5 cannot append safely: a process killed while it writes may leave a file that nobody opens. So frames are kept in
memory, compressed; `commit` puts them whole into a new file in the hidden folder `.fields` and replaces fields.vtkhdf
by an index of virtual datasets that point there (a few kilobytes); `close` packs everything into one real file by
copying the compressed chunks as they are, then removes the folder. The cost is linear in the number of frames.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import h5py
import numpy as np

from houle.frame import Frame
from houle.grid import FloatArray, Grid
from houle.output.atomic import OutputError, reported
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
)

NAME = "fields.vtkhdf"
MOST = 64e6  # bytes of compressed frames in memory


class FieldsWriter:
    """append(frame), commit(), close(); truncate_after(time) goes on with a folder of an earlier run."""

    def __init__(self, directory: Path, grid: Grid, attributes: Mapping[str, str]) -> None:
        self.path = Path(directory) / NAME
        self.parts = self.path.with_name(PARTS)
        self.grid, self.attributes = grid, dict(attributes)
        self.frames: list[Stored] = []  # on the disk, in parts
        self.pending: list[Stored] = []  # in memory, after them
        self._held, self._indexed = 0, 0  # bytes in memory; frames in fields.vtkhdf
        self._started = False

    def append(self, frame: Frame) -> None:
        """One more frame, float32 and compressed; too many in memory go to the disk."""
        self.pending.append(compress(frame))
        self._held += self.pending[-1].size
        if self._held > MOST:
            self._part()

    def commit(self) -> None:
        """fields.vtkhdf shows every frame, by reference."""
        if self.pending:
            self._part()
        if self._indexed != len(self.frames):
            self._index()

    def close(self) -> None:
        """fields.vtkhdf holds every frame and needs no other file. If there is no room, it goes on by reference."""
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

    def truncate_after(self, time: float) -> None:
        """Go on with the frames on disk that are not after `time` [s]; the later ones are forgotten."""
        self._started = True
        if _is_packed(self.path):
            shutil.rmtree(self.parts, ignore_errors=True)
            with reported(self.parts):
                self.parts.mkdir()
                _link(self.path, self._part_of(0))
        stored = self._stored()
        self.frames = [frame for frame in stored if frame.time <= time * (1 + 1e-12)]
        if self.frames:
            self._index()  # before the later ones go: the file must not point at what is not there
        with reported(self.parts):
            for path in {frame.path for frame in stored} - {frame.path for frame in self.frames}:
                path.unlink()

    def _part(self) -> None:
        """The frames in memory go to a file of their own. The first one of a new run clears what an older run left."""
        if not self._started:
            with reported(self.parts):
                shutil.rmtree(self.parts, ignore_errors=True)
            self._started = True
        path = self._part_of(len(self.frames))
        assemble(path, self.pending, self.grid, self.attributes, packed=True)
        self.frames += frames_in(path)
        self.pending, self._held = [], 0

    def _index(self) -> None:
        assemble(self.path, self.frames, self.grid, self.attributes, packed=False)
        self._indexed = len(self.frames)

    def _part_of(self, number: int) -> Path:
        """The part that begins with this frame."""
        return self.parts / f"{number:06d}.h5"

    def _stored(self) -> list[Stored]:
        """The frames of all parts. A run that was cut back left frames in a part that a later part holds again."""
        found: list[Stored] = []
        with reported(self.parts):
            for path in sorted(self.parts.glob("[!.]*.h5")):
                part = frames_in(path)
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

    def frame(self, i: int) -> Frame:
        """Frame i; negative i count from the end. eta comes from surface.nc, NaN when that file has no such time."""
        stored = self.stored[i]
        with reported(self.path), h5py.File(self.path) as file:
            values = read_values(file, stored, self.grid.dimension)
        return Frame(
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
        with h5py.File(path) as file:
            shape, spacing = tuple(map(int, file.attrs["shape"])), tuple(map(float, file.attrs["spacing"]))
        stored = tuple(frames_in(path))
    except (OSError, KeyError) as error:
        raise OutputError(path, str(error), "is this the folder of a run?", verb="read") from error
    grid = Grid(shape, spacing, (False,) * len(shape))
    return FieldsReader(path, grid, np.array([frame.time for frame in stored]), stored)


def _is_packed(path: Path) -> bool:
    if not path.exists():
        return False
    with reported(path), h5py.File(path) as file:
        return bool(file.attrs.get("packed", False))


def _link(source: Path, target: Path) -> None:
    """A second name for a file; a copy where the file system has no hard links."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)
