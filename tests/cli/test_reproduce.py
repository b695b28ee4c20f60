"""`houle reproduce`: the plan is complete and good, the page holds what was computed, nothing is computed twice."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial

import pytest
from typer.testing import CliRunner

from houle.check import rules
from houle.cli import app
from houle.errors import SimulationError
from houle.reproduction import command, measured, page, plan
from houle.results import reflection
from houle.running import runner

FOLDER = plan.folder_of("jh2020")
JOBS = plan.read(FOLDER)
TABLE = measured.printed(FOLDER)
TINY = ["beads-*", "wave-90-40mm"]
COARSE = {"time.step": 0.004, "numerics.remesh_every": 50}  # of the paper's scheme: as often as in its plan


@pytest.mark.parametrize("job", JOBS, ids=lambda job: job.name)
def test_every_run_of_the_plan_passes_the_pre_flight(job):
    for quick in (False, True):
        case = job.load(None, quick)
        assert case.case.name == job.name
        assert not [finding for finding in rules.check(case) if finding.level == "error"]
    if job.part != "dam-break":
        assert case.waves.height == job.height
        assert case.porous[0].name == "block" and case.porous[0].porosity == 0.85
        assert (case.porous[0].box is not None) == (job.slope == 90)


def test_the_plan_holds_every_row_of_the_table_in_both_flumes_and_both_schemes_of_the_dam_breaks():
    rows = {(j.slope, j.height, j.flume) for j in JOBS if j.part == "table"}
    assert rows == {(p.slope, p.height, flume) for p in TABLE for flume in (5, 7)}
    dams = {(j.of, j.scheme) for j in JOBS if j.part == "dam-break"}
    assert dams == {(of, scheme) for of in ("rock", "beads") for scheme in ("houle", "jh2020")}
    assert len({j.name for j in JOBS}) == len(JOBS)
    assert {(j.slope, j.height) for j in plan.choose(JOBS, [], quick=True) if j.part == "table"} == {
        (p.slope, p.height) for p in TABLE
    }


def test_the_papers_formula_gives_its_printed_coefficients():
    """To rounding of the levels: which is why it is known what was read."""
    for p in TABLE:
        formula = (p.A - p.B) / (p.A + p.B)
        assert abs(formula - p.C_R) < 1e-3 / (p.A + p.B) + 5e-4


@pytest.fixture(scope="module")
def tiny():
    """A small part of the plan on a very coarse grid, without the pictures of every run."""
    jobs = [replace(j, set={**j.set, **(COARSE if j.scheme == "jh2020" else {})}) for j in JOBS]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(command, "read", lambda folder: jobs)
        patch.setattr(page, "PERIODS", (1.2, 1.5))
        patch.setattr(page, "GRAINS", (0.0159,))
        patch.setattr(runner, "draw", lambda run, session: None)
        patch.setattr(reflection, "draw", lambda found, path: None)
        yield lambda *args, **options: command.reproduce(
            "jh2020", *args, **{"once": partial(runner.once, threads=1), "spacing": 0.05, "only": TINY, **options}
        )


@pytest.fixture(scope="module")
def computed(tiny, tmp_path_factory):
    folder = tmp_path_factory.mktemp("reproduction")
    assert tiny(folder) == 0
    return folder


def test_the_page_holds_tables_and_figures(computed):
    text = (computed / "report.md").read_text(encoding="utf-8")
    assert not re.search(r"\$\w", text)
    row = re.search(r"\| 90°, 0\.04 m \| 5 m \| (.*) \|\n", text)
    assert row
    A, B, printed, formula = (float(word) for word in row.group(1).split(" | ")[:4])
    assert printed == 0.138 and 0.25 < A < 0.33 and 0.2 < B < 0.25
    assert formula == pytest.approx((A - B) / (A + B), abs=2e-3)
    pictures = re.findall(r"\]\((figures/\S+\.png)\)", text)
    assert len(pictures) == 4  # beads, what they gain, the waves, the coefficients
    assert all((computed / p).stat().st_size < 200_000 for p in pictures)
    assert page.ABSENT in text  # the rock was not computed


def test_what_is_there_is_not_computed_again(computed, tiny, monkeypatch, tmp_path):
    """And the page goes where it is asked for, with all of the runs."""
    written = []
    monkeypatch.setattr(page, "write", lambda *args: written.append(args))
    assert tiny(computed, once=lambda *args: pytest.fail("computed a second time"), file=tmp_path / "page.md") == 0
    ((file, _, found, done, _),) = written
    assert file == tmp_path / "page.md"
    assert len(done.runs) == 3 and [p.name for p in found.pairs] == ["beads"]


def test_the_paper_gains_water_and_we_do_not(computed):
    text = (computed / "report.md").read_text(encoding="utf-8")
    ours, papers = re.search(r"\| beads \| 1\.2 \| (\S+) % \| (\S+) % \|", text).groups()
    assert abs(float(ours)) < 1e-10 and float(papers) > 1.0


def test_a_run_that_fails_is_told_and_does_not_stop_the_others(computed, tiny, monkeypatch, capsys):
    def fail(case, place):
        raise SimulationError("it fell over\nin detail")

    states = []
    monkeypatch.setattr(page, "write", lambda file, folder, found, done, quick: states.append(page._state(done, quick)))
    assert tiny(computed, once=fail, progress=True, only=["rock-houle", *TINY]) == 3
    assert "failed  rock-houle: it fell over" in capsys.readouterr().err
    assert states == [" Failed: rock-houle: it fell over."]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["jh2021"], "Did you mean"),
        (["jh2020", "--only", "wave-60-40mm"], "no such run"),
        (["jh2020", "--quick", "--only", "wave-90-80mm-7m"], "no such run"),
        (["jh2020", "--spacing", "-1"], "domain.spacing"),
    ],
)
def test_wrong_input_is_one_message_and_writes_nothing(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["reproduce", *arguments])
    assert done.exit_code == 2 and words in done.stderr
    assert not list(tmp_path.iterdir())
