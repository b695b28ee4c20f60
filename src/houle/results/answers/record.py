"""All answers of a run: the rows, answers.csv, answers.png and the entry of run.json."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from houle.output import series_table
from houle.output.csv_file import write_csv
from houle.results.answers import armour, bank, enough, mound, overtopping, pressures, reflection, runup, walls
from houle.results.answers.given import Given, Question, attempted
from houle.results.answers.sea import measured, sea_of, together
from houle.results.answers.table import COLUMNS, Answer, entry

if TYPE_CHECKING:
    from houle.case.model import Case
    from houle.results.run import Run

TABLE = "answers.csv"
PICTURE = "answers.png"


def record(directory: Path, rows: list[Answer]) -> dict[str, Any]:
    """Writes answers.csv; the entry "answers" of run.json, {} where the case asks nothing."""
    if not rows:
        return {}
    found = entry(rows)
    write_csv(directory / TABLE, COLUMNS, found["rows"])
    return {"answers": found}


def draw(directory: Path, title: str, rows: list[Answer]) -> None:
    """Draws answers.png, if there is anything in it to be drawn."""
    from houle.results.answers.picture import write

    write(directory / PICTURE, title, rows)


def answers(run: Run, summary: Mapping[str, Any]) -> list[Answer]:
    """The rows of a run; summary: its other entries, of which those of [reflection], [[bank]] and [[armour]] are read.

    A question without an answer is a row that says why.
    """
    return _rows(run.case, [_given(run, summary)], [summary]) if _asks(run.case) else []


def pooled(case: Case, runs: Sequence[Run]) -> list[Answer]:
    """The rows of several finished runs of a case, in seas that differ by their seed, taken together."""
    summaries = [run.summary for run in runs]
    each = zip(runs, summaries, strict=True)
    return _rows(case, [_given(run, found) for run, found in each], summaries) if _asks(case) else []


def reflection_entry(runs: Sequence[Run]) -> dict[str, Any]:
    """The entry "reflection" of run.json for several runs together; {} without [reflection]."""
    found = [run.summary.get("reflection") or {} for run in runs]
    pooled = reflection.pooled(found, [f"seed {run.case.waves.seed}" for run in runs if run.case.waves])
    return {"reflection": pooled} if pooled else {}


def _asks(case: Case) -> bool:
    """True if the case asks for anything that becomes an answer."""
    tables = (case.overtopping, case.runup, case.force, case.bank, case.armour, case.reflection)
    return any(tables) or bool(case.waves and (case.sensor or case.phreatic))


def _given(run: Run, summary: Mapping[str, Any]) -> Given:
    """The case of a run, its series and its sea; None of waves of which it has no three rows yet."""
    series, sea = series_table(run.directory), sea_of(run.case)
    found = summary.get("reflection") or {}
    short = sea is None or series.sizes["time"] < 3
    return Given(run.case, series, None if sea is None or short else measured(sea, run.case, series, found))


def _rows(case: Case, runs: Sequence[Given], summaries: Sequence[Mapping[str, Any]]) -> list[Answer]:
    if any(one.series.sizes["time"] < 3 for one in runs):
        return []
    given = runs[0] if len(runs) == 1 else replace(runs[0], case=case, sea=together(runs), parts=tuple(runs))
    found = reflection.pooled([summary.get("reflection") or {} for summary in summaries], [one.seed for one in runs])
    banks, armours = ([summary.get(key) or [] for summary in summaries] for key in ("bank", "armour"))
    asked = [*_questions(given, found), *bank.questions(given, banks), *armour.questions(given, armours)]
    return [row for question in asked for row in attempted(question)]


def sure(run: Run, summary: Mapping[str, Any]) -> bool:
    """True if all answers of a run that goes on are as sure as time.until asks; summary as of `answers`."""
    return met(run.case, [run], answers(run, summary))


def met(case: Case, runs: Sequence[Run], rows: list[Answer]) -> bool:
    """True if the rows of one run, or of several together, are as sure as time.until of the case asks."""
    return all(one.met for one in _asked(case, runs, rows))


def until(case: Case, runs: Sequence[Run], rows: list[Answer]) -> dict[str, Any]:
    """The entry "until" of run.json; {} where the case asks for nothing."""
    return enough.entry(_asked(case, runs, rows))


def _asked(case: Case, runs: Sequence[Run], rows: list[Answer]) -> list[enough.Asked]:
    """All that time.until asks for; [] without it, and then no series is read."""
    if case.time.until is None:
        return []
    return enough.asked(case, rows, sum(enough.waves_of(run.case, run.directory) for run in runs))


def _questions(given: Given, found: Mapping[str, Any]) -> Iterator[Question]:
    yield from overtopping.questions(given)
    yield from runup.questions(given)
    yield from walls.questions(given)
    yield from reflection.questions(given, found)
    yield from pressures.questions(given)
    yield from mound.questions(given)
