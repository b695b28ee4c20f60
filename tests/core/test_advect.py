"""Motion of the particles: the twin, the midpoint rule, and nothing ever through a wall, a gate or a solid."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference
import reference_transfer
from clouds import grids, linear_faces, random_faces, randoms, scattered, start_of
from houle import _core
from houle.geometry import Box, node_distance
from houle.grid import Grid

NO_GATES = np.zeros((0, 2))


def move(grid, u, dt, x, porosity=None, distance=None, gates=NO_GATES, own=None, own_porosity=None):
    x = np.ascontiguousarray(x, dtype=float).copy()
    _core.move(grid.core, u, porosity, own, own_porosity, distance, gates, dt, x)
    return x


@given(randoms, st.integers(1, 3000), st.booleans())
def test_ways_against_the_twin(random, count, porous):
    """To the bit: ways are part of the state."""
    u, mass, dt = random.normal(size=count), random.uniform(0.0, 2.0, count), random.uniform(0.0, 0.1)
    porosity = random.uniform(0.3, 1.0, count).astype(np.float32) if porous else None
    way = random.normal(size=count).astype(np.float32)
    expected, farthest = reference.travel(dt, u, mass, 1.0, porosity, way)
    assert _core.travel(dt, u, mass, 1.0, porosity, way) == farthest
    assert np.array_equal(way, expected)
    if mass.max() > 1.0:
        u[np.argmax(mass)] = np.nan
        assert np.isnan(_core.travel(dt, u, mass, 1.0, porosity, way))


def obstacles(grid, random):
    """A solid block and a half-open gate somewhere inside: distances at the nodes, gates."""
    size = np.array(grid.size)
    block = Box(tuple(0.55 * size), tuple(0.8 * size))
    gates = np.array([[round(0.3 * grid.shape[0]) * grid.spacing[0], random.uniform(0.0, size[-1])]])
    return node_distance(grid, [block]), gates


@settings(max_examples=40)
@given(grids(), randoms, st.booleans(), st.booleans())
def test_motion_against_the_twin(grid, random, porous, obstructed):
    x, u = scattered(grid, random, 30), random_faces(grid, random)
    porosity = random.uniform(0.3, 1.0, grid.shape) if porous else None
    distance, gates = obstacles(grid, random) if obstructed else (None, NO_GATES)
    dt = 0.5 * min(grid.spacing)
    expected = reference.move(grid, u, porosity, distance, gates, dt, x)
    np.testing.assert_allclose(move(grid, u, dt, x, porosity, distance, gates), expected, rtol=0, atol=1e-12)

    own, clear = np.empty_like(x), np.ones(len(x))
    _core.to_particles(grid.core, "linear", x, None, clear, start_of(grid, x), u, [], [], 0.0, own)
    own_porosity = reference_transfer.gather_cells(grid, x, porosity) if porous else None
    found = move(grid, u, dt, x, porosity, distance, gates, own, own_porosity)  # the first stage known already
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)

    new = x.copy()
    _core.displace(grid.core, u, porosity, distance, gates, 0.1, new)
    expected = reference.displace(grid, u, porosity, distance, gates, 0.1, x)
    np.testing.assert_allclose(new, expected, rtol=0, atol=1e-12)

    velocity = random.normal(size=x.shape)
    n = random.uniform(0.3, 1.0, len(x)) if porous else None
    _core.drift(grid.core, x, velocity, n, distance, gates, dt, new)
    ends = x + dt * velocity / (1.0 if n is None else n[:, None])
    expected = [reference.keep_inside(grid, distance, gates, *pair) for pair in zip(x, ends, strict=True)]
    np.testing.assert_allclose(new, expected, rtol=0, atol=1e-12)


# ---- accuracy --------------------------------------------------------------------------------------------------------


def test_solid_body_rotation_is_of_second_order():
    """Linear fields are interpolated exactly, so what is left is the midpoint rule."""
    grid = Grid((10, 10), (0.1, 0.1), (False, False))
    u = linear_faces(grid, np.array([0.5, -0.5]), np.array([[0.0, -1.0], [1.0, 0.0]]))  # once round in 2 pi s
    start = np.array([[0.8, 0.5], [0.5, 0.6], [0.3, 0.35]])
    errors = []
    for steps in (50, 100, 200):
        x = start
        for _ in range(steps):
            x = move(grid, u, 2 * np.pi / steps, x)
        errors.append(np.abs(x - start).max())
    assert errors[0] > 3.8 * errors[1] > 3.8**2 * errors[2]
    assert errors[2] < 1e-3


@pytest.mark.parametrize("d", [2, 3])
def test_uniform_flow_goes_round_a_periodic_tank(d):
    grid = Grid((5, 4, 6)[:d], (0.2, 0.25, 0.5)[:d], (True,) * d)
    velocity = np.array([1.0, -0.5, 0.75])[:d]
    x = scattered(grid, np.random.default_rng(1), 50)
    moved = x
    for _ in range(40):
        moved = move(grid, linear_faces(grid, velocity, np.zeros((d, d))), 0.1, moved)
        assert np.all((moved >= 0) & (moved < grid.size))
    turns = (x + 4.0 * velocity - moved) / grid.size
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-12)


def test_water_in_the_pores_is_faster():
    """u_d / n: through a bed of porosity 0.4 in 0.4 of the time; linear in between."""
    grid = Grid((40, 2), (0.05, 0.05), (False, True))
    u = linear_faces(grid, np.array([0.1, 0.0]), np.zeros((2, 2)))
    for c in (u[0][0], u[0][-1]):
        c[...] = 0.1
    porosity = grid.cells(1.0)
    porosity[20:] = 0.4
    x = np.array([[0.5, 0.05], [1.5, 0.05]])
    moved = move(grid, u, 1.0, x, porosity)
    np.testing.assert_allclose(moved[:, 0] - x[:, 0], [0.1, 0.25], rtol=1e-12)
    through, steps = np.array([[0.9, 0.05]]), 2000
    for _ in range(steps):
        through = move(grid, u, 2.0 / steps, through, porosity)
    # time from 0.9 m: n from 1 to 0.4 between the centres at 0.975 and 1.025 m
    time = 0.075 / 0.1 + 0.05 * 0.7 / 0.1
    assert through[0, 0] == pytest.approx(1.025 + (2.0 - time) * 0.25, abs=1e-5)


# ---- nothing passes --------------------------------------------------------------------------------------------------


@settings(max_examples=60)
@given(grids(), randoms, st.floats(0.1, 30.0))
def test_no_particle_leaves_the_tank(grid, random, courant):
    """Even with steps far too long: never out, never on the wall itself, never not a number."""
    x, u = scattered(grid, random, 60), random_faces(grid, random)
    dt = courant * min(grid.spacing)
    ends = [move(grid, u, dt, x)]
    drifted = np.empty_like(x)
    _core.drift(grid.core, x, 5.0 * random.normal(size=x.shape), None, None, NO_GATES, dt, drifted)
    for end in (*ends, drifted):
        for a, length in enumerate(grid.size):
            assert np.all((end[:, a] < length) & ((end[:, a] >= 0) if grid.periodic[a] else (end[:, a] > 0)))


@settings(max_examples=60)
@given(st.floats(0.0, 1.0), randoms)
def test_no_particle_passes_a_gate_but_below_it(bottom, random):
    """Water on both sides of a plate, thrown at it: above the lower edge none changes sides, below it may."""
    grid = Grid((10, 10), (0.1, 0.1), (False, False))
    x = scattered(grid, random, 200)
    x[:, 0] = np.where(np.abs(x[:, 0] - 0.5) < 1e-12, 0.45, x[:, 0])
    u = random_faces(grid, random, -3.0, 3.0)
    end = move(grid, u, 0.05, x, gates=np.array([[0.5, bottom]]))
    changed = (end[:, 0] < 0.5) != (x[:, 0] < 0.5)
    assert np.all(end[changed, 1] <= bottom)
    free = move(grid, u, 0.05, x)
    elsewhere = np.abs(x[:, 0] - 0.5) > 0.2
    assert np.array_equal(end[elsewhere], free[elsewhere])


@settings(max_examples=40)
@given(randoms, st.sampled_from([(2, False), (3, False), (2, True)]))
def test_no_particle_ends_in_a_solid(random, kind):
    """Started in the water and moved by up to a cell: outside the solid, or on its surface, after every step."""
    d, tilted = kind
    grid = Grid((12, 12, 12)[:d], (0.1,) * d, (False,) * d)
    if tilted:
        points = np.stack(np.meshgrid(*[np.arange(13) * 0.1] * 2, indexing="ij"), axis=-1)
        distance = (points @ np.array([-0.6, 0.8])) - 0.1  # a ramp
    else:
        distance = node_distance(grid, [Box((0.4,) * d, (0.8,) * d)])

    def depth_inside(x):
        return np.array([-reference.solid_distance(grid, distance, p)[0] for p in x])

    x = scattered(grid, random, 150)
    x = x[depth_inside(x) < -1e-9]
    for _ in range(5):
        x = move(grid, random_faces(grid, random, -1.0, 1.0), 0.1, x, distance=distance)
        x = x[np.all((x > 1e-6) & (x < 1.2 - 1e-6), axis=1)]  # where a solid meets a wall, the wall comes first
        inside = depth_inside(x)
        assert inside.max() < (1e-12 if tilted else 0.02)  # cells that hold an edge of the solid round it off
