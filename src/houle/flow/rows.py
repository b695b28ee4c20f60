"""Rows of cells that a run keeps: those that water can reach soon, without the dry air up to the top of the tank.

A run starts with the rows up to the highest thing that the case places, and `MARGIN` more. When the water comes within
`HEADROOM` rows of the top one, the flow is built anew on a higher grid and goes on from its state. Above the rows the
domain is air; results always have the grid of the whole domain.
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
GROWTH = 1.2  # factor on the number of rows, when there are too few
PROGRAM = 6e7  # bytes of memory of Python and its libraries
PER_PARTICLE = 68  # bytes of memory, measured as `houle bench --large` does
PER_CELL = {2: 255, 3: 390}  # bytes of memory per cell in the rows that are kept, by dimension


def memory(grid: Grid, particles: float, rows: int) -> float:
    """Memory [bytes] of a run with this number of particles that keeps this number of rows of cells of a grid."""
    columns = math.prod(grid.shape[:-1])
    return PROGRAM + PER_PARTICLE * particles + PER_CELL[grid.dimension] * columns * rows


def more_rows(flow: Flow, most: int) -> int:
    """Number of rows that the flow needs for the next step, `most` at most; those that it has if they suffice."""
    rows = flow.grid.shape[-1]
    if rows == most or not _core.water_above(flow.grid.core, flow.fill, rows - HEADROOM):
        return rows
    return min(most, max(rows + MARGIN, math.ceil(GROWTH * rows)))
