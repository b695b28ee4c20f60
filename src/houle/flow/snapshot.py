"""One instant of a run, as the writers and the pictures see it. Names, units and places are those of `fields.py`."""

from __future__ import annotations

from dataclasses import dataclass

from houle.grid import FloatArray


@dataclass(frozen=True)
class Snapshot:
    """Particles: position, velocity (N, d), volume, porosity, pressure (N,). Cells: grid.shape, velocity (..., d)."""

    time: float
    step: int
    position: FloatArray
    velocity: FloatArray  # pore velocity u_d / n [m/s]
    volume: FloatArray
    porosity: FloatArray
    pressure: FloatArray
    cell_pressure: FloatArray
    cell_fill: FloatArray
    cell_velocity: FloatArray  # Darcy velocity [m/s]
    cell_porosity: FloatArray
    eta: FloatArray  # level of the free surface above z = 0 [m], grid.shape[:-1], NaN where dry
