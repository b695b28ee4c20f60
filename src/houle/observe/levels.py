"""Levels of the water in columns of cells, and the solids under, over and beside that water.

    around, mean_of_known   from the columns of the grid to a place between them
    wet_share               share of each cell that is under water
    SolidsAt                the solids on the upright lines at places in plan
    Columns                 levels of columns of cells, beside, under and on solids

The places of solids are exact for polygons, and found once, before the run.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.flow.state import Flow
from houle.grid import FloatArray, Grid
from houle.medium.integrals import edges
from houle.medium.medium import Medium
from houle.medium.sections import partition
from houle.medium.shapes import spans_inside

Indices = NDArray[np.intp]
Plan = tuple[slice | Indices, ...] | Indices  # columns of cells, by their indices in plan

BESIDE = 1e-6  # [cells] a point of a line is solid if it is solid so far to the left and to the right
THIN = 0.25  # depth of water on a solid [cells] that counts as none: less than a layer of particles
CLEAR = 2.0  # depth of water on a solid [cells] from which on the cells show its surface exactly


def around(points: FloatArray, grid: Grid) -> tuple[Indices, FloatArray]:
    """The 2^k cell centres around points (N, k) in the first k axes: their flat numbers over these axes, and weights.

    Both are (N, 2^k), for linear interpolation. Beyond the outermost centres the outermost one counts; periodic axes
    wrap.
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


def wet_share(flow: Flow, columns: Plan) -> FloatArray:
    """Share of each cell that is under water, from its bottom up, in some columns (..., nz).

    A cell at the surface is wet by its depth; deeper ones are wet, however the particles lie in them.
    """
    kind, opened = flow.medium.listed("open_cells")
    active, open_ = flow.active[columns] > 0, opened[kind[columns]] > 0.0
    covered = np.ones(active.shape, bool)
    covered[..., :-1] = active[..., 1:] | ~open_[..., 1:]
    return np.where(active & covered, 1.0, np.clip(flow.submergence[columns] + 0.5, 0.0, 1.0))


def layer_at(spans: Sequence[tuple[float, float]], y: float) -> int:
    """The number of the layer that holds y [m]; 0 in 2D."""
    return next((i for i, (low, high) in enumerate(spans) if low <= y <= high), 0)


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


class SolidsAt:
    """The solids on upright lines at places (N, d - 1) in plan: number (K,) of the line, low and high (K,) ends [m].

    They are ordered from the lowest up. A line along the face of a solid is outside. hangs (K,): true if the solid does
    not stand on the floor.
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
        """Mask (K,) of the solids inside which the levels (N,) [m] lie."""
        return (level[self.number] > self.low) & (level[self.number] < self.high)


class Columns:
    """Levels of some columns of cells (C,), given by their flat numbers over the plan, as they are at their centres.

    The level that the core finds may lie inside a solid. Where a solid hangs over the water and the water reaches
    it, the surface is not free but confined, and the level is the underside; where water stands on the solid, the level
    is that of this water.
    """

    def __init__(self, flow: Flow, number: Indices) -> None:
        grid, plan = flow.grid, flow.grid.shape[:-1]
        self.number = number
        at = [(i + 0.5) * h for i, h in zip(np.unravel_index(number, plan), grid.spacing, strict=False)]
        self.solids = SolidsAt(grid, flow.medium, np.stack(at, axis=1))
        self.ponds = Ponds(flow, self.solids, number)

    def levels(self, flow: Flow) -> tuple[FloatArray, NDArray[np.bool_], NDArray[np.bool_]]:
        """Levels (C,) [m], NaN where dry; masks (C,): confined ones, ones in a solid on the floor."""
        level = self.ponds.levels(flow, flow.eta.ravel()[self.number])
        confined, buried = np.zeros((2, len(level)), bool)
        inside = self.solids.holds(level)
        for solids, found in ((inside & self.solids.hangs, confined), (inside & ~self.solids.hangs, buried)):
            found[self.solids.number[solids]] = True
        level[self.solids.number[inside & self.solids.hangs]] = self.solids.low[inside & self.solids.hangs]
        return level, confined, buried


class Ponds:
    """Water that stands on solids which do not stand on the floor, at the centres of some columns (C,)."""

    def __init__(self, flow: Flow, solids: SolidsAt, column: Indices) -> None:
        grid, nz = flow.grid, flow.grid.shape[-1]
        self.at, self.top = solids.number[solids.hangs], solids.high[solids.hangs]
        self.column = column[self.at]
        h, k = grid.spacing[-1], np.arange(nz)
        floor = np.floor(self.top / h + 1e-9).astype(int)[:, None]  # the cell in which it stands
        inverse = flow.inverse_capacity.reshape(-1, nz)[self.column] * flow.medium.porosity.reshape(-1, nz)[self.column]
        tent = np.divide(1.0, inverse, out=np.zeros_like(inverse), where=inverse > 0.0)  # open volume of each
        whole = tent.max(axis=1, initial=1e-300, where=(k >= floor) & (k < floor + 3))[:, None]
        away = np.clip(self.top[:, None] / h - (k + 0.5), -1.0, 1.0)  # height of the top above the centres [cells]
        over = np.where(away < 0.0, 1.0 - 0.5 * (1.0 + away) ** 2, 0.5 * (1.0 - away) ** 2)  # share of tents above
        self.height = h * np.minimum(tent / whole, over)  # water [m] on the solid in each full tent
        self.below, self.thin = k < floor, THIN * h

    def levels(self, flow: Flow, level: FloatArray) -> FloatArray:
        """The levels (C,) [m] with those of columns under such water replaced by its own, in a new array."""
        found = level.copy()
        if len(self.at) == 0:
            return found
        fill = flow.fill.reshape(-1, flow.grid.shape[-1])[self.column]
        wet = np.logical_and.accumulate((fill >= 0.5) | self.below, axis=1)  # from the solid up without a gap
        for _ in range(2):  # and the two above it, which the surface may reach
            wet[:, 1:] |= wet[:, :-1]
        depth = (fill * self.height * wet).sum(axis=1)
        with np.errstate(invalid="ignore"):
            seen = (depth <= self.thin) | ((found[self.at] > self.top) & (depth > CLEAR * self.thin / THIN))
        found[self.at[~seen]] = (self.top + depth)[~seen]
        return found


def out_of_solids(solids: SolidsAt, level: FloatArray, columns: FloatArray, weight: FloatArray) -> FloatArray:
    """The levels (N,), those inside a solid moved to where the water is.

    The water is on the solid if most of the columns (N, K) around, by their weights, stand higher than it. Else it is
    confined below, and its level is the underside; NaN for a solid on the floor.
    """
    inside = np.flatnonzero(solids.holds(level))
    found, n = level.copy(), solids.number[inside]
    on_top = mean_of_known(np.where(columns[n] >= solids.high[inside, None], columns[n], np.nan), weight[n])
    below = np.where(solids.hangs[inside], solids.low[inside], np.nan)
    found[n] = np.where(np.isnan(on_top), below, on_top)
    return found
