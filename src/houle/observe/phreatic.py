"""[[phreatic]]: the phreatic line, the level of the water in the pores of a structure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from houle.errors import metres
from houle.fields import LEVEL, Field, Stations
from houle.flow.observer import Instrument, Now, Observer, Remark, Sample, Site, along, outside
from houle.flow.state import Flow
from houle.grid import FloatArray, Grid
from houle.medium.medium import Medium
from houle.medium.sections import partition, section
from houle.medium.shapes import Shape
from houle.observe.levels import SolidsAt, around, crossings, layer_at, mean_of_known, out_of_solids


@dataclass(frozen=True)
class Phreatic(Instrument):
    """The phreatic line in the porous body of this name, at some x [m]; by default at every column of the grid in it.

    y  in 3D, the upright plane in which the line lies [m]
    """

    name: str
    body: str
    x: tuple[float, ...] | None = None
    y: float | None = None

    def places(self, site: Site) -> FloatArray:
        """The places (N, d - 1) in plan [m]."""
        x = np.array(self.x or self._columns(site))
        return x[:, None] if self.y is None else np.stack([x, np.full(len(x), self.y)], axis=1)

    def _columns(self, site: Site) -> FloatArray:
        lower, upper = site.porous[self.body].bounds
        x = site.grid.axis_points(0)
        inside = x[(x >= lower[0]) & (x <= upper[0])]
        return inside if len(inside) else np.array([0.5 * (lower[0] + upper[0])])

    def check(self, site: Site) -> Iterator[Remark]:
        """The places lie in the body, and in the tank."""
        low, high = (float(corner[0]) for corner in site.porous[self.body].bounds)
        for x in self.x or ():
            if not max(low, 0.0) <= x <= min(high, site.grid.size[0]):
                text = f"= {x:g} lies beside porous.{self.body}, {low:g} <= x <= {high:g} m.{metres(x, high)}"
                yield Remark("error", "x", text)
        if self.y is not None:
            yield from outside(site, "y", self.y, 1)


class PhreaticLines(Observer[Phreatic]):
    """Levels [m] above z = 0 of all phreatic lines, one line after the other."""

    table = "phreatic"
    instrument = Phreatic
    fields = (
        Field(
            "phreatic_level",
            r"\eta_p",
            "m",
            "phreatic",
            "level of the water in the pores of the body above the datum z = 0, not a number where they are dry",
            standard_name=LEVEL,
        ),
    )

    def __init__(self, instruments: Sequence[Phreatic], site: Site, flow: Flow) -> None:
        self.lines = [PoreLevels(flow, site.porous[line.body], line.places(site)) for line in instruments]

    @classmethod
    def stations(cls, instruments: Sequence[Phreatic], site: Site) -> Stations:
        places = [line.places(site) for line in instruments]
        names = [line.name for line, at in zip(instruments, places, strict=True) for _ in at]
        letters = "xy"[: site.grid.dimension - 1]
        return Stations(names, along("phreatic line", np.concatenate(places), letters), cls.fields)

    def sample(self, now: Now) -> Sample:
        return {"phreatic_level": np.concatenate([line.levels(now.flow) for line in self.lines])}


class PoreLevels:
    """Level [m] of the water in the pores of a body at places in plan (N, d - 1); NaN where they are dry.

    It is the first surface met on the way up, so that water which runs over a dry core is not taken for a full one,
    and no higher than the body, nor inside a solid.
    """

    def __init__(self, flow: Flow, shape: Shape, places: FloatArray) -> None:
        grid, medium = flow.grid, flow.medium
        column, self.weight = around(places, grid)
        self.columns, self.number = np.unique(column, return_inverse=True)
        self.number = self.number.reshape(column.shape)
        self.closed = medium.open_cells.reshape(-1, grid.shape[-1])[self.columns] == 0.0
        self.bottom, self.top = body_levels(grid, medium, shape, places)
        self.solids = SolidsAt(grid, medium, places)

    def levels(self, flow: Flow) -> FloatArray:
        """The levels (N,) [m] in the present flow."""
        depth = flow.submergence.reshape(-1, flow.grid.shape[-1])[self.columns]
        columns = first_surface(depth, self.closed, flow.grid.spacing[-1])[self.number]
        level = out_of_solids(self.solids, mean_of_known(columns, self.weight), columns, self.weight)
        with np.errstate(invalid="ignore"):
            return np.where(level > self.bottom, np.minimum(level, self.top), np.nan)


def first_surface(depth: FloatArray, closed: NDArray[np.bool_], h: float) -> FloatArray:
    """Level (N,) [m] of the lowest free surface in columns of cells, NaN where dry.

    depth (N, nz): of the cell centres below the surface, in cells (theory, eq. (8)). Closed cells are passed. Where the
    cells under one are full the water is confined by it, and the level is their upper end.
    """
    rows, nz = np.arange(len(depth)), depth.shape[1]
    dry = (depth < 0.0) & ~closed
    first = np.where(dry.any(axis=1), dry.argmax(axis=1), nz)
    above = depth[rows, np.minimum(first, nz - 1)]
    last = np.where(~closed & (np.arange(nz) < first[:, None]), np.arange(nz), -1).max(axis=1)  # open cell below it
    below = depth[rows, last]
    with np.errstate(divide="ignore", invalid="ignore"):
        between = first - 0.5 + below / (below - above)
    low = np.where(above > -0.5 + 1e-6, first + 0.5 + above, np.nan)  # less than half of the first cell
    confined = last + 1.0  # under closed cells
    return h * np.where(last < 0, low, np.where(last == first - 1, np.where(first == nz, nz, between), confined))


def body_levels(grid: Grid, medium: Medium, shape: Shape, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Bottom and top (N,) [m] of a body at places (N, d - 1) in plan, without the solids in it; NaN beside it."""
    low, high = np.full(len(places), np.nan), np.full(len(places), np.nan)
    parts = partition(grid, medium.bodies, medium.solids, [shape])
    spans = [span for span, _, _ in parts]
    for i, place in enumerate(places):
        span, solid, _ = parts[layer_at(spans, place[1]) if len(place) == 2 else 0]
        area = section(grid, [shape], span).difference(solid)
        low[i], high[i] = (v[0] for v in crossings(area, place[:1]))
    return low, high
