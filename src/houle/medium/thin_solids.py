"""Thin solids are thickened to a cell, so that water on the two sides of a plate shares no cell.

A cell has one fill, one pressure and one velocity on each face, and a particle gives to everything within a cell. If a
plate is thinner than a cell, water on one side pushes and carries the water on the other: a third of it went through a
plate in a second, and a film beside the tip of a wedge gained energy. The rule is therefore (decision 0021): take a
window as large as a cell, anywhere on the lattice of half cells. If a solid parts the open space in it, so that the
parts do not touch, the whole window counts as solid. A plate is then at least one cell thick, and as it is drawn where
it is thicker; a solid thicker than a cell is changed at its tips only.

Slits that are narrower than a tenth of a cell count as closed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, groupby, pairwise, product
from operator import itemgetter

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid
from houle.medium.integrals import cut_all, edges
from houle.medium.sections import layers, repeated, section
from houle.medium.shapes import EVERYWHERE, Box, Shape, Span, Union, covers, polygons

CRUMB = 1e-9  # share of a window: less open space is no part; a face beside more may be open (`medium.CLOSED`)
SLIT = 0.1  # cells: a narrower slit is closed, as the pressure would drive the water of whole cells at its faces
BEHIND = 1e-3  # share of a window: less open space than this on one side of a slit does not count
BEVEL = 1.5  # limit of mitres at the corners of solids that are widened to find slits [half widths of a slit]
NEAR = 1e-6  # [cells] shorter lengths are round-off

Lines = tuple[FloatArray, FloatArray]  # places of the lines between windows along x and along z [m]


@dataclass(frozen=True)
class Thickened(Union):
    """A solid together with the windows that it parts and that so count as solid: the first part is the solid."""

    @property
    def drawn(self) -> Shape:
        """The solid as it is drawn in the case."""
        return self.parts[0]

    @property
    def windows(self) -> Union:
        """The windows that count as solid."""
        return Union(self.parts[1:])


def thickened(grid: Grid, solids: Sequence[Shape]) -> tuple[Shape, ...]:
    """The solids, each with the windows that it parts; a window belongs to the solid nearest to its middle."""
    return _thickened(grid, tuple(solids))


@lru_cache(maxsize=8)  # the check, the run and each of its pictures ask for the same solids
def _thickened(grid: Grid, solids: tuple[Shape, ...]) -> tuple[Shape, ...]:
    whole = list(solids)
    for shift in product((0.0, 0.5), repeat=grid.dimension) if solids else ():
        found = sorted(parted_windows(grid, whole, shift), key=itemgetter(0))
        more: list[list[Box]] = [[] for _ in whole]
        for layer, windows in groupby(found, key=itemgetter(0)):
            alone = np.array([repeated(grid, section(grid, [solid], layer)) for solid in whole])
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
    """The boxes, with those that follow each other along an axis joined to one."""

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

    shift: displacement of the windows from the cells (d,) [cells]. Windows at a wall are cut there; those at the seam
    of a periodic axis are whole and come as two boxes. In 3D windows through which the same layers go are joined in y.
    """
    spans, lines = layers(grid, solids), (_lines(grid, 0, shift[0]), _lines(grid, -1, shift[-1]))
    areas = [repeated(grid, section(grid, solids, span)) for span in spans]
    blocks = [_blocks(area, lines) for area in areas]
    closed = _without_slits(grid, spans, areas)
    apart = [_blocks(c, lines) if _has_slits(grid, c, a) else [] for c, a in zip(closed, areas, strict=True)]
    edges_in = [_edges_in(grid, area, lines, (shift[0], shift[-1])) for area in areas]
    for number, width, y in _stacks(grid, spans, shift[1]):
        if len(number) == 1:
            where = edges_in[number[0]] > 1  # one edge leaves one part
        else:
            where = np.any([(edges_in[n] > 0) | _middles(areas[n], lines) for n in number], axis=0)
        at = np.argwhere(where)
        window = [_window(lines, i, k) for i, k in at]
        open_ = [shapely.difference(window, [blocks[n][i] for i, _ in at]) for n in number]
        least = BEHIND * shapely.area(window)
        parts = [
            _parts(found, [apart[n][i] for i, _ in at if apart[n]], least)
            for n, found in zip(number, open_, strict=True)
        ]
        for box, found, layer in zip(window, zip(*open_, strict=True), zip(*parts, strict=True), strict=True):
            if _is_parted(layer, width, box.area):
                solid = next(spans[n] for n, part in zip(number, found, strict=True) if part.area < box.area)
                (x0, z0, x1, z1), (low, high) = box.bounds, (((end,) if grid.dimension == 3 else ()) for end in y)
                for inside in _inside(grid, Box((x0, *low, z0), (x1, *high, z1))):
                    yield solid, inside


def _lines(grid: Grid, axis: int, shift: float) -> FloatArray:
    """Ends of the windows along an axis [m]; on a periodic axis a shifted first window begins before the seam."""
    inner = np.array((np.arange(grid.shape[axis] + 1) + shift) * grid.spacing[axis], float)
    if shift == 0.0:
        return inner
    if grid.periodic[axis]:
        return np.array(inner - grid.spacing[axis], float)
    return np.array([0.0, *inner[:-1], grid.size[axis]], float)


def _window(lines: Lines, i: int, k: int) -> shapely.Polygon:
    (x, z) = lines
    return shapely.box(x[i], z[k], x[i + 1], z[k + 1])


def _inside(grid: Grid, box: Box) -> list[Box]:
    """The box, in two parts inside the domain where it lies across the seam of a periodic axis."""
    found = [box]
    for axis in range(grid.dimension):
        low, size = box.lower[axis], grid.size[axis]
        if low < 0.0:
            ends = [(0.0, box.upper[axis]), (size + low, size)]
            found = [Box(_put(b.lower, axis, e[0]), _put(b.upper, axis, e[1])) for b in found for e in ends]
    return found


def _put(corner: tuple[float, ...], axis: int, value: float) -> tuple[float, ...]:
    return (*corner[:axis], value, *corner[axis + 1 :])


def _blocks(area: shapely.Geometry, lines: Lines) -> list[shapely.Geometry]:
    """The part of an area around each column of windows, and some more: less to search than the whole area."""
    (x, z), found = lines, []
    count = len(x) - 1
    several = int(np.ceil(np.sqrt(count)))
    for first in range(0, count, several):
        last = min(first + several, count)
        margin = x[1] - x[0]
        around = shapely.box(x[first] - margin, z[0] - margin, x[last] + margin, z[-1] + margin)
        found += _plain([shapely.intersection(area, around)]) * (last - first)
    return found


def _without_slits(grid: Grid, spans: Sequence[Span], areas: Sequence[shapely.Geometry]) -> list[shapely.Geometry]:
    """The areas of the layers (of `repeated`) with the slits between them and at walls, narrower than `SLIT`."""
    radius = 0.5 * SLIT * min(grid.spacing[0], grid.spacing[-1])
    ends = [(-size, 2.0 * size) if wraps else (0.0, size) for size, wraps in zip(grid.size, grid.periodic, strict=True)]
    tank = shapely.box(ends[0][0], ends[-1][0], ends[0][1], ends[-1][1])
    walls = shapely.difference(shapely.box(*tank.buffer(4.0 * radius).bounds), tank)
    found = []
    for area in areas:
        grown = _buffer(shapely.union_all([area, walls]), radius)
        found.append(area if area.is_empty else _buffer(grown, -radius))
    if grid.dimension == 3:  # slits across y are layers thinner than `SLIT`
        whole = list(found)
        for n, (low, high) in enumerate(spans):
            if high - low < SLIT * grid.spacing[1]:
                sides = [m % len(spans) if grid.periodic[1] else m for m in (n - 1, n + 1)]
                beside = [whole[m] if 0 <= m < len(spans) else tank for m in sides]
                found[n] = shapely.union_all([found[n], shapely.intersection(*beside)])
    return found


def _buffer(area: shapely.Geometry, radius: float) -> shapely.Geometry:
    return shapely.buffer(area, radius, join_style="mitre", mitre_limit=BEVEL)


def _plain(areas: Iterable[shapely.Geometry]) -> list[shapely.Geometry]:
    """Areas without the lines and points in which shapes may touch."""
    return [shapely.multipolygons(polygons(area)) for area in areas]


def _has_slits(grid: Grid, closed: shapely.Geometry, area: shapely.Geometry) -> bool:
    """True if an area differs from `closed`, which is the same without slits."""
    least = CRUMB * grid.spacing[0] * grid.spacing[-1]
    return bool((shapely.area(polygons(shapely.difference(closed, area))) > least).any())


def _parts(open_: NDArray[np.object_], closed: list[shapely.Geometry], least: FloatArray) -> list[NDArray[np.object_]]:
    """The open parts of each of W windows: polygons that touch no other one, or touch it by a slit only.

    open_   (W,) open space of the windows
    closed  solids at each window without their slits; empty if there are no slits
    least   (W,) parts behind a slit that are smaller than this do not count [m2]
    """
    one = (shapely.get_type_id(open_) == shapely.GeometryType.POLYGON) & ~shapely.is_empty(open_)
    whole = [open_[w : w + 1] if one[w] else polygons(area) for w, area in enumerate(open_)]
    if not closed:
        return whole
    wide = shapely.difference(_plain(open_), closed)
    return [_split(*each) for each in zip(whole, wide, least, strict=True)]


def _split(whole: NDArray[np.object_], wide: shapely.Geometry, least: float) -> NDArray[np.object_]:
    """The open parts of a window: its polygons, split where only a slit joins them. wide: open space without slits."""
    parts = polygons(wide)
    parts = parts[shapely.area(parts) > least]
    if len(parts) < 2:
        return whole
    inside = [parts[shapely.intersects(polygon, shapely.point_on_surface(parts))] for polygon in whole]
    pieces = [own if len(own) > 1 else np.array([polygon]) for polygon, own in zip(whole, inside, strict=True)]
    return np.concatenate(pieces)


def _edges_in(grid: Grid, area: shapely.Geometry, lines: Lines, shift: tuple[float, float]) -> NDArray[np.intp]:
    """Number of edges of an area that run through each window of a section."""
    shape = (len(lines[0]) - 1, len(lines[1]) - 1)
    piece, edge = cut_all(edges(area, (0.5 * grid.spacing[0], 0.5 * grid.spacing[-1])))  # cut at shifted lines too
    window = np.floor(0.5 * piece.mean(axis=1) + shift).astype(np.intp)
    inside = ((window >= 0) & (window < shape)).all(axis=1)
    through = np.unique(np.column_stack([edge, window])[inside], axis=0)[:, 1:]
    flat = np.ravel_multi_index(tuple(through.T), shape)
    return np.bincount(flat, minlength=shape[0] * shape[1]).reshape(shape)


def _middles(area: shapely.Geometry, lines: Lines) -> NDArray[np.bool_]:
    """True for the windows of a section whose middle the area covers."""
    x, z = np.meshgrid(*((line[1:] + line[:-1]) / 2 for line in lines), indexing="ij")
    return covers(area, x, z)


def _stacks(grid: Grid, spans: Sequence[Span], shift: float) -> Iterator[tuple[list[int], FloatArray, Span]]:
    """Runs of windows along y through which the same layers go.

    For each run: the numbers of the layers, their widths in y within the run [m], and the span of the run in y [m].
    """
    if grid.dimension == 2:
        yield [0], np.ones(1), EVERYWHERE
        return
    y, slack = _lines(grid, 1, shift), NEAR * grid.spacing[1]
    copies = [
        (n, low + by, high + by)
        for by in ((-grid.size[1], 0.0) if y[0] < 0.0 else (0.0,))
        for n, (low, high) in enumerate(spans)
    ]
    through: list[list[int]] = []
    width: list[list[float]] = []
    for a, b in pairwise(y):
        here = [(n, min(high, b) - max(low, a)) for n, low, high in copies if low < b - slack and high > a + slack]
        runs = [list(run) for _, run in groupby(here, key=itemgetter(0))]  # across the seam one layer may go on
        through.append([run[0][0] for run in runs])
        width.append([sum(w for _, w in run) for run in runs])
    for number, run in groupby(range(len(through)), key=through.__getitem__):
        windows = list(run)
        total = np.sum([width[w] for w in windows], axis=0)
        yield number, total, (y[windows[0]], y[windows[-1] + 1])


def _is_parted(layer: Sequence[NDArray[np.object_]], width: FloatArray, window: float) -> bool:
    """True for a window whose open polygons, layer by layer, make more than one part of its space.

    layer   open polygons of the window in each of its layers
    width   width in y of each layer inside the window [m]
    window  area of the section of the window [m2]
    """
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


def solid_windows(grid: Grid, solids: Sequence[Shape]) -> list[Box]:
    """The windows that count as solid in addition to the solids as they are drawn."""
    whole = [solid for solid in thickened(grid, solids) if isinstance(solid, Thickened)]
    return [box for solid in whole for box in solid.windows.parts if isinstance(box, Box)]


def closed_passage(grid: Grid, open_: shapely.Geometry, windows: shapely.Geometry) -> tuple[float, float] | None:
    """Place (x, z) [m] in a section where windows that count as solid close a passage of the open space.

    They part the open space there in two parts that are both larger than a cell. None where no passage is closed.
    """
    least = grid.spacing[0] * grid.spacing[-1]
    for space in polygons(open_):
        rest = polygons(shapely.difference(space, windows))
        rest = rest[shapely.area(rest) > least]
        if len(rest) > 1:
            between = polygons(shapely.intersection(space, windows))
            touched = shapely.dwithin(between[:, None], rest, NEAR * max(grid.spacing)).sum(axis=1)
            x, z = shapely.get_coordinates(shapely.point_on_surface(between[np.argmax(touched)]))[0]
            return float(x), float(z)
    return None


def at_width(boxes: Sequence[Box], y: float) -> list[Box]:
    """The boxes that reach over this y [m]; all of them in 2D."""
    return [box for box in boxes if box.span[0] <= y <= box.span[1]]
