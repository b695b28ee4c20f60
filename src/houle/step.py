"""The algorithm: one time step, each line one operation of the core, numbered as in the paper (JH2020).

The equations are the paper's, corrected (docs/theory.md): drag implicit and inside the projection, particles move with
the pore velocity u_d / n, the free surface is where the water is and not where the cells are.
"""

from __future__ import annotations

from houle import _core
from houle.errors import SimulationError
from houle.flow import Flow
from houle.ledger import Ledger
from houle.transfer import Transfer

LEAST_THETA = 0.05  # least distance of the surface from a cell centre, in cells (pressure)
LEAST_THETA_CORRECTION = 0.2
import os
CONT = int(os.environ.get("CONT","2"))
SPRAY = 1e-3  # faces carrying less of a cell than this are empty


class Step:
    """The default scheme, "houle"."""

    def __init__(self, transfer: Transfer, correction: float) -> None:
        self.transfer, self.correction = transfer, correction

    def advance(self, flow: Flow, dt: float, ledger: Ledger) -> None:
        with ledger.operation("sort"):
            sort(flow, self.transfer)
        with ledger.operation("surface"):
            find_surface(flow)  # which cells hold water, where the surface cuts the grid
        with ledger.operation("transfer"):
            self.transfer.to_grid(flow)  # Darcy velocity on the faces
        with ledger.operation("forces"):
            apply_forces(flow, dt)  # (13), drag and Bernoulli term implicit
        with ledger.operation("projection"):
            project(flow, dt, ledger)  # (15), (16)
        with ledger.operation("transfer"):
            self.transfer.to_particles(flow)
        with ledger.operation("advection"):
            move(flow, dt)  # (17), with u_d / n
        with ledger.operation("correction"):
            correct_positions(flow, self.correction, ledger)  # density (14) kept at 1 on the grid


def sort(flow: Flow, transfer: Transfer) -> None:
    """Particles in the order of their cells: neighbours in space are neighbours in memory."""
    p = flow.particles
    _core.cell_sort(flow.grid.core, p.position, flow.cell, flow.order, flow.start)
    p.position, p.velocity, p.volume = p.position[flow.order], p.velocity[flow.order], p.volume[flow.order]
    for name, values in transfer.arrays.items():
        transfer.arrays[name] = values[flow.order]
    flow.sample_medium()
    if not flow.porous:
        flow.bulk = p.volume


def find_surface(flow: Flow) -> None:
    """Fill fraction of the pores of every cell; depth below the free surface; cells under water."""
    g, m = flow.grid, flow.medium
    _core.scatter_cells(g.core, flow.start, flow.particles.position, flow.particles.volume, flow.fill)
    flow.fill *= flow.inverse_tent_volume
    _core.find_surface(
        g.core, flow.fill, m.open_cells, flow.columns, flow.depth, flow.active, flow.column, flow.eta
    )


def apply_forces(flow: Flow, dt: float) -> None:
    m = flow.medium
    resistance = (m.inertia, m.darcy, m.forchheimer, m.inverse_n2) if flow.porous else ([], [], [], None)
    flow.velocity, flow.old_velocity = flow.old_velocity, flow.velocity
    _core.apply_forces(
        flow.grid.core, flow.old_velocity, *resistance, flow.gravity, flow.extra, dt,
        flow.velocity, flow.drag, flow.mobility,
    )  # fmt: skip


def project(flow: Flow, dt: float, ledger: Ledger) -> None:
    """Pressure that makes div u_d = 0 in the water with p = 0 on its surface; velocity carried on into the air."""
    core, tolerance = flow.grid.core, flow.tolerance / dt
    system = (flow.coefficient, flow.dirichlet, flow.rhs)
    _core.pressure_system(
        core, flow.active, flow.depth, flow.open_faces, flow.mobility, flow.velocity, LEAST_THETA, *system
    )
    flow.solver.setup(flow.active, flow.coefficient, flow.dirichlet)
    iterations, residual = flow.solver.solve(flow.rhs, flow.pressure, tolerance, 200)
    if not residual <= tolerance:
        raise SimulationError(
            f"the pressure did not converge: max |div u_d| dt = {residual * dt:.2e}, wanted {flow.tolerance:.2e}",
            diagnosis="The projection left more divergence than the tolerance allows after 200 iterations.",
        )
    ledger.note(pressure_iterations=iterations, divergence=residual * dt)
    _core.project(
        core, flow.active, flow.depth, flow.open_faces, flow.mobility, flow.pressure, LEAST_THETA,
        flow.velocity, flow.valid,
    )  # fmt: skip
    _core.extrapolate(core, 6, 2, flow.face_mass, SPRAY * flow.grid.cell_volume, flow.velocity, flow.valid)
    if CONT: _core.continue_upwards(core, CONT, flow.active, flow.column, flow.velocity)


def move(flow: Flow, dt: float) -> None:
    _core.move(
        flow.grid.core, flow.velocity, flow.medium.porosity if flow.porous else None, flow.medium.solid_distance,
        flow.gates, dt, flow.particles.position,
    )  # fmt: skip


def correct_positions(flow: Flow, share: float, ledger: Ledger) -> None:
    """Moves particles from overfull to underfull cells: a second projection, of positions (Kugelstadt et al. 2019)."""
    if share == 0.0:
        return
    g, m, p = flow.grid, flow.medium, flow.particles
    porosity = m.porosity if flow.porous else None
    find_surface(flow)
    _core.pressure_system(
        g.core, flow.active, flow.depth, flow.open_faces, [], [], LEAST_THETA_CORRECTION,
        flow.coefficient, flow.dirichlet, flow.rhs,
    )  # fmt: skip
    _core.density_excess(g.core, flow.active, flow.depth, flow.column, flow.fill, m.open_cells, porosity, share, flow.rhs)
    flow.solver.setup(flow.active, flow.coefficient, flow.dirichlet)
    largest = float(abs(flow.rhs).max())
    iterations, _ = flow.solver.solve(flow.rhs, flow.psi, 1e-2 * largest, 50)
    ledger.note(correction_iterations=iterations)
    for f in flow.face_work:
        f[...] = 0.0
    _core.project(
        g.core, flow.active, flow.depth, flow.open_faces, [], flow.psi, LEAST_THETA_CORRECTION,
        flow.face_work, flow.valid,
    )  # fmt: skip
    _core.extrapolate(g.core, 3, 3, [], 0.0, flow.face_work, flow.valid)
    _core.displace(
        g.core, flow.face_work, porosity, m.solid_distance, flow.gates, 0.1, p.position, flow.shift
    )
