"""Particles to grid and back: the core against its NumPy twin, and what each transfer promises."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference_transfer as reference
from clouds import each_once, grids, in_order, lattice, linear_faces, random_faces, randoms, scattered, start_of
from houle import _core
from houle.grid import Grid

KERNELS = list(reference.KERNELS)
POSITIVE = [k for k in KERNELS if k != "m4prime"]


class Cloud:
    """Random particles on a grid, and the transfers of the core on them, returning new arrays."""

    def __init__(self, grid, kernel, random, count=25, position=None):
        self.grid, self.kernel = grid, kernel
        self.x = scattered(grid, random, count) if position is None else position
        n = len(self.x)
        self.mass = random.uniform(0.5, 2.0, n)
        self.side = random.uniform(0.3, 0.8, n) * min(grid.spacing)
        self.u = random.normal(size=self.x.shape)
        self.affine = random.normal(size=(n, grid.dimension, grid.dimension))
        self.start = start_of(grid, self.x)
        self.twin = (grid, kernel, self.x, self.side)
        self.core = (grid.core, kernel, self.x, self.side, self.mass, self.start)

    def to_faces(self, affine=None, u=None):
        velocity, mass = self.grid.faces(7.0), self.grid.faces(7.0)  # overwritten
        _core.to_faces(*self.core, self.u if u is None else u, affine, velocity, mass)
        return velocity, mass

    def fmpm(self, order, u=None):
        u = self.u if u is None else u
        velocity, mass = self.to_faces(u=u)
        work = self.grid.faces()
        for _ in range(order - 1):
            _core.add_residual(*self.core, u, mass, velocity, work)
        return velocity, mass

    def by_mass_matrix(self, order, lent, where=None, more=0):
        velocity, mass, work = (self.grid.faces(7.0) for _ in range(3))  # overwritten
        matrix = (_core.MassMatrix2 if self.grid.dimension == 2 else _core.MassMatrix3)(self.grid.core)
        for count in (len(self.x) // 2, len(self.x)):  # what the first transfer left is forgotten
            start = np.minimum(self.start, count)
            spaces = velocity, mass, work, np.full(lent, 7.0)
            rest = (None, where, more)
            matrix.transfer(self.x[:count], self.mass[:count], start, self.u[:count], order, *spaces, *rest)
        return velocity, mass

    def to_particles(self, velocity, change=(), drag=(), flip=0.0):
        u = self.u.copy()
        _core.to_particles(*self.core, velocity, list(change), list(drag), flip, u)
        return u

    def affine_from(self, velocity):
        affine = np.empty_like(self.affine)
        _core.affine_from(*self.core, velocity, affine)
        return affine

    def kinetic(self, u):
        return 0.5 * self.mass @ (u**2).sum(axis=1)


def same(faces, expected, where=None):
    """Equal to round-off, or where the masks say so to what division by small masses leaves of it."""
    for a, (found, twin) in enumerate(zip(faces, expected, strict=True)):
        mask = where[a] if where else ...
        np.testing.assert_allclose(found[mask], twin[mask], rtol=0, atol=1e-9 if where else 1e-12)


# ---- against the twin ------------------------------------------------------------------------------------------------


@settings(max_examples=40)
@given(grids(), randoms, st.sampled_from(KERNELS))
def test_transfers_against_the_twin(grid, random, kernel):
    cloud = Cloud(grid, kernel, random)
    velocity, mass = cloud.to_faces()
    same(mass, reference.to_faces(*cloud.twin, cloud.mass, cloud.u)[1])
    heavy = [m > 1e-3 for m in mass]  # M4' may leave a face next to no mass, and divides by it
    same(velocity, reference.to_faces(*cloud.twin, cloud.mass, cloud.u)[0], heavy)

    now, change, drag = (random_faces(grid, random) for _ in range(3))
    for flip in (0.0, 0.3, 1.0):
        expected = reference.to_particles(*cloud.twin, now, change, drag, flip, cloud.u)
        np.testing.assert_allclose(cloud.to_particles(now, change, drag, flip), expected, rtol=0, atol=1e-12)

    expected = reference.add_residual(*cloud.twin, cloud.mass, cloud.u, mass, now)
    _core.add_residual(*cloud.core, cloud.u, mass, now, grid.faces())
    same(now, expected, heavy)


@settings(max_examples=100)
@given(grids(least=1), randoms, st.integers(1, 5), st.sampled_from([2, 40]), st.sampled_from([0, 100, 100_000]))
def test_the_mass_matrix_gives_what_passes_over_the_particles_give(grid, random, order, count, lent):
    """FMPM(k), with walls and periodic sides, down to a single cell between them; in memory of its own or lent."""
    cloud = Cloud(grid, "linear", random, count)
    velocity, mass = cloud.fmpm(order)
    found, found_mass = cloud.by_mass_matrix(order, lent)
    same(found_mass, mass)
    same(found, velocity, [(m == 0.0) | (m > 1e-3) for m in mass])


@settings(max_examples=40)
@given(grids(), randoms, st.integers(1, 4), st.integers(0, 5))
def test_more_terms_where_they_are_asked_for(grid, random, order, more):
    """On all faces they are terms like the others, on none they are none; on some, each is a step of Jacobi's there."""
    cloud = Cloud(grid, "linear", random)

    def marks(value):
        return [np.full(m.shape, value, np.uint8) for m in grid.faces()]

    few = cloud.by_mass_matrix(order, 0)[0]
    for value, terms in ((1, order + more), (0, order)):
        for found, known in zip(
            cloud.by_mass_matrix(order, 0, marks(value), more)[0], cloud.by_mass_matrix(terms, 0)[0], strict=True
        ):
            assert np.array_equal(found, known)
    some = [np.asarray(random.random(m.shape) < 0.5, np.uint8) for m in grid.faces()]
    one, two = cloud.by_mass_matrix(order, 0, some, 1)[0], cloud.by_mass_matrix(order + 1, 0)[0]
    for axis, (where, found, before, after) in enumerate(zip(some, one, few, two, strict=True)):
        if grid.periodic[axis]:  # the last face is the first again
            np.moveaxis(where, axis, 0)[-1] = np.moveaxis(where, axis, 0)[0]
        assert np.allclose(found, np.where(where, after, before), rtol=1e-12, atol=1e-12)


@settings(max_examples=40)
@given(grids(), randoms, st.sampled_from(KERNELS))
def test_apic_against_the_twin(grid, random, kernel):
    """Behind walls and beyond periodic sides a node stands where it stands, not where it was folded to."""
    cloud = Cloud(grid, kernel, random)
    velocity, mass = cloud.to_faces(affine=cloud.affine)
    expected = reference.to_faces(*cloud.twin, cloud.mass, cloud.u, cloud.affine)[0]
    heavy = [m > 1e-3 for m in mass]
    same(velocity, expected, heavy)
    field = random_faces(grid, random)
    expected = reference.affine_from(*cloud.twin, field)
    np.testing.assert_allclose(cloud.affine_from(field), expected, rtol=1e-5, atol=1e-5)  # 0/0 for one on a node


@settings(max_examples=40)
@given(grids(), randoms)
def test_cells_against_the_twin(grid, random):
    x = scattered(grid, random, 50)
    amount, field = random.random(50), random.random(grid.shape)
    out, at = grid.cells(), np.empty(50)
    _core.scatter_cells(grid.core, start_of(grid, x), x, amount, out)
    np.testing.assert_allclose(out, reference.scatter_cells(grid, x, amount), rtol=0, atol=1e-13)
    assert out.sum() == pytest.approx(amount.sum(), rel=1e-14)
    _core.gather_cells(grid.core, x, field, at)
    np.testing.assert_allclose(at, reference.gather_cells(grid, x, field), rtol=0, atol=1e-13)


@settings(max_examples=40)
@given(grids(), randoms, st.integers(0, 200))
def test_particles_are_sorted_by_cell_and_stay_in_order_within(grid, random, count):
    x = random.uniform(-0.2, 1.2, (count, grid.dimension)) * grid.size  # those outside count for the nearest cell
    (cell, order), start = np.zeros((2, count), np.int32), np.zeros(np.prod(grid.shape) + 1, np.int32)
    _core.cell_sort(grid.core, x, cell, order, start)
    index = np.clip(np.floor(x / grid.spacing).astype(int), 0, np.array(grid.shape) - 1)
    number = np.ravel_multi_index(tuple(index.T), grid.shape)
    assert np.array_equal(order, np.argsort(number, kind="stable"))
    assert np.array_equal(start, np.searchsorted(number[order], np.arange(len(start))))


@given(randoms, st.sampled_from([1, 2, 5]), st.booleans())
@settings(max_examples=10)
def test_every_number_of_threads_sorts_alike(random, threads, nearly):
    grid = Grid((40, 30), (1.0, 1.0), (False, False))
    x = random.uniform(0.0, 1.0, (20_000, 2)) * grid.size
    if nearly:
        x = in_order(grid, x)[0] + random.normal(0.0, 0.3, x.shape)
    (cell, order), start = np.zeros((2, len(x)), np.int32), np.full(1201, 7, np.int32)
    _core.set_threads(threads)
    _core.cell_sort(grid.core, x, cell, order, start)
    index = np.clip(np.floor(x).astype(int), 0, (39, 29))
    number = index[:, 0] * 30 + index[:, 1]
    assert np.array_equal(order, np.argsort(number, kind="stable"))
    assert np.array_equal(start, np.searchsorted(number[order], np.arange(len(start))))


@given(grids(), randoms, st.integers(0, 50))
def test_all_of_the_particles_is_brought_into_the_order_of_their_cells(grid, random, count):
    x, u = random.uniform(0.0, 1.0, (count, grid.dimension)) * grid.size, random.normal(size=(count, grid.dimension))
    volume, sorted_x = random.random(count), in_order(grid, x)[0]
    order, start = np.zeros(count, np.int32), np.zeros(np.prod(grid.shape) + 1, np.int32)
    rows = [x.copy(), u.copy(), volume.copy()]
    _core.sort_particles(grid.core, *rows, np.empty_like(x), order, start)
    assert np.array_equal(rows[0], sorted_x)
    for now, before in zip(rows, (x, u, volume), strict=True):
        assert np.array_equal(now, before[order])


# ---- what is conserved -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [1, 2, 5])
@settings(max_examples=25)
@given(grids(), randoms, st.sampled_from(POSITIVE))
def test_momentum_is_conserved_where_no_wall_mirrors_it(order, grid, random, kernel):
    """sum_f m_f u_f = sum_p m_p u_p, along the walls and between them, for every number of terms of FMPM.

    The component normal to a wall is conserved as well by what never reaches behind it.
    """
    cloud = Cloud(grid, kernel, random)
    velocity, mass = cloud.fmpm(order)
    reach = {"linear": 0, "quadratic": 0.5}.get(kernel, 3)
    for a in range(grid.dimension):
        away = np.minimum(cloud.x[:, a], grid.size[a] - cloud.x[:, a]) / grid.spacing[a]
        total = each_once(grid, a, mass[a]).sum()
        assert total == pytest.approx(cloud.mass.sum(), rel=1e-13)
        if grid.periodic[a] or away.min() >= reach:
            carried = each_once(grid, a, mass[a] * velocity[a]).sum()
            assert carried == pytest.approx(cloud.mass @ cloud.u[:, a], abs=1e-10 * np.abs(cloud.mass).sum())


@pytest.mark.parametrize("kernel", POSITIVE)
def test_momentum_along_a_wall_is_conserved_and_normal_to_it_mirrored(kernel):
    """Particles beside the floor: their tangential momentum arrives whole; the wall face of their normal one is 0."""
    grid = Grid((16, 12), (1.0, 1.0), (False, False))
    x = np.stack([np.linspace(6, 10, 9), np.full(9, 0.2)], axis=1)
    cloud = Cloud(grid, kernel, np.random.default_rng(1), position=x)
    velocity, mass = cloud.to_faces()
    assert np.sum(mass[0] * velocity[0]) == pytest.approx(cloud.mass @ cloud.u[:, 0], abs=1e-12)
    if kernel == "linear":  # stays in front of the wall, and so gives the wall face what is near it
        assert np.sum(mass[1] * velocity[1]) == pytest.approx(cloud.mass @ cloud.u[:, 1], abs=1e-13)
    elif kernel == "quadratic":  # what falls behind the wall comes back with the other sign
        behind = reference.quadratic(1.2, 0)[0]
        assert np.sum(mass[1] * velocity[1]) == pytest.approx((1 - 2 * behind) * cloud.mass @ cloud.u[:, 1], abs=1e-13)


@settings(max_examples=60)
@given(grids(), randoms, st.sampled_from(POSITIVE), st.integers(1, 6))
def test_fmpm_never_adds_kinetic_energy(grid, random, kernel, order):
    """Grid and back is a contraction in the norm of kinetic energy for weights >= 0, and less of one with each term."""
    cloud = Cloud(grid, kernel, random)
    energy = [cloud.kinetic(cloud.to_particles(cloud.fmpm(k)[0])) for k in (order, order + 1)]
    assert energy[0] <= energy[1] * (1 + 1e-12) <= cloud.kinetic(cloud.u) * (1 + 2e-12)


def test_fmpm_converges_to_the_conservative_l2_projection():
    """Its limit solves the full mass matrix: the face velocities whose interpolation is nearest to the particles'."""
    grid = Grid((6, 6), (1.0, 1.0), (True, True))
    cloud = Cloud(grid, "linear", np.random.default_rng(3), position=lattice(grid, 3))
    velocity, _ = cloud.fmpm(2000)
    for a in range(2):
        _, signed, _ = reference.matrices(*cloud.twin[:2], a, cloud.x)
        nearest = np.linalg.lstsq(
            np.sqrt(cloud.mass)[:, None] * signed, np.sqrt(cloud.mass) * cloud.u[:, a], rcond=None
        )[0]
        interpolated = signed @ velocity[a].ravel()
        np.testing.assert_allclose(interpolated, signed @ nearest, atol=1e-6)


# ---- what is reproduced ----------------------------------------------------------------------------------------------


def flooded(kernel, random, d=2):
    """A box of walls full of slightly disordered particles, and which of them are 4 cells away from any wall."""
    grid = Grid((12, 12, 9)[:d], (1.0, 0.8, 1.2)[:d], (False,) * d)
    x = lattice(grid)
    cloud = Cloud(grid, kernel, random, position=in_order(grid, x + random.uniform(-0.1, 0.1, x.shape))[0])
    away = np.minimum(cloud.x, np.array(grid.size) - cloud.x) / grid.spacing
    return cloud, away.min(axis=1) > 4.0


@pytest.mark.parametrize("axis", [(2, 0), (2, 1), (3, 0), (3, 1), (3, 2)])
@pytest.mark.parametrize("kernel", ["linear", "quadratic", "m4prime"])
@pytest.mark.parametrize("order", [1, 2, 4])
def test_linear_fields_pass_through_fmpm(axis, kernel, order):
    """From the lattice PIC already keeps a velocity linear along an axis; so FMPM of any order does."""
    random = np.random.default_rng(5)
    d, along = axis
    margin = 1 + order * {"linear": 1, "quadratic": 2, "m4prime": 2}[kernel]  # the walls are heard one reach per term
    sides = tuple(a != along for a in range(d))
    grid = Grid(tuple(2 if side else 2 * margin + 3 for side in sides), (1.0, 0.8, 1.2)[:d], sides)
    cloud = Cloud(grid, kernel, random, position=in_order(grid, lattice(grid))[0])
    cloud.mass[:] = 1.0
    constant, gradient = random.normal(size=d), np.zeros((d, d))
    gradient[:, along] = random.normal(size=d)
    velocity, _ = cloud.fmpm(order, constant + cloud.x @ gradient.T)
    for a, expected in enumerate(linear_faces(grid, constant, gradient)):
        inner = tuple(slice(margin, -margin) if b == along else slice(None) for b in range(d))
        np.testing.assert_allclose(velocity[a][inner], expected[inner], atol=1e-12)


@pytest.mark.parametrize("kernel", ["linear", "quadratic"])
def test_more_terms_bring_disordered_particles_nearer_to_a_linear_field(kernel):
    """A linear field is in the space the faces span: its distance to what comes back shrinks with every term."""
    random = np.random.default_rng(6)
    cloud, inside = flooded(kernel, random)
    u = random.normal(size=2) + cloud.x @ random.normal(size=(2, 2)).T
    errors = [np.abs(cloud.to_particles(cloud.fmpm(k, u)[0]) - u)[inside].max() for k in (1, 4, 16)]
    assert errors[0] > 2 * errors[1] > 4 * errors[2]


@settings(max_examples=40)
@given(grids(), randoms, st.sampled_from(KERNELS))
def test_flip_keeps_the_particles_when_nothing_changes(grid, random, kernel):
    cloud = Cloud(grid, kernel, random)
    velocity, _ = cloud.to_faces()
    same = cloud.to_particles(velocity, grid.faces(0.0), grid.faces(1.0), 1.0)
    np.testing.assert_allclose(same, cloud.u, rtol=1e-14)
    blend = cloud.to_particles(velocity, grid.faces(0.0), grid.faces(1.0), 0.75)
    np.testing.assert_allclose(blend, 0.75 * cloud.u + 0.25 * cloud.to_particles(velocity), atol=1e-13)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("kernel", ["linear", "quadratic"])
def test_apic_keeps_a_linear_field(d, kernel):
    """Velocity gradients included, whatever the disorder of the particles: onto the faces, and back."""
    random = np.random.default_rng(7)
    cloud, inside = flooded(kernel, random, d)
    constant, gradient = random.normal(size=d), random.normal(size=(d, d))
    u = constant + cloud.x @ gradient.T
    velocity, _ = cloud.to_faces(np.broadcast_to(gradient, cloud.affine.shape).copy(), u)
    for a, expected in enumerate(linear_faces(cloud.grid, constant, gradient)):
        inner = tuple(slice(2, n - 2) for n in cloud.grid.face_shape(a))
        np.testing.assert_allclose(velocity[a][inner], expected[inner], atol=1e-12)
    np.testing.assert_allclose(cloud.to_particles(velocity)[inside], u[inside], atol=1e-12)
    error = np.abs(cloud.affine_from(velocity) - gradient)[inside].max()
    assert error < 1e-9


@pytest.mark.parametrize("kernel", ["linear", "quadratic"])
@pytest.mark.parametrize("periodic", [False, True])
def test_apic_sees_no_gradient_in_uniform_flow(kernel, periodic):
    """Along slip walls and round periodic sides as well."""
    grid = Grid((6, 5), (1.0, 0.7), (periodic, periodic))
    cloud = Cloud(grid, kernel, np.random.default_rng(2), count=200)
    flow = [np.ones(grid.face_shape(0)), np.zeros(grid.face_shape(1))]
    middle = np.abs(cloud.x[:, 0] / grid.size[0] - 0.5) < 0.3  # at the ends a slip wall turns u_x round
    keep = middle | periodic
    assert np.abs(cloud.affine_from(flow)[keep]).max() < 1e-9


@pytest.mark.parametrize("kernel", ["linear", "quadratic"])
def test_apic_conserves_angular_momentum(kernel):
    """sum_p m_p (x_b u_a + C_ab D_bb), D = sum_f w r_b^2, is what the faces hold: there and back (Jiang 2015)."""
    grid = Grid((12, 11), (1.0, 0.8), (False, False))
    random = np.random.default_rng(8)
    x = np.array([4.0, 4.0]) + random.random((60, 2)) * [4.0, 1.0]
    cloud = Cloud(grid, kernel, random, position=in_order(grid, x)[0])

    def of_particles(u, affine):
        total = 0.0
        for a, b, sign in ((0, 1, -1.0), (1, 0, 1.0)):
            second = reference.matrices(*cloud.twin[:2], a, cloud.x)[2][b, 1].sum(axis=1)
            total += sign * cloud.mass @ (cloud.x[:, b] * u[:, a] + affine[:, a, b] * second)
        return total

    velocity, mass = cloud.to_faces(cloud.affine)
    on_grid = sum(
        sign * np.sum(mass[a] * velocity[a] * grid.points(a)[..., b]) for a, b, sign in ((0, 1, -1.0), (1, 0, 1.0))
    )
    assert on_grid == pytest.approx(of_particles(cloud.u, cloud.affine), rel=1e-12)
    back = of_particles(cloud.to_particles(velocity), cloud.affine_from(velocity))
    assert back == pytest.approx(on_grid, rel=1e-12)


def test_wrong_sizes_are_refused():
    grid = Grid((4, 5), (1.0, 1.0), (False, False))
    cloud = Cloud(grid, "linear", np.random.default_rng(0))
    with pytest.raises(ValueError, match="velocity does not fit the faces of axis 1"):
        _core.to_faces(*cloud.core, cloud.u, None, [grid.faces()[0], np.zeros((4, 5))], grid.faces())
    with pytest.raises(ValueError, match="start has"):
        _core.scatter_cells(grid.core, cloud.start[:-1].copy(), cloud.x, cloud.mass, grid.cells())
