"""The setup of a simulation: physics objects and numbers, for any number of rows of cells; no case file.

`houle.case.build` makes a `Setup` from a case; a user of the library can make one by hand. A simulation keeps it,
because it builds its flow anew on a higher grid when the water rises (rows.py).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import inf

from houle.flow.boundaries import Boundary
from houle.flow.observer import Instruments
from houle.flow.particles import Particles
from houle.flow.snapshot import Frames
from houle.flow.state import Flow
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Shape
from houle.waves.wave import Wave

Make = Callable[[Grid, Medium, Particles], Boundary]  # (grid of a flow, its medium, water at the start) -> boundary

WAVE_SHARE = 1.0 / 3.0  # share of the step sqrt(h/g) of the shortest wave on the grid: keeps long waves from decaying
SHORTEST = 1e-6  # share of sqrt(h/g), the time of fall through a cell: a run that needs shorter steps has failed


@dataclass(frozen=True)
class Water:
    """Water at the start: the region that it fills, and its Darcy velocity per axis [m/s], None at rest."""

    shape: Shape
    velocity: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Fluid:
    """The water and the uniform forces on it.

    density       [kg/m3]
    viscosity     kinematic viscosity [m2/s]
    smagorinsky   constant C_s of the eddy viscosity [-], 0 for none
    gravity       gravity, downwards [m/s2]
    acceleration  gravity and a uniform push together, per axis, the last one up [m/s2]
    """

    density: float
    viscosity: float
    smagorinsky: float
    gravity: float
    acceleration: tuple[float, ...]


@dataclass(frozen=True)
class Numerics:
    """The method by the names of its parts: scheme, transfer, kernel and remeshing, and their numbers.

    order         number of terms of the transfer "fmpm"
    flip          share of FLIP in the transfer "flip" [-]
    remesh_every  least number of steps between two remeshings
    correction    share of the excess volume of a cell that the position correction spreads when the fastest particle
                  crosses a quarter of a cell in a step [-]
    tolerance     largest relative volume change max |div u_d| dt that the pressure solve may leave [-]
    """

    scheme: str
    transfer: str
    order: int
    flip: float
    kernel: str
    remesh: str
    remesh_every: int
    correction: float
    tolerance: float


@dataclass(frozen=True)
class TimeControl:
    """Length of the run and of its steps [s].

    courant  cells that the fastest particle may cross in a step [-]; unused where `step` is given
    step     fixed step [s]; None: the step follows from courant
    viscous  longest step with which the explicit viscosity is stable [s]
    """

    end: float
    courant: float = 0.5
    step: float | None = None
    viscous: float = inf


@dataclass(frozen=True)
class Setup:
    """Everything a simulation needs to build its flow.

    grid        of the whole domain, and of the results; a run keeps its lowest rows
    rows        rows of cells that a run starts with
    water       where water stands at the start
    bodies      porous bodies; where two overlap, the later one holds
    solids      impermeable shapes, one for each body of the case
    no_slip     per axis, last up: whether the low and the high wall hold the water back along them
    rough       roughness k_s of each solid [m]: 0 for smooth ones, None where the water slips along it
    rough_sides sides of the tank that rub, and their roughness [m]
    settles     whether water beside upright interfaces is seeded as flow leaves it (`Medium`): not where gates stand
    boundaries  functions that make one boundary each, in this order
    instruments instruments that observe the flow, one entry for each kind
    frames      (flow, grid of the domain, density [kg/m3]) -> `Frames`, which takes snapshots for the writers
    wave        the wave that is made; None without waves
    """

    grid: Grid
    rows: int
    water: tuple[Water, ...]
    fluid: Fluid
    numerics: Numerics
    time: TimeControl
    instruments: tuple[Instruments, ...]
    frames: Callable[[Flow, Grid, float], Frames]
    bodies: tuple[PorousBody, ...] = ()
    solids: tuple[Shape, ...] = ()
    no_slip: tuple[tuple[bool, bool], ...] | None = None
    rough: tuple[float | None, ...] = ()
    rough_sides: Mapping[str, float] = field(default_factory=dict)
    settles: bool = True
    boundaries: tuple[Make, ...] = ()
    wave: Wave | None = None
