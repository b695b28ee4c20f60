"""Water particles: arrays, nothing else. Each carries a water volume, at the Darcy velocity, and moves with u_d / n."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from houle import _core
from houle.grid import FloatArray, Grid


@dataclass
class Particles:
    """position (N, d) [m]; velocity (N, d) Darcy [m/s]; volume (N,) of water [m^d], constant between remeshings."""

    position: FloatArray
    velocity: FloatArray
    volume: FloatArray

    def __len__(self) -> int:
        return len(self.volume)

    @property
    def total_volume(self) -> float:
        """[m^d]"""
        return _core.total(self.volume)

    def depths(self, grid: Grid) -> FloatArray:
        """Water over the plan area of each column of cells, grid.shape[:-1] [m]."""
        plan = grid.spacing[:-1]
        bins = [np.arange(n + 1) * h for n, h in zip(grid.shape, plan, strict=False)]
        held = np.histogramdd(self.position[:, :-1], bins, weights=self.volume)[0]
        return held / math.prod(plan)
