"""Walls along which the water rubs: solids and sides of the tank, as planes that the cells near them know.

The water within a cell and a half of a wall is slowed down by it (core/houle/water/friction.hpp). Each cell so near
knows the nearest point of the nearest wall, and the plane through it; in front of an edge or a corner the plane faces
the cell. Where walls meet at less than three quarters of a turn, in the foot of a wall say, it knows one plane of each.
The sides of a plate are walls of their own: a plane counts for the water in front of it only. Outlines may have any
number of short edges, as of all edges that run nearly the same way the nearest counts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid, fixed, spread
from houle.medium.patches import SIDES, Patches, Surfaces
from houle.medium.shapes import Shape

REACH = 1.5  # cells: how far from a wall water is slowed down
OTHER_WAY = 0.7  # largest product of the normals of two planes of one cell
ON_IT = 1e-6  # [cells] a point is on a plane

Numbers = NDArray[np.intp]


class RoughWalls(NamedTuple):
    """The cells near walls that rub, and the planes that stand for these walls.

    cell   (C,) int64 flat numbers of the cells, rising
    first  (C + 1,) int64 first plane of each cell
    front  (K,) int64 cell whose fill tells how thick the water on a plane is: it holds the point half a cell before it
    plane  (K, d + 2) normal into the water [-], its product with the points of the plane [m], roughness k_s [m]
    foot   (K, d) point of the plane that is nearest to the centre of the cell [m]
    wall   (K,) int64 number of the wall that each plane belongs to: of the solid, or of the side (`number_of_side`)
    """

    cell: NDArray[np.int64]
    first: NDArray[np.int64]
    front: NDArray[np.int64]
    plane: FloatArray
    foot: FloatArray
    wall: NDArray[np.int64]

    @classmethod
    def of(cls, surfaces: Surfaces, solids: Sequence[float | None], sides: Mapping[str, float]) -> RoughWalls | None:
        """The walls that rub; None where none does.

        solids: roughness k_s of each solid [m], 0 for smooth ones, None where the water slips; sides: of those sides of
        the tank that rub, by their names.
        """
        rough = [(n, k, surfaces.of_solid(solid)) for n, solid, k in _rubbing(surfaces.solids, solids)]
        rough += [(number_of_side(side), k, surfaces.of_side(side)) for side, k in sides.items()]
        rough = [entry for entry in rough if len(entry[2].cell)]
        if not rough:
            return None
        patches = Patches(*(np.concatenate(parts) for parts in zip(*(_fields(p) for *_, p in rough), strict=True)))
        wall = np.concatenate([np.full(len(p.cell), n) for n, _, p in rough])
        roughness = np.concatenate([np.full(len(p.cell), k) for _, k, p in rough])
        return cls._near(surfaces.grid, surfaces.open_cells, patches, wall, roughness)

    @classmethod
    def _near(
        cls, grid: Grid, open_cells: FloatArray, patches: Patches, wall: Numbers, roughness: FloatArray
    ) -> RoughWalls:
        """The walls made of these patches, each with the number of its wall and its roughness [m]."""
        marked = np.zeros(grid.shape, bool)
        marked.ravel()[patches.cell] = True
        for _ in range(2):
            marked = spread(marked, grid.periodic)
        cells = np.flatnonzero(marked & (open_cells > 0.0))
        planes: list[_Planes] = []
        for _ in range(grid.dimension):
            planes.append(_nearest(grid, patches, cells, planes))
        row = np.concatenate([p.row for p in planes])
        order = np.argsort(row, kind="stable")
        normal, offset, foot, patch = (
            np.concatenate([getattr(p, name) for p in planes])[order] for name in ("normal", "offset", "foot", "patch")
        )
        count = np.bincount(row, minlength=len(cells))
        before = foot + 0.5 * normal * grid.spacing
        return cls(
            fixed(cells[count > 0].astype(np.int64)),
            fixed(np.concatenate([[0], np.cumsum(count[count > 0])]).astype(np.int64)),
            fixed(_open_cell(grid, open_cells, before, cells[row[order]]).astype(np.int64)),
            np.ascontiguousarray(np.column_stack([normal, offset, roughness[patch]])),
            foot,
            wall[patch].astype(np.int64),
        )


def number_of_side(side: str) -> int:
    """Number by which the planes of a side of the tank are known: -1, -2, ..."""
    return -1 - list(SIDES).index(side)


class _Planes(NamedTuple):
    """Planes of some cells: row (K,) of the cell in the list, normal (K, d), offset (K,), foot (K, d), patch (K,)."""

    row: Numbers
    normal: FloatArray
    offset: FloatArray
    foot: FloatArray
    patch: Numbers


def _rubbing(solids: Sequence[Shape], roughness: Sequence[float | None]) -> Iterator[tuple[int, Shape, float]]:
    for n, (solid, k) in enumerate(zip(solids, roughness, strict=True)):
        if k is not None:
            yield n, solid, k


def _fields(patches: Patches) -> tuple[Numbers, FloatArray, FloatArray, FloatArray]:
    return patches.cell, patches.a, patches.b, patches.area


def _nearest(grid: Grid, patches: Patches, cells: Numbers, known: Sequence[_Planes]) -> _Planes:
    """For each cell the plane of the nearest patch that runs another way than the planes it knows already."""
    d, h = grid.dimension, np.array(grid.spacing)
    far = np.full(len(cells), np.inf)
    best = _Planes(
        np.arange(len(cells)), np.zeros((len(cells), d)), np.zeros(len(cells)), np.zeros((len(cells), d)),
        np.zeros(len(cells), np.intp),
    )  # fmt: skip
    others = [np.zeros((len(cells), d)) for _ in known]
    for other, planes in zip(others, known, strict=True):
        other[planes.row] = planes.normal
    for row, patch, centre, moved in _pairs(grid, patches, cells):
        normal, foot = _facing(patches, patch, centre)
        way = centre - foot
        distance, before = np.linalg.norm(way / h, axis=1), (way * normal).sum(axis=1)
        on_plane = distance <= np.abs((way * normal / h).sum(axis=1)) + ON_IT
        new = (distance <= REACH + 0.5 * np.sqrt(d)) & (before > -0.5 * np.sqrt(d) * h.min())
        for other in others:
            new &= on_plane & ((normal * other[row]).sum(axis=1) < OTHER_WAY) & other[row].any(axis=1)
        length = np.linalg.norm(way, axis=1, keepdims=True)
        radial = new & ~on_plane & (before > ON_IT * h.min())
        normal = np.where(radial[:, None], way / np.maximum(length, 1e-300), normal)
        new &= distance < far[row]
        order = np.flatnonzero(new)[np.argsort(-distance[new], kind="stable")]  # the nearest is written last
        offset = (normal * (foot - moved)).sum(axis=1)
        far[row[order]] = distance[order]
        for field, values in zip(best[1:], (normal, offset, foot - moved, patch), strict=True):
            field[row[order]] = values[order]
    near = np.isfinite(far)
    return _Planes(best.row[near], best.normal[near], best.offset[near], best.foot[near], best.patch[near])


def _pairs(grid: Grid, patches: Patches, cells: Numbers) -> Iterator[tuple[Numbers, Numbers, FloatArray, FloatArray]]:
    """Pairs of cells and patches up to two cells apart: row in `cells`, patch, centre, and how far it was moved.

    Across the seam of a periodic axis the centre (N, d) stands beside the patch, and is moved (N, d) from its cell [m].
    """
    at, size, n = (
        np.stack(np.unravel_index(patches.cell, grid.shape), axis=1),
        np.array(grid.size),
        np.array(grid.shape),
    )
    for step in product(range(-2, 3), repeat=grid.dimension):
        there = at + step
        turns = np.where(grid.periodic, there // n, 0)
        inside = ((there - turns * n >= 0) & (there - turns * n < n)).all(axis=1)
        patch, there, turns = np.flatnonzero(inside), there[inside], turns[inside]
        number = np.ravel_multi_index(tuple((there - turns * n).T), grid.shape)
        row = np.minimum(np.searchsorted(cells, number), len(cells) - 1)
        listed = cells[row] == number
        yield row[listed], patch[listed], ((there + 0.5) * grid.spacing)[listed], (turns * size)[listed]


def _facing(patches: Patches, patch: Numbers, centre: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Normals into the water (N, d) of patches, and their points (N, d) nearest to the centres [m]."""
    a, along, area = patches.a[patch], (patches.b - patches.a)[patch], patches.area[patch]
    size = np.linalg.norm(area, axis=1, keepdims=True)
    normal, off, length2 = -area / size, centre - a, (along**2).sum(axis=1, keepdims=True)
    foot = a + np.clip((off * along).sum(axis=1, keepdims=True) / length2, 0.0, 1.0) * along
    if a.shape[1] == 3:
        across = np.cross(normal, along)  # as long as `along`
        half = 0.5 * size / length2  # half the width of the patch, in that length
        foot += np.clip((off * across).sum(axis=1, keepdims=True) / length2, -half, half) * across
    return normal, foot


def _open_cell(grid: Grid, open_cells: FloatArray, points: FloatArray, instead: Numbers) -> Numbers:
    """Flat numbers (N,) of the cells that hold points (N, d) [m]; `instead` for points in closed cells."""
    at = np.floor(points / grid.spacing).astype(np.intp)
    at = np.where(grid.periodic, at % np.array(grid.shape), np.clip(at, 0, np.array(grid.shape) - 1))
    number = np.ravel_multi_index(tuple(at.T), grid.shape)
    return np.where(open_cells.ravel()[number] > 0.0, number, instead)
