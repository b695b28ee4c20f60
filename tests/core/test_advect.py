"""Motion of the particles: the twin, the midpoint rule, and nothing ever through a wall, a gate or a solid."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import reference
import reference_transfer
from clouds import grids, linear_faces, numbered, random_faces, randoms, scattered, start_of
from houle import _core
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.shapes import Box, Polygon, Union, signed_distance
from houle.medium.solids import Outline

NO_GATES = np.zeros((0, 2))


def move(grid, u, dt, x, porosity=None, outline=None, gates=NO_GATES, own=None, own_porosity=None):
    x = np.ascontiguousarray(x, dtype=float).copy()
    volume = None if own_porosity is None else np.full(len(x), 0.125)
    bulk = None if own_porosity is None else volume / own_porosity
    _core.move(grid.core, u, numbered(porosity), own, volume, bulk, outline, gates, dt, x)
    return x


@given(grids(), randoms, st.booleans())
def test_ways_against_the_twin(grid, random, porous):
    """To the bit: ways are part of the state."""
    u, dt = random_faces(grid, random), random.uniform(0.0, 0.1)
    mass = [random.uniform(0.0, 2.0, f.shape) for f in u]
    porosity = random.uniform(0.3, 1.0, grid.shape) if porous else None
    ways = [random.normal(size=f.shape).astype(np.float32) for f in u]
    expected = [reference.travel(a, dt, u[a], mass[a], 1.0, porosity, way) for a, way in enumerate(ways)]
    assert _core.travel(grid.core, dt, u, mass, 1.0, numbered(porosity), ways) == [farthest for _, farthest in expected]
    for way, (wanted, _) in zip(ways, expected, strict=True):
        assert np.array_equal(way, wanted)
    if mass[0].max() > 1.0:
        u[0].flat[np.argmax(mass[0])] = np.nan
        assert np.isnan(_core.travel(grid.core, dt, u, mass, 1.0, numbered(porosity), ways)[0])


def obstacles(grid, random):
    """A solid block and a half-open gate somewhere inside."""
    size = np.array(grid.size)
    block = Box(tuple(0.55 * size), tuple(0.8 * size))
    gates = np.array([[round(0.3 * grid.shape[0]) * grid.spacing[0], random.uniform(0.0, size[-1])]])
    return block, gates


@settings(max_examples=40)
@given(grids(), randoms, st.booleans(), st.booleans())
def test_motion_against_the_twin(grid, random, porous, obstructed):
    x, u = scattered(grid, random, 30), random_faces(grid, random)
    porosity = random.uniform(0.3, 1.0, grid.shape) if porous else None
    block, gates = obstacles(grid, random) if obstructed else (None, NO_GATES)
    outline = Outline.of(grid, [block] if block else [])
    dt = 0.5 * min(grid.spacing)
    expected = reference.move(grid, u, porosity, block, gates, dt, x)
    np.testing.assert_allclose(move(grid, u, dt, x, porosity, outline, gates), expected, rtol=0, atol=1e-12)

    own, clear = np.empty_like(x), np.ones(len(x))
    _core.to_particles(grid.core, "linear", x, None, clear, start_of(grid, x), u, [], [], 0.0, own)
    own_porosity = reference_transfer.gather_cells(grid, x, porosity) if porous else None
    found = move(grid, u, dt, x, porosity, outline, gates, own, own_porosity)  # the first stage known already
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)

    new = x.copy()
    _core.displace(grid.core, u, numbered(porosity), outline, gates, 0.1, new)
    expected = reference.displace(grid, u, porosity, block, gates, 0.1, x)
    np.testing.assert_allclose(new, expected, rtol=0, atol=1e-12)

    velocity = random.normal(size=x.shape)
    n = random.uniform(0.3, 1.0, len(x)) if porous else None
    _core.drift(grid.core, x, velocity, n, outline, gates, dt, new)
    ends = x + dt * velocity / (1.0 if n is None else n[:, None])
    expected = [reference.keep_inside(grid, block, gates, *pair) for pair in zip(x, ends, strict=True)]
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


L_SHAPE = shapely.Polygon([(0.43, 0.0), (0.83, 0.0), (0.83, 0.77), (0.64, 0.77), (0.64, 0.35), (0.43, 0.35)])
SOLIDS = {  # corners that stick out and corners that do not, off the lines of the grid, across walls and beside them
    "box": lambda d: [Box((0.43,) * d, (0.77,) * d)],
    "box on the floor": lambda d: [Box((0.43,) * (d - 1) + (0.0,), (0.77,) * (d - 1) + (0.35,))],
    "boxes in a corner": lambda d: [Box((0.0,) * d, (0.57,) * d), Box((0.0,) * d, (0.83,) * (d - 1) + (0.26,))],
    "spike": lambda d: [Polygon(shapely.Polygon([(0.31, 0.0), (0.92, 0.0), (0.55, 0.97)]), d)],
    "L": lambda d: [Polygon(L_SHAPE, d)],
    "L and a box": lambda d: [Polygon(L_SHAPE, d), Box((0.21,) * d, (0.52,) * d)],
}


@settings(max_examples=40)
@given(randoms, st.sampled_from(sorted(SOLIDS)), st.sampled_from([2, 3]), st.booleans())
def test_no_particle_ends_in_a_solid(random, kind, d, periodic):
    """Started in the water and moved by up to a cell: at most a rounding deep in the solid after every step."""
    if kind == "boxes in a corner":
        periodic = False
    grid = Grid((12, 12, 12)[:d], (0.1,) * d, (periodic,) * (d - 1) + (False,))
    solids = SOLIDS[kind](d)
    outline = Outline.of(grid, solids)
    x = scattered(grid, random, 150)
    x = x[Union(tuple(solids)).distance(x) > 1e-9]
    for _ in range(5):
        x = move(grid, random_faces(grid, random, -1.0, 1.0), 0.1, x, outline=outline)
        assert Union(tuple(solids)).distance(x).min() > -1e-9 * 0.1
        displaced = x.copy()
        _core.displace(grid.core, random_faces(grid, random, -0.1, 0.1), None, outline, NO_GATES, 1.0, displaced)
        assert Union(tuple(solids)).distance(displaced).min() > -1e-9 * 0.1


@settings(max_examples=40)
@given(randoms, st.sampled_from(["box", "spike", "L"]))
def test_water_in_a_solid_takes_the_nearest_way_out(random, kind):
    """Exact, wherever the solid's corners lie on the grid; what is outside stays where it is, to the bit."""
    grid = Grid((12, 12), (0.1, 0.1), (False, False))
    (solid,) = SOLIDS[kind](2)
    x = np.clip(scattered(grid, random, 300), 1e-6, 1.2 - 1e-6)
    moved = x.copy()
    _core.leave_solids(grid.core, Outline.of(grid, [solid]), moved)
    area = solid.section((0.0, -1.0, 1.2, 1.2))
    if kind != "box":  # which goes on below the floor as in a mirror
        area = shapely.union(area, shapely.transform(area, lambda points: points * [1.0, -1.0]))
    depth = -signed_distance(area, *x.T)
    way = np.linalg.norm(moved - x, axis=1)
    np.testing.assert_allclose(way, np.maximum(depth, 0.0), atol=2e-10)
    assert np.array_equal(moved[depth < -1e-9], x[depth < -1e-9])
    assert np.abs(solid.distance(moved[depth > 0])).max(initial=0.0) < 2e-10


def test_a_solid_may_fill_the_tank():
    grid = Grid((4, 4), (0.1, 0.1), (False, False))
    x = np.array([[0.2, 0.2]])
    _core.leave_solids(grid.core, Outline.of(grid, [Box((0.0, 0.0), (0.4, 0.4))]), x)
    assert np.all((x > 0) & (x < 0.4))
    assert Outline.of(grid, []) is None and Outline.of(grid, [Box((0.5, 0.0), (0.6, 0.4))]) is None


# ---- the velocity that particles beside a solid interpolate ----------------------------------------------------------


def stopped(medium, u):
    u = [v.copy() for v in u]
    _core.stop_at_solids(medium.grid.core, medium.closed_faces, u)
    return u


@settings(max_examples=20, deadline=None)
@given(randoms, st.sampled_from(sorted(SOLIDS)), st.sampled_from([(2, False), (2, True), (3, False)]))
def test_velocity_at_solids_against_the_twin(random, kind, form):
    d, periodic = form[0], form[1] and kind != "boxes in a corner"
    grid = Grid((12, 12, 12)[:d], (0.1,) * d, (periodic,) + (False,) * (d - 1))
    medium = Medium.build(grid, solids=SOLIDS[kind](d))
    u = random_faces(grid, random)
    expected = reference.stop_at_solids(grid, medium.closed_faces, u)
    for found, twin in zip(stopped(medium, u), expected, strict=True):
        np.testing.assert_allclose(found, twin, rtol=0, atol=1e-12)


@pytest.mark.parametrize("face", [0.4, 0.43, 0.479])
def test_no_flow_through_an_upright_face_wherever_it_stands(face):
    """Water that runs at a wall as at a stagnation point is left as it is; other water is stopped, and only across."""
    grid = Grid((10, 10), (0.1, 0.1), (False, False))
    medium = Medium.build(grid, solids=[Box((0.0, 0.0), (face, 1.0))])
    stagnation = linear_faces(grid, np.array([face, -0.5]), np.array([[-1.0, 0.0], [0.0, 1.0]]))
    for before, after in zip(stagnation, stopped(medium, stagnation), strict=True):
        np.testing.assert_allclose(after[:, 1:-1], before[:, 1:-1], atol=1e-9)
    uniform = linear_faces(grid, np.array([-2.0, 1.0]), np.zeros((2, 2)))
    across, along = stopped(medium, uniform)
    closed = round(np.floor(face / 0.1 + 1e-9))
    assert np.all(across[closed, 1:-1] == pytest.approx(2.0 * (face - 0.1 * closed) / 0.1))
    assert np.all(across[closed + 1 :, 1:-1] == uniform[0][closed + 1 :, 1:-1])
    assert np.array_equal(along, uniform[1])


def test_water_slides_along_a_slope_as_before():
    grid = Grid((12, 12), (0.1, 0.1), (False, False))
    medium = Medium.build(grid, solids=[Polygon(shapely.Polygon([(0.0, 0.0), (1.2, 0.0), (1.2, 0.9)]), 2)])
    along = linear_faces(grid, np.array([0.8, 0.6]), np.zeros((2, 2)))
    inner = (slice(2, -2), slice(2, -2))
    for before, after in zip(along, stopped(medium, along), strict=True):
        np.testing.assert_allclose(after[inner], before[inner], atol=1e-9)
    assert sum(len(faces.face) for faces in medium.closed_faces) > 20
