"""Lines through the case: columns of the grid around places in plan, what stands on an upright line, where it is open.

All of it is exact for polygons, and done once, before the run.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.flow.state import Flow
from houle.grid import FloatArray, Grid
from houle.medium.integrals import edges
from houle.medium.medium import Medium
from houle.medium.sections import partition, section
from houle.medium.shapes import Shape, spans_inside

Indices = NDArray[np.intp]
BESIDE = 1e-6  # [cells] what is solid on both sides of a line, so near, is so on the line


def around(points: FloatArray, grid: Grid) -> tuple[Indices, FloatArray]:
    """The 2^k cell centres around each of the points (N, k) in the first k axes: flat numbers over those axes, weights.

    Both (N, 2^k); linear. Beyond the outermost centres the outermost one counts; periodic axes wrap.
    """
    points = np.asarray(points, float)
    index, weight = np.zeros((len(points), 1), np.intp), np.ones((len(points), 1))
    for a in range(points.shape[1]):
        n, s = grid.shape[a], points[:, a] / grid.spacing[a] - 0.5
        low = np.floor(s).astype(np.intp)
        both = low[:, None] + np.array([0, 1])
        both = both % n if grid.periodic[a] else np.clip(both, 0, n - 1)
        share = np.stack([1.0 - (s - low), s - low], axis=1)
        index = (index[:, :, None] * n + both[:, None, :]).reshape(len(points), 2 << a)
        weight = (weight[:, :, None] * share[:, None, :]).reshape(len(points), 2 << a)
    return index, weight


def mean_of_known(values: FloatArray, weight: FloatArray) -> FloatArray:
    """Weighted mean (N,) of the values (N, K) that are numbers; NaN where they weigh less than half."""
    known = np.isfinite(values)
    share = np.where(known, weight, 0.0)
    total = share.sum(axis=1)
    found = np.where(known, values, 0.0)
    return np.where(total >= 0.5, (share * found).sum(axis=1) / np.maximum(total, 0.5), np.nan)


def wet_share(flow: Flow, columns: Any) -> FloatArray:
    """Share of each cell that is under water, from its bottom up, in some columns (..., nz).

    Cells between the water and a surface tell by their depth; those deeper are wet, however the particles lie in them.
    """
    kind, opened = flow.medium.listed("open_cells")
    active, open_ = flow.active[columns] > 0, opened[kind[columns]] > 0.0
    covered = np.ones(active.shape, bool)
    covered[..., :-1] = active[..., 1:] | ~open_[..., 1:]
    return np.where(active & covered, 1.0, np.clip(flow.submergence[columns] + 0.5, 0.0, 1.0))


def crossings(area: shapely.Geometry, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest z [m] of the area on the upright lines at x (N,) [m]; NaN where it is not."""
    low, high = np.full(len(x), np.inf), np.full(len(x), -np.inf)
    for (x0, z0), (x1, z1) in edges(area, (1.0, 1.0)):
        hit = (x >= min(x0, x1)) & (x <= max(x0, x1))
        if x0 == x1:
            ends = np.full((2, int(hit.sum())), [[min(z0, z1)], [max(z0, z1)]])
        else:
            ends = np.stack([z0 + (x[hit] - x0) / (x1 - x0) * (z1 - z0)] * 2)
        low[hit], high[hit] = np.minimum(low[hit], ends[0]), np.maximum(high[hit], ends[1])
    return np.where(low <= high, low, np.nan), np.where(low <= high, high, np.nan)


def ground(grid: Grid, medium: Medium, x: FloatArray) -> FloatArray:
    """Level (rows, N) [m] on which the water stands at x (N,): top of solids and porous bodies, 0 on the floor.

    One row per cell in y, one in 2D.
    """
    parts = partition(grid, medium.bodies, medium.solids)
    tops = [np.nan_to_num(crossings(shapely.union_all([solid, *areas]), x)[1]) for _, solid, areas in parts]
    if grid.dimension == 2:
        return tops[0][None]
    spans = [span for span, _, _ in parts]
    return np.stack([tops[layer_at(spans, y)] for y in grid.axis_points(1)])


def layer_at(spans: Sequence[tuple[float, float]], y: float) -> int:
    """The number of the layer that holds y [m]; 0 in 2D."""
    return next((i for i, (low, high) in enumerate(spans) if low <= y <= high), 0)


class SolidsAt:
    """The solids on upright lines at places (N, d - 1) in plan: number (K,) of the line, low and high (K,) ends [m].

    From the lowest up. A line along the face of a solid is outside. hangs (K,): whether there is room below.
    """

    def __init__(self, grid: Grid, medium: Medium, places: FloatArray) -> None:
        parts = partition(grid, medium.bodies, medium.solids)
        spans, margin = [span for span, _, _ in parts], BESIDE * grid.spacing[0]
        layer = np.array([layer_at(spans, p[1]) if len(p) == 2 else 0 for p in places], int)
        found: list[tuple[int, float, float]] = []
        for i in np.unique(layer):
            solid, here = parts[i][1], np.flatnonzero(layer == i)
            for x in [] if solid.is_empty else np.unique(places[here, 0]):
                left, right = (spans_inside(solid, x + side * margin) for side in (-1, 1))
                both = [(max(a, c), min(b, d)) for a, b in left for c, d in right if max(a, c) < min(b, d)]
                found += [(int(n), a, b) for n in here[places[here, 0] == x] for a, b in both]
        rows = np.array(found).reshape(-1, 3)
        self.number, self.low, self.high = rows[:, 0].astype(int), rows[:, 1], rows[:, 2]
        self.hangs = self.low > 0.0

    def holds(self, level: FloatArray) -> NDArray[np.bool_]:
        """Which of the solids (K,) the levels (N,) lie inside."""
        return (level[self.number] > self.low) & (level[self.number] < self.high)


def body_levels(grid: Grid, medium: Medium, shape: Shape, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Bottom and top (N,) [m] of a body at places (N, 1 or 2) in plan, without the solids in it; NaN beside it."""
    low, high = np.full(len(places), np.nan), np.full(len(places), np.nan)
    parts = partition(grid, medium.bodies, medium.solids, [shape])
    spans = [span for span, _, _ in parts]
    for i, place in enumerate(places):
        span, solid, _ = parts[layer_at(spans, place[1]) if len(place) == 2 else 0]
        area = section(grid, [shape], span).difference(solid)
        low[i], high[i] = (v[0] for v in crossings(area, place[:1]))
    return low, high


def open_spans(area: shapely.Geometry, x: float, grid: Grid, low: float, high: float) -> FloatArray:
    """From where to where (nz, 2) [m] the upright line at x is open in each cell, between two levels.

    area: the solids of the section. Where a cell has several openings, the lowest is taken.
    """
    line = shapely.linestrings([[x, max(low, 0.0)], [x, min(high, grid.size[-1])]])
    free = shapely.difference(line, area)
    parts = [shapely.bounds(p)[[1, 3]] for p in shapely.get_parts(free) if p.length > 0]
    h, nz = grid.spacing[-1], grid.shape[-1]
    found = np.zeros((nz, 2))
    for bottom, top in sorted(parts, key=lambda p: -p[0]):
        k = np.arange(max(0, int(bottom / h + 1e-9)), min(nz, int(np.ceil(top / h - 1e-9))))
        found[k, 0], found[k, 1] = np.maximum(bottom, k * h), np.minimum(top, (k + 1) * h)
    return found
