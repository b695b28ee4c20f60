"""The sides of thin solids: on which side of a plate a gauge has its water, and what the plate hides from it.

Thin solids are thickened to a cell (thin_solids.py), so an instrument on a plate, as it is drawn, may lie in the
solid.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid
from houle.medium.sections import layers, section
from houle.medium.shapes import Shape
from houle.medium.thin_solids import NEAR, Thickened

STEPS, FARTHEST = 16, 48  # steps per cell, and at most, in which a way out of the windows is looked for


def on_their_side(grid: Grid, solids: Sequence[Shape], points: FloatArray) -> FloatArray:
    """Places (N, d) [m] at which points (N, d) on or beside a thin solid find their water.

    Points in a window that counts as solid are moved out of it, away from the solid as it is drawn; others stay.
    """
    found, spacing = points.copy(), min(grid.spacing)
    for solid in solids:
        if not isinstance(solid, Thickened):
            continue
        number = np.flatnonzero(solid.windows.contains(points))
        away = _away(grid, solid.drawn, points[number], NEAR * spacing)
        for step in np.arange(1, FARTHEST + 1) * (spacing / STEPS):
            inside = solid.contains(found[number])
            moved = points[number[inside]] + step * away[inside]
            found[number[inside]] = np.where(grid.periodic, moved % grid.size, moved)
    return found


def behind_plates(grid: Grid, solids: Sequence[Shape], points: FloatArray, others: FloatArray) -> NDArray[np.bool_]:
    """True (N, K) where a solid lies between a point (N, d) and one of its others (N, K, d) [m], both outside it.

    Along periodic axes the nearest copy of the other point counts.
    """
    copies = np.zeros_like(others)
    for axis in np.flatnonzero(grid.periodic):
        copies[..., axis] = grid.size[axis] * np.round((others - points[:, None])[..., axis] / grid.size[axis])
    hidden = _between(grid, solids, np.broadcast_to(points[:, None], others.shape), others - copies)
    if copies.any():  # the other end of a line that leaves the domain
        hidden |= _between(grid, solids, points[:, None] + copies, others)
    return hidden


def _between(grid: Grid, solids: Sequence[Shape], start: FloatArray, end: FloatArray) -> NDArray[np.bool_]:
    """True (N, K) where a solid lies on the line between two points (N, K, d) [m] outside it."""
    hidden = np.zeros(start.shape[:2], bool)
    if not solids or not start.size:
        return hidden
    line = shapely.linestrings(np.stack([start, end], axis=2)[..., [0, -1]])
    y0, y1 = np.minimum(start[..., 1], end[..., 1]), np.maximum(start[..., 1], end[..., 1])
    for low, high in layers(grid, solids):
        area = section(grid, solids, (low, high))
        inside = shapely.contains(area, shapely.points(start[..., [0, -1]]))
        free = ~inside & ~shapely.intersects(area, shapely.points(end[..., [0, -1]]))
        between = free & (shapely.length(shapely.intersection(area, line)) > NEAR * grid.spacing[0])
        if grid.dimension == 3:
            between &= (low <= start[..., 1]) & (start[..., 1] <= high)
            between |= inside & (y0 <= low) & (high <= y1)  # a plate that is thin in y
        hidden |= between
    return hidden


def _away(grid: Grid, shape: Shape, points: FloatArray, step: float) -> FloatArray:
    """Unit vectors (N, d) out of a shape, or away from it, at points (N, d) [m]: gradient of the signed distance.

    The gradient is taken over `step` [m] to both sides. Copies of the shape along periodic axes count.
    """
    by = [(-size, 0.0, size) if wraps else (0.0,) for size, wraps in zip(grid.size, grid.periodic, strict=True)]

    def distance(at: FloatArray) -> FloatArray:
        return np.min([shape.distance(at + np.array(copy)) for copy in product(*by)], axis=0)

    ends = [[distance(points + side * step * axis) for side in (-1, 1)] for axis in np.eye(points.shape[1])]
    slope = np.stack([high - low for low, high in ends], axis=-1) / (2.0 * step)
    return slope / np.maximum(np.linalg.norm(slope, axis=-1, keepdims=True), 1e-12)
