"""Linear theory of the structure of a case, beside what its gauges say: C_R, C_T, C_D of any section in 2D.

A vertical porous block over the full depth under regular waves has its theory in closed form. All else is solved on
two grids (`houle.analysis.section`), and what these give is carried on to no spacing, as slopes converge with the first
order. Waves of no height: nothing breaks, runs up or comes over, and the water stays where it is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from houle.analysis.errors import AnalysisError
from houle.analysis.section import Section, scatter
from houle.case.porous import porous_body
from houle.case.shapes import shape_of
from houle.grid import Grid
from houle.medium.medium import Medium

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from houle.analysis.theory import Scatter
    from houle.case.model import Case

ROWS = (20, 40)  # cells in the depth of the two grids
AWAY = 2.0  # depths between the section and its ends: what dies away has fallen to exp(-2 pi)
ALL = 1e-3  # C_T below which nothing goes on behind a structure
BANDS = 10  # parts of equal energy of a sea


@dataclass(frozen=True)
class Solved:
    """Coefficients of a section by linear theory; C_T is 0 where there is a wall behind it.

    error: difference of C_R between the two grids.
    """

    C_R: float
    C_T: float
    C_D: float
    error: float


def solve(case: Case, height: float, towards: float, front: float, wall: float | None) -> Solved:
    """Linear theory of the section of a case for its waves, of this height H or H_m0 [m].

    towards, front  direction of the waves, +1 or -1, and the place where they meet the structure [m]
    wall            side of the tank at which they end; None where something takes up what goes on

    Raises AnalysisError where there is none.
    """
    level = _level(case)
    omega, heights = bands(case, height)
    first, last = _ends(case, towards, front, wall, level)
    found: list[Scatter] = []
    for rows in ROWS:
        medium = _medium(case, level, rows)
        hx = medium.grid.spacing[0]
        i, j = round(first / hx), round(last / hx)
        found.append(scatter(Section.of(medium, rows, i, j, case.fluid.gravity), omega, heights, wall=wall is not None))
    coarse, fine = found
    if not case.porous and fine.C_T < ALL:
        raise AnalysisError("nothing takes energy out of linear waves on solids alone: all of it comes back")
    C_R, C_T = (2 * getattr(fine, name) - getattr(coarse, name) for name in ("C_R", "C_T"))
    return Solved(C_R, C_T, 1.0 - C_R**2 - C_T**2, abs(fine.C_R - coarse.C_R))


def bands(case: Case, height: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """omega [rad/s] and height [m] of the waves: one of regular waves, `BANDS` of a sea of this H_m0."""
    wave = case.wave
    assert wave is not None and case.waves is not None
    if case.waves.kind == "regular":
        return np.array([wave.omega]), np.array([height])
    parts = wave.components()
    if parts is None:
        raise AnalysisError(f'waves.kind = "{case.waves.kind}" is no sum of waves')
    parts = parts.moving
    order = np.argsort(parts.omega)
    omega, energy = parts.omega[order], parts.amplitude[order] ** 2
    share = (np.cumsum(energy) - 0.5 * energy) / energy.sum()
    number = np.minimum((BANDS * share).astype(int), BANDS - 1)
    sums = np.bincount(number, energy, BANDS)
    means = np.bincount(number, energy * omega, BANDS)
    there = sums > 0.0
    return means[there] / sums[there], height / math.sqrt(2.0) * np.sqrt(sums[there] / sums.sum())


def _level(case: Case) -> float:
    """The level of still water [m], one for the whole flume."""
    assert case.waves is not None
    if case.dimension == 3:
        raise AnalysisError("it is for sections, in 2D")
    levels = {entry.below for entry in case.water}
    if len(levels) != 1 or None in levels:
        raise AnalysisError("the water has not one level everywhere")
    return float(levels.pop() or 0.0)


def _ends(case: Case, towards: float, front: float, wall: float | None, level: float) -> tuple[float, float]:
    """The places [m] between which the section is solved, in the direction of the waves."""
    assert case.waves is not None
    size, depth = case.domain.size[0], case.waves.depth
    shapes = [shape_of(entry, case.dimension).bounds for entry in (*case.porous, *case.solid)]
    spans = [sorted((towards * low[0], towards * high[0])) for low, high in shapes if low[-1] < level]
    maker = towards * (case.waves.place if case.waves.zone is None else case.waves.zone.x[1 if towards > 0 else 0])
    begins = min([towards * front, *(near for near, _ in spans if near > maker)]) - AWAY * depth
    ends = max([towards * front, *(far for _, far in spans)]) + AWAY * depth if wall is None else towards * wall
    sides = sorted((0.0, towards * size))
    if begins < sides[0]:
        raise AnalysisError(f"there are less than {AWAY:g} depths of flume before the structure")
    return towards * begins, towards * min(ends, sides[1])


def _medium(case: Case, level: float, rows: int) -> Medium:
    """The medium of the flume up to the still level, which is a line of the grid, `rows` cells above the floor."""
    assert case.waves is not None
    h, size, d = level / rows, case.domain.size[0], case.dimension
    columns = max(1, round(size / h))
    grid = Grid((columns, rows + 1), (size / columns, h), (False, False))
    period = case.drag_period if case.porous else math.inf
    bodies = [porous_body(entry, d, case.fluid.viscosity, period) for entry in case.porous]
    return Medium.build(grid, bodies, [shape_of(entry, d) for entry in case.solid])
