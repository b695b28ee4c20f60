"""[[flux]]: discharge through an upright section, through the pores and above."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from houle.fields import Field, Stations
from houle.flow.observer import Instrument, Now, Observer, Remark, Sample, Site, outside
from houle.flow.state import Flow
from houle.grid import FloatArray, Grid
from houle.medium.medium import Medium
from houle.medium.sections import partition
from houle.observe.levels import around, layer_at, wet_share


@dataclass(frozen=True)
class Flux(Instrument):
    """An upright section at x between two levels [m]; from the floor to the lid when they are left out."""

    name: str
    x: float
    between: tuple[float, float] | None = None

    def check(self, site: Site) -> Iterator[Remark]:
        """The section lies in the tank and is not empty."""
        yield from outside(site, "x", self.x, 0)
        for level in self.between or ():
            yield from outside(site, "between", level, site.grid.dimension - 1)
        if self.between is not None and self.between[0] >= self.between[1]:
            text = f"= {list(self.between)} is empty: the lower level stands first"
            yield Remark("error", "between", text)


class Fluxes(Observer[Flux]):
    """Discharge through each section."""

    table = "flux"
    instrument = Flux
    fields = (
        Field(
            "discharge",
            "q",
            "m3 s-1",
            "flux",
            "discharge of water through the upright section, positive towards larger x",
            unit_2d="m2 s-1",
            instant="velocity",
        ),
    )

    def __init__(self, instruments: Sequence[Flux], site: Site, flow: Flow) -> None:
        self.openings = [Opening(flow, one.x, *(one.between or (-np.inf, np.inf))) for one in instruments]

    @classmethod
    def stations(cls, instruments: Sequence[Flux], site: Site) -> Stations:
        low, high = np.array([one.between or (0.0, site.grid.size[-1]) for one in instruments]).T
        places = {
            "x": ("position of the section along x", [one.x for one in instruments]),
            "from": ("level of the lower end of the section", low.tolist()),
            "to": ("level of the upper end of the section", high.tolist()),
        }
        return Stations([one.name for one in instruments], places, cls.fields)

    def sample(self, now: Now) -> Sample:
        return {"discharge": np.array([opening.discharge(now.flow) for opening in self.openings])}


class Opening:
    """An upright section at x between two levels [m], in rows of one cell in y.

    The discharge through it is the Darcy velocity of the faces beside it times its wetted openings.
    """

    def __init__(self, flow: Flow, x: float, low: float = -np.inf, high: float = np.inf) -> None:
        grid = flow.grid
        s = np.clip(x / grid.spacing[0], 0.0, grid.shape[0])
        self.face = min(int(s), grid.shape[0] - 1)
        self.share = s - self.face  # weight of the next face
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
        """Discharge towards larger x [m^d/s] in the present flow."""
        low, high = flow.passing(0)[[self.face, self.face + 1]]
        u = (1.0 - self.share) * low + self.share * high
        wet = (self.weight * wet_share(flow, self.column).reshape(2, -1)).sum(axis=0).reshape(-1, len(self.bottom))
        top = self.bottom + flow.grid.spacing[-1] * wet
        opening = np.clip(top, self.spans[..., 0], self.spans[..., 1]) - self.spans[..., 0]
        return self.width * float(np.sum(u.reshape(opening.shape) * opening))


def open_spans(area: shapely.Geometry, x: float, grid: Grid, low: float, high: float) -> FloatArray:
    """Lower and upper end (nz, 2) [m] of the opening of each cell on the upright line at x, between two levels.

    area: the solids of the section. Where a cell has several openings, the lowest is taken.
    """
    line = shapely.linestrings([[x, max(low, 0.0)], [x, min(high, grid.size[-1])]])
    free = shapely.difference(line, area)
    parts = [shapely.bounds(p)[[1, 3]] for p in shapely.get_parts(free) if p.length > 0]
    h, nz = grid.spacing[-1], grid.shape[-1]
    found = np.zeros((nz, 2))
    for bottom, top in sorted(parts, key=lambda p: -p[0]):
        k = np.arange(max(0, int(bottom / h + 1e-9)), min(nz, int(np.ceil(top / h - 1e-9))))
        found[k, 0], found[k, 1] = np.maximum(bottom, k * h), np.minimum(top, (k + 1) * h)
    return found


def _solid_sections(grid: Grid, medium: Medium) -> tuple[list[tuple[float, float]], list[shapely.Geometry]]:
    """The layers in y [m], and the section of the solids in each."""
    parts = partition(grid, medium.bodies, medium.solids)
    return [span for span, _, _ in parts], [solid for _, solid, _ in parts]
