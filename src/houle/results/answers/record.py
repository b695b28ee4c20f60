"""All answers of a run: the rows, answers.csv, answers.png and the entry of run.json."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from houle.output import series_table
from houle.output.csv_file import write_csv
from houle.results.answers import armour, bank, enough, mound, overtopping, pressures, reflection, runup, walls
from houle.results.answers.given import Given, Question, attempted
from houle.results.answers.sea import measured, sea_of
from houle.results.answers.table import COLUMNS, Answer, entry

if TYPE_CHECKING:
    from houle.results.run import Run

TABLE = "answers.csv"
PICTURE = "answers.png"


def record(run: Run, rows: list[Answer]) -> dict[str, Any]:
    """Writes answers.csv; the entry "answers" of run.json, {} where the case asks nothing."""
    if not rows:
        return {}
    found = entry(rows)
    write_csv(run.directory / TABLE, COLUMNS, found["rows"])
    return {"answers": found}


def draw(run: Run, rows: list[Answer]) -> None:
    """Draws answers.png, if there is anything in it to be drawn."""
    from houle.results.answers.picture import write

    write(run.directory / PICTURE, run.case.title, rows)


def answers(run: Run, summary: Mapping[str, Any]) -> list[Answer]:
    """The rows of a run; summary: its other entries, of which those of [reflection], [[bank]] and [[armour]] are read.

    A question without an answer is a row that says why.
    """
    case = run.case
    if not (
        case.overtopping
        or case.runup
        or case.force
        or case.bank
        or case.armour
        or case.reflection
        or (case.waves and (case.sensor or case.phreatic))
    ):
        return []
    series = series_table(run.directory)
    if series.sizes["time"] < 3:
        return []
    found = summary.get("reflection") or {}
    sea = sea_of(case)
    given = Given(case, series, None if sea is None else measured(sea, case, series, found))
    asked = [*_questions(given, found), *bank.questions(summary.get("bank") or [])]
    asked += armour.questions(given, summary.get("armour") or [])
    return [row for question in asked for row in attempted(question)]


def sure(run: Run, summary: Mapping[str, Any]) -> bool:
    """True if all answers of a run that goes on are as sure as time.until asks; summary as of `answers`."""
    return all(one.met for one in _asked(run, answers(run, summary)))


def until(run: Run, rows: list[Answer]) -> dict[str, Any]:
    """The entry "until" of run.json; {} where the case asks for nothing."""
    return enough.entry(_asked(run, rows))


def _asked(run: Run, rows: list[Answer]) -> list[enough.Asked]:
    """All that time.until asks for; [] without it, and then no series is read."""
    if run.case.time.until is None:
        return []
    return enough.asked(run.case, rows, enough.waves_of(run.case, run.directory))


def _questions(given: Given, found: Mapping[str, Any]) -> Iterator[Question]:
    yield from overtopping.questions(given)
    yield from runup.questions(given)
    yield from walls.questions(given)
    yield from reflection.questions(given, found)
    yield from pressures.questions(given)
    yield from mound.questions(given)
