"""Friction of walls: the twin, the law of smooth and rough walls, and the planes that stand for any outline."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import reference
from clouds import grids, in_order, lattice, randoms, scattered
from houle import _core
from houle.flow.seeding import seed
from houle.grid import FloatArray, Grid
from houle.medium.medium import Medium
from houle.medium.patches import Surfaces
from houle.medium.rough_walls import RoughWalls
from houle.medium.shapes import Box, Polygon, Shape

NU = 1e-6  # [m2/s]
H = 0.01  # [m] size of the cells of most tests


def rub(grid, walls, start, x, u, dt, *, volume=None, bulk=None, inertia=None, fill=None, nu=NU):
    """Velocities after friction, impulse of each plane, energy taken."""
    u, impulse = u.copy(), np.full((len(walls[3]), grid.dimension), 7.0)  # overwritten
    bulk = np.full(len(x), grid.cell_volume / 4) if bulk is None else bulk
    water = (bulk if volume is None else volume, bulk, inertia, grid.cells(1.0) if fill is None else fill)
    taken = _core.rub(grid.core, tuple(walls[:4]), start, x, *water, nu, dt, u, impulse)
    return u, impulse, taken


@settings(max_examples=30)
@given(grids(least=2, most=6), randoms)
def test_against_the_twin(grid, random):
    d, n = grid.dimension, 40
    x = scattered(grid, random, n)
    start = in_order(grid, x)[1]
    cell = np.flatnonzero(random.random(grid.shape).ravel() < 0.7)
    first = np.concatenate([[0], np.cumsum(random.integers(0, 3, len(cell)))]).astype(np.int64)
    normal = random.normal(size=(first[-1], d))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    middle = random.random((len(normal), d)) * grid.size
    roughness = random.choice([0.0, 1e-4, 0.3], len(normal))
    plane = np.column_stack([normal, (normal * middle).sum(axis=1), roughness])
    front = random.integers(0, grid.cells().size, len(normal))
    u, fill = (
        random.choice([1e-4, 1.0, 30.0], (n, 1)) * random.normal(size=(n, d)),
        random.uniform(-0.1, 1.2, grid.shape),
    )
    volume = random.uniform(0.1, 1.0, n)
    bulk = np.where(random.random(n) < 0.8, volume, 2.0 * volume)
    inertia = random.choice([1.0, 1.5], (n, d)).astype(np.float32) if random.random() < 0.5 else None
    nu = random.choice([0.0, 1e-6, 0.1])
    walls = (cell.astype(np.int64), first, front.astype(np.int64), plane)
    found = rub(grid, walls, start, x, u, 0.3, volume=volume, bulk=bulk, inertia=inertia, fill=fill, nu=nu)
    twin = reference.rub(grid, *walls, start, x, volume, bulk, inertia, fill, nu, 0.3, u)
    for one, other in zip(found, twin, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)


# ---- the law --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", [0.02, 0.3, -2.0, 20.0])
def test_a_smooth_wall(speed):
    """Above the sublayer v / v_* = ln(9.8 y v_*/nu) / 0.41, in it nu v / y."""
    y = 0.005
    shear = _core.wall_shear(speed, y, NU, 0.0)
    scale = np.sqrt(abs(shear))
    assert np.sign(shear) == np.sign(speed)
    if abs(speed) * y / NU > 133:
        assert abs(speed) / scale == pytest.approx(np.log(9.8 * y * scale / NU) / 0.41, rel=1e-9)
    else:
        assert shear == pytest.approx(NU * speed / y, rel=1e-12)


@pytest.mark.parametrize("share", [2e-3, 0.05, 0.5])
def test_a_rough_wall(share):
    """Where k_s v_*/nu > 1000, v / v_* = ln(30 y / k_s) / 0.41; viscosity does not matter, and there may be none."""
    y, speed = 0.05, 30.0
    scale = np.sqrt(_core.wall_shear(speed, y, NU, share * y))
    assert share * y * scale / NU > 80
    assert speed / scale == pytest.approx(np.log(30.0 / share) / 0.41, rel=0.01)
    inviscid = np.sqrt(_core.wall_shear(speed, y, 0.0, share * y))
    assert speed / inviscid == pytest.approx(np.log(30.0 / share) / 0.41, rel=1e-12)


def test_grains_below_the_sublayer_do_not_matter_and_grains_as_large_as_the_cell_have_a_limit():
    smooth = _core.wall_shear(0.3, 0.005, NU, 0.0)
    assert _core.wall_shear(0.3, 0.005, NU, 1e-6) == pytest.approx(smooth, rel=0.03)
    most = [_core.wall_shear(0.3, 0.005, NU, k) for k in (0.01, 0.02, 1.0)]
    np.testing.assert_allclose(most, (0.3 * 0.41 / np.log(15.0)) ** 2, rtol=0.01)
    assert _core.wall_shear(0.3, 0.005, 0.0, 0.0) == 0.0


@given(st.floats(1e-6, 50.0), st.floats(1e-4, 1.0), st.floats(1e-8, 1e-2), st.floats(0.0, 0.5))
def test_shear_grows_with_speed_and_roughness_without_a_jump(speed, y, nu, roughness):
    here = _core.wall_shear(speed, y, nu, roughness)
    beside = _core.wall_shear(1.0001 * speed, y, nu, roughness)
    assert here < beside < here * 1.0004
    if roughness + 1e-4 < 2.0 * y:
        assert here <= _core.wall_shear(speed, y, nu, roughness + 1e-4) * (1.0 + 1e-12)


# ---- planes ---------------------------------------------------------------------------------------------------------


def walls_of(grid: Grid, solids: list[Shape], roughness: list[float | None], sides: dict[str, float] | None = None):
    medium = Medium.build(grid, (), solids)
    surfaces = Surfaces(grid, medium.open_cells, (), medium.solids)
    return medium, RoughWalls.of(surfaces, roughness, sides or {})


def shear_on(grid: Grid, walls: RoughWalls, medium: Medium, u: FloatArray, weight) -> FloatArray:
    """Force over density (d,) on water of velocity u (d,), each particle with a weight that is a function of its place.

    It is divided by the shear of a wall in water of this velocity: the mean over the layer, of the share of each place.
    """
    water = seed(grid, medium, [Box((0.0,) * grid.dimension, grid.size)])
    x, start = in_order(grid, water.position)
    size = water.volume[np.lexsort(water.position.T)][np.argsort(np.lexsort(x.T))]
    before = np.broadcast_to(u, x.shape).copy()
    after, _, _ = rub(grid, walls, start, x, before, 1e-6, volume=size, bulk=size)
    lost = (weight(x) * size) @ (before - after) / 1e-6
    d = (np.arange(3000) + 0.5) * H / 2000
    shear = [_core.wall_shear(float(np.linalg.norm(u)), max(y, 0.5 * H), NU, 0.0) for y in d]
    return lost / (np.clip(1.5 - d / H, 0.0, 1.0) @ shear / 2000)


@pytest.mark.parametrize("off", [0.0, 0.003, 0.0071])
@pytest.mark.parametrize("angle", [0, 10, 30, 45, 63, 90, 117, 180, 240])
def test_the_shear_on_a_plane_is_that_of_its_area_wherever_it_stands(angle, off):
    """Water over a stretch of a plane is held by so much of it, wherever it cuts the cells: 1 % for the particles."""
    grid = Grid((40, 40), (H, H), (False, False))
    a = np.radians(angle)
    along, normal = np.array([np.cos(a), np.sin(a)]), np.array([-np.sin(a), np.cos(a)])
    foot = np.array([0.2, 0.2]) + off * normal
    corners = [foot - along, foot + along, foot + along - normal, foot - along - normal]
    solid = Polygon(shapely.Polygon(corners).intersection(shapely.box(0, 0, 0.4, 0.4)), 2)
    medium, walls = walls_of(grid, [solid], [0.0])

    def stretch(x: FloatArray) -> FloatArray:  # 1 in the middle, 0 from 0.17 m on: 0.24 m in all
        return np.clip((0.17 - np.abs((x - foot) @ along)) / 0.1, 0.0, 1.0)

    force = shear_on(grid, walls, medium, 0.5 * along, stretch)
    np.testing.assert_allclose(force / 0.24, along, atol=0.01)
    across = shear_on(grid, walls, medium, 0.5 * normal, stretch)
    assert np.abs(across).max() < 1e-12  # water that runs at the wall is no matter of friction


def test_a_side_of_the_tank_is_a_solid_with_the_same_face():
    """Planes of the bottom, and of a solid three cells high, to the last bit but for the three cells."""
    grid = Grid((6, 12), (H, H), (True, False))
    _, solid = walls_of(grid, [Box((-1.0, -1.0), (1.0, 3 * H))], [2e-3])
    _, side = walls_of(Grid((6, 9), (H, H), (True, False)), [], [], {"bottom": 2e-3})
    for cell, other, shape in ((solid.cell, side.cell, 9), (solid.front, side.front, 9)):
        at, there = np.divmod(cell, 12), np.divmod(other, shape)
        np.testing.assert_array_equal((at[0], at[1] - 3), there)
    np.testing.assert_allclose(solid.plane - [0.0, 0.0, 3 * H, 0.0], side.plane, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(solid.first, side.first)


def test_each_side_of_a_plate_has_its_own_plane_and_the_foot_of_a_wall_has_two():
    grid = Grid((20, 20), (H, H), (False, False))
    medium, walls = walls_of(grid, [Box((0.1, 0.0), (0.102, 0.3))], [0.0], {"bottom": 0.0})
    planes = dict(zip(walls.cell.tolist(), np.split(walls.plane, walls.first[1:-1]), strict=True))
    left, right = medium.solids[0].bounds
    for i, normal, at in ((int(left[0] / H) - 1, -1.0, left[0]), (round(right[0] / H), 1.0, right[0])):
        alone, foot = planes[i * 20 + 10], planes[i * 20]
        np.testing.assert_allclose(alone, [[normal, 0.0, normal * at, 0.0]], atol=1e-12)
        assert {tuple(np.round(p[:2])) for p in foot} == {(normal, 0.0), (0.0, 1.0)}
    assert right[0] - left[0] > 0.999 * H  # thickened (decision 0021)


def test_many_short_edges_are_one_long_one():
    """A bed of 200 points on a line holds the water as the line does."""
    grid = Grid((40, 20), (H, H), (False, False))
    x = np.linspace(0.0, 0.4, 200)
    bed = shapely.Polygon([(0.4, 0.0), (0.0, 0.0), *zip(x, 0.04 + 0.1 * x, strict=True)])
    line = shapely.Polygon([(0.4, 0.0), (0.0, 0.0), (0.0, 0.04), (0.4, 0.08)])
    _, many = walls_of(grid, [Polygon(bed, 2)], [0.0])
    _, one = walls_of(grid, [Polygon(line, 2)], [0.0])
    np.testing.assert_array_equal(many.cell, one.cell)
    np.testing.assert_allclose(many.plane, one.plane, atol=1e-9)


def _between(x: FloatArray, a: int, low: float, high: float) -> FloatArray:
    return ((x[:, a] > low) & (x[:, a] < high)).astype(float)


def test_in_3d_all_faces_of_a_box_rub():
    """A box of 8 x 6 x 8 cells in a stream along each axis: four faces each, with layers around the edges on top."""
    grid = Grid((16, 14, 16), (H, H, H), (False, False, False))
    low, high = np.array([4, 4, 4]) * H, np.array([12, 10, 12]) * H
    medium, walls = walls_of(grid, [Box(tuple(low), tuple(high))], [0.0])
    size = high - low
    for a in range(3):
        inner = partial(_between, a=a, low=low[a] + 2 * H, high=high[a] - 2 * H)
        force = shear_on(grid, walls, medium, 0.5 * np.eye(3)[a], inner)
        faces = 2.0 * (size.sum() - size[a]) * (size[a] - 4 * H)
        corners = 4 * 1.5 * H * (size[a] - 4 * H)  # length of a quarter circle times H at most
        assert faces * 0.999 < force[a] < faces + corners


def test_water_along_a_linear_profile_has_exactly_its_shear():
    """v = G d along a wall, constant over the last half cell as interpolated from faces: nu G."""
    grid = Grid((6, 6), (H, H), (True, False))
    _, walls = walls_of(grid, [], [], {"bottom": 0.0})
    x, start = in_order(grid, lattice(grid, 64))
    size = np.full(len(x), grid.cell_volume / 64**2)
    u = np.column_stack([3.0 * np.maximum(x[:, 1], 0.5 * H), 0.0 * x[:, 1]])
    after, impulse, _ = rub(grid, walls, start, x, u, 1e-6, volume=size, bulk=size, nu=0.01)
    lost = (size[:, None] * (u - after)).sum(axis=0) / (1e-6 * grid.size[0])
    np.testing.assert_allclose(lost, [0.03, 0.0], rtol=1e-3, atol=1e-15)
    np.testing.assert_allclose(impulse.sum(axis=0) / (1e-6 * grid.size[0]), lost, rtol=1e-12, atol=1e-18)


def test_a_thin_sheet_is_held_more():
    """The shear of the floor stops the water that there is, not a cell of it; a quarter of a cell counts at least."""
    grid = Grid((4, 6), (H, H), (True, False))
    _, walls = walls_of(grid, [], [], {"bottom": 0.0})
    x, start = in_order(grid, np.array([[0.02, 0.001]]))  # below the middle of any of the sheets

    def rate(fill: float) -> float:
        u = rub(grid, walls, start, x, np.array([[0.1, 0.0]]), 1e-9, fill=grid.cells(fill), nu=1e-3)[0][0, 0]
        return (0.1 - u) / 0.1 / 1e-9

    full = rate(1.0)
    assert full == pytest.approx(2.0 * 1e-3 / H**2, rel=1e-4)
    assert rate(0.5) == pytest.approx(4.0 * full, rel=1e-4)
    assert rate(0.1) == pytest.approx(16.0 * full, rel=1e-4)


@settings(max_examples=30)
@given(randoms, st.floats(1e-6, 1e6))
def test_friction_only_takes_energy_and_turns_no_velocity(random, dt):
    grid = Grid((12, 12), (H, 0.8 * H), (False, False))
    solid = Polygon(shapely.Polygon([(0.0, 0.0), (0.12, 0.0), (0.12, 0.05), (0.05, 0.03)]), 2)
    _, walls = walls_of(grid, [solid], [float(random.choice([0.0, 1e-3]))], {"left": 0.0, "bottom": 1e-4})
    x = scattered(grid, random, 300)
    start, u = in_order(grid, x)[1], random.normal(size=x.shape)
    bulk = random.uniform(0.1, 1.0, len(x))
    after, impulse, taken = rub(grid, walls, start, x, u, dt, bulk=bulk, fill=random.uniform(0, 1, grid.shape), nu=1e-3)
    lost = 0.5 * bulk @ (u**2 - after**2).sum(axis=1)
    assert taken >= 0.0 and taken == pytest.approx(lost, rel=1e-9, abs=1e-12)
    assert ((after**2).sum(axis=1) <= (u**2).sum(axis=1) * (1.0 + 1e-12)).all()
    one = np.repeat(np.diff(walls.first) == 1, np.diff(start)[walls.cell])
    mine = np.concatenate([np.arange(start[c], start[c + 1]) for c in walls.cell])[one]
    assert ((u * after).sum(axis=1)[mine] >= 0.0).all()
    np.testing.assert_allclose(impulse.sum(axis=0), bulk @ (u - after), rtol=1e-9, atol=1e-12)


def test_no_wall_that_rubs_is_none_nor_is_one_behind_a_solid():
    grid = Grid((6, 6), (H, H), (False, False))
    covered = [Box((-1.0, -1.0), (1.0, 0.02))]
    assert walls_of(grid, covered, [None], {"bottom": 0.0})[1] is None
    assert walls_of(grid, [Box((0.0, 0.0), (0.02, 0.02))], [None])[1] is None
