"""What stands at a place: level of the surface at gauges, pressure and Darcy velocity at points."""

from __future__ import annotations

import numpy as np

from houle import _core
from houle.flow import Flow
from houle.grid import FloatArray


def levels_at(flow: Flow, places: list[tuple[float, ...]]) -> FloatArray:
    """Level of the free surface [m] above z = 0 at horizontal places, linear between columns; NaN when dry."""
    grid = flow.grid
    out = np.full(len(places), np.nan)
    for row, place in enumerate(places):
        level, weight = 0.0, 0.0
        corners = [(0, 1.0)]
        for a, x in enumerate(place):
            n, s = grid.shape[a], x / grid.spacing[a] - 0.5
            low = int(np.floor(s))
            f = s - low
            wrap = (lambda i, n=n: i % n) if grid.periodic[a] else (lambda i, n=n: min(max(i, 0), n - 1))
            corners = [(c * n + wrap(low + k), w * (f if k else 1.0 - f)) for c, w in corners for k in (0, 1)]
        for column, w in corners:
            value = flow.eta.flat[column]
            if w > 0.0 and np.isfinite(value):
                level, weight = level + w * value, weight + w
        if weight >= 0.5:
            out[row] = level / weight
    return out


def at_points(flow: Flow, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Kinematic pressure (N,) [m2/s2] and Darcy velocity (N, d) [m/s] at points (N, d), linear from the grid."""
    points = np.ascontiguousarray(points, dtype=float)
    pressure, velocity, mass = np.zeros(len(points)), np.zeros(points.shape), np.ones(len(points))
    if len(points):
        core = flow.grid.core
        _core.gather_cells(core, points, flow.pressure, pressure)
        cloud = (core, "linear", points, None, mass, flow.start)
        _core.to_particles(*cloud, flow.velocity, [], [], 0.0, velocity)
    return pressure, velocity
