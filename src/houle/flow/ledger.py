"""The ledger: how each operation of a step changes the energy of the water, and what the run has conserved.

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

WORKS = ("drag_work", "viscous_work", "friction_work", "sponge_work", "source_work", "open_work")
OPERATIONS = ("forces", "projection", "transfer", "advection", "exchange", "correction", "remeshing")


class Booked(Protocol):
    """The part of a flow that its ledger reads: the water, its boundaries, its energies over density."""

    particles: Particles
    boundaries: Boundaries

    def kinetic_energy(self) -> float:
        """Kinetic energy of the particles over density [m^d m2/s2]."""
        ...

    def grid_kinetic_energy(self) -> float:
        """Kinetic energy on the faces over density [m^d m2/s2]."""
        ...

    def potential_energy(self) -> float:
        """Potential energy of the particles over density [m^d m2/s2]."""
        ...


class _Clock:
    """Context manager of one operation: times it and, if `books`, books the change of energy that it made.

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
    """Sums of a run: time and change of energy of each operation, and the work that was done on the water and by it.

    Energies and works are per density [m^d m2/s2] and count from the start of the run.

    seconds        time that each operation took since the process started [s]
    energy         change of energy made by each of OPERATIONS
    notes          numbers of the last step: iterations of the solver, divergence
    volume0        volume of the water at the start [m^d]
    drag_work      energy that the porous bodies took
    viscous_work   energy that the viscosity took, with that taken by the no-slip walls of `viscosity`
    friction_work  energy that rough and smooth walls and solids took
    sponge_work    energy that sponges and relaxation zones took
    source_work    work on the water of moving walls and of boundaries that push it, as wave makers do
    open_work      work of the pressure at open sides on the water
    given          work of makers, moving walls and open sides, summed over the steps in which it was positive
    kinetic, potential   energy of the water after the last operation
    """

    def __init__(self, flow: Booked) -> None:
        self.flow = flow
        self.seconds: dict[str, float] = {}
        self.energy: dict[str, float] = dict.fromkeys(OPERATIONS, 0.0)
        self.notes: dict[str, float] = {}
        self.volume0 = flow.particles.total_volume
        self.drag_work = self.viscous_work = self.friction_work = self.sponge_work = 0.0
        self.source_work = self.open_work = self.given = 0.0
        self.kinetic, self.potential = 0.0, 0.0
        self._gave = 0.0  # `_net` at the end of the last step
        self._on_grid = False  # True between the transfers, when the kinetic energy is that of the faces
        self._counted = ref(flow.particles)  # particles after the last operation: remeshing makes others

    def operation(self, name: str) -> _Clock:
        """A context that times an operation and, if it is one of OPERATIONS, books its change of the energy."""
        return _Clock(self, name, name in self.energy)

    def clock(self, name: str) -> _Clock:
        """A context that times something that does not change the energy."""
        return _Clock(self, name, False)

    def book(self, name: str) -> None:
        """Books the change of energy made by an operation that ends now."""
        flow = self.flow
        open_sides = flow.boundaries.with_method("exchange")
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
        """Takes the energy of the flow as it is now: at the start of a run, and when it goes on from a checkpoint."""
        self.kinetic, self.potential = self.flow.kinetic_energy(), self.flow.potential_energy()
        self._on_grid = False

    def close(self) -> None:
        """Ends a step: sums both energies anew, and books the change that is left to advection.

        It is left because a particle that moves to another porosity with the same u_d changes its V/n and C_r/n. The
        sums run in the order of the sorted particles, so that a resumed run starts from the same energies to the last
        bit.
        """
        kinetic = self.kinetic
        self.open()
        self.energy["advection"] += self.kinetic - kinetic
        gave = self._net()
        self.given += max(gave - self._gave, 0.0)
        self._gave = gave

    def _net(self) -> float:
        """Energy that makers, moving walls and open sides gave the water since the start, less what they took."""
        return self.source_work + self.open_work + self.energy["exchange"]

    def give(self, work: str, energy: float) -> None:
        """Books energy under one of `WORKS` [m^d m2/s2]."""
        setattr(self, work, getattr(self, work) + energy)

    @property
    def start(self) -> float:
        """Kinetic and potential energy of the water at the start of the run, together."""
        return self.kinetic + self.potential - sum(self.energy.values())

    @property
    def inflow(self) -> float:
        """Volume of water that has come in through open sides since the start [m^d]."""
        return sum(boundary.came for boundary in self.flow.boundaries)

    @property
    def outflow(self) -> float:
        """Volume of water that has gone out through open sides since the start [m^d]."""
        return sum(boundary.went for boundary in self.flow.boundaries)

    def volume_drift(self) -> float:
        """Volume that nothing accounts for: present + outflow - start - inflow, over start + inflow [-]."""
        held = self.volume0 + self.inflow
        return (self.flow.particles.total_volume + self.outflow - held) / held if held > 0 else 0.0

    def note(self, **values: float) -> None:
        """Notes numbers of this step, in the place of those of the last one."""
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
        """Goes on with the sums of a state(); the flow must have been restored and arranged before."""
        for name in (*WORKS, "volume0", "given"):
            setattr(self, name, float(state[name]))
        for sums, kind in ((self.energy, "energy."), (self.notes, "notes.")):
            sums.update({key.removeprefix(kind): float(state[key]) for key in state if key.startswith(kind)})
        self.open()
        self._gave = self._net()
