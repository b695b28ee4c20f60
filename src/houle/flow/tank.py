"""What a boundary sees of a flow: the tank, the medium in it, the water as particles and as fields on the grid."""

from __future__ import annotations

import numpy as np

from houle.flow.component import Component
from houle.flow.particles import Particles
from houle.flow.workspace import Workspace
from houle.grid import Grid
from houle.medium.medium import Medium


class Tank(Component):
    """Water in a tank: particles, and fields on the grid. Each step overwrites the arrays of the fields.

    gravity       acceleration of the water, per axis, the last one up [m/s2]
    time          that of the positions: in a step, at its start [s]
    step_size     length of the step that is done or in progress [s]; last_step: of the one before it, 0 in the first
    kick          time over which the last forces changed old_velocity into velocity [s]
    fill          water volume / pore volume of the cells, tent-smoothed [-]
    submergence   of the cell centres: how far below the free surface they are [cells]; active: those under water
    eta           level of the free surface [m], NaN where dry
    velocity      Darcy velocity on the faces [m/s]; old_velocity: before the forces
    pressure      p / rho of the cells [m2/s2]
    """

    def __init__(self, grid: Grid, medium: Medium, particles: Particles, gravity: tuple[float, ...]) -> None:
        self.grid, self.medium, self.particles = grid, medium, particles
        self.gravity = tuple(float(g) for g in gravity)
        self.time = self.step_size = self.last_step = 0.0
        self.kick = 1.0
        self.fill = grid.cells()
        self.submergence = grid.cells()
        self.active = np.zeros(grid.shape, np.uint8)
        self.eta = np.zeros(grid.shape[:-1])
        self.velocity = grid.faces()
        self.old_velocity = grid.faces()
        self.pressure = grid.cells()
        self.work = Workspace(grid, len(particles))

    def kick_of(self, dt: float) -> float:
        """Time from the middle of the last step to that of one of dt [s] that begins now: forces act over it [s]."""
        return 0.5 * (self.last_step + dt)
