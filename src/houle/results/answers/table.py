"""A row of the answers of a run, and what stands beside its number."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import isfinite, nan
from typing import Any

CONFIDENCE = 0.90  # share that every interval holds
WINDOW = 10.0  # mean periods over which the level at rest is taken
BRIEF = 0.05  # mean periods: a pressure that rises in less is an impact
BOUND = (
    "an impact: a code without air stops water in a step, so its peak is an upper bound that depends on the spacing; "
    "the impulse does not"
)

#: Columns of answers.csv, in their order. "low_90" and "high_90" are the ends of an interval of 90 %.
COLUMNS = (
    "name", "value", "low_90", "high_90", "unit", "method",
    "formula", "formula_value", "formula_low", "formula_high",
    "formula_2", "formula_2_value", "formula_2_low", "formula_2_high",
    "tests", "tests_low", "tests_high", "tests_rows", "note",
)  # fmt: skip


@dataclass(frozen=True)
class Beside:
    """A number beside an answer: by a formula with its band, or of laboratory tests with their spread.

    name   of the formula, with the rule it was taken by, or of the tests
    value  in the unit of the answer; low and high are NaN where the source gives none
    words  source, branch, and what lies outside the range; of tests one sentence each
    points   values of single tests
    """

    name: str
    value: float
    low: float = nan
    high: float = nan
    words: tuple[str, ...] = ()
    points: tuple[float, ...] = ()

    def __str__(self) -> str:
        return f"{self.name} {number(self.value)}{span(self.low, self.high)}"


@dataclass(frozen=True)
class Answer:
    """A number that a run was made for, with its interval of 90 % and what stands beside it.

    value     NaN where the question was not answered: `note` says why
    low, high   NaN where no interval can be given
    method    how it was measured, and what the interval covers
    formulas  published formulas for the same number, two at most
    tests     the nearest laboratory tests
    group     answers of one group and unit share a panel of the picture
    """

    name: str
    value: float
    unit: str
    low: float = nan
    high: float = nan
    method: str = ""
    formulas: tuple[Beside, ...] = ()
    tests: Beside | None = None
    note: str = ""
    group: str = ""

    @property
    def answered(self) -> bool:
        return isfinite(self.value)

    def noted(self, *sentences: str) -> Answer:
        """The same with more sentences in its note; empty ones are left out."""
        return replace(self, note=". ".join(part.rstrip(".") for part in (self.note, *sentences) if part))

    def __str__(self) -> str:
        if not self.answered:
            return self.note
        return f"{number(self.value)}{span(self.low, self.high)} {self.unit}".rstrip(" -")

    def cells(self) -> dict[str, Any]:
        """The row of answers.csv: an entry for each of `COLUMNS`, None where there is nothing."""
        own = (self.name, self.value, self.low, self.high, self.unit, self.method)
        row: dict[str, Any] = dict(zip(COLUMNS, own, strict=False))
        for key, beside in zip(("formula", "formula_2"), self.formulas, strict=False):
            row |= {key: beside.name, f"{key}_value": beside.value}
            row |= {f"{key}_low": beside.low, f"{key}_high": beside.high}
        if self.tests is not None:
            row |= {"tests": self.tests.value, "tests_low": self.tests.low, "tests_high": self.tests.high}
            row |= {"tests_rows": "; ".join(self.tests.words)}
        row["note"] = self.note
        return {key: _told(row.get(key)) for key in COLUMNS}


def not_answered(name: str, why: object, unit: str = "") -> Answer:
    """A row for a question that the run does not answer, and why."""
    return Answer(name, nan, unit, note=f"not answered: {' '.join(str(why).split())}")


def entry(rows: list[Answer]) -> dict[str, Any]:
    """The entry "answers" of run.json: the confidence of the intervals, and the rows of answers.csv."""
    return {"confidence": CONFIDENCE, "rows": [row.cells() for row in rows]}


def number(value: float) -> str:
    """A number in four digits."""
    return f"{value:.4g}"


def span(low: float, high: float) -> str:
    """An interval in words, "" if there is none."""
    return f" ({low:.3g} to {high:.3g})" if isfinite(low) and isfinite(high) else ""


def _told(value: Any) -> Any:
    """None for what is no number, or no words."""
    if isinstance(value, float):
        return value if isfinite(value) else None
    return value or None


def lines(found: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Rows of the summary of a run from the entry "answers": name; value, interval, formula, tests, note."""
    return [pair for row in found.get("rows", []) for pair in _lines(row)]


def _lines(row: Mapping[str, Any]) -> list[tuple[str, str]]:
    if row["value"] is None:
        return [(row["name"], row["note"] or ""), *_formula_lines(row)]
    found = [(row["name"], f"{_with_span(row, 'value', 'low_90', 'high_90')} {row['unit'] or ''}".rstrip(" -"))]
    found += _formula_lines(row)
    if row["tests"] is not None:
        found.append(("  nearest laboratory tests", _with_span(row, "tests", "tests_low", "tests_high")))
    return [*found, ("  note", row["note"])] if row["note"] else found


def _formula_lines(row: Mapping[str, Any]) -> list[tuple[str, str]]:
    """A line for each formula beside a row."""
    keys = [key for key in ("formula", "formula_2") if row[key]]
    return [(f"  by {row[key]}", _with_span(row, f"{key}_value", f"{key}_low", f"{key}_high")) for key in keys]


def _with_span(row: Mapping[str, Any], value: str, low: str, high: str) -> str:
    ends = (nan if row[key] is None else float(row[key]) for key in (low, high))
    return f"{number(row[value])}{span(*ends)}"
