"""Rows of cells that a run keeps: those that water can soon be in, without the dry air up to the top of the tank.

A run starts with the rows up to the highest thing that the case places, and `MARGIN`. Before the water comes within
`HEADROOM` of the uppermost row there are more of them: the flow is built anew on the higher grid and goes on from its
state. Above the rows the domain is air; results always have the grid of the whole domain.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from houle import _core
from houle.grid import Grid

if TYPE_CHECKING:
    from houle.flow.state import Flow

HEADROOM = 8  # rows that stay dry: a step looks 6 of them above the water, and the water rises by less than one
MARGIN = 12  # rows above what the case places, when the run starts
GROWTH = 1.2  # of the number of rows, when there are too few
PROGRAM = 6e7  # bytes of memory: Python, its libraries
PER_PARTICLE = 68  # bytes, measured as `houle bench --large` does
PER_CELL = {2: 255, 3: 390}  # bytes of a cell in the rows that are kept, by dimension


def memory(grid: Grid, particles: float, rows: int) -> float:
    """[bytes] of a run with so many particles that keeps so many rows of cells of a grid."""
    columns = math.prod(grid.shape[:-1])
    return PROGRAM + PER_PARTICLE * particles + PER_CELL[grid.dimension] * columns * rows


def more_rows(flow: Flow, most: int) -> int:
    """For the next step, up to `most`, with the fill of the cells now."""
    rows = flow.grid.shape[-1]
    if rows == most or not _core.water_above(flow.grid.core, flow.fill, rows - HEADROOM):
        return rows
    return min(most, max(rows + MARGIN, math.ceil(GROWTH * rows)))
