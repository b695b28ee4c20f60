"""Grids, particles and face fields for the tests: small, random, and with what is awkward in them."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from houle import _core
from houle.flow.particles import Particles
from houle.flow.state import Flow
from houle.grid import Faces, FloatArray, Grid
from houle.medium.medium import Medium


@st.composite
def grids(draw: st.DrawFn, least: int = 1, most: int = 9) -> Grid:
    """2D or 3D, walls or periodic sides, cells that are not cubes."""
    d = draw(st.sampled_from([2, 3]))
    shape = tuple(draw(st.integers(least, most if d == 2 else max(least, most // 2))) for _ in range(d))
    spacing = tuple(draw(st.sampled_from([0.5, 0.8, 1.0, 1.7])) for _ in range(d))
    periodic = tuple(draw(st.booleans()) for _ in range(d))
    return Grid(shape, spacing, periodic)


def numbered(field: FloatArray | None) -> tuple[np.ndarray, FloatArray] | None:
    """A cell field as the core takes properties with few different values (Medium.listed): here all differ."""
    return None if field is None else (np.arange(field.size, dtype=np.int32), field.ravel())


def lattice(grid: Grid, per_cell: int = 2) -> FloatArray:
    """Positions (M, d) [m] of per_cell^d particles in every cell, evenly spaced, cell by cell."""
    offset = (np.arange(per_cell) + 0.5) / per_cell
    lines = [((np.arange(n)[:, None] + offset) * h).ravel() for n, h in zip(grid.shape, grid.spacing, strict=True)]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, grid.dimension)


randoms = st.integers(0, 2**32 - 1).map(np.random.default_rng)


def scattered(grid: Grid, random: np.random.Generator, count: int) -> FloatArray:
    """Positions (count, d): most anywhere, some on faces, on centres, and next to the walls; sorted by cell."""
    x = random.random((count, grid.dimension)) * grid.shape
    x[: count // 5] = np.floor(2 * x[: count // 5]) / 2
    near = x[count // 5 : count // 3]
    near[...] = np.where(random.random(near.shape) < 0.5, 1e-9, np.array(grid.shape) - 1e-9)
    return in_order(grid, x * grid.spacing)[0]


def in_order(grid: Grid, position: FloatArray) -> tuple[FloatArray, np.ndarray]:
    """The positions sorted by cell, and the start of each cell."""
    cell, order = np.zeros(len(position), np.int32), np.zeros(len(position), np.int32)
    start = np.zeros(int(np.prod(grid.shape)) + 1, np.int32)
    _core.cell_sort(grid.core, position, cell, order, start)
    return np.ascontiguousarray(position[order]), start


def start_of(grid: Grid, position: FloatArray) -> np.ndarray:
    return in_order(grid, position)[1]


def random_faces(grid: Grid, random: np.random.Generator, low: float = -1.0, high: float = 1.0) -> Faces:
    """A face field; on a periodic axis the last face is the first."""
    fields = [random.uniform(low, high, grid.face_shape(a)) for a in range(grid.dimension)]
    for a, f in enumerate(fields):
        if grid.periodic[a]:
            f = np.moveaxis(f, a, 0)
            f[-1] = f[0]
    return fields


def linear_faces(grid: Grid, constant: FloatArray, gradient: FloatArray) -> Faces:
    """u_a(x) = constant_a + sum_b gradient_ab x_b on the faces."""
    return [constant[a] + grid.points(a) @ gradient[a] for a in range(grid.dimension)]


def each_once(grid: Grid, axis: int, field: FloatArray) -> FloatArray:
    """A face field without the copy of its first face at the end of a periodic axis."""
    return np.delete(field, -1, axis=axis) if grid.periodic[axis] else field


def porosity_at(grid: Grid, medium: Medium, particles: Particles) -> FloatArray | None:
    """Porosity of the medium at the particles (N,), as remeshing takes it; None in clear water."""
    if not medium.bodies:
        return None
    flow = Flow(grid, medium, particles, gravity=(0.0,) * grid.dimension)
    flow.sample_medium()
    return np.array(flow.porosity)
