"""Position correction: a second projection, of positions, spreads the particles evenly (docs/theory.md, section 10).

It solves -lap psi = omega n E for the excess E = F - 1 of the fill F of each cell, and moves particles by
-grad psi / n, eq. (20).
"""

from __future__ import annotations

import numpy as np

from houle import _core
from houle.flow.crossing import book_crossings, crossing, near_crests
from houle.flow.ledger import Ledger
from houle.flow.state import Flow
from houle.flow.surface import find_surface

LEAST_DEPTH_CORRECTION = 0.2  # cells: depth below the surface that a pressure cell is given at least
FULL_CORRECTION = 0.25  # Courant number of the step in which `numerics.correction` is the share that is spread
MOST_SHIFT = 0.1  # cells by which a correction may move a particle along each axis


def portion(correction: float, courant: float) -> float:
    """omega of (20): share of the excess that a step with this Courant number spreads [-].

    Motion makes the disorder. So a step that moves little corrects little, and a step over several quarters of a cell
    corrects as much as that many steps over a quarter: min(4 C s, 1 - (1 - s)^(4 C)).
    """
    quarters = courant / FULL_CORRECTION
    return min(correction * quarters, 1.0 - (1.0 - correction) ** quarters)


def correct_positions(flow: Flow, correction: float, dt: float, ledger: Ledger) -> None:
    """Moves particles from overfull to underfull cells, after Kugelstadt et al. (2019), in a step of dt [s].

    correction: share of the excess that is spread when the fastest particle crosses a quarter of a cell [-].
    Velocities stay as they are. flow.psi, the potential of the last step, is the first guess of the solver.
    """
    share = portion(correction, flow.courant(dt))
    if share == 0.0:
        return
    g, m, work, between = flow.grid, flow.medium, flow.work, flow.boundaries
    find_surface(flow)
    _core.pressure_system(
        g.core, flow.active, flow.submergence, between.open_faces, [], 1.0, [], LEAST_DEPTH_CORRECTION,
        work.coefficient, work.dirichlet, work.rhs,
    )  # fmt: skip
    surface = (flow.active, flow.submergence, flow.single_level, flow.eta, flow.fill)
    largest = _core.density_excess(g.core, *surface, m.listed("open_cells"), flow.listed("porosity"), share, work.rhs)
    if between.column_share is not None:
        np.multiply(work.rhs, between.column_share[..., None], out=work.rhs)
        largest = float(max(work.rhs.max(), -work.rhs.min()))
    displacement, potential = work.set_up(flow.active)  # Darcy displacement on the faces [m]; potential [m2]
    tolerance = max(1e-2 * largest, 1e-9)
    iterations = work.solver.solve(work.rhs, potential, tolerance, 50, flow.psi)[0]
    ledger.note(correction_iterations=iterations)
    _core.project(
        g.core, flow.active, flow.submergence, between.open_faces, [], 1.0, potential, LEAST_DEPTH_CORRECTION,
        displacement, work.valid, still=True,
    )  # fmt: skip
    _core.extrapolate(g.core, 3, 3, [], 0.0, displacement, work.valid)
    porosity, position = flow.listed("particle_porosity"), flow.particles.position
    before = near_crests(flow, position)
    with crossing(flow, 0.0, 0.0):
        _core.displace(g.core, displacement, porosity, m.outline, between.gates, MOST_SHIFT, position, between.walls)
    book_crossings(flow, before)
