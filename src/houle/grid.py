"""The Cartesian staggered (MAC) grid: where its cells and faces lie, and arrays that fit it.

The last axis is up. Cell i spans [i h, (i+1) h] along each axis; face i of an axis lies at i h. The spacing is the one
asked for, changed per axis by the least that makes a whole number of cells fill the domain.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from houle import _core

FloatArray = NDArray[np.float64]
Listed = tuple[NDArray[np.int32], FloatArray]  # a cell field with few different values: numbers, values by number
Core = _core.Grid2 | _core.Grid3
Faces = list[FloatArray]  # a face field: one array per axis, entry i of axis a on the face at i h_a
SingleFaces = list[NDArray[np.float32]]  # a face field in single precision
MOST_NUMBERS = 2**31 - 2  # most cells, and most particles: they are numbered with 32 bits, with one more for the end


@dataclass(frozen=True)
class Grid:
    """The grid of a tank of dimension d, 2 or 3.

    shape     (d,) number of cells along each axis
    spacing   (d,) size of a cell [m]
    periodic  (d,) whether the two sides across an axis are joined
    """

    shape: tuple[int, ...]
    spacing: tuple[float, ...]
    periodic: tuple[bool, ...]

    @cached_property
    def core(self) -> Core:
        """The grid as an object of the core. ValueError where it has more than `MOST_NUMBERS` cells."""
        kind = _core.Grid2 if self.dimension == 2 else _core.Grid3
        return kind(self.shape, self.spacing, self.periodic)

    @classmethod
    def fit(cls, size: tuple[float, ...], spacing: float, periodic: tuple[bool, ...] | None = None) -> Grid:
        """The grid that fills a tank of this size [m] with a whole number of cells of nearly this spacing [m]."""
        shape = tuple(max(1, round(s / spacing)) for s in size)
        return cls(shape, tuple(s / n for s, n in zip(size, shape, strict=True)), periodic or (False,) * len(size))

    def lowest(self, rows: int) -> Grid:
        """The grid of its lowest `rows` rows of cells."""
        return Grid((*self.shape[:-1], rows), self.spacing, self.periodic)

    @property
    def dimension(self) -> int:
        """d: 2 or 3."""
        return len(self.shape)

    @property
    def size(self) -> tuple[float, ...]:
        """Length of the tank along each axis [m]."""
        return tuple(n * h for n, h in zip(self.shape, self.spacing, strict=True))

    @property
    def cell_volume(self) -> float:
        """Volume of a cell [m^d], an area in 2D."""
        return math.prod(self.spacing)

    def face_shape(self, axis: int) -> tuple[int, ...]:
        """Shape of a field on the faces across an axis: one more than cells along it."""
        return tuple(n + (a == axis) for a, n in enumerate(self.shape))

    def nearest_face(self, x: float) -> float:
        """Position [m] of the face across the first axis that is nearest to x."""
        return round(x / self.spacing[0]) * self.spacing[0]

    def cells(self, value: float = 0.0) -> FloatArray:
        """A new cell field with this value."""
        return np.full(self.shape, value)

    def faces(self, value: float = 0.0) -> Faces:
        """A new face field with this value."""
        return [np.full(self.face_shape(a), value) for a in range(self.dimension)]

    def axis_points(self, axis: int, on_faces: bool = False) -> FloatArray:
        """Coordinates (n,) [m] of the cell centres along an axis, or (n + 1,) of the faces."""
        n, h = self.shape[axis], self.spacing[axis]
        return np.arange(n + 1, dtype=float) * h if on_faces else (np.arange(n, dtype=float) + 0.5) * h

    def points(self, axis: int | None = None) -> FloatArray:
        """Positions (..., d) [m] of the cell centres, or of the centres of the faces across one axis."""
        lines = [self.axis_points(a, on_faces=a == axis) for a in range(self.dimension)]
        return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)


def fixed(table: NDArray) -> NDArray:
    """A read-only copy. The core checks a table of indices only once if it is read-only, else in every call."""
    table = np.array(table, order="C")
    table.flags.writeable = False
    return table


def axes(dimension: int) -> str:
    """The letters of the axes, the last one up."""
    return "xz" if dimension == 2 else "xyz"


def widened(values: NDArray, axis: int, periodic: bool) -> NDArray:
    """A field with one more entry at both ends of an axis, which is moved to the front.

    The entry is that of the other end if the axis is periodic, else the last one again.
    """
    margins = [(int(a == axis),) * 2 for a in range(values.ndim)]
    return np.moveaxis(np.pad(values, margins, mode="wrap" if periodic else "edge"), axis, 0)


Choose = Callable[[NDArray, NDArray], NDArray]  # np.minimum or np.maximum


def beside(choose: Choose, cells: NDArray, axis: int, periodic: Sequence[bool]) -> NDArray:
    """The least or largest value, by `choose`, among each cell and the two beside it along an axis."""
    wide = widened(cells, axis, periodic[axis])
    return np.moveaxis(choose(choose(wide[:-2], wide[1:-1]), wide[2:]), 0, axis)


def seen(choose: Choose, faces: NDArray, axis: int, periodic: Sequence[bool]) -> NDArray:
    """The least or largest value, by `choose`, among the faces of an axis that a particle in each cell sees.

    It sees them by the linear kernel: two faces along the axis and those of the cells beside, across the others.
    """
    along = np.moveaxis(faces, axis, 0)
    cells = np.moveaxis(choose(along[:-1], along[1:]), 0, axis)
    for across in set(range(faces.ndim)) - {axis}:
        cells = beside(choose, cells, across, periodic)
    return cells


def spread(marked: NDArray[np.bool_], periodic: Sequence[bool]) -> NDArray[np.bool_]:
    """The marked cells and all that touch one, across corners too."""
    for axis, wraps in enumerate(periodic):
        wide = widened(marked, axis, wraps)
        marked = np.moveaxis(wide[:-2] | wide[1:-1] | wide[2:], 0, axis)
    return marked
