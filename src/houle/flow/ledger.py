"""The ledger: what each operation of a step did to the energy, and what the run has conserved.

Energies are per step of the sequence in `step.py`, kinetic + potential. Inside a step the kinetic energy is that of the
particles, except between the two transfers, where it is that of the faces; so the changes of all operations add up
to the change of the particles' energy, and source and sink have a name. Units: m^d m2/s2; times the density outside.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING
from weakref import ref

if TYPE_CHECKING:
    from houle.flow.state import Flow

WORKS = ("drag_work", "viscous_work", "sponge_work", "source_work", "open_work")
OPERATIONS = ("forces", "projection", "transfer", "advection", "exchange", "correction", "remeshing")


class _Clock:
    """Times what is done inside `with` and books the energy it changed. A class: a generator takes thrice as long."""

    __slots__ = ("begin", "books", "ledger", "name")

    def __init__(self, ledger: Ledger, name: str, books: bool) -> None:
        self.ledger, self.name, self.books = ledger, name, books

    def __enter__(self) -> None:
        self.begin = time.perf_counter()

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        seconds, end = self.ledger.seconds, time.perf_counter()
        seconds[self.name] = seconds.get(self.name, 0.0) + end - self.begin
        if self.books and kind is None:
            self.ledger.book(self.name)
            seconds["ledger"] = seconds.get("ledger", 0.0) + time.perf_counter() - end


class Ledger:
    """Seconds and energy change of every operation, summed since the start of the run; notes of the last step."""

    def __init__(self, flow: Flow) -> None:
        self.flow = flow
        self.seconds: dict[str, float] = {}
        self.energy: dict[str, float] = dict.fromkeys(OPERATIONS, 0.0)
        self.notes: dict[str, float] = {}
        self.volume0 = flow.particles.total_volume
        self.drag_work = 0.0
        self.viscous_work = 0.0
        self.sponge_work = 0.0  # taken by sponges and relaxation zones
        self.source_work = 0.0  # given by wave makers
        self.open_work = 0.0  # of the pressure at open sides
        self.kinetic, self.potential = 0.0, 0.0  # at the last operation [m^d m2/s2]
        self.given = 0.0  # by makers, moving walls and open sides, in the steps in which they gave
        self._gave = 0.0  # by them, less what they took, since the start
        self.on_grid = False
        self.counted = ref(flow.particles)  # at the last operation; remeshing puts others in their place

    def operation(self, name: str) -> _Clock:
        """Times an operation and books what it did to the energy."""
        return _Clock(self, name, name in self.energy)

    def clock(self, name: str) -> _Clock:
        """Times what is no change of energy."""
        return _Clock(self, name, False)

    def book(self, name: str) -> None:
        """What an operation that ends now did to the energy."""
        flow = self.flow
        if (name == "exchange" and not flow.sides) or (name == "remeshing" and self.counted() is flow.particles):
            return  # nothing was done
        kinetic, potential = self.kinetic, self.potential
        if name == "transfer":
            self.on_grid = not self.on_grid
        if name in ("transfer", "forces", "projection"):
            kinetic = flow.grid_kinetic_energy() if self.on_grid else flow.kinetic_energy()
        else:
            potential = flow.potential_energy()
            if name in ("exchange", "remeshing"):
                kinetic = flow.kinetic_energy()
        self.energy[name] += kinetic + potential - self.kinetic - self.potential
        self.kinetic, self.potential, self.counted = kinetic, potential, ref(flow.particles)

    def open(self) -> None:
        """With the flow as it is now: at the start of a run, and where it goes on."""
        self.kinetic, self.potential = self.flow.kinetic_energy(), self.flow.potential_energy()
        self.on_grid = False

    def go_on(self) -> None:
        """With the sums of a run that goes on."""
        self.open()
        self._gave = self.source_work + self.open_work + self.energy["exchange"]

    def close(self) -> None:
        """At the end of a step: to move with the same u_d to another porosity is to change V/n and C_r/n.

        Both sums anew, in the order of the sorted particles: those that a resumed run starts from, to the last bit.
        """
        kinetic = self.kinetic
        self.open()
        self.energy["advection"] += self.kinetic - kinetic
        gave = self.source_work + self.open_work + self.energy["exchange"]
        self.given += max(gave - self._gave, 0.0)
        self._gave = gave

    @property
    def start(self) -> float:
        """Kinetic and potential energy at the start of the run [m^d m2/s2]."""
        return self.kinetic + self.potential - sum(self.energy.values())

    @property
    def inflow(self) -> float:
        """Volume that has come in through open sides [m^d]."""
        return sum(side.came for side in self.flow.sides)

    @property
    def outflow(self) -> float:
        """Volume that has gone out through open sides [m^d]."""
        return sum(side.went for side in self.flow.sides)

    def volume_drift(self) -> float:
        """Water that is there and should not be, as a share of what there was and what came [-]."""
        held = self.volume0 + self.inflow
        return (self.flow.particles.total_volume + self.outflow - held) / held if held > 0 else 0.0

    def note(self, **values: float) -> None:
        self.notes.update(values)
