"""Arrays that a time step needs only while it lasts.

Each is made when it is first asked for. The next step needs nothing of their contents. Remeshing, which needs memory of
its own, drops them all where the flow is large, and the next step makes them anew.
"""

from __future__ import annotations

import math
from functools import cached_property
from itertools import accumulate

import numpy as np

from houle import _core
from houle.grid import Faces, FloatArray, Grid


class Workspace:
    """The work space of a flow with this number of particles on a grid."""

    def __init__(self, grid: Grid, particles: int) -> None:
        self.grid, self.particles = grid, particles

    def resize(self, particles: int) -> None:
        """Fits the arrays to another number of particles; those on the grid alone stay."""
        if particles == self.particles:
            return
        self.particles = particles
        large_enough = "store" in self.__dict__ and len(self.store) >= self._stored_numbers
        for name in ("order", "spare", *(() if large_enough else ("store", "_system"))):
            self.__dict__.pop(name, None)

    @property
    def _stored_numbers(self) -> int:
        grid = self.grid
        on_grid = 2 * math.prod(grid.shape) + sum(math.prod(grid.face_shape(a)) for a in range(grid.dimension))
        return max(on_grid, self.particles * grid.dimension + (self.particles + 1) // 2)

    @cached_property
    def store(self) -> FloatArray:
        """Memory that sorting, the transfer and the pressure system use one after the other."""
        return np.zeros(self._stored_numbers)

    def _stored(self, *shapes: tuple[int, ...]) -> list[FloatArray]:
        """Arrays of these shapes, one after the other in the store."""
        ends = accumulate(map(math.prod, shapes))
        return [
            self.store[end - math.prod(shape) : end].reshape(shape) for end, shape in zip(ends, shapes, strict=True)
        ]

    @cached_property
    def spare(self) -> FloatArray:
        """Space (N, d) for the rows of an array that is sorted. Sorting overwrites the pressure system in the store."""
        return self._stored((self.particles, self.grid.dimension))[0]

    @cached_property
    def order(self) -> np.ndarray:
        """Order (N,) in which the particles are sorted, in the store behind the spare rows."""
        n = self.particles
        return self._stored((n, self.grid.dimension), ((n + 1) // 2,))[1].view(np.int32)[:n]

    @cached_property
    def _system(self) -> list[FloatArray]:
        faces = [self.grid.face_shape(a) for a in range(self.grid.dimension)]
        return self._stored(*faces, self.grid.shape, self.grid.shape)

    @property
    def coefficient(self) -> Faces:
        """Coefficients of a pressure system between cells, on faces, (17) in docs/theory.md."""
        return self._system[:-2]

    @property
    def dirichlet(self) -> FloatArray:
        """Coefficients of a pressure system towards the surface, p = 0, in the cells beside air."""
        return self._system[-2]

    @property
    def rhs(self) -> FloatArray:
        """Right-hand side of a pressure system in the cells, [1/s] for the pressure and [-] for the correction."""
        return self._system[-1]

    def set_up(self, active: np.ndarray) -> tuple[Faces, FloatArray]:
        """Hands the coefficients of a pressure system to the solver, which copies them.

        Returns the arrays that held them, one per axis on faces and one on cells, which are then free for other use.
        """
        self.solver.setup(active, self.coefficient, self.dirichlet)
        return self.coefficient, self.dirichlet

    @cached_property
    def face_mass(self) -> Faces:
        """Mass of the transfer (10) on each face: bulk volume of the particles around, by kernel weight [m^d]."""
        return self.grid.faces()

    @cached_property
    def mobility(self) -> Faces:
        """Arrays of `Flow.mobility` [s]."""
        return self.grid.faces()

    @cached_property
    def valid(self) -> list[np.ndarray]:
        """Layer of each face (uint8): 1 where the pressure or a wall gives its velocity, then 2, 3, ...; 0: unknown."""
        return [np.zeros(self.grid.face_shape(a), np.uint8) for a in range(self.grid.dimension)]

    @cached_property
    def solver(self) -> _core.PressureSolver2 | _core.PressureSolver3:
        """The solver of the pressure system and of that of the position correction."""
        core = self.grid.core
        return _core.PressureSolver2(core) if isinstance(core, _core.Grid2) else _core.PressureSolver3(core)

    @cached_property
    def mass_matrix(self) -> _core.MassMatrix2 | _core.MassMatrix3:
        """The matrix of the transfer "fmpm" with the linear kernel."""
        core = self.grid.core
        return _core.MassMatrix2(core) if isinstance(core, _core.Grid2) else _core.MassMatrix3(core)
