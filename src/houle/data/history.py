"""Histories: values against time from a file beside the case, on the clock of the run, and checks that they suffice.

A file has its own clock; `start` is the time on it at which the run begins. Rows without a number are left out, and so
are repeated rows. Between samples a value is interpolated linearly: over a hole longer than a few usual steps this
would invent data, so such a hole is an error unless the case allows it.
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

USUAL = 90  # percentile of the steps that is the usual one: a few holes do not change it
HOLE = 3.5  # usual steps: a longer step is a hole, so that two samples in a row may be missing
REST = 0.01  # share of the range of values: a value that changes less at an end is at rest there
FEW = 3  # steps at an end in which it has to be at rest

Told = tuple[Literal["error", "warning", "info"], str]  # level of a finding, and its text


@dataclass(frozen=True)
class History:
    """Values against time.

    time    (N,) rising, on the clock of the run [s]
    values  arrays (N,), one per column
    start   time on the clock of the file at which the run begins [s]
    """

    time: FloatArray
    values: list[FloatArray]
    start: float = 0.0

    @property
    def step(self) -> float:
        """Usual step of time between samples [s]; 0 for a single one."""
        return float(np.percentile(np.diff(self.time), USUAL)) if len(self.time) > 1 else 0.0

    def resting(self, last: bool, still: float | None) -> bool:
        """True if all values are at rest at the last end, or the first: as they are there, or at `still` if given."""
        for value in self.values:
            end = value[-FEW - 1 :] if last else value[: FEW + 1]
            level = still if still is not None else float(end[-1 if last else 0])
            if np.abs(end - level).max() > REST * np.ptp(value):
                return False
        return True


@dataclass(frozen=True)
class Record:
    """A value (N,) against time (N,) [s]: linear between its points, constant before and after them."""

    time: FloatArray
    value: FloatArray

    def at(self, t: float) -> float:
        """The value at the time t [s]."""
        return float(np.interp(t, self.time, self.value))


def read_history(
    file: Path, columns: tuple[str, ...], key: str, least: int, start: float = 0.0, error: type[CaseError] = CaseError
) -> History:
    """The columns of a file against its column t_s. Raises `error` with the key of the case file and the row.

    key    key of the case file that names the file
    least  number of samples that are needed
    start  time in the file at which the run begins [s]
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
    known: History,
    end: float,
    gap: float | None,
    still: float | None = None,
    outside: str = "the last value is held",
    line: str = "a straight line",
) -> Iterator[Told]:
    """Findings about a history for a run to `end` [s]: does it cover the run, and has it no holes?

    The texts are read after the key of the case file.

    gap      longest hole that is interpolated [s]; None: `HOLE` usual steps
    still    value at rest; None: any
    outside  words for the values that are taken before and after the samples
    line     words for what goes from sample to sample
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
    yield from _holes(known, end, gap, line)


def _holes(known: History, end: float, gap: float | None, line: str) -> Iterator[Told]:
    """An error if there are holes within the run, with the place of the longest one."""
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
        f"one every {known.step:.3g} s: {line} of {size:.3g} s would stand for it; close the hole, or allow "
        f"it with gap = {size:.3g}",
    )
