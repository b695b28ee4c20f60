"""[[gauge]]: level of the free surface at places in plan."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from houle.fields import LEVEL, Field, Stations
from houle.flow.observer import Instrument, Now, Observer, Remark, Sample, Site, along, outside
from houle.flow.state import Flow
from houle.grid import FloatArray
from houle.medium.plate_sides import behind_plates, on_their_side
from houle.medium.thin_solids import Thickened
from houle.observe.levels import Columns, Indices, SolidsAt, around, mean_of_known, out_of_solids


@dataclass(frozen=True)
class Gauge(Instrument):
    """A gauge at x, in 3D at (x, y) [m]."""

    name: str
    x: float
    y: float | None = None

    @property
    def place(self) -> tuple[float, ...]:
        """The place in plan [m]."""
        return (self.x,) if self.y is None else (self.x, self.y)

    def check(self, site: Site) -> Iterator[Remark]:
        """The gauge stands in the tank, and not in a solid from the floor to the lid."""
        for axis, (key, value) in enumerate(zip("xy", self.place, strict=False)):
            yield from outside(site, key, value, axis)
        z = site.grid.axis_points(site.grid.dimension - 1)
        line = np.stack([*(np.full_like(z, at) for at in self.place), z], axis=-1)
        for name, solid in site.solid.items():
            if np.all(solid.distance(line) < 0):
                yield Remark("warning", "x", f"= {self.x:g} lies in solid.{name}, floor to lid: it reads nothing")


class Gauges(Observer[Gauge]):
    """Level of the free surface [m] above z = 0 at places in plan (N, d - 1), linear between columns; NaN when dry.

    A level is where water is, never inside a solid. Under a solid that the water reaches it is the underside; where
    water stands on a solid, it is the level of that water. Water that is confined beside the place of a gauge does not
    count, nor does water behind a plate.
    """

    table = "gauge"
    instrument = Gauge
    fields = (
        Field(
            "eta",
            r"\eta",
            "m",
            "gauge",
            "level of the free surface above the datum z = 0, not a number where the gauge is dry",
            standard_name=LEVEL,
        ),
    )

    def __init__(self, instruments: Sequence[Gauge], site: Site, flow: Flow) -> None:
        points = _beside_plates(flow, np.array([gauge.place for gauge in instruments], float))
        column, self.weight = around(points, flow.grid)
        number, at = np.unique(column, return_inverse=True)
        self.columns, self.at = Columns(flow, number), at.reshape(column.shape)
        self.solids = SolidsAt(flow.grid, flow.medium, points)
        self.hidden, self.spacing = _hidden(flow, points, column), flow.grid.spacing[-1]

    @classmethod
    def stations(cls, instruments: Sequence[Gauge], site: Site) -> Stations:
        places = along("gauge", [gauge.place for gauge in instruments], "xy"[: site.grid.dimension - 1])
        return Stations([gauge.name for gauge in instruments], places, cls.fields)

    def sample(self, now: Now) -> Sample:
        return {"eta": self.levels(now.flow)}

    def levels(self, flow: Flow) -> FloatArray:
        """The levels (N,) [m] in the present flow."""
        level, confined, _ = self.columns.levels(flow)
        level, confined = level[self.at], confined[self.at] | self._behind(level[self.at])
        free = np.where(confined, 0.0, self.weight)
        share = free.sum(axis=1, keepdims=True)
        left_out = confined.any(axis=1, keepdims=True) & (share > 0.0)
        found = mean_of_known(level, np.where(left_out, free / np.where(left_out, share, 1.0), self.weight))
        return out_of_solids(self.solids, found, level, self.weight)

    def _behind(self, level: FloatArray) -> NDArray[np.bool_]:
        """Mask (N, K) of the columns around whose level [m] lies behind a plate."""
        row = np.clip(np.nan_to_num(level) // self.spacing, 0, self.hidden.shape[2] - 1).astype(np.intp)
        return np.take_along_axis(self.hidden, row[..., None], axis=2)[..., 0]


def _hidden(flow: Flow, places: FloatArray, column: Indices) -> NDArray[np.bool_]:
    """Mask (N, K, nz): a thin solid stands between the places (N, d - 1) and the columns (N, K) around, in each row."""
    grid, d, nz, (n, k) = flow.grid, flow.grid.dimension, flow.grid.shape[-1], column.shape
    there = np.swapaxes(grid.points().reshape(-1, nz, d)[column], 1, 2)  # (N, nz, K, d)
    here = np.concatenate([np.repeat(places[:, None], nz, axis=1), there[:, :, 0, -1:]], axis=2)
    found = behind_plates(grid, flow.medium.solids, here.reshape(-1, d), there.reshape(-1, k, d))
    return np.swapaxes(found.reshape(n, nz, k), 1, 2)


def _beside_plates(flow: Flow, places: FloatArray) -> FloatArray:
    """The places (N, d - 1) in plan, moved to the water on their side where a thin solid divides their cells.

    The side is told halfway up these cells.
    """
    found = places.copy()
    for solid in flow.medium.solids:
        if not isinstance(solid, Thickened):
            continue
        ends = np.array([cell.bounds for cell in solid.windows.parts])  # lower and upper corners
        for i, place in enumerate(places):
            over = ((ends[:, 0, :-1] <= place) & (place <= ends[:, 1, :-1])).all(axis=1)
            if over.any():
                height = np.sort(ends[over, :, -1].mean(axis=1))[over.sum() // 2]
                found[i] = on_their_side(flow.grid, [solid], np.array([[*place, height]]))[0, :-1]
    return found
