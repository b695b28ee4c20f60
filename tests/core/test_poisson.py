"""The pressure solver: against sparse direct solution, its iteration counts, and its promises."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from houle import _core

sys.path.insert(0, str(Path(__file__).parents[1]))
import reference_poisson as reference


def solver(shape, periodic=None):
    d = len(shape)
    grid = (_core.Grid2, _core.Grid3)[d - 2](shape, [1.0] * d, periodic or [False] * d)
    return (_core.PressureSolver2, _core.PressureSolver3)[d - 2](grid)


def faces(shape, value=1.0):
    return [np.full([n + (a == axis) for a, n in enumerate(shape)], value) for axis in range(len(shape))]


def random_system(shape, periodic, rng, filling, surface):
    """Active cells at random, a fifth of the faces shut, k from 0.05 to 1, e in a share `surface` of cells."""
    active = rng.random(shape) < filling
    k = faces(shape)
    for a, f in enumerate(k):
        f *= rng.uniform(0.5, 1, f.shape) * 10.0 ** rng.integers(-1, 1, f.shape) * (rng.random(f.shape) > 0.2)
        if periodic[a]:
            f[(slice(None),) * a + (-1,)] = f[(slice(None),) * a + (0,)]
    e = np.where(rng.random(shape) < surface, rng.uniform(0.1, 20, shape), 0)
    return active, k, e


def basin(shape, depth, slope=0.0, rough=False, seed=1):
    """Water of a depth (cells) under a wavy surface, ghost-fluid e = k / theta at the faces to air.

    rough: a porous block (k / 50), a solid ball that cuts faces down to 1e-3, spray of single cells and a thin film.
    """
    rng = np.random.default_rng(seed)
    x = np.meshgrid(*[np.arange(n) + 0.5 for n in shape], indexing="ij")
    level = depth - x[-1] + slope * shape[-1] * np.sin(2 * np.pi * x[0] / shape[0])  # > 0 in the water
    k = faces(shape)
    if rough:
        for a, f in enumerate(k):
            y = np.meshgrid(*[np.arange(n) + 0.5 * (b != a) for b, n in enumerate(f.shape)], indexing="ij")
            f[(y[0] > shape[0] / 3) & (y[0] < shape[0] / 2)] /= 50
            distance = np.sqrt(sum((yb - 0.25 * n) ** 2 for yb, n in zip(y, shape, strict=True))) - 0.15 * shape[-1]
            f *= np.where(distance < -0.5, 0, np.clip(distance + 0.5, 1e-3, 1))
        level[rng.random(shape) < 0.02] = 0.3
        level[(x[-1] > shape[-1] - 1) & (x[0] < shape[0] / 2)] = 0.5
    active = level >= 0
    e = np.zeros(shape)
    for a, f in enumerate(k):
        front, back = (slice(None),) * a + (slice(1, None),), (slice(None),) * a + (slice(None, -1),)
        inner = f[(slice(None),) * a + (slice(1, -1),)]
        for own, other in ((front, back), (back, front)):
            here, there = level[own], level[other]
            theta = np.clip(here / np.where(here > there, here - there, 1), 0.05, 1)
            e[own] += np.where(active[own] & ~active[other], inner / theta, 0)
    return active, k, e


def solve(s, system, rhs, tolerance=1e-9, p=None, limit=300):
    active, k, e = system
    p = np.zeros(active.shape) if p is None else p
    s.setup(active.astype(np.uint8), k, e)
    iterations, residual = s.solve(rhs, p, tolerance, limit)
    return p, iterations, residual


@st.composite
def cases(draw):
    d = draw(st.integers(2, 3))
    shape = draw(st.lists(st.integers(1, 24 if d == 2 else 9), min_size=d, max_size=d))
    periodic = draw(st.lists(st.booleans(), min_size=d, max_size=d))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    filling = draw(st.sampled_from([0.2, 0.6, 0.9, 1.0]))
    surface = draw(st.sampled_from([0.0, 0.02, 0.3]))
    return shape, periodic, rng, filling, surface


@settings(max_examples=150, deadline=None)
@given(cases())
def test_random_domains_agree_with_direct_solution(case):
    shape, periodic, rng, filling, surface = case
    s = solver(shape, periodic)
    for _ in range(2):  # the second system must not see the first one
        system = random_system(shape, periodic, rng, filling, surface)
        rhs = rng.standard_normal(shape)
        p, iterations, residual = solve(s, system, rhs, p=rng.standard_normal(shape))
        expected, closed = reference.solve(*system, rhs, periodic)
        assert iterations >= 0 and residual <= 1e-9
        assert s.closed_components == len(closed)
        assert np.all(p[~system[0]] == 0)
        np.testing.assert_allclose(p, expected, atol=1e-6 * max(1, np.abs(expected).max()))


@pytest.mark.parametrize("d", [2, 3])
def test_dead_faces_and_inactive_cells_are_ignored(d):
    """Garbage on walls, on faces to inactive cells and in inactive cells changes no bit."""
    shape = [20, 17] if d == 2 else [8, 9, 10]
    rng = np.random.default_rng(3)
    active, k, e = random_system(shape, [False] * d, rng, 0.7, 0.2)
    rhs, start = rng.standard_normal(shape), rng.standard_normal(shape)
    clean = solve(solver(shape), (active, k, e), rhs, p=start.copy())
    for a, f in enumerate(k):
        both = np.zeros(f.shape, bool)
        lower, upper = (slice(None),) * a + (slice(None, -1),), (slice(None),) * a + (slice(1, None),)
        both[(slice(None),) * a + (slice(1, -1),)] = active[lower] & active[upper]
        f[~both] = np.nan
    for cells in (e, rhs, start):
        cells[~active] = np.nan
    dirty = solve(solver(shape), (active, k, e), rhs, p=start)
    assert np.array_equal(clean[0], dirty[0]) and clean[1:] == dirty[1:]


SMOOTH = [((1000, 50), 31.3), ((500, 500), 340.6), ((48, 48, 48), 30.7)]


@pytest.mark.parametrize(("shape", "depth"), SMOOTH)
def test_iterations_smooth(shape, depth):
    active, k, e = basin(shape, depth, slope=0.03)
    rhs = np.random.default_rng(0).standard_normal(shape) + np.cos(np.arange(shape[-1]) / shape[-1])
    _, iterations, _ = solve(solver(shape), (active, k, e), rhs, 1e-6 * np.abs(rhs[active]).max())
    assert 0 < iterations <= 10


@pytest.mark.parametrize(("shape", "depth"), SMOOTH)
def test_iterations_with_jumps_cut_faces_spray_and_films(shape, depth):
    active, k, e = basin(shape, depth, slope=0.03, rough=True)
    rhs = np.random.default_rng(0).standard_normal(shape)
    _, iterations, _ = solve(solver(shape), (active, k, e), rhs, 1e-6 * np.abs(rhs[active]).max())
    assert 0 < iterations <= 16


def test_iterations_do_not_grow_with_the_grid():
    counts = []
    for n in (64, 128, 256, 512):
        system = basin((n, n), 0.63 * n, slope=0.02)
        counts.append(solve(solver((n, n)), system, np.ones((n, n)), 1e-6)[1])
    assert max(counts) <= min(counts) + 4


def test_closed_tank_has_zero_mean():
    """A filled tank: only differences of pressure are known; a rhs that does not sum to zero loses its mean."""
    shape = (30, 20, 10)
    rhs = np.random.default_rng(0).standard_normal(shape) + 3.0
    s = solver(shape)
    p, iterations, residual = solve(s, (np.ones(shape, bool), faces(shape), np.zeros(shape)), rhs)
    assert s.closed_components == 1 and 0 < iterations <= 16 and residual <= 1e-9
    assert abs(p.mean()) < 1e-12 * np.abs(p).max()


def test_hydrostatic_pressure_is_exact():
    """Gravity in a column under a flat surface at theta: p = g (depth), linear, in a few iterations."""
    shape = (16, 40)
    theta = 0.3
    active = np.zeros(shape, bool)
    active[:, :25] = True
    e = np.zeros(shape)
    e[:, 24] = 1 / theta
    rhs = np.zeros(shape)
    rhs[:, 0] = 1  # -div of the unit weight, which the floor stops
    p, _, _ = solve(solver(shape), (active, faces(shape), e), rhs, 1e-11)
    depth = (24 + theta) - np.arange(25)
    np.testing.assert_allclose(p[:, :25], np.broadcast_to(depth, (16, 25)), rtol=1e-9)


@pytest.mark.parametrize("shape", [(64, 40), (63, 41), (24, 15, 18)])
def test_mirror_symmetric_problem(shape):
    """A system that is its own mirror image in x has such a solution, to round-off of the reached residual."""
    active, k, e = basin(shape, 0.6 * shape[-1])
    rhs = np.random.default_rng(0).standard_normal(shape)
    rhs += rhs[::-1]
    p, _, _ = solve(solver(shape), (active, k, e), rhs, 1e-12)
    np.testing.assert_allclose(p, p[::-1], atol=1e-10 * np.abs(p).max())


def test_warm_start_and_round_off():
    system = basin((200, 60), 35.2, slope=0.02)
    s = solver((200, 60))
    rhs = np.random.default_rng(0).standard_normal((200, 60))
    p, iterations, residual = solve(s, system, rhs, 1e-10)
    assert iterations > 0 and residual <= 1e-10
    again = p.copy()
    assert s.solve(rhs, again, 1e-10, 100)[0] == 0
    assert np.abs(again - p).max() <= 1e-12 * np.abs(p).max()
    iterations, residual = s.solve(rhs, p, 0.0, 1000)  # out of reach: stops at round-off and says so
    assert iterations == -1 and residual < 1e-11


def test_too_few_iterations_are_reported():
    system = basin((200, 60), 35.2)
    rhs = np.ones((200, 60))
    _, iterations, residual = solve(solver((200, 60)), system, rhs, 1e-10, limit=2)
    assert iterations == -1 and residual > 1e-10


def test_no_water_has_no_pressure_and_a_nan_is_told_and_forgotten():
    shape = (12, 9)
    s = solver(shape)
    nothing = (np.zeros(shape, bool), faces(shape), np.zeros(shape))
    p, iterations, residual = solve(s, nothing, np.ones(shape), p=np.ones(shape))
    assert (iterations, residual) == (0, 0) and np.all(p == 0)
    system = basin(shape, 5.5)
    rhs = np.ones(shape)
    rhs[3, 2] = np.nan
    _, iterations, residual = solve(s, system, rhs)
    assert iterations == -1 and np.isnan(residual)
    rhs[3, 2] = 1  # and it leaves nothing behind
    assert solve(s, system, rhs)[1] > 0


def test_wrong_sizes_are_refused():
    s = solver((4, 5))
    with pytest.raises(ValueError, match="active has 12 entries"):
        s.setup(np.zeros((3, 4), np.uint8), faces((4, 5)), np.zeros((4, 5)))
    with pytest.raises(ValueError, match="faces of axis 1"):
        s.setup(np.zeros((4, 5), np.uint8), [np.zeros((5, 5)), np.zeros((4, 5))], np.zeros((4, 5)))


def test_same_bits_for_any_number_of_threads():
    before = _core.get_threads()
    try:
        results = []
        for threads in (1, 2, 3):
            _core.set_threads(threads)
            for shape in ((300, 200), (40, 30, 50)):
                system = basin(shape, 0.6 * shape[-1], slope=0.05, rough=True)
                p, *report = solve(solver(shape), system, np.random.default_rng(0).standard_normal(shape), 1e-8)
                results.append((p.tobytes(), report))
        assert results[:2] == results[2:4] == results[4:]
    finally:
        _core.set_threads(before)


def test_second_solve_allocates_nothing():
    """Every work array keeps its place and size while the water moves, breaks up, and closes off."""
    shape = (120, 80)
    s, rhs = solver(shape), np.ones(shape)
    solve(s, basin(shape, 20.5), rhs)
    buffers = s.buffers
    rng = np.random.default_rng(0)
    for system in (basin(shape, 60.2, 0.05, True), random_system(shape, [False] * 2, rng, 0.5, 0.0)):
        solve(s, system, rhs)
        assert s.buffers == buffers
