"""How much water columns of cells hold that have no level of their own, as the surface shows it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.flow import Flow
from houle.grid import FloatArray

Cells = NDArray[np.bool_]


def without_level(flow: Flow) -> Cells:
    """Columns, grid.shape[:-1], whose surface is that of their cells: steep, overhanging, splashing, or beside such."""
    return flow.eta != flow.column * flow.grid.spacing[-1]


def water_held(flow: Flow) -> tuple[Cells, FloatArray]:
    """Columns without a level, or beside interfaces and solids; water (these,) in them over their plan area [m].

    Of what its tent holds, the sum behind its fill, each cell counts as its place to the surface says.

    * Under the surface: all, however the particles lie there.
    * Cut by the surface: the share under it, an upright front as exact as a level; or what is there, if the column has
      a level.
    * Outside, and where water or air is too thin for the grid to show a surface: what is there. Too thin are sheets,
      drops and crevices, and bubbles, which leave the place of a particle empty or more.
    """
    grid, steep = flow.grid, without_level(flow)
    columns = steep.copy()
    columns.ravel()[flow.mixed.column] = True
    if not columns.any():
        return columns, np.empty(0)
    number, kind = np.flatnonzero(steep), np.empty(grid.shape, np.uint8)
    share = np.empty((len(number), grid.shape[-1]))
    _core.wetted(grid.core, flow.depth, flow.medium.open_cells, number, share)
    _core.shown(grid.core, flow.active, flow.medium.open_cells, flow.fill, kind)
    held, inverse = np.minimum(flow.fill[columns], 1.0), flow.inverse_capacity[columns]
    held[kind[columns] == 2] = 1.0
    held[steep[columns]] = np.where(kind[steep] == 1, share, held[steep[columns]])
    water = np.divide(held, inverse, out=np.zeros_like(held), where=inverse > 0.0)
    return columns, grid.spacing[-1] / grid.cell_volume * water.sum(axis=-1)
