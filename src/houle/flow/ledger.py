"""The ledger: what each operation of a step did to the energy of the water, and what the run has conserved.

The energy of the water is kinetic + potential. Inside a step the kinetic energy is that of the particles, but between
the two transfers it is that of the faces; so the changes of all operations add up to the change of the energy of the
particles, and every source and sink has a name. Energies and works are per density [m^d m2/s2]: whoever writes them
multiplies by it.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Protocol
from weakref import ref

import numpy as np

from houle.flow.boundaries import Boundaries
from houle.flow.component import Component, State
from houle.flow.particles import Particles
from houle.grid import FloatArray

WORKS = ("drag_work", "viscous_work", "sponge_work", "source_work", "open_work")
OPERATIONS = ("forces", "projection", "transfer", "advection", "exchange", "correction", "remeshing")


class Booked(Protocol):
    """What a ledger reads of the flow whose energy it books: the water, its boundaries, its energies per density."""

    particles: Particles
    boundaries: Boundaries

    def kinetic_energy(self) -> float:
        """That of the particles [m^d m2/s2]."""
        ...

    def grid_kinetic_energy(self) -> float:
        """That of the faces [m^d m2/s2]."""
        ...

    def potential_energy(self) -> float:
        """That of the particles [m^d m2/s2]."""
        ...


class _Clock:
    """Times what is done inside `with`, and books the energy that it changed where it `books`.

    It is a class because a generator would take three times as long, in every operation of every step.
    """

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


class Ledger(Component):
    """Sums of a run: how long each operation took, what it did to the energy, what was taken and given.

    seconds        that each operation took since the process started
    energy         change by each of OPERATIONS since the start of the run
    notes          numbers of the last step: iterations of the solver, divergence
    volume0        water at the start [m^d]
    drag_work      taken by the porous bodies
    viscous_work   taken by the viscosity
    sponge_work    taken by sponges and relaxation zones
    source_work    given by wave makers and moving walls
    open_work      given by the pressure at open sides
    given          by makers, moving walls and open sides, in the steps in which they gave more than they took
    kinetic, potential   energy after the last operation
    """

    def __init__(self, flow: Booked) -> None:
        self.flow = flow
        self.seconds: dict[str, float] = {}
        self.energy: dict[str, float] = dict.fromkeys(OPERATIONS, 0.0)
        self.notes: dict[str, float] = {}
        self.volume0 = flow.particles.total_volume
        self.drag_work = self.viscous_work = self.sponge_work = 0.0
        self.source_work = self.open_work = self.given = 0.0
        self.kinetic, self.potential = 0.0, 0.0
        self._gave = 0.0  # by makers, moving walls and open sides, less what they took, since the start
        self._on_grid = False  # whether the kinetic energy is that of the faces now
        self._counted = ref(flow.particles)  # the particles after the last operation

    def operation(self, name: str) -> _Clock:
        """A context that times an operation and books what it did to the energy."""
        return _Clock(self, name, name in self.energy)

    def clock(self, name: str) -> _Clock:
        """A context that times what does not change the energy."""
        return _Clock(self, name, False)

    def book(self, name: str) -> None:
        """Books what an operation that ends now did to the energy."""
        flow = self.flow
        open_sides = flow.boundaries.that("exchange")
        if (name == "exchange" and not open_sides) or (name == "remeshing" and self._counted() is flow.particles):
            return  # nothing was done
        kinetic, potential = self.kinetic, self.potential
        if name == "transfer":
            self._on_grid = not self._on_grid
        if name in ("transfer", "forces", "projection"):
            kinetic = flow.grid_kinetic_energy() if self._on_grid else flow.kinetic_energy()
        else:
            potential = flow.potential_energy()
            if name in ("exchange", "remeshing"):
                kinetic = flow.kinetic_energy()
        self.energy[name] += kinetic + potential - self.kinetic - self.potential
        self.kinetic, self.potential, self._counted = kinetic, potential, ref(flow.particles)

    def open(self) -> None:
        """Begins with the energy of the flow as it is now: at the start of a run, and where it goes on."""
        self.kinetic, self.potential = self.flow.kinetic_energy(), self.flow.potential_energy()
        self._on_grid = False

    def close(self) -> None:
        """Ends a step: what is left of the change is that of advection.

        To move with the same u_d to another porosity is to change V/n and C_r/n. Both energies are summed anew, in the
        order of the sorted particles: those that a resumed run starts from, to the last bit.
        """
        kinetic = self.kinetic
        self.open()
        self.energy["advection"] += self.kinetic - kinetic
        gave = self._net()
        self.given += max(gave - self._gave, 0.0)
        self._gave = gave

    def _net(self) -> float:
        """What makers, moving walls and open sides gave since the start, less what they took."""
        return self.source_work + self.open_work + self.energy["exchange"]

    def give(self, work: str, energy: float) -> None:
        """Books energy under one of `WORKS` [m^d m2/s2]."""
        setattr(self, work, getattr(self, work) + energy)

    @property
    def start(self) -> float:
        """Kinetic and potential energy at the start of the run."""
        return self.kinetic + self.potential - sum(self.energy.values())

    @property
    def inflow(self) -> float:
        """Volume that has come in through open sides [m^d]."""
        return sum(boundary.came for boundary in self.flow.boundaries)

    @property
    def outflow(self) -> float:
        """Volume that has gone out through open sides [m^d]."""
        return sum(boundary.went for boundary in self.flow.boundaries)

    def volume_drift(self) -> float:
        """Water that is there and should not be, as a share of what there was and what came [-]."""
        held = self.volume0 + self.inflow
        return (self.flow.particles.total_volume + self.outflow - held) / held if held > 0 else 0.0

    def note(self, **values: float) -> None:
        """Puts numbers of this step in the place of those of the last one."""
        self.notes.update(values)

    # ---- checkpoints ---------------------------------------------------------------------------------------------

    def state(self) -> State:
        """Every sum since the start of the run, and the notes of the last step; not the seconds."""
        return {
            **{name: np.array(getattr(self, name)) for name in (*WORKS, "volume0", "given")},
            **{f"energy.{name}": np.array(value) for name, value in self.energy.items()},
            **{f"notes.{name}": np.array(float(value)) for name, value in self.notes.items()},
        }

    def restore(self, state: Mapping[str, FloatArray]) -> None:
        """Goes on with the sums of a state(); the flow must stand as it did then, arranged."""
        for name in (*WORKS, "volume0", "given"):
            setattr(self, name, float(state[name]))
        for sums, kind in ((self.energy, "energy."), (self.notes, "notes.")):
            sums.update({key.removeprefix(kind): float(state[key]) for key in state if key.startswith(kind)})
        self.open()
        self._gave = self._net()
