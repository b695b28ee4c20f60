"""Thin solids: water on the two sides of a plate shares no cell.

A cell has one fill, one pressure and one velocity on each face, and a particle gives to all within a cell. Where a
plate is thinner, water on its one side pushed and carried that on the other: a third of it went through a plate in a
second, and a film beside the tip of a wedge gained energy. So no window as large as a cell, wherever it lies on the
lattice of half cells, may be parted: where a solid parts the open space of one, all of it counts as solid. A plate is
then one cell thick at least, and as it is drawn where it is thicker; a solid thicker than a cell is changed at its tips
only.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, groupby, pairwise, product
from operator import itemgetter

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.geometry import EVERYWHERE, Box, Shape, Span, Union, covers, layers, polygons, section
from houle.grid import FloatArray, Grid
from houle.moments import cut, edges

CRUMB = 1e-3  # of a window: less open space is no part of it
NEAR = 1e-6  # [cells]
STEPS, FARTHEST = 16, 48  # a cell, and in all, in which a way out of the windows is looked for

Lines = tuple[FloatArray, FloatArray]  # between windows along x and z [m]


@dataclass(frozen=True)
class Thickened(Union):
    """A solid, the first part, with the windows that it parts."""

    @property
    def drawn(self) -> Shape:
        return self.parts[0]

    @property
    def windows(self) -> Union:
        return Union(self.parts[1:])


def thickened(grid: Grid, solids: Sequence[Shape]) -> tuple[Shape, ...]:
    """The solids, each with the windows that it parts; where there are several, the one nearest to their middle."""
    whole = list(solids)
    for shift in product((0.0, 0.5), repeat=grid.dimension) if solids else ():
        found = sorted(parted_windows(grid, whole, shift), key=itemgetter(0))
        more: list[list[Box]] = [[] for _ in whole]
        for layer, windows in groupby(found, key=itemgetter(0)):
            alone = np.array([section(grid, [solid], layer) for solid in whole])
            for _, window in windows:
                x, z = (0.5 * (window.lower[a] + window.upper[a]) for a in (0, -1))
                far = np.nan_to_num(shapely.distance(alone, shapely.Point(x, z)), nan=np.inf)
                more[int(np.argmin(far))].append(window)
        for n, boxes in enumerate(more):
            if boxes:
                before = whole[n]
                parts = before.parts if isinstance(before, Thickened) else (before,)
                whole[n] = Thickened((*parts, *_joined(_joined(boxes, -1), 0)))
    return tuple(whole)


def _joined(boxes: Iterable[Box], axis: int) -> list[Box]:
    """The boxes, those that follow each other along an axis as one."""

    def others(box: Box) -> tuple[float, ...]:
        ends = np.delete(np.array([box.lower, box.upper]), axis, axis=1)
        return tuple(ends.ravel())

    found: list[Box] = []
    for box in sorted(boxes, key=lambda b: (others(b), b.lower[axis])):
        last = found[-1] if found else None
        if last is not None and others(last) == others(box) and last.upper[axis] == box.lower[axis]:
            found[-1] = Box(last.lower, box.upper)
        else:
            found.append(box)
    return found


def parted_windows(grid: Grid, solids: Sequence[Shape], shift: Sequence[float]) -> Iterator[tuple[Span, Box]]:
    """Windows whose open space has parts that do not touch, each with a layer in y in which a solid is.

    shift: of the windows from the cells (d,) [cells]; those at a wall are cut there. In 3D a window is as long in y as
    the same layers go on.
    """
    spans, lines = layers(grid, solids), (_lines(grid, 0, shift[0]), _lines(grid, -1, shift[-1]))
    areas = [section(grid, solids, span) for span in spans]
    edges_in = [_edges_in(grid, area, (shift[0], shift[-1])) for area in areas]
    for number, y in _stacks(grid, spans, shift[1]):
        if len(number) == 1:
            width, where = np.ones(1), edges_in[number[0]] > 1  # one edge leaves one part
        else:
            width = np.array([min(spans[n][1], y[1]) - max(spans[n][0], y[0]) for n in number])
            where = np.any([(edges_in[n] > 0) | _middles(areas[n], lines) for n in number], axis=0)
        window = [_window(lines, i, k) for i, k in np.argwhere(where)]
        open_ = [shapely.difference(window, areas[n]) for n in number]
        for box, *found in zip(window, *open_, strict=True):
            if _is_parted([polygons(part) for part in found], width, box.area):
                solid = next(spans[n] for n, part in zip(number, found, strict=True) if part.area < box.area)
                (x0, z0, x1, z1), (low, high) = box.bounds, (((end,) if grid.dimension == 3 else ()) for end in y)
                yield solid, Box((x0, *low, z0), (x1, *high, z1))


def _lines(grid: Grid, axis: int, shift: float) -> FloatArray:
    """Ends of the windows along an axis [m]."""
    inner = (np.arange(grid.shape[axis] + 1) + shift) * grid.spacing[axis]
    return np.array(inner if shift == 0.0 else [0.0, *inner[:-1], grid.size[axis]], float)


def _window(lines: Lines, i: int, k: int) -> shapely.Polygon:
    (x, z) = lines
    return shapely.box(x[i], z[k], x[i + 1], z[k + 1])


def _edges_in(grid: Grid, area: shapely.Geometry, shift: tuple[float, float]) -> NDArray[np.intp]:
    """How many edges of an area run through each of the windows of a section."""
    shape = [grid.shape[a] + (s > 0.0) for a, s in zip((0, -1), shift, strict=True)]
    found: list[NDArray[np.intp]] = [np.empty(0, np.intp)]
    for edge in edges(area, (0.5 * grid.spacing[0], 0.5 * grid.spacing[-1])):  # in half cells: on all their lines
        window = np.floor(cut(0.5 * edge + shift).mean(axis=1)).astype(np.intp)
        found.append(np.unique(np.ravel_multi_index(tuple(np.clip(window, 0, np.array(shape) - 1).T), tuple(shape))))
    return np.bincount(np.concatenate(found), minlength=shape[0] * shape[1]).reshape(shape)


def _middles(area: shapely.Geometry, lines: Lines) -> NDArray[np.bool_]:
    """Whether the area covers the middle of each window of a section."""
    x, z = np.meshgrid(*((line[1:] + line[:-1]) / 2 for line in lines), indexing="ij")
    return covers(area, x, z)


def _stacks(grid: Grid, spans: Sequence[Span], shift: float) -> Iterator[tuple[list[int], Span]]:
    """Numbers of the layers that run through the same windows in y, and from where to where [m] these reach."""
    if grid.dimension == 2:
        yield [0], EVERYWHERE
        return
    y = _lines(grid, 1, shift)
    slack = NEAR * grid.spacing[1]
    through = [
        [n for n, (low, high) in enumerate(spans) if low < b - slack and high > a + slack] for a, b in pairwise(y)
    ]
    for number, run in groupby(range(len(through)), key=through.__getitem__):
        windows = list(run)
        yield number, (y[windows[0]], y[windows[-1] + 1])


def _is_parted(layer: Sequence[NDArray[np.object_]], width: FloatArray, window: float) -> bool:
    """Whether the open polygons of the layers of a window, which are so wide, are more than one part of its space."""
    part = [(n, p) for n, found in enumerate(layer) for p in found]
    if len(part) < 2:
        return False
    joined = list(range(len(part)))  # number of the part that each polygon belongs to
    for one, other in combinations(range(len(part)), 2):
        (n, p), (m, q) = part[one], part[other]
        if m == n + 1 and joined[one] != joined[other] and shapely.intersection(p, q).area > CRUMB * window:
            joined = [joined[one] if j == joined[other] else j for j in joined]
    size = np.zeros(len(part))
    np.add.at(size, joined, [width[n] * p.area for n, p in part])
    return int((size > CRUMB * window * width.sum()).sum()) > 1


def added(grid: Grid, solids: Sequence[Shape], y: float) -> list[Box]:
    """The windows that count as solid besides what is drawn, those at a y in 3D: for pictures."""
    whole = [solid for solid in thickened(grid, solids) if isinstance(solid, Thickened)]
    boxes = [box for solid in whole for box in solid.windows.parts if isinstance(box, Box)]
    return [box for box in boxes if grid.dimension == 2 or box.lower[1] <= y <= box.upper[1]]


def on_their_side(solids: Sequence[Shape], points: FloatArray, spacing: float) -> FloatArray:
    """Where to look for the water beside points (N, d) [m] on or beside a thin solid: those that lie in a window which
    it parts, moved out of that, away from the solid as it is drawn.
    """
    found = points.copy()
    for solid in solids:
        if not isinstance(solid, Thickened):
            continue
        held = np.flatnonzero(solid.windows.contains(points))
        away = _gradient(solid.drawn, points[held], NEAR * spacing)
        for step in np.arange(1, FARTHEST + 1) * (spacing / STEPS):
            inside = solid.contains(found[held])
            found[held[inside]] = points[held[inside]] + step * away[inside]
    return found


def behind_plates(grid: Grid, solids: Sequence[Shape], points: FloatArray, others: FloatArray) -> NDArray[np.bool_]:
    """Which of the other points (N, K, d) [m] a solid hides from the points (N, d), where both lie outside it."""
    hidden, ends = np.zeros(others.shape[:2], bool), np.stack(np.broadcast_arrays(points[:, None], others), axis=2)
    if not solids or not ends.size:
        return hidden
    line, (start, end) = shapely.linestrings(ends[..., [0, -1]]), np.moveaxis(ends, 2, 0)
    y0, y1 = np.sort(ends[..., 1], axis=2).transpose(2, 0, 1)
    for low, high in layers(grid, solids):
        area = section(grid, solids, (low, high))
        inside = shapely.contains(area, shapely.points(start[..., [0, -1]]))
        free = ~inside & ~shapely.intersects(area, shapely.points(end[..., [0, -1]]))
        between = free & (shapely.length(shapely.intersection(area, line)) > NEAR * grid.spacing[0])
        if grid.dimension == 3:
            between &= (low <= start[..., 1]) & (start[..., 1] <= high)
            between |= inside & (y0 <= low) & (high <= y1)  # as thin in y
        hidden |= between
    return hidden


def _gradient(shape: Shape, points: FloatArray, step: float) -> FloatArray:
    """Of the signed distance (N, d): the way out of it, or away from it, of length 1."""
    ends = [[shape.distance(points + side * step * axis) for side in (-1, 1)] for axis in np.eye(points.shape[1])]
    slope = np.stack([high - low for low, high in ends], axis=-1) / (2.0 * step)
    return slope / np.maximum(np.linalg.norm(slope, axis=-1, keepdims=True), 1e-12)
