"""The structure of fields.vtkhdf: particles and grid over time in one file that ParaView >= 6.0 opens, with h5py alone.

VTKHDF 2.2 (docs.vtk.org, VTKHDF file format): a PartitionedDataSetCollection of two blocks with the same time steps,
`particles` (PolyData, a vertex per particle) and `grid` (ImageData with cell data). It is the one arrangement in
which a file holds both over time. Two turns are ours. A 2D run lies in the plane y = 0 and its grid is one cell thick
and stands behind the particles: readers drop an empty axis of an image only when it is the last. A file of one step
has no time axis in the image arrays: readers take such a file for a static one.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from houle.fields import Field, at, find
from houle.frame import Frame
from houle.grid import FloatArray, Grid
from houle.output.atomic import new_hdf5
from houle.output.series import describe

PARTS = ".fields"  # the folder beside the file, where the frames of an unfinished run lie
ROWS = (
    8192  # particles per compressed chunk; a frame starts at a multiple of it, so that chunks can be copied as they are
)
TOPOLOGIES = ("Vertices", "Lines", "Polygons", "Strips")
FILTERS: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
POINTS = "VTKHDF/particles/Points"
POINT_DATA = "VTKHDF/particles/PointData"
CELL_DATA = "VTKHDF/grid/CellData"
POINT_NAMES = tuple(field.name for field in at("particle") if field.name != "position")
CELL_NAMES = tuple(field.name for field in at("centre"))
ARRAYS = (POINTS, *(f"{POINT_DATA}/{name}" for name in POINT_NAMES), *(f"{CELL_DATA}/{name}" for name in CELL_NAMES))


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


def write_part(path: Path, frame: Frame) -> Stored:
    """One frame in a file of its own, float32 and compressed."""
    count = len(frame.volume)
    with new_hdf5(path) as file:
        file.attrs.update(time=frame.time, step=frame.step, count=count)
        for name, values in _arrays(frame).items():
            _create(file, name, values.shape, values.dtype, 1)[...] = values
    return Stored(path, float(frame.time), int(frame.step), count, rows=count)


def assemble(path: Path, frames: Sequence[Stored], grid: Grid, attributes: Mapping[str, Any], *, packed: bool) -> None:
    """The whole VTKHDF file: with the data (packed), or with virtual datasets that show it in the folder PARTS."""
    starts = _starts(frames)
    with new_hdf5(path) as file:
        file.attrs.update(attributes)
        file.attrs.update(packed=packed, shape=grid.shape, spacing=grid.spacing, step=[f.step for f in frames])
        root = file.create_group("VTKHDF", track_order=True)
        _mark(root, "PartitionedDataSetCollection")
        particles, cells = (root.create_group(name) for name in ("particles", "grid"))
        assembly = root.create_group("Assembly", track_order=True)
        for index, (name, block) in enumerate((("particles", particles), ("grid", cells))):
            block.attrs["Index"] = index
            assembly[name] = h5py.SoftLink(f"/VTKHDF/{name}")
            steps = block.create_group("Steps")
            steps.attrs["NSteps"] = len(frames)
            steps["Values"] = [frame.time for frame in frames]
        _mark(particles, "PolyData")
        _topology(particles, frames, starts)
        _mark(cells, "ImageData")
        _image(cells, grid)
        for name, (shape, dtype) in _kinds(frames[0], starts[-1], len(frames)).items():
            if packed:
                dataset = _create(file, name, shape, dtype, len(frames))
            else:
                dataset = _refer(file, name, shape, dtype, frames, starts)
            dataset.attrs.update(describe(_field(name), grid.dimension))
        if packed:
            _copy(file, frames, starts)


def read_values(file: h5py.File, stored: Stored, dimension: int) -> dict[str, FloatArray]:
    """Arrays of a frame by their name in the file, as float64 in the shapes of houle."""
    keep = [0, 2] if dimension == 2 else [0, 1, 2]
    result = {}
    for name in ARRAYS:
        dataset = file[name]
        if name.startswith(CELL_DATA):
            values = _from_image(dataset[stored.index if stored.steps > 1 else ...], dimension)
        else:
            values = dataset[stored.row : stored.row + stored.count]
        result[name] = (values[..., keep] if _field(name).vector else values).astype(float)
    return result


def frames_in(path: Path) -> list[Stored]:
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


def _field(name: str) -> Field:
    block, last = name.split("/")[1], name.split("/")[-1]
    return find("position" if last == "Points" else last, "particle" if block == "particles" else "centre")


def _arrays(frame: Frame) -> dict[str, NDArray[np.float32]]:
    """What a part holds: particles (N,) or (N, 3), cells (nz, ny, nx) or (nz, ny, nx, 3)."""
    result = {POINTS: _spatial(frame.position)}
    for name in POINT_NAMES:
        values = getattr(frame, name)
        result[f"{POINT_DATA}/{name}"] = _spatial(values) if values.ndim == 2 else values.astype(np.float32)
    dimension = frame.position.shape[1]
    for name in CELL_NAMES:
        values = getattr(frame, f"cell_{name}")
        values = _spatial(values) if values.ndim > dimension else values.astype(np.float32)
        result[f"{CELL_DATA}/{name}"] = _to_image(values, dimension)
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


def _from_image(values: NDArray, dimension: int) -> NDArray:
    """The inverse of _to_image."""
    turned = np.swapaxes(values, 0, 2)
    return np.ascontiguousarray(turned[:, 0] if dimension == 2 else turned)


def _create(file: h5py.File, name: str, shape: tuple[int, ...], dtype: np.dtype, steps: int) -> h5py.Dataset:
    """An empty compressed dataset. The chunks of a frame are the same bytes in a part and in the packed file."""
    if "/particles/" in name:
        chunks: tuple[int, ...] = (ROWS, *shape[1:])
        return file.create_dataset(name, shape, dtype, chunks=chunks, maxshape=(None, *shape[1:]), **FILTERS)
    cells = shape[1:] if steps > 1 else shape
    size = 256 if cells[1] == 1 else 64
    chunks = (*(min(n, size) for n in cells[:3]), *cells[3:])
    return file.create_dataset(name, shape, dtype, chunks=(1, *chunks) if steps > 1 else chunks, **FILTERS)


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
        for name in ARRAYS:
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
            for name in ARRAYS:
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
