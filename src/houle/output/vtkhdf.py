"""The structure of fields.vtkhdf: particles and grid over time in one file that ParaView >= 6.0 opens, with h5py alone.

VTKHDF 2.2 (docs.vtk.org, VTKHDF file format): a PartitionedDataSetCollection of two blocks with the same time steps,
`particles` (PolyData, a vertex per particle) and `grid` (ImageData with cell data). It is the one arrangement in
which a file holds both over time. Two details are ours. A 2D run lies in the plane y = 0 and its grid is one cell thick
and stands behind the particles: readers drop an empty axis of an image only when it is the last. A file of one step
has no time axis in the image arrays: readers take such a file for a static one.
"""

from __future__ import annotations

import contextlib
import itertools
import zlib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from houle.flow.snapshot import CELLS, PARTICLES, Snapshot
from houle.grid import FloatArray, Grid
from houle.output.atomic import DAMAGES, new_hdf5, regular

PARTS = ".fields"  # the folder beside the file, where the frames of an unfinished run lie
PIECE = 1 << 20  # numbers that are written at a time
MOST_PACKED = 1100  # bytes of which deflate can make one, at most
ROWS = 8192  # particles per compressed chunk; a frame starts at a multiple of it: its chunks can be copied as they are
TOPOLOGIES = ("Vertices", "Lines", "Polygons", "Strips")
FILTERS: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
POINTS = "VTKHDF/particles/Points"
POINT_DATA = "VTKHDF/particles/PointData"
CELL_DATA = "VTKHDF/grid/CellData"
Kind = tuple[tuple[int, ...], np.dtype]
FIELDS = {POINTS if field.name == "position" else f"{POINT_DATA}/{field.name}": field for field in PARTICLES} | {
    f"{CELL_DATA}/{field.name}": field for field in CELLS
}
ARRAYS = tuple(FIELDS)

Chunks = list[tuple[tuple[int, ...], bytes]]  # the first indices of each chunk in its array, and its compressed bytes


@dataclass(frozen=True)
class Stored:
    """A frame in memory, or its place in a file.

    path    the file; time [s] and step of the run, count of particles
    row     first row of its particles in the file, of `rows`     index  its number in the file, of `steps`
    kinds   in memory: shape and type of each array               chunks  in memory: its chunks
    """

    path: Path
    time: float
    step: int
    count: int
    row: int = 0
    index: int = 0
    rows: int = 0
    steps: int = 1
    kinds: Mapping[str, Kind] | None = None
    chunks: Mapping[str, Chunks] | None = None

    @property
    def size(self) -> int:
        """Bytes in memory."""
        return sum(len(data) for chunks in (self.chunks or {}).values() for _, data in chunks)


def compress(frame: Snapshot) -> Stored:
    """One frame in memory, float32 and compressed."""
    arrays, count = _arrays(frame), len(frame.volume)
    kinds = {name: (values.shape, values.dtype) for name, values in arrays.items()}
    chunks = {name: _compressed(name, values) for name, values in arrays.items()}
    return Stored(Path(), float(frame.time), int(frame.step), count, rows=count, kinds=kinds, chunks=chunks)


def _compressed(name: str, values: NDArray[np.float32]) -> Chunks:
    """The chunks as HDF5 stores them: full size, bytes shuffled, deflated.

    Only runs of equal bytes are packed (Z_RLE): numbers have few other repetitions, and this is twice as fast as the
    search for them, for a tenth more bytes.
    """
    shape = _chunk(name, values.shape, 1)
    found = []
    for place in _places(name, values.shape):
        part = values[tuple(slice(i, i + c) for i, c in zip(place, shape, strict=True))]
        if part.shape != shape:
            part = np.pad(part, [(0, c - n) for n, c in zip(part.shape, shape, strict=True)])
        shuffled = np.ascontiguousarray(part).reshape(-1).view(np.uint8).reshape(-1, part.itemsize).T
        deflate = zlib.compressobj(1, strategy=zlib.Z_RLE)
        found.append((place, deflate.compress(np.ascontiguousarray(shuffled).data) + deflate.flush()))
    return found


def assemble(path: Path, frames: Sequence[Stored], grid: Grid, attributes: Mapping[str, Any], *, packed: bool) -> None:
    """Writes the whole VTKHDF file, with the data (packed) or with virtual datasets that point into PARTS."""
    starts = _starts(frames)
    with new_hdf5(path) as file:
        file.attrs.update(attributes)
        file.attrs.update(packed=packed, shape=grid.shape, spacing=grid.spacing)
        file["step"] = np.array([frame.step for frame in frames], np.int64)  # an attribute could not hold so many
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
                dataset = _refer(file, name, (shape, dtype), frames, starts)
            dataset.attrs.update(FIELDS[name].attributes(grid.dimension))
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
        result[name] = (values[..., keep] if FIELDS[name].vector else values).astype(float)
    return result


def frames_in(path: Path) -> list[Stored]:
    """The frames of an assembled file."""
    with h5py.File(regular(path)) as file:
        particles = file["VTKHDF/particles"]
        columns = (
            particles["Steps/Values"],
            file["step"] if "step" in file else file.attrs["step"],
            particles["NumberOfPoints"],
            particles["Steps/PointOffsets"],
        )
        table = list(zip(*(column[...] for column in columns), strict=True))
        rows = len(particles["Points"])
        return [
            Stored(path, float(t), int(s), int(n), int(o), i, rows, len(table)) for i, (t, s, n, o) in enumerate(table)
        ]


def which_are_whole(path: Path, grid: Grid, hashes: Collection[str] = ()) -> list[bool]:
    """True for each frame of an assembled file on this grid that can be read from the first number to the last.

    hashes: those of the cases whose file it may be. Raises one of DAMAGES where nothing of the file can be relied on.
    """
    frames = frames_in(path)
    with h5py.File(path) as file:
        if tuple(file.attrs["shape"]) != grid.shape or (hashes and file.attrs["case_hash"] not in hashes):
            raise ValueError("it is that of another case")
        for name in ARRAYS:
            _check_shape(file[name], name, grid, frames)
        if not np.all(np.diff([frame.time for frame in frames]) > 0):
            raise ValueError("its times do not increase")
        return [_is_whole(file, frame, grid) for frame in frames]


def _check_shape(dataset: h5py.Dataset, name: str, grid: Grid, frames: Sequence[Stored]) -> None:
    """Raises ValueError where a dataset is not what houle writes, before memory is taken for it."""
    field, steps = FIELDS[name], len(frames)
    tail = (3,) if field.vector else ()
    if "/particles/" in name:
        wanted: tuple[int, ...] = (frames[0].rows if frames else 0, *tail)
    else:
        nx, *ny, nz = grid.shape
        wanted = (*((steps,) if steps > 1 else ()), nz, *(ny or [1]), nx, *tail)
    most = MOST_PACKED * max(dataset.id.get_storage_size(), 1)  # bytes that can be packed in it
    if dataset.shape != wanted or dataset.dtype != np.float32 or (not dataset.is_virtual and dataset.nbytes > most):
        raise ValueError(f"{name} is not what houle writes")
    if dataset.chunks != _chunk(name, wanted, steps):
        raise ValueError(f"{name} is not stored as houle stores it")


def _is_whole(file: h5py.File, frame: Stored, grid: Grid) -> bool:
    if not (0 <= frame.row <= frame.row + frame.count <= frame.rows and np.isfinite(frame.time)):
        return False
    try:
        read_values(file, frame, grid.dimension)
        for name in ARRAYS:
            if not file[name].is_virtual:
                _chunks_in(file, name, frame)  # raises for a chunk that is missing, which read_values gets as zeros
    except DAMAGES:
        return False
    return True


def _arrays(frame: Snapshot) -> dict[str, NDArray[np.float32]]:
    """The arrays of a frame as the file has them: particles (N,) or (N, 3), cells (nz, ny, nx) or (nz, ny, nx, 3)."""
    result, dimension = {}, frame.position.shape[1]
    for name, field in FIELDS.items():
        if field.place == "particle":
            values = getattr(frame, field.name)
            result[name] = _spatial(values) if field.vector else values.astype(np.float32)
        else:
            values = getattr(frame, f"cell_{field.name}")
            result[name] = _to_image(_spatial(values) if field.vector else values.astype(np.float32), dimension)
    return result


def _spatial(vectors: FloatArray) -> NDArray[np.float32]:
    """Vectors (..., 2) or (..., 3) as (..., 3): a 2D run lies in the plane y = 0."""
    full = np.zeros((*vectors.shape[:-1], 3), np.float32)
    full[..., [0, 2] if vectors.shape[-1] == 2 else [0, 1, 2]] = vectors
    return full


def _to_image(values: NDArray, dimension: int) -> NDArray:
    """Cell field (nx, [ny,] nz, ...) in the order of the image, (nz, ny, nx, ...)."""
    if dimension == 2:
        values = values[:, None]
    return np.ascontiguousarray(np.swapaxes(values, 0, 2))


def _from_image(values: NDArray, dimension: int) -> NDArray:
    """The inverse of _to_image."""
    turned = np.swapaxes(values, 0, 2)
    return np.ascontiguousarray(turned[:, 0] if dimension == 2 else turned)


def _create(file: h5py.File, name: str, shape: tuple[int, ...], dtype: np.dtype, steps: int) -> h5py.Dataset:
    """An empty compressed dataset, whose chunks are those of `_compressed`."""
    most = (None, *shape[1:]) if "/particles/" in name else None
    return file.create_dataset(name, shape, dtype, chunks=_chunk(name, shape, steps), maxshape=most, **FILTERS)


def _chunk(name: str, shape: tuple[int, ...], steps: int) -> tuple[int, ...]:
    """Shape of a chunk: the chunks of a frame have the same bytes in a file of one step and of many.

    Each holds one component of a vector: neighbours of a kind compress better.
    """
    if "/particles/" in name:
        return (ROWS, *(1 for _ in shape[1:]))
    cells = shape[1:] if steps > 1 else shape
    size = 256 if cells[1] == 1 else 64
    chunk = (*(min(n, size) for n in cells[:3]), *(1 for _ in cells[3:]))
    return (1, *chunk) if steps > 1 else chunk


def _mark(group: h5py.Group, kind: str) -> None:
    """Gives a group the version of the format and its kind of VTK data set."""
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
        for begin, values in _offsets(cells, ids):
            offsets[begin : begin + len(values)] = values
        kind.create_dataset(
            "Connectivity", data=ids[: cells.max(initial=0)], chunks=(ROWS,), maxshape=(None,), **FILTERS
        )


def _offsets(cells: NDArray[np.int64], ids: NDArray[np.int64]) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """The offsets 0, 1, 2, ... of every step, one step after the other, in pieces: first place and values of each."""
    begin, first = 0, 0
    ends = np.cumsum(cells + 1)
    while first < len(cells):
        last = max(first + 1, int(np.searchsorted(ends, begin + PIECE, side="right")))
        yield begin, np.concatenate([ids[: count + 1] for count in cells[first:last]])
        begin, first = int(ends[last - 1]), last


def _image(block: h5py.Group, grid: Grid) -> None:
    """Gives the image its extent, spacing and place; that of a 2D run is one cell thick, behind the particles."""
    nx, *ny, nz = grid.shape
    flat = grid.dimension == 2
    block.attrs["WholeExtent"] = np.array([0, nx, 0, 1 if flat else ny[0], 0, nz], np.int64)
    block.attrs["Spacing"] = np.array((grid.spacing[0], grid.spacing[0], grid.spacing[1]) if flat else grid.spacing)
    block.attrs["Origin"] = np.array([0.0, 0.5 * grid.spacing[0] if flat else 0.0, 0.0])
    block.attrs["Direction"] = np.eye(3).ravel()


def _kinds(first: Stored, rows: int, steps: int) -> dict[str, Kind]:
    """Shape and type of each assembled array, from those of a frame."""
    kinds = {}
    for name, (shape, dtype) in (first.kinds or _kinds_in(first.path)).items():
        if "/particles/" in name:
            kinds[name] = ((rows, *shape[1:]), dtype)
        else:
            cells = shape[1:] if first.steps > 1 else shape
            kinds[name] = ((steps, *cells) if steps > 1 else cells, dtype)
    return kinds


def _kinds_in(path: Path) -> dict[str, Kind]:
    with h5py.File(path) as source:
        return {name: (source[name].shape, source[name].dtype) for name in ARRAYS}


def _refer(file: h5py.File, name: str, kind: Kind, frames: Sequence[Stored], starts: Sequence[int]) -> h5py.Dataset:
    """A virtual dataset that points to the frames in their files; neighbours in a file are taken together."""
    shape, dtype = kind
    layout = h5py.VirtualLayout(shape, dtype)
    many = len(frames) > 1
    cells = shape[1:] if many else shape
    for i, j in _neighbours(frames):
        first, last = frames[i], frames[j]
        there = f"{PARTS}/{first.path.name}"
        if "/particles/" in name:
            source = h5py.VirtualSource(there, name, (first.rows, *shape[1:]), dtype)
            layout[starts[i] : starts[j] + last.count] = source[first.row : last.row + last.count]
        elif first.steps > 1:
            source = h5py.VirtualSource(there, name, (first.steps, *cells), dtype)
            layout[slice(i, j + 1) if many else ...] = source[first.index : last.index + 1]
        else:
            layout[i if many else ...] = h5py.VirtualSource(there, name, cells, dtype)
    return file.create_virtual_dataset(name, layout)


def _neighbours(frames: Sequence[Stored]) -> list[tuple[int, int]]:
    """First and last of each stretch of frames that follow each other in one file."""
    begins = [
        i
        for i, frame in enumerate(frames)
        if i == 0 or frame.path != frames[i - 1].path or frame.index != frames[i - 1].index + 1
    ]
    return list(zip(begins, [i - 1 for i in begins[1:]] + [len(frames) - 1], strict=True))


def _copy(file: h5py.File, frames: Sequence[Stored], starts: Sequence[int]) -> None:
    """Fills the packed file with the compressed chunks of the frames, as they are."""
    targets = {name: file[name].id for name in ARRAYS}
    for path, group in itertools.groupby(enumerate(frames), key=lambda pair: pair[1].path):
        with h5py.File(path) if path.name else contextlib.nullcontext() as source:
            for i, frame in group:
                for name, target in targets.items():
                    for place, data in (frame.chunks or {}).get(name) or _chunks_in(source, name, frame):
                        target.write_direct_chunk(_placed(name, place, starts[i], i, len(frames)), data)


def _chunks_in(source: h5py.File, name: str, frame: Stored) -> Chunks:
    """The chunks of an array of a frame, from its file."""
    there = source[name]
    shape = there.shape[1:] if "/particles/" in name or frame.steps > 1 else there.shape
    shape = (frame.count, *shape) if "/particles/" in name else shape
    places = [(place, _placed(name, place, frame.row, frame.index, frame.steps)) for place in _places(name, shape)]
    return [(place, there.id.read_direct_chunk(offset)[1]) for place, offset in places]


def _places(name: str, shape: tuple[int, ...]) -> Iterable[tuple[int, ...]]:
    """The first indices of each chunk of an array of one frame; there is at least one chunk."""
    return itertools.product(*(range(0, max(n, 1), c) for n, c in zip(shape, _chunk(name, shape, 1), strict=True)))


def _placed(name: str, place: tuple[int, ...], row: int, index: int, steps: int) -> tuple[int, ...]:
    """First indices, in a file of so many steps, of the chunk at `place` in the frame at this row and index."""
    if "/particles/" in name:
        return (place[0] + row, *place[1:])
    return (index, *place) if steps > 1 else place
