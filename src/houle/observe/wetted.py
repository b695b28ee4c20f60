"""How much of the cells is under water, where a column has no single level."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.flow import Flow
from houle.grid import FloatArray


def without_level(flow: Flow) -> NDArray[np.bool_]:
    """Columns, grid.shape[:-1], whose surface is that of their cells: steep, overhanging, splashing, or beside such."""
    return flow.eta != flow.column * flow.grid.spacing[-1]


def wetted(flow: Flow, columns: NDArray[np.bool_]) -> FloatArray:
    """Share (N, nz) of each cell of the N columns marked that is under water, an upright front as exact as a level."""
    number = np.flatnonzero(columns)
    share = np.empty((len(number), flow.grid.shape[-1]))
    _core.wetted(flow.grid.core, flow.depth, flow.medium.open_cells, number, share)
    return share
