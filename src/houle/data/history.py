"""Histories: values against time in a file beside the case, on the clock of the run, and where they do not serve it.

A file has a clock of its own; `start` is the time on it at which the run begins. Rows without a number are left out,
and so are rows that stand twice. Between samples a value goes along a straight line: over a hole that is longer than a
few usual steps this would make up what was not measured, so such a hole is told unless the case allows it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from houle.data.csv_table import read_columns
from houle.data.files import require_file
from houle.errors import CaseError
from houle.grid import FloatArray

USUAL = 90  # per cent of the steps are no longer than the usual one: few holes do not make it long
HOLE = 3.5  # usual steps without a sample from which on it is a hole: two in a row may be missing
REST = 0.01  # of the span of values: what changes less at an end is at rest there
FEW = 3  # steps at an end that tell whether it is at rest

Told = tuple[Literal["error", "warning", "info"], str]


@dataclass(frozen=True)
class History:
    """time (N,) rising, on the clock of the run [s]; values, each (N,); start, time of the file at its t = 0 [s]."""

    time: FloatArray
    values: list[FloatArray]
    start: float = 0.0

    @property
    def step(self) -> float:
        """The usual one [s]."""
        return float(np.percentile(np.diff(self.time), USUAL)) if len(self.time) > 1 else 0.0

    def resting(self, last: bool, still: float | None) -> bool:
        """Whether all values stay as they are at that end, or at a level `still`."""
        for value in self.values:
            end = value[-FEW - 1 :] if last else value[: FEW + 1]
            level = still if still is not None else float(end[-1 if last else 0])
            if np.abs(end - level).max() > REST * np.ptp(value):
                return False
        return True


@dataclass(frozen=True)
class Record:
    """A value against time: linear between its points, constant before and after."""

    time: FloatArray
    value: FloatArray

    def at(self, t: float) -> float:
        return float(np.interp(t, self.time, self.value))


def read_history(
    file: Path, columns: tuple[str, ...], key: str, least: int, start: float = 0.0, error: type[CaseError] = CaseError
) -> History:
    """The columns of a file against its column t_s. Raises `error`, which names the key of the case file, and the row.

    least  number of samples that are needed
    """
    require_file(file, key, error)
    (time, *values), _ = read_columns(file, ("t_s", *columns), key, error)
    known = np.all(np.isfinite([time, *values]), axis=0)
    rows = np.flatnonzero(known) + 1
    table = np.array([time, *values])[:, known]
    again = np.zeros(len(rows), bool)
    again[1:] = np.all(table[:, 1:] == table[:, :-1], axis=0)
    table, rows = table[:, ~again], rows[~again]
    if table.shape[1] < least:
        raise error(
            f"{key} = {file} needs at least {least} rows of finite numbers with rising times; it has {table.shape[1]}"
        )
    if (falls := np.flatnonzero(np.diff(table[0]) <= 0)).size:
        i = int(falls[0])
        before, after = table[0, i], table[0, i + 1]
        said = f"{after:g} s stands twice with other values" if before == after else f"{after:g} s follows {before:g} s"
        raise error(f"{key} = {file} needs rising times: {said} (row {rows[i + 1]}); sort its rows, one for each time")
    return History(table[0] - start, list(table[1:]), start)


def shortcomings(
    known: History, end: float, gap: float | None, still: float | None = None, outside: str = "the last value is held"
) -> Iterator[Told]:
    """What a history of a run to `end` [s] lacks, in words that follow its key: time in common, an end, samples.

    gap      longest hole that a straight line may stand for [s]; HOLE usual steps if None
    still    the value of rest, any if None          outside  what is taken where the file says nothing
    """
    first, last, low, high = (float(t) + known.start for t in (known.time[0], known.time[-1], 0.0, end))
    has = f"has times from {first:.12g} to {last:.12g} s, the run takes {low:.12g} to {high:.12g} s of its clock"
    if first >= high or last <= low:
        yield "error", f"{has}: they have nothing in common; start = {first:.12g} makes its first time t = 0 of the run"
        return
    for beyond, where, at_end in (
        (first - low, f"before {first:.12g} s", False),
        (high - last, f"after {last:.12g} s", True),
    ):
        if beyond > HOLE * known.step:
            cure = f"start = {first:.12g}" if not at_end else f"time.end = {last - low:g}, or a longer record"
            level: Literal["warning", "info"] = "info" if known.resting(at_end, still) else "warning"
            yield level, f"{has}: {where} {outside}; {cure}"
    yield from _holes(known, end, gap)


def _holes(known: History, end: float, gap: float | None) -> Iterator[Told]:
    """Those inside the run, the longest of them with its place."""
    allowed = HOLE * known.step if gap is None else gap * (1 + 1e-9)
    before, after = known.time[:-1], known.time[1:]
    long = np.flatnonzero((after - before > allowed) & (after > 0.0) & (before < end))
    if not long.size:
        return
    i = int(long[np.argmax((after - before)[long])])
    size, others = float(after[i] - before[i]), len(long) - 1
    more = f", nor at {others} other place{'s' if others > 1 else ''}" if others else ""
    yield (
        "error",
        f"has no sample between {before[i] + known.start:.12g} and {after[i] + known.start:.12g} s{more}, elsewhere "
        f"one every {known.step:.3g} s: a straight line of {size:.3g} s would stand for it; close the hole, or allow "
        f"it with gap = {size:.3g}",
    )
