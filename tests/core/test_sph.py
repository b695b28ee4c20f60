"""Sums over neighbours: kernels, partition of unity up to the walls, exact fields, conservation, time-step limit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import reference_sph as reference
from clouds import lattice
from houle import _core
from houle.flow.viscosity import KERNEL_STIFFNESS, Smoothing
from houle.grid import Grid

KERNELS = sorted(KERNEL_STIFFNESS)


def sort_by_cell(grid, x):
    cell = np.minimum((x / np.array(grid.spacing)).astype(int), np.array(grid.shape) - 1)
    flat = np.ravel_multi_index(cell.T, grid.shape)
    count = np.bincount(flat, minlength=np.prod(grid.shape))
    return np.ascontiguousarray(x[np.argsort(flat, kind="stable")]), np.concatenate([[0], np.cumsum(count)])


def tank(dimension, n=8, shake=0.0, periodic=False, seed=0):
    """A full unit tank: grid, sorted positions, cell_start, bulk volumes."""
    grid = Grid((n,) * dimension, (1 / n,) * dimension, (periodic,) * dimension)
    x = lattice(grid) + np.random.default_rng(seed).normal(0, 1, (2 * n,) * dimension + (dimension,)).reshape(
        -1, dimension
    ) * (shake / n / 2)
    x, start = sort_by_cell(grid, np.clip(x, 1e-9, 1 - 1e-9))
    return grid, x, start, np.full(len(x), 1 / len(x))


def interior(x, margin):
    return np.all((x > margin) & (x < 1 - margin), axis=1)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("dimension", [2, 3])
def test_kernel_integrals(dimension, kernel):
    """Integral 1, and the stiffness that the time-step limit uses; the kernel is sampled with two particles."""
    grid = Grid((4,) * dimension, (1.0,) * dimension, (False,) * dimension)
    smooth = Smoothing(grid, ("free",) * (2 * dimension), 1.9, kernel)
    middle = np.full(dimension, 2.0)

    def value(r):
        x, start = sort_by_cell(grid, np.array([middle, middle + np.eye(dimension)[0] * r]))
        first = int(np.argmin(np.abs(x - middle).sum(1)))
        bulk = np.where(np.arange(2) == first, 0.0, 1.0)
        return smooth.density_sum(x, start, bulk)[first]

    shell = 2 * np.pi if dimension == 2 else 4 * np.pi
    integral = quad(lambda r: shell * r ** (dimension - 1) * value(r), 1e-12, 1.9, epsabs=1e-11)[0]
    assert integral == pytest.approx(1, abs=1e-9)

    def slope(r):  # -W'/r by differences
        step = 1e-5
        return (value(r - step) - value(r + step)) / (2 * step * r)

    stiffness = quad(lambda r: shell * r ** (dimension - 1) * slope(r), 1e-4, 1.9 - 1e-4, epsabs=1e-6, limit=200)[0]
    assert stiffness * 1.9**2 == pytest.approx(KERNEL_STIFFNESS[kernel], rel=5e-3)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("walls", ["slip", "no-slip", "periodic"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_full_tank_is_full_up_to_the_walls(dimension, walls, kernel):
    grid, x, start, bulk = tank(dimension, 5, periodic=walls == "periodic")
    smooth = Smoothing(grid, ("slip" if walls == "periodic" else walls,) * (2 * dimension), 1.5 * 0.2, kernel)
    np.testing.assert_allclose(smooth.density_sum(x, start, bulk), 1, atol=6e-3)


def test_a_tank_narrower_than_the_kernel_is_full_too():
    grid = Grid((1, 2), (0.2, 0.2), (False, True))
    x, start = sort_by_cell(grid, lattice(grid))
    smooth = Smoothing(grid, ("slip",) * 4, 0.9)
    np.testing.assert_allclose(smooth.density_sum(x, start, np.full(len(x), 0.01)), 1, atol=1e-3)


def test_half_at_a_flat_free_surface():
    """The kernel of a particle half a spacing below the surface reaches that much into the water above the half."""
    grid, x, start, bulk = tank(2, 10)
    fill = Smoothing(grid, ("slip", "slip", "slip", "free"), 0.15).density_sum(x, start, bulk)
    np.testing.assert_allclose(fill[x[:, 1] < 0.85], 1, atol=6e-3)
    top = x[:, 1] > 0.95
    strip = quad(lambda z: quad(lambda y: _wendland_2d(np.hypot(y, z), 0.15), -0.15, 0.15)[0], 0, 0.025)[0]
    np.testing.assert_allclose(fill[top], 0.5 + strip, atol=0.03)  # the sum does not see where its cells end


def _wendland_2d(r, radius):
    return reference.wendland(r, radius, 2)[0]


@settings(max_examples=25, deadline=None)
@given(st.sampled_from([2, 3]), st.booleans(), st.sampled_from(["slip", "no-slip", "free"]), st.integers(0, 99))
def test_agrees_with_the_numpy_twin(dimension, periodic, wall, seed):
    grid, x, start, bulk = tank(dimension, 5 if dimension == 2 else 3, 0.4, periodic, seed)
    random = np.random.default_rng(seed)
    u, bulk, nu = random.normal(size=x.shape), bulk * random.uniform(0.5, 2, len(x)), random.uniform(0, 1, len(x))
    walls, radius = (wall,) * (2 * dimension), 0.4
    smooth = Smoothing(grid, walls, radius)
    np.testing.assert_allclose(
        smooth.density_sum(x, start, bulk), reference.density_sum(grid, walls, radius, x, bulk), rtol=1e-11
    )
    np.testing.assert_allclose(
        smooth.viscous_acceleration(x, start, u, bulk, nu),
        reference.viscous_acceleration(grid, walls, radius, x, u, bulk, nu),
        rtol=1e-9,
        atol=1e-8,
    )
    if not periodic:
        np.testing.assert_allclose(
            smooth.velocity_gradient(x, start, u, bulk),
            reference.velocity_gradient(radius, x, u, bulk),
            rtol=1e-7,
            atol=1e-7,
        )


@pytest.mark.parametrize("dimension", [2, 3])
def test_gradient_is_exact_for_linear_fields_on_shaken_particles(dimension):
    grid, x, start, bulk = tank(dimension, 6, 0.5)
    A = np.random.default_rng(1).normal(size=(dimension, dimension))
    smooth = Smoothing(grid, ("slip",) * (2 * dimension), 0.3)
    gradient = smooth.velocity_gradient(x, start, x @ A.T + 3.0, bulk)
    np.testing.assert_allclose(gradient, np.broadcast_to(A, gradient.shape), atol=1e-11)
    nu = smooth.eddy_viscosity(x, start, x @ A.T, bulk, 0.2)
    strain = (A + A.T) / 2
    np.testing.assert_allclose(nu, (0.2 / 6) ** 2 * np.sqrt(2 * (strain**2).sum()), rtol=1e-10)


def test_no_gradient_without_neighbours_or_along_a_line():
    grid = Grid((10, 10), (1.0, 1.0), (False, False))
    x, start = sort_by_cell(grid, np.array([[1.5, 1.5], [7.0, 7.5], [7.5, 7.5], [8.5, 7.5]]))
    smooth = Smoothing(grid, ("slip",) * 4, 2.0)
    assert np.all(smooth.velocity_gradient(x, start, x.copy(), np.ones(4)) == 0)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("dimension", [2, 3])
def test_operator_is_laplacian_plus_twice_grad_div(dimension, kernel):
    """The paper's (3) on quadratic fields, in the interior of a lattice; the sums converge as the kernel holds more."""
    grid, x, start, bulk = tank(dimension, 12 if dimension == 2 else 8)
    wide, narrow = 3 / grid.shape[0], 2 / grid.shape[0]
    inside = interior(x, wide)
    with_div, shear = np.zeros_like(x), np.zeros_like(x)
    with_div[:, 0] = x[:, 0] ** 2  # lap = 2, grad div = 2
    shear[:, 0] = x[:, -1] ** 2  # lap = 2, div = 0
    for u, exact in ((with_div, 6.0), (shear, 2.0)):
        errors = []
        for radius in (narrow, wide):
            smooth = Smoothing(grid, ("slip",) * (2 * dimension), radius, kernel)
            a = smooth.viscous_acceleration(x, start, u, bulk, 1.0)[inside]
            np.testing.assert_allclose(a[:, 1:], 0, atol=1e-9)
            errors.append(np.abs(a[:, 0] / exact - 1).max())
        assert errors[1] < 0.015 and errors[1] < 0.6 * errors[0]


def test_variable_viscosity_gives_the_divergence_of_the_stress():
    """u = (z^2, 0), nu = 1 + z: div(2 nu S) = d/dz((1 + z) 2 z) = 2 + 4 z."""
    grid, x, start, bulk = tank(2, 16)
    u = np.stack([x[:, 1] ** 2, np.zeros(len(x))], 1)
    a = Smoothing(grid, ("slip",) * 4, 3 / 16).viscous_acceleration(x, start, u, bulk, 1 + x[:, 1])
    inside = interior(x, 3 / 16)
    np.testing.assert_allclose(a[inside, 0], 2 + 4 * x[inside, 1], rtol=0.015)


def test_momentum_and_angular_momentum_are_kept_and_energy_is_lost():
    grid, x, start, bulk = tank(2, 6, 0.4)
    random = np.random.default_rng(3)
    u, bulk = random.normal(size=x.shape), bulk * random.uniform(0.5, 2, len(x))
    force = bulk[:, None] * Smoothing(grid, ("free",) * 4, 0.3).viscous_acceleration(
        x, start, u, bulk, random.uniform(0, 1, len(x))
    )
    scale = np.abs(force).sum()
    assert np.abs(force.sum(0)).max() < 1e-13 * scale
    assert abs((x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]).sum()) < 1e-13 * scale
    assert (force * u).sum() < 0


@pytest.mark.parametrize("dimension", [2, 3])
def test_slip_walls_let_the_water_slide_and_no_slip_walls_hold_it(dimension):
    grid, x, start, bulk = tank(dimension, 6)
    u = np.zeros_like(x)
    u[:, 0] = 1.0
    periodic = Grid(grid.shape, grid.spacing, (True,) + (False,) * (dimension - 1))
    walls = ("slip",) * (2 * dimension)
    free = Smoothing(periodic, walls, 0.25).viscous_acceleration(x, start, u, bulk, 1.0)
    np.testing.assert_allclose(free, 0, atol=1e-12)
    held = Smoothing(periodic, (*walls[:-2], "no-slip", "slip"), 0.25).viscous_acceleration(x, start, u, bulk, 1.0)
    assert np.all(held[x[:, -1] < 0.2, 0] < 0)
    np.testing.assert_allclose(held[x[:, -1] > 0.3], 0, atol=1e-12)


def test_plane_poiseuille_flow_between_no_slip_walls():
    """du/dt = 1 + nu u_zz, u = 0 at both walls: steady u = z (1 - z)/(2 nu) with a mean of 1/(12 nu)."""
    n, nu = 12, 1.0
    grid = Grid((3, n), (1 / n, 1 / n), (True, False))
    x, start = sort_by_cell(grid, lattice(grid))
    smooth = Smoothing(grid, ("slip", "slip", "no-slip", "no-slip"), 3 / n)
    u, bulk, dt = np.zeros_like(x), np.full(len(x), grid.cell_volume / 4), smooth.time_step_limit(nu)
    push = np.array([1.0, 0.0])
    for _ in range(int(1.0 / dt)):
        u = u + dt * (smooth.viscous_acceleration(x, start, u, bulk, nu) + push)
    exact = x[:, 1] * (1 - x[:, 1]) / 2
    assert np.abs(u[:, 0] - exact).max() < 0.02 * exact.max()
    assert np.abs(u[:, 1]).max() < 1e-12


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("dimension", [2, 3])
def test_time_step_limit_is_stable_and_not_wasteful(dimension, kernel):
    grid, x, start, bulk = tank(dimension, 4, periodic=True)
    smooth = Smoothing(grid, ("slip",) * (2 * dimension), 0.375, kernel)
    noise = np.random.default_rng(0).normal(size=x.shape)

    def growth(factor):
        u, dt = noise.copy(), factor * smooth.time_step_limit(1.0)
        for _ in range(60):
            u = u + dt * smooth.viscous_acceleration(x, start, u, bulk, 1.0)
        return np.abs(u).max() / np.abs(noise).max()

    assert growth(1.0) < 1
    assert growth(3.0) > 1e3
    assert smooth.time_step_limit(0.0) == np.inf


@pytest.mark.parametrize("dimension", [2, 3])
def test_threads_do_not_change_a_bit(dimension):
    grid, x, start, bulk = tank(dimension, 16 if dimension == 2 else 6, 0.3)
    u = np.random.default_rng(0).normal(size=x.shape)
    smooth = Smoothing(grid, ("slip", "no-slip") * dimension, 2.0 / grid.shape[0])
    results = []
    try:
        for threads in (1, 2, 3):
            _core.set_threads(threads)
            results.append(
                (
                    smooth.density_sum(x, start, bulk),
                    smooth.velocity_gradient(x, start, u, bulk),
                    smooth.viscous_acceleration(x, start, u, bulk, 0.1),
                )
            )
    finally:
        _core.set_threads(1)
    for other in results[1:]:
        assert all(np.array_equal(a, b) for a, b in zip(results[0], other, strict=True))


def test_wrong_input_is_refused():
    grid, x, start, bulk = tank(2, 4)
    with pytest.raises(ValueError, match="unknown SPH kernel"):
        Smoothing(grid, ("slip",) * 4, 0.3, "cubic").density_sum(x, start, bulk)
    with pytest.raises(ValueError, match="unknown wall"):
        Smoothing(grid, ("sticky",) * 4, 0.3).density_sum(x, start, bulk)
    with pytest.raises(ValueError, match="cell_start does not fit"):
        Smoothing(grid, ("slip",) * 4, 0.3).density_sum(x[:-1].copy(), start, bulk[:-1])
