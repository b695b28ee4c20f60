"""Water of the columns of cells that have no level of their own, as the surface shows it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.flow.state import Flow
from houle.grid import FloatArray


def water_held(flow: Flow) -> tuple[NDArray[np.bool_], FloatArray]:
    """Columns without a level and beside interfaces and solids; water (these,) in them over their plan area [m].

    Without a level are those whose surface is that of their cells: steep, overhanging, splashing, or beside such.
    """
    columns = flow.eta != flow.single_level * flow.grid.spacing[-1]
    columns.ravel()[flow.mixed.column] = True
    number = np.flatnonzero(columns)
    held = np.empty(len(number))
    cells = (flow.active, flow.medium.listed("open_cells"), flow.fill, flow.inverse_capacity)
    _core.water_held(flow.grid.core, *cells, flow.water_height, number, held)
    return columns, flow.grid.spacing[-1] / flow.grid.cell_volume * held
