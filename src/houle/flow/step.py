"""The algorithm: one time step, each line one operation of the core, numbered as in the paper (JH2020).

The equations are the paper's, corrected (docs/theory.md): drag implicit and inside the projection, particles move with
the pore velocity u_d / n, the free surface is where the water is and not where the cells are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from houle.flow.component import Component
from houle.flow.correction import correct_positions
from houle.flow.forces import apply_forces, drive, make_waves, sph_viscosity, viscosity
from houle.flow.ledger import Ledger
from houle.flow.motion import arrive, drift, exchange, move, move_walls, settle
from houle.flow.projection import project
from houle.flow.remeshing_schedule import RemeshingSchedule
from houle.flow.state import Flow
from houle.flow.surface import arrange, find_surface, sort
from houle.flow.transfer import Transfer


@dataclass
class Step(Component):
    """The default scheme, "houle": everything between the particles on the grid, second order in time.

    Velocities live at the middles of the steps, positions at their ends (leapfrog): what forces and pressure at the
    positions of now change is the velocity from the middle of the last step to the middle of this one.
    """

    transfer: Transfer
    correction: float
    remeshing: RemeshingSchedule
    velocity_lag: ClassVar[float] = 0.5  # of a step, behind the positions
    pressure_lag: ClassVar[float] = 1.0

    def parts(self) -> Mapping[str, Component]:
        return {"remeshing": self.remeshing}

    def advance(self, flow: Flow, dt: float, ledger: Ledger) -> None:
        """One step of dt [s] that has begun, from an arranged flow to an arranged flow."""
        kick = flow.kick_of(dt)  # from middle to middle
        with ledger.operation("transfer"):
            self.transfer.to_grid(flow)  # Darcy velocity on the faces
        with ledger.operation("forces"):
            acceleration = viscosity(flow, kick, ledger)  # (3), on the grid
            drive(flow, dt)  # what flows through open sides
            acceleration = make_waves(flow, acceleration)  # (4), (5)
            apply_forces(flow, kick, acceleration)  # (13), drag and Bernoulli term implicit
        with ledger.operation("projection"):
            project(flow, kick, ledger)  # (15), (16)
        with ledger.operation("transfer"):
            linear = self.transfer.to_particles(flow)
            settle(flow)
        with ledger.operation("advection"):
            move_walls(flow)
            move(flow, dt, linear)  # (17), with u_d / n
        with ledger.operation("exchange"):
            exchange(flow, dt)  # water that comes in and goes out
        with ledger.operation("correction"):
            correct_positions(flow, self.correction, dt, ledger)  # (14) kept at 1, on the grid
        with ledger.operation("remeshing"):
            self.remeshing.after_step(flow, self.transfer, dt)  # (6), (7)
        with ledger.clock("surface"):
            arrange(flow)  # which cells hold water, where the surface cuts the grid


@dataclass
class PaperStep(Component):
    """The paper's own sequence (12)-(17), "jh2020", with the corrections of docs/theory.md.

    Particles move to r* first, meet the grid there, and go from r to the end of the step with the mean of the old and
    the new velocity.
    """

    transfer: Transfer
    correction: float
    remeshing: RemeshingSchedule
    velocity_lag: ClassVar[float] = 0.0
    pressure_lag: ClassVar[float] = 0.0

    def parts(self) -> Mapping[str, Component]:
        return {"remeshing": self.remeshing}

    def advance(self, flow: Flow, dt: float, ledger: Ledger) -> None:
        """One step of dt [s], whatever the last one was, from an arranged flow to an arranged flow."""
        with ledger.operation("advection"):
            move_walls(flow)
            start, velocity, porosity = flow.snapshot()
            drift(flow, start, velocity, porosity, dt)  # (12): r* = r + dt u_d / n
        with ledger.clock("surface"):
            start, velocity, porosity = sort(flow, start, velocity, porosity)
            find_surface(flow)
        with ledger.operation("forces"):
            sph_viscosity(flow, dt, ledger)  # (3) in (13), on the particles
        with ledger.operation("transfer"):
            self.transfer.to_grid(flow)
        with ledger.operation("forces"):
            drive(flow, dt)
            acceleration = make_waves(flow, [])  # (4), (5)
            apply_forces(flow, dt, acceleration)  # (13), drag implicit
        with ledger.operation("projection"):
            project(flow, dt, ledger)  # (15), (16)
        with ledger.operation("transfer"):
            self.transfer.to_particles(flow)
            settle(flow)
        with ledger.operation("advection"):
            mean = 0.5 * (velocity / porosity[:, None] + flow.pore_velocity())
            arrive(flow, start, mean, dt)  # (17): r + dt (u + u')/2 / n
        with ledger.operation("exchange"):
            exchange(flow, dt)
        with ledger.operation("correction"):
            correct_positions(flow, self.correction, dt, ledger)
        with ledger.operation("remeshing"):
            self.remeshing.after_step(flow, self.transfer, dt)
        with ledger.clock("surface"):
            arrange(flow)


STEPS: dict[str, type[Step] | type[PaperStep]] = {"houle": Step, "jh2020": PaperStep}
