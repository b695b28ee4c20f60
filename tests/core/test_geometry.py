"""Shapes contain what they should, distances are distances, and integrals over the grid are exact."""

from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from houle.case.shapes import shape_of
from houle.errors import CaseError
from houle.grid import Grid
from houle.medium.integrals import Measure, around_faces, covered_faces, over_cells, section_moments, with_tent
from houle.medium.sections import layers, section
from houle.medium.shapes import EVERYWHERE, Box, Polygon, Union
from houle.medium.solids import Outline

ROUND_OFF = 1e-12
STAR = shapely.Polygon(
    [(0.13, 0.07), (0.55, 0.21), (0.93, 0.02), (0.7, 0.44), (0.98, 0.66), (0.52, 0.55), (0.21, 0.7), (0.31, 0.4)],
    holes=[[(0.45, 0.3), (0.6, 0.33), (0.5, 0.46)]],
)


def below(level, dimension=2):
    return shape_of(SimpleNamespace(box=None, polygon=None, below=level), dimension)


def moments_by_clipping(area, spacing, shape):
    """[0, 0], [1, 0], [0, 1], [1, 1] moments of every cell from shapely's clip, area and the textbook vertex sums."""
    out = np.zeros((2, 2, *shape))
    for i, j in np.ndindex(*shape):
        cell = shapely.box(i * spacing[0], j * spacing[1], (i + 1) * spacing[0], (j + 1) * spacing[1])
        for part in shapely.get_parts(shapely.intersection(area, cell)):
            if part.geom_type != "Polygon":
                continue
            for ring in (part.exterior, *part.interiors):
                sign = (1.0 if shapely.is_ccw(ring) else -1.0) * (1.0 if ring.equals(part.exterior) else -1.0)
                x, z = (shapely.get_coordinates(ring) / spacing - (i + 0.5, j + 0.5)).T
                cross = sign * (x[:-1] * z[1:] - x[1:] * z[:-1])
                out[0, 0, i, j] += cross.sum() / 2
                out[1, 0, i, j] += (cross * (x[:-1] + x[1:])).sum() / 6
                out[0, 1, i, j] += (cross * (z[:-1] + z[1:])).sum() / 6
                xz = x[:-1] * (2 * z[:-1] + z[1:]) + x[1:] * (z[:-1] + 2 * z[1:])
                out[1, 1, i, j] += (cross * xz).sum() / 24
    return out


def test_a_box_knows_inside_from_outside_and_how_far():
    box = Box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
    points = [(0.5, 1.0, 1.0), (4.0, 6.0, 2.0), (0.25, 1.0, 1.5), (1.0, 2.0, 3.0), (-1.0, 1.0, 1.0)]
    assert box.contains(points).tolist() == [True, False, True, True, False]
    assert box.distance(points) == pytest.approx([-0.5, 5.0, -0.25, 0.0, 1.0])
    assert [b.tolist() for b in box.bounds] == [[0, 0, 0], [1, 2, 3]]


def test_a_rectangle_given_as_a_polygon_is_the_same_shape():
    box, polygon = Box((0.2, 0.1), (0.7, 0.4)), Polygon(shapely.box(0.2, 0.1, 0.7, 0.4), 2)
    points = np.random.default_rng(1).uniform(0, 1, (500, 2))
    assert np.array_equal(box.contains(points), polygon.contains(points))
    assert polygon.distance(points) == pytest.approx(box.distance(points), abs=ROUND_OFF)
    assert np.array_equal(box.bounds, polygon.bounds)
    prism = Polygon(shapely.box(0.2, 0.1, 0.7, 0.4), 3)
    behind = np.insert(points, 1, 7.0, axis=1)
    assert prism.distance(behind) == pytest.approx(box.distance(points), abs=ROUND_OFF)
    assert prism.bounds[0].tolist() == [0.2, -np.inf, 0.1]


def test_distance_from_water_below_a_level_is_the_height_above_it():
    points = np.array([(3.0, -1.0, 0.1), (0.0, 5.0, 0.7)])
    assert below(0.3, 3).distance(points) == pytest.approx([-0.2, 0.4])
    assert below(0.3, 3).contains(points).tolist() == [True, False]


def test_a_union_holds_what_any_part_holds():
    union = Union((Box((0.0, 0.0), (0.3, 1.0)), below(0.2)))
    points = [(0.1, 0.9), (0.9, 0.1), (0.9, 0.5), (0.4, 0.2)]
    assert union.contains(points).tolist() == [True, True, False, True]
    assert union.distance(points)[2] == pytest.approx(0.3)
    assert union.bounds[1].tolist() == [np.inf, 1.0]


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"polygon": [(0, 0), (1, 1), (1, 0), (0, 1)]}, "not a simple polygon"),
        ({"polygon": [(0, 0), (1, 1), (2, 2)]}, "no area"),
        ({"box": [(0.5, 0.0), (0.2, 1.0)]}, "the first one the lower"),
        ({"box": [(0.0, 0.0, 0.0), (1.0, 1.0, 1.0)]}, "not a box in 2D"),
        ({}, "needs one of"),
    ],
)
def test_a_shape_that_is_none_is_refused_with_the_cure(entry, words):
    with pytest.raises(CaseError, match=words):
        shape_of(SimpleNamespace(**{"box": None, "polygon": None, "below": None, **entry}), 2)


def test_case_entries_become_shapes():
    entry = SimpleNamespace(box=[[0, 0], [1, 2]], polygon=None, below=None)
    assert shape_of(entry, 2) == Box((0.0, 0.0), (1.0, 2.0))
    entry = SimpleNamespace(box=None, polygon=[(0, 0), (1, 0), (0, 1)], below=None)
    assert shape_of(entry, 3).contains([(0.2, 9.0, 0.2), (0.8, 9.0, 0.8)]).tolist() == [True, False]


def test_moments_of_a_star_with_a_hole_match_those_of_its_clipped_pieces():
    spacing, shape = (0.1, 0.08), (10, 10)
    exact = moments_by_clipping(STAR, spacing, shape)
    found = section_moments(STAR, spacing, shape)
    assert np.abs(found - exact).max() < ROUND_OFF
    assert found[0, 0].sum() * 0.008 == pytest.approx(STAR.area, rel=ROUND_OFF)


def test_a_box_on_grid_lines_fills_cells_exactly_whatever_the_rounding():
    moments = section_moments(shapely.box(0.29, 0.005, 0.58, 0.35), (0.005, 0.005), (178, 116))
    expected = np.zeros((178, 116))
    expected[58:116, 1:70] = 1.0
    assert np.array_equal(moments[0, 0], expected)
    assert not moments[1:].any() and not moments[0, 1].any()


@pytest.mark.parametrize("periodic", [(False, False), (True, False), (True, True)])
def test_averages_keep_the_area(periodic):
    """Tents are a partition of unity, folded or wrapped; cells tile; a constant stays a constant."""
    grid = Grid((9, 7), (1 / 9, 0.1), periodic)
    star = Measure.of(grid, [(EVERYWHERE, section(grid, [Polygon(STAR, 2)]))])
    cells, tent = star.mean([over_cells] * 2), star.mean([with_tent] * 2)
    assert cells.sum() == pytest.approx(STAR.area / grid.cell_volume, rel=ROUND_OFF)
    assert tent.sum() == pytest.approx(cells.sum(), rel=ROUND_OFF)
    full = Measure.of(grid, [(EVERYWHERE, section(grid, [below(9.0)]))])
    for averaging in ([with_tent] * 2, [around_faces, over_cells], [over_cells, around_faces]):
        assert np.abs(full.mean(averaging) - 1).max() < ROUND_OFF


def test_tent_averages_match_brute_force_sampling():
    grid = Grid((6, 5), (1 / 6, 0.14), (True, False))
    tent = Measure.of(grid, [(EVERYWHERE, section(grid, [Polygon(STAR, 2)]))]).mean([with_tent] * 2)
    m = 200
    x, z = ((np.arange(n * m) + 0.5) / m for n in grid.shape)
    inside = shapely.contains_xy(STAR, *np.meshgrid(x * grid.spacing[0], z * grid.spacing[1], indexing="ij"))

    def weights(s, n, periodic):
        images = (0, -n, n) if periodic else (0,)
        mirrored = (s,) if periodic else (s, -s, 2 * n - s)
        centre = np.arange(n)[:, None] + 0.5
        return sum(np.maximum(0, 1 - np.abs(p + k - centre)) for p in mirrored for k in images) / m

    sampled = weights(x, 6, True) @ inside @ weights(z, 5, False).T
    assert np.abs(tent - sampled).max() < 4 / m  # a boundary of a few cell sides, uncertain by half a sample


def test_a_shape_that_only_touches_the_domain_covers_none_of_it():
    grid = Grid((4, 4), (0.25, 0.25), (False, False))
    beside = Polygon(shapely.Polygon([(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)]), 2)
    both = Polygon(shapely.Polygon([(0.5, 0.0), (0.75, 0.5), (1.0, 0.1), (1.0, 0.9), (2.0, 2.0), (3.0, 0.0)]), 2)
    assert section(grid, [beside]).is_empty and section(grid, [below(0.0)]).is_empty
    part = Measure.of(grid, [(EVERYWHERE, section(grid, [both, beside]))]).mean([over_cells] * 2)
    assert part.sum() / 16 == pytest.approx(both.outline.intersection(shapely.box(0, 0, 1, 1)).area, rel=ROUND_OFF)


def test_open_faces_are_what_the_polygon_leaves_of_the_grid_lines():
    grid = Grid((10, 9), (0.1, 0.08), (False, False))
    upright, level = covered_faces(grid, [(EVERYWHERE, STAR)])
    for i, j in np.ndindex(11, 9):
        line = shapely.LineString([(i * 0.1, j * 0.08), (i * 0.1, (j + 1) * 0.08)])
        assert upright[i, j] == pytest.approx(STAR.intersection(line).length / 0.08, abs=ROUND_OFF)
    for i, j in np.ndindex(10, 10):
        line = shapely.LineString([(i * 0.1, j * 0.08), ((i + 1) * 0.1, j * 0.08)])
        assert level[i, j] == pytest.approx(STAR.intersection(line).length / 0.1, abs=ROUND_OFF)


def test_a_box_on_grid_lines_covers_all_faces_around_it():
    grid = Grid((6, 5, 4), (0.1, 0.2, 0.25), (False,) * 3)
    box = Box((0.2, 0.4, 0.0), (0.4, 0.6, 0.375))
    areas = [(span, section(grid, [box], span)) for span in layers(grid, [box])]
    x, y, z = covered_faces(grid, areas)
    assert np.array_equal(np.argwhere(x == 1), [(i, 2, 0) for i in (2, 3, 4)])
    assert np.array_equal(np.argwhere(y == 1), [(i, j, 0) for i in (2, 3) for j in (2, 3)])
    assert np.array_equal(np.argwhere(z == 1), [(i, 2, k) for i in (2, 3) for k in (0, 1)])
    assert x[3, 2].tolist() == y[2, 3].tolist() == [1, 0.5, 0, 0]
    assert x.sum() == 3 * 1.5 and y.sum() == 4 * 1.5 and z.sum() == 4


def test_overlapping_boxes_count_once_in_3d():
    grid = Grid((7, 6, 5), (0.2, 0.2, 0.2), (False,) * 3)
    a, b = Box((0.11, 0.13, 0.0), (0.73, 0.82, 0.5)), Box((0.5, 0.6, 0.2), (1.3, 1.17, 0.9))
    union = Measure.of(grid, [(s, section(grid, [Union((a, b))], s)) for s in layers(grid, [a, b])])
    volume = 0.62 * 0.69 * 0.5 + 0.8 * 0.57 * 0.7 - 0.23 * 0.22 * 0.3
    assert union.mean([over_cells] * 3).sum() * grid.cell_volume == pytest.approx(volume, rel=ROUND_OFF)


def test_solids_that_touch_have_no_edge_between_them():
    """Nor at the floor, under which their mirror image goes on."""
    grid = Grid((10, 10), (0.1, 0.1), (False, False))
    outline = Outline.of(grid, [Box((0.0, 0.0), (0.5, 0.6)), Box((0.5, 0.0), (1.0, 0.6))])
    assert outline is not None
    assert np.all(np.abs(outline.edge[:, [1, 3]]) == 0.6) and outline.top.tolist() == [np.inf]


def test_the_outline_in_3d_has_a_section_for_each_layer():
    grid = Grid((6, 5, 4), (0.1, 0.1, 0.1), (False,) * 3)
    outline = Outline.of(grid, [Box((0.23, 0.11, 0.05), (0.41, 0.32, 0.27))])
    assert outline is not None
    assert outline.top.tolist() == [0.11, 0.32, 0.5]
    assert np.diff(outline.start).reshape(3, -1).any(axis=1).tolist() == [False, True, False]
    assert np.unique(np.abs(outline.edge[:, [1, 3]])).tolist() == [0.05, 0.27]


# corners, and the area that they enclose
RINGS = {
    "a bed whose foot lies on the floor": ([(0, 0), (4, 0), (8, 0.4), (8, 0)], 0.8),
    "two bars on a floor": ([(0, 0), (1, 0), (2, 0.2), (3, 0), (5, 0), (6, 0.2), (7, 0), (8, 0)], 0.4),
    "corners that repeat, and the first one again": ([(0, 0), (0, 0), (1, 0), (1, 1), (1, 1), (0, 1), (0, 0)], 1.0),
    "corners on a line": ([(0, 0), (0.5, 0), (1, 0), (1, 1), (0.3, 1), (0, 1), (0, 0.7)], 1.0),
    "a spike outwards": ([(0, 0), (1, 0), (1, 1), (1, 2), (1, 1), (0, 1)], 1.0),
    "a spike inwards": ([(0, 0), (2, 0), (2, 1), (1, 1), (1, 0.5), (1, 1), (0, 1)], 2.0),
    "a foot along a slope": ([(0, 0.1), (3.3, 0.37), (6.6, 0.64), (6.6, 0.9), (3.3, 0.37)], 0.429),
    "a hole on a cut": ([(0, 0), (4, 0), (4, 4), (0, 4), (0, 1), (1, 1), (1, 3), (3, 3), (3, 1), (0, 1)], 12.0),
    "touching itself at a corner": ([(0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 1)], 2.0),
    "clockwise": ([(8, 0), (8, 0.4), (4, 0), (0, 0)], 0.8),
}
CROSSING = {
    "a bow tie": ([(0, 0), (1, 1), (1, 0), (0, 1)], (0.5, 0.5)),
    "a corner through the opposite side": ([(0, 0), (2, 0), (2, 1), (1, -0.5), (0, 1)], None),
    "twice round": ([(0, 0), (3, 0), (3, 2), (1, 2), (1, 1), (2, 1), (2, 3), (0, 3)], (2.0, 2.0)),
    "a foot on the floor and a crossing": ([(0, 0), (1, 0), (2, 1), (3, 1), (2, 0.2), (1.5, 2), (4, 2), (4, 0)], None),
}


@pytest.mark.parametrize("ring", RINGS)
def test_whatever_encloses_one_area_is_a_shape(ring):
    corners, area = RINGS[ring]
    for start in range(len(corners)):
        shape = shape_of(SimpleNamespace(box=None, polygon=corners[start:] + corners[:start], below=None), 2)
        assert shape.section((-1.0, -1.0, 9.0, 9.0)).area == pytest.approx(area, rel=1e-9)
        inside = shapely.point_on_surface(shape.outline)
        assert shape.contains([(inside.x, inside.y), (-0.5, -0.5)]).tolist() == [True, False]
        assert shape.distance([(inside.x, inside.y)])[0] < 0 < shape.distance([(-0.5, -0.5)])[0]


@pytest.mark.parametrize("ring", CROSSING)
def test_a_ring_that_crosses_itself_is_refused_with_the_place(ring):
    corners, place = CROSSING[ring]
    said = "crosses itself at" if place is None else rf"crosses itself at \[{place[0]:g}, {place[1]:g}\]"
    for start in range(len(corners)):
        with pytest.raises(CaseError, match=said):
            shape_of(SimpleNamespace(box=None, polygon=corners[start:] + corners[:start], below=None), 2)
