"""The budget of energy: no run gains energy in silence.

The kinetic energy of the water is at most what the water had at the start above its lowest state, and what has come
since: the work of makers, moving walls and open sides, the energy of water that came in, the height of water that
`remesh = "paper"` made. What drag, viscosity and sponges took is not counted against it (docs/theory.md, section 13).
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

MORE = 0.05  # share of what there is by which the sums of the ledger may be wrong
LEAST = 0.01  # share of a cell by which all water may fall: motion of no account, in water at rest


@dataclass(frozen=True)
class _Pores:
    """The pores of a tank, filled from below: each cell evenly between its lowest and its highest potential.

    level   (K,) potentials at which cells begin or end [m2/s2]
    share   (K,) volume per potential above each level [m^d s2/m2]
    volume  (K,) of the water that fills the pores up to each level [m^d]
    energy  (K,) potential energy of that water [m^d m2/s2]
    """

    level: FloatArray
    share: FloatArray
    volume: FloatArray
    energy: FloatArray

    @classmethod
    def of(cls, grid: Grid, pores: FloatArray, gravity: FloatArray) -> _Pores:
        """The pores of all cells, their volumes (nx, [ny,] nz) [m^d], under gravity (d,) [m/s2]."""
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
        """Potential energy of a volume of water [m^d] that lies as low as it can [m^d m2/s2]."""
        k = int(np.searchsorted(self.volume, volume, side="right")) - 1
        more, share = volume - self.volume[k], self.share[k]
        return float(self.energy[k] + more * self.level[k] + (0.5 * more**2 / share if share > 0.0 else 0.0))


class Budget:
    """How much kinetic energy the water of a flow can have, per density [m^d m2/s2]. It keeps nothing between steps."""

    def __init__(self, flow: Flow) -> None:
        grid, medium = flow.grid, flow.medium
        self.gravity = np.array(flow.gravity[: grid.dimension])
        self.endless = bool(np.any(self.gravity[list(grid.periodic)]))  # water falls for ever: nothing bounds it
        self.gravity[list(grid.periodic)] = 0.0
        self.pores = _Pores.of(grid, medium.porosity * medium.open_cells * grid.cell_volume, self.gravity)
        self.range = float(np.abs(self.gravity) @ np.array(grid.size))  # of the potential in the tank [m2/s2]
        self.fall = LEAST * float(np.linalg.norm(self.gravity)) * max(grid.spacing)  # potential of no account [m2/s2]

    def available(self, flow: Flow, ledger: Ledger) -> float:
        """Kinetic energy of the water if all of it had fallen into the lowest pores, with no air there.

        Water that remeshing made counts as if it had appeared at the top of the tank.
        """
        volume = flow.particles.total_volume
        made = max(ledger.volume_drift(), 0.0) * volume * self.range
        return max(ledger.start + ledger.given + made - self.pores.lowest(volume), 0.0)

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
