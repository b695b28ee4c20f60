"""[waves] seeds: runs of one case in seas that differ by their seed, in one folder, with their answers together."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import houle
from houle.errors import CaseError
from houle.output.netcdf import Table, Variable, times
from houle.results import summary
from houle.results.answers import overtopping, reflection, walls
from houle.results.answers.given import Given, attempted, worst
from houle.results.answers.sea import sea_of, together
from houle.results.answers.table import Answer
from houle.running.seeds import realisation, seeds_of

CASE: dict[str, Any] = {
    "case": {"name": "sea"},
    "domain": {"size": [3.2, 0.7], "spacing": 0.05},
    "water": [{"polygon": [[0.0, 0.0], [2.0, 0.0], [2.6, 0.3], [0.0, 0.3]]}],
    "solid": [{"name": "dike", "polygon": [[2.0, 0.0], [2.7, 0.35], [2.8, 0.35], [2.9, 0.0]]}],
    "waves": {
        "kind": "jonswap", "height": 0.12, "period": 1.0, "depth": 0.3, "seed": 3, "seeds": 2, "zone": {"x": [0.0, 1.2]}
    },
    "overtopping": [{"name": "crest", "x": 2.75}],
    "time": {"end": 8.0},
    "output": {"every": 1.0, "series_every": 0.02},
}  # fmt: skip


def case_with(**more: Any) -> dict[str, Any]:
    return {**CASE, **more}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Both seeds, finished."""
    path = tmp_path_factory.mktemp("seeds") / "run"
    houle.run(CASE, path)
    return path


def levels(folder: Path) -> np.ndarray:
    return houle.open_run(folder).series["overtopping_volume"].values


def test_each_seed_is_the_run_of_that_seed_alone(folder, tmp_path):
    alone = houle.run(CASE, tmp_path / "alone", overrides={"waves.seeds": None, "waves.seed": 4})
    assert [found.name for found in sorted(folder.glob("seed-*"))] == ["seed-3", "seed-4"]
    second = houle.open_run(folder / "seed-4")
    assert second.case.hash == alone.case.hash
    for name, values in alone.series.items():
        np.testing.assert_array_equal(second.series[name].values, values.values, err_msg=str(name))
    assert not np.array_equal(levels(folder / "seed-3"), levels(folder / "seed-4"))


def test_the_folder_holds_the_answers_of_all(folder):
    whole, each = houle.open_run(folder).summary, [houle.open_run(folder / f"seed-{k}").summary for k in (3, 4)]
    assert whole["finished"] and [one["seed"] for one in whole["seeds"]] == [3, 4]
    assert whole["steps"] == sum(one["steps"] for one in each)
    rows = {row["name"]: row for row in whole["answers"]["rows"]}
    singles = [{row["name"]: row for row in one["answers"]["rows"]} for one in each]
    name = "overtopping crest, mean discharge"
    assert rows[name]["value"] == pytest.approx(np.mean([one[name]["value"] for one in singles]), rel=1e-3)
    assert rows[name]["value"] > 0.0 and "2 seeds" in rows[name]["method"]
    name = "overtopping crest, V_max"
    assert rows[name]["value"] == max(one[name]["value"] for one in singles if name in one)
    assert (folder / "answers.csv").exists() and (folder / "answers.png").exists()


def test_a_loop_that_was_stopped_goes_on_where_it_was(folder, tmp_path):
    """In the middle of a seed, before the next one, and when nothing is left to do."""
    there = tmp_path / "run"
    shutil.copytree(folder, there)
    for part in ("begun", "not begun"):
        shutil.rmtree(there / "seed-4")
        manifest = json.loads((there / "run.json").read_text())
        (there / "run.json").write_text(json.dumps({**manifest, "finished": False}))
        if part == "begun":
            houle.run(realisation(houle.load(CASE), 4), there / "seed-4", until=3.0)
        first = (there / "seed-3" / "series.nc").stat().st_mtime_ns
        again = houle.resume(there)
        assert again.summary["finished"] and (there / "seed-3" / "series.nc").stat().st_mtime_ns == first
        np.testing.assert_array_equal(levels(there / "seed-4"), levels(folder / "seed-4"))
        assert again.summary["answers"] == houle.open_run(folder).summary["answers"]
    assert houle.resume(there).summary["finished"]


@pytest.mark.parametrize(("waves", "seeds"), [(3, 1), (9, 2)])
def test_the_goal_is_asked_of_all_seeds_together(folder, tmp_path, waves, seeds):
    """Some six waves come in one run: three are there after the first, nine after the second."""
    there = tmp_path / "run"
    there.mkdir()
    for seed in (3, 4):
        shutil.copytree(folder / f"seed-{seed}", there / f"seed-{seed}")
    asked = case_with(time={"end": 8.0, "until": {"waves": waves}}, waves={**CASE["waves"], "seeds": 3})
    found = houle.run(asked, there).summary
    assert found["finished"] and len(found["seeds"]) == seeds and not (there / "seed-5").exists()
    assert found["until"][0]["met"] and found["until"][0]["half"] >= waves


def test_a_folder_of_another_case_is_not_taken(folder, tmp_path):
    shutil.copytree(folder / "seed-3", tmp_path / "run" / "seed-3")
    with pytest.raises(CaseError, match="seed-3 holds the run of another case"):
        houle.run(case_with(time={"end": 7.0}), tmp_path / "run")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"seeds": 1}, r"waves.seeds = 1"),
        ({"kind": "focused", "focus": {"x": 1.8, "time": 4.0}}, r'seeds does not belong to kind = "focused"'),
    ],
)
def test_seeds_that_are_none_are_refused(changes, said):
    with pytest.raises(CaseError, match=said):
        houle.load(case_with(waves={**CASE["waves"], **changes}))


def test_until_and_seeds_do_not_go_together(tmp_path):
    with pytest.raises(CaseError, match=r"until = 2 s: with waves.seeds each run goes to time.end"):
        houle.run(CASE, tmp_path / "run", until=2.0)
    assert not (tmp_path / "run").exists()


def test_the_seeds_of_a_case_follow_the_first():
    case = houle.load(CASE)
    assert list(seeds_of(case)) == [3, 4] and list(seeds_of(realisation(case, 4))) == []
    waves = {key: value for key, value in CASE["waves"].items() if key != "seed"}
    assert list(seeds_of(houle.load(case_with(waves=waves)))) == [1, 2]


# ---- answers of several runs ----------------------------------------------------------------------------------------

TIME = np.arange(0.0, 200.0, 0.01)


def run_of(case: houle.case.model.Case, **series: np.ndarray) -> Given:
    variables = {
        name: Variable(("station", "time", "axis")[: 1 + values.ndim], values[None], {})
        for name, values in series.items()
    }
    return Given(case, Table(variables, {"time": times(TIME)}, {}), sea_of(case))


def pool(*runs: Given) -> Given:
    return replace(runs[0], sea=together(runs), parts=runs)


def rows_of(questions: Any) -> dict[str, Answer]:
    return {row.name: row for question in questions for row in attempted(question)}


def test_waves_of_all_seeds_give_one_interval():
    """The same record four times has the same discharge, half as wide an interval, and four times the waves."""
    case = houle.load(case_with(time={"end": 200.0}))
    random, record = np.random.default_rng(2), np.zeros_like(TIME)
    for start in np.arange(10.0, 195.0, 2.5):
        record += random.exponential(0.01) * (1 - np.cos(np.pi * np.clip((TIME - start) / 0.3, 0.0, 1.0))) / 2
    one = run_of(case, overtopping_volume=record)
    alone, four = (rows_of(overtopping.questions(given)) for given in (one, pool(one, one, one, one)))
    for name in ("overtopping crest, mean discharge", "overtopping crest, share of the waves"):
        assert four[name].value == pytest.approx(alone[name].value, rel=1e-9)
        wide, narrow = (np.log(row[name].high / row[name].low) for row in (alone, four))
        assert narrow == pytest.approx(wide / 2, rel=0.15)
    name = "overtopping crest, V_max"
    assert four[name].value == alone[name].value and "largest of" in four[name].method
    count = [int(row[name].method.split("largest of ")[1].split()[0]) for row in (alone, four)]
    assert count[1] == 4 * count[0]


def test_the_largest_force_of_all_seeds_tells_its_seed_and_time():
    """With the waves of both runs F_1/250 is answered, which neither answers alone."""
    case = houle.load(case_with(time={"end": 200.0}, force=[{"name": "dike", "body": "dike", "about": [2.9, 0.0]}]))
    other = houle.load(case, {"waves.seed": 4})
    peak = np.exp(-(((TIME - 120.0) / 0.1) ** 2))
    about = {"structure_about_x": Variable(("structure",), np.array([2.9]), {})}
    about |= {"structure_about_z": Variable(("structure",), np.array([0.0]), {})}

    def run(which: houle.case.model.Case, size: float) -> Given:
        force = 50.0 * np.sin(2 * np.pi * TIME) + size * peak
        given = run_of(which, force=np.stack([force, 0 * TIME], axis=1), moment=0.1 * force)
        return replace(given, series=Table({**dict(given.series.items()), **about}, {"time": times(TIME)}, {}))

    first, second = run(case, 300.0), run(other, 500.0)
    found, alone = (rows_of(walls.questions(given)) for given in (pool(first, second), second))
    name = "force dike, F_max landward"
    assert found[name].value == alone[name].value and "at 120 s of seed 4" in found[name].note
    assert not alone["force dike, F_1/250"].answered
    assert found["force dike, F_1/250"].answered


def test_reflection_of_all_seeds_is_that_of_their_energy():
    def entry(C_R: float, H_I: float, half: float) -> dict[str, Any]:
        same = {"confidence": 0.9, "covers": "c", "notes": [], "C_T": None, "H_T": None, "C_D": 1 - C_R**2}
        ends = {"interval_R": [C_R - half, C_R + half], "interval_T": [None, None], "interval_D": [None, None]}
        return {**same, **ends, "C_R": C_R, "H_I": H_I, "H_R": C_R * H_I}

    found = reflection.pooled([entry(0.3, 0.1, 0.03), entry(0.4, 0.2, 0.04)], ["seed 1", "seed 2"])
    assert found["C_R"] == pytest.approx(np.sqrt((0.03**2 + 0.08**2) / (0.1**2 + 0.2**2)))
    assert found["interval_R"] == pytest.approx([found["C_R"] - 0.025, found["C_R"] + 0.025])
    assert np.isnan(found["C_T"])
    one = entry(0.3, 0.1, 0.03)
    assert reflection.pooled([one], ["seed 1"]) == one
    assert reflection.pooled([one, {"problem": "short"}], ["seed 1", "seed 2"]) == {"problem": "seed 2: short"}


def test_of_a_worst_number_the_seed_is_told():
    given = pool(*(run_of(houle.load(CASE, {"waves.seed": seed}), x=TIME) for seed in (3, 4)))
    runs = [lambda: [Answer("safety", 1.5, "-")], lambda: [Answer("safety", 1.2, "-", note="at 3 s")]]
    (low,), (high,) = worst(given, runs, lowest=True), worst(given, runs)
    assert (low.value, low.note) == (1.2, "at 3 s. in seed 4") and (high.value, high.note) == (1.5, "in seed 3")


def test_waves_that_hold_less_energy_than_at_the_start_have_no_share_lost():
    """Water that stood upright at the start has more; run.json holds null then, and the summary leaves the line out."""
    entry = {"unit": "W/m", "periods": 5, "source_work": 3.0, "lost": 1.0, "stored": 0.0}
    title, told = summary.waves({"wave_energy": {**entry, "lost_per_wavelength": None}})
    assert "5 periods" in title and told[-1][0] == "lost in numbers"
    assert summary.waves({"wave_energy": {**entry, "lost_per_wavelength": 0.02}})[1][-1][1] == "2.00 %"
