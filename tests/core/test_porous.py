"""The medium holds the pore volume of its shapes, and its averages are those of the shapes themselves."""

from itertools import product

import numpy as np
import pytest
import shapely

import reference
from houle.grid import Grid
from houle.medium.medium import CLOSED, Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box, Polygon, Shape

ROUND_OFF = 1e-12
SINGLE = 2.0**-24  # half a unit of the last place at 1 in single precision, in which openness of faces is kept
ROCK = {"porosity": 0.49, "a": 3.0, "b": 90.0, "inertia": 1.35}
CORE = {"porosity": 0.35, "a": 40.0, "b": 300.0, "inertia": 1.6}
SLOPE = shapely.Polygon([(0.21, 0.0), (0.47, 0.26), (0.63, 0.26), (0.91, 0.0)])


def pore_volume(medium: Medium) -> float:
    return float((medium.porosity * medium.open_cells).sum() * medium.grid.cell_volume)


def sampled(grid: Grid, value, low, high, m=40) -> float:
    """Mean of value(points) over the part of a box inside the domain, by m^2 midpoints."""
    low, high = np.maximum(low, 0), np.minimum(high, grid.size)
    lines = [lo + (hi - lo) * (np.arange(m) + 0.5) / m for lo, hi in zip(low, high, strict=True)]
    values = value(np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1))
    return float(np.nanmean(values)) if np.isfinite(values).any() else np.nan


def all_fields(medium: Medium) -> list[np.ndarray]:
    faces = [*medium.open_faces, *(f for column in range(3) for f in medium.on_faces(column))]
    return [medium.porosity, medium.particle_porosity, medium.open_cells, medium.body, *faces]


@pytest.mark.parametrize(("shape", "size"), [((7, 5), (0.7, 0.4)), ((4, 3, 5), (0.4, 0.2, 0.5))])
def test_clear_water_is_one_everywhere(shape, size):
    medium = Medium.build(Grid(shape, tuple(s / n for s, n in zip(size, shape, strict=True)), (False,) * len(shape)))
    for ones in (
        medium.porosity,
        medium.open_cells,
        medium.energy,
        medium.contrast,
        *medium.open_faces,
        *medium.on_faces(0),
    ):
        assert np.array_equal(ones, np.ones_like(ones))
    for zeros in (*medium.on_faces(1), *medium.on_faces(2), medium.body):
        assert not zeros.any()
    assert medium.outline is None


@pytest.mark.parametrize(
    ("low", "high"), [((0.30, 0.0), (0.59, 0.37)), ((0.3013, 0.0), (0.5871, 0.3717)), ((-1.0, 0.011), (0.013, 9.0))]
)
def test_pore_volume_of_a_dam_is_exact_on_and_off_the_grid_lines(low, high):
    grid = Grid.fit((0.892, 0.58), 0.01)
    body = PorousBody("dam", Box(low, high), **ROCK)
    inside = np.minimum(high, grid.size) - np.maximum(low, 0)
    exact = np.prod(grid.size) - (1 - 0.49) * np.prod(inside)
    assert pore_volume(Medium.build(grid, [body])) == pytest.approx(exact, rel=ROUND_OFF)


def test_pore_volume_of_overlapping_bodies_on_a_solid_slope_is_exact():
    """A core replaces the armour before it in the list, a solid replaces both."""
    grid = Grid.fit((1.0, 0.5), 0.02)
    bed = shapely.Polygon([(0.0, 0.0), (1.0, 0.0), (1.0, 0.17)])
    core = shapely.box(0.4, 0.0, 0.7, 0.2)
    bodies = [PorousBody("armour", Polygon(SLOPE, 2), **ROCK), PorousBody("core", Polygon(core, 2), **CORE)]
    medium = Medium.build(grid, bodies, [Polygon(bed, 2)])
    armour_area = SLOPE.difference(core).difference(bed).area
    exact = 0.5 - bed.area - 0.51 * armour_area - 0.65 * core.difference(bed).area
    closed = bed.area - (1 - medium.open_cells).sum() * grid.cell_volume  # cells that CLOSED took away
    assert abs(closed) < CLOSED * grid.cell_volume * np.sum(medium.open_cells == 0)
    assert pore_volume(medium) == pytest.approx(exact + closed, rel=1e-9)


def test_pore_volume_of_a_box_in_3d_is_exact():
    grid = Grid.fit((1.0, 0.6, 0.5), 0.05)
    medium = Medium.build(grid, [PorousBody("block", Box((0.33, 0.11, 0.0), (0.72, 0.47, 0.31)), **ROCK)])
    assert pore_volume(medium) == pytest.approx(0.3 - 0.51 * 0.39 * 0.36 * 0.31, rel=ROUND_OFF)


def test_face_and_cell_averages_match_sampled_ones():
    """Means over the open part of the one-cell box around a face, of its inner half at a wall, and of each cell."""
    grid = Grid((10, 6), (0.1, 0.06), (False, False))
    solid: Shape = Polygon(shapely.Polygon([(0.6, 0.0), (1.0, 0.0), (1.0, 0.3)]), 2)
    body = PorousBody("rock", Polygon(SLOPE, 2), **ROCK)
    medium = Medium.build(grid, [body], [solid])

    def field(inside: float, clear: float):
        def value(points):
            return np.where(solid.contains(points), np.nan, np.where(body.shape.contains(points), inside, clear))

        return value

    def check(found, place, value, jump):
        exact = sampled(grid, value, place - half, place + half)
        if np.isfinite(exact):
            assert found == pytest.approx(exact, abs=0.06 * jump)

    def check_face(found, place, inside, clear, jump):
        """The mean, or where an interface runs along the face that of one medium."""
        if found not in (pytest.approx(inside), clear):
            check(found, place, field(inside, clear), jump)

    half = np.array(grid.spacing) / 2
    for axis in (0, 1):
        for at in np.ndindex(*grid.face_shape(axis)):
            place = (np.array(at) + 0.5) * grid.spacing
            place[axis] -= half[axis]
            check_face(medium.on_faces(0)[axis][at], place, 1.35 / 0.49, 1.0, 1.76)
            check_face(medium.on_faces(1)[axis][at], place, 3.0, 0.0, 3.0)
            check_face(medium.on_faces(2)[axis][at], place, 90.0, 0.0, 90.0)
    for at in np.ndindex(*grid.shape):
        if medium.open_cells[at] > 0.1:
            check(medium.porosity[at], (np.array(at) + 0.5) * grid.spacing, field(0.49, 1.0), 0.51)
            inertia = medium.energy[at] * medium.porosity[at]  # <C_r / n>
            check(inertia, (np.array(at) + 0.5) * grid.spacing, field(1.35 / 0.49, 1.0), 1.8)


def test_a_wall_face_knows_only_the_half_cell_inside():
    grid = Grid((4, 1), (0.1, 0.1), (False, False))
    medium = Medium.build(grid, [PorousBody("skin", Box((0.0, 0.0), (0.05, 0.1)), 0.5, a=8.0, inertia=1.2)])
    assert medium.on_faces(1)[0][:, 0] == pytest.approx([8, 0, 0, 0, 0], abs=ROUND_OFF)
    assert medium.on_faces(0)[0][0, 0] == pytest.approx(2.4) and not medium.on_faces(1)[1][0].any()  # on it


def test_fields_repeat_along_a_periodic_axis():
    """A body cut by the periodic side is the same body as one in the middle."""
    grid = Grid((8, 4), (0.1, 0.1), (True, False))
    halves = [Box((0.0, 0.0), (0.123, 0.27)), Box((0.671, 0.0), (0.8, 0.27))]
    cut = Medium.build(grid, [PorousBody("b", half, **ROCK) for half in halves])
    whole = Medium.build(grid, [PorousBody("b", Box((0.271, 0.0), (0.523, 0.27)), **ROCK)])
    assert np.abs(np.roll(cut.on_faces(1)[0][:-1], 4, axis=0) - whole.on_faces(1)[0][:-1]).max() < 1e-11
    assert np.array_equal(cut.material[0][0], cut.material[0][-1])
    assert np.array_equal(np.roll(cut.body > 0, 8, axis=0), whole.body > 0)


def test_a_prism_in_3d_is_the_same_as_its_section_in_2d():
    flat, deep = Grid((12, 8), (0.08, 0.05), (False,) * 2), Grid((12, 3, 8), (0.08, 0.1, 0.05), (False,) * 3)
    solid = shapely.Polygon([(0.5, 0.0), (0.96, 0.0), (0.96, 0.3)])
    two = Medium.build(flat, [PorousBody("b", Polygon(SLOPE, 2), **ROCK)], [Polygon(solid, 2)])
    three = Medium.build(deep, [PorousBody("b", Polygon(SLOPE, 3), **ROCK)], [Polygon(solid, 3)])
    for name in ("porosity", "open_cells", "energy", "contrast", "body"):
        assert np.abs(getattr(three, name) - getattr(two, name)[:, None]).max() < ROUND_OFF, name
    for a3, a2 in ((0, 0), (2, 1)):
        assert np.abs(three.open_faces[a3] - two.open_faces[a2][:, None]).max() < ROUND_OFF
        for column in range(3):
            assert np.abs(three.on_faces(column)[a3] - two.on_faces(column)[a2][:, None]).max() < 1e-11, column
    assert np.abs(three.open_faces[1] - two.open_cells[:, None]).max() < SINGLE


def test_every_field_has_the_shape_and_the_layout_that_the_kernels_read():
    grid = Grid((6, 5, 4), (0.1, 0.1, 0.1), (False, True, False))
    medium = Medium.build(grid, [PorousBody("b", Box((0.1, 0.1, 0.0), (0.3, 0.3, 0.2)), **ROCK)])
    cells, faces = [grid.shape] * 3, [grid.face_shape(a) for a in range(3)] * 4
    for field, shape in zip(all_fields(medium), [*cells, (12, 10, 8), *faces], strict=True):
        assert field.shape == shape and field.flags.c_contiguous
    assert medium.body.dtype == np.int8


def test_half_cells_know_the_body_at_their_centre():
    grid = Grid((4, 2), (1.0, 1.0), (False, False))
    bodies = [
        PorousBody("a", Box((0.0, 0.0), (3.0, 1.0)), **ROCK),
        PorousBody("b", Box((1.3, 0.0), (2.2, 2.0)), **CORE),
    ]
    medium = Medium.build(grid, bodies, [Box((3.5, 0.0), (4.0, 2.0))])
    assert medium.body[:, 0].tolist() == [1, 1, 1, 2, 1, 1, 0, -1]
    assert medium.body[:, 3].tolist() == [0, 0, 0, 2, 0, 0, 0, -1]


def test_a_solid_closes_its_cells_and_all_their_faces():
    grid = Grid((5, 4), (0.2, 0.1), (False, False))
    medium = Medium.build(grid, solids=[Box((0.4, 0.0), (0.6, 0.25))])
    assert medium.open_cells[2] == pytest.approx([0, 0, 0.5, 1])
    assert medium.open_faces[0][2] == pytest.approx([0, 0, 0.5, 1])
    assert medium.open_faces[0][3] == pytest.approx([0, 0, 0.5, 1])
    assert medium.open_faces[1][2] == pytest.approx([0, 0, 0, 1, 1])
    assert medium.outline is not None
    assert np.diff(medium.outline.start).reshape(5, 4)[2].astype(bool).tolist() == [True, True, True, False]


@pytest.mark.parametrize(("gap", "open_part"), [(0.5 * CLOSED, 0.0), (2 * CLOSED, 2 * CLOSED)])
def test_gaps_too_small_to_matter_are_closed(gap, open_part):
    grid = Grid((3, 3), (1.0, 1.0), (False, False))
    medium = Medium.build(grid, solids=[Box((0.0, 0.0), (3.0, 2.0 - gap))])
    assert medium.open_cells[:, 1] == pytest.approx(open_part)
    assert medium.open_faces[0][:, 1] == pytest.approx(open_part)
    assert np.all(medium.open_faces[1][:, 2] == (1.0 if open_part else 0.0))


def test_solid_cells_continue_the_porosity_beside_them():
    """So that interpolation to a particle in rock that lies on a bed does not see clear water in the bed."""
    grid = Grid((6, 4), (1.0, 1.0), (False, False))
    rock = PorousBody("rock", Box((0.0, 1.0), (6.0, 4.0)), **ROCK)
    medium = Medium.build(grid, [rock], [Box((0.0, 0.0), (6.0, 1.0))])
    assert medium.porosity == pytest.approx(0.49) and medium.energy == pytest.approx(1.35 / 0.49**2)


def test_a_sloping_solid_pushes_back_with_its_full_face():
    """In every cell the open sides and the cut face close: the missing sides are the cut's projections.

    Except beside a cell closed for being less open than CLOSED: a triangle with sides below sqrt(2 CLOSED / 0.775).
    """
    grid = Grid((12, 10), (0.1, 0.1), (False, False))
    slope = shapely.Polygon([(0.0, 0.0), (1.2, 0.0), (1.2, 0.93)])
    medium = Medium.build(grid, solids=[Polygon(slope, 2)])
    side = np.sqrt(2 * CLOSED / 0.775)
    for i, j in product(range(12), range(10)):
        if medium.open_cells[i, j] > 0.05:
            cell = shapely.box(i * 0.1, j * 0.1, (i + 1) * 0.1, (j + 1) * 0.1)
            cut = cell.intersection(shapely.LineString([(0.0, 0.0), (1.2, 0.93)]))
            run = np.abs(np.diff(shapely.get_coordinates(cut), axis=0)).sum(axis=0) if cut.length > 0 else (0.0, 0.0)
            x, z = medium.open_faces
            assert (x[i, j] - x[i + 1, j]) * 0.1 == pytest.approx(run[1], abs=0.1 * side)
            assert (z[i, j + 1] - z[i, j]) * 0.1 == pytest.approx(run[0], abs=0.1 * side)


@pytest.mark.parametrize("porosity", [0.39, 0.49, 0.85])
def test_the_porosity_of_particles_fills_tents_as_the_structure_does(porosity):
    """Integrated with the tent of every cell, finely: the means of the structure, faces on and off the grid lines."""
    grid = Grid((16, 8), (0.5, 0.5), (False, False))
    medium = Medium.build(grid, [PorousBody("block", Box((2.0, 0.0), (5.3, 2.1)), porosity)])
    tents = reference.tent_porosity(grid, medium.bodies, medium.solids)
    s = (np.arange(200) + 0.5) / 100 - 1  # over a tent, in cells
    for i, k in [(3, 1), (4, 1), (5, 1), (10, 1), (11, 1), (7, 3), (7, 4), (7, 6)]:
        x, z = np.meshgrid(i + s, k + s, indexing="ij")
        field = interpolated(medium.particle_porosity, x, z)
        weight = (1 - np.abs(s))[:, None] * (1 - np.abs(s))
        assert (weight * field).sum() / weight.sum() == pytest.approx(tents[i, k], abs=3e-4)


def interpolated(values, i, k):
    """Bilinear between cells at places (in cells, centres at whole numbers)."""
    low = np.floor(i).astype(int), np.floor(k).astype(int)
    s, t = i - low[0], k - low[1]
    at = [[values[np.clip(low[0] + a, 0, None), np.clip(low[1] + b, 0, None)] for b in (0, 1)] for a in (0, 1)]
    return (1 - s) * ((1 - t) * at[0][0] + t * at[0][1]) + s * ((1 - t) * at[1][0] + t * at[1][1])


def test_the_porosity_of_particles_stays_well_above_nothing_beside_tight_bodies():
    grid = Grid((8, 8), (1.0, 1.0), (False, False))
    medium = Medium.build(grid, [PorousBody("core", Box((3.0, 0.0), (6.0, 8.0)), 0.1)])
    assert medium.particle_porosity.min() >= 0.05 - ROUND_OFF


@pytest.mark.parametrize("width", [0.02, 0.09, 0.12, 0.3])
@pytest.mark.parametrize("line", [0.0, 0.4, 0.36], ids=["floor", "on a grid line", "in a row"])
@pytest.mark.parametrize("upright", [False, True])
def test_slits_thinner_than_a_tenth_of_a_cell_are_closed(width, line, upright):
    """In cells of 0.1: along the floor, on both sides of a grid line, or in one row of cells; what is wider is open."""
    grid = Grid((12, 12), (0.1, 0.1), (False, False))
    start = line if line == 0.0 else line - 0.05 * width
    solids = [((0.35, 0.0), (0.83, start)), ((0.35, start + 0.1 * width), (0.83, 0.8))]
    solids = [(low[:: -1 if upright else 1], high[:: -1 if upright else 1]) for low, high in solids if high[1] > 0.0]
    medium = Medium.build(grid, solids=[Box(*ends) for ends in solids])
    across, cells = medium.open_faces[1 if upright else 0], medium.open_cells
    across, cells = (across.T, cells.T) if upright else (across, cells)
    shares = [0.5 * width, 0.5 * width] if line == 0.4 else [width]
    passage = across[4:9, :8].sum(axis=1)
    expected = 0.0 if max(shares) < 0.1 else width
    assert passage == pytest.approx(expected, abs=1e-6)
    assert np.all((cells[4:8, :8].sum(axis=1) > 0.0) == (expected > 0.0))


@pytest.mark.parametrize(
    "corners", [[(0.0, 0.0), (1.2, 0.0), (1.2, 0.495), (0.0, 0.495)], [(0, 0), (1.2, 0), (1.2, 0.93)]]
)
def test_a_thin_sheet_of_open_cells_over_a_solid_is_no_slit(corners):
    """Water reaches it from above, through all of its length; and so the corners that a slope leaves."""
    grid, solid = Grid((12, 10), (0.1, 0.1), (False, False)), shapely.Polygon(corners)
    cells = [[shapely.box(0.1 * i, 0.1 * k, 0.1 * i + 0.1, 0.1 * k + 0.1) for k in range(10)] for i in range(12)]
    whole = 1.0 - shapely.area(shapely.intersection(np.array(cells), solid)) / 0.01
    expected = np.where(whole < CLOSED, 0.0, whole)
    assert Medium.build(grid, solids=[Polygon(solid, 2)]).open_cells == pytest.approx(expected, abs=1e-9)
    assert np.any((expected > 0.0) & (expected < 0.1))
