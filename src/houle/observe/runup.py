"""[[runup]]: run-up, the end of the water that is connected with the sea, on a slope or at a wall."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from houle.fields import LEVEL, Field, Stations
from houle.flow.observer import Instrument, Now, Observer, Remark, Sample, Site, outside
from houle.flow.state import Flow
from houle.grid import FloatArray, Grid
from houle.medium.medium import Medium
from houle.medium.sections import partition
from houle.observe.levels import crossings, layer_at

PARTS = 16  # parts of a cell: the profile of the slope is known at their ends


@dataclass(frozen=True)
class RunUp(Instrument):
    """A stretch of slope from x in the water to x at the crest or the wall [m].

    threshold  thickness of water that is not counted [m]; half a spacing when left out
    """

    name: str
    x: tuple[float, float]
    threshold: float | None = None

    def check(self, site: Site) -> Iterator[Remark]:
        """The stretch lies in the tank and has columns of cells in it."""
        h = site.grid.spacing[0]
        for end in self.x:
            yield from outside(site, "x", end, 0)
        if abs(self.x[1] - self.x[0]) < 2 * h:
            text = f"= {list(self.x)} is shorter than 2 spacings of {h:.3g} m: from the water to the crest or the wall"
            yield Remark("error", "x", text)


class RunUps(Observer[RunUp]):
    """Position and level [m] of the end of the connected water on each stretch of slope."""

    table = "runup"
    instrument = RunUp
    fields = (
        Field(
            "runup_x",
            "x_R",
            "m",
            "runup",
            "position along x of the end of the connected water on the slope, not a number where the slope is dry",
        ),
        Field(
            "runup_level",
            "R",
            "m",
            "runup",
            "level above the datum z = 0 of the end of the connected water on the slope, not a number where it is dry",
            standard_name=LEVEL,
        ),
    )

    def __init__(self, instruments: Sequence[RunUp], site: Site, flow: Flow) -> None:
        self.tips = [Tip(flow, one.x, one.threshold or 0.5 * flow.grid.spacing[0]) for one in instruments]

    @classmethod
    def stations(cls, instruments: Sequence[RunUp], site: Site) -> Stations:
        ends = {
            "from": ("end of the stretch of slope in the water", [one.x[0] for one in instruments]),
            "to": ("end of the stretch of slope at the crest or the wall", [one.x[1] for one in instruments]),
        }
        return Stations([one.name for one in instruments], ends, cls.fields)

    def sample(self, now: Now) -> Sample:
        x, level = np.array([tip.find(now.flow) for tip in self.tips]).T
        return {"runup_x": x.copy(), "runup_level": level.copy()}


class Tip:
    """The tip (x, level) [m] of the water between `ends` = (x in the water, x up the slope), NaN when the first is dry.

    From the seaward end the columns are followed as long as the water above solids and porous bodies is thicker than
    the threshold. Between the last such column and the next, the surface goes on along the straight line through the
    last two columns; the tip is where that line comes nearer to the slope than the threshold. At a wall it is where the
    surface meets the wall. In 3D it is the highest tip of all rows.
    """

    def __init__(self, flow: Flow, ends: tuple[float, float], threshold: float) -> None:
        grid = flow.grid
        h, self.threshold = grid.spacing[0], threshold
        low, high = (int(np.floor(x / h + 1e-9)) for x in sorted(ends))
        count = min(high, grid.shape[0] - 1) - low + 1
        self.columns = slice(low, low + count)
        self.way = 1 if ends[1] > ends[0] else -1
        self.x = grid.axis_points(0)[self.columns][:: self.way]
        reach = max(abs(ends[1] - self.x[0]), h / PARTS)
        self.fine = self.x[0] + self.way * np.minimum(np.arange(count * PARTS + 1) * h / PARTS, reach)
        self.slope, self.bed = ground(grid, flow.medium, self.fine), ground(grid, flow.medium, self.x)
        nz = grid.shape[-1]
        k = np.ceil(self.bed / grid.spacing[-1] - 1e-9).astype(int)
        self.films = np.minimum(k[..., None] + np.arange(3), nz - 1)  # cells just above the ground (rows, N, 3)

    def find(self, flow: Flow) -> tuple[float, float]:
        """The tip (x, level) [m] in the present flow."""
        n = len(self.x)
        level = self._levels(flow)
        wet = level - self.bed > self.threshold
        last = np.where(wet.all(axis=1), n, wet.argmin(axis=1)) - 1
        some = np.flatnonzero(last >= 0)
        if len(some) == 0:
            return np.nan, np.nan
        level, last, every = level[some], last[some], np.arange(len(some))
        here = level[every, last]
        steepness = here - level[every, np.maximum(last - 1, 0)]  # per cell
        at = np.minimum(last[:, None] * PARTS + np.arange(PARTS + 1), self.fine.size - 1)
        away = self.way * (self.fine[at] - self.x[last][:, None]) / flow.grid.spacing[0]  # [cells]
        line = here[:, None] + steepness[:, None] * away
        spare = line - self.slope[some[:, None], at] - self.threshold
        end = np.where((spare <= 0).any(axis=1), (spare <= 0).argmax(axis=1), PARTS)
        s0, s1 = spare[every, np.maximum(end - 1, 0)], spare[every, end]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where((s1 <= 0) & (s0 > 0), s0 / (s0 - s1), 1.0)

        def between(values: FloatArray) -> FloatArray:
            first = values[every, np.maximum(end - 1, 0)]
            return first + share * (values[every, end] - first)

        x, z = between(self.fine[at]), between(line)
        top = int(np.argmax(z))
        return float(x[top]), float(z[top])

    def _levels(self, flow: Flow) -> FloatArray:
        """Level of the water above the ground (rows, N) [m]; below the ground where there is none."""
        count = len(self.x)
        eta = flow.eta[self.columns].reshape(count, -1).T[:, :: self.way]
        fill = flow.fill[self.columns].reshape(count, -1, flow.grid.shape[-1]).transpose(1, 0, 2)[:, :: self.way]
        film = flow.grid.spacing[-1] * np.take_along_axis(fill, self.films, axis=2).sum(axis=2)
        with np.errstate(invalid="ignore"):
            return np.where(eta > self.bed, eta, self.bed + film)  # a sheet of water over dry pores


def ground(grid: Grid, medium: Medium, x: FloatArray) -> FloatArray:
    """Level (rows, N) [m] on which the water stands at x (N,): top of solids and porous bodies, 0 on the floor.

    One row per cell in y, one in 2D.
    """
    parts = partition(grid, medium.bodies, medium.solids)
    tops = [np.nan_to_num(crossings(shapely.union_all([solid, *areas]), x)[1]) for _, solid, areas in parts]
    if grid.dimension == 2:
        return tops[0][None]
    spans = [span for span, _, _ in parts]
    return np.stack([tops[layer_at(spans, y)] for y in grid.axis_points(1)])
