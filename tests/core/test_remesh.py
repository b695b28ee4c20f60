"""Remeshing: what is conserved and where, what is reproduced exactly, and that energy is never made."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference_remesh as reference
from clouds import lattice, numbered
from houle import _core
from houle.flow.particles import Particles
from houle.flow.remeshers import REMESHERS, Conservative, Paper
from houle.grid import Grid
from houle.medium.medium import Medium

SCATTERS = ["lattice", "shaken", "random", "sparse"]


def water(grid, scatter="shaken", level=0.6, seed=0):
    """Particles below a level (share of the height), with a rough velocity field."""
    random = np.random.default_rng(seed)
    size = np.array(grid.size)
    x = lattice(grid)
    x = x[x[:, -1] < level * size[-1]]
    if scatter == "shaken":
        x = x + random.normal(0, 0.15, x.shape) * np.array(grid.spacing)
    if scatter in ("random", "sparse"):
        x = random.random(x.shape) * size * np.append(np.ones(len(size) - 1), level)
    if scatter == "sparse":
        x = x[: len(x) // 5]
    x = np.clip(x, 1e-9 * size, (1 - 1e-9) * size)
    volume = grid.cell_volume / 2**grid.dimension * random.uniform(0.8, 1.2, len(x))
    return Particles(x, random.normal(size=x.shape), volume)


def everywhere_open(grid):
    return np.zeros([2 * n for n in grid.shape], np.int8)


def clear(grid):
    """The remesher of a tank without any structure."""
    return Conservative(grid, None, everywhere_open(grid))


def at(pores, grid, x):
    """Porosity of the half cells that hold x."""
    half = np.minimum((x / (np.array(grid.spacing) / 2)).astype(int), np.array(pores.shape) - 1)
    return pores[tuple(half.T)]


def close(a, b, scale):
    np.testing.assert_allclose(a, b, rtol=0, atol=1e-14 * np.max(scale))


def kinetic(p):
    return p.volume @ (p.velocity**2).sum(1) / 2


def mean_height(p):
    return p.volume @ p.position[:, -1] / p.volume.sum()


@st.composite
def situations(draw):
    dimension = draw(st.sampled_from([2, 3]))
    shape = tuple(draw(st.integers(2, 11 if dimension == 2 else 6)) for _ in range(dimension))
    spacing = tuple(draw(st.floats(0.5, 2.0)) for _ in range(dimension))
    periodic = (*(draw(st.booleans()) for _ in range(dimension - 1)), False)
    grid = Grid(shape, spacing, periodic)
    return grid, water(grid, draw(st.sampled_from(SCATTERS)), draw(st.floats(0.2, 0.95)), draw(st.integers(0, 99)))


@settings(max_examples=150, deadline=None)
@given(situations(), st.integers(0, 3), st.integers(0, 99))
def test_volume_and_momentum_are_conserved(situation, bodies, seed):
    grid, old = situation
    cells, body = np.ones(grid.shape), everywhere_open(grid)
    if bodies:  # slabs of the tank that belong to porous bodies, and one half cell that is solid
        cuts = np.sort(np.random.default_rng(seed).integers(0, grid.shape[0], bodies))
        number = np.searchsorted(cuts, np.arange(grid.shape[0]), side="right")
        cells[:] = np.where(number == 0, 1.0, 0.1 + 0.25 * number).reshape(-1, *[1] * (grid.dimension - 1))
        body[(0,) * grid.dimension] = -1
    pores = reference.half_cells(grid, cells, body)
    own = at(pores, grid, old.position)
    new = Conservative(grid, numbered(cells), body)(old, np.where(own > 0, own, 1.0))
    assert np.all(new.volume > 0)
    assert np.all((new.position >= 0) & (new.position <= grid.size))
    assert (old.volume[own == 0].sum() > 0) or np.all(at(pores, grid, new.position) > 0)
    close(new.total_volume, old.total_volume, old.volume.sum())
    close(new.volume @ new.velocity, old.volume @ old.velocity, old.volume @ np.abs(old.velocity))


@pytest.mark.parametrize("shift", [0.1, 0.25, 0.4])
@pytest.mark.parametrize("dimension", [2, 3])
def test_full_pores_stay_full_across_an_interface(dimension, shift):
    """Particles anywhere with as much water as belongs there, steps of the porosity of all sizes: so have the nodes.

    Without the porosity in the weights M4' fills the pores beside a step from 1 to 0.39 by up to a sixth too much.
    """
    grid = Grid((10, 6, 4)[:dimension], (1.0,) * dimension, (True,) * dimension)
    steps = np.repeat([1.0, 0.7, 0.45, 0.39, 0.8, 1.0], [2, 2, 1, 2, 1, 2]).reshape(-1, *[1] * (dimension - 1))
    cells = np.ascontiguousarray(np.broadcast_to(steps, grid.shape))
    pores = reference.half_cells(grid, cells, everywhere_open(grid))
    x = lattice(grid)
    nodes = at(pores, grid, x)
    line = np.append(pores[(slice(None), *[0] * (dimension - 1))], [1.0] * 4)
    weights = np.array([reference.m4_prime(k - shift * 2) for k in range(-1, 3)])
    index = np.round(x[:, 0] * 2 - 0.5).astype(int)
    held = np.array([weights @ line[[i - 1, i, i + 1, i + 2]] for i in index])  # of the porosity at the nodes around
    x[:, 0] += shift
    old = Particles(x % grid.size, np.zeros_like(x), held * grid.cell_volume / 2**dimension)
    new = Conservative(grid, numbered(cells), everywhere_open(grid))(old, held)
    assert len(new) == len(nodes)
    np.testing.assert_allclose(new.volume / at(pores, grid, new.position), 0.5**dimension, rtol=1e-9)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("scatter", SCATTERS)
@pytest.mark.parametrize("dimension", [2, 3])
def test_no_energy_is_made_from_noise(dimension, scatter, seed):
    """Rough velocities are filtered, never amplified; the mean height stays but for particles held back at a wall."""
    grid = Grid((9 if dimension == 2 else 6,) * dimension, (1.0,) * dimension, (False,) * dimension)
    old = water(grid, scatter, 0.6, seed)
    new = clear(grid)(old, np.ones(len(old)))
    assert kinetic(new) < (1.01 if scatter == "sparse" else 1 + 1e-13) * kinetic(old)
    assert abs(mean_height(new) - mean_height(old)) < 1e-3


@pytest.mark.parametrize("seed", range(3))
def test_kinetic_energy_of_a_wave_on_strained_particles(seed):
    """Particles that drifted in a wave for a while, 50 dx long: a remeshing filters a little, at the surface."""
    n, k = 50, 2 * np.pi / 50
    grid = Grid((n, 16), (1.0, 1.0), (True, False))
    x = lattice(grid)
    x = x[x[:, 1] < 12]
    phase = np.random.default_rng(seed).uniform(0, 2 * np.pi)
    still = x.copy()
    x[:, 0] = (x[:, 0] - np.sin(k * still[:, 0] + phase) * np.cosh(k * still[:, 1]) / np.sinh(12 * k)) % n
    x[:, 1] += np.cos(k * still[:, 0] + phase) * np.sinh(k * still[:, 1]) / np.sinh(12 * k)
    u = np.stack([np.cos(k * x[:, 0]) * np.cosh(k * x[:, 1]), np.sin(k * x[:, 0]) * np.sinh(k * x[:, 1])], 1)
    old = Particles(x, u, np.full(len(x), 0.25))
    new = clear(grid)(old, np.ones(len(old)))
    assert -1e-4 < kinetic(new) / kinetic(old) - 1 < 1e-7
    assert mean_height(new) == pytest.approx(mean_height(old), abs=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("scatter", ["lattice", "shaken"])
def test_potential_energy_is_kept_to_round_off_under_a_wavy_surface(dimension, scatter):
    grid = Grid((8,) * dimension, (1.0,) * dimension, (False,) * dimension)
    old = water(grid, scatter, 0.6)
    old.position[:, -1] *= 1 + 0.2 * np.cos(np.pi * old.position[:, 0] / 8)
    new = clear(grid)(old, np.ones(len(old)))
    close(new.volume @ new.position[:, -1], old.volume @ old.position[:, -1], old.volume @ old.position[:, -1])


@pytest.mark.parametrize("dimension", [2, 3])
def test_moments_up_to_degree_two_are_kept_in_full_water(dimension):
    """One particle in a sea of still ones: M4' hands its momentum on with the right 0th, 1st and 2nd moments."""
    grid = Grid((8,) * dimension, (1.0,) * dimension, (False,) * dimension)
    old = water(grid, "lattice", 1.0)
    old.velocity[:] = 0
    middle = np.argmin(((old.position - 4.1) ** 2).sum(1))
    old.position[middle] += 0.05 * np.arange(1, dimension + 1)
    old.velocity[middle] = 1.0
    new = clear(grid)(old, np.ones(len(old)))
    momentum = new.volume * new.velocity[:, 0]
    for powers in np.ndindex(*(3,) * dimension):
        if sum(powers) > 2:
            continue
        expected = old.volume[middle] * np.prod((old.position[middle] - 4) ** powers)
        assert momentum @ np.prod((new.position - 4) ** powers, axis=1) == pytest.approx(expected, abs=1e-13)


def test_quadratic_velocity_is_reproduced_in_the_interior():
    """Particles on a shifted lattice: M4' is exact for degree 2 (third order)."""
    grid = Grid((12, 12), (0.5, 0.5), (False, False))
    x = lattice(grid) + np.array([0.06, 0.09])
    x = x[np.all(x < 5.99, axis=1)]
    field = lambda x: 1 + x[:, 0] - 2 * x[:, 1] + 0.3 * x[:, 0] ** 2 - 0.2 * x[:, 0] * x[:, 1]  # noqa: E731
    old = Particles(x, np.stack([field(x)] * 2, 1), np.full(len(x), 1 / 16))
    new = clear(grid)(old, np.ones(len(x)))
    interior = np.all((new.position > 1) & (new.position < 5), axis=1)
    np.testing.assert_allclose(new.velocity[interior, 0], field(new.position[interior]), rtol=0, atol=1e-12)
    np.testing.assert_allclose(new.volume[interior], 1 / 16, rtol=1e-13)


@pytest.mark.parametrize("dimension", [2, 3])
def test_lattice_in_a_full_tank_is_a_fixed_point(dimension):
    grid = Grid((5, 4, 3)[:dimension], (0.1, 0.2, 0.15)[:dimension], (False,) * dimension)
    old = water(grid, "lattice", 1.0)
    old.volume[:] = grid.cell_volume / 2**dimension
    new = clear(grid)(old, np.ones(len(old)))
    order_old, order_new = np.lexsort(old.position.T.round(9)), np.lexsort(new.position.T.round(9))
    np.testing.assert_allclose(new.position[order_new], old.position[order_old], atol=1e-12)
    np.testing.assert_allclose(new.velocity[order_new], old.velocity[order_old], atol=1e-12)


def level_of(grid, p):
    """Surface of flat water from the tent-weighted fill of the cells, inverted exactly for a flat surface [m]."""
    h, n = grid.spacing[-1], grid.shape[-1]
    s = p.position[:, -1] / h - 0.5
    i = np.floor(s).astype(int)
    layer = np.zeros(n)
    for k, w in ((i, 1 - s + i), (i + 1, s - i)):
        np.add.at(layer, np.clip(k, 0, n - 1), w * p.volume)
    fill = layer / (grid.cell_volume * np.prod(grid.shape[:-1]))
    depth = np.where(fill >= 0.5, 1 - np.sqrt(np.maximum(0, 2 - 2 * fill)), np.sqrt(2 * np.maximum(fill, 0)) - 1)
    top = np.nonzero(depth >= 0)[0].max()
    return (top + 0.5 + depth[top] / (depth[top] - depth[top + 1])) * h


@pytest.mark.parametrize("level", np.linspace(4.8, 5.2, 9).round(3))
@pytest.mark.parametrize("dimension", [2, 3])
def test_still_water_keeps_its_level_off_the_lattice(dimension, level):
    """In 50 remeshings the level read from the grid moves by less than 0.02 dx, the centre of volume not at all."""
    grid = Grid((4,) * (dimension - 1) + (10,), (1.0,) * dimension, (False,) * dimension)
    x = lattice(grid)
    x = x[x[:, -1] < 5.0]
    x[:, -1] *= level / 5.0
    old = Particles(x, np.zeros_like(x), np.full(len(x), level * 4 ** (dimension - 1) / len(x)))
    remesher, new = clear(grid), old
    for _ in range(50):
        new = remesher(new, np.ones(len(new)))
    assert level_of(grid, new) == pytest.approx(level, abs=0.02)
    assert mean_height(new) == pytest.approx(mean_height(old), abs=1e-12)


def test_symmetric_water_stays_symmetric():
    grid = Grid((10, 8), (0.1, 0.1), (False, False))
    right = water(grid, "random", 0.5)
    middle = right.position[:, 0] > 0.5
    x, u, v = right.position[middle], right.velocity[middle], right.volume[middle]
    old = Particles(np.vstack([x, [1, 0] + x * [-1, 1]]), np.vstack([u, u * [-1, 1]]), np.concatenate([v, v]))
    new = clear(grid)(old, np.ones(len(old)))
    mirrored = [1, 0] + new.position * [-1, 1]
    a, b = np.lexsort(new.position.T.round(9)), np.lexsort(mirrored.T.round(9))
    np.testing.assert_allclose(new.position[a], mirrored[b], atol=1e-12)
    np.testing.assert_allclose(new.velocity[a], (new.velocity * [-1, 1])[b], atol=1e-10)


def test_lone_drop_stays_as_it_is():
    grid = Grid((10, 10), (1.0, 1.0), (False, False))
    old = Particles(np.array([[5.1, 5.2]]), np.array([[1.0, -2.0]]), np.array([0.02]))
    new = clear(grid)(old, np.ones(1))
    assert np.array_equal(new.position, old.position) and np.array_equal(new.velocity, old.velocity)


def test_nothing_is_remeshed_to_nothing():
    grid = Grid((3, 3), (1.0, 1.0), (False, False))
    nothing = Particles(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0))
    for remesher in REMESHERS.values():
        assert len(remesher.of(grid, Medium.build(grid))(nothing, np.ones(0))) == 0


@pytest.mark.parametrize("scatter", SCATTERS)
@pytest.mark.parametrize("dimension", [2, 3])
def test_agrees_with_the_numpy_twin(dimension, scatter):
    grid = Grid((7, 5, 4)[:dimension], (0.1, 0.2, 0.15)[:dimension], (True, False, False)[:dimension])
    old = water(grid, scatter, 0.6)
    cells, body = np.ones(grid.shape), everywhere_open(grid)
    cells[grid.shape[0] // 2 :] = 0.5
    body[-1] = -1
    pores = reference.half_cells(grid, cells, body)
    porosity = np.where(at(pores, grid, old.position) == 1.0, 1.0, 0.5)
    new = Conservative(grid, numbered(cells), body)(old, porosity)
    twin = reference.conservative(grid, pores, old.position, old.velocity, old.volume, porosity)
    x, u, v = twin
    np.testing.assert_allclose(new.position, x, atol=1e-8)
    np.testing.assert_allclose(new.velocity, u, atol=1e-9)
    np.testing.assert_allclose(new.volume, v, atol=1e-14)


@pytest.mark.parametrize("dimension", [2, 3])
def test_threads_do_not_change_a_bit(dimension):
    grid = Grid((80, 40) if dimension == 2 else (20, 10, 12), (0.1,) * dimension, (False,) * dimension)
    old = water(grid)
    results = []
    try:
        for threads in (1, 2, 5):
            _core.set_threads(threads)
            results.append([remesher(old, np.ones(len(old))) for remesher in (clear(grid), Paper(grid))])
    finally:
        _core.set_threads(1)
    for other in results[1:]:
        for a, b in zip(results[0], other, strict=True):
            assert np.array_equal(a.position, b.position) and np.array_equal(a.velocity, b.velocity)
            assert np.array_equal(a.volume, b.volume)


def test_paper_scheme_raises_the_surface():
    """The defect the paper reports in its section 5.1: one more layer on every remeshing off the lattice."""
    grid = Grid((4, 10), (1.0, 1.0), (False, False))
    old = water(grid, "lattice", 0.5)
    old.volume[:] = 0.25
    old.position[:, 1] += 0.1
    new = Paper(grid)(old, np.ones(len(old)))
    assert new.total_volume == pytest.approx(1.1 * old.total_volume)
    assert new.position[:, 1].max() == pytest.approx(5.25)


def test_paper_scheme_fills_porous_nodes_with_n_times_their_size():
    grid = Grid((4, 4), (1.0, 1.0), (False, False))
    old = water(grid, "lattice", 1.0)
    old.volume[:] = 0.4 * 0.25
    new = Paper(grid)(old, np.full(len(old), 0.4))
    np.testing.assert_allclose(new.volume, 0.1, rtol=1e-13)


def test_wrong_lengths_are_refused():
    grid = Grid((3, 3), (1.0, 1.0), (False, False))
    old = water(grid)
    with pytest.raises(ValueError, match="porosity has 1 entries"):
        clear(grid)(old, np.ones(1))
    with pytest.raises(ValueError, match="body has 9 entries"):
        Conservative(grid, None, np.zeros((3, 3), np.int8))(old, np.ones(len(old)))
