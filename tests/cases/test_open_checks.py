"""Pre-flight of open sides: each doubt is found with both numbers; a good river is left in peace."""

import pytest

from houle.case.model import load
from houle.case.tables.boundaries import records
from houle.check import rules
from houle.check.report import open_rows
from houle.errors import CaseError

RIVER = [{"side": "left", "discharge": 0.075, "ramp": 2.0}, {"side": "right", "level": 0.25}]


def channel(sides=None, **tables):
    base = {
        "case": {"name": "channel"},
        "domain": {"size": [4.0, 0.4], "spacing": 0.02},
        "water": [{"below": 0.25}],
        "time": {"end": 20.0},
    }
    return load({**base, "open": RIVER if sides is None else sides, **tables})


def found(case):
    return [(f.level, f.key, f.text) for f in rules.check(case) if f.level != "info" and "open" in f.key + f.text]


def test_a_good_river_is_left_in_peace():
    assert found(channel()) == []
    rows = dict(open_rows(channel()))
    assert "0.3 m/s in 0.25 m of water, Froude number 0.19" in rows["left side"]
    assert "level 0.25 m" in rows["right side"]


DOUBTS = {
    "dry": ({"water": [{"box": [[0.0, 0.0], [2.0, 0.25]]}]}, "error", "two cells"),
    "stones": (
        {
            "porous": [
                {"box": [[3.0, 0.0], [4.0, 0.4]], "porosity": 0.4, "resistance": {"a": 1.0, "b": 1.0}},
            ]
        },
        "error",
        "reaches to the open right side",
    ),
    "dry, with a discharge": (
        {"water": [{"box": [[1.0, 0.0], [2.0, 0.25]]}], "sides": [{"side": "left", "discharge": 0.1}]},
        "error",
        "two cells",
    ),
    "joined": ({"domain": {"size": [4.0, 0.4], "spacing": 0.02, "walls": {"x": "periodic"}}}, "error", "periodic"),
    "lid": ({"sides": [{"side": "right", "level": 0.45}]}, "error", "the lid, 0.4 m"),
    "step": ({"sides": [{"side": "right", "level": 0.3}]}, "warning", "that of the water beside it is 0.25 m"),
    "fast": ({"sides": [{"side": "left", "velocity": 1.6, "level": 0.25, "ramp": 1.0}]}, "error", "Froude number of 1"),
    "jolt": ({"sides": [{"side": "left", "velocity": 0.3}, RIVER[1]]}, "warning", "a jolt; give ramp = 2"),
    "fills": ({"sides": [{"side": "left", "velocity": 0.01, "ramp": 1.0}]}, "warning", "mm of level"),
    "overflows": ({"sides": [{"side": "left", "velocity": 0.3, "ramp": 1.0}]}, "error", "give a level to one side"),
    "a gate near it": ({"gate": [{"x": 3.95, "speed": 1.0}]}, "error", "over which the open right side reads its"),
    "no file": ({"sides": [{"side": "left", "file": "nothing.csv"}]}, "error", "cannot be read"),
}


@pytest.mark.parametrize("doubt", DOUBTS)
def test_a_doubt_is_found(doubt):
    tables, level, words = DOUBTS[doubt]
    rows = found(channel(**tables))
    assert any(found_level == level and words in text for found_level, _, text in rows), rows


@pytest.mark.parametrize(
    ("sides", "words"),
    [
        ([{"side": "left"}], "nothing is given"),
        ([{"side": "left", "velocity": 0.1, "discharge": 0.1}], "keep one of them"),
        ([{"side": "left", "level": 0.1, "file": "a.csv"}], "given together"),
        ([{"side": "left", "velocity": 0.1, "response": 1.0}], "response belongs to level"),
        ([{"side": "left", "level": 0.1, "ramp": 1.0}], "ramp belongs"),
        ([{"side": "left", "level": 0.1}, {"side": "left", "velocity": 0.1}], "given twice"),
        ([{"side": "up", "level": 0.1}], "left"),
    ],
)
def test_bad_tables_are_refused(sides, words):
    with pytest.raises(CaseError, match=words):
        channel(sides)


def test_a_file_may_hold_a_level_and_a_velocity(tmp_path):
    file = tmp_path / "stage.csv"
    file.write_text("# a river\nt_s,level_m,velocity_m_s\n0,0.25,0.0\n10,0.3,0.2\n")
    case = channel([{"side": "left", "file": "stage.csv"}])
    known = records(case.open[0], tmp_path)
    assert known["level"].at(5.0) == pytest.approx(0.275)
    assert known["velocity"].at(99.0) == pytest.approx(0.2)
    file.write_text("t_s,discharge_m2_s,velocity_m_s\n0,1,1\n1,1,1\n")
    with pytest.raises(CaseError, match="one of velocity_m_s, discharge_m2_s, level_m"):
        records(case.open[0], tmp_path)
