"""Pressure and Darcy velocity at points, and the hydrostatic part of the pressure between the centres of cells."""

from __future__ import annotations

import numpy as np

from houle import _core
from houle.flow.state import Flow
from houle.grid import FloatArray, Grid


def at_points(flow: Flow, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Kinematic pressure (N,) [m2/s2] and Darcy velocity (N, d) [m/s] at points (N, d), linear from the grid."""
    points = np.ascontiguousarray(points, dtype=float)
    pressure = np.zeros(len(points))
    if len(points):
        _core.gather_cells(flow.grid.core, points, flow.pressure, pressure)
    return pressure, velocity_at(flow, points)


def velocity_at(flow: Flow, points: FloatArray) -> FloatArray:
    """Darcy velocity (N, d) [m/s] at points (N, d), linear from the faces; along an interface from its side."""
    velocity, mass = np.zeros(points.shape), np.ones(len(points))
    if len(points):
        cloud = (flow.grid.core, "linear", points, None, mass, flow.start)
        _core.to_particles(*cloud, flow.velocity, [], [], 0.0, velocity, flow.interfaces)
    return velocity


def still_gravity(flow: Flow) -> FloatArray:
    """Gravity (d,) [m/s2] that water at rest balances by pressure: none along periodic axes."""
    return np.where(flow.grid.periodic, 0.0, flow.gravity)


def cell_below(cell: np.ndarray, grid: Grid, steps: int = 1) -> np.ndarray:
    """Flat number of the cell so many steps below in the same column; the cell itself where the column ends."""
    nz = grid.shape[-1]
    k = cell % nz
    return np.where((k - steps >= 0) & (k - steps < nz), cell - steps, cell)
