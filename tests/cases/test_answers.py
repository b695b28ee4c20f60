"""The answers of a run: the section that formulas are taken for, the rows from made-up series, the files."""

from __future__ import annotations

import csv
import json
import re
from typing import Any

import numpy as np
import pytest

import houle
from houle import design
from houle.case.tables.waves import PASSING
from houle.check.rules import check, require
from houle.errors import CaseError
from houle.output.netcdf import Table, Variable, times
from houle.results.answers import bank, mound, overtopping, pressures, runup, walls
from houle.results.answers.given import Given, attempted
from houle.results.answers.outline import OutlineError, outline_of
from houle.results.answers.picture import write
from houle.results.answers.sea import NO_SEA, measured, sea_of
from houle.results.answers.table import COLUMNS, Answer, entry, lines, not_answered
from houle.waves.dispersion import wave_number

PERIOD, HEIGHT, DEPTH = 1.6, 0.10, 0.40
FLUME: dict[str, Any] = {
    "case": {"name": "flume"},
    "domain": {"size": [9.6, 0.8], "spacing": 0.02},
    "water": [{"polygon": [[0.0, 0.0], [6.0, 0.0], [6.0, 0.4], [0.0, 0.4]]}],
    "waves": {"kind": "jonswap", "height": HEIGHT, "period": PERIOD, "depth": DEPTH, "zone": {"x": [0.0, 3.5]}},
    "time": {"end": 200.0},
    "output": {"every": 5.0, "series_every": 0.01},
}
DIKE = {"name": "dike", "polygon": [[6.0, 0.0], [7.56, 0.52], [7.76, 0.52], [8.2, 0.0]]}
CAISSON = {"name": "caisson", "box": [[6.0, 0.1], [6.5, 0.55]]}
ROCK = {"porosity": 0.4, "grain_diameter": 0.03, "resistance": {"law": "van-gent-1995"}}
FOUNDATION = {"name": "berm", "polygon": [[5.6, 0.0], [5.8, 0.1], [6.7, 0.1], [6.9, 0.0]], **ROCK}
MOUND = {"name": "mound", "polygon": [[6.0, 0.0], [6.75, 0.5], [6.95, 0.5], [7.7, 0.0]], **ROCK}
CREST = [{"name": "crest", "x": 7.66}]
BANK = {"name": "b", "body": "mound", "x": [6.2, 6.6], "depth": 0.06, "friction_angle": 40.0}
FORCE = {"name": "caisson", "body": "caisson", "about": [6.25, 0.1]}
TIME = np.arange(0.0, 200.0, 0.01)


def case_with(**more: Any) -> houle.case.model.Case:
    return houle.load({**FLUME, **more})


def given_with(case: houle.case.model.Case, **series: np.ndarray) -> Given:
    """The case with a made-up series: values of one station each, (T,) or (T, 2)."""
    variables = {
        name: Variable(("station", "time", "axis")[: 1 + values.ndim], values[None], {})
        for name, values in series.items()
    }
    return Given(case, Table(variables, {"time": times(TIME)}, {}), sea_of(case))


def rows_of(questions: Any) -> dict[str, Answer]:
    return {row.name: row for question in questions for row in attempted(question)}


def test_the_sea_is_that_of_the_case():
    sea = sea_of(case_with(solid=[DIKE]))
    assert sea is not None
    assert (sea.height, sea.level, sea.maker, sea.lack) == (HEIGHT, DEPTH, 3.5, "")
    assert PERIOD / 1.2 < sea.period < PERIOD / 1.05  # T_p/1.1 of a JONSWAP spectrum
    assert PERIOD / 1.4 < sea.mean < PERIOD / 1.2
    assert sea.waves(6.0) == pytest.approx((200.0 - 3.2 - 2.5 / sea.speed) / sea.mean)


def test_a_dike_is_a_smooth_slope():
    found = outline_of(case := case_with(solid=[DIKE]), sea_of(case), 7.66)
    assert found.kind == "slope" and not found.foreshore and not found.permeable and found.berm == 0.0
    assert (found.freeboard, found.depth) == pytest.approx((0.12, DEPTH), abs=1e-6)
    assert found.cot_slope == pytest.approx(3.0, rel=0.02)


def test_a_mound_has_an_armour_with_a_crest():
    found = outline_of(case := case_with(porous=[MOUND]), sea_of(case), 6.9)
    assert found.kind == "mound" and found.permeable
    assert (found.freeboard, found.armour_crest) == pytest.approx((0.1, 0.1), abs=1e-6)
    assert found.cot_slope == pytest.approx(1.5, rel=0.03)
    assert found.crest_width == pytest.approx(0.15 + 0.03, abs=0.03)  # from the crest at 6.9 m to 6.75 m, and a spacing


def test_a_crown_wall_stands_above_the_armour():
    crown = {"name": "crown", "box": [[6.85, 0.45], [6.95, 0.6]]}
    found = outline_of(case := case_with(porous=[MOUND], solid=[crown]), sea_of(case), 6.9)
    assert found.kind == "mound"
    assert (found.freeboard, found.armour_crest) == pytest.approx((0.2, 0.1), abs=1e-6)
    assert found.crest_width == pytest.approx(0.1, abs=0.03)


def test_a_revetment_has_an_impermeable_core():
    rock = {"name": "rock", "polygon": [[5.8, 0.0], [7.36, 0.52], [7.56, 0.52], [6.0, 0.0]], **ROCK}
    found = outline_of(case := case_with(porous=[rock], solid=[DIKE]), sea_of(case), 7.66)
    assert found.kind == "mound" and not found.permeable
    assert found.cot_slope == pytest.approx(3.0, rel=0.02)


def test_a_caisson_on_a_berm_is_a_wall():
    found = outline_of(case := case_with(porous=[FOUNDATION], solid=[CAISSON]), sea_of(case), 6.25)
    assert (found.kind, found.cot_slope) == ("wall", 0.0)
    assert (found.freeboard, found.depth, found.on_berm, found.foot) == pytest.approx((0.15, 0.4, 0.3, 0.3), abs=0.005)
    assert found.x == pytest.approx(6.0, abs=0.005) and found.berm_width == pytest.approx(0.2, abs=0.03)


def test_a_foreshore_is_told_from_the_structure():
    bed = {"name": "bed", "polygon": [[4.0, 0.0], [6.5, 0.1], [9.6, 0.1], [9.6, 0.0]]}
    wall = {"name": "wall", "box": [[6.5, 0.0], [6.8, 0.6]]}
    found = outline_of(case := case_with(solid=[bed, wall]), sea_of(case), 6.65)
    assert found.kind == "wall" and found.foreshore
    assert found.depth == pytest.approx(0.3, abs=0.005)


def test_a_mirrored_flume_has_the_same_section():
    waves = {**FLUME["waves"], "source": {"x": 6.1, "side": "left", "form": "finite"}}
    del waves["zone"]
    mirrored = {"name": "dike", "polygon": [[9.6 - x, z] for x, z in DIKE["polygon"]]}
    left = outline_of(case := case_with(waves=waves, solid=[mirrored]), sea_of(case), 9.6 - 7.66)
    right = outline_of(case := case_with(solid=[DIKE]), sea_of(case), 7.66)
    for name in ("freeboard", "cot_slope", "depth", "crest_width"):
        assert getattr(left, name) == pytest.approx(getattr(right, name), abs=0.03), name


@pytest.mark.parametrize(
    ("bodies", "x", "words"),
    [
        ({"solid": [DIKE]}, 5.0, "nothing stands above still water"),
        ({"porous": [{"name": "block", "box": [[6.0, 0.0], [7.0, 0.6]], **ROCK}]}, 6.5, "upright porous face"),
        ({"solid": [DIKE]}, 3.5, "at the maker"),
    ],
)
def test_a_section_that_no_formula_knows_says_why(bodies, x, words):
    case = case_with(**bodies)
    with pytest.raises(OutlineError, match=words):
        outline_of(case, sea_of(case), x)


def overtopped() -> tuple[np.ndarray, int, np.ndarray]:
    """Volume so far of a crest that every fourth wave of 1.25 s overtops, from 10 s on; their number and volumes."""
    starts = np.arange(10.0, 190.0, 5.0)
    sizes = 0.004 * np.random.default_rng(5).weibull(0.9, len(starts)) + 0.0005
    record = np.zeros_like(TIME)
    for start, size in zip(starts, sizes, strict=True):
        record += size * (1 - np.cos(np.pi * np.clip((TIME - start) / 0.4, 0.0, 1.0))) / 2
    return record, len(starts), sizes


def test_overtopping_stands_beside_formula_and_tests():
    record, count, sizes = overtopped()
    case = case_with(solid=[DIKE], overtopping=CREST)
    given = given_with(case, overtopping_volume=record)
    found = rows_of(overtopping.questions(given))
    mean = found["overtopping crest, mean discharge"]
    seconds = TIME[-1] - given.sea.start(7.66)
    assert mean.value == pytest.approx(sizes.sum() / seconds, rel=2e-3)
    assert mean.low < mean.value < mean.high
    sea = given.sea
    outline = outline_of(case, sea, 7.66)
    eurotop = design.overtopping_slope(
        wave_height=HEIGHT, period=sea.period, freeboard=outline.freeboard, cot_slope=outline.cot_slope
    )
    (beside,) = mean.formulas
    assert (beside.value, beside.low, beside.high) == pytest.approx((eurotop.q, eurotop.low, eurotop.q_design))
    assert mean.tests is not None and len(mean.tests.points) == 5
    assert mean.tests.value == pytest.approx(np.exp(np.mean(np.log(mean.tests.points))))
    litres = found["overtopping crest, the same in litres"]
    assert litres.value == pytest.approx(1e3 * mean.value) and litres.unit == "l/s/m"
    share = found["overtopping crest, share of the waves"]
    assert share.value == pytest.approx(count / round(given.waves(7.66)))
    assert found["overtopping crest, V_max"].value == pytest.approx(sizes.max(), rel=2e-3)
    shape = found["overtopping crest, Weibull b"]
    assert shape.low < shape.value < shape.high
    assert "R_c 0.12 m" in mean.note and "H_m0 0.1 m" in mean.note


def test_both_rules_of_a_mound_are_named():
    record, _, _ = overtopped()
    case = case_with(porous=[MOUND], overtopping=[{"name": "crest", "x": 6.85, "level": 0.5}])
    mean = rows_of(overtopping.questions(given_with(case, overtopping_volume=record)))[
        "overtopping crest, mean discharge"
    ]
    assert [one.name for one in mean.formulas] == [
        "overtopping-mound, gamma_f by eurotop-2018", "overtopping-mound, gamma_f by taw-2002",
    ]  # fmt: skip
    assert mean.formulas[0].value < mean.formulas[1].value
    cells = mean.cells()
    assert cells["formula_2"] == mean.formulas[1].name and cells["formula_2_value"] == mean.formulas[1].value


def test_a_dry_crest_says_how_many_waves_stayed_in_front():
    case = case_with(solid=[DIKE], overtopping=CREST)
    found = rows_of(overtopping.questions(given_with(case, overtopping_volume=np.zeros_like(TIME))))
    mean = found["overtopping crest, mean discharge"]
    assert mean.value == 0.0 and "waves came over" in mean.note and np.isnan(mean.low)
    assert mean.formulas


def test_waves_that_are_no_sea_have_no_formula():
    waves = {**FLUME["waves"], "kind": "regular"}
    case = case_with(solid=[DIKE], overtopping=CREST, waves=waves)
    mean = rows_of(overtopping.questions(given_with(case, overtopping_volume=overtopped()[0])))
    row = mean["overtopping crest, mean discharge"]
    assert row.formulas == () and row.tests is None and "no formula: the waves are all alike" in row.note


def test_waves_that_pass_once_are_no_sea():
    assert set(PASSING) | {"regular"} == set(NO_SEA)


def test_one_wave_is_no_three():
    """A solitary wave comes over once: the volume and the highest run-up, however long the run beside its "period"."""
    waves = {"kind": "solitary", "height": HEIGHT, "depth": DEPTH, "zone": {"x": [0.0, 3.5]}}
    tables = {"waves": waves, "solid": [DIKE], "overtopping": CREST, "runup": [{"name": "r", "x": [6.0, 7.66]}]}
    given = given_with(
        case_with(**tables),
        overtopping_volume=0.02 * np.clip(TIME - 4.0, 0.0, 1.0),
        runup_level=DEPTH + 0.1 * np.exp(-((TIME - 4.0) ** 2)),
    )
    short = Given(given.case, cut(given.series, 8.0), given.sea)
    found = rows_of([*overtopping.questions(short), *runup.questions(short)])
    assert found["overtopping crest, volume"].value == pytest.approx(0.02)
    assert not any("share" in name for name in found)
    assert found["run-up r, R_max"].value == pytest.approx(0.1)


def cut(series: Table, end: float) -> Table:
    """The rows of a made-up series up to a time [s]."""
    keep = end >= TIME
    rows = {name: Variable(one.dims, one.values[:, keep], {}) for name, one in series.variables.items()}
    return Table(rows, {"time": times(TIME[keep])}, {})


def test_a_run_that_ends_too_soon_is_a_row():
    case = case_with(solid=[DIKE], overtopping=CREST)
    given = given_with(case, overtopping_volume=np.zeros_like(TIME))
    early = TIME < 5.0
    series = Table({"overtopping_volume": Variable(("station", "time"), np.zeros((1, early.sum())), {})},
                   {"time": times(TIME[early])}, {})  # fmt: skip
    (row,) = rows_of(overtopping.questions(Given(case, series, given.sea))).values()
    assert not row.answered and row.note.startswith("not answered: the waves arrive at x = 7.66 m")


def test_run_up_of_the_highest_waves():
    heights = 0.08 + 0.001 * (np.arange(160) % 50)
    phase = TIME / 1.25
    wave = np.minimum(phase.astype(int), 159)
    level = DEPTH + np.where(np.sin(2 * np.pi * phase) > 0, heights[wave], 0.05) * np.sin(2 * np.pi * phase)
    high = {"name": "dike", "polygon": [[6.0, 0.0], [8.1, 0.7], [8.2, 0.7], [8.2, 0.0]]}
    case = case_with(solid=[high], runup=[{"name": "front", "x": [6.2, 8.1]}])
    found = rows_of(runup.questions(given_with(case, runup_level=level)))
    two, most = found["run-up front, R_2%"], found["run-up front, R_max"]
    assert most.value == pytest.approx(heights.max(), rel=1e-3)
    assert 0.08 < two.low <= two.value <= two.high <= most.value
    assert two.formulas[0].name == "run-up-slope" and "over the crest" not in two.note


def loads(peak: float, horizontal: float = 0.0, up: float = 1471.5) -> tuple[np.ndarray, np.ndarray]:
    """Force (T, 2) and moment (T,) about the middle of the base: half-sine impacts of 0.5 s, every tenth second."""
    pulse = np.where(TIME % 10 < 0.5, np.sin(np.pi * (TIME % 10) / 0.5), 0.0) * (TIME > 20)
    force = np.stack([horizontal + peak * pulse, up + 0.0 * TIME], axis=-1)
    return force, 0.15 * force[:, 0]  # it acts 0.15 m above the base


def given_wall(**force: Any) -> Given:
    return given_forces(*loads(600.0), **force)


def given_forces(values: np.ndarray, moment: np.ndarray, **force: Any) -> Given:
    case = case_with(
        porous=[FOUNDATION], solid=[CAISSON], force=[{**FORCE, **force}], water=[{"below": 0.4}]
    )  # fmt: skip
    series = given_with(case, force=values, moment=moment).series
    about = {
        f"structure_about_{axis}": Variable(("station",), np.array([at]), {}) for axis, at in (("x", 6.25), ("z", 0.1))
    }
    return Given(case, Table({**series.variables, **about}, series.coordinates, {}), sea_of(case))


def test_a_wall_has_impulse_force_uplift_and_moment():
    found = rows_of(walls.questions(given_wall()))
    assert next(iter(found)) == "force caisson, largest impulse landward"
    assert found["force caisson, largest impulse landward"].value == pytest.approx(2 * 600 * 0.5 / np.pi, rel=1e-3)
    largest = found["force caisson, F_max landward"]
    assert largest.value == pytest.approx(600.0, rel=1e-3) and largest.formulas[0].name == "wall-takahashi"
    # about the heel at (6.5, 0.1): the lever of the horizontal force stays, buoyancy is at rest
    assert found["force caisson, overturning moment"].value == pytest.approx(0.15 * 600.0, rel=1e-3)
    assert not found["force caisson, F_1/250"].answered and "250 are the least" in found["force caisson, F_1/250"].note
    assert not found["force caisson, uplift"].answered  # it stands still


def test_a_wall_with_a_weight_has_a_factor_of_safety():
    """Least of 0.6 (3000 - 1471.5)/600, and of (3000 - 1471.5) 0.25/(600 x 0.15)."""
    found = rows_of(walls.questions(given_wall(weight=3000.0, friction=0.6)))
    assert found["safety caisson, sliding"].value == pytest.approx(0.6 * (3000 - 1471.5) / 600, rel=1e-3)
    assert found["safety caisson, tilting"].value == pytest.approx((3000 - 1471.5) * 0.25 / (600 * 0.15), rel=1e-3)
    floats = rows_of(walls.questions(given_wall(weight=1000.0)))
    assert "still water lifts" in floats["safety caisson"].note


def test_a_factor_of_safety_that_is_none_says_why():
    """A wall that tips in still water; one that no load moves; one that the water lifts has no friction left."""
    seaward = rows_of(walls.questions(given_wall(weight=3000.0, heel=[5.0, 0.1])))
    assert "tips in still water" in seaward["safety caisson"].note
    still = list(walls.questions(given_loads(0.0 * TIME, weight=3000.0, friction=0.6)))
    for name in ("sliding", "tilting"):
        assert rows_of(still)[f"safety caisson, {name}"].note.startswith("not answered: no load of the waves")
    lifted = rows_of(walls.questions(given_loads(600.0 * np.sin(TIME), weight=1600.0, friction=0.6)))
    assert lifted["safety caisson, sliding"].value == 0.0


def given_loads(load: np.ndarray, **force: Any) -> Given:
    """The caisson under a load (T,) along x, and as large a one upwards beside its buoyancy."""
    values, moment = np.stack([load, 1471.5 + load], axis=1), 0.15 * load
    return given_forces(values, moment, **force)


@pytest.mark.parametrize("side", ["bottom", "top"])
def test_a_floor_is_no_wall(side):
    case = case_with(water=[{"below": 0.4}], force=[{"name": "F", "side": side}])
    found = rows_of(walls.questions(given_with(case, force=np.stack([TIME, TIME], axis=1), moment=TIME)))
    assert list(found) == ["force F"] and "no wall" in found["force F"].note


def test_water_that_flows_back_has_no_interval():
    """More comes back than went over: an interval about the mean discharge would begin above its end."""
    record = sum(size * np.clip(TIME - at, 0.0, 1.0) for at, size in ((20, -0.01), (50, 1e-3), (80, 1e-3), (110, 1e-3)))
    found = rows_of(
        overtopping.questions(given_with(case_with(solid=[DIKE], overtopping=CREST), overtopping_volume=record))
    )
    q = found["overtopping crest, mean discharge"]
    assert q.value < 0.0 and np.isnan([q.low, q.high]).all() and "flowed back" in q.note


def test_waves_of_less_than_a_cell_came_over_all_the_same():
    case = case_with(solid=[DIKE], overtopping=CREST)
    found = rows_of(overtopping.questions(given_with(case, overtopping_volume=1e-5 * TIME)))
    q = found["overtopping crest, mean discharge"]
    assert q.value == pytest.approx(1e-5) and "less than a cell" in q.note and "came over" not in q.note
    assert not found["overtopping crest, share of the waves"].answered


def test_volumes_that_are_alike_have_no_shape():
    case, record = case_with(solid=[DIKE], overtopping=CREST), np.zeros_like(TIME)
    for start in np.arange(10.0, 190.0, 5.0):
        record += 0.004 * (1 - np.cos(np.pi * np.clip((TIME - start) / 0.4, 0.0, 1.0))) / 2
    found = rows_of(overtopping.questions(given_with(case, overtopping_volume=record)))
    assert found["overtopping crest, V_max"].value == pytest.approx(0.004, rel=1e-3)
    assert "too much alike" in found["overtopping crest, Weibull b"].note


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"waves": None, "solid": [CAISSON], "force": [{**FORCE, "weight": 900.0}]}, "caisson.weight = 900 N/m is"),
        ({"solid": [DIKE], "overtopping": [{"name": "c", "x": 2.0}]}, r"c.x = 2 lies in waves.zone, 0 to 3.5"),
        ({"solid": [DIKE], "overtopping": [{"name": "c", "x": 5.0}]}, r"c.x = 5: 0.4 m of still water stands"),
        (
            {"solid": [DIKE], "overtopping": CREST, "time": {"end": 40.0, "until": {"waves": 100}}},
            r"time.until.waves = 100: until time.end = 40 s some \d+ waves come: time.end = 1\d\d",
        ),
        (
            {"waves": None, "porous": [MOUND], "bank": [{**BANK, "x": [7.1, 7.6]}],
             "water": [{"box": [[0.0, 0.0], [5.0, 0.4]]}]},
            r"bank.b.x = \[7.1, 7.6\]: no water stands there at the start",
        ),
        (
            {"porous": [MOUND], "bank": [{**BANK, "friction_angle": 30.0}]},
            r"bank.b.friction_angle = 30 degrees is less than the 33.7 of the face",
        ),
    ],
)  # fmt: skip
def test_check_says_what_is_not_answered(tables, said):
    """One warning each, and none of the kind for a section as it should be."""
    tables = {**FLUME, **tables}
    found = [
        f for f in check(houle.load({k: v for k, v in tables.items() if v is not None})) if re.search(said, str(f))
    ]
    assert [f.level for f in found] == ["warning"]


def test_a_section_as_it_should_be_is_not_warned_of():
    case = case_with(
        porous=[MOUND], overtopping=[{"name": "c", "x": 6.85}], bank=[BANK],
        time={"end": 400.0, "until": {"waves": 100}},
    )  # fmt: skip
    said = "not used|lies in waves.zone|to and fro|waves come|no water stands|is less than the"
    assert not [str(f) for f in check(case) if re.search(said, str(f))]


def test_a_bank_whose_plane_stayed_dry_has_no_exit_gradient():
    """A number that is not finite is a row that says why: infinite as computed, None as read from run.json."""
    safe, worst = {"value": 1.5, "x": 1.0, "time": 2.0}, {"x": 1.0, "time": 0.0}
    for value in (-np.inf, None):
        entry = {
            "bank": "b", "safety": safe, "still": 1.5, "unstable": 0.0, "gradient": {**worst, "value": value},
            "critical": 0.9, "lifting": 0.0, "excess": safe, "shields": None,
        }  # fmt: skip
        found = rows_of(bank.questions(Given(case_with(), Table({}, {}, {}), None), [[entry]]))
        assert found["bank b, exit gradient"].note.startswith("not answered: the face is level, or the plane")
        assert found["bank b, factor of safety"].value == 1.5


def test_a_slope_that_stayed_dry_has_no_highest_level():
    flume = {key: table for key, table in FLUME.items() if key != "waves"}
    case = houle.load({**flume, "runup": [{"name": "r", "x": [7.0, 9.0]}]})
    found = rows_of(runup.questions(given_with(case, runup_level=np.full(len(TIME), np.nan))))
    assert found["run-up r"].note == "not answered: no water stood on it in the whole run"


@pytest.mark.parametrize(
    ("force", "words"),
    [
        ({"side": "right", "weight": 10.0}, ["weight", "[[solid]]"]),
        ({"body": "caisson", "friction": 0.6}, ["weight", "is missing"]),
        ({"body": "caisson", "weight": -1.0}, ["weight"]),
    ],
)
def test_a_weight_belongs_to_a_solid(force, words):
    with pytest.raises(CaseError) as caught:
        case_with(solid=[CAISSON], force=[{"name": "F", **force}])
    for word in words:
        assert word in str(caught.value)


def test_the_instrument_does_not_know_the_weight():
    """Keys for what is made of the results never reach the solver: the same bits with them and without."""
    from houle.case.build import asked_for, site_of

    heavy = case_with(solid=[CAISSON], force=[{**FORCE, "weight": 3000.0, "friction": 0.6}])
    plain = case_with(solid=[CAISSON], force=[FORCE])
    assert asked_for(heavy, "force", site_of(heavy)).them == asked_for(plain, "force", site_of(plain)).them


def test_pressures_count_from_rest():
    case = case_with(sensor=[{"name": "P1", "at": [5.0, 0.2]}])
    swing = 300.0 * np.sin(2 * np.pi * TIME / 1.25)
    found = rows_of(pressures.questions(given_with(case, pressure=2000.0 + swing)))
    assert found["pressure P1, p_max"].value == pytest.approx(300.0, rel=2e-3)
    assert found["pressure P1, p_1/10"].value == pytest.approx(300.0, rel=5e-3)


def test_a_recorded_sea_is_taken_from_a_gauge(tmp_path):
    np.savetxt(tmp_path / "eta.csv", np.stack([TIME, 0.02 * np.sin(2 * np.pi * TIME / 1.5)], axis=1), delimiter=",",
               header="t_s,eta_m", comments="")  # fmt: skip
    waves = {"kind": "series", "file": str(tmp_path / "eta.csv"), "depth": DEPTH, "zone": {"x": [0.0, 3.5]}}
    case = case_with(waves=waves, gauge=[{"name": "G1", "x": 4.0}])
    sea = sea_of(case)
    assert sea is not None and "record" in sea.lack
    eta = DEPTH + 0.02 * np.sin(2 * np.pi * TIME / 1.5)
    values = {"eta": Variable(("gauge", "time"), eta[None], {}), "gauge_x": Variable(("gauge",), np.array([4.0]), {})}
    names = Variable(("gauge",), np.array(["G1"], dtype=object), {})
    table = Table(values, {"time": times(TIME), "gauge": names}, {})
    found = measured(sea, case, table, {})
    assert not found.lack
    assert (found.height, found.period) == pytest.approx((4 * 0.02 / np.sqrt(2), 1.5), rel=0.03)
    assert measured(sea, case, Table({}, {"time": times(TIME)}, {}), {}).lack.endswith("no gauge stands offshore")


def test_the_check_tells_how_much_water_a_wave_is():
    fine = case_with(solid=[DIKE], overtopping=CREST, domain={"size": [9.6, 0.8], "spacing": 0.01})
    coarse = case_with(solid=[DIKE], overtopping=CREST)
    said = {
        h: [f for f in check(c) if f.key.startswith("overtopping")] for h, c in (("fine", fine), ("coarse", coarse))
    }
    assert [f.level for f in said["fine"]] == ["info"] and [f.level for f in said["coarse"]] == ["warning"]
    spacing = float(said["coarse"][0].text.rpartition("domain.spacing = ")[2])
    cells = float(said["coarse"][0].text.split(" l/m each, ")[1].split(" cells")[0])
    assert spacing == pytest.approx(0.02 * np.sqrt(cells / 20), rel=0.05)
    require(coarse)


def test_the_table_and_the_summary_hold_the_same():
    rows = [Answer("a", 1.0, "m", 0.5, 2.0, "m."), not_answered("b", "no\nwater")]
    found = entry(rows)
    assert list(found["rows"][0]) == list(COLUMNS) and found["confidence"] == 0.90
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    assert lines(found) == [("a", "1 (0.5 to 2) m"), ("b", "not answered: no water")]


def test_nothing_beside_is_no_picture(tmp_path):
    assert write(tmp_path / "a.png", "t", [Answer("a", 1.0, "m", group="force")]) is None


def test_a_short_run_leaves_its_answers(tmp_path):
    """A finished run is not failed by a question that it cannot answer; nor by one that it can."""
    case = case_with(
        domain={"size": [4.2, 0.5], "spacing": 0.05}, water=[{"below": 0.25}],
        waves={"kind": "jonswap", "height": 0.08, "period": 1.0, "depth": 0.25, "zone": {"x": [0.0, 1.5]}, "ramp": 0.5},
        solid=[{"name": "wall", "box": [[3.0, 0.0], [3.3, 0.28]]}],
        overtopping=[{"name": "crest", "x": 3.15}], force=[{"name": "wall", "body": "wall", "weight": 9000.0}],
        runup=[{"name": "face", "x": [2.0, 3.0]}], sensor=[{"name": "P1", "at": [2.9, 0.1]}],
        time={"end": 6.0}, output={"every": 2.0, "series_every": 0.02},
    )  # fmt: skip
    run = houle.run(case, tmp_path / "run", threads=1)
    assert run.summary["finished"]
    found = run.summary["answers"]["rows"]
    with (run.directory / "answers.csv").open(encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    assert [row["name"] for row in table] == [row["name"] for row in found]
    assert tuple(table[0]) == COLUMNS
    for row, kept in zip(table, found, strict=True):
        assert (float(row["value"]) if row["value"] else None) == kept["value"]
        assert kept["value"] is not None or kept["note"].startswith("not answered: ")
    volume = run.series.overtopping_volume.values[0]
    mean = next(row for row in found if row["name"].endswith("mean discharge"))
    late = run.series.time.values >= sea_of(run.case).start(3.15)
    assert mean["value"] == pytest.approx((volume[-1] - volume[late][0]) / np.ptp(run.series.time.values[late]))
    assert (run.directory / "answers.png").exists()


def test_sensors_at_one_level_in_a_core_tell_the_decay_beside_the_formula():
    """A third one in the row above, one in the water, and one alone in its row are not taken."""
    places = {"P1": [6.6, 0.2], "P2": [6.9, 0.205], "P3": [7.1, 0.2], "alone": [6.8, 0.3], "water": [5.0, 0.2]}
    sensors = [{"name": name, "at": at} for name, at in places.items()]
    case, rate = case_with(porous=[MOUND], sensor=sensors), 1.5
    record = np.stack([
        1000.0 + 200.0 * np.exp(-rate * (x - 6.3)) * np.sin(2 * np.pi * TIME / 1.6) for x, _ in places.values()
    ])  # fmt: skip
    series = Table({"pressure": Variable(("sensor", "time"), record, {})}, {"time": times(TIME)}, {})
    sea = sea_of(case)
    decay, gradient = rows_of(mound.questions(Given(case, series, sea))).values()
    length = 2 * np.pi / wave_number(2 * np.pi / PERIOD, DEPTH)
    assert decay.value == pytest.approx(rate * length / np.sqrt(1.4) / (2 * np.pi), rel=1e-3)
    assert decay.low == pytest.approx(decay.high, rel=0.02) and "P1, P2, P3" in decay.method
    width = 1.7 - 0.2 * (1.5 + 1.5)  # of the mound at 0.2 m
    expected = 0.0141 * np.sqrt(0.4) * length**2 / (HEIGHT * width)
    assert decay.formulas[0].value == pytest.approx(expected, rel=0.005)
    fall = np.exp(-rate * 0.3) - np.exp(-rate * 0.8)
    assert gradient.value == pytest.approx(200.0 * fall / (9810.0 * 0.5), rel=0.01)
    record[1, 9000] = 0.0
    (row,) = rows_of(mound.questions(Given(case, series, sea))).values()
    assert "sensor P2 falls dry" in row.note


def test_the_set_up_of_a_phreatic_line_is_that_of_its_highest_place():
    case = case_with(porous=[MOUND], phreatic=[{"name": "line", "body": "mound", "x": [6.7, 6.8, 6.9]}])
    swing = 0.01 * np.sin(2 * np.pi * TIME / 1.6)
    levels = DEPTH + np.stack([0.02 + swing, 0.03 + swing, np.where(TIME > 100.0, np.nan, 0.05)])
    series = Table(
        {
            "phreatic": Variable(("phreatic",), np.array(["line"] * 3), {}),
            "phreatic_x": Variable(("phreatic",), np.array([6.7, 6.8, 6.9]), {}),
            "phreatic_level": Variable(("phreatic", "time"), levels, {}),
        },
        {"time": times(TIME)},
        {},
    )
    (row,) = rows_of(mound.questions(Given(case, series, sea_of(case)))).values()
    assert row.value == pytest.approx(0.03, abs=2e-4) and row.low <= row.value <= row.high
    assert "x = 6.8 m, the highest of 2 places" in row.note
