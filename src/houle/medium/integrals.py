"""Exact integrals of polygonal regions over a grid: areas, first moments, box and tent averages, covered faces.

A region of the (x, z) section is bounded by edges. Each edge is cut at the lattice lines, and the strip below each
piece is counted positive or negative, depending on its direction (Green's theorem, as when an outline font is drawn).
This gives exactly the moments, integrals of xi^a zeta^b with a, b = 0, 1, where xi and zeta go from -1/2 to 1/2 across
a lattice cell. The lattice is that of the half cells (2 per axis and cell): cells, boxes centred on faces and the
linear pieces of the tent function are all made of half cells, so their averages are exact sums of these moments. In 3D
a region is a stack of sections, each over a span of y. See docs/decisions/0004.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.polygon import orient

from houle.grid import FloatArray, Grid
from houle.medium.shapes import Span, polygons

ON_LINE = 1e-9  # [cells] an end of an edge that is nearer to a lattice line lies on it
NOTHING = 1e-12  # [cells] less area is none

Averaging = Callable[[FloatArray, FloatArray, bool], FloatArray]  # (moments 0 and 1 along the last axis, periodic)


def edges(area: shapely.Geometry, spacing: Sequence[float]) -> FloatArray:
    """Edges (E, 2, 2) of a polygonal area in units of spacing, from [:, 0] to [:, 1], with the area on their left."""
    found = [np.empty((0, 2, 2))]
    for part in map(orient, polygons(area)):
        for ring in (part.exterior, *part.interiors):
            corners = shapely.get_coordinates(ring) / spacing
            on_line = np.round(corners)
            corners = np.where(np.abs(corners - on_line) < ON_LINE, on_line, corners)
            found.append(np.stack([corners[:-1], corners[1:]], axis=1))
    return np.concatenate(found)


def cut(edge: FloatArray) -> FloatArray:
    """Pieces (P, 2, 2) of an edge (2, 2) of `edges`, cut at every lattice line."""
    return cut_all(edge[None])[0]


def cut_all(edge: FloatArray) -> tuple[FloatArray, NDArray[np.intp]]:
    """Pieces (P, 2, 2) of edges (E, 2, 2) cut at every lattice line, edge by edge, and number (P,) of their edge."""
    start, step = edge[:, 0], edge[:, 1] - edge[:, 0]
    number = [np.repeat(np.arange(len(edge)), 2)]
    share = [np.tile([0.0, 1.0], len(edge))]  # place of each end of a piece on its edge, from 0 to 1
    for a in (0, 1):
        first = np.ceil(edge[:, :, a].min(axis=1))
        count = np.where(step[:, a] != 0, np.floor(edge[:, :, a].max(axis=1)) + 1 - first, 0).astype(np.intp)
        own = np.repeat(np.arange(len(edge)), count)
        line = first[own] + (np.arange(len(own)) - (np.cumsum(count) - count)[own])
        number.append(own)
        share.append((line - start[own, a]) / step[own, a])
    own, at = np.concatenate(number), np.clip(np.concatenate(share), 0, 1)
    order = np.lexsort((at, own))
    own, at = own[order], at[order]
    new = np.concatenate([[True], (own[1:] != own[:-1]) | (at[1:] != at[:-1])])[: len(own)]
    own, at = own[new], at[new]
    point = start[own] + at[:, None] * step[own]
    last = np.flatnonzero(np.diff(own, append=len(edge)))
    point[last] = edge[own[last], 1]
    inner = own[1:] == own[:-1]
    return np.stack([point[:-1], point[1:]], axis=1)[inner], own[1:][inner]


def _fill_below(amount: FloatArray) -> FloatArray:
    """Sum, for each entry, of all entries after it along the last axis, that is above it."""
    total = np.zeros_like(amount)
    total[..., :-1] = np.cumsum(amount[..., :0:-1], axis=-1)[..., ::-1]
    return total


def section_moments(
    area: shapely.Geometry, spacing: Sequence[float], shape: tuple[int, int], between: tuple[int, int] | None = None
) -> FloatArray:
    """Moments (2, 2, *shape) of an area over the cells of a lattice, exact to round-off.

    [a, b] is the integral of xi^a zeta^b over the part of the area in the cell, divided by the area of the cell; so
    [0, 0] is the covered fraction. The area must lie in the lattice, whose cells have this spacing (2,) [m]. between:
    first column and end of the columns that are asked for, None for all.
    """
    outline, (first, end) = edges(area, spacing), between or (0, shape[0])
    moments = np.zeros((2, 2, end - first, shape[1]))
    if len(outline) == 0:
        return moments
    piece, _ = cut_all(outline)
    cell = np.clip(np.floor(piece.mean(axis=1)).astype(int), 0, np.array(shape) - 1)
    inside = (cell[:, 0] >= first) & (cell[:, 0] < end)
    piece, cell, shape = piece[inside], cell[inside], (end - first, shape[1])
    flat = np.ravel_multi_index((cell[:, 0] - first, cell[:, 1]), shape)
    columns = np.zeros((2, *shape))
    for gauss in (0.5 - 0.5 / np.sqrt(3), 0.5 + 0.5 / np.sqrt(3)):  # exact for the cubic integrands below
        xi, zeta = (piece[:, 0] + gauss * (piece[:, 1] - piece[:, 0]) - cell - 0.5).T
        weight = 0.5 * (piece[:, 0, 0] - piece[:, 1, 0])  # the area lies below edges that run to the left
        for a in (0, 1):
            strip = weight * xi**a
            for target, height in (
                (moments[a, 0], zeta + 0.5),
                (moments[a, 1], (zeta**2 - 0.25) / 2),
                (columns[a], np.ones_like(zeta)),
            ):
                target += np.bincount(flat, strip * height, minlength=target.size).reshape(shape)
    moments[:, 0] += _fill_below(columns)
    moments[:, :, np.abs(moments[0, 0]) < NOTHING] = 0.0
    full = np.abs(moments[0, 0] - 1) < NOTHING
    moments[:, :, full] = 0.0
    moments[0, 0, full] = 1.0
    return moments


def span_moments(span: Span, spacing: float, cells: int) -> FloatArray:
    """Moments (2, cells) of a span [m] in the cells along one axis: covered fraction, and integral of xi over it."""
    ends = [np.clip(end / spacing - np.arange(cells), 0, 1) - 0.5 for end in span]
    ends = [np.where(np.abs(np.abs(e) - 0.5) < ON_LINE, np.round(e + 0.5) - 0.5, e) for e in ends]
    return np.array([ends[1] - ends[0], (ends[1] ** 2 - ends[0] ** 2) / 2])


def over_cells(zero: FloatArray, one: FloatArray, periodic: bool) -> FloatArray:
    """Mean over each cell, from the half-cell moments along the last axis."""
    return (zero[..., 0::2] + zero[..., 1::2]) / 2


def around_faces(zero: FloatArray, one: FloatArray, periodic: bool) -> FloatArray:
    """Mean over the one-cell interval around each face; over its inner half at a wall."""
    left, right = zero[..., 1::2], zero[..., 0::2]
    mean = np.empty((*zero.shape[:-1], left.shape[-1] + 1))
    mean[..., 1:-1] = (left[..., :-1] + right[..., 1:]) / 2
    mean[..., 0] = (left[..., -1] + right[..., 0]) / 2 if periodic else right[..., 0]
    mean[..., -1] = mean[..., 0] if periodic else left[..., -1]
    return mean


def with_tent(zero: FloatArray, one: FloatArray, periodic: bool) -> FloatArray:
    """Mean with weight 1 - |x - x_c| / h around each centre x_c; the part behind a wall is folded back, or wraps."""
    low, high, low_one, high_one = zero[..., 0::2], zero[..., 1::2], one[..., 0::2], one[..., 1::2]
    upward, downward = 0.25 * high + 0.5 * high_one, 0.25 * low - 0.5 * low_one  # for the cells beside
    mean = 0.75 * (low + high) + 0.5 * (low_one - high_one)
    mean[..., 1:] += upward[..., :-1]
    mean[..., :-1] += downward[..., 1:]
    mean[..., 0] += upward[..., -1] if periodic else downward[..., 0]
    mean[..., -1] += downward[..., 0] if periodic else upward[..., -1]
    return mean / 2


@dataclass(frozen=True)
class Measure:
    """Moments of a region in the half cells of a grid, kept as products.

    layers   pairs of the moments of a section (2, 2, 2 nx, 2 nz) and those of its span in y (2, 2 ny), None in 2D; the
             moments of the region are the sum over pairs of the product
    columns  range [first, end) of half cells along x that are known; None: all
    """

    grid: Grid
    layers: tuple[tuple[FloatArray, FloatArray | None], ...]
    columns: tuple[int, int] | None = None

    @classmethod
    def of(
        cls, grid: Grid, areas: Sequence[tuple[Span, shapely.Geometry]], columns: tuple[int, int] | None = None
    ) -> Measure:
        """The measure of a region given by its sections in the tank, each over a span of y [m]."""
        half = [h / 2 for h in grid.spacing]
        shape = (2 * grid.shape[0], 2 * grid.shape[-1])
        return cls(
            grid,
            tuple(
                (
                    section_moments(area, (half[0], half[-1]), shape, columns),
                    span_moments(span, half[1], 2 * grid.shape[1]) if grid.dimension == 3 else None,
                )
                for span, area in areas
                if not area.is_empty
            ),
            columns,
        )

    def mean(self, averaging: Sequence[Averaging]) -> FloatArray:
        """Fraction that the region takes of each cell, box or tent, with one averaging per axis; needs all columns."""
        wrap = self.grid.periodic
        total: FloatArray | None = None
        for moments, along in self.layers:
            rows = [averaging[0](moments[0, b].T, moments[1, b].T, wrap[0]).T for b in (0, 1)]
            plane = averaging[-1](rows[0], rows[1], wrap[-1])
            if along is not None:
                plane = plane[:, None, :] * averaging[1](along[0], along[1], wrap[1])[:, None]
            total = plane if total is None else total + plane
        shape = tuple(n + (f is around_faces) for n, f in zip(self.grid.shape, averaging, strict=True))
        return np.zeros(shape) if total is None else np.ascontiguousarray(total)

    def half_cells(self, powers: Sequence[int] | None = None) -> FloatArray:
        """The moments with these powers, 0 or 1 per axis, in the half cells (columns, [2 ny,] 2 nz)."""
        p, (first, end) = powers or (0,) * self.grid.dimension, self.columns or (0, 2 * self.grid.shape[0])
        total = np.zeros([end - first, *(2 * n for n in self.grid.shape[1:])])
        for moments, along in self.layers:
            plane = moments[p[0], p[-1]]
            total += plane if along is None else plane[:, None, :] * along[p[1]][:, None]
        return total


def covered_lines(area: shapely.Geometry, spacing: Sequence[float], shape: tuple[int, int]) -> FloatArray:
    """Fraction (nx + 1, nz) that a closed area covers of each piece, one cell long, of the vertical grid lines.

    An area that ends on a line covers it: the larger of the limits from the left and from the right counts.
    """
    outline = edges(area, spacing)
    covered = np.maximum(_covered_beside(outline, shape, left=True), _covered_beside(outline, shape, left=False))
    return np.where(covered < NOTHING, 0.0, np.where(covered > 1 - NOTHING, 1.0, covered))


def _covered_beside(outline: FloatArray, shape: tuple[int, int], left: bool) -> FloatArray:
    """The covered fraction of `covered_lines` just to the left or just to the right of each line."""
    covered = np.zeros((shape[0] + 1, shape[1]))
    full = np.zeros_like(covered)
    for start, end in outline:
        first, last = sorted((start[0], end[0]))
        i = np.arange(np.floor(first) + 1 if left else np.ceil(first), np.floor(last) + 1 if left else np.ceil(last))
        if len(i) > 0:
            height = start[1] + (i - start[0]) / (end[0] - start[0]) * (end[1] - start[1])
            line, j = i.astype(int), np.clip(np.floor(height).astype(int), 0, shape[1] - 1)
            sign = np.sign(start[0] - end[0])  # the area lies below edges that run to the left
            covered[line, j] += sign * (height - j)
            full[line, j] += sign
    return covered + _fill_below(full)


def covered_faces(grid: Grid, areas: Sequence[tuple[Span, shapely.Geometry]]) -> list[FloatArray]:
    """Exact fraction of every face, one array per axis, that a closed region covers; areas as in `Measure.of`."""
    faces = grid.faces()
    cells = (grid.shape[0], grid.shape[-1])
    for span, area in areas:
        upright = covered_lines(area, (grid.spacing[0], grid.spacing[-1]), cells)
        swapped = shapely.transform(area, lambda points: points[:, ::-1])
        level = covered_lines(swapped, (grid.spacing[-1], grid.spacing[0]), cells[::-1]).T
        if grid.dimension == 2:
            faces[0] += upright
            faces[1] += level
            continue
        along = span_moments(span, grid.spacing[1], grid.shape[1])[0]
        faces[0] += upright[:, None, :] * along[:, None]
        faces[2] += level[:, None, :] * along[:, None]
        plane = section_moments(area, (grid.spacing[0], grid.spacing[-1]), cells)[0, 0]
        y, margin = grid.axis_points(1, on_faces=True), ON_LINE * grid.spacing[1]
        cut = (y >= span[0] - margin) & (y <= span[1] + margin)
        faces[1] = np.where(cut[:, None], np.maximum(faces[1], plane[:, None, :]), faces[1])
    return [np.minimum(f, 1.0) for f in faces]
