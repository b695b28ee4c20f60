"""Sections of the tank: the areas that shapes cover in it, and how porous bodies and solids share it.

In 3D the tank is a stack of layers in y. The (x, z) section of every shape is the same throughout a layer, so the areas
in a layer are exact polygons, as in 2D, where there is one layer.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import shapely

from houle.grid import FloatArray, Grid
from houle.medium.shapes import EVERYWHERE, Shape, Span, Window, pieces


@dataclass(frozen=True)
class PorousBody:
    """A region of one porous material, as the water feels it.

    The drag per unit mass of water is a u_d + b |u_d| u_d with the Darcy velocity u_d. on_rate: whether the added mass
    stands before du/dt alone, and not before (u . grad) u as well, (4b) in docs/theory.md.
    """

    name: str
    shape: Shape
    porosity: float  # pore volume over total volume [-]
    a: float = 0.0  # [1/s]
    b: float = 0.0  # [1/m]
    inertia: float = 1.0  # C_r [-]
    on_rate: bool = False

    @property
    def convective(self) -> float:
        """K, the coefficient of the convective acceleration [-]."""
        return 1.0 if self.on_rate else self.inertia


def layers(grid: Grid, shapes: Iterable[Shape]) -> list[Span]:
    """The layers: spans of y [m], from wall to wall, in each of which no section of a shape changes; one in 2D."""
    if grid.dimension == 2:
        return [EVERYWHERE]
    width = grid.size[1]
    ends = {0.0, width} | {float(y) for shape in pieces(shapes) for y in shape.span if 0 < y < width}
    return list(itertools.pairwise(sorted(ends)))


def section(grid: Grid, shapes: Sequence[Shape], layer: Span = EVERYWHERE) -> shapely.Geometry:
    """The area of the (x, z) section of the tank that the shapes cover together in a layer, one of `layers`."""
    here = [s for s in pieces(shapes) if s.span[0] <= layer[0] and layer[1] <= s.span[1]]
    return shapely.union_all([s.section(_window(grid)) for s in here]) if here else shapely.Polygon()


def repeated(grid: Grid, area: shapely.Geometry, mirrored: bool = False) -> shapely.Geometry:
    """An area of the section together with its copies beside the tank along periodic axes [m].

    mirrored: together with its mirror images behind the walls as well.
    """
    for a, axis in ((0, 0), (1, -1)) if not area.is_empty else ():
        size, unit = grid.size[axis], np.eye(2)[a]
        copies = []
        if grid.periodic[axis]:
            copies = [_moved(area, np.ones(2), shift * unit) for shift in (-size, size)]
        elif mirrored:
            copies = [_moved(area, 1 - 2 * unit, 2 * wall * unit) for wall in (0.0, size)]
        area = shapely.union_all([area, *copies]) if copies else area
    return area


def _moved(area: shapely.Geometry, factor: FloatArray, shift: FloatArray) -> shapely.Geometry:
    """An area with its points multiplied by a factor (2,) and moved by a shift (2,) [m]."""
    return shapely.transform(area, lambda points: factor * points + shift)


class Layer(NamedTuple):
    """One layer of the tank in y, with disjoint areas in its section [m].

    span    the y between which it lies [m]
    solid   area of all solids
    bodies  area of each porous body, in the order of the case, without the parts in which something replaces it
    """

    span: Span
    solid: shapely.Geometry
    bodies: list[shapely.Geometry]


def partition(
    grid: Grid, bodies: Sequence[PorousBody], solids: Sequence[Shape], also: Sequence[Shape] = ()
) -> list[Layer]:
    """The layers of the tank with disjoint areas: a solid replaces bodies, a body replaces those before it.

    also: other shapes whose sections must not change inside a layer either.
    """
    found = []
    for span in layers(grid, [*solids, *(b.shape for b in bodies), *also]):
        solid = taken = section(grid, solids, span)
        areas: list[shapely.Geometry] = []
        for body in reversed(bodies):
            whole = section(grid, [body.shape], span)
            areas.insert(0, whole.difference(taken))
            taken = taken.union(whole)
        found.append(Layer(span, solid, areas))
    return found


def _window(grid: Grid) -> Window:
    return (0.0, 0.0, grid.size[0], grid.size[-1])
