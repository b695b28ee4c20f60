"""The surfaces on which water presses, solids and sides of the tank, cut into patches of one cell each.

A patch is a piece of an edge of the section, from a to b, times a width in y; a face across y is taken cell by cell.
The pressure along it is linear: that of its cell, plus the hydrostatic difference between the centre of the cell and
the ends of the patch (no other part of the pressure changes towards a fixed wall).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid
from houle.medium.integrals import cut, cut_all, edges, section_moments, span_moments
from houle.medium.sections import PorousBody, partition, repeated, section
from houle.medium.shapes import Shape, Span

SIDES = {"left": (0, 0), "right": (0, 1), "front": (1, 0), "back": (1, 1), "bottom": (-1, 0), "top": (-1, 1)}
NEAR = 1e-6  # distance [cells] from a surface at which the cell on its wet side is looked for


@dataclass(frozen=True)
class Patches:
    """cell (P,) on the wet side; a, b (P, d) ends [m]; area (P, d) [m^(d-1)] as a vector out of the water."""

    cell: NDArray[np.intp]
    a: FloatArray
    b: FloatArray
    area: FloatArray

    @classmethod
    def gather(
        cls, grid: Grid, open_cells: FloatArray, found: list[tuple[FloatArray, FloatArray, FloatArray]]
    ) -> Patches:
        """The patches made of these (a, b, area); those with no water in front of them are left out."""
        d = grid.dimension
        a, b, area = (
            (np.concatenate([np.empty((0, d)), *parts]) for parts in zip(*found, strict=True))
            if found
            else (np.empty((0, d)),) * 3
        )
        size = np.linalg.norm(area, axis=1)
        a, b, area, size = a[size > 0], b[size > 0], area[size > 0], size[size > 0]
        inwards = -area / size[:, None]
        cell = np.full(len(a), -1, np.intp)
        for step in (NEAR, 0.5, 1.0):  # a cell that is a sliver of water is closed: the next one speaks for it
            at = np.floor((0.5 * (a + b)) / grid.spacing + step * inwards).astype(int)
            at = np.where(grid.periodic, at % grid.shape, at)
            inside = ((at >= 0) & (at < grid.shape)).all(axis=1)
            flat = np.ravel_multi_index(tuple(np.clip(at, 0, np.array(grid.shape) - 1).T), grid.shape)
            new = (cell == -1) & inside & (open_cells.ravel()[flat] > 0.0)
            cell[new] = flat[new]
            if step == NEAR:
                cell[~inside] = -2  # on a side of the tank
        kept = cell >= 0
        return cls(cell[kept], a[kept], b[kept], area[kept])


@dataclass(frozen=True)
class Surfaces:
    """The surfaces of a tank with these bodies and solids. open_cells: open share of the cells (`Medium`) [-]."""

    grid: Grid
    open_cells: FloatArray
    bodies: Sequence[PorousBody]
    solids: Sequence[Shape]

    def of_solid(self, shape: Shape) -> Patches:
        """The surface of a solid, where no other solid touches it."""
        grid = self.grid
        parts = partition(grid, self.bodies, self.solids)
        layers = [(span, solid, section(grid, [shape], span)) for span, solid, _ in parts]
        found = []
        for span, solid, own in layers:
            if not own.is_empty:
                piece = _pieces(grid, repeated(grid, solid))
                middle = piece.mean(axis=1) * (grid.spacing[0], grid.spacing[-1])
                here = shapely.dwithin(
                    shapely.points(middle), shapely.boundary(repeated(grid, own)), NEAR * min(grid.spacing)
                )
                here &= (middle[:, 0] >= 0.0) & (middle[:, 0] < grid.size[0] if grid.periodic[0] else True)
                found += list(_upright(grid, piece[here], span))
        ring = [*layers, layers[0]] if grid.dimension == 3 and grid.periodic[1] else layers
        for (before, solid_before, own_before), (_, solid_after, own_after) in itertools.pairwise(ring):
            found.append(_across(grid, own_before.difference(solid_after), before[1], +1.0))
            found.append(_across(grid, own_after.difference(solid_before), before[1], -1.0))
        return Patches.gather(grid, self.open_cells, found)

    def of_side(self, side: str) -> Patches:
        """A side of the tank, where no solid covers it."""
        grid = self.grid
        axis, end = SIDES[side]
        x, z = grid.size[0], grid.size[-1]
        found = []
        for span, solid, _ in partition(grid, self.bodies, self.solids):
            if side in ("front", "back"):
                if (span[0] <= 0.0) if end == 0 else (span[1] >= grid.size[1]):
                    free = shapely.box(0, 0, x, z).difference(solid)
                    found.append(_across(grid, free, grid.size[1] * end, -1.0 if end else +1.0))
                continue
            inset = NEAR * grid.spacing[axis]
            lines = {
                "left": [[inset, 0], [inset, z]], "right": [[x - inset, z], [x - inset, 0]],
                "bottom": [[x, inset], [0, inset]], "top": [[0, z - inset], [x, z - inset]],
            }  # fmt: skip  # the wall on their left
            way = np.diff(lines[side], axis=0)[0]
            free = shapely.difference(shapely.linestrings(lines[side]), solid)
            for line in shapely.get_parts(free) if not shapely.is_empty(free) else ():
                ends = shapely.get_coordinates(line)[[0, -1]]
                ends[:, 0 if axis == 0 else 1] = end * (x if axis == 0 else z)
                ends = ends if np.dot(ends[1] - ends[0], way) > 0 else ends[::-1]
                piece = cut(ends / (grid.spacing[0], grid.spacing[-1]))
                found += list(_upright(grid, piece, span))
        return Patches.gather(grid, self.open_cells, found)


def _pieces(grid: Grid, area: shapely.Geometry) -> FloatArray:
    """Edges (P, 2, 2) of the area [cells], the area on their left, cut at the lines of the grid."""
    return cut_all(edges(area, (grid.spacing[0], grid.spacing[-1])))[0]


def _upright(grid: Grid, piece: FloatArray, span: Span) -> Iterator[tuple[FloatArray, FloatArray, FloatArray]]:
    """(a, b, area) of pieces (P, 2, 2) [cells] that have the solid on their left, over a span of y."""
    ends = piece * (grid.spacing[0], grid.spacing[-1])
    along = ends[:, 1] - ends[:, 0]
    out = np.stack([-along[:, 1], along[:, 0]], axis=1)
    if grid.dimension == 2:
        yield ends[:, 0], ends[:, 1], out
        return
    share = span_moments(span, grid.spacing[1], grid.shape[1])[0]
    for j in np.flatnonzero(share > 0):
        y = np.full(len(ends), (j + 0.5) * grid.spacing[1])
        a, b = (np.stack([e[:, 0], y, e[:, 1]], axis=1) for e in (ends[:, 0], ends[:, 1]))
        width = share[j] * grid.spacing[1]
        yield a, b, width * np.stack([out[:, 0], np.zeros_like(y), out[:, 1]], axis=1)


def _across(grid: Grid, area: shapely.Geometry, y: float, into: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(a, b, area) of a face across y: the water lies on the side of larger y where `into` is 1, else -1."""
    h = grid.spacing
    if area.is_empty:
        return np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3))
    share = section_moments(area, (h[0], h[-1]), (grid.shape[0], grid.shape[-1]))[0, 0]
    i, k = np.nonzero(share > 1e-9)
    x, level = (i + 0.5) * h[0], np.full(len(i), y)
    a, b = (np.stack([x, level, (k + e) * h[-1]], axis=1) for e in (0, 1))
    size = share[i, k] * h[0] * h[-1]
    return a, b, np.stack([0 * x, -into * size, 0 * x], axis=1)
