"""Position correction: a second projection that keeps the particles at uniform volume."""

from __future__ import annotations

import numpy as np

from houle import _core
from houle.flow.crossing import book_crossings, crossing, near_crests
from houle.flow.ledger import Ledger
from houle.flow.state import Flow
from houle.flow.surface import find_surface

LEAST_DEPTH_CORRECTION = 0.2
FULL_CORRECTION = 0.25  # Courant number of a step to which the share of the correction is applied
MOST_SHIFT = 0.1  # cells a correction may move a particle


def portion(correction: float, courant: float) -> float:
    """Share of the excess that a step spreads [-]. Disorder is made by moving: a step that moves little corrects
    little, one of several quarters of a cell as much as that many steps.
    """
    quarters = courant / FULL_CORRECTION
    return min(correction * quarters, 1.0 - (1.0 - correction) ** quarters)


def correct_positions(flow: Flow, correction: float, dt: float, ledger: Ledger) -> None:
    """Moves particles from overfull to underfull cells: a second projection, of positions (Kugelstadt et al. 2019).

    correction: share of the excess that is spread when the fastest particle crosses a quarter of a cell [-]. The
    velocity is left as it is.
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
