"""The algorithm: one time step, each line one operation of the core.

Numbers in brackets are equations of the paper (JH2020: Ramos Ortega, Beaudoin & Huberson 2020). They are solved as
docs/theory.md corrects them, section 12: the drag is implicit and inside the projection, particles move with the pore
velocity u_d / n, and p = 0 on the free surface itself, which may lie anywhere in a cell.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from houle.flow.component import Component
from houle.flow.correction import correct_positions
from houle.flow.forces import apply_forces, drive, gather_behind, make_waves, rub, sph_viscosity, viscosity
from houle.flow.ledger import Ledger
from houle.flow.motion import arrive, drift, exchange, limit_energy, move, move_walls
from houle.flow.projection import project
from houle.flow.remeshing_schedule import RemeshingSchedule
from houle.flow.state import Flow
from houle.flow.surface import arrange, find_surface, sort
from houle.flow.transfer import Transfer


@dataclass
class Step(Component):
    """The default scheme, "houle": all forces act on the faces of the grid; second order in time.

    Velocities belong to the middles of the steps, positions to their ends (leapfrog, docs/decisions/0008). The forces
    at the present positions therefore act from the middle of the last step to the middle of this one.

    correction    `numerics.correction`, see `correct_positions` [-]
    velocity_lag  share of a step by which the velocities are older than the positions when a step is done
    pressure_lag  the same of the pressure
    """

    transfer: Transfer
    correction: float
    remeshing: RemeshingSchedule
    velocity_lag: ClassVar[float] = 0.5
    pressure_lag: ClassVar[float] = 1.0

    def parts(self) -> Mapping[str, Component]:
        return {"remeshing": self.remeshing}

    def advance(self, flow: Flow, dt: float, ledger: Ledger) -> None:
        """Advances an arranged flow, for which `motion.begin` was called, by dt [s]. On return it is arranged again."""
        kick = flow.kick_of(dt)  # time over which the forces act, from middle to middle of two steps
        rub(flow, kick, ledger)  # the law of the wall, on particles near solids and sides that rub
        with ledger.operation("transfer"):
            self.transfer.to_grid(flow)  # Darcy velocity on the faces
            gather_behind(flow)
        with ledger.operation("forces"):
            acceleration = viscosity(flow, kick, ledger)  # (3), on the grid
            drive(flow, dt)  # velocities at open sides
            acceleration = make_waves(flow, acceleration)  # (4), (5)
            apply_forces(flow, kick, acceleration)  # (13), drag and Bernoulli term implicit
        with ledger.operation("projection"):
            project(flow, kick, ledger)  # (15), (16)
        with ledger.operation("transfer"):
            interpolated = self.transfer.to_particles(flow)
            limit_energy(flow)  # beside porous interfaces, particles have no more energy than the grid
        with ledger.operation("advection"):
            move_walls(flow)
            move(flow, dt, interpolated)  # (17), with u_d / n
        with ledger.operation("exchange"):
            exchange(flow, dt)  # particles enter and leave through open sides
        with ledger.operation("correction"):
            correct_positions(flow, self.correction, dt, ledger)  # (14) kept at 1, on the grid
        with ledger.operation("remeshing"):
            self.remeshing.after_step(flow, self.transfer, dt)  # (6), (7)
        with ledger.clock("surface"):
            arrange(flow)  # sorted particles, the cells under water, the free surface


@dataclass
class PaperStep(Component):
    """The paper's own sequence (12)-(17), "jh2020", with the corrections of docs/theory.md, section 12.

    Particles first move from r to r*, exchange velocities with the grid there, and then go from r to the end of the
    step with the mean of the old and the new velocity. Positions, velocities and pressure belong to the same instant.
    The attributes are those of `Step`.
    """

    transfer: Transfer
    correction: float
    remeshing: RemeshingSchedule
    velocity_lag: ClassVar[float] = 0.0
    pressure_lag: ClassVar[float] = 0.0

    def parts(self) -> Mapping[str, Component]:
        return {"remeshing": self.remeshing}

    def advance(self, flow: Flow, dt: float, ledger: Ledger) -> None:
        """Advances an arranged flow by dt [s]; the length of the last step does not matter. It is arranged again."""
        with ledger.operation("advection"):
            move_walls(flow)
            start, velocity, porosity = flow.copied_particles()
            drift(flow, start, velocity, porosity, dt)  # (12): r* = r + dt u_d / n
        with ledger.clock("surface"):
            start, velocity, porosity = sort(flow, start, velocity, porosity)
            find_surface(flow)
        with ledger.operation("forces"):
            sph_viscosity(flow, dt, ledger)  # (3) in (13), on the particles
        rub(flow, dt, ledger)
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
            limit_energy(flow)
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
