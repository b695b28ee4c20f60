"""Water that passes an upright section at x: discharge through the pores and above, and volume that has come over."""

from __future__ import annotations

import numpy as np
import shapely

from houle.flow.crest import Crest
from houle.flow.state import Flow
from houle.grid import FloatArray, Grid
from houle.medium.medium import Medium
from houle.medium.sections import partition
from houle.observe.profile import around, layer_at, open_spans, wet_share


class Section:
    """Discharge [m^d/s] towards larger x between two levels: Darcy velocity of the faces times the wetted opening."""

    def __init__(self, flow: Flow, x: float, low: float = -np.inf, high: float = np.inf) -> None:
        grid = flow.grid
        s = np.clip(x / grid.spacing[0], 0.0, grid.shape[0])
        self.face = min(int(s), grid.shape[0] - 1)
        self.share = s - self.face  # of the next face
        column, weight = around(np.array([[x]]), grid)
        self.column, weight = column[0], weight[0][:, None] * (flow.medium.open_cells[column[0]].reshape(2, -1) > 0)
        total = weight.sum(axis=0)
        self.weight = weight / np.where(total > 0, total, 1.0)
        spans, areas = _solid_sections(grid, flow.medium)
        rows = [0.0] if grid.dimension == 2 else grid.axis_points(1)
        self.spans = np.stack([open_spans(areas[layer_at(spans, y)], x, grid, low, high) for y in rows])
        self.bottom = np.arange(grid.shape[-1]) * grid.spacing[-1]
        self.width = 1.0 if grid.dimension == 2 else grid.spacing[1]

    def discharge(self, flow: Flow) -> float:
        low, high = flow.passing(0)[[self.face, self.face + 1]]
        u = (1.0 - self.share) * low + self.share * high
        wet = (self.weight * wet_share(flow, self.column).reshape(2, -1)).sum(axis=0).reshape(-1, len(self.bottom))
        top = self.bottom + flow.grid.spacing[-1] * wet
        opening = np.clip(top, self.spans[..., 0], self.spans[..., 1]) - self.spans[..., 0]
        return self.width * float(np.sum(u.reshape(opening.shape) * opening))


class Overtopping:
    """Volume [m^d] of water that has crossed x above a level since the start, and its rate in the last step."""

    def __init__(self, flow: Flow, x: float, level: float | None, to_the_right: bool) -> None:
        self.crest = Crest(flow.grid, flow.medium, x, level, to_the_right)
        self.volume, self.discharge = 0.0, 0.0
        flow.crests.append(self.crest)

    def after_step(self, dt: float) -> None:
        """Reads what the crest booked in a step of dt [s]."""
        before, self.volume = self.volume, self.crest.passed
        self.discharge = (self.volume - before) / dt

    @property
    def state(self) -> FloatArray:
        return np.array([self.volume, self.discharge])

    @state.setter
    def state(self, values: FloatArray) -> None:
        self.volume, self.discharge = map(float, values)
        self.crest.passed = self.volume


def _solid_sections(grid: Grid, medium: Medium) -> tuple[list[tuple[float, float]], list[shapely.Geometry]]:
    parts = partition(grid, medium.bodies, medium.solids)
    return [span for span, _, _ in parts], [solid for _, solid, _ in parts]
