"""What the columns of cells hold up to a level: the water as its surface shows it, its amount and its energy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid
from houle.medium.medium import Medium


@dataclass(frozen=True)
class Room:
    """Integrals over the open pores of each column up to its faces z_k: share (columns, nz) n times open, of each cell;
    below of share dz [m], moment of share z dz [m2], (columns, nz + 1).
    """

    spacing: float  # upwards [m]
    plan: float  # area of a column [m^(d-1)]
    share: FloatArray
    below: FloatArray
    moment: FloatArray

    @classmethod
    def of(cls, grid: Grid, medium: Medium) -> Room:
        h = grid.spacing[-1]
        share = (medium.porosity * medium.open_cells).reshape(-1, grid.shape[-1])
        middle = h * (np.arange(grid.shape[-1]) + 0.5)
        below, moment = (np.pad(np.cumsum(part, axis=1), ((0, 0), (1, 0))) * h for part in (share, share * middle))
        return cls(h, grid.cell_volume / h, share, below, moment)

    def mean_level(
        self,
        eta: FloatArray,
        along: FloatArray | None = None,
        held: tuple[NDArray[np.bool_], FloatArray] | None = None,
    ) -> float:
        """Water below the levels eta (columns) [m], NaN where dry, over the plan area [m].

        along: share of each column that counts, between moving walls; None: all.
        held: which columns count by what they hold instead of by their level, and how much it is, over their area [m].
        """
        water = np.zeros(eta.size)
        wet, cell, z = self._top(eta)
        water[wet] = self.below[wet, cell] + self.share[wet, cell] * (z - cell * self.spacing)
        if held is not None:
            water[held[0].ravel()] = held[1]
        return float(np.mean(water) if along is None else np.sum(water * along.ravel()) / np.sum(along))

    def height_moment(self, eta: FloatArray, along: FloatArray | None = None) -> float:
        """Integral of z over the water below the levels eta [m^(d+1)]: its energy over density and gravity."""
        wet, cell, z = self._top(eta)
        moment = self.moment[wet, cell] + 0.5 * self.share[wet, cell] * (z**2 - (cell * self.spacing) ** 2)
        return self.plan * float(np.sum(moment if along is None else moment * along.ravel()[wet]))

    def _top(self, eta: FloatArray) -> tuple[Any, Any, FloatArray]:
        """Wet columns, the cell that the level is in, the level, not above the lid."""
        eta = eta.ravel()
        wet = np.flatnonzero(eta > 0.0)
        count = self.share.shape[1]
        z = np.minimum(eta[wet], count * self.spacing)
        return wet, np.minimum((z / self.spacing).astype(int), count - 1), z
