"""Level of columns that interfaces or solids cross: exact at rest, monotone, never outside the tank."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from houle import _core
from houle.flow.seeding import seed
from houle.grid import Grid
from houle.medium.columns import Capacity
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box, Polygon

TOP = 4.0  # m
levels = st.floats(0.15, TOP)


def polygon(corners, d=2):
    return Polygon(shapely.Polygon(corners), d)


SLOPES = {
    "mound": polygon([(1.03, 0.0), (9.0, 0.0), (5.0, 4.2)]),
    "overhang": polygon([(2.1, 0.0), (3.7, 0.0), (8.3, 4.0), (6.9, 4.0)]),
    "berm": polygon([(2.0, 0.0), (9.7, 0.0), (7.31, 2.15), (5.02, 2.15), (3.4, 3.9)]),
    "bed": Box((-np.inf, -np.inf), (np.inf, 1.37)),
    "block": Box((3.1, -1.0), (6.05, 2.9)),
}


def water_of(grid, particles):
    """Sums with the tents of the cells (m^d)."""
    order, cell = np.zeros(len(particles), np.int32), np.zeros(len(particles), np.int32)
    start, water = np.zeros(np.prod(grid.shape) + 1, np.int32), grid.cells()
    _core.cell_sort(grid.core, particles.position, cell, order, start)
    _core.scatter_cells(grid.core, start, particles.position[order], particles.volume[order], water)
    return water


def levels_of(grid, medium, water):
    """Levels [m] of the mixed columns."""
    mixed, level = Capacity.of(grid, medium), np.full(grid.shape[:-1], np.nan)
    capacity = water_of(grid, seed(grid, medium, [Box((0.0,) * grid.dimension, grid.size)]))
    inverse = np.divide(1.0, capacity, out=grid.cells(), where=capacity > 1e-9 * grid.cell_volume)
    height, porosity = np.full(level.shape, 0.3), np.full(level.shape, 0.4)  # of the uniform columns
    pieces = (mixed.column, mixed.start, mixed.pieces)
    _core.column_levels(grid.core, height, porosity, water * inverse, inverse, *pieces, level)
    assert (np.delete(level, mixed.column) == 0.3 / 0.4).all()
    return level.ravel()[mixed.column]


def at_rest(grid, medium, level):
    d = grid.dimension
    return levels_of(
        grid, medium, water_of(grid, seed(grid, medium, [Box((-np.inf,) * d, (*[np.inf] * (d - 1), level))]))
    )


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("name", SLOPES)
@settings(max_examples=25)
@given(level=levels, porosity=st.floats(0.2, 0.9))
def test_flat_water_has_one_level_whatever_slopes_cross_it(name, periodic, level, porosity):
    """Seeds of a flat level: that level to round-off in every column, in cells that surface and slope share too."""
    grid = Grid((20, 16), (0.5, 0.25), (periodic, False))
    found = at_rest(grid, Medium.build(grid, [PorousBody(name, SLOPES[name], porosity)]), level)
    assert len(found) >= 10
    np.testing.assert_allclose(found, level, rtol=0, atol=1e-11)


@pytest.mark.parametrize("corners", [False, True])
@settings(max_examples=10)
@given(level=levels)
def test_flat_water_in_three_dimensions(corners, level):
    """A mound and a solid box on the lattice, exact; upright edges off it leave the term in x y: 3e-3 cells."""
    grid = Grid((10, 6, 8), (1.0, 0.5, 0.5), (False, False, False))
    bodies = [PorousBody("mound", polygon([(1.03, 0.0), (9.0, 0.0), (5.0, 4.2)], 3), 0.4)]
    if corners:
        bodies.append(PorousBody("block", Box((2.2, 0.63, 0.0), (5.1, 1.81, 3.3)), 0.7))
    found = at_rest(grid, Medium.build(grid, bodies, [Box((7.0, 1.0, 0.0), (9.0, 2.0, 0.5))]), level)
    assert len(found) == 60
    ground = 0.5 if level < 0.5 else 0.0  # dry on top of the box
    error = np.maximum(found, ground) - max(level, ground)
    np.testing.assert_allclose(error, 0.0, rtol=0, atol=5e-3 * 0.5 if corners else 1e-11)


@given(st.lists(st.floats(0.0, 1.2), min_size=2, max_size=2), st.sampled_from(sorted(SLOPES)))
def test_more_water_stands_higher_and_never_outside_the_tank(shares, name):
    """Any share of the flood, more than all of it too; the capacity at the level found is the water."""
    grid = Grid((20, 16), (0.5, 0.25), (False, False))
    medium = Medium.build(grid, [PorousBody("a", SLOPES[name], 0.3)], [polygon([(4.0, 0.0), (6.0, 0.0), (5.1, 2.7)])])
    flood = water_of(grid, seed(grid, medium, [Box((0.0, 0.0), (10.0, TOP))]))
    low, high = (levels_of(grid, medium, share * flood) for share in sorted(shares))
    assert (low >= 0.0).all() and (high <= TOP).all()
    assert (high >= low).all()
    if max(shares) >= 1.01:
        np.testing.assert_allclose(high, TOP, rtol=1e-12)


def test_capacity_of_a_slope_by_hand():
    """A slope of 45 degrees through the middle of a column: where its section changes, and the water up to there."""
    grid = Grid((8, 8), (1.0, 1.0), (False, False))
    medium = Medium.build(grid, [PorousBody("slope", polygon([(0.0, 0.0), (8.0, 0.0), (8.0, 8.0)]), 0.5)])
    mixed = Capacity.of(grid, medium)
    i = int(np.flatnonzero(mixed.column == 4)[0])
    pieces = mixed.pieces[mixed.start[i] : mixed.start[i + 1]]
    np.testing.assert_allclose(pieces[:, 0], [0.0, 3.5, 4.5, 5.5, 8.0], atol=1e-12)  # the kinks of its tent
    np.testing.assert_allclose(pieces[:, 1], np.array([0.0, 1.75, 2.25 + 1 / 12, 3.25, 5.75]), atol=1e-12)


def test_a_column_that_is_nearly_solid_is_not_filled_beyond_the_tank():
    """What cut cells gave: a slit of a thousandth of the column, with all the water of its neighbours in the tent."""
    grid = Grid((8, 6, 8), (0.5, 0.5, 0.5), (False, False, False))
    medium = Medium.build(grid, [], [Box((1.001, 0.0, 0.0), (2.499, 3.0, 3.3))])
    water = np.full(grid.shape, grid.cell_volume)
    found = levels_of(grid, medium, water)
    assert (found >= 0.0).all() and (found <= TOP).all()


def test_particles_that_crowd_deep_under_the_surface_raise_no_level():
    """A tenth more in the cells by the floor: the same levels. Water added at the surface: more."""
    grid = Grid((8, 16), (0.5, 0.25), (False, False))
    medium = Medium.build(grid, [PorousBody("block", SLOPES["block"], 0.4)])
    water = water_of(grid, seed(grid, medium, [Box((0.0, 0.0), (4.0, 3.1))]))
    still, crowded, more = levels_of(grid, medium, water), water.copy(), water.copy()
    crowded[:, :9] *= 1.1
    more[:, 12] *= 1.1
    np.testing.assert_allclose(still, 3.1, atol=1e-11)
    np.testing.assert_allclose(levels_of(grid, medium, crowded), still, atol=1e-11)
    assert (levels_of(grid, medium, more) > still + 0.005).all()
