"""The free surface: exact level from the fill of cells and from the volume of columns, and what is under water."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import reference
from clouds import grids, numbered, randoms, scattered, start_of
from houle import _core
from houle.flow.correction import portion
from houle.flow.particles import Particles
from houle.flow.seeding import seed
from houle.flow.state import Flow
from houle.flow.surface import find_surface, sort
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box, Polygon

levels = st.floats(0.05, 7.5)  # cells, in a tank of 8
FLAT = (6, 8)


def below(level, d=2):
    return Box((-np.inf,) * d, (*[np.inf] * (d - 1), level))


def find(grid, fill, height=None, open_cells=None):
    """(depth, active, column, eta) from given fills and column heights [m]; without heights no column has a level."""
    depth, active = grid.cells(), np.zeros(grid.shape, np.uint8)
    column, eta = np.zeros(grid.shape[:-1]), np.zeros(grid.shape[:-1])
    height = np.full(grid.shape[:-1], np.nan) if height is None else height
    open_cells = grid.cells(1.0) if open_cells is None else open_cells
    _core.find_surface(grid.core, fill, numbered(open_cells), height, depth, active, column, eta)
    return depth, active, column, eta


def flow_of(grid, particles, bodies=(), solids=()):
    """The flow after it has looked for its surface."""
    flow = Flow(grid, Medium.build(grid, bodies, solids), particles, gravity=(0.0,) * grid.dimension)
    flow.sample_medium()
    sort(flow)
    find_surface(flow)
    return flow


def at_rest(grid, level, bodies=(), solids=()):
    return flow_of(grid, seed(grid, Medium.build(grid, bodies, solids), [below(level, grid.dimension)]), bodies, solids)


def fills(grid, level):
    """Tent-smoothed fill of a tank filled to a level [cells]: what the particles of full water sum up to."""
    column = [reference.fill_of_depth(level - (k + 0.5)) for k in range(grid.shape[-1])]
    column[0] += reference.fill_of_depth(level + 0.5) - 1.0 if level < 0.5 else 0.0  # folded back at the floor
    return np.broadcast_to(column, grid.shape).copy()


@given(st.floats(0.5, 7.4))
def test_flat_surface_is_exact_from_the_fill_of_the_cells(level):
    """The depth inverts the tent-smoothed fill: without columns, at any level the surface is where the water ends."""
    grid = Grid(FLAT, (0.7, 0.3), (False, False))
    depth, active, _, eta = find(grid, fills(grid, level))
    np.testing.assert_allclose(eta, 0.3 * level, rtol=0, atol=1e-7)  # sqrt(2(1-F)) magnifies round-off near F = 1
    under = level - (np.arange(8) + 0.5)
    np.testing.assert_allclose(depth[2], np.clip(under, -1.0, 1.0), rtol=0, atol=1e-7)
    sure = np.abs(under) > 1e-7
    assert np.array_equal(active[:, sure], np.broadcast_to(under > 0, FLAT)[:, sure])


@pytest.mark.parametrize("d", [2, 3])
@settings(max_examples=30)
@given(level=levels)
def test_flat_surface_is_exact_from_the_columns(d, level):
    """From a film of a twentieth of a cell up: level = volume / area, to round-off."""
    grid = Grid(FLAT if d == 2 else (6, 5, 8), (0.7, 0.3) if d == 2 else (0.7, 0.5, 0.3), (False,) * d)
    flow = at_rest(grid, 0.3 * level)
    np.testing.assert_allclose(flow.eta, 0.3 * level, rtol=0, atol=1e-12)
    under = level - (np.arange(8) + 0.5)
    sure = np.abs(under) > 1e-9
    assert np.array_equal(flow.active[..., sure], np.broadcast_to(under > 0, grid.shape)[..., sure])
    np.testing.assert_allclose(flow.submergence, np.broadcast_to(under, grid.shape), rtol=0, atol=1e-10)


@pytest.mark.parametrize("body", ["bed", "block", "slope"])
def test_flat_surface_is_exact_in_and_beside_a_porous_body(body):
    """Over a bed, beside a block whose faces lie on the grid or not, and where a slope crosses the surface."""
    grid = Grid((20, 16), (0.5, 0.5), (False, False))
    shape = {
        "bed": below(2.15),
        "block": Box((3.1, -1.0), (6.0, 20.0)),
        "slope": Polygon(shapely.Polygon([(1.03, 0.0), (9.0, 0.0), (5.0, 4.2)]), 2),
    }[body]
    for level in (2.15, 3.3, 5.02):
        flow = at_rest(grid, level, [PorousBody(body, shape, 0.4)])
        np.testing.assert_allclose(flow.eta, level, rtol=0, atol=1e-10)


@given(st.floats(0.2, 7.0), st.floats(-0.15, 0.15))
def test_volume_under_the_surface_is_the_volume_of_the_water(level, slope):
    """A gentle slope: the column levels times the plan area are the particles' volume, to round-off."""
    grid = Grid((9, 8), (0.5, 0.5), (False, False))
    x = (np.arange(18) + 0.5) / 4
    bottom = np.arange(16) / 4
    heights = np.maximum(0.5 * level + slope * (x - x.mean()), 1e-3)
    volume = 0.25 * np.clip(heights[:, None] - bottom, 0.0, 0.25)
    held = volume > 0
    position = np.stack(np.broadcast_arrays(x[:, None], bottom + 2 * volume), axis=-1)[held]
    flow = flow_of(grid, Particles(position, np.zeros_like(position), volume[held]))
    if np.isfinite(flow.eta).all() and np.isfinite(flow.single_level).all():
        assert 0.5 * flow.eta.sum() == pytest.approx(volume.sum(), rel=1e-12)
    assert np.isfinite(flow.single_level).all()


@given(grids(), randoms, st.integers(-1, 9))
def test_water_above_a_row_of_cells(grid, random, row):
    fill = np.where(random.random(grid.shape) < 0.1, 1e-300, 0.0)
    assert _core.water_above(grid.core, fill, row) == fill[..., max(row, 0) :].any()


@settings(max_examples=40)
@given(grids(), randoms)
def test_column_heights_against_the_twin(grid, random):
    x, volume, height = scattered(grid, random, 50), random.random(50), np.zeros(grid.shape[:-1])
    _core.column_heights(grid.core, start_of(grid, x), x, volume, height)
    np.testing.assert_allclose(height, reference.column_heights(grid, x, volume), rtol=0, atol=1e-12)
    assert height.sum() * grid.cell_volume / grid.spacing[-1] == pytest.approx(volume.sum(), rel=1e-13)


@given(st.floats(1e-6, 0.4))
def test_a_rise_of_any_size_is_seen(rise):
    """A tenth of the columns a little higher: by the volume added, however small it is beside a cell."""
    grid = Grid((20, 8), (1.0, 1.0), (False, False))
    low, high = at_rest(grid, 4.3), at_rest(grid, 4.3)
    inside = (high.particles.position[:, 0] > 8) & (high.particles.position[:, 0] < 12)
    top = inside & (high.particles.position[:, 1] > 4.0)
    high.particles.volume[top] *= 1.0 + rise / 0.3
    high.volume = high.particles.volume
    find_surface(high)
    assert (high.eta - low.eta).sum() == pytest.approx(4 * rise, rel=1e-9, abs=1e-12)
    assert (high.eta - low.eta).max() == pytest.approx(rise, rel=1e-9, abs=1e-12)
    assert (high.eta - low.eta).min() > -1e-12


def test_a_wall_of_water_is_placed_by_its_cells():
    """Steeper than 45 degrees a column is no guide: cells beside the drop take their depth from their own fill."""
    grid = Grid((8, 8), (1.0, 1.0), (False, False))
    medium = Medium.build(grid)
    flow = flow_of(grid, seed(grid, medium, [Box((0.0, 0.0), (4.0, 6.0))]))
    assert np.array_equal(flow.active, np.broadcast_to(np.arange(8)[:, None] < 4, (8, 8)) & (np.arange(8) < 6))
    np.testing.assert_allclose(flow.eta[:3], 6.0, atol=1e-9)
    assert np.isnan(flow.eta[5:]).all()
    np.testing.assert_allclose(flow.submergence[3, 2], 0.5)  # the front stands on the face, half a cell away
    np.testing.assert_allclose(flow.submergence[4, 2], -0.5)


def test_trapped_air_of_two_cells_is_looked_through_and_a_drop_high_above_is_not_the_surface():
    grid = Grid((1, 12), (1.0, 0.5), (True, False))
    fill = grid.cells()
    fill[0, :8] = 1.0
    fill[0, 3:5] = 0.0
    assert find(grid, fill)[3][0] == pytest.approx(4.0)
    fill[0, 3:6] = 0.0
    assert find(grid, fill)[3][0] == pytest.approx(1.5)


def test_solid_cells_hold_no_pressure_and_ground_raises_the_level():
    """A closed step of two cells under water at 4.4: dry inside, and the column's level counts from the ground."""
    grid = Grid((12, 8), (1.0, 1.0), (False, False))
    flow = at_rest(grid, 4.4, solids=[Box((-1.0, -1.0), (5.0, 2.0))])
    assert not flow.active[:5, :2].any()
    assert flow.active[:, 2:4].all()
    assert flow.active[6:, :4].all()
    np.testing.assert_allclose(flow.eta[[0, 1, 2, 8, 9, 10, 11]], 4.4, atol=1e-9)


def test_dry_columns_have_no_level():
    grid = Grid((5, 4, 6), (1.0, 1.0, 1.0), (False, False, False))
    _, active, _, eta = find(grid, grid.cells())
    assert np.isnan(eta).all() and not active.any()


@settings(max_examples=40, deadline=None)
@given(grid=grids(most=7), random=randoms)
def test_the_water_that_columns_hold_is_the_reference(grid, random):
    """Any cells under water and closed, any fills, bubbles too, beside walls and periodic sides; 2D and 3D. Closed
    cells, whose tents reach into the water, hold a little.
    """
    dry, closed = (random.random(grid.shape) < share for share in random.random(2) ** 2)
    active, open_cells = (~dry & ~closed).astype(np.uint8), (~closed).astype(float)
    fill = 1.05 - 0.35 * random.random(grid.shape) ** 4
    inverse = np.where(closed, random.choice([0.0, 9.0], grid.shape), random.uniform(1.0, 2.0, grid.shape))
    height = random.random(grid.shape[:-1])
    columns = np.flatnonzero(random.random(grid.shape[:-1]) < 0.5)
    held = np.full(len(columns), np.nan)
    _core.water_held(grid.core, active, numbered(open_cells), fill, inverse, height, columns, held)
    expected = reference.water_held(grid, active, open_cells, fill, inverse, height)
    np.testing.assert_allclose(held, expected.ravel()[columns], rtol=1e-13)


@pytest.mark.parametrize("step", [0.5, 2.0])
@pytest.mark.parametrize("excess", [-0.1, 0.1])
def test_the_correction_spreads_deficit_and_excess_alike_under_gentle_and_steep_surfaces(step, excess):
    """A cell with water all around it, in columns each filled to one level, half a cell or two lower from one to the
    next. Beside air a deficit is the surface.
    """
    grid = Grid((4, 12), (1.0, 1.0), (False, False))
    height = 9.25 - step * np.arange(4)
    fill = np.clip(height[:, None] - np.arange(12), 0.0, 1.0)
    fill[1, 2] += excess
    depth, active, column, eta = find(grid, fill, height)
    assert not np.isnan(column).any()
    assert (eta == column).all() == (step < 1.0)
    rhs = grid.cells()
    arrays = (active, depth, column, eta, fill, numbered(grid.cells(1.0)))
    largest = _core.density_excess(grid.core, *arrays, None, 0.5, rhs)
    assert rhs[1, 2] == pytest.approx(0.5 * excess) and largest == pytest.approx(0.05)
    rhs[1, 2] = 0.0
    assert not rhs.any()


@pytest.mark.parametrize("d", [2, 3])
def test_the_correction_fills_holes_that_no_flat_surface_leaves(d):
    """Air that a cell touches at an edge or a corner only: no more than 1/24 (2D) or 29/360 (3D) of its tent can be
    above a flat surface. What lacks the place of a particle is filled to that. Across a face a deficit is the surface.
    """
    corner = {2: 1 / 24, 3: 29 / 360}[d]
    t = (np.arange(60) + 0.5) / 30 - 1.0
    tent = (1.0 - np.abs(t)) / 30
    at = np.stack(np.meshgrid(*[t] * d, indexing="ij"), axis=-1)
    weight = np.prod(np.stack(np.meshgrid(*[tent] * d, indexing="ij")), axis=0)
    normals = np.vstack([np.eye(d), np.ones(d), np.random.default_rng(1).random((30, d))])
    above = [weight[at @ n > n.max()].sum() for n in normals]
    assert max(above) == pytest.approx(corner, rel=0.1) and max(above) == above[d]

    grid = Grid((5,) * d, (1.0,) * d, (False,) * d)
    active, fill, rhs = np.ones(grid.shape, np.uint8), grid.cells(1.0), grid.cells()
    none = np.full(grid.shape[:-1], np.nan)
    active[(3,) * d] = 0
    middle, beside = (2,) * d, (2, *(3,) * (d - 1))
    place = 0.5**d
    for cell, missing, right in (
        (middle, 1.1 * place, 1.1 * place - corner),
        (middle, 0.9 * place, 0.0),
        (beside, 0.4, 0.0),
    ):
        fill[...] = 1.0
        fill[cell] -= missing
        _core.density_excess(
            grid.core, active, grid.cells(), none, none, fill, numbered(grid.cells(1.0)), None, 0.5, rhs
        )
        assert rhs[cell] == pytest.approx(-0.5 * right, abs=1e-15)
        rhs[cell] = 0.0
        assert not rhs.any()


def test_a_step_corrects_as_much_as_its_quarters_of_a_cell():
    assert portion(0.5, 0.05) == pytest.approx(0.1) and portion(0.5, 0.25) == pytest.approx(0.5)
    for quarters in (2, 3):
        assert 1.0 - portion(0.3, 0.25 * quarters) == pytest.approx((1.0 - portion(0.3, 0.25)) ** quarters)
    assert portion(0.0, 0.5) == 0.0 and portion(1.0, 0.5) == 1.0
