"""time.until: a run ends as soon as its answers are as sure as the case asks."""

import shutil

import numpy as np
import pytest

import houle
from houle.case.model import load
from houle.errors import CaseError
from houle.output import read_manifest, write_manifest
from houle.results import reflection
from houle.results.answers.enough import asked, entry
from houle.results.answers.record import answers
from houle.results.answers.table import Answer, not_answered
from houle.results.answers.until import lines
from houle.running.goal import WAVES, Goal

PERIOD = 1.3  # s
END = 2 * WAVES * PERIOD  # s
TANK = {
    "case": {"name": "sea"},
    "domain": {"size": [4.0, 0.7], "spacing": 0.1},
    "water": [{"below": 0.4}],
    "waves": {"kind": "jonswap", "height": 0.12, "period": PERIOD, "depth": 0.4, "zone": {"x": [0.0, 1.5]}},
    "solid": [{"box": [[3.2, 0.0], [4.0, 0.45]]}],
    "overtopping": [{"name": "crest", "x": 3.3, "level": 0.45}],
    "gauge": [{"name": "G1", "x": 1.8}, {"name": "G2", "x": 2.05}, {"name": "G3", "x": 2.4}],
    "reflection": {"structure": [3.2], "gauges": ["G1", "G2", "G3"], "twin": False},
    "time": {"end": 100.0, "until": {"waves": 30}},
    "output": {"every": 0.5, "series_every": 0.05},
}


def tank(**until):
    return load(TANK, {"time.until": until})


def test_more_waves_make_it_so_by_the_root_of_their_number():
    """An interval of +-60 % after 50 waves is one of +-30 % after 200."""
    row = Answer("overtopping crest, mean discharge", 1e-3, "m3/s/m", 0.4e-3, 1.6e-3)
    (found,) = asked(tank(q=0.3), [row], 50.0)
    assert found.half == pytest.approx(0.6) and not found.met and found.more == 150
    (found,) = asked(tank(q=0.7), [row], 50.0)
    assert found.met and found.more == 0


def test_an_answer_without_an_interval_is_not_sure():
    failed = not_answered("overtopping crest", "2 waves came")
    for rows in ([], [failed], [Answer("overtopping crest, mean discharge", 0.0, "m3/s/m")]):
        found = asked(tank(q=0.3, waves=30), rows, 12.0)
        assert [one.met for one in found] == [False, False]
        assert found[1].more == 18
        told = dict(lines(entry(found)["until"]))
        assert told == {"overtopping crest, mean discharge": "no interval yet, +-30.0% asked", "waves": "12 of 30"} or (
            not rows and told["overtopping, mean discharge"].startswith("no interval yet")
        )


def test_every_crest_has_to_be_sure():
    rows = [
        Answer("overtopping one, mean discharge", 1.0, "m3/s/m", 0.9, 1.1),
        Answer("overtopping two, mean discharge", 1.0, "m3/s/m", 0.5, 1.5),
        Answer("overtopping two, Weibull b", 1.0, "-", 0.1, 2.0),
    ]
    assert [one.met for one in asked(tank(q=0.2), rows, 100.0)] == [True, False]


@pytest.mark.parametrize(
    ("until", "message"),
    [
        ({}, "asks for nothing"),
        ({"q": None}, "asks for nothing"),
        ({"q": 30}, "time.until.q = 30"),
        ({"run_up": 0.1}, "asks for an answer of ..runup.., which is not there"),
        ({"wave": 3}, "time.until.wave"),
    ],
)
def test_what_cannot_be_asked_is_refused(until, message):
    with pytest.raises(CaseError, match=message):
        tank(**until)


def test_waves_that_pass_once_cannot_be_counted():
    with pytest.raises(CaseError, match="passes once"):
        load(TANK, {"waves": {"kind": "solitary", "height": 0.1, "depth": 0.4, "zone": {"x": [0.0, 1.5]}}})


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The run in one go. Looks come every 20 periods; the second sees 30 waves."""
    return houle.run(TANK, out=tmp_path_factory.mktemp("until") / "whole", threads=1)


@pytest.fixture
def folder(whole, tmp_path):
    """A copy of its folder."""
    return shutil.copytree(whole.directory, tmp_path / "copy")


def test_it_ends_where_the_answers_are_sure(whole):
    (waves,) = whole.summary["until"]
    assert whole.summary["finished"] and whole.summary["time"] == END < TANK["time"]["end"]
    assert waves["met"] and 30 <= waves["half"] < END
    assert float(whole.series.time[-1]) == END


def test_it_ends_at_the_same_step_wherever_it_was_stopped_before(whole, tmp_path):
    parts = houle.run(TANK, out=tmp_path / "parts", threads=1, until=WAVES * PERIOD + 0.7)
    assert not parts.summary["finished"]
    parts = houle.resume(tmp_path / "parts", threads=1)
    assert parts.summary["time"] == END and parts.summary["steps"] == whole.summary["steps"]
    for name in whole.series.data_vars:
        assert np.array_equal(whole.series[name].values, parts.series[name].values, equal_nan=True)


def test_a_look_at_the_reflection_sees_what_the_end_says(whole):
    seen, said = reflection.look(whole)["reflection"], whole.summary["reflection"]
    assert seen["C_R"] == said["C_R"] and list(seen["interval_R"]) == list(said["interval_R"])
    (row,) = [row for row in whole.summary["answers"]["rows"] if row["name"].startswith("reflection, C_R")]
    half = (row["high_90"] - row["low_90"]) / 2
    for target, met in ((half * 1.01, True), (half * 0.99, False)):
        (found,) = asked(tank(reflection=target), answers(whole, {"reflection": seen}), 40.0)
        assert found.met == met and found.half == pytest.approx(half)


def test_a_run_that_was_killed_after_it_was_sure_ends_there(whole, folder):
    """Its last checkpoint stands at the look; that is taken again."""
    write_manifest(folder, {**read_manifest(folder), "finished": False})
    again = houle.resume(folder, threads=1)
    assert again.summary["finished"] and again.summary["steps"] == whole.summary["steps"]


def test_a_run_that_was_sure_can_be_prolonged(folder):
    assert houle.resume(folder, until=END - 1.0).summary["time"] == END
    longer = houle.resume(folder, threads=1, until=END + 1.0)
    assert longer.summary["finished"] and longer.summary["time"] == END + 1.0 and longer.case.time.until is None
    assert read_manifest(folder)["prolonged"][0]["from"] == END


def test_the_latest_end_says_what_is_lacking(tmp_path):
    run = houle.run(TANK, out=tmp_path / "run", threads=1, overrides={"time.end": 8.0})
    (waves,) = run.summary["until"]
    assert run.summary["finished"] and run.summary["time"] == 8.0
    assert not waves["met"] and waves["more"] == np.ceil(30 - waves["half"])


def test_without_it_nothing_is_looked_at():
    assert Goal(load(TANK, {"time.until": None}), lambda _: True).frames == 0
    assert Goal(load(TANK), lambda _: True).frames == round(WAVES * PERIOD / 0.5)
