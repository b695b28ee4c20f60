"""Sponges: a linear resistance that grows towards a side of the tank and takes up the waves that go there."""

from __future__ import annotations

import numpy as np

from houle.grid import Faces, FloatArray, Grid

Box = tuple[tuple[float, ...], tuple[float, ...]]


def sides(box: Box, size: tuple[float, ...], near: float) -> list[tuple[int, bool]]:
    """(horizontal axis, at its far end) of the sides of the tank that a box touches, `near` [m] being touched.

    An axis along which the box goes from side to side does not count: nothing goes that way.
    """
    low, high = box
    found = []
    for a in range(len(size) - 1):
        touches = (low[a] <= near, high[a] >= size[a] - near)
        if touches[0] != touches[1]:
            found.append((a, touches[1]))
    return found


def way_in(box: Box, points: FloatArray, grid: Grid) -> FloatArray:
    """Share of the way from the edge of the sponge to the side of the tank at points (..., d); 0 outside the box."""
    low, high = (np.asarray(corner) for corner in box)
    margin = 1e-9 * min(grid.spacing)
    inside = np.all((points >= low - margin) & (points <= high + margin), axis=-1)
    way = np.zeros(points.shape[:-1])
    for a, far in sides(box, grid.size, min(grid.spacing) / 2):
        along = (points[..., a] - low[a]) / (high[a] - low[a])
        way = np.maximum(way, along if far else 1 - along)
    return np.where(inside, np.clip(way, 0, 1), 0.0)


def way_length(box: Box, grid: Grid) -> float:
    """How far it is through the sponge to the side of the tank [m], the shortest way."""
    low, high = box
    return min(high[a] - low[a] for a, _ in sides(box, grid.size, min(grid.spacing) / 2))


def resist(box: Box, strength: float, grid: Grid, rate: Faces) -> None:
    """Adds the sponge's rate to the linear resistance of the faces [1/s]: strength times the squared way in."""
    for axis, r in enumerate(rate):
        r += strength * way_in(box, grid.points(axis), grid) ** 2
