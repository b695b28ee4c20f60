"""A case looked at as a drawing: its shapes as polygons in the (x, z) section, and what is said about them."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any, Literal

import numpy as np
import shapely
from shapely.ops import polylabel

from houle.case.messages import place
from houle.case.model import Case
from houle.grid import FloatArray
from houle.medium import sections, shapes
from houle.medium.thin_solids import solid_windows

COLUMNS = 500  # looked at for the levels of the water


@dataclass(frozen=True)
class Finding:
    """level; key the finding is about; the two numbers and the cure in words, which follow it or begin with a colon."""

    level: Literal["error", "warning", "info"]
    key: str
    text: str

    def __str__(self) -> str:
        return f"{self.key}{'' if self.text.startswith(':') else ' '}{self.text}"


@dataclass(frozen=True)
class Body:
    """An entry of water, porous or solid with its place in the file and its shape."""

    key: str
    entry: Any
    shape: shapes.Shape

    @property
    def free(self) -> bool:
        """A level fills whatever is open below it; a box or a polygon means exactly itself."""
        return self.entry.below is not None


class Section:
    """The case as polygons: bodies with their shapes, and the (x, z) window of the domain."""

    def __init__(self, case: Case) -> None:
        self.case, self.grid = case, case.domain.grid
        self.window = (0.0, 0.0, case.domain.size[0], case.domain.size[-1])
        self.water = self._bodies("water")
        self.porous = self._bodies("porous")
        self.solid = self._bodies("solid")
        self.layers = sections.layers(self.grid, [b.shape for b in self.bodies])

    @property
    def bodies(self) -> list[Body]:
        return [*self.water, *self.porous, *self.solid]

    def _bodies(self, key: str) -> list[Body]:
        rows = enumerate(getattr(self.case, key))
        d = self.case.dimension
        return [Body(place((key, i), self.case.__dict__), row, shapes.shape_of(row, d)) for i, row in rows]

    def area(self, bodies: list[Body], layer: shapes.Span) -> shapely.Geometry:
        """What the bodies cover together of the domain's section in a layer."""
        return sections.section(self.grid, [b.shape for b in bodies], layer)

    @property
    def windows(self) -> list[shapes.Box]:
        """What counts as solid besides what is drawn: the windows that thin solids part."""
        return solid_windows(self.grid, [b.shape for b in self.solid])

    def overlap(self, one: list[Body], other: list[Body]) -> tuple[float, tuple[float, ...]]:
        """Area [m2] of the largest common section over the layers, and the bounds of it in x, z."""
        common = [shapely.intersection(self.area(one, y), self.area(other, y)) for y in self.layers]
        largest = max(common, key=lambda c: c.area)
        return largest.area, largest.bounds

    @property
    def speck(self) -> float:
        """An area that does not matter [m2]."""
        return 1e-6 * self.case.domain.spacing**2

    def open_water(self, layer: shapes.Span) -> shapely.Geometry:
        return shapely.difference(self.area(self.water, layer), self.area(self.solid, layer))

    def tops(self, areas: list[shapely.Geometry]) -> FloatArray:
        """Top [m] of an area per layer over evenly spaced columns and the middles of shapes; 0 where there is none."""
        ends = [np.clip([b.shape.bounds[0][0], b.shape.bounds[1][0]], 0.0, self.window[2]) for b in self.bodies]
        x = np.concatenate([(np.arange(COLUMNS) + 0.5) / COLUMNS * self.window[2], np.mean(ends, axis=1)])
        feet, heads = (np.stack([x, np.full_like(x, z)], axis=-1) for z in (0.0, self.window[3]))
        columns = shapely.linestrings(np.stack([feet, heads], axis=1))
        return np.array([np.nan_to_num(shapely.bounds(shapely.intersection(columns, a))[:, 3]) for a in areas])

    def depth(self) -> float:
        """Highest level of the water [m]."""
        return float(self.tops([self.open_water(y) for y in self.layers]).max())

    def drop(self) -> float:
        """Highest minus lowest level of the water at the start [m]; where it is dry the floor counts."""
        water = self.tops([self.open_water(y) for y in self.layers])
        floor = self.tops([self.area(self.solid, y) for y in self.layers])
        return max(0.0, float(water.max() - np.maximum(water, floor).min()))

    def particles(self) -> float:
        """How many the water is made of: 2 per cell and axis."""
        flat = self.grid.dimension == 2
        widths = [1.0 if flat else y1 - y0 for y0, y1 in self.layers]
        volume = sum(self.open_water(y).area * w for y, w in zip(self.layers, widths, strict=True))
        return volume / self.grid.cell_volume * 2**self.grid.dimension

    def extent(self, body: Body) -> tuple[float, ...]:
        """Length [m] of the body inside the domain along each axis."""
        lower, upper = body.shape.bounds
        return tuple(np.minimum(upper, self.case.domain.size) - np.maximum(lower, 0.0))

    def thickness(self, body: Body) -> float:
        """What the grid has to resolve [m]: width of the largest circle inside a polygon, shortest side of a box.

        A side that reaches from wall to wall does not count; inf when all do.
        """
        size = self.case.domain.size
        counted = [e for e, s in zip(self.extent(body), size, strict=True) if e < s * (1 - 1e-9)]
        if body.entry.polygon is not None and counted:
            outline = body.shape.section(self.window)
            if self.extent(body)[0] >= size[0] * (1 - 1e-9):
                counted.append(outline.area / size[0])
            else:
                for part in shapes.polygons(outline):
                    centre = polylabel(part, tolerance=0.02 * min(counted))
                    counted.append(2 * centre.distance(part.boundary))
        return min(counted, default=inf)
