"""Levels of the water: gauges of the free surface, and the phreatic line, the level in the pores of a structure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from houle.flow import Flow
from houle.geometry import Shape
from houle.grid import FloatArray
from houle.observe.profile import around, body_levels, mean_of_known


class Gauges:
    """Level of the free surface [m] above z = 0 at places in plan (N, d - 1), linear between columns; NaN when dry."""

    def __init__(self, flow: Flow, places: Sequence[Sequence[float]]) -> None:
        points = np.array(places, float).reshape(-1, flow.grid.dimension - 1)
        self.column, self.weight = around(points, flow.grid)

    def levels(self, flow: Flow) -> FloatArray:
        return mean_of_known(flow.eta.ravel()[self.column], self.weight)


class Phreatic:
    """Level [m] of the water in the pores of a body at places in plan (N, d - 1); NaN where they are dry.

    It is the first surface met on the way up, so that water which runs over a dry core is not taken for a full one,
    and no higher than the body.
    """

    def __init__(self, flow: Flow, shape: Shape, places: FloatArray) -> None:
        grid, medium = flow.grid, flow.medium
        column, self.weight = around(places, grid)
        self.columns, self.number = np.unique(column, return_inverse=True)
        self.number = self.number.reshape(column.shape)
        self.closed = medium.open_cells.reshape(-1, grid.shape[-1])[self.columns] == 0.0
        self.bottom, self.top = body_levels(grid, medium, shape, places)

    def levels(self, flow: Flow) -> FloatArray:
        depth = flow.depth.reshape(-1, flow.grid.shape[-1])[self.columns]
        level = mean_of_known(first_surface(depth, self.closed, flow.grid.spacing[-1])[self.number], self.weight)
        with np.errstate(invalid="ignore"):
            return np.where(level > self.bottom, np.minimum(level, self.top), np.nan)


def first_surface(depth: FloatArray, closed: NDArray[np.bool_], h: float) -> FloatArray:
    """Level (N,) [m] of the lowest free surface of columns (N, nz), NaN where dry.

    depth: of the cell centres below the surface, in cells (theory, eq. (8)); closed cells are passed.
    """
    rows, nz = np.arange(len(depth)), depth.shape[1]
    dry = (depth < 0.0) & ~closed
    first = np.where(dry.any(axis=1), dry.argmax(axis=1), nz)
    above = depth[rows, np.minimum(first, nz - 1)]
    below, on_ground = depth[rows, first - 1], (first == 0) | closed[rows, first - 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        between = first - 0.5 + below / (below - above)
    low = np.where(above > -0.5 + 1e-6, first + 0.5 + above, np.nan)  # less than half of the first cell
    return h * np.where(first == nz, nz, np.where(on_ground, low, between))
