"""Shapes of water, porous bodies and solids: the points that they cover, the distance to them, their exact sections.

Every shape is an area in the (x, z) plane; in 3D it is that area over a span of y (a box has its own span, a polygon
and a level reach over all y). So the union, difference and overlap of shapes are exact: in each layer of y, in which no
section changes, they follow from polygon algebra (shapely). `integrals.py` integrates over the result. A shape is
closed: its boundary belongs to it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
Span = tuple[float, float]  # least and largest y [m]; `EVERYWHERE` in 2D
Window = tuple[float, float, float, float]  # x_min, z_min, x_max, z_max [m]
SLIVER = 1e-12  # share of the box around a ring: a smaller face comes from rounding
EVERYWHERE: Span = (-np.inf, np.inf)


class Shape(Protocol):
    """A closed region of space."""

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper corner (d,) of the smallest box around the shape [m]; infinite where it does not end."""

    @property
    def span(self) -> Span:
        """Lowest and highest y of the shape [m]."""

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """True (...) for the points (..., d) [m] in the shape or on its boundary."""

    def distance(self, points: ArrayLike) -> FloatArray:
        """Signed distance (...) [m] of points (..., d) from the boundary of the shape, positive outside."""

    def section(self, window: Window) -> shapely.Geometry:
        """Section of the shape in the (x, z) plane, cut to a window [m]."""


@dataclass(frozen=True)
class Box:
    """Everything between two corners (d,) [m], which may be infinite."""

    lower: tuple[float, ...]
    upper: tuple[float, ...]

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        return np.array(self.lower), np.array(self.upper)

    @property
    def span(self) -> Span:
        return (self.lower[1], self.upper[1]) if len(self.lower) == 3 else EVERYWHERE

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        x = np.asarray(points, float)
        return np.all((x >= self.lower) & (x <= self.upper), axis=-1)

    def distance(self, points: ArrayLike) -> FloatArray:
        x = np.asarray(points, float)
        beyond = np.maximum(np.subtract(self.lower, x), np.subtract(x, self.upper))  # distance beyond a side, per axis
        return np.linalg.norm(np.maximum(beyond, 0), axis=-1) + np.minimum(beyond.max(axis=-1), 0)

    def section(self, window: Window) -> shapely.Geometry:
        x0, z0 = max(self.lower[0], window[0]), max(self.lower[-1], window[1])
        x1, z1 = min(self.upper[0], window[2]), min(self.upper[-1], window[3])
        return shapely.box(x0, z0, x1, z1) if x0 < x1 and z0 < z1 else shapely.Polygon()


@dataclass(frozen=True)
class Polygon:
    """A polygon in the (x, z) plane, over all y in 3D."""

    outline: shapely.Geometry  # a polygon, or several
    dimension: int

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        x0, z0, x1, z1 = self.outline.bounds
        if self.dimension == 2:
            return np.array([x0, z0]), np.array([x1, z1])
        return np.array([x0, -np.inf, z0]), np.array([x1, np.inf, z1])

    @property
    def span(self) -> Span:
        return EVERYWHERE

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        x = np.asarray(points, float)
        return covers(self.outline, x[..., 0], x[..., -1])

    def distance(self, points: ArrayLike) -> FloatArray:
        x = np.asarray(points, float)
        return signed_distance(self.outline, x[..., 0], x[..., -1])

    def section(self, window: Window) -> shapely.Geometry:
        return shapely.multipolygons(polygons(shapely.intersection(self.outline, shapely.box(*window))))


@dataclass(frozen=True)
class Union:
    """Everything in any of the parts."""

    parts: tuple[Shape, ...]

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        lower, upper = zip(*(p.bounds for p in self.parts), strict=True)
        return np.min(lower, axis=0), np.max(upper, axis=0)

    @property
    def span(self) -> Span:
        return min(p.span[0] for p in self.parts), max(p.span[1] for p in self.parts)

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        return np.any([p.contains(points) for p in self.parts], axis=0)

    def distance(self, points: ArrayLike) -> FloatArray:
        """Exact outside; inside, where parts touch or overlap, it may be nearer to zero than the truth."""
        return np.min([p.distance(points) for p in self.parts], axis=0)

    def section(self, window: Window) -> shapely.Geometry:
        return shapely.union_all([p.section(window) for p in self.parts])


def enclosed(corners: Sequence[tuple[float, float]]) -> shapely.Geometry:
    """The area inside a ring of corners, listed once around: a polygon, or several that lines join.

    Corners may repeat or lie on a line, and the ring may go back along itself, as a surveyed bed does that is closed
    along the floor: all this does not change the area. Raises ValueError where the ring crosses itself, with the place,
    and where it encloses nothing.
    """
    ring = np.asarray(corners, float)
    outline = shapely.Polygon(ring) if len(ring) > 2 else shapely.Polygon()
    if outline.is_valid and outline.area > 0:
        return outline
    ring = ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)]
    if len(ring) < 3:
        raise ValueError("has no area: give corners that enclose some")
    edges = shapely.unary_union(shapely.linestrings(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)))
    faces = polygons(shapely.polygonize([*shapely.get_parts(edges)]))
    width, height = np.ptp(ring, axis=0)
    faces = faces[shapely.area(faces) > SLIVER * width * height]
    turns = np.array([_turns(ring, shapely.point_on_surface(face)) for face in faces], int)
    if not turns.any():
        raise ValueError("has no area: give corners that enclose some")
    way = np.sign(turns[np.argmax(shapely.area(faces) * (turns != 0))])
    if (wrong := (turns != 0) & (turns != way)).any():
        x, z = _crossing(ring, faces[wrong][0])
        raise ValueError(f"crosses itself at [{x:g}, {z:g}]: list its corners in order, going round once")
    return shapely.union_all(faces[turns != 0])


def _turns(ring: FloatArray, place: shapely.Point) -> int:
    """Number of times that the ring goes round a place, anticlockwise."""
    (x, z), (x1, z1) = ring.T, np.roll(ring, -1, axis=0).T
    left = (x1 - x) * (place.y - z) - (z1 - z) * (place.x - x)
    up, down = (z <= place.y) & (z1 > place.y) & (left > 0), (z > place.y) & (z1 <= place.y) & (left < 0)
    return int(up.sum()) - int(down.sum())


def _crossing(ring: FloatArray, face: shapely.Polygon) -> tuple[float, float]:
    """A place (x, z) where edges of the ring cross: the corner of the face that is farthest from those of the ring."""
    found = shapely.get_coordinates(face)
    far = shapely.distance(shapely.points(found), shapely.multipoints(ring))
    x, z = found[np.argmax(far)]
    return float(x), float(z)


def pieces(shapes: Iterable[Shape]) -> list[Shape]:
    """The shapes with every union taken apart."""
    found: list[Shape] = []
    for shape in shapes:
        found += pieces(shape.parts) if isinstance(shape, Union) else [shape]
    return found


def polygons(area: shapely.Geometry) -> NDArray[np.object_]:
    """The polygons in a geometry, without the lines and points where shapes only touch."""
    parts = shapely.get_parts(shapely.get_parts(area))
    return parts[(shapely.get_type_id(parts) == shapely.GeometryType.POLYGON) & ~shapely.is_empty(parts)]


def covers(area: shapely.Geometry, x: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
    """True for the points of the section that lie in the area or on its boundary."""
    shapely.prepare(area)
    return shapely.intersects_xy(area, x, z)


def spans_inside(area: shapely.Geometry, x: float) -> list[tuple[float, float]]:
    """Lower and upper ends [m] of the pieces of the upright line at x that lie in the area, the lowest first."""
    low, high = shapely.bounds(area)[[1, 3]]
    if not low < high:
        return []
    line = shapely.linestrings([[x, low - 1.0], [x, high + 1.0]])
    parts = [p for p in shapely.get_parts(shapely.intersection(area, line)) if shapely.length(p) > 0.0]
    return sorted((float(z0), float(z1)) for z0, z1 in (shapely.bounds(p)[[1, 3]] for p in parts))


def signed_distance(area: shapely.Geometry, x: FloatArray, z: FloatArray) -> FloatArray:
    """Distance [m] in the section from the boundary of the area, negative inside."""
    outline = shapely.boundary(area)
    shapely.prepare(outline)
    far = shapely.distance(outline, shapely.points(x, z))
    return np.where(covers(area, x, z), -far, far)
