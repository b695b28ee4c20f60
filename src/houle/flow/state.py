"""The flow: the state that a time step advances, that is the particles and the fields on the grid.

Arrays that are needed only while a step lasts are in workspace.py.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.flow.boundaries import Boundaries, Boundary, Tank
from houle.flow.component import Component, State
from houle.flow.kernels import KERNELS
from houle.flow.particles import Column, Particles
from houle.flow.seeding import column_pores, seed_slabs
from houle.flow.viscosity import REACH, Smoothing
from houle.flow.workspace import Workspace
from houle.grid import Core, Faces, FloatArray, Grid, Listed, spread, widened
from houle.medium.columns import Capacity
from houle.medium.interfaces import Interfaces
from houle.medium.medium import OBLIQUE, Medium
from houle.medium.rough_walls import RoughWalls
from houle.medium.shapes import Box

if TYPE_CHECKING:
    from houle.flow.crest import Crest

SPRAY = 1e-3  # a face that carries less than this of a cell's volume is empty
HEAVY = 30.0  # pores with K / n^2 (`Medium`) above this are heavy: gravity hardly changes their velocity in a step
MOST_CONTRAST = 30.0  # ratio of C_r/n^2 at an interface up to which the Bernoulli force acts on faces (section 6)
AROUND = 4  # cells on each side of a gate that are flooded to measure what the tents beside it hold
LARGE = 100_000  # a flow with more particles gives its work space back before it remeshes


class Behind(NamedTuple):
    """Faces in solids, and the open faces beside each, whose mean velocity they get after the projection.

    face    (K,) flat numbers of the closed faces; around (K,) number of open faces beside each
    beside  (T,) flat numbers of all these open faces
    number  (P,) which of `beside`, face after face; share (P,) 1 / around
    """

    face: NDArray[np.intp]
    around: NDArray[np.intp]
    beside: NDArray[np.int64]
    number: NDArray[np.intp]
    share: FloatArray


class Flow(Tank):
    """The water in a tank, its boundaries, and the numbers of the method that moves it.

    gravity       acceleration of the water per axis, the last one up [m/s2]
    kernel        name of the kernel of the transfers, one of `KERNELS`
    tolerance     largest max |div u_d| dt that the projection may leave [-]
    viscosity     kinematic viscosity [m2/s]; smagorinsky: constant C_s of the eddy viscosity [-]
    no_slip       per axis: whether the low and the high wall hold the water back along them
    walls         the walls that rub, of solids and sides of the tank; None where none does
    boundaries    in the order in which they act

    A flow is *arranged* when its particles are sorted by cell, the medium is sampled where they are, and the free
    surface is found (`surface.arrange`). Arrays on the grid are overwritten in each step; those of the particles grow
    if needed.
    """

    def __init__(
        self,
        grid: Grid,
        medium: Medium,
        particles: Particles,
        *,
        gravity: tuple[float, ...],
        kernel: str = "linear",
        tolerance: float = 1e-6,
        viscosity: float = 0.0,
        smagorinsky: float = 0.0,
        no_slip: tuple[tuple[bool, bool], ...] | None = None,
        walls: RoughWalls | None = None,
        boundaries: Sequence[Boundary] = (),
    ) -> None:
        super().__init__(grid, medium, particles, gravity)
        self.kernel = kernel
        self.tolerance = tolerance
        self.viscosity, self.smagorinsky = viscosity, smagorinsky
        self.no_slip = [side for pair in no_slip or ((False, False),) * grid.dimension for side in pair]
        self.walls = walls
        planes = 0 if walls is None else len(walls.plane)
        self.impulse = np.zeros((planes, grid.dimension))  # given to each plane of `walls` in a step [m^d m/s]
        self.porous = bool(np.any(medium.porosity < 1.0))
        self.column_porosity = column_pores(grid, medium)

        g = grid
        self.inverse_capacity = g.cells()  # 1 / what a tent of full pores holds [1/m^d], 0 in solids
        self.water_height = np.zeros(g.shape[:-1])  # water of each column over its plan area, without grains [m]
        self.filled_level = np.zeros(g.shape[:-1])  # level up to which this water fills the pores of the column [m]
        self.single_level = np.zeros(g.shape[:-1])  # the same in cells; NaN where the surface is not single-valued
        self.drag: Faces = []  # factor D of (12) by which the drag scales the old velocity; made only for FLIP [-]
        self.nu = g.cells() if smagorinsky > 0.0 else None  # kinematic viscosity with the eddies' [m2/s]
        self.psi = np.zeros(g.shape, np.float32)  # first guess of the potential of the position correction [m2]
        self.fastest = [0.0] * grid.dimension  # largest |u_d| / n of the particles along each axis, arranged [m/s]
        self.crests: list[Crest] = []  # sections at which overtopping is booked
        self.held = [np.zeros(u.shape, np.uint8) for u in self.velocity] if self.porous else []  # faces: 1 near an
        # interface deep under water, where the pressure on both sides holds the flux and the Bernoulli force acts
        self.start = np.zeros(math.prod(g.shape) + 1, np.int32)  # number of the first particle of each cell
        self._declare_columns()
        self.enclose(boundaries)

    # ---- checkpoints ---------------------------------------------------------------------------------------------

    on_rows = ("pressure", "psi", "velocity")

    def parts(self) -> Mapping[str, Component]:
        return {"particles": self.particles, "boundaries": self.boundaries}

    def state(self) -> State:
        own = {"time": np.array(self.time), "step_size": np.array(self.step_size)}
        velocity = {f"velocity.{axis}": u for axis, u in enumerate(self.velocity)}
        return {**super().state(), **own, **velocity, "pressure": self.pressure, "psi": self.psi}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Goes on from a `state`; the particles have to be arranged before the next step."""
        super().restore(state)
        self.time, self.step_size = float(state["time"]), float(state["step_size"])
        self.pressure[...], self.psi[...] = state["pressure"], state["psi"]
        for axis, u in enumerate(self.velocity):
            u[...] = state[f"velocity.{axis}"]
        self.stand()

    # ---- boundaries ----------------------------------------------------------------------------------------------

    def enclose(self, boundaries: Sequence[Boundary]) -> None:
        """Puts the boundaries around the water and in it; those that stood there before are gone.

        `interfaces` are then those of the medium and of shut gates; `mixed` is the capacity of the columns whose
        porosity varies or that hold solids.
        """
        self.boundaries = Boundaries(self, boundaries)
        self.interfaces, self.mixed = self.medium.interfaces, Capacity.of(self.grid, self.medium)
        self.measure_capacity()
        if len(self.boundaries.gates):
            self.whole_capacity, self.whole_mixed = self.inverse_capacity.copy(), self.mixed
            self._part_at_gates()
        self.sample_medium()

    @property
    def viscous(self) -> bool:
        """True if the water has a viscosity, its own or that of eddies."""
        return self.viscosity > 0.0 or self.smagorinsky > 0.0

    @property
    def resists(self) -> bool:
        """True if anything resists the flow: porous bodies, sponges or relaxation zones."""
        return self.porous or bool(self.boundaries.damping)

    @property
    def mobility(self) -> Faces:
        """Phi of (13), factor of grad p / rho in the projection, on faces [s]; empty without resistance: it is dt."""
        return self.work.mobility if self.resists else []

    @cached_property
    def smoothing(self) -> Smoothing:
        """Sums over the neighbours of each particle, within two cells: the viscosity of the scheme jh2020."""
        walls = tuple("no-slip" if side else "slip" for side in self.no_slip)
        return Smoothing(self.grid, walls, REACH * max(self.grid.spacing))

    @property
    def crossed_medium(self) -> tuple[list[NDArray[np.int32]], FloatArray, Listed, Listed]:
        """The medium as the core takes it for particles that cross from one porosity to another.

        These are `Medium.material`, `Medium.materials`, and the kinds "inertia" and "uniform".
        """
        m = self.medium
        return m.material, m.materials, m.listed("inertia"), m.listed("uniform")

    @property
    def lag(self) -> Listed | None:
        """1 - K/C_r of the cells as the core takes it; None where K = C_r everywhere, that is by default."""
        return self.medium.listed("lag") if "lag" in self.medium.kinds else None

    @cached_property
    def edges(self) -> list[tuple[NDArray[np.int64], NDArray[np.int64], FloatArray, FloatArray]]:
        """Faces of each axis beside which another face of that axis has another inertia C_r / n.

        One tuple per axis: flat numbers of these faces (K,) and of the faces beside each (K, 2 d), inertia of these
        faces (K,) and of those beside them (K, 2 d) [-].
        """
        found = []
        for axis, faces in enumerate(self.medium.on_faces(0) if self.porous else []):
            around, inertia = self._beside(axis), faces.ravel()
            where = np.flatnonzero((inertia[around] != inertia[:, None]).any(axis=1))
            found.append((where, around[where], inertia[where], inertia[around[where]]))
        return found

    @cached_property
    def heavy(self) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Faces of each axis with a cell of heavy pores beside them, K / n^2 above `HEAVY`; no axes without such cells.

        One pair per axis: flat numbers of these faces (K,) and of the faces of the axis beside each (K, 2 d).
        """
        found, energy = [], self.medium.energy if self.porous else np.ones(1)
        for axis, wraps in enumerate(self.grid.periodic if energy.max() > HEAVY else ()):
            wide = widened(energy, axis, wraps)
            where = np.flatnonzero(np.moveaxis(np.maximum(wide[:-1], wide[1:]) > HEAVY, 0, axis))
            found.append((where, self._beside(axis)[where]))
        return found

    @cached_property
    def behind_walls(self) -> list[Behind]:
        """The closed faces of each axis beside open ones, in tanks with walls that rub: else no axes.

        Faces on a solid's face that is parallel to them are left out: what crosses it is stopped by the pressure.
        """
        found, open_cells = [], self.medium.open_cells
        for axis, faces in enumerate(self.medium.open_faces if self.walls is not None else []):
            wide = widened(open_cells, axis, self.grid.periodic[axis])
            on_face = np.moveaxis((wide[:-1] == 1.0) | (wide[1:] == 1.0), 0, axis).ravel()
            around, is_open = self._beside(axis), faces.ravel() > 0.0
            face = np.flatnonzero(~is_open & ~on_face & is_open[around].any(axis=1))
            known = is_open[around[face]]
            beside, number = np.unique(around[face][known], return_inverse=True)
            share = (known / np.maximum(known.sum(axis=1, keepdims=True), 1))[known]
            found.append(Behind(face, known.sum(axis=1), beside, number.ravel(), share))
        return found if any(len(axis.face) for axis in found) else []

    def _beside(self, own: int) -> NDArray[np.int64]:
        """Flat numbers (faces, 2 d) of the faces of an axis beside each: before and after it along every axis.

        Behind a wall stands the face itself.
        """
        shape, beside = self.grid.face_shape(own), []
        number = np.arange(math.prod(shape)).reshape(shape)
        for axis, wraps in enumerate(self.grid.periodic):
            wide = widened(number, axis, wraps)
            if axis == own and wraps:  # the first face is the last: the second and the last but one are beside both
                wide[[0, -1]] = wide[[-3, 2]]
            beside += [np.moveaxis(part, 0, axis).ravel() for part in (wide[:-2], wide[2:])]
        return np.stack(beside, axis=1)

    @cached_property
    def at_interface(self) -> NDArray[np.bool_]:
        """`Medium.at_interface`, computed once: cells (grid.shape) near a change of K / n^2."""
        return self.medium.at_interface

    @cached_property
    def at_oblique_interface(self) -> NDArray[np.bool_]:
        """Cells (grid.shape) at an oblique interface where K / n^2 differs by no more than `MOST_CONTRAST`."""
        oblique = self.medium.contrast == OBLIQUE
        return self.at_interface & oblique & ~self.medium.near_contrast(MOST_CONTRAST)

    def joined_cells(self) -> NDArray[np.bool_]:
        """Cells (grid.shape) of `at_oblique_interface` with water and no air around: the pressure joins them."""
        air = (self.active == 0) & (self.medium.open_cells > 0.0)
        return self.at_oblique_interface & (self.active != 0) & ~spread(air, self.grid.periodic)

    def joined_faces(self) -> list[NDArray[np.uint8]] | None:
        """1 on the faces of `joined_cells`, 0 on others, per axis; None where there is no oblique interface."""
        if not (self.porous and self._has_oblique):
            return None
        cells, found = self.joined_cells(), []
        for axis, wraps in enumerate(self.grid.periodic):
            wide = np.moveaxis(np.pad(cells, [(int(a == axis),) * 2 for a in range(cells.ndim)]), axis, 0)
            if wraps:
                wide[0], wide[-1] = wide[-2], wide[1]
            found.append(np.ascontiguousarray(np.moveaxis(wide[:-1] | wide[1:], 0, axis), np.uint8))
        return found

    @cached_property
    def _has_oblique(self) -> bool:
        return bool(self.at_oblique_interface.any())

    @cached_property
    def around_interface(self) -> NDArray[np.uint8]:
        """The cells of `at_interface` and all that touch one (grid.shape), as the core takes them."""
        return np.ascontiguousarray(spread(self.at_interface, self.grid.periodic), np.uint8)

    def stand(self) -> bool:
        """Finds anew what depends on the places of the boundaries. Returns whether a gate has moved.

        Then the free surface beside the gate has to be found anew, and the medium to be sampled, as particles see
        other faces.
        """
        moved = self.boundaries.stand()
        if moved:
            self._part_at_gates()
        return moved

    def _part_at_gates(self) -> None:
        """Finds what gates change where they stand: interfaces, and what columns and tents beside them can hold."""
        gates = self.boundaries.gates
        self.mixed = self.whole_mixed.between_gates(self.grid, self.medium, gates)
        self.interfaces = Interfaces.with_gates(self.grid, gates, self.medium.interfaces)
        self.inverse_capacity[...] = self.whole_capacity
        h, size = self.grid.spacing, self.grid.size
        for x, _ in gates:
            near = max(0.0, x - AROUND * h[0]), min(size[0], x + AROUND * h[0])
            around = Box((near[0], *(0.0,) * (len(h) - 1)), (near[1], *size[1:]))
            beside = slice(round(x / h[0]) - 1, round(x / h[0]) + 1)
            self.inverse_capacity[beside] = self._inverse_capacity(around, gates)[beside]

    def measure_capacity(self) -> None:
        """Measures W_c of (7): the water in the tent of each cell when all pores of the tank are full.

        It is the sum of the fill, over the particles of a flooded tank, and not an integral. So the fill of water at
        rest is 1 to round-off across interfaces of any slope, where sum and integral differ by 1e-3. On return
        `inverse_capacity` holds 1 / W_c.
        """
        self.inverse_capacity[...] = self._inverse_capacity(Box((0.0,) * self.grid.dimension, self.grid.size))

    def _inverse_capacity(self, box: Box, gates: FloatArray | None = None) -> FloatArray:
        """1 / W_c [1/m^d] where the pores of a box are full; 0 for tents that hold nearly nothing. gates: (K, 2)."""
        core, start = self.grid.core, np.zeros_like(self.start)
        capacity, part, inverse = self.grid.cells(), self.grid.cells(), self.grid.cells()
        for flood in seed_slabs(self.grid, self.medium, [box]):
            order, cell = np.zeros(len(flood), np.int32), np.zeros(len(flood), np.int32)
            _core.cell_sort(core, flood.position, cell, order, start)
            _core.scatter_cells(core, start, flood.position[order], flood.volume[order], part, gates=gates)
            capacity += part
        least = 1e-9 * self.grid.cell_volume
        np.divide(1.0, capacity, out=inverse, where=capacity > least)
        return inverse

    def listed(self, name: str) -> Listed | None:
        """One of `Medium.kinds` as the core takes it; None without porous bodies, where it is 1 everywhere."""
        return self.medium.listed(name) if self.porous else None

    # ---- arrays per particle -------------------------------------------------------------------------------------

    def _declare_columns(self) -> None:
        """Declares the columns in which the flow keeps, for each particle, the medium at its place."""
        unread = float("nan")
        if self.porous:
            inertia = Column("inertia", "place", (self.grid.dimension,), unread, np.float32)
            self.particles.declare(Column("bulk", "place", new=unread), inertia)
        if KERNELS[self.kernel].sized:
            self.particles.declare(Column("side", "place", new=unread))

    @property
    def bulk(self) -> FloatArray:
        """V / n of the particles (N,) [m^d], with the porosity (bi)linear from the cells."""
        return self.particles["bulk"] if self.porous else self.particles.volume

    @property
    def inertia(self) -> NDArray[np.float32] | None:
        """C_r / n at the particles, of each axis (N, d) [-], float32; None in clear water, where it is 1."""
        return self.particles.get("inertia")

    @property
    def side(self) -> FloatArray | None:
        """Edge length of the square of each particle (N,) [m], for the Gaussian kernels; None for the others."""
        return self.particles.get("side")

    @property
    def porosity(self) -> FloatArray:
        """Porosity at the particles (N,) [-]."""
        return self.particles.volume / self.bulk if self.porous else np.broadcast_to(1.0, len(self.particles))

    @property
    def cloud(self) -> tuple[Core, str, FloatArray, FloatArray | None, FloatArray, NDArray[np.int32]]:
        """The grid, the kernel and the particles as the core takes them in a transfer."""
        return self.grid.core, self.kernel, self.particles.position, self.side, self.bulk, self.start

    def interpolate(self, faces: Faces, out: FloatArray) -> None:
        """Interpolates a field on the faces to the particles, with the weights of velocities; sets out (N, d)."""
        _core.to_particles(*self.cloud, faces, [], [], 0.0, out, self.interfaces)

    def drop_work(self) -> None:
        """Gives the memory of the work space of a large flow back. A small flow keeps it: to get it anew takes time."""
        if len(self.particles) > LARGE:
            self.work = Workspace(self.grid, len(self.particles))
            _core.return_memory()

    def sample_medium(self) -> None:
        """Sets the columns of the place, bulk volume, inertia and side, for the present positions of the particles."""
        p, core = self.particles, self.grid.core
        if self.porous:
            pores = self.medium.listed("particle_porosity")
            particles = (p.position, p.volume, self.bulk, p["inertia"])
            _core.sample_medium(core, *self.crossed_medium, pores, *particles, self.interfaces)
        self._find_sides()

    def carry(self, dt: float, ago: FloatArray | None) -> None:
        """Does what `sample_medium` does after a motion of dt [s], and corrects velocities for the change of medium.

        A particle that no pressure holds keeps its kinetic energy, (14a); the velocity turns where C_r changes, (4a).
        ago: K/C_r (N,) where the particles were before; None where it is 1 everywhere.
        """
        p, m = self.particles, self.medium
        medium = (*self.crossed_medium, self.held, m.listed("particle_porosity"), m.listed("coefficient"))
        state = (p.position, p.volume, self.bulk, p["inertia"], p.velocity)
        _core.carry(self.grid.core, *medium, dt, *state, self.lag, ago, self.interfaces)
        self._find_sides()

    def _find_sides(self) -> None:
        if self.side is not None:
            self.side[...] = self.bulk ** (1.0 / self.grid.dimension)

    def copied_particles(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Copies of position (N, d) [m], Darcy velocity (N, d) [m/s] and porosity (N,) [-] of the particles."""
        return self.particles.position.copy(), self.particles.velocity.copy(), np.array(self.porosity)

    # ---- derived -------------------------------------------------------------------------------------------------

    def kinetic_energy(self) -> float:
        """Kinetic energy of the particles per density, 1/2 sum B (C_r/n) u_d^2 [m^d m2/s2]."""
        return _core.kinetic_energy(self.bulk, self.inertia, self.particles.velocity)

    def grid_kinetic_energy(self) -> float:
        """Kinetic energy of the faces per density, with the bulk volumes that the transfer gave them [m^d m2/s2]."""
        m = self.medium
        return _core.face_kinetic_energy(self.grid.core, self.work.face_mass, m.material, m.materials, self.velocity)

    def potential_energy(self) -> float:
        """Potential energy of the particles per density, -sum V g.x [m^d m2/s2]; periodic axes do not count."""
        d = self.grid.dimension
        return -sum(
            g * _core.weighted_sum(self.particles.volume, self.particles.position, a)
            for a, g in enumerate(self.gravity[:d])
            if g != 0.0 and not self.grid.periodic[a]
        )

    def passing(self, axis: int) -> FloatArray:
        """Darcy velocity on the faces of an axis [m/s]; where two media share a face, the mean over both."""
        u = self.velocity[axis]
        if self.medium.shared and len(self.medium.shared[axis].face):
            faces, u = self.medium.shared[axis], u.copy()
            u.ravel()[faces.face] = faces.mean(u)
        return u

    def pore_velocity(self) -> FloatArray:
        """Pore velocity u_d / n of the particles (N, d) [m/s]."""
        return self.particles.velocity / self.porosity[:, None]

    def courant(self, dt: float) -> float:
        """Courant number: cells that the fastest particle crosses in dt [s], the largest along one axis [-]."""
        return self.crossed(self.max_pore_speed()) * dt

    def crossed(self, speed: list[float]) -> float:
        """Cells crossed per second at these speeds along the axes [m/s], the largest of the axes [1/s]."""
        return max(v / h for v, h in zip(speed, self.grid.spacing, strict=True))

    def max_pore_speed(self) -> list[float]:
        """Largest |u_d| / n of the particles along each axis [m/s]; NaN where one of them is NaN."""
        p = self.particles
        return _core.max_speed(p.velocity, p.volume, self.bulk)
