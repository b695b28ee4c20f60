"""A case as a drawing: its shapes as polygons in the (x, z) section of the tank."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, sqrt
from typing import Generic, TypeVar

import numpy as np
import shapely
from shapely.ops import polylabel

from houle.case.messages import place
from houle.case.model import Case
from houle.case.shapes import shape_of
from houle.case.tables.tank import Shape
from houle.grid import FloatArray
from houle.medium import sections, shapes
from houle.medium.thin_solids import solid_windows

COLUMNS = 500  # places along x at which levels are looked at


Row = TypeVar("Row", bound=Shape, covariant=True)


@dataclass(frozen=True)
class Entry(Generic[Row]):
    """One table of [[water]], [[porous]] or [[solid]]: its key in the case file, the table itself, and its shape."""

    key: str
    row: Row
    shape: shapes.Shape

    @property
    def free(self) -> bool:
        """True for a level, which fills the open space below it; a box or a polygon means exactly its own area."""
        return self.row.below is not None


class CrossSection:
    """The drawing of a case; all lengths are in metres.

    window  x_min, z_min, x_max, z_max of the tank
    water, porous, solid  the entries of these tables, with their shapes
    layers  spans of y in each of which no section changes; one in 2D
    """

    def __init__(self, case: Case) -> None:
        self.case, self.grid = case, case.domain.grid
        self.window = (0.0, 0.0, case.domain.size[0], case.domain.size[-1])
        self.water = self._entries("water", case.water)
        self.porous = self._entries("porous", case.porous)
        self.solid = self._entries("solid", case.solid)
        self.layers = sections.layers(self.grid, [entry.shape for entry in self.entries])

    @property
    def entries(self) -> list[Entry[Shape]]:
        """All entries of water, porous bodies and solids."""
        return [*self.water, *self.porous, *self.solid]

    def _entries(self, key: str, rows: Sequence[Row]) -> list[Entry[Row]]:
        d, tables = self.case.dimension, self.case.__dict__
        return [Entry(place((key, i), tables), row, shape_of(row, d)) for i, row in enumerate(rows)]

    def area(self, entries: Sequence[Entry[Shape]], layer: shapes.Span) -> shapely.Geometry:
        """The area of the section of the tank in a layer that the entries cover together."""
        return sections.section(self.grid, [entry.shape for entry in entries], layer)

    @property
    def windows(self) -> list[shapes.Box]:
        """Windows that count as solid besides the solids as they are drawn (`houle.medium.thin_solids`)."""
        return solid_windows(self.grid, [entry.shape for entry in self.solid])

    def overlap(self, one: Sequence[Entry[Shape]], other: Sequence[Entry[Shape]]) -> tuple[float, tuple[float, ...]]:
        """Area [m2] of the largest common section over the layers, and the bounds of it in x, z [m]."""
        common = [shapely.intersection(self.area(one, y), self.area(other, y)) for y in self.layers]
        largest = max(common, key=lambda c: c.area)
        return largest.area, largest.bounds

    @property
    def speck(self) -> float:
        """A smaller area does not matter [m2]."""
        return 1e-6 * self.case.domain.spacing**2

    def open_water(self, layer: shapes.Span) -> shapely.Geometry:
        """The water at the start in a layer, without the solids in it."""
        return shapely.difference(self.area(self.water, layer), self.area(self.solid, layer))

    def tops(self, areas: list[shapely.Geometry]) -> FloatArray:
        """Top [m] of an area per layer, (layers, places); 0 where there is none.

        The places are spread evenly along x, with the middles of all shapes in addition.
        """
        ends = [np.clip([e.shape.bounds[0][0], e.shape.bounds[1][0]], 0.0, self.window[2]) for e in self.entries]
        x = np.concatenate([(np.arange(COLUMNS) + 0.5) / COLUMNS * self.window[2], np.mean(ends, axis=1)])
        feet, heads = (np.stack([x, np.full_like(x, z)], axis=-1) for z in (0.0, self.window[3]))
        columns = shapely.linestrings(np.stack([feet, heads], axis=1))
        return np.array([np.nan_to_num(shapely.bounds(shapely.intersection(columns, a))[:, 3]) for a in areas])

    def standing(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Depth and level of the water at the start at x (N,) [m], both (layers, N) [m]; the level NaN where dry."""
        ends = np.stack([np.stack([x, np.full_like(x, z)], axis=-1) for z in (0.0, self.window[3])], axis=1)
        wet = [shapely.intersection(shapely.linestrings(ends), self.open_water(y)) for y in self.layers]
        return np.array([shapely.length(w) for w in wet]), np.array([shapely.bounds(w)[:, 3] for w in wet])

    def depth(self) -> float:
        """Highest level of the water at the start [m]."""
        return float(self.tops([self.open_water(y) for y in self.layers]).max())

    def drop(self) -> float:
        """Highest minus lowest level of the water at the start [m]; where it is dry, the bed counts as level."""
        water = self.tops([self.open_water(y) for y in self.layers])
        floor = self.tops([self.area(self.solid, y) for y in self.layers])
        return max(0.0, float(water.max() - np.maximum(water, floor).min()))

    def expected_speed(self) -> float:
        """Speed of the water to expect [m/s]: sqrt(2 g drop), at least a tenth of the speed of long waves, sqrt(g d).

        The depth d is taken as at least one cell.
        """
        g = max(self.case.fluid.gravity, 1e-12)
        return max(sqrt(2 * g * self.drop()), 0.1 * sqrt(g * max(self.depth(), self.grid.spacing[-1])))

    def particles(self) -> float:
        """Number of particles at the start: two per cell and axis in the water."""
        flat = self.grid.dimension == 2
        widths = [1.0 if flat else y1 - y0 for y0, y1 in self.layers]
        volume = sum(self.open_water(y).area * w for y, w in zip(self.layers, widths, strict=True))
        return volume / self.grid.cell_volume * 2**self.grid.dimension

    def extent(self, entry: Entry[Shape]) -> tuple[float, ...]:
        """Length [m] of an entry inside the tank along each axis."""
        lower, upper = entry.shape.bounds
        return tuple(np.minimum(upper, self.case.domain.size) - np.maximum(lower, 0.0))

    def thickness(self, entry: Entry[Shape]) -> float:
        """Thickness that the grid has to resolve [m]: the largest circle inside a polygon, the shortest side of a box.

        A side that reaches from wall to wall does not count; inf when all do.
        """
        size = self.case.domain.size
        counted = [e for e, s in zip(self.extent(entry), size, strict=True) if e < s * (1 - 1e-9)]
        if entry.row.polygon is not None and counted:
            outline = entry.shape.section(self.window)
            if self.extent(entry)[0] >= size[0] * (1 - 1e-9):
                counted.append(outline.area / size[0])
            else:
                for part in shapes.polygons(outline):
                    centre = polylabel(part, tolerance=0.02 * min(counted))
                    counted.append(2 * centre.distance(part.boundary))
        return min(counted, default=inf)
