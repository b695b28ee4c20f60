"""Published wave loads on a wall, beside those of a run: Goda, Takahashi, Sainflou."""

from __future__ import annotations

from typing import Any

from houle.design.walls import WallPressure, wall_goda, wall_sainflou, wall_takahashi
from houle.errors import CaseError
from houle.results.answers.structure import Outline, Sea
from houle.results.answers.table import Beside
from houle.waves.dispersion import GRAVITY

HIGHEST = 1.8  # H_max over H_1/3 (Goda 2000); H_1/3 is taken as H_m0 and T_1/3 as T_m-1,0
CREST = "crest level + mean rise, pressures linear between bed, still water and crest"


def pressure(sea: Sea, wall: Outline, density: float) -> WallPressure:
    """Goda's pressures of the highest wave; with Takahashi's impulsive part where a berm lies in front.

    Raises CaseError where the structure is no wall, DesignError.
    """
    if wall.kind != "wall":
        raise CaseError(f"its front is no upright wall: {wall.words}")
    given: dict[str, Any] = {
        "wave_height": HIGHEST * sea.height, "period": sea.period, "depth": wall.depth, "depth_on_berm": wall.on_berm,
        "foot": min(wall.foot, wall.depth), "crest": wall.freeboard, "depth_seaward": wall.depth, "density": density,
        "obliquity": sea.angle,
    }  # fmt: skip
    if wall.on_berm < wall.depth - 1e-6:
        return wall_takahashi(**given, berm_width=wall.berm_width)
    return wall_goda(**given)


def beside(found: WallPressure, value: float) -> Beside:
    """A load that Goda's pressures add up to, as it stands beside an answer."""
    words = (f"H_max = {HIGHEST:g} H_m0", *([found.branch] if found.branch else []), *found.outside)
    return Beside(found.formula, value, words=words)


def horizontal(sea: Sea, wall: Outline, density: float) -> Beside:
    """Horizontal wave force [N/m]; of regular waves by Sainflou. Raises CaseError, DesignError."""
    if sea.regular:
        return _sainflou(sea, wall, density)
    found = pressure(sea, wall, density)
    return beside(found, found.F)


def uplift(sea: Sea, wall: Outline, density: float, width: float) -> Beside:
    """Wave uplift [N/m] under a wall so wide [m]: a triangle from pu at its front. Raises CaseError, DesignError."""
    found = pressure(sea, wall, density)
    return beside(found, 0.5 * found.pu * width)


def overturning(sea: Sea, wall: Outline, density: float, width: float, under: bool) -> Beside:
    """Moment [N] about the heel of a wall so wide [m]: of the horizontal force, and of the uplift if water is under it.

    The triangle of uplift acts two thirds of the width from the heel. Raises CaseError, DesignError.
    """
    found = pressure(sea, wall, density)
    return beside(found, found.M + (found.pu * width**2 / 3 if under else 0.0))


def _sainflou(sea: Sea, wall: Outline, density: float) -> Beside:
    """Horizontal force [N/m] of a standing wave under its crest, beyond that of still water. Raises CaseError."""
    if wall.kind != "wall" or wall.on_berm < wall.depth - 1e-6:
        raise CaseError("Sainflou's standing wave is for a wall that goes down to the bed")
    found = wall_sainflou(wave_height=sea.height, period=sea.period, depth=wall.depth, density=density)
    weight = density * GRAVITY
    top, bed = wall.depth + found.h0 + sea.height, weight * wall.depth + found.p_bed
    force = 0.5 * bed * top - 0.5 * weight * wall.depth**2
    words = (CREST, *found.outside, "RECALLED")
    if wall.freeboard < found.h0 + sea.height:
        words = ("the crest stands higher than the wall", *words)
    return Beside(found.formula, force, words=words)
