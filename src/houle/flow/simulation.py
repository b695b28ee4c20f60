"""The simulation: builds the flow from its setup, chooses the time steps, advances the flow and samples it.

`advance` takes one step, as step.py writes it. Steps are shortened only to end at the stop time that is given.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.errors import CaseError, SimulationError
from houle.flow.budget import Budget
from houle.flow.component import Component, State, under
from houle.flow.ledger import Ledger
from houle.flow.motion import begin
from houle.flow.observer import Now, Observer, Sample
from houle.flow.particles import Particles
from houle.flow.remeshers import REMESHERS
from houle.flow.remeshing_schedule import RemeshingSchedule
from houle.flow.rows import more_rows
from houle.flow.seeding import seed
from houle.flow.setup import SHORTEST, WAVE_SHARE, Setup, Water
from houle.flow.snapshot import Snapshot
from houle.flow.start import prepare
from houle.flow.state import Flow
from houle.flow.step import STEPS
from houle.flow.surface import arrange
from houle.flow.transfer import TRANSFERS
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.patches import Surfaces
from houle.medium.rough_walls import RoughWalls
from houle.waves.wave import Wave


class Simulation(Component):
    """The state of a run.

    setup      what it is made from
    grid       grid of the whole domain and of the results; the flow has its lowest rows (rows.py)
    flow       particles and fields; step: the scheme that advances them
    ledger     sums of energy, work and seconds
    observers  instruments that are placed in the flow; frames: takes snapshots
    steps      number of steps done

    Where `threads` is given, the loops of the core share this number of threads.
    """

    def __init__(self, setup: Setup, threads: int | None = None) -> None:
        if threads:
            _core.set_threads(threads)
        self.setup, self.grid = setup, setup.grid
        self.steps = 0
        self._build(setup.rows)
        self.ledger = Ledger(self.flow)
        prepare(self.flow, self.step.transfer, self.ledger)
        self.ledger.open()

    def _build(self, rows: int) -> None:
        """Builds the flow as it starts, arranged, on this number of rows of cells, with step, observers and budget."""
        setup, grid = self.setup, self.grid.lowest(rows)
        fluid, numerics = setup.fluid, setup.numerics
        self.medium = Medium.build(grid, setup.bodies, setup.solids, settles=setup.settles)
        water = seed(grid, self.medium, [w.shape for w in setup.water])
        _set_off(setup.water, water)
        self.flow = Flow(
            grid, self.medium, water, gravity=fluid.acceleration,
            kernel=numerics.kernel, tolerance=numerics.tolerance,
            viscosity=fluid.viscosity, smagorinsky=fluid.smagorinsky, no_slip=setup.no_slip,
            walls=self._walls(grid),
            boundaries=[make(grid, self.medium, water) for make in setup.boundaries],
        )  # fmt: skip
        transfer = TRANSFERS[numerics.transfer].of(order=numerics.order, flip=numerics.flip)
        remeshing = RemeshingSchedule(REMESHERS[numerics.remesh].of(grid, self.medium), numerics.remesh_every)
        self.flow.particles.declare(*transfer.columns(grid.dimension))
        self.step = STEPS[numerics.scheme](transfer, numerics.correction, remeshing)
        arrange(self.flow)
        self.observers: list[Observer[Any]] = [kind.place(self.flow) for kind in setup.instruments]
        self.frames = setup.frames(self.flow, self.grid, fluid.density)
        self.budget = Budget(self.flow)

    def _walls(self, grid: Grid) -> RoughWalls | None:
        """The walls of the setup that rub, on a grid of its lowest rows; the lid only where the grid reaches it."""
        setup, medium = self.setup, self.medium
        rough = setup.rough or (None,) * len(medium.solids)
        below = grid.shape[-1] < self.grid.shape[-1]
        sides = {side: k for side, k in setup.rough_sides.items() if not (side == "top" and below)}
        if not sides and not any(k is not None for k in rough):
            return None
        return RoughWalls.of(Surfaces(grid, medium.open_cells, medium.bodies, medium.solids), rough, sides)

    @property
    def time(self) -> float:
        """Time of the particles [s]."""
        return self.flow.time

    @property
    def step_size(self) -> float:
        """Length of the last step [s], 0 before the first."""
        return self.flow.step_size

    @property
    def wave(self) -> Wave | None:
        """The wave that is made in the tank; None without waves."""
        return self.setup.wave

    @property
    def particles(self) -> Particles:
        return self.flow.particles

    @property
    def timings(self) -> dict[str, float]:
        """Time that each operation took since the process started [s]."""
        return self.ledger.seconds

    @property
    def volume_drift(self) -> float:
        """Relative change of the volume of water that is neither inflow nor outflow [-]."""
        return self.ledger.volume_drift()

    # ---- marching ------------------------------------------------------------------------------------------------

    def advance(self, stop: float) -> None:
        """Advances by one time step, never past `stop` [s]. The remaining time is divided into equal steps."""
        if not (isinstance(stop, Real) and self.time < stop < math.inf):
            raise CaseError(f"stop = {stop!r} is not a time after t = {self.time:g} s: give a later one [s]")
        if self.steps == 0:
            self.ledger.open()  # velocities may have been set since it was made
        self._make_room()
        remaining, largest = stop - self.time, self._largest_step()
        count = max(1, math.ceil(remaining / largest - 1e-9))
        dt = remaining / count
        begin(self.flow, dt)
        try:
            self.step.advance(self.flow, dt, self.ledger)
            self.ledger.close()
            for observer in self.observers:
                observer.after_step(dt)
            self.flow.time = stop if count == 1 else self.time + dt
            self.steps += 1
            self._check(largest)
        except SimulationError as error:
            error.step, error.time = self.steps, self.time
            raise

    def _make_room(self) -> None:
        """Rebuilds the flow with more rows of cells if the water has come near to the uppermost one."""
        more = more_rows(self.flow, self.grid.shape[-1]) - self.flow.grid.shape[-1]
        if more:
            self.restore(self.raised(self.state(), more))

    def _largest_step(self) -> float:
        """Longest time step allowed now [s]: time.step where given, else by Courant number and viscosity.

        No particle crosses more than `time.courant` of a cell, the shortest wave on the grid at most a third of that
        (`WAVE_SHARE`), and the explicit viscosity stays stable, which is no limit in water.
        """
        control = self.setup.time
        gravity = max(abs(g) for g in self.flow.gravity) or 1e-300
        cells = max(self.flow.crossed(self.flow.fastest), 1e-300)  # crossed in a second
        if control.step is not None:
            courant = cells * control.step
            if courant > 1.0:
                raise SimulationError(
                    f"time.step = {control.step:g} s is too long: the fastest particle crosses "
                    f"{courant:.2f} cells in a step, at most 1. Leave step out and give courant, or halve the step.",
                    diagnosis="The fixed time step is longer than the flow allows.",
                )
            return control.step
        crossed = min(1.0 / cells, WAVE_SHARE * math.sqrt(self.grid.spacing[-1] / gravity))
        return min(control.courant * crossed, control.viscous)

    def _check(self, largest: float) -> None:
        """Raises SimulationError where the state is no physical flow any more, after a step.

        largest: time step [s] that the flow allowed; the step itself may have been shorter, to end at the stop.
        """
        p = self.particles
        if not (all(map(math.isfinite, self.flow.fastest)) and _core.all_finite(p.position)):
            raise SimulationError(
                "the velocity is no longer a number", diagnosis="A particle velocity became infinite or not a number."
            )
        if largest < SHORTEST * math.sqrt(self.grid.spacing[-1] / max(9.81, *map(abs, self.flow.gravity))):
            raise SimulationError(
                f"the time step has shrunk to {largest:.1e} s: some water moves at {np.abs(p.velocity).max():.3g} m/s",
                diagnosis="A few particles have a speed without physical cause; another transfer or kernel may not.",
            )
        drift = self.volume_drift
        if not math.isfinite(drift):
            raise SimulationError(
                "the volume is no longer a number", diagnosis="A particle carries a volume that is not a number."
            )
        if abs(drift) > 1e-9 and self.step.remeshing.remesher.conserves:
            raise SimulationError(
                f"water was lost: the volume has changed by {drift:.2e} of itself",
                diagnosis="The volume carried by the particles is conserved to round-off; a change is a fault.",
            )
        self.budget.check(self.flow, self.ledger, self.setup.fluid.density)

    # ---- observing -----------------------------------------------------------------------------------------------

    @property
    def lag(self) -> dict[str, float]:
        """Share of a step by which each quantity of sample() is older than `time` [-]."""
        of = {"position": 0.0, "middle": 0.5, "velocity": self.step.velocity_lag, "pressure": self.step.pressure_lag}
        return {field.name: of[field.instant] for observer in self.observers for field in observer.fields}

    def sample(self) -> Sample:
        """The present values of all observers, as copies, by the names of their fields."""
        now = Now(self.flow, self.ledger)
        return {name: value for observer in self.observers for name, value in observer.sample(now).items()}

    def frame(self) -> Snapshot:
        """A snapshot of this instant for the writers and the pictures, as copies."""
        return self.frames.take(self.steps)

    # ---- checkpoints ---------------------------------------------------------------------------------------------

    def parts(self) -> Mapping[str, Component]:
        observers = {f"observers/{observer.dimension}": observer for observer in self.observers}
        return {"flow": self.flow, "step": self.step, "ledger": self.ledger, **observers}

    def state(self) -> State:
        return {**super().state(), "steps": np.array(self.steps)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Goes on from a `state` of the same setup, bitwise as if it had never stopped."""
        rows = state["flow/pressure"].shape[-1]
        if rows != self.flow.grid.shape[-1]:
            del self.flow, self.medium, self.step, self.ledger.flow  # first, for the memory
            del self.observers, self.frames
            self._build(rows)
            self.ledger.flow = self.flow
        self.steps = int(state["steps"])
        self.flow.restore(under("flow", state))
        arrange(self.flow)  # the ledger sums the energy of the particles in this order
        for name, part in self.parts().items():
            if part is not self.flow:
                part.restore(under(name, state))


def _set_off(water: Iterable[Water], particles: Particles) -> None:
    """Gives the first particles the velocities of the shapes they lie in."""
    for entry in water:
        if entry.velocity is not None:
            particles.velocity[entry.shape.contains(particles.position)] = entry.velocity
