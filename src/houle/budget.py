"""No run gains energy in silence: the kinetic energy that the water can have, of what it had and what it was given.

The water of a run can have in motion no more than its energy at the start above that of its lowest state, and what has
come since: the work of makers, moving walls and open sides, the energy of water that came in, the height of water that
`remesh = "paper"` made. What drag, viscosity and sponges took is not counted against it (docs/theory.md, section 13).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.errors import SimulationError

if TYPE_CHECKING:
    from houle.flow import Flow
    from houle.ledger import Ledger

MORE = 0.05  # of what there is, that the sums of the ledger may be wrong by
LEAST = 0.01  # of a cell, that all water may fall: motion of no account, in water at rest


class Budget:
    """What the water of a flow could have in motion, per density [m^d m2/s2]."""

    def __init__(self, flow: Flow) -> None:
        grid, medium = flow.grid, flow.medium
        self.gravity = np.array(flow.gravity[: grid.dimension])
        self.endless = bool(np.any(self.gravity[list(grid.periodic)]))  # falls for ever: nothing bounds its energy
        self.gravity[list(grid.periodic)] = 0.0
        lines = [(np.arange(n) + 0.5) * h for n, h in zip(grid.shape, grid.spacing, strict=True)]
        height = -sum(g * z for g, z in zip(self.gravity, np.meshgrid(*lines, indexing="ij"), strict=True))
        room = (medium.porosity * medium.open_cells * grid.cell_volume).ravel()
        order = np.argsort(height, axis=None, kind="stable")
        self.volume = np.cumsum(room[order])
        self.lowest = np.cumsum((room * height.ravel())[order])
        self.size = float(np.abs(self.gravity) @ np.array(grid.size))
        self.fall = LEAST * float(np.linalg.norm(self.gravity)) * max(grid.spacing)

    def available(self, flow: Flow, ledger: Ledger) -> float:
        """With no air in it, all water falls into the lowest pores."""
        volume = flow.particles.total_volume
        lowest = float(np.interp(volume, self.volume, self.lowest, left=0.0))
        made = max(ledger.volume_drift(), 0.0) * volume * self.size
        return max(ledger.start + ledger.given + made - lowest, 0.0)

    def check(self, flow: Flow, ledger: Ledger, density: float) -> None:
        """Raises SimulationError when the water moves with more energy than there was."""
        if self.endless:
            return
        available = self.available(flow, ledger)
        if not ledger.kinetic > (1.0 + MORE) * available + self.fall * flow.particles.total_volume:
            return
        p = flow.particles
        speed = np.linalg.norm(flow.pore_velocity(), axis=1)
        fastest = int(np.argmax(speed))
        unit = "J" if flow.grid.dimension == 3 else "J per metre of width"
        raise SimulationError(
            f"the water has gained energy: {density * ledger.kinetic:.3g} {unit} in motion, where at most "
            f"{density * available:.3g} were to be had; the fastest water moves at {speed[fastest]:.3g} m/s",
            place=tuple(float(x) for x in p.position[fastest]),
            diagnosis="The kinetic energy exceeds all that gravity, wave makers, moving walls and open sides can have "
            "given since the start, so the motion has no physical cause. The series energy_... in series.nc say which "
            "operation made it. Another transfer, kernel or remeshing, or a finer grid at the place given, may not.",
        )
