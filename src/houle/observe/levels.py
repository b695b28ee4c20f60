"""Levels of the water: gauges of the free surface, and the phreatic line, the level in the pores of a structure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from houle.flow.state import Flow
from houle.grid import FloatArray
from houle.medium.plate_sides import behind_plates, on_their_side
from houle.medium.shapes import Shape
from houle.medium.thin_solids import Thickened
from houle.observe.profile import Indices, SolidsAt, around, body_levels, mean_of_known

THIN = 0.25  # cells of water on a solid that are not taken for its level: less than a layer of particles
CLEAR = 2.0  # cells of water on a solid from which on the cells show its surface exactly


class Columns:
    """Levels of some columns of cells (C,), given by their flat numbers over the plan, as they are at their centres.

    The core finds the free surface whatever solid may be there. Where one hangs over the water, and the room below is
    full, the surface is not free but confined, and the level is the underside; where water stands on it, the level is
    that of this water.
    """

    def __init__(self, flow: Flow, number: Indices) -> None:
        grid, plan = flow.grid, flow.grid.shape[:-1]
        self.number = number
        at = [(i + 0.5) * h for i, h in zip(np.unravel_index(number, plan), grid.spacing, strict=False)]
        self.solids = SolidsAt(grid, flow.medium, np.stack(at, axis=1))
        self.ponds = Ponds(flow, self.solids, number)

    def levels(self, flow: Flow) -> tuple[FloatArray, NDArray[np.bool_], NDArray[np.bool_]]:
        """Levels (C,) [m], NaN where dry; which (C,) are confined; which lie in a solid that stands on the floor."""
        level = self.ponds.raise_(flow, flow.eta.ravel()[self.number])
        confined, buried = np.zeros((2, len(level)), bool)
        inside = self.solids.holds(level)
        for solids, found in ((inside & self.solids.hangs, confined), (inside & ~self.solids.hangs, buried)):
            found[self.solids.number[solids]] = True
        level[self.solids.number[inside & self.solids.hangs]] = self.solids.low[inside & self.solids.hangs]
        return level, confined, buried


class Ponds:
    """Water that stands on solids with room below, over the centres of some columns (C,)."""

    def __init__(self, flow: Flow, solids: SolidsAt, column: Indices) -> None:
        grid, nz = flow.grid, flow.grid.shape[-1]
        self.at, self.top = solids.number[solids.hangs], solids.high[solids.hangs]
        self.column = column[self.at]
        h, k = grid.spacing[-1], np.arange(nz)
        floor = np.floor(self.top / h + 1e-9).astype(int)[:, None]  # the cell in which it stands
        inverse = flow.inverse_capacity.reshape(-1, nz)[self.column] * flow.medium.porosity.reshape(-1, nz)[self.column]
        room = np.divide(1.0, inverse, out=np.zeros_like(inverse), where=inverse > 0.0)
        whole = room.max(axis=1, initial=1e-300, where=(k >= floor) & (k < floor + 3))[:, None]
        away = np.clip(self.top[:, None] / h - (k + 0.5), -1.0, 1.0)  # of the top from the centres [cells]
        over = np.where(away < 0.0, 1.0 - 0.5 * (1.0 + away) ** 2, 0.5 * (1.0 - away) ** 2)  # of each tent, above it
        self.height = h * np.minimum(room / whole, over)  # of the water on the solid in each tent when it is full
        self.below, self.thin = k < floor, THIN * h

    def raise_(self, flow: Flow, level: FloatArray) -> FloatArray:
        """The levels (C,) [m], those under a pond replaced by its own, in a new array."""
        found = level.copy()
        if len(self.at) == 0:
            return found
        fill = flow.fill.reshape(-1, flow.grid.shape[-1])[self.column]
        wet = np.logical_and.accumulate((fill >= 0.5) | self.below, axis=1)  # from the solid up without a gap
        for _ in range(2):  # and what the surface leaves in the cells above
            wet[:, 1:] |= wet[:, :-1]
        depth = (fill * self.height * wet).sum(axis=1)
        with np.errstate(invalid="ignore"):
            seen = (depth <= self.thin) | ((found[self.at] > self.top) & (depth > CLEAR * self.thin / THIN))
        found[self.at[~seen]] = (self.top + depth)[~seen]
        return found


class Gauges:
    """Level of the free surface [m] above z = 0 at places in plan (N, d - 1), linear between columns; NaN when dry.

    A level is where water is, never inside a solid: under one whose room below is full it is the underside, where
    water stands on it the level of that. Water that is confined beside a place has no level there, nor has water behind
    a plate.
    """

    def __init__(self, flow: Flow, places: Sequence[Sequence[float]]) -> None:
        points = np.array(places, float).reshape(-1, flow.grid.dimension - 1)
        points = _beside_plates(flow, points)
        column, self.weight = around(points, flow.grid)
        number, at = np.unique(column, return_inverse=True)
        self.columns, self.at = Columns(flow, number), at.reshape(column.shape)
        self.solids = SolidsAt(flow.grid, flow.medium, points)
        self.hidden, self.spacing = _hidden(flow, points, column), flow.grid.spacing[-1]

    def levels(self, flow: Flow) -> FloatArray:
        level, confined, _ = self.columns.levels(flow)
        level, confined = level[self.at], confined[self.at] | self._behind(level[self.at])
        free = np.where(confined, 0.0, self.weight)
        share = free.sum(axis=1, keepdims=True)
        left_out = confined.any(axis=1, keepdims=True) & (share > 0.0)
        found = mean_of_known(level, np.where(left_out, free / np.where(left_out, share, 1.0), self.weight))
        return outside(self.solids, found, level, self.weight)

    def _behind(self, level: FloatArray) -> NDArray[np.bool_]:
        """Which of the columns (N, K) around have their level [m] behind a plate."""
        row = np.clip(np.nan_to_num(level) // self.spacing, 0, self.hidden.shape[2] - 1).astype(np.intp)
        return np.take_along_axis(self.hidden, row[..., None], axis=2)[..., 0]


def _hidden(flow: Flow, places: FloatArray, column: Indices) -> NDArray[np.bool_]:
    """Whether a thin solid stands between places (N, d - 1) and columns (N, K) around them, in each row: (N, K, nz)."""
    grid, d, nz, (n, k) = flow.grid, flow.grid.dimension, flow.grid.shape[-1], column.shape
    there = np.swapaxes(grid.points().reshape(-1, nz, d)[column], 1, 2)  # (N, nz, K, d)
    here = np.concatenate([np.repeat(places[:, None], nz, axis=1), there[:, :, 0, -1:]], axis=2)
    found = behind_plates(grid, flow.medium.solids, here.reshape(-1, d), there.reshape(-1, k, d))
    return np.swapaxes(found.reshape(n, nz, k), 1, 2)


def _beside_plates(flow: Flow, places: FloatArray) -> FloatArray:
    """The places (N, d - 1) in plan; those in cells that a thin solid divides moved to the water on their side of it,
    which is told halfway up these cells.
    """
    found = places.copy()
    for solid in flow.medium.solids:
        if not isinstance(solid, Thickened):
            continue
        ends = np.array([cell.bounds for cell in solid.windows.parts])  # lower and upper corners
        for i, place in enumerate(places):
            over = ((ends[:, 0, :-1] <= place) & (place <= ends[:, 1, :-1])).all(axis=1)
            if over.any():
                height = np.sort(ends[over, :, -1].mean(axis=1))[over.sum() // 2]
                found[i] = on_their_side(flow.grid, [solid], np.array([[*place, height]]))[0, :-1]
    return found


class Profile:
    """Level (columns) [m] at the centres of all columns of cells, as that of gauges there."""

    def __init__(self, flow: Flow) -> None:
        self.columns = Columns(flow, np.arange(flow.eta.size))

    def levels(self, flow: Flow) -> FloatArray:
        level, _, buried = self.columns.levels(flow)
        level[buried] = np.nan
        return level.reshape(flow.eta.shape)


def outside(solids: SolidsAt, level: FloatArray, columns: FloatArray, weight: FloatArray) -> FloatArray:
    """The levels (N,), those inside a solid moved to where the water is.

    If most of the columns (N, K) around, by their weights, stand higher than the solid, on it; else the water is
    confined below, at the underside; NaN where that is the floor.
    """
    inside = np.flatnonzero(solids.holds(level))
    found, n = level.copy(), solids.number[inside]
    on_top = mean_of_known(np.where(columns[n] >= solids.high[inside, None], columns[n], np.nan), weight[n])
    below = np.where(solids.hangs[inside], solids.low[inside], np.nan)
    found[n] = np.where(np.isnan(on_top), below, on_top)
    return found


class Phreatic:
    """Level [m] of the water in the pores of a body at places in plan (N, d - 1); NaN where they are dry.

    It is the first surface met on the way up, so that water which runs over a dry core is not taken for a full one,
    and no higher than the body, nor inside a solid.
    """

    def __init__(self, flow: Flow, shape: Shape, places: FloatArray) -> None:
        grid, medium = flow.grid, flow.medium
        column, self.weight = around(places, grid)
        self.columns, self.number = np.unique(column, return_inverse=True)
        self.number = self.number.reshape(column.shape)
        self.closed = medium.open_cells.reshape(-1, grid.shape[-1])[self.columns] == 0.0
        self.bottom, self.top = body_levels(grid, medium, shape, places)
        self.solids = SolidsAt(grid, medium, places)

    def levels(self, flow: Flow) -> FloatArray:
        depth = flow.submergence.reshape(-1, flow.grid.shape[-1])[self.columns]
        columns = first_surface(depth, self.closed, flow.grid.spacing[-1])[self.number]
        level = outside(self.solids, mean_of_known(columns, self.weight), columns, self.weight)
        with np.errstate(invalid="ignore"):
            return np.where(level > self.bottom, np.minimum(level, self.top), np.nan)


def first_surface(depth: FloatArray, closed: NDArray[np.bool_], h: float) -> FloatArray:
    """Level (N,) [m] of the lowest free surface of columns (N, nz), NaN where dry.

    depth: of the cell centres below the surface, in cells (theory, eq. (8)). Closed cells are passed; where the cells
    under one are full the water is confined by it, and its level is their upper end.
    """
    rows, nz = np.arange(len(depth)), depth.shape[1]
    dry = (depth < 0.0) & ~closed
    first = np.where(dry.any(axis=1), dry.argmax(axis=1), nz)
    above = depth[rows, np.minimum(first, nz - 1)]
    last = np.where(~closed & (np.arange(nz) < first[:, None]), np.arange(nz), -1).max(axis=1)  # open cell below it
    below = depth[rows, last]
    with np.errstate(divide="ignore", invalid="ignore"):
        between = first - 0.5 + below / (below - above)
    low = np.where(above > -0.5 + 1e-6, first + 0.5 + above, np.nan)  # less than half of the first cell
    confined = last + 1.0  # under closed cells
    return h * np.where(last < 0, low, np.where(last == first - 1, np.where(first == nz, nz, between), confined))
