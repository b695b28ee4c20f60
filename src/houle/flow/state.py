"""The state one time step works on: particles and fields on the grid; what it only works with is in workspace.py."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

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
from houle.medium.medium import Medium
from houle.medium.shapes import Box

if TYPE_CHECKING:
    from houle.flow.crest import Crest

SPRAY = 1e-3  # a face that carries less than this of a cell's volume is empty
HEAVY = 30.0  # K / n^2 (`Medium`) of pores in which gravity changes next to nothing in a step
AROUND = 4  # cells beside a gate in which the water counts that its columns can hold
LARGE = 100_000  # particles from which on memory is worth more than the time to get it again


class Flow(Tank):
    """Water in a tank between its boundaries, with the numbers of the method. Arrays are reused from step to step;
    those of the particles grow if needed.

    After each operation of `step.py` the names below hold what their comments say.
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
        boundaries: Sequence[Boundary] = (),
    ) -> None:
        super().__init__(grid, medium, particles, gravity)
        self.kernel = kernel
        self.tolerance = tolerance  # max |div u_d| dt left by the projection
        self.viscosity, self.smagorinsky = viscosity, smagorinsky
        self.no_slip = [side for pair in no_slip or ((False, False),) * grid.dimension for side in pair]
        self.porous = bool(np.any(medium.porosity < 1.0))
        self.column_porosity = column_pores(grid, medium)

        g = grid
        self.inverse_capacity = g.cells()  # 1 / what a tent of full pores holds [1/m^d], 0 in solids
        self.water_height = np.zeros(g.shape[:-1])  # of the water in each column if there were no grains [m]
        self.filled_level = np.zeros(g.shape[:-1])  # to which that fills the pores of the column [m]
        self.single_level = np.zeros(g.shape[:-1])  # the same where the surface is single-valued, else NaN [cells]
        self.drag: Faces = []  # factor by which the implicit resistance scales the old velocity, where it is wanted
        self.nu = g.cells() if smagorinsky > 0.0 else None  # kinematic viscosity with the eddies' [m2/s]
        self.psi = np.zeros(g.shape, np.float32)  # first guess of the potential of the position correction [m2]
        self.fastest = [0.0] * grid.dimension  # largest |u_d| / n along each axis, of an arranged flow [m/s]
        self.crests: list[Crest] = []  # sections that book what crosses them
        self.held = [np.zeros(u.shape, np.uint8) for u in self.velocity] if self.porous else []  # by pressure: faces
        self.start = np.zeros(math.prod(g.shape) + 1, np.int32)
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
        """Puts the boundaries around the water and in it; those that stood there before are gone."""
        self.boundaries = Boundaries(self, boundaries)
        self.interfaces, self.mixed = self.medium.interfaces, Capacity.of(self.grid, self.medium)
        self.measure_capacity()
        if len(self.boundaries.gates):
            self.whole_capacity, self.whole_mixed = self.inverse_capacity.copy(), self.mixed
            self._part_at_gates()
        self.sample_medium()

    @property
    def viscous(self) -> bool:
        """Whether anything rubs, water or eddies."""
        return self.viscosity > 0.0 or self.smagorinsky > 0.0

    @property
    def resists(self) -> bool:
        """Whether anything resists the flow, bodies or sponges."""
        return self.porous or bool(self.boundaries.damping)

    @property
    def mobility(self) -> Faces:
        """Factor of grad p in the projection [s]; empty where nothing resists: it is the time step."""
        return self.work.mobility if self.resists else []

    @cached_property
    def smoothing(self) -> Smoothing:
        """Sums over neighbouring particles, within two cells."""
        walls = tuple("no-slip" if side else "slip" for side in self.no_slip)
        return Smoothing(self.grid, walls, REACH * max(self.grid.spacing))

    @property
    def crossing(self) -> tuple[list[NDArray[np.int32]], FloatArray, Listed, Listed]:
        """The medium as the core takes it for particles that cross from one porosity to another."""
        m = self.medium
        return m.material, m.materials, m.listed("inertia"), m.listed("uniform")

    @property
    def lag(self) -> Listed | None:
        """1 - K/C_r of the cells as the core takes it; None if the added mass stands before all of Du/Dt everywhere."""
        return self.medium.listed("lag") if "lag" in self.medium.kinds else None

    @cached_property
    def edges(self) -> list[tuple[NDArray[np.int64], NDArray[np.int64], FloatArray, FloatArray]]:
        """Faces of each axis that have another inertia than one beside them (K,), and those beside them (K, 2 d), flat;
        then the inertia of the ones and of the others.
        """
        found = []
        for axis, faces in enumerate(self.medium.on_faces(0) if self.porous else []):
            around, inertia = self._beside(axis), faces.ravel()
            where = np.flatnonzero((inertia[around] != inertia[:, None]).any(axis=1))
            found.append((where, around[where], inertia[where], inertia[around[where]]))
        return found

    @cached_property
    def heavy(self) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Faces of each axis (K,) beside a cell where K / n^2 is above `HEAVY`, and those beside them (K, 2 d), flat;
        none where it nowhere is.
        """
        found, energy = [], self.medium.energy if self.porous else np.ones(1)
        for axis, wraps in enumerate(self.grid.periodic if energy.max() > HEAVY else ()):
            wide = widened(energy, axis, wraps)
            where = np.flatnonzero(np.moveaxis(np.maximum(wide[:-1], wide[1:]) > HEAVY, 0, axis))
            found.append((where, self._beside(axis)[where]))
        return found

    def _beside(self, own: int) -> NDArray[np.int64]:
        """The faces beside each one of an axis (faces, 2 d), along each axis before and after it, flat numbers."""
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
        """`Medium.at_interface`, once."""
        return self.medium.at_interface

    @cached_property
    def around_interface(self) -> NDArray[np.uint8]:
        """Those cells, and all that touch one."""
        return np.ascontiguousarray(spread(self.at_interface, self.grid.periodic), np.uint8)

    def stand(self) -> bool:
        """Finds anew what follows from where the boundaries stand. Returns whether a gate has moved: then the surface
        beside it is another, and so are the faces that particles see.
        """
        moved = self.boundaries.stand()
        if moved:
            self._part_at_gates()
        return moved

    def _part_at_gates(self) -> None:
        """Interfaces, and what columns and tents beside the gates can hold, with the gates where they stand."""
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
        """Volume of water in the tent of each cell when all pores are full, by the very sum that gives the fill.

        Summed over the particles of a flooded tank and not integrated: so the fill of water at rest is 1 to round-off
        across interfaces of any slope, where a sum over particles differs from the integral by 1e-3.
        """
        self.inverse_capacity[...] = self._inverse_capacity(Box((0.0,) * self.grid.dimension, self.grid.size))

    def _inverse_capacity(self, box: Box, gates: FloatArray | None = None) -> FloatArray:
        """1 / what the tents hold of the water in a box between gates, None: there are none [1/m^d]."""
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
        """One of the kinds of the medium as the core takes it; None in clear water, where it is one."""
        return self.medium.listed(name) if self.porous else None

    # ---- arrays per particle -------------------------------------------------------------------------------------

    def _declare_columns(self) -> None:
        """What the flow keeps at each particle of the medium where it is."""
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
        """At the particles (N,)."""
        return self.particles.volume / self.bulk if self.porous else np.broadcast_to(1.0, len(self.particles))

    @property
    def cloud(self) -> tuple[Core, str, FloatArray, FloatArray | None, FloatArray, NDArray[np.int32]]:
        """The particles as the core takes them in a transfer."""
        return self.grid.core, self.kernel, self.particles.position, self.side, self.bulk, self.start

    def interpolate(self, faces: Faces, out: FloatArray) -> None:
        """Sets out (N, d) to a field on the faces where the particles are, as they see velocities."""
        _core.to_particles(*self.cloud, faces, [], [], 0.0, out, self.interfaces)

    def drop_work(self) -> None:
        """Gives the memory of the work space back, of a large flow only: to get it again takes time."""
        if len(self.particles) > LARGE:
            self.work = Workspace(self.grid, len(self.particles))
            _core.return_memory()

    def sample_medium(self) -> None:
        """Reads the columns of the place: bulk volume, inertia and side at the present positions."""
        p, core = self.particles, self.grid.core
        if self.porous:
            pores = self.medium.listed("particle_porosity")
            particles = (p.position, p.volume, self.bulk, p["inertia"])
            _core.sample_medium(core, *self.crossing, pores, *particles, self.interfaces)
        self._find_sides()

    def carry(self, dt: float, ago: FloatArray | None) -> None:
        """The same after a motion of dt [s]; and particles that nothing holds keep the energy that they had.

        ago: (N,) K/C_r where they were; None where it is 1 everywhere.
        """
        p, m = self.particles, self.medium
        medium = (*self.crossing, self.held, m.listed("particle_porosity"), m.listed("coefficient"))
        state = (p.position, p.volume, self.bulk, p["inertia"], p.velocity)
        _core.carry(self.grid.core, *medium, dt, *state, self.lag, ago, self.interfaces)
        self._find_sides()

    def _find_sides(self) -> None:
        if self.side is not None:
            self.side[...] = self.bulk ** (1.0 / self.grid.dimension)

    def snapshot(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Copies of position, velocity and porosity of the particles."""
        return self.particles.position.copy(), self.particles.velocity.copy(), np.array(self.porosity)

    # ---- derived -------------------------------------------------------------------------------------------------

    def kinetic_energy(self) -> float:
        return _core.kinetic_energy(self.bulk, self.inertia, self.particles.velocity)

    def grid_kinetic_energy(self) -> float:
        m = self.medium
        return _core.face_kinetic_energy(self.grid.core, self.work.face_mass, m.material, m.materials, self.velocity)

    def potential_energy(self) -> float:
        d = self.grid.dimension
        return -sum(
            g * _core.weighted_sum(self.particles.volume, self.particles.position, a)
            for a, g in enumerate(self.gravity[:d])
            if g != 0.0 and not self.grid.periodic[a]
        )

    def passing(self, axis: int) -> FloatArray:
        """Darcy velocity on the faces of an axis, the mean of both media where two share one [m/s]."""
        u = self.velocity[axis]
        if self.medium.shared and len(self.medium.shared[axis].face):
            faces, u = self.medium.shared[axis], u.copy()
            u.ravel()[faces.face] = faces.mean(u)
        return u

    def pore_velocity(self) -> FloatArray:
        """u_d / n of the particles (N, d) [m/s]."""
        return self.particles.velocity / self.porosity[:, None]

    def courant(self, dt: float) -> float:
        """Cells that the fastest particle goes in dt [s]."""
        return self.crossed(self.max_pore_speed()) * dt

    def crossed(self, speed: list[float]) -> float:
        """Cells crossed in a second at this speed along each axis [m/s]."""
        return max(v / h for v, h in zip(speed, self.grid.spacing, strict=True))

    def max_pore_speed(self) -> list[float]:
        """Largest |u_d| / n of the particles along each axis [m/s]; NaN where one is."""
        p = self.particles
        return _core.max_speed(p.velocity, p.volume, self.bulk)
