"""C_R at the end of a run: what [reflection] measures, says and keeps; the card of the empty flume."""

import json
import re

import pytest

from houle.case.model import load
from houle.check import gauges
from houle.errors import CaseError
from houle.results import reflection, summary, wave_quality
from houle.running.progress import Silent


def test_theory_is_given_for_one_upright_block_only():
    block, slope = load("wave-block"), load("wave-slope")
    known = reflection.theory(block, 0.02)
    assert known is not None and pytest.approx(0.1565, abs=2e-4) == known.C_R
    assert known.friction == pytest.approx(0.5)
    assert reflection.theory(slope, 0.04) is None
    assert reflection.theory(load(block, {"reflection.theory": False}), 0.02) is None


def test_flume_of_a_block_with_sponge_and_with_wall():
    flume = reflection.ReflectionFlume.of(load("wave-block"))
    assert (flume.maker, flume.front, flume.back, flume.absorbed, flume.quiet) == (3.3, 6.1, 7.6, True, True)
    closed = load("wave-block", {"domain.size": [7.6, 0.35], "sponge": [], "reflection.behind": []})
    assert reflection.ReflectionFlume.of(closed).back == 7.6 and not reflection.ReflectionFlume.of(closed).absorbed


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"reflection.gauges": ["G1", "T1"]}, "T1 stands at 8 m"),
        ({"reflection.gauges": ["G1", "X"]}, "no gauge X"),
        ({"reflection.structure": [7.6, 6.1]}, "first the face"),
        ({"reflection.structure": [20.0]}, "outside the tank"),
        ({"reflection.method": "goda-suzuki"}, "takes 2"),
    ],
)
def test_wrong_tables_are_refused(change, words):
    with pytest.raises(CaseError, match=words):
        load("wave-block", change)


def test_a_window_after_the_end_is_warned_of():
    told = gauges.steady(load("wave-block", {"reflection.window": [19.0, 30.0]}))
    assert told.level == "warning" and told.key == "reflection.window" and "time.end = 20.4 s" in told.text
    assert gauges.steady(load("wave-block", {"reflection.window": [14.0, 30.0]})) is None


def test_twin_has_no_block_and_is_shared_by_all_blocks():
    one = wave_quality.empty_flume(load("wave-block"))
    other = wave_quality.empty_flume(load("wave-block", {"porous.block.porosity": 0.6, "time.end": 15.0}))
    assert not one.porous and one.sponge[-1].box[0][0] > 5.9 and one.hash == other.hash
    assert one.hash != wave_quality.empty_flume(load("wave-block", {"waves.height": 0.03})).hash


def test_card_is_computed_once(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    case = load("wave-block")
    kept = wave_quality.folder() / f"{wave_quality.empty_flume(case).hash}-{wave_quality._version()}.json"
    kept.parent.mkdir(parents=True)
    kept.write_text(json.dumps({"height": 0.02}))
    assert wave_quality.card(case, Silent()) == {"height": 0.02, "kept": str(kept)}
    assert wave_quality.card(load(case, {"reflection.twin": False}), Silent()) == {}
    assert "regular" in wave_quality.card(load("breakwater", {"reflection.twin": True}), Silent())["problem"]


def test_a_run_says_its_reflection_or_why_there_is_none(tmp_path):
    import houle

    change = {"domain.spacing": 0.05, "time.end": 1.0, "reflection.twin": False}
    run = houle.run(load("wave-block", change), out=tmp_path / "short", threads=1)
    assert "too short" in run.summary["reflection"]["problem"]
    said_before = gauges.steady(run.case)
    steady = re.compile(r"the gauges are steady at ([\d.]+) s")
    assert steady.search(said_before.text)[1] == steady.search(run.summary["reflection"]["problem"])[1]
    assert summary.reflection(run.summary["reflection"])[0][0] == "none"
    change |= {"time.end": 6.0, "reflection.window": [3.0, 6.0]}
    run = houle.run(load("wave-block", change), out=tmp_path / "longer", threads=1)
    entry = run.summary["reflection"]
    assert 0 <= entry["C_R"] < 0.5 and entry["window"]["periods"] == 2 and entry["theory"]["C_R"] > 0.1
    assert (run.directory / reflection.PICTURE).stat().st_size > 10_000
