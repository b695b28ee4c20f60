"""The start of a run: its first free surface and its first pressure."""

from __future__ import annotations

from houle.flow.forces import apply_forces
from houle.flow.ledger import Ledger
from houle.flow.projection import project
from houle.flow.state import Flow
from houle.flow.surface import arrange
from houle.flow.transfer import Transfer


def prepare(flow: Flow, transfer: Transfer, ledger: Ledger) -> None:
    """Finds free surface and pressure of the water as it stands at the start of a run.

    The pressure is that of a short step of the forces, whose velocities are thrown away: on return the faces have the
    velocities of the particles, and the ledger no work.
    """
    dt = 1e-3 * float(min(flow.grid.spacing)) ** 0.5  # [s]; the pressure does not depend on it
    arrange(flow)
    transfer.to_grid(flow)
    for boundary in flow.boundaries:
        boundary.prepare(flow)
    apply_forces(flow, dt, [])
    project(flow, dt, ledger)
    for u in flow.velocity:
        u[...] = 0.0
    if flow.particles.velocity.any():
        transfer.to_grid(flow)
    ledger.drag_work = ledger.open_work = 0.0
