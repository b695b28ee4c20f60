"""Answers of [[sensor]] under waves: the largest pressures above that at rest."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from houle.analysis.events import Events, load_events
from houle.errors import CaseError
from houle.results.answers.given import Given, Question
from houle.results.answers.table import BOUND, BRIEF, WINDOW, Answer

if TYPE_CHECKING:
    from houle.case.tables.observed import Sensor

TENTH = 0.1  # part of the waves whose pressures are averaged


def questions(given: Given) -> Iterator[Question]:
    """One question for each sensor, if there are waves."""
    for row, table in enumerate(given.case.sensor if given.sea is not None else ()):
        yield f"pressure {table.name}", partial(_rows, given, row, table)


def _rows(given: Given, row: int, table: Sensor) -> Iterator[Answer]:
    """The rows of a sensor. Raises AnalysisError, CaseError."""
    sea, x = given.sea, table.at[0]
    assert sea is not None
    name = f"pressure {table.name}"
    found = Events.together([_events(one, row, x) for one in given.each], given.offsets)
    if not len(found):
        raise CaseError("the pressure stands still")
    top, method = found.largest, f"above the pressure at rest, {given.when(x)}"
    rose = (
        f"at {given.moment(found.times[top])}, risen in {found.rise[top]:.3g} s, impulse {found.impulses[top]:.3g} Pa s"
    )
    note = f"{rose}. {BOUND}" if found.rise[top] < BRIEF * sea.mean else rose
    yield Answer(f"{name}, p_max", float(found.peaks[top]), "Pa", method=method, note=note, group="pressure")
    if np.isfinite(tenth := found.highest(TENTH)):
        yield Answer(f"{name}, p_1/10", tenth, "Pa", method=f"mean of the highest tenth, {method}", group="pressure")


def _events(given: Given, row: int, x: float) -> Events:
    """The events of one run at a sensor. Raises AnalysisError."""
    assert given.sea is not None
    late, window = given.late(x), WINDOW * given.sea.mean
    return load_events(given.time[late], given.record("pressure", row)[late], window=window, waves=given.waves(x))
