"""Profile of the free surface: its level over the whole plan, for surface.nc and the pictures."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from houle.flow.state import Flow
from houle.grid import FloatArray
from houle.observe.levels import Columns


class Profile:
    """Level of the free surface [m] at the centres of all columns of cells, as gauges there would read it.

    It has no level where a solid stands on the floor up to the water; NaN there and where it is dry.
    """

    def __init__(self, flow: Flow) -> None:
        self.flow = flow

    def levels(self) -> FloatArray:
        """The levels [m] in the present flow, grid.shape[:-1], in a new array."""
        level, _, buried = self._columns.levels(self.flow)
        level[buried] = np.nan
        return level.reshape(self.flow.eta.shape)

    @cached_property
    def _columns(self) -> Columns:
        return Columns(self.flow, np.arange(self.flow.eta.size))
