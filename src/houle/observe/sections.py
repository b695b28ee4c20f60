"""Water that passes an upright section at x: discharge through the pores and above, and volume that has come over."""

from __future__ import annotations

import numpy as np
import shapely

from houle.flow import Flow
from houle.grid import FloatArray, Grid
from houle.observe.profile import around, layer_at, open_spans, wet_share
from houle.porous import Medium, partition


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

    @property
    def closed(self) -> bool:
        return not bool(np.any(self.spans[..., 1] > self.spans[..., 0]))

    def discharge(self, flow: Flow) -> float:
        u = (1.0 - self.share) * flow.velocity[0][self.face] + self.share * flow.velocity[0][self.face + 1]
        wet = (self.weight * wet_share(flow, self.column).reshape(2, -1)).sum(axis=0).reshape(-1, len(self.bottom))
        top = self.bottom + flow.grid.spacing[-1] * wet
        opening = np.clip(top, self.spans[..., 0], self.spans[..., 1]) - self.spans[..., 0]
        return self.width * float(np.sum(u.reshape(opening.shape) * opening))


class Overtopping:
    """Volume [m^d] of water that has passed x above a level since the start, and its rate of change.

    It is the change of the water volume behind x, less what the faces let through below the level. Behind a crest that
    is tight below that level the second part is nothing: the volume is then that of the particles themselves, which
    neither remeshing nor the position correction changes, and no discharge has to be summed up over the run. A
    particle passes little by little, over one cell on each side (with the tent function as density).
    """

    def __init__(self, flow: Flow, x: float, level: float | None, to_the_right: bool) -> None:
        self.x, self.sign = x, 1.0 if to_the_right else -1.0
        below = Section(flow, x, high=level) if level is not None else None
        self.below = None if below is None or below.closed else below
        self.start, self.leaked = self.behind(flow), 0.0
        self.volume, self.discharge = 0.0, 0.0

    def behind(self, flow: Flow) -> float:
        """Water behind x less what came in there through an open side [m^d]; the particles are sorted by x first."""
        grid, p = flow.grid, flow.particles
        per_column = int(np.prod(grid.shape[1:]))
        i = int(self.x / grid.spacing[0])
        near = [int(flow.start[min(max(j, 0), grid.shape[0]) * per_column]) for j in (i - 1, i + 2)]
        s = np.clip(self.sign * (p.position[near[0] : near[1], 0] - self.x) / grid.spacing[0], -1.0, 1.0)
        passed = np.where(s < 0.0, 0.5 * (1.0 + s) ** 2, 1.0 - 0.5 * (1.0 - s) ** 2)
        far = p.volume[near[1] :] if self.sign > 0 else p.volume[: near[0]]
        through = sum(side.came - side.went for side in flow.sides if side.far == (self.sign > 0))
        return float(far.sum() + np.sum(p.volume[near[0] : near[1]] * passed)) - through

    def after_step(self, flow: Flow, dt: float) -> None:
        """Books a step of dt [s]; the velocities are those of its middle."""
        if self.below is not None:
            self.leaked += dt * self.sign * self.below.discharge(flow)
        before, self.volume = self.volume, self.behind(flow) - self.start - self.leaked
        self.discharge = (self.volume - before) / dt

    @property
    def state(self) -> FloatArray:
        return np.array([self.start, self.leaked, self.volume, self.discharge])

    @state.setter
    def state(self, values: FloatArray) -> None:
        self.start, self.leaked, self.volume, self.discharge = map(float, values)


def _solid_sections(grid: Grid, medium: Medium) -> tuple[list[tuple[float, float]], list[shapely.Geometry]]:
    parts = partition(grid, medium.bodies, medium.solids)
    return [span for span, _, _ in parts], [solid for _, solid, _ in parts]
