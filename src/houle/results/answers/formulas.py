"""Published formulas and the nearest laboratory tests, beside the answers of a run."""

from __future__ import annotations

from typing import Any

from houle.design.formula import Answer as Published
from houle.design.nearest import NearestTests, nearest_tests
from houle.design.overtopping import (
    overtopping_mound,
    overtopping_slope,
    overtopping_wall,
    overtopping_wall_foreshore,
)
from houle.design.reflection import reflection_slope
from houle.design.roughness import ROUGHNESS
from houle.design.runup import run_up_slope, run_up_solitary
from houle.design.sea import discharge
from houle.design.share import AT_A_WALL, overtopping_share
from houle.results.answers.structure import Outline, Sea
from houle.results.answers.table import Beside

FEWEST = 1e-5  # q / sqrt(g Hm0^3) of the tests in the table, at least
COUNT = 5  # laboratory tests beside an answer
RULES = ("eurotop-2018", "taw-2002")  # rules for the roughness of mounds in long waves


def beside(found: Published, name: str = "") -> Beside:
    """The answer of a formula as it stands beside that of a run."""
    words = (found.branch, *found.outside, "" if found.verified else "RECALLED")
    return Beside(name or found.formula, found.value, found.low, found.high, tuple(w for w in words if w))


def roughness(outline: Outline) -> float:
    """Roughness factor gamma_f of the front: 1 of solids; porous armour counts as two layers of rock."""
    core = "permeable" if outline.permeable else "impermeable"
    return ROUGHNESS[f"rock, two layers, {core} core"] if outline.kind == "mound" else 1.0


def mean_overtopping(sea: Sea, outline: Outline) -> tuple[Beside, ...]:
    """Mean discharge [m3/s/m] by EurOtop (2018); of a mound by both rules of roughness. Raises DesignError."""
    waves: dict[str, Any] = {"wave_height": sea.height, "freeboard": outline.freeboard}
    slope: dict[str, Any] = {"period": sea.period, "cot_slope": outline.cot_slope, "obliquity": sea.angle}
    if outline.kind == "wall" and outline.foreshore:
        return (beside(overtopping_wall_foreshore(**waves, period=sea.period, depth=outline.depth)),)
    if outline.kind == "wall":
        return (beside(overtopping_wall(**waves)),)
    if outline.kind == "slope":
        return (beside(overtopping_slope(**waves, **slope)),)
    mound: dict[str, Any] = {
        "roughness": roughness(outline),
        "permeable": outline.permeable,
        "crest_width": outline.crest_width,
    }
    return tuple(
        beside(found, f"{found.formula}, gamma_f by {rule}")
        for rule in RULES
        for found in (overtopping_mound(**waves, **slope, **mound, roughness_rule=rule),)
    )


def laboratory_tests(sea: Sea, outline: Outline) -> Beside:
    """The nearest laboratory tests of mean overtopping [m3/s/m], at the size of the case. Raises DesignError."""
    waves: dict[str, Any] = {"wave_height": sea.height, "period": sea.period, "depth": outline.depth}
    more: dict[str, Any] = {}
    if outline.kind != "wall":
        more["cot_slope"] = outline.cot_slope
    if outline.kind == "mound":
        more |= {"roughness": roughness(outline), "crest_width": outline.crest_width}
        more["armour_crest"] = outline.armour_crest
    found: NearestTests = nearest_tests(kind=outline.kind, freeboard=outline.freeboard, count=COUNT, **waves, **more)
    rows = tuple(f"row {n.test.row} of CLASH: q {n.q:.3g}, distance {n.distance:.2f}" for n in found.tests)
    less = min(one.value for one in mean_overtopping(sea, outline)) < FEWEST * discharge(sea.height)
    cut = f"the database has no test below q* = {FEWEST:g}, so its nearest let more water over" if less else ""
    words = tuple(w for w in (*rows, *found.outside, cut) if w)
    return Beside("CLASH", found.q, found.low, found.high, words, tuple(n.q for n in found.tests))


def run_up(sea: Sea, outline: Outline) -> Beside:
    """Run-up R_2% above still water [m]; at a wall by the rule of Franco et al. Raises DesignError."""
    if outline.kind == "wall":
        return Beside("R_2% 1.8 H_m0 of a wall", AT_A_WALL * sea.height, words=("RECALLED",))
    found = run_up_slope(
        wave_height=sea.height, period=sea.period, cot_slope=outline.cot_slope, roughness=roughness(outline),
        permeable=outline.permeable, obliquity=sea.angle,
    )  # fmt: skip
    return beside(found)


def solitary_run_up(height: float, sea: Sea, outline: Outline) -> Beside:
    """Run-up [m] of a solitary wave of this height on a smooth slope. Raises DesignError."""
    return beside(run_up_solitary(wave_height=height, depth=sea.depth, cot_slope=outline.cot_slope))


def share(sea: Sea, outline: Outline) -> Beside:
    """Share of the waves that overtop [-]. Raises DesignError."""
    return beside(overtopping_share(freeboard=outline.freeboard, run_up=run_up(sea, outline).value))


def reflection(sea: Sea, outline: Outline) -> Beside:
    """Reflection coefficient of a slope. Raises DesignError."""
    return beside(
        reflection_slope(
            wave_height=sea.height, period=sea.period, cot_slope=outline.cot_slope, roughness=roughness(outline)
        )
    )
