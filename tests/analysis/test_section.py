"""Linear theory of any section, against what is known of some: blocks, plates, slopes, rooms without loss."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from houle.analysis.errors import AnalysisError
from houle.analysis.section import Section, scatter
from houle.analysis.theory import porous_block, porous_block_lorentz
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box
from houle.medium.shapes import Polygon as Drawn

DEPTH, OMEGA = 0.4, 2.0 * np.pi / 1.6


def section(*bodies: PorousBody, solids=(), length: float = 4.0, cells: int = 40, depth: float = DEPTH) -> Section:
    """The section of a flume of this length and depth [m] with square cells."""
    h = depth / cells
    grid = Grid((round(length / h), cells + 1), (h, h), (False, False))
    return Section.of(Medium.build(grid, bodies, solids), cells, 0, grid.shape[0])


def polygon(*points: tuple[float, float]) -> Drawn:
    return Drawn(shapely.Polygon(points), 2)


def block(x0: float, x1: float, **given: float) -> PorousBody:
    return PorousBody("block", Box((x0, 0.0), (x1, 1.0)), **given)


@pytest.mark.parametrize("wall", [False, True])
def test_block_is_that_of_its_modes(wall):
    """Eigenfunctions know it to 1e-4; the waves that die away are left out at the end of the section."""
    body = block(1.6, 4.0 if wall else 2.4, porosity=0.45, a=8.0, inertia=1.4)
    width = 2.4 if wall else 0.8
    exact = porous_block(OMEGA, DEPTH, width, 0.45, 0.45 * 8.0 / OMEGA, inertia=1.4, wall=wall)
    found = scatter(section(body), OMEGA, 0.05, wall=wall)
    assert abs(found.C_R - exact.C_R) < 2e-3
    assert abs(found.C_T - exact.C_T) < 2e-3


def test_quadratic_drag_of_a_block():
    """One friction for the whole block does the same work as one in every place, and lets through nearly the same."""
    body = block(1.6, 2.4, porosity=0.45, a=1.0, b=60.0, inertia=1.4)
    known = porous_block_lorentz(OMEGA, DEPTH, 0.8, 0.45, 0.1, 1.0, 60.0, inertia=1.4)
    found = scatter(section(body), OMEGA, 0.1, wall=False)
    assert abs(found.C_R - known.C_R) < 0.02
    assert abs(found.C_T - known.C_T) < 0.02


def test_short_block_of_quadratic_drag_has_no_place_to_differ_in():
    """So there the two are the same: a screen of two cells in waves that are long to it."""
    omega, body = 1.0, block(1.98, 2.02, porosity=0.5, b=500.0)
    known = porous_block_lorentz(omega, DEPTH, 0.04, 0.5, 0.05, 0.0, 500.0)
    found = scatter(section(body), omega, 0.05, wall=False)
    assert abs(found.C_R - known.C_R) < 2e-3 < known.C_R


def test_solid_slope_sends_everything_back():
    slope = polygon((2.0, 0.0), (3.2, 0.6), (4.0, 0.6), (4.0, 0.0))
    assert abs(scatter(section(solids=[slope]), OMEGA, 0.05, wall=False).C_R - 1.0) < 1e-3


def test_nothing_is_lost_without_drag():
    """On a mound of pores and layers over a bar of stone, inclined to the grid."""
    bar = polygon((1.4, 0.0), (2.0, 0.2), (2.4, 0.1), (2.6, 0.0))
    mound = PorousBody("mound", polygon((1.3, 0.0), (2.1, 0.5), (2.3, 0.5), (2.8, 0.0)), 0.4, inertia=1.5)
    found = scatter(section(mound, solids=[bar]), OMEGA, 0.05, wall=False)
    assert 0.1 < found.C_R < 0.9
    assert abs(found.C_D - 0.0) < 2e-3


def test_step_in_long_waves():
    """Lamb, Hydrodynamics, art. 176: (1 - sqrt(d2/d1)) / (1 + sqrt(d2/d1)), and 2 / (1 + sqrt(d2/d1))."""
    omega, step = 0.3, Box((2.0, 0.0), (4.0, 0.3))
    found, root = scatter(section(solids=[step]), omega, 0.05, wall=False), np.sqrt(0.1 / 0.4)
    assert abs(found.C_R - ((1 - root) / (1 + root))) < 5e-3
    assert abs(found.C_T - (2 / (1 + root))) < 5e-3


def test_mound_converges_with_the_first_order():
    """Slopes are means over boxes around faces: half the spacing is half the error, and C_R(h) on a line."""
    mound = PorousBody("mound", polygon((1.4, 0.0), (2.4, 0.5), (2.6, 0.5), (3.0, 0.0)), 0.45, 12.0, 30.0, 1.4)
    coarse, middle, fine = (scatter(section(mound, cells=n), OMEGA, 0.05, wall=False).C_R for n in (16, 32, 64))
    assert abs(fine - middle) < 0.7 * abs(middle - coarse)


def test_pores_where_the_waves_come_from_are_refused():
    with pytest.raises(AnalysisError, match="no open water at the ends"):
        scatter(section(block(0.0, 1.0, porosity=0.5)), OMEGA, 0.05, wall=False)


def test_narrow_sea_is_regular_waves_but_for_the_mean_of_the_drag():
    """In flow to and fro |q| q does the work that it does in waves 3 pi / 8 (8 / pi)^(1/2) / 2^(1/2) times as high."""
    body = block(1.6, 2.0, porosity=0.45, b=80.0, inertia=1.4)
    omega = OMEGA * np.array([0.999, 1.001])
    sea = scatter(section(body), omega, [0.05, 0.05], wall=False)
    higher = 0.05 * np.sqrt(2.0) * 3.0 * np.pi / 8.0 * np.sqrt(8.0 / np.pi) / np.sqrt(2.0)
    assert abs(sea.C_R - (scatter(section(body), OMEGA, higher, wall=False).C_R)) < 2e-3
    assert abs(sea.C_R - scatter(section(body), OMEGA, 0.05 * np.sqrt(2.0), wall=False).C_R) > 3e-3


def test_sea_without_quadratic_drag_is_the_sum_of_its_waves():
    body, omega, height = block(1.6, 2.4, porosity=0.45, a=8.0), np.array([2.5, 4.0, 6.0]), np.array([0.02, 0.05, 0.03])
    each = [scatter(section(body), one, 0.01, wall=False) for one in omega]
    sea = scatter(section(body), omega, height, wall=False)
    assert abs(sea.C_R**2 / np.average([one.C_R**2 for one in each], weights=height**2) - 1.0) < 1e-9
    assert abs(sea.C_T**2 / np.average([one.C_T**2 for one in each], weights=height**2) - 1.0) < 1e-9
