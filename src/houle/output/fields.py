"""fields.vtkhdf: particles and grid at each output time, one file that ParaView >= 5.13 opens, written with h5py alone.

Structure (VTKHDF 2.2, docs.vtk.org): a PartitionedDataSetCollection of two blocks with the same time steps, `particles`
(PolyData, a vertex per particle) and `grid` (ImageData with cell data). It is the one arrangement in which a file holds
both over time. Two turns are ours. A 2D run lies in the plane y = 0 and its grid is one cell thick and stands behind
the particles: readers drop an empty axis of an image only when it is the last. A file of one step has no time axis in
the image arrays: readers take such a file for a static one.

HDF5 cannot append safely: a process killed while it writes may leave a file that nobody opens. So each frame goes whole
into a small file of its own in the hidden folder `.fields`; `commit` replaces fields.vtkhdf by an index of virtual
datasets that point there (a few kilobytes); `close` packs everything into one real file by copying the compressed
chunks as they are, then removes the folder. Cost is linear in the number of frames, and the file can be opened at any time.
"""

from __future__ import annotations

import itertools
import os
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from houle.fields import Field, at, find
from houle.frame import Frame
from houle.grid import FloatArray, Grid
from houle.output.atomic import OutputError, replacing, reported
from houle.output.series import describe

NAME = "fields.vtkhdf"
PARTS = ".fields"
ROWS = (
    8192  # particles per compressed chunk; a frame starts at a multiple of it, so that chunks can be copied as they are
)
TOPOLOGIES = ("Vertices", "Lines", "Polygons", "Strips")
FILTERS = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


@dataclass(frozen=True)
class Stored:
    """Where a frame lies: a file of so many `steps` and `rows` of particles; its own row, count and step in there."""

    path: Path
    time: float
    step: int
    count: int
    row: int = 0
    index: int = 0
    rows: int = 0
    steps: int = 1


class FieldsWriter:
    """append(frame), commit(), close(); truncate_after(time) goes on with a folder of an earlier run."""

    def __init__(self, directory: Path, grid: Grid, attributes: Mapping[str, str]) -> None:
        self.path = Path(directory) / NAME
        self.parts = self.path.with_name(PARTS)
        self.grid, self.attributes = grid, dict(attributes)
        self.frames: list[Stored] = []
        self._dirty = self._started = False

    def append(self, frame: Frame) -> None:
        """Store one frame, float32 and compressed. The first one of a new run clears what an older run left."""
        if not self._started:
            with reported(self.parts):
                shutil.rmtree(self.parts, ignore_errors=True)
            self._started = True
        target = self.parts / f"{len(self.frames):06d}.h5"
        with replacing(target) as temporary, h5py.File(temporary, "w") as file:
            file.attrs.update(time=frame.time, step=frame.step, count=len(frame.volume))
            for name, values in _arrays(frame).items():
                _create(file, name, values.shape, values.dtype, 1)[...] = values
        self.frames.append(
            Stored(target, float(frame.time), int(frame.step), len(frame.volume), rows=len(frame.volume))
        )
        self._dirty = True

    def commit(self) -> None:
        """fields.vtkhdf shows every frame, by reference."""
        if self._dirty:
            self._assemble(packed=False)
            self._dirty = False

    def close(self) -> None:
        """fields.vtkhdf holds every frame and needs no other file."""
        if self.frames and self.parts.exists():
            self._assemble(packed=True)
            shutil.rmtree(self.parts, ignore_errors=True)
        self._dirty = False

    def truncate_after(self, time: float) -> None:
        """Go on with the frames on disk that are not after `time` [s]; the later ones are forgotten."""
        self._started = True
        if _is_packed(self.path):
            shutil.rmtree(self.parts, ignore_errors=True)
            with reported(self.parts):
                self.parts.mkdir()
                _link(self.path, self.parts / "packed.h5")
        with reported(self.parts):
            stored = sorted(
                itertools.chain.from_iterable(map(_frames_in, self.parts.glob("*.h5"))), key=lambda f: f.time
            )
        self.frames = [frame for frame in stored if frame.time <= time * (1 + 1e-12)]
        kept = {frame.path for frame in self.frames}
        for path in {frame.path for frame in stored} - kept:
            path.unlink()
        self._dirty = True

    def _assemble(self, packed: bool) -> None:
        frames, starts = self.frames, _starts(self.frames)
        with replacing(self.path) as temporary, h5py.File(temporary, "w") as file:
            file.attrs.update(self.attributes)
            file.attrs.update(
                packed=packed, shape=self.grid.shape, spacing=self.grid.spacing, step=[f.step for f in frames]
            )
            root = file.create_group("VTKHDF", track_order=True)
            _mark(root, "PartitionedDataSetCollection")
            particles, grid = (root.create_group(name) for name in ("particles", "grid"))
            assembly = root.create_group("Assembly", track_order=True)
            for index, (name, block) in enumerate((("particles", particles), ("grid", grid))):
                block.attrs["Index"] = index
                assembly[name] = h5py.SoftLink(f"/VTKHDF/{name}")
                steps = block.create_group("Steps")
                steps.attrs["NSteps"] = len(frames)
                steps["Values"] = [frame.time for frame in frames]
            _mark(particles, "PolyData")
            _topology(particles, frames, starts)
            _mark(grid, "ImageData")
            _image(grid, self.grid)
            for name, (shape, dtype) in _kinds(frames[0], starts[-1], len(frames)).items():
                if packed:
                    dataset = _create(file, name, shape, dtype, len(frames))
                else:
                    dataset = _refer(file, name, shape, dtype, frames, starts)
                dataset.attrs.update(describe(_field(name), self.grid.dimension))
            if packed:
                _copy(file, frames, starts)


@dataclass(frozen=True)
class FieldsReader:
    """The frames of a run: times [s], and frame(i) as float64 in the shapes of houle, whichever way the file is built."""

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
        at_ = self.stored[i]
        with reported(self.path), h5py.File(self.path) as file:
            block = file["VTKHDF"]
            particle = {name: _rows(block["particles"], name, at_) for name in ("Points", *_point_names())}
            cell = {name: _image_at(block["grid/CellData"][name], at_) for name in _cell_names()}
        keep = [0, 2] if self.grid.dimension == 2 else [0, 1, 2]
        turned = {name: _from_image(values, self.grid.dimension, keep) for name, values in cell.items()}
        return Frame(
            time=at_.time,
            step=at_.step,
            position=particle["Points"][:, keep],
            velocity=particle["velocity"][:, keep],
            volume=particle["volume"],
            porosity=particle["porosity"],
            pressure=particle["pressure"],
            cell_pressure=turned["pressure"],
            cell_fill=turned["fill"],
            cell_velocity=turned["velocity"],
            cell_porosity=turned["porosity"],
            eta=_eta(self.path.parent, at_.time, self.grid),
        )


def read_fields(directory: Path) -> FieldsReader:
    """The frames of a run, finished or not. OutputError when there are none."""
    path = Path(directory) / NAME
    try:
        with h5py.File(path) as file:
            shape, spacing = tuple(map(int, file.attrs["shape"])), tuple(map(float, file.attrs["spacing"]))
        stored = tuple(_frames_in(path))
    except (OSError, KeyError) as error:
        raise OutputError(path, str(error), "is this the folder of a run?", verb="read") from error
    grid = Grid(shape, spacing, (False,) * len(shape))
    return FieldsReader(path, grid, np.array([frame.time for frame in stored]), stored)


# ---- arrays


def _point_names() -> tuple[str, ...]:
    return tuple(field.name for field in at("particle") if field.name != "position")


def _cell_names() -> tuple[str, ...]:
    return tuple(sorted({field.name for field in at("centre")}))


def _names() -> list[str]:
    """Datasets of a part, named by their place in the assembled file."""
    points = [f"VTKHDF/particles/PointData/{name}" for name in _point_names()]
    return ["VTKHDF/particles/Points", *points, *(f"VTKHDF/grid/CellData/{name}" for name in _cell_names())]


def _field(name: str) -> Field:
    block, last = name.split("/")[1], name.split("/")[-1]
    return find("position" if last == "Points" else last, "particle" if block == "particles" else "centre")


def _arrays(frame: Frame) -> dict[str, NDArray[np.float32]]:
    """What a part holds: particles (N,) or (N, 3), cells (nz, ny, nx) or (nz, ny, nx, 3)."""
    result = {"VTKHDF/particles/Points": _spatial(frame.position)}
    for name in _point_names():
        values = getattr(frame, name)
        result[f"VTKHDF/particles/PointData/{name}"] = (
            _spatial(values) if values.ndim == 2 else values.astype(np.float32)
        )
    dimension = frame.position.shape[1]
    for name in _cell_names():
        values = getattr(frame, f"cell_{name}")
        values = _spatial(values) if values.ndim > dimension else values.astype(np.float32)
        result[f"VTKHDF/grid/CellData/{name}"] = _to_image(values, dimension)
    return result


def _spatial(vectors: FloatArray) -> NDArray[np.float32]:
    """Vectors (..., 2) or (..., 3) as (..., 3): a 2D run lies in the plane y = 0."""
    full = np.zeros((*vectors.shape[:-1], 3), np.float32)
    full[..., [0, 2] if vectors.shape[-1] == 2 else [0, 1, 2]] = vectors
    return full


def _to_image(values: NDArray, dimension: int) -> NDArray:
    """Cell field (nx, [ny,] nz, ...) as the image wants it, (nz, ny, nx, ...)."""
    if dimension == 2:
        values = values[:, None]
    return np.ascontiguousarray(np.swapaxes(values, 0, 2))


def _from_image(values: NDArray, dimension: int, keep: Sequence[int]) -> FloatArray:
    turned = np.swapaxes(values, 0, 2)
    turned = turned[:, 0] if dimension == 2 else turned
    return np.ascontiguousarray(turned[..., keep] if turned.ndim > dimension else turned)


def _create(file: h5py.File, name: str, shape: tuple[int, ...], dtype: np.dtype, steps: int) -> h5py.Dataset:
    """An empty compressed dataset. The chunks of a frame are the same bytes in a part and in the packed file."""
    if "/particles/" in name:
        chunks: tuple[int, ...] = (ROWS, *shape[1:])
        return file.create_dataset(name, shape, dtype, chunks=chunks, maxshape=(None, *shape[1:]), **FILTERS)
    cells = shape[1:] if steps > 1 else shape
    size = 256 if cells[1] == 1 else 64
    chunks = (*(min(n, size) for n in cells[:3]), *cells[3:])
    return file.create_dataset(name, shape, dtype, chunks=(1, *chunks) if steps > 1 else chunks, **FILTERS)


# ---- the VTKHDF file


def _mark(group: h5py.Group, kind: str) -> None:
    group.attrs["Version"] = (2, 2)
    group.attrs.create("Type", kind.encode("ascii"), dtype=h5py.string_dtype("ascii", len(kind)))


def _starts(frames: Sequence[Stored]) -> list[int]:
    """Row of the first particle of each frame, and the number of rows: multiples of ROWS."""
    return [0, *itertools.accumulate(-(-max(frame.count, 1) // ROWS) * ROWS for frame in frames)]


def _topology(block: h5py.Group, frames: Sequence[Stored], starts: Sequence[int]) -> None:
    """A vertex for each particle; the other kinds of cells are empty, with the single offset 0 that each step needs."""
    counts = np.array([frame.count for frame in frames], np.int64)
    total = len(frames)
    before = np.concatenate([[0], np.cumsum(counts)[:-1]])
    block["NumberOfPoints"] = counts
    steps = block["Steps"]
    steps["PartOffsets"] = np.arange(total)
    steps["NumberOfParts"] = np.ones(total, np.int64)
    steps["PointOffsets"] = np.array(starts[:-1], np.int64)
    steps["CellOffsets"] = np.outer(before, [1, 0, 0, 0])
    steps["ConnectivityIdOffsets"] = np.zeros((total, 4), np.int64)  # every step reads the same 0, 1, 2, ...
    ids = np.arange(counts.max(initial=0) + 1, dtype=np.int64)
    for name in TOPOLOGIES:
        kind = block.create_group(name)
        cells = counts if name == "Vertices" else 0 * counts
        kind["NumberOfCells"] = kind["NumberOfConnectivityIds"] = cells
        offsets = kind.create_dataset(
            "Offsets", (int(cells.sum()) + total,), np.int64, chunks=(ROWS,), maxshape=(None,), **FILTERS
        )
        for first, count in zip(itertools.accumulate(cells + 1, initial=0), cells, strict=False):
            offsets[first : first + count + 1] = ids[: count + 1]
        kind.create_dataset(
            "Connectivity", data=ids[: cells.max(initial=0)], chunks=(ROWS,), maxshape=(None,), **FILTERS
        )


def _image(block: h5py.Group, grid: Grid) -> None:
    nx, *ny, nz = grid.shape
    flat = grid.dimension == 2
    block.attrs["WholeExtent"] = np.array([0, nx, 0, 1 if flat else ny[0], 0, nz], np.int64)
    block.attrs["Spacing"] = np.array((grid.spacing[0], grid.spacing[0], grid.spacing[1]) if flat else grid.spacing)
    block.attrs["Origin"] = np.array([0.0, 0.5 * grid.spacing[0] if flat else 0.0, 0.0])
    block.attrs["Direction"] = np.eye(3).ravel()


def _kinds(first: Stored, rows: int, steps: int) -> dict[str, tuple[tuple[int, ...], np.dtype]]:
    """Shape and type of each assembled array, from those in a source."""
    kinds = {}
    with h5py.File(first.path) as source:
        for name in _names():
            shape = source[name].shape
            if "/particles/" in name:
                kinds[name] = ((rows, *shape[1:]), source[name].dtype)
            else:
                cells = shape[1:] if first.steps > 1 else shape
                kinds[name] = ((steps, *cells) if steps > 1 else cells, source[name].dtype)
    return kinds


def _refer(
    file: h5py.File, name: str, shape: tuple[int, ...], dtype: np.dtype, frames: Sequence[Stored], starts: Sequence[int]
) -> h5py.Dataset:
    """A virtual dataset that shows the frames where they lie."""
    layout = h5py.VirtualLayout(shape, dtype)
    cells = shape[1:] if len(frames) > 1 else shape
    for i, frame in enumerate(frames):
        there = f"{PARTS}/{frame.path.name}"
        if "/particles/" in name:
            source = h5py.VirtualSource(there, name, (frame.rows, *shape[1:]), dtype)
            layout[starts[i] : starts[i] + frame.count] = source[frame.row : frame.row + frame.count]
        else:
            source = h5py.VirtualSource(there, name, (frame.steps, *cells) if frame.steps > 1 else cells, dtype)
            layout[i if len(frames) > 1 else ...] = source[frame.index if frame.steps > 1 else ...]
    return file.create_virtual_dataset(name, layout)


def _copy(file: h5py.File, frames: Sequence[Stored], starts: Sequence[int]) -> None:
    """Fill the packed file with the compressed chunks of the frames, as they are."""
    for i, frame in enumerate(frames):
        with h5py.File(frame.path) as source:
            for name in _names():
                there, here = source[name].id, file[name].id
                for k in range(there.get_num_chunks()):
                    offset = there.get_chunk_info(k).chunk_offset
                    if (target := _moved(offset, name, frame, starts[i], i if len(frames) > 1 else None)) is not None:
                        mask, data = there.read_direct_chunk(offset)
                        here.write_direct_chunk(target, data, mask)


def _moved(offset: tuple[int, ...], name: str, frame: Stored, start: int, index: int | None) -> tuple[int, ...] | None:
    """Where a chunk of a source goes in the packed file; None when it is of another frame."""
    if "/particles/" in name:
        mine = frame.row <= offset[0] < frame.row + frame.count
        return (offset[0] - frame.row + start, *offset[1:]) if mine else None
    if frame.steps > 1:
        if offset[0] != frame.index:
            return None
        offset = offset[1:]
    return offset if index is None else (index, *offset)


# ---- reading back


def _frames_in(path: Path) -> list[Stored]:
    """The frames of a part, or of an assembled file."""
    with h5py.File(path) as file:
        if "count" in file.attrs:
            time, step, count = (file.attrs[key] for key in ("time", "step", "count"))
            return [Stored(path, float(time), int(step), int(count), rows=int(count))]
        particles = file["VTKHDF/particles"]
        columns = (
            particles["Steps/Values"],
            file.attrs["step"],
            particles["NumberOfPoints"],
            particles["Steps/PointOffsets"],
        )
        table = list(zip(*(column[...] for column in columns), strict=True))
        rows = len(particles["Points"])
        return [
            Stored(path, float(t), int(s), int(n), int(o), i, rows, len(table)) for i, (t, s, n, o) in enumerate(table)
        ]


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


def _rows(block: h5py.Group, name: str, stored: Stored) -> FloatArray:
    dataset = block[name if name == "Points" else f"PointData/{name}"]
    return dataset[stored.row : stored.row + stored.count].astype(float)


def _image_at(dataset: h5py.Dataset, stored: Stored) -> FloatArray:
    return dataset[stored.index if stored.steps > 1 else ...].astype(float)


def _eta(directory: Path, time: float, grid: Grid) -> FloatArray:
    from houle.output.surface import NAME as SURFACE
    from houle.output.surface import read_surface

    eta = grid.cells(np.nan)[..., 0]
    if (directory / SURFACE).exists():
        surface = read_surface(directory)
        near = np.flatnonzero(np.isclose(surface.time.values, time, rtol=1e-12, atol=1e-12))
        if near.size:
            eta = surface.eta.values[near[0]].T
    return eta
