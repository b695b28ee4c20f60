"""Pressure and Darcy velocity at points."""

from __future__ import annotations

import numpy as np

from houle import _core
from houle.flow.state import Flow
from houle.grid import FloatArray, Grid
from houle.medium.plate_sides import behind_plates, on_their_side
from houle.observe.profile import around


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
    """The accelerations (d,) [m/s2] that water at rest answers with a pressure: not those along periodic axes."""
    return np.where(flow.grid.periodic, 0.0, flow.gravity)


def cell_below(cell: np.ndarray, grid: Grid, steps: int = 1) -> np.ndarray:
    """Flat number of the cell so many steps below, in the same column; at its ends the cell itself."""
    nz = grid.shape[-1]
    k = cell % nz
    return np.where((k - steps >= 0) & (k - steps < nz), cell - steps, cell)


class Sensors:
    """Pressure and Darcy velocity at fixed points (N, d), up to the very floor, wall or free surface.

    What is interpolated, linearly, is the part of the pressure beyond that of water at rest, p/rho - g.x: it has no
    gradient towards a fixed wall, and goes on above the last cell of the water to the surface. A dry sensor reads 0.
    One on a thin plate reads the water on its side (`houle.medium.plate_sides`).
    """

    def __init__(self, flow: Flow, points: FloatArray) -> None:
        grid, g = flow.grid, still_gravity(flow)
        points = np.array(points, float).reshape(-1, grid.dimension)
        self.seen = on_their_side(grid, flow.medium.solids, points)
        self.cell, self.weight = around(self.seen, grid)
        open_ = flow.medium.open_cells.ravel()[self.cell] > 0.0
        hidden = behind_plates(
            grid, flow.medium.solids, self.seen, grid.points().reshape(-1, grid.dimension)[self.cell]
        )
        self.weight = np.where(open_ & ~hidden, self.weight, 0.0)
        self.below = cell_below(self.cell, grid)
        rest = (grid.points() @ g).ravel()
        self.rest, self.rest_here, self.rest_below = points @ g, rest[self.cell], rest[self.below]
        self.moved = self.seen @ g - self.rest

    def pressure(self, flow: Flow) -> FloatArray:
        """Kinematic, p/rho (N,) [m2/s2]."""
        p = flow.pressure.ravel()
        here, below = p[self.cell], p[self.below]
        wet = here != 0.0
        beyond = np.where(wet, here - self.rest_here, below - self.rest_below)
        weight = np.where(wet | (below != 0.0), self.weight, 0.0)
        total = weight.sum(axis=1)
        found = (weight * beyond).sum(axis=1) / np.where(total > 0.0, total, 1.0) + self.rest
        at_surface = (~wet & (self.weight > 0.0)).any(axis=1) | (found + self.moved >= 0.0)  # no suction where it looks
        return np.where(total > 0.0, np.where(at_surface, np.maximum(found, 0.0), found), 0.0)

    def velocity(self, flow: Flow) -> FloatArray:
        return velocity_at(flow, self.seen)
