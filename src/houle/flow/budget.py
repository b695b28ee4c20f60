"""The budget of energy: no run gains energy in silence.

The kinetic energy of the water can be no more than a bound: its energy at the start above the lowest state, plus what
has come since. That is the work of makers, moving walls and open sides, the energy of water that came in, and the
height of water that `remesh = "paper"` made. What drag, viscosity and sponges took does not lower the bound
(docs/theory.md, section 13). A run that exceeds it stops.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from houle.errors import SimulationError
from houle.grid import FloatArray, Grid

if TYPE_CHECKING:
    from houle.flow.ledger import Ledger
    from houle.flow.state import Flow

MORE = 0.05  # share of the bound by which the sums of the ledger may be wrong
LEAST = 0.01  # share of a cell: less energy than all water gains by falling so far is of no account


@dataclass(frozen=True)
class _Pores:
    """The pores of a tank, filled from below. Potential means -g.x [m2/s2]: the height times gravity.

    The pores of a cell count as spread evenly between its lowest and its highest potential.

    level   (K,) potentials at which cells begin or end, ascending [m2/s2]
    share   (K,) pore volume per potential just above each level [m^d s2/m2]
    volume  (K,) water that fills the pores up to each level [m^d]
    energy  (K,) potential energy of that water per density [m^d m2/s2]
    """

    level: FloatArray
    share: FloatArray
    volume: FloatArray
    energy: FloatArray

    @classmethod
    def of(cls, grid: Grid, pores: FloatArray, gravity: FloatArray) -> _Pores:
        """The pores of a tank. pores: volume of those of each cell (nx, [ny,] nz) [m^d]; gravity (d,) [m/s2]."""
        pores = np.sum(pores, axis=tuple(np.flatnonzero(gravity == 0.0)))
        lines = [
            -g * h * (np.arange(n) + 0.5) for g, h, n in zip(gravity, grid.spacing, grid.shape, strict=True) if g != 0.0
        ]
        middle = sum(np.meshgrid(*lines, indexing="ij")) if lines else np.zeros(())
        half = 0.5 * float(np.abs(gravity) @ grid.spacing)
        edges = np.concatenate([np.ravel(middle) - half, np.ravel(middle) + half])
        share = np.concatenate([pores.ravel(), -pores.ravel()]) / (2.0 * half or 1.0)
        order = np.argsort(edges, kind="stable")
        level, share = edges[order], np.cumsum(share[order])
        share = np.where(share > 1e-9 * share.max(), share, 0.0)  # round-off where all cells are full
        step = share[:-1] * np.diff(level)
        volume = np.concatenate([[0.0], np.cumsum(step)])
        energy = np.concatenate([[0.0], np.cumsum(step * 0.5 * (level[:-1] + level[1:]))])
        return cls(level, share, volume, energy)

    def lowest(self, volume: float) -> float:
        """Potential energy [m^d m2/s2] of a volume of water [m^d] that lies as low as it can."""
        k = int(np.searchsorted(self.volume, volume, side="right")) - 1
        more, share = volume - self.volume[k], self.share[k]
        return float(self.energy[k] + more * self.level[k] + (0.5 * more**2 / share if share > 0.0 else 0.0))


class Budget:
    """The bound on the kinetic energy of the water in a flow, per density [m^d m2/s2].

    It has no state: nothing is kept from one step to the next.

    endless  gravity acts along a periodic axis, so that water falls for ever and nothing bounds its energy
    range    difference between the largest and the smallest potential in the tank [m2/s2]
    fall     kinetic energy per volume of no account [m2/s2]
    """

    def __init__(self, flow: Flow) -> None:
        grid, medium = flow.grid, flow.medium
        self.gravity = np.array(flow.gravity[: grid.dimension])
        self.endless = bool(np.any(self.gravity[list(grid.periodic)]))
        self.gravity[list(grid.periodic)] = 0.0
        self.pores = _Pores.of(grid, medium.porosity * medium.open_cells * grid.cell_volume, self.gravity)
        self.range = float(np.abs(self.gravity) @ np.array(grid.size))
        self.fall = LEAST * float(np.linalg.norm(self.gravity)) * max(grid.spacing)

    def available(self, flow: Flow, ledger: Ledger) -> float:
        """The bound: kinetic energy that the water would have if all of it had fallen into the lowest pores.

        Water that remeshing made counts as if it had appeared at the top of the tank.
        """
        volume = flow.particles.total_volume
        made = max(ledger.volume_drift(), 0.0) * volume * self.range
        return max(ledger.start + ledger.given + made - self.pores.lowest(volume), 0.0)

    def check(self, flow: Flow, ledger: Ledger, density: float) -> None:
        """Raises SimulationError where the kinetic energy exceeds the bound. density [kg/m3]: for the message."""
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
