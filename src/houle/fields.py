"""One table of every quantity a run writes: name, symbol, unit, place, description. It feeds writers, docs and plots.

Units are SI, written as CF and UDUNITS want them. A quantity per volume of space has one unit in 3D and another in 2D,
where a run is one metre wide: `Field.unit_in(dimension)` knows. Sums over the run (works, energy by operation) start
at 0 with the run, so that rows of the series can be interpolated and differenced.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Place = Literal[
    "particle", "face", "centre", "surface", "gauge", "sensor", "runup", "overtopping", "flux", "phreatic",
    "structure", "paddle", "run",
]  # fmt: skip


@dataclass(frozen=True)
class Field:
    """A quantity; `vector` has one value per axis; `standard_name` only where the CF table has the very thing."""

    name: str
    symbol: str
    unit: str
    place: Place
    description: str
    unit_2d: str | None = None  # per metre of width, where it differs
    vector: bool = False
    standard_name: str | None = None

    def unit_in(self, dimension: int) -> str:
        return self.unit_2d if dimension == 2 and self.unit_2d else self.unit

    @property
    def label(self) -> str:
        """For an axis of a plot: the symbol in mathematics, the unit in brackets when there is one."""
        unit = "" if self.unit == "1" else f" [{self.unit}]"
        return f"${self.symbol}${unit}"


_LEVEL = "water_surface_height_above_reference_datum"
_OPERATIONS = {
    "forces": "the forces applied on the grid (gravity, viscosity, porosity gradient)",
    "projection": "the pressure projection, the implicit porous drag included",
    "transfer": "the transfers between particles and grid",
    "advection": "moving the particles",
    "exchange": "the water that came in through open sides, less what went out",
    "correction": "the position correction",
    "remeshing": "remeshing",
}

FIELDS: tuple[Field, ...] = (
    # particles
    Field("position", "x", "m", "particle", "position; the last axis is up", vector=True),
    Field(
        "velocity",
        "u",
        "m s-1",
        "particle",
        "pore velocity, Darcy velocity over porosity: what moves the water",
        vector=True,
    ),
    Field("volume", "V", "m3", "particle", "water volume, constant between remeshings", unit_2d="m2"),
    Field(
        "porosity",
        "n",
        "1",
        "particle",
        "pore volume over total volume that the particle moves with, 1 in clear water; fitted to what cells hold, so "
        "within two of a face it differs from that of the body by up to a quarter of the step, and may be above 1",
    ),
    Field("pressure", "p", "Pa", "particle", "pressure above the air, interpolated from the grid"),
    # faces and centres of the grid
    Field(
        "velocity", "u_d", "m s-1", "face", "Darcy velocity normal to the face: flow rate over total area", vector=True
    ),
    Field("velocity", "u_d", "m s-1", "centre", "Darcy velocity, mean of the two faces of each axis", vector=True),
    Field("pressure", "p", "Pa", "centre", "pressure above the air, solution of the projection"),
    Field("fill", r"\varphi", "1", "centre", "water volume over the pore volume of the cell"),
    Field("porosity", "n", "1", "centre", "mean porosity of the open part of the cell"),
    # observations
    Field("eta", r"\eta", "m", "surface", "level of the free surface above z = 0, NaN where dry", standard_name=_LEVEL),
    Field("eta", r"\eta", "m", "gauge", "level of the free surface above z = 0, NaN when dry", standard_name=_LEVEL),
    Field("pressure", "p", "Pa", "sensor", "pressure above the air; in a structure, the pore pressure"),
    Field("velocity", "u_d", "m s-1", "sensor", "Darcy velocity", vector=True),
    Field("runup_x", "x_R", "m", "runup", "where the connected water ends on the slope, NaN when dry"),
    Field(
        "runup_level",
        "R",
        "m",
        "runup",
        "level above z = 0 of the end of the connected water, NaN when dry",
        standard_name=_LEVEL,
    ),
    Field(
        "overtopping_volume",
        "V_o",
        "m3",
        "overtopping",
        "volume of water that has crossed the section above the level given, since the start",
        unit_2d="m2",
    ),
    Field(
        "overtopping_discharge",
        "q_o",
        "m3 s-1",
        "overtopping",
        "rate of change of overtopping_volume",
        unit_2d="m2 s-1",
    ),
    Field("discharge", "q", "m3 s-1", "flux", "discharge through the section towards larger x", unit_2d="m2 s-1"),
    Field(
        "phreatic_level",
        r"\eta_p",
        "m",
        "phreatic",
        "level of the water in the pores above z = 0, NaN where dry",
        standard_name=_LEVEL,
    ),
    Field(
        "force",
        "F",
        "N",
        "structure",
        "force of the water: pressure, and in a porous body drag",
        unit_2d="N m-1",
        vector=True,
    ),
    Field("drag_force", "F_d", "N", "structure", "the part of the force that is drag", unit_2d="N m-1", vector=True),
    Field(
        "moment",
        "M",
        "N m",
        "structure",
        "moment of the force about the point given; in 2D about y, positive when it tips towards larger x",
        unit_2d="N",
    ),
    Field("paddle_position", "X", "m", "paddle", "where the moving wall stands"),
    # ledger
    Field("time", "t", "s", "run", "simulated time"),
    Field("volume", "V", "m3", "run", "water volume carried by the particles", unit_2d="m2"),
    Field(
        "volume_drift",
        r"\Delta V/V_0",
        "1",
        "run",
        "change of the water volume since the start that is not in- or outflow, over the first volume and inflow",
    ),
    Field("inflow", "V_{in}", "m3", "run", "volume come in through open sides since the start", unit_2d="m2"),
    Field("outflow", "V_{out}", "m3", "run", "volume gone out through open sides since the start", unit_2d="m2"),
    Field("mean_level", r"\bar\eta", "m", "run", "water under the free surface, in its pores, over the plan area"),
    *(
        Field(
            f"momentum_{axis}", f"P_{axis}", "kg m s-1", "run", f"momentum of the water along {axis}", unit_2d="kg s-1"
        )
        for axis in "xyz"
    ),
    Field("kinetic_energy", "E_k", "J", "run", "kinetic energy of the water, added mass included", unit_2d="J m-1"),
    Field(
        "potential_energy",
        "E_p",
        "J",
        "run",
        "potential energy of the water above z = 0; with [waves] that of the levels of its columns",
        unit_2d="J m-1",
    ),
    Field("drag_work", "W_d", "J", "run", "energy lost to the porous drag since the start", unit_2d="J m-1"),
    Field("viscous_work", "W_\\nu", "J", "run", "energy lost to viscosity since the start", unit_2d="J m-1"),
    Field(
        "sponge_work", "W_s", "J", "run", "energy lost to sponges and relaxation zones since the start", unit_2d="J m-1"
    ),
    Field(
        "source_work",
        "W_w",
        "J",
        "run",
        "energy given by wave makers and moving walls, less what they took, since the start",
        unit_2d="J m-1",
    ),
    Field("open_work", "W_o", "J", "run", "work of the pressure at open sides since the start", unit_2d="J m-1"),
    *(
        Field(
            f"energy_{name}",
            f"\\Delta E_{{{name[:4]}}}",
            "J",
            "run",
            f"energy brought by {what}, since the start",
            unit_2d="J m-1",
        )
        for name, what in _OPERATIONS.items()
    ),
    Field("max_speed", r"|u|_{max}", "m s-1", "run", "largest pore speed of a particle"),
    Field("courant", "C", "1", "run", "largest pore speed times step size over spacing"),
    Field("step_size", r"\Delta t", "s", "run", "time step"),
    Field(
        "divergence",
        r"|\nabla\cdot u_d|\Delta t",
        "1",
        "run",
        "largest relative volume change of a wet cell left by the projection in one step",
    ),
    Field("pressure_iterations", "N_p", "1", "run", "iterations of the pressure solver"),
    Field("correction_iterations", "N_c", "1", "run", "iterations of the position correction"),
    Field("particles", "N", "1", "run", "number of particles"),
)

OPERATIONS = tuple(_OPERATIONS)
_TABLE = {(field.place, field.name): field for field in FIELDS}


def find(name: str, place: Place = "run") -> Field:
    """The entry of the table. An unknown name is our bug, not the user's: RuntimeError says where to add it."""
    try:
        return _TABLE[place, name]
    except KeyError:
        raise RuntimeError(
            f"internal error: no field {name!r} at place {place!r} in houle/fields.py; add it there with its unit"
        ) from None


def at(place: Place) -> tuple[Field, ...]:
    """All fields of one place, in the order of the table."""
    return tuple(field for field in FIELDS if field.place == place)
