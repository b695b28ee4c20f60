"""Answers of [[runup]]: the run-up that 2 % of the waves exceed, and the largest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from houle.analysis.events import interval
from houle.analysis.runup import LEAST_WAVES, RunUp, run_up
from houle.errors import CaseError
from houle.grid import FloatArray
from houle.results.answers import formulas
from houle.results.answers.given import Given, Question, with_formulas
from houle.results.answers.outline import OutlineError, outline_of
from houle.results.answers.table import Answer, Beside, not_answered

if TYPE_CHECKING:
    from houle.case.tables import observed
    from houle.results.answers.structure import Sea

LEAST = 0.05  # wave heights by which a run-up rises above the mean level of the edge, or it is none
PART = 0.02  # share of the waves that exceed R_2%


def questions(given: Given) -> Iterator[Question]:
    """One question for each [[runup]]."""
    for row, table in enumerate(given.case.runup):
        yield f"run-up {table.name}", partial(_rows, given, row, table)


def _rows(given: Given, row: int, table: observed.RunUp) -> Iterator[Answer]:
    """The rows of a stretch of slope. Raises AnalysisError; CaseError where it stayed dry."""
    name, sea = f"run-up {table.name}", given.sea
    if sea is None:
        record = given.record("runup_level", row)
        if not np.isfinite(record).any():
            raise CaseError("no water stood on it in the whole run")
        highest = float(np.nanmax(record))
        yield Answer(f"{name}, highest level", highest, "m", method="above z = 0, in the whole run", group="run-up")
        return
    x = table.x[1]
    found = _together([_waves(one, row, x) for one in given.each], given.offsets)
    waves = found.waves
    method = f"above still water, {given.when(x)}"
    over = _over(given, sea, x, found.R_max)
    if waves < LEAST_WAVES:
        yield not_answered(f"{name}, R_2%", f"{waves} waves came, {LEAST_WAVES} are the least", "m")
    else:
        low, high = interval(_padded(found), _exceeded)
        covers = f"{method}; interval: stationary block bootstrap of the waves"
        two = Answer(f"{name}, R_2%", found.R_2, "m", low, high, covers, note=over, group="run-up")
        yield with_formulas(two, sea, lambda: [_by_formula(given, sea, x)])
    largest = Answer(f"{name}, R_max", found.R_max, "m", method=method, note=over, group="run-up")
    yield _single(given, sea, x, largest)


def _waves(given: Given, row: int, x: float) -> RunUp:
    """The run-ups of one run. Raises AnalysisError."""
    sea = given.sea
    assert sea is not None
    late, record = given.late(x), given.record("runup_level", row)
    least = LEAST * sea.height if sea.height > 0 else 0.0
    return _highest(run_up(given.time[late], record[late] - sea.level, threshold=least), round(given.waves(x)))


def _together(runs: list[RunUp], offsets: FloatArray) -> RunUp:
    """The run-ups of several runs as those of one."""
    times = [one.times + offset for one, offset in zip(runs, offsets, strict=True)]
    return RunUp(np.concatenate([one.peaks for one in runs]), np.concatenate(times), sum(one.waves for one in runs))


def _highest(found: RunUp, waves: int) -> RunUp:
    """The run-ups of so many incident waves: the highest, in their order, where the edge went up more often."""
    kept = np.sort(np.argsort(-found.peaks, kind="stable")[:waves])
    return RunUp(found.peaks[kept], found.times[kept], waves)


def _over(given: Given, sea: Sea, x: float, highest: float) -> str:
    """A sentence where the water ran over the crest, "" where it did not, or there is no crest."""
    try:
        crest = outline_of(given.case, sea, x).freeboard
    except OutlineError:
        return ""
    if highest < crest - given.case.domain.spacing:
        return ""
    return f"water ran over the crest, R_c {crest:.3g} m, where run-up is cut off; the formula is for a higher slope"


def _by_formula(given: Given, sea: Sea, x: float) -> Beside:
    return formulas.run_up(sea, outline_of(given.case, sea, x))


def _single(given: Given, sea: Sea, x: float, row: Answer) -> Answer:
    """The row with the law of a solitary wave beside it, where that is the wave."""
    waves = given.case.waves
    if waves is None or waves.kind != "solitary" or waves.height is None:
        return row
    height = waves.height
    return with_formulas(
        row, replace(sea, lack=""), lambda: [formulas.solitary_run_up(height, sea, outline_of(given.case, sea, x))]
    )


def _padded(found: RunUp) -> FloatArray:
    """Run-ups (W,) of all waves, those without one at the lowest of all."""
    rest = np.full(found.waves - len(found.peaks), found.peaks.min())
    return np.concatenate([found.peaks, rest])


def _exceeded(rows: FloatArray) -> FloatArray:
    """Level (R,) that 2 % of the waves of each row (R, W) exceed, linear between ranks."""
    falling = -np.sort(-rows, axis=1)
    rank = PART * rows.shape[1] - 1.0
    i = min(int(rank), rows.shape[1] - 2)
    return np.asarray(falling[:, i] + (rank - i) * (falling[:, i + 1] - falling[:, i]))
