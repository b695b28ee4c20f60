"""The first particles hold exactly the water of the case, at its centre of gravity, and fill submerged cells to one."""

from itertools import product

import numpy as np
import pytest
import shapely

import reference
from clouds import lattice
from houle.flow.particles import Particles
from houle.flow.seeding import SLIVER, Settled, seed
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box, Polygon, Shape

ROUND_OFF = 1e-12
BEADS = 0.39


def below(level: float, dimension: int = 2) -> Box:
    return Box((-np.inf,) * dimension, (*[np.inf] * (dimension - 1), level))


def corners(*points: tuple[float, float], dimension: int = 2) -> Polygon:
    return Polygon(shapely.Polygon(points), dimension)


def fill_fraction(grid: Grid, particles: Particles, medium: Medium) -> np.ndarray:
    """F_c = sum_p V_p tent(x_p - x_c) / (cell volume * tent_porosity_c): multilinear weights, folded or wrapped."""
    tent_porosity = np.maximum(reference.tent_porosity(grid, medium.bodies, medium.solids), 1e-9)
    cells, weights = [], []
    for x, h, n, wrap in zip(particles.position.T, grid.spacing, grid.shape, grid.periodic, strict=True):
        left = np.floor(x / h - 0.5).astype(int)
        right_weight = x / h - 0.5 - left
        pair = np.stack([left, left + 1])
        cells.append(pair % n if wrap else np.clip(pair, 0, n - 1))
        weights.append(np.stack([1 - right_weight, right_weight]))
    fill = np.zeros(grid.shape)
    for corner in product((0, 1), repeat=grid.dimension):
        weight = np.prod([w[c] for w, c in zip(weights, corner, strict=True)], axis=0)
        np.add.at(fill, tuple(i[c] for i, c in zip(cells, corner, strict=True)), particles.volume * weight)
    return fill / (grid.cell_volume * tent_porosity)


def first_moment(particles: Particles) -> np.ndarray:
    return particles.volume @ particles.position


def test_a_full_box_gets_the_lattice_with_equal_volumes_at_rest():
    grid = Grid((9, 6), (0.1, 0.15), (False, False))
    particles = seed(grid, Medium.build(grid), [below(0.6)])
    places = lattice(grid)
    places = places[places[:, 1] < 0.6]
    order = np.lexsort(particles.position.T), np.lexsort(places.T)
    assert particles.position[order[0]] == pytest.approx(places[order[1]], abs=ROUND_OFF)
    assert particles.volume == pytest.approx(0.1 * 0.15 / 4, rel=ROUND_OFF)
    assert particles.velocity.shape == particles.position.shape and not particles.velocity.any()


@pytest.mark.parametrize("level", [0.35, 0.2034, 0.3001, 0.2999, 0.0123, 0.58])
@pytest.mark.parametrize("dimension", [2, 3])
def test_volume_and_level_of_a_tank_are_exact_wherever_the_level_lies(level, dimension):
    grid = Grid.fit((0.892, 0.2, 0.58) if dimension == 3 else (0.892, 0.58), 0.02)
    particles = seed(grid, Medium.build(grid), [below(level, dimension)])
    floor = np.prod(grid.size[:-1])
    assert particles.total_volume / floor == pytest.approx(level, abs=ROUND_OFF)
    assert first_moment(particles)[-1] / floor == pytest.approx(level**2 / 2, abs=ROUND_OFF)
    columns = np.bincount((particles.position[:, 0] / grid.spacing[0]).astype(int), particles.volume)
    assert columns == pytest.approx(particles.total_volume / grid.shape[0], rel=1e-11)


@pytest.mark.parametrize("spacing", [0.01, 0.005])
def test_a_dam_break_holds_the_water_of_its_reservoir_and_film(spacing):
    """Reservoir, film (counted once) and the film's share of the pores."""
    grid = Grid.fit((0.892, 0.58), spacing)
    medium = Medium.build(grid, [PorousBody("dam", Box((0.30, 0.0), (0.59, 0.37)), 0.49)])
    particles = seed(grid, medium, [Box((0.0, 0.0), (0.29, 0.35)), below(0.025)])
    exact = 0.29 * 0.35 + (0.892 - 0.29) * 0.025 - (1 - 0.49) * 0.29 * 0.025
    assert particles.total_volume == pytest.approx(exact, rel=ROUND_OFF)


def test_sloping_water_over_a_sloping_bed_is_exact():
    grid = Grid.fit((1.0, 0.6), 0.02)
    bed, water = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.27)], [(0.0, 0.0), (1.0, 0.0), (1.0, 0.31), (0.0, 0.43)]
    particles = seed(grid, Medium.build(grid, solids=[corners(*bed)]), [corners(*water)])
    wet = shapely.Polygon(water).difference(shapely.Polygon(bed))
    assert particles.total_volume == pytest.approx(wet.area, rel=ROUND_OFF)
    assert first_moment(particles) == pytest.approx(shapely.get_coordinates(wet.centroid)[0] * wet.area, rel=1e-11)


def test_overlapping_boxes_of_water_in_3d_count_once():
    grid = Grid.fit((1.0, 0.5, 0.5), 0.05)
    block = PorousBody("block", Box((0.42, 0.13, 0.0), (0.81, 0.5, 0.3)), BEADS)
    particles = seed(grid, Medium.build(grid, [block]), [Box((0.0, 0.0, 0.0), (0.47, 0.33, 0.4)), below(0.07, 3)])
    free = 0.47 * 0.33 * 0.4 + 1.0 * 0.5 * 0.07 - 0.47 * 0.33 * 0.07
    in_block = 0.05 * 0.20 * 0.3 + 0.39 * 0.37 * 0.07 - 0.05 * 0.20 * 0.07
    assert particles.total_volume == pytest.approx(free - (1 - BEADS) * in_block, rel=ROUND_OFF)


def test_no_particle_is_a_sliver_but_a_thin_film_is_kept():
    grid = Grid((20, 10), (0.1, 0.1), (False, False))
    medium = Medium.build(grid)
    half = grid.cell_volume / 4
    tank = seed(grid, medium, [Box((0.0, 0.0), (1.005, 0.51)), corners((0.0, 0.5), (1.0, 0.5), (0.0, 0.83))])
    assert tank.volume.min() >= SLIVER * half
    film = seed(grid, medium, [below(0.004)])
    assert film.total_volume == pytest.approx(2.0 * 0.004, rel=ROUND_OFF)
    assert film.position[:, 1] == pytest.approx(0.002)


def test_a_domain_without_water_has_no_particles():
    grid = Grid((4, 3, 2), (0.1, 0.1, 0.1), (False,) * 3)
    dry = seed(grid, Medium.build(grid), [])
    assert len(dry) == 0 and dry.position.shape == dry.velocity.shape == (0, 3)


SUBMERGED = [
    ("dam on grid lines", Box((0.3, 0.0), (0.6, 0.8)), 1e-11),
    ("dam through cell centres", Box((0.305, 0.0), (0.605, 0.8)), 1e-11),
    ("dam off the lattice", Box((0.3013, 0.0), (0.5871, 0.8)), 1e-11),
    ("bed off the lattice", Box((0.0, 0.0), (0.9, 0.2034)), 1e-11),
    ("corner off the lattice", Box((0.3013, 0.0), (0.5871, 0.3017)), 5e-3),
    ("45 degrees, through grid nodes", corners((0.2, 0.0), (0.6, 0.4), (0.9, 0.4), (0.9, 0.0)), 5e-3),
    ("45 degrees, through particles", corners((0.2025, 0.0), (0.6025, 0.4), (0.9, 0.4), (0.9, 0.0)), 5e-3),
    ("30 degrees", corners((0.2, 0.0), (0.6, 0.231), (0.9, 0.4), (0.9, 0.0)), 5e-3),
]


@pytest.mark.parametrize(("body", "limit"), [case[1:] for case in SUBMERGED], ids=[case[0] for case in SUBMERGED])
@pytest.mark.parametrize("spacing", [0.01, 0.0075])
def test_submerged_cells_are_full_across_porous_interfaces(body: Shape, limit: float, spacing: float):
    """Exact if the interface lies along an axis. Else each half cell misses the covariance c of x and z in its water.

    The tent's x z coefficient is 1/4 per half cell (sides 1): 8 half cells at most are cut, 1/4 of a cell each, and
    |c| <= 0.01 (1 - n): below 0.005 of a cell; relative to the mean porosity about twice that at the very worst.
    """
    grid = Grid.fit((0.9, 0.48), spacing)
    medium = Medium.build(grid, [PorousBody("beads", body, BEADS)])
    fill = fill_fraction(grid, seed(grid, medium, [below(0.4534)]), medium)
    assert np.abs(fill[:, : int(0.4534 / spacing - 1.5)] - 1).max() < limit


def test_submerged_cells_are_full_in_3d_and_across_a_periodic_side():
    grid = Grid((9, 6, 8), (0.1, 0.1, 0.1), (True, False, False))
    block = PorousBody("block", Box((0.0, 0.0, 0.0), (0.43, 0.6, 0.51)), BEADS)
    medium = Medium.build(grid, [block])
    fill = fill_fraction(grid, seed(grid, medium, [below(0.77, 3)]), medium)
    assert np.abs(fill[:, :, :6] - 1).max() < 5e-3
    assert np.abs(fill[:, :, :4] - 1).max() < 1e-11  # below the top edges of the block: interfaces along axes only


def test_cells_cut_by_a_sloping_solid_are_full():
    grid = Grid.fit((0.9, 0.5), 0.01)
    medium = Medium.build(grid, solids=[corners((0.0, 0.0), (0.6, 0.0), (0.1, 0.5), (0.0, 0.5))])
    particles = seed(grid, medium, [below(0.4534)])
    cells = tuple(np.floor(particles.position / grid.spacing).astype(int).T)
    assert np.all(medium.open_cells[cells] > 0)
    fill = fill_fraction(grid, particles, medium)
    wet = medium.open_cells[:, :43] > 0
    assert np.abs(fill[:, :43] - 1)[wet].max() < 0.02


def test_the_fill_of_the_cells_at_the_surface_gives_the_level_back():
    """The tent-smoothed fill of a flat surface at height d (in cells) above a centre is 1 - (1 - d)^2 / 2 for d > 0."""
    grid = Grid.fit((0.9, 0.5), 0.01)
    medium = Medium.build(grid, [PorousBody("beads", Box((0.3, 0.0), (0.6, 0.5)), BEADS)])
    for level, moved in ((0.4534, 0.0), (0.4571, 0.0), (0.4549, 0.0), (0.4557, SLIVER / 2)):
        fill = fill_fraction(grid, seed(grid, medium, [below(level)]), medium)
        depth = level / 0.01 - 45.5
        exact = 1 - (1 - depth) ** 2 / 2 if depth > 0 else (1 + depth) ** 2 / 2
        assert fill[:, 45] == pytest.approx(exact, abs=max(moved**2, 1e-11))  # a sliver, seen from below the centre
        assert np.ptp(fill[:, 45]) < 1e-11


UPRIGHT = {  # what water lies in of a tank of 1.1 x 0.5 [x 0.4] m
    "2D": ((1.1, 0.5), 0.43, [below(0.4534)], 0),
    "2D, another level on each side": (
        (1.1, 0.5),
        0.43,
        [Box((0.0, 0.0), (0.43, 0.4)), Box((0.43, 0.0), (1.1, 0.2))],
        0,
    ),
    "2D, dry pores": ((1.1, 0.5), 0.43, [Box((0.0, 0.0), (0.43, 0.41))], 0),
    "2D, on grid lines": ((1.1, 0.5), 0.42, [below(0.4534)], 0),
    "2D, at a wall": ((1.1, 0.5), 0.0, [below(0.4534)], 0),
    "3D, along x": ((1.1, 0.4, 0.5), 0.43, [below(0.4534, 3)], 0),
    "3D, along y": ((0.4, 1.1, 0.5), 0.43, [below(0.4534, 3)], 1),
}


@pytest.mark.parametrize("name", UPRIGHT)
def test_beside_upright_interfaces_water_lies_as_flow_leaves_it(name: str):
    """As much as there is, with its centre, tents as full; and where it is full, with the porosity of the particles."""
    size, edge, water, axis = UPRIGHT[name]
    grid = Grid.fit(size, 0.02)
    low, high = np.zeros(len(size)), np.array(size)
    low[axis], high[axis] = edge, min(edge + 0.4, 1.1)
    medium = Medium.build(grid, [PorousBody("rock", Box(tuple(low), tuple(high)), 0.45)])
    particles, settled = seed(grid, medium, water), Settled.of(grid, medium)
    assert settled is not None and settled.axis == axis
    parts = []  # volume and centre of the water, and of what the grains take of it
    for gain, least, most in ((1.0, np.zeros(len(size)), np.array(size)), (-0.55, low, high)):
        for box in water:
            lower, upper = np.maximum(least, box.lower), np.minimum(most, box.upper)
            parts.append((gain * np.prod(np.maximum(upper - lower, 0.0)), 0.5 * (lower + upper)))
    assert particles.volume.sum() == pytest.approx(sum(v for v, _ in parts), rel=ROUND_OFF)
    moment = sum(v * x for v, x in parts)
    across = np.arange(len(size)) != axis
    assert first_moment(particles)[across] == pytest.approx(moment[across], rel=ROUND_OFF)
    assert np.all((particles.position > 0.0) & (particles.position < size))
    if len(water) > 1 or np.isfinite(water[0].upper[axis]):
        return
    assert first_moment(particles) == pytest.approx(moment, rel=ROUND_OFF)
    fill = fill_fraction(grid, particles, medium)
    assert np.abs(fill[..., :21] - 1.0).max() < 1e-11
    deep = particles.position[:, -1] < 0.4
    line = np.moveaxis(medium.particle_porosity, axis, 0).reshape(grid.shape[axis], -1)[:, 0]
    n = np.interp(particles.position[deep, axis], grid.axis_points(axis), line)
    assert particles.volume[deep] == pytest.approx(n * grid.cell_volume / 2 ** len(size), rel=0.05)


@pytest.mark.parametrize(
    "body", [Box((0.4, 0.0), (0.8, 0.3)), corners((0.4, 0.0), (0.8, 0.0), (0.7, 0.5))], ids=["top", "slope"]
)
def test_beside_other_interfaces_it_lies_as_drawn(body: Shape):
    grid = Grid.fit((1.1, 0.5), 0.02)
    assert Settled.of(grid, Medium.build(grid, [PorousBody("rock", body, 0.45)])) is None


def assert_same_in_slabs(grid: Grid, medium: Medium, water: list[Shape], monkeypatch: pytest.MonkeyPatch):
    found = []
    for size in (10**9, 1):
        monkeypatch.setattr("houle.flow.seeding.SLAB", size)
        found.append(seed(grid, medium, water))
    whole, slabs = found
    assert np.array_equal(whole.position, slabs.position) and np.array_equal(whole.volume, slabs.volume)


@pytest.mark.parametrize("dimension", [2, 3])
def test_slabs_make_no_difference(dimension: int, monkeypatch: pytest.MonkeyPatch):
    """Whole or eight columns of half cells at a time, slivers at their ends included: the same to the last bit."""
    grid = Grid((23, 11) if dimension == 2 else (23, 5, 11), (0.1,) * dimension, (False,) * dimension)
    slope = corners((0.0, 0.0), (2.3, 0.0), (2.3, 0.93), dimension=dimension)
    solid = corners((0.4, 0.0), (1.0, 0.0), (0.7, 0.6), dimension=dimension)
    medium = Medium.build(grid, [PorousBody("beads", slope, BEADS)], [solid])
    water = [corners((0.0, 0.2), (2.3, 0.67), (2.3, 1.02), (0.0, 0.21), dimension=dimension)]
    assert_same_in_slabs(grid, medium, water, monkeypatch)


@pytest.mark.parametrize("dimension", [2, 3])
def test_slabs_make_no_difference_to_settled_water(dimension: int, monkeypatch: pytest.MonkeyPatch):
    grid = Grid((29, 11) if dimension == 2 else (29, 5, 11), (0.1,) * dimension, (False,) * dimension)
    upright = Box((0.93, *[-np.inf] * (dimension - 1)), (1.87, *[np.inf] * (dimension - 1)))
    medium = Medium.build(grid, [PorousBody("beads", upright, BEADS)])
    water = [corners((0.0, 0.2), (2.9, 0.67), (2.9, 1.02), (0.0, 0.21), dimension=dimension)]
    assert_same_in_slabs(grid, medium, water, monkeypatch)
