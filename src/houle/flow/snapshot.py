"""One instant of a run as the writers and the pictures see it: particles, cells, and the profile of the surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from houle.fields import LEVEL, Field
from houle.grid import FloatArray

PARTICLES = (
    Field("position", "x", "m", "particle", "position of the particle, the last axis upwards", vector=True),
    Field(
        "velocity",
        "u",
        "m s-1",
        "particle",
        "pore velocity of the water, with which it moves: Darcy velocity over porosity",
        vector=True,
    ),
    Field(
        "volume",
        "V",
        "m3",
        "particle",
        "volume of water that the particle carries, constant between remeshings",
        unit_2d="m2",
    ),
    Field(
        "porosity",
        "n",
        "1",
        "particle",
        "pore volume over total volume that the particle moves with, 1 in clear water; it is fitted to what the cells "
        "hold, so that within two cells of a face it differs from that of the body by up to a quarter of the step, and "
        "may be above 1",
    ),
    Field("pressure", "p", "Pa", "particle", "pressure of the water above that of the air, interpolated from the grid"),
)
FACES = (
    Field(
        "velocity",
        "u_d",
        "m s-1",
        "face",
        "Darcy velocity normal to the face: flow rate of the water over the whole area",
        vector=True,
    ),
)
CELLS = (
    Field(
        "velocity", "u_d", "m s-1", "centre", "Darcy velocity of the water, mean of the two faces of each axis",
        vector=True,
    ),
    Field("pressure", "p", "Pa", "centre", "pressure of the water above that of the air, as the projection gives it"),
    Field("fill", r"\varphi", "1", "centre", "volume of water over the pore volume of the cell"),
    Field("porosity", "n", "1", "centre", "mean porosity of the open part of the cell"),
)  # fmt: skip
ETA = Field(
    "eta",
    r"\eta",
    "m",
    "surface",
    "level of the free surface above the datum z = 0, not a number where the bed is dry",
    standard_name=LEVEL,
)


@dataclass(frozen=True)
class Snapshot:
    """All quantities of one instant, as copies: those of PARTICLES, those of CELLS with `cell_` in front, and eta.

    Arrays of particles are (N,), vectors (N, d). Arrays of cells have the shape of the grid of the domain, vectors one
    axis more (..., d). time [s] and step are those of the instant; the units are those of the fields.
    """

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


class Frames(Protocol):
    """Takes snapshots of a flow."""

    def take(self, step: int) -> Snapshot:
        """A snapshot of the flow as it is now, after this number of steps."""
