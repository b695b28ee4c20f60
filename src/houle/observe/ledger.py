"""The ledger in the series: volume, momentum and energy of all water, and all that it gained and lost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.fields import RUN, Field, Stations
from houle.flow.ledger import OPERATIONS, WORKS, Ledger
from houle.flow.observer import Instrument, Now, Observer, Sample, Site
from houle.flow.state import Flow
from houle.grid import FloatArray, axes
from houle.medium.columns import Storage

NOTES = ("divergence", "pressure_iterations", "correction_iterations")  # notes of the ledger about the last step
_WORKS = {
    "drag_work": ("W_d", "energy of the water lost to the drag of porous bodies since the start"),
    "viscous_work": (r"W_\nu", "energy of the water lost to viscosity since the start"),
    "friction_work": ("W_f", "energy of the water lost to the friction of beds, walls and solids since the start"),
    "sponge_work": ("W_s", "energy of the water taken by sponges and relaxation zones since the start"),
    "source_work": (
        "W_w",
        "energy given to the water by moving walls and by boundaries that push it, as wave makers do, less what they "
        "took, since the start",
    ),
    "open_work": ("W_o", "work of the pressure on the water at open sides since the start"),
}
_OPERATIONS = {
    "forces": "the forces applied on the grid (gravity, viscosity, change of porosity)",
    "projection": "the pressure projection, with the implicit drag of porous bodies",
    "transfer": "the transfers between particles and grid",
    "advection": "the motion of the particles",
    "exchange": "the water that came in through open sides, less the water that went out",
    "correction": "the correction of the positions of the particles",
    "remeshing": "the remeshing of the particles",
}


def _energy(name: str, symbol: str, description: str, velocity: bool) -> Field:
    return Field(name, symbol, "J", RUN, description, unit_2d="J m-1", instant="velocity" if velocity else "position")


def _volume(name: str, symbol: str, description: str) -> Field:
    return Field(name, symbol, "m3", RUN, description, unit_2d="m2")


def _number(name: str, symbol: str, description: str) -> Field:
    return Field(name, symbol, "1", RUN, description)


@dataclass(frozen=True)
class Books(Instrument):
    """The ledger of a run as an instrument: it needs no place.

    by_levels  true where waves are made: the potential energy is that of the levels of the columns, which do not know
               how the particles are packed, and not the sum over the particles
    """

    by_levels: bool = False


class LedgerRow(Observer[Books]):
    """Sums over all of the water, and what the ledger of the flow has booked since the start."""

    instrument = Books
    fields = (
        _volume("volume", "V", "volume of the water that the particles carry"),
        _number(
            "volume_drift",
            r"\Delta V/V_0",
            "change of the volume of the water since the start that is not in- or outflow, as a share of the first "
            "volume and the inflow",
        ),
        _volume("inflow", "V_{in}", "volume of water that has come in through open sides since the start"),
        _volume("outflow", "V_{out}", "volume of water that has gone out through open sides since the start"),
        Field("mean_level", r"\bar\eta", "m", RUN, "volume of the water under the free surface, over the area in plan"),
        *(
            Field(
                f"momentum_{axis}",
                f"P_{axis}",
                "kg m s-1",
                RUN,
                f"momentum of the water along {axis}",
                unit_2d="kg s-1",
                instant="velocity",
            )
            for axis in "xyz"
        ),
        _energy("kinetic_energy", "E_k", "kinetic energy of the water with that of its added mass", True),
        _energy(
            "potential_energy",
            "E_p",
            "potential energy of the water above the datum z = 0, with waves that of the levels of its columns",
            False,
        ),
        *(_energy(name, *_WORKS[name], True) for name in WORKS),
        *(
            _energy(
                f"energy_{name}",
                f"\\Delta E_{{{name[:4]}}}",
                f"energy that the water has got from {_OPERATIONS[name]} since the start",
                False,
            )
            for name in OPERATIONS
        ),
        Field("max_speed", r"|u|_{max}", "m s-1", RUN, "largest pore speed of a particle", instant="velocity"),
        _number("courant", "C", "Courant number: cells that the fastest particle crosses in a time step"),
        Field("step_size", r"\Delta t", "s", RUN, "length of the time step"),
        _number(
            "divergence",
            r"|\nabla\cdot u_d|\Delta t",
            "largest relative change of volume of a wet cell that the pressure projection leaves in a time step",
        ),
        _number("pressure_iterations", "N_p", "number of iterations of the pressure solver in a time step"),
        _number("correction_iterations", "N_c", "number of iterations of the position correction in a time step"),
        _number("particles", "N", "number of particles"),
    )

    def __init__(self, instruments: Sequence[Books], site: Site, flow: Flow) -> None:
        self.by_levels, self.density = instruments[0].by_levels, site.density
        self.flow = flow

    @classmethod
    def stations(cls, instruments: Sequence[Books], site: Site) -> Stations:
        return Stations((), {}, cls.fields)

    def sample(self, now: Now) -> Sample:
        flow, ledger, rho = self.flow, now.ledger, self.density
        p, speed = flow.particles, flow.fastest
        works = {name: rho * getattr(ledger, name) for name in WORKS}
        momentum = {
            f"momentum_{axis}": rho * _core.weighted_sum(flow.bulk, p.velocity, a)
            for a, axis in enumerate(axes(flow.grid.dimension))
        }
        return {
            "volume": p.total_volume,
            "volume_drift": ledger.volume_drift(),
            "inflow": float(ledger.inflow),
            "outflow": float(ledger.outflow),
            "mean_level": self.mean_level(),
            **momentum,
            "kinetic_energy": rho * ledger.kinetic,
            "potential_energy": rho * self.potential_energy(ledger),
            **works,
            **{f"energy_{name}": rho * ledger.energy[name] for name in OPERATIONS},
            "max_speed": max(speed),
            "courant": flow.crossed(speed) * flow.step_size,
            "step_size": flow.step_size,
            **{name: float(ledger.notes.get(name, 0.0)) for name in NOTES},
            "particles": float(len(p)),
        }

    def mean_level(self) -> float:
        """Mean level [m]: volume of the water under the free surface over the plan area.

        A column with a single-valued surface counts with the volume below its level; any other (steep, overhanging,
        beside interfaces) with the volume of the water in it.
        """
        return self._storage.mean_level(self.flow.eta, self.flow.boundaries.column_share, water_held(self.flow))

    def potential_energy(self, ledger: Ledger) -> float:
        """Potential energy over density [m^d m2/s2]: that of the levels where waves are made, else of the particles."""
        *along, down = self.flow.gravity
        if not self.by_levels or any(along):
            return ledger.potential
        return -down * self._storage.height_moment(self.flow.eta, self.flow.boundaries.column_share)

    @cached_property
    def _storage(self) -> Storage:
        return Storage.of(self.flow.grid, self.flow.medium)


def water_held(flow: Flow) -> tuple[NDArray[np.bool_], FloatArray]:
    """Mask of the columns without a level, or beside interfaces and solids; water in these over the plan area (C,) [m].

    A column has no level of its own where its surface is not single-valued: it is steep, overhanging, splashing, or
    beside such a column. Its surface is then found from the submergence of its cells.
    """
    columns = flow.eta != flow.single_level * flow.grid.spacing[-1]
    columns.ravel()[flow.mixed.column] = True
    number = np.flatnonzero(columns)
    held = np.empty(len(number))
    cells = (flow.active, flow.medium.listed("open_cells"), flow.fill, flow.inverse_capacity)
    _core.water_held(flow.grid.core, *cells, flow.water_height, number, held)
    return columns, flow.grid.spacing[-1] / flow.grid.cell_volume * held
