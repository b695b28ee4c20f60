"""Boundaries: the tank as they see it, the protocol that each one follows, and the list of all in a tank.

A boundary writes those methods of `Boundary` in which it does something; the others do nothing. Any two can stand in
one tank: their openness is multiplied; resistances, pushes and fluxes add; and the velocity of a face is prescribed by
one of them only. Where two cannot stand together, the boundary says so with the physical reason when it joins.

The methods see the tank (grid, medium, water), not the flow that calls them, and are called in this order: `join` once,
`prepare` for the first pressure, and in each step `begin`, `drive`, `push`, `feed`, `impose`, `power`, `advance`,
`exchange`. `houle.boundary` holds one kind in each of its files, with its row of `BOUNDARIES`: what it is, and what
makes it from the keys of its table in a case file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, overload

import numpy as np

from houle.flow.component import Component
from houle.flow.particles import EVERYWHERE, Nodes, Particles
from houle.flow.workspace import Workspace
from houle.grid import Faces, FloatArray, Grid, SingleFaces
from houle.medium.medium import Medium
from houle.registry import Choices
from houle.waves.wave import Wave

Row = tuple[float, float]


class Tank(Component):
    """Water in a tank: particles, and fields on the grid. Each step overwrites the arrays of the fields.

    gravity       acceleration of the water per axis, the last one up [m/s2]
    time          time of the particle positions; during a step, its start [s]
    step_size     length of the step that is done or in progress [s]
    last_step     length of the step before that, 0 in the first [s]
    kick          time over which the last forces changed old_velocity into velocity [s]
    fill          water volume over pore volume of the cells, with the tent function as weight: (7) [-]
    submergence   depth of the cell centres below the free surface, negative above it: (8) [cells]
    active        cells: 1 where the centre is under water, which have a pressure
    eta           level of the free surface in the columns of cells [m], NaN where dry
    velocity      Darcy velocity on the faces [m/s]; old_velocity: before the forces
    pressure      p / rho of the cells [m2/s2]
    work          arrays that are needed only during a step
    """

    def __init__(self, grid: Grid, medium: Medium, particles: Particles, gravity: tuple[float, ...]) -> None:
        self.grid, self.medium, self.particles = grid, medium, particles
        self.gravity = tuple(float(g) for g in gravity)
        self.time = self.step_size = self.last_step = 0.0
        self.kick = 1.0
        self.fill = grid.cells()
        self.submergence = grid.cells()
        self.active = np.zeros(grid.shape, np.uint8)
        self.eta = np.zeros(grid.shape[:-1])
        self.velocity = grid.faces()
        self.old_velocity = grid.faces()
        self.pressure = grid.cells()
        self.work = Workspace(grid, len(particles))

    def kick_of(self, dt: float) -> float:
        """Time over which forces act: from the middle of the last step to that of a step of dt [s] that begins now."""
        return 0.5 * (self.last_step + dt)


class Boundary(Component):
    """A gate, a moving wall, an open side, a source, a zone or a sponge: this one does nothing.

    name          its name in messages
    work          sum of the ledger in which `power` is booked
    came, went    volume of water that has come in and gone out through it since the start [m^d]
    """

    name: str = ""
    work: ClassVar[Literal["source_work", "open_work"]] = "source_work"
    came: float = 0.0
    went: float = 0.0

    # ---- where it stands -----------------------------------------------------------------------------------------

    def join(self, tank: Tank, boundaries: Boundaries) -> None:
        """Learns the tank and the other boundaries, once. Raises CaseError if it cannot stand beside one of them."""

    def openness(self, faces: SingleFaces) -> None:
        """Multiplies the open area fraction of the faces, in place, by the share that it leaves open now."""

    def columns(self, share: FloatArray) -> None:
        """Multiplies the water's share of each column of cells, (nx, [ny]), by the share that it leaves now."""

    def images(self) -> Sequence[Row]:
        """Mirror planes across the tank, in which particles have images, as walls between the faces have them.

        Each is x [m], and +1 where the water is on its right, -1 where it is on its left.
        """
        return ()

    def gates(self) -> Sequence[Row]:
        """Plates across the tank that stop particles: x of a face, and height of the lower edge on a grid line [m]."""
        return ()

    def dry(self, tank: Tank) -> None:
        """Marks the cells in which it leaves no water as dry, in the surface that was just found."""

    # ---- what it does to the faces -------------------------------------------------------------------------------

    def resist(self, rate: Faces) -> None:
        """Adds its damping, which is the same at all times, to the linear resistance of the faces [1/s]."""

    def touches(self) -> dict[int, slice]:
        """Faces that it pushes: for each axis of faces the range of their numbers along x. Fixed from `join` on."""
        return {}

    def push(self, t: float, acceleration: Faces) -> None:
        """Adds the acceleration with which it pushes the water at the time t [s] to that of the faces [m/s2].

        The faces are those of `touches`. A push that depends on the velocity of the water, tank.velocity, is found in
        `drive`. Its work is booked as source_work of the ledger, whatever `work` says.
        """

    # ---- in a step -----------------------------------------------------------------------------------------------

    def prepare(self, tank: Tank) -> None:
        """Takes the velocities at its faces from the water in the tank, before the first pressure of a run."""

    def begin(self, tank: Tank, dt: float) -> None:
        """Decides how it moves in the step of dt [s] that begins at tank.time."""

    def drive(self, tank: Tank, dt: float) -> None:
        """Chooses the velocities at its faces for that step, when those of the water are known on the grid."""

    def feed(self, tank: Tank) -> None:
        """Adds the flux through its faces to the right-hand side of the pressure system, tank.work.rhs [1/s]."""

    def impose(self, tank: Tank) -> None:
        """Gives its faces their velocity, after the projection, and marks them valid."""

    def power(self, tank: Tank) -> float:
        """Power of the pressure on its faces, over the density: pressure times flux into the water [m^d m2/s3]."""
        return 0.0

    def advance(self, tank: Tank) -> None:
        """Moves to where it stands at the end of the step."""

    def exchange(self, tank: Tank, dt: float) -> None:
        """Lets particles in and takes particles out for a step of dt [s], after they have moved."""

    def to_lattice(self, particles: Particles) -> None:
        """Shifts particles before a remeshing, so that the boundary stands between two nodes of their lattice."""

    def from_lattice(self, particles: Particles) -> None:
        """Shifts the new particles of the remeshing back."""


class Boundaries(Component, Sequence[Boundary]):
    """All boundaries of a tank, in the order in which they act, and the sums and products over them.

    Openness and shares of columns are found anew when a mirror plane or a gate has moved.

    damping       linear resistance of the faces [1/s]; empty where nothing damps
    pushes        accelerations of the faces [m/s2]
    pushed        axis of faces -> range along x of the faces that are pushed
    open_faces    open area fraction of the faces: that of the medium times the openness of each boundary; the arrays
                  of the medium themselves where no boundary closes anything
    column_share  water's share of each column of cells, (nx, [ny]) [-]; None without moving walls: 1 everywhere
    walls         mirror planes (K, 2): x [m] and the side of the water, as in `Boundary.images`; None without any
    gates         gates (K, 2): x and height of the lower edge [m]
    nodes         first node and end of the lattice of the particles along x, between moving walls
    """

    def __init__(self, tank: Tank, entries: Sequence[Boundary] = ()) -> None:
        self.grid, self.medium, self.entries = tank.grid, tank.medium, tuple(entries)
        self.damping = self._damping()
        self.open_faces = tank.medium.open_faces
        self.column_share: FloatArray | None = None
        self.walls: FloatArray | None = None
        self.gates: FloatArray = np.zeros((0, 2))
        self.nodes: Nodes = EVERYWHERE
        for boundary in self:
            boundary.join(tank, self)
        self.pushed = self._touched()
        self.pushes = tank.grid.faces() if self.pushed else []
        if self.with_method("openness"):
            self._open()
        self.stand()

    def _damping(self) -> Faces:
        if not (resisting := self.with_method("resist")):
            return []
        rate = self.grid.faces()
        for boundary in resisting:
            boundary.resist(rate)
        return rate if any(r.any() for r in rate) else []

    @overload
    def __getitem__(self, key: int) -> Boundary: ...

    @overload
    def __getitem__(self, key: slice) -> tuple[Boundary, ...]: ...

    def __getitem__(self, key: int | slice) -> Boundary | tuple[Boundary, ...]:
        return self.entries[key]

    def __len__(self) -> int:
        return len(self.entries)

    def __iter__(self) -> Iterator[Boundary]:
        return iter(self.entries)

    def parts(self) -> Mapping[str, Boundary]:
        return {str(i): boundary for i, boundary in enumerate(self)}

    def with_method(self, method: str) -> list[Boundary]:
        """The boundaries whose class writes this method of `Boundary`, and so does something in it."""
        return [b for b in self if getattr(type(b), method) is not getattr(Boundary, method)]

    def stand(self) -> bool:
        """Finds anew what depends on the places of the boundaries, if one has moved. Returns whether a gate has."""
        if not self.entries:
            return False
        walls = np.array([row for boundary in self for row in boundary.images()]).reshape(-1, 2)
        gates = np.array([row for boundary in self for row in boundary.gates()]).reshape(-1, 2)
        known = np.zeros((0, 2)) if self.walls is None else self.walls
        gate_moved = not np.array_equal(gates, self.gates)
        if np.array_equal(walls, known) and not gate_moved:
            return False
        self.walls, self.gates = walls if len(walls) else None, gates
        self._open()
        grid = self.grid
        if len(walls):
            node = [round(2.0 * (x / grid.spacing[0])) for x in walls[:, 0]]
            left = [n for n, side in zip(node, walls[:, 1], strict=True) if side > 0]
            right = [n for n, side in zip(node, walls[:, 1], strict=True) if side < 0]
            self.nodes = max(left, default=0), min(right, default=2 * grid.shape[0])
            self.column_share = np.ones(grid.shape[:-1])
            for boundary in self:
                boundary.columns(self.column_share)
        return gate_moved

    def _open(self) -> None:
        """Sets the open area of the faces, in arrays of the list: those of the medium are never written."""
        medium = self.medium.open_faces
        if self.open_faces is medium:
            self.open_faces = [faces.copy() for faces in medium]
        for faces, whole in zip(self.open_faces, medium, strict=True):
            faces[...] = whole
        for boundary in self:
            boundary.openness(self.open_faces)

    def _touched(self) -> dict[int, slice]:
        found: dict[int, slice] = {}
        for boundary in self:
            for axis, s in boundary.touches().items():
                before = found.get(axis, s)
                found[axis] = slice(min(before.start, s.start), max(before.stop, s.stop))
        return found

    def push(self, t: float) -> Faces:
        """Accelerations of the faces [m/s2] by all boundaries at the time t [s]; 0 outside `pushed`."""
        for axis, where in self.pushed.items():
            self.pushes[axis][where] = 0.0
        for boundary in self:
            boundary.push(t, self.pushes)
        return self.pushes


@dataclass(frozen=True)
class Surroundings:
    """The rest of a case, as far as the makers of boundaries ask for it.

    gravity    downwards [m/s2]
    wave       the wave that is made in the tank; None without
    ramp       time in which the wave grows from nothing to its height [s]
    zone       ends of the relaxation zone that leads the flow to the wave [m]; None without
    lets_long  whether the zone lets long waves pass that come back: for a record and for a single wave
    open_left  whether the left side of the tank is open
    """

    gravity: float
    wave: Wave | None = None
    ramp: float = 0.0
    zone: tuple[float, float] | None = None
    lets_long: bool = False
    open_left: bool = False


@dataclass(frozen=True)
class BoundaryKind:
    """A kind of boundary as the case file, `houle describe makers` and `houle.case.build` know it.

    name         name of its table in the case file
    make         (surroundings, grid, medium, water, **keys of its table) -> Boundary in a flow with this grid and
                 medium, and with these particles of water at the start; CaseError where it cannot be
    place        order among the boundaries of a flow: lower numbers act first
    full_height  whether it reaches over the whole height of the tank; a run then keeps all rows of cells
    divides      whether it can separate the water of two neighbouring columns of cells, as a gate does
    """

    name: str
    what: str
    source: str
    make: Callable[..., Boundary]
    place: int
    range: str = ""
    full_height: bool = True
    divides: bool = False


BOUNDARIES: Choices[BoundaryKind] = Choices("boundary", package="houle.boundary")
