"""Data that the rows of answers are made of: the case, its series, its sea; and what may go wrong with a question.

Several runs of a case in seas that differ by their seed are one `Given` with parts: what is measured, wave by wave, in
each of them is put together before a statistic is taken. Times of the parts follow one another then.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from houle.analysis.errors import AnalysisError
from houle.design.errors import DesignError
from houle.errors import CaseError
from houle.grid import FloatArray
from houle.output.netcdf import TIME
from houle.results.answers.structure import Sea
from houle.results.answers.table import Answer, Beside, not_answered

if TYPE_CHECKING:
    from houle.case.model import Case
    from houle.output.netcdf import Table

SINGLE = ("solitary", "focused", "ship")  # kinds of which one wave or group comes: the whole run is about it
EXPECTED = (CaseError, AnalysisError, DesignError)  # errors whose message is the reason that a question has no answer
Question = tuple[str, Callable[[], Iterable[Answer]]]


@dataclass(frozen=True)
class Given:
    """A case, the series of its run, and its sea; None without [waves].

    parts  the runs that are taken together, of the seeds of a case; case, series and sea are then those of the first,
           but for what the sea has in the mean
    """

    case: Case
    series: Table
    sea: Sea | None
    parts: tuple[Given, ...] = ()

    @property
    def each(self) -> tuple[Given, ...]:
        """The runs: the parts, or the one itself."""
        return self.parts or (self,)

    @property
    def offsets(self) -> FloatArray:
        """Times [s] that are added to those of each run, so that the runs follow one another; 0 of one run."""
        return np.concatenate([[0.0], np.cumsum([one.end for one in self.each])[:-1]])

    def moment(self, time: float) -> str:
        """A time [s] with its offset in words, of several runs with the seed."""
        number = int(np.searchsorted(self.offsets, time, side="right")) - 1
        told = f"{time - self.offsets[number]:.4g} s"
        return f"{told} of {self.parts[number].seed}" if self.parts else told

    @property
    def seed(self) -> str:
        """The seed of the run in words."""
        return "" if self.case.waves is None else f"seed {self.case.waves.seed}"

    @property
    def width(self) -> float:
        """Width of the tank [m], by which volumes and forces of a 3D run are divided; 1 in 2D."""
        return self.case.domain.size[1] if self.case.dimension == 3 else 1.0

    @property
    def single(self) -> bool:
        """True where one wave or group comes: the whole run is looked at, and no waves are counted."""
        return self.case.waves is not None and self.case.waves.kind in SINGLE

    @property
    def time(self) -> FloatArray:
        """Times (T,) of the series [s]."""
        return np.asarray(self.series[TIME].values)

    def record(self, name: str, row: int) -> FloatArray:
        """Values of a variable at its station `row`: (T,), of a vector (T, d)."""
        variable = self.series[name]
        return np.moveaxis(variable.values[row], variable.dims.index(TIME) - 1, 0)

    def late(self, x: float) -> NDArray[np.intp]:
        """Numbers of the rows of the series from the arrival of the waves at x [m] on; all without waves, or of one.

        Raises AnalysisError where fewer than three waves have come.
        """
        if self.sea is None or self.single:
            return np.arange(len(self.time))
        start = self.sea.start(x)
        if (count := self.waves(x)) < 3.0:
            arrived = f"the waves arrive at x = {x:g} m at t = {start:.3g} s and the run ends at {self.end:.4g} s"
            raise AnalysisError(f"{arrived}: {max(0.0, count):.2g} waves; 3 are the least")
        return np.flatnonzero(self.time >= start)

    @property
    def end(self) -> float:
        return float(self.time[-1])

    def waves(self, x: float) -> float:
        """Number of waves that came to x [m] in the run: their mean period is that between zero crossings."""
        assert self.sea is not None
        if self.parts:
            return sum(one.waves(x) for one in self.parts)
        if self.single:
            return 1.0
        return (self.end - self.sea.start(x)) / self.sea.mean

    def when(self, x: float) -> str:
        """The part of the run that is looked at, in words."""
        if self.parts and self.sea is not None:
            return f"{len(self.parts)} seeds, {self.parts[0].when(x)} each, {self.waves(x):.0f} waves in all"
        if self.sea is None or self.single:
            return f"0 to {self.end:.4g} s"
        return f"{self.sea.start(x):.4g} to {self.end:.4g} s, {self.waves(x):.0f} waves of {self.sea.mean:.3g} s"


def attempted(question: Question) -> Iterator[Answer]:
    """The rows of a question; one that says why where it has no answer."""
    name, ask = question
    try:
        yield from ask()
    except EXPECTED as error:
        yield not_answered(name, error)


def worst(given: Given, runs: Sequence[Callable[[], Iterable[Answer]]], lowest: bool = False) -> Iterator[Answer]:
    """Rows with the largest, or lowest, value among those of each run; of several runs with the seed in their note.

    A row that no run answers is told as the first run tells it. Raises what the runs raise.
    """
    found: dict[str, list[tuple[Answer, str]]] = {}
    for run, one in zip(runs, given.each, strict=True):
        for row in run():
            found.setdefault(row.name, []).append((row, f"in {one.seed}" if given.parts else ""))
    for rows in found.values():
        known = [(row, words) for row, words in rows if row.answered]
        row, words = (min if lowest else max)(known, key=lambda pair: pair[0].value) if known else (rows[0][0], "")
        yield row.noted(words)


def with_formulas(row: Answer, sea: Sea | None, find: Callable[[], Iterable[Beside]]) -> Answer:
    """The row with published formulas beside it, or with the reason why there is none in its note."""
    if sea is None:
        return row.noted("no formula: the case has no [waves]")
    if sea.lack:
        return row.noted(f"no formula: {sea.lack}")
    try:
        found = tuple(find())
    except EXPECTED as error:
        return row.noted(f"no formula: {error}")
    said = [f"{one.name}: {', '.join(one.words)}" for one in found if one.words]
    return replace(row, formulas=found).noted(*said)


def with_tests(row: Answer, sea: Sea | None, find: Callable[[], Beside]) -> Answer:
    """The row with the nearest laboratory tests beside it, or with the reason why there are none in its note."""
    if sea is None or sea.lack:
        return row
    try:
        return replace(row, tests=find())
    except EXPECTED as error:
        return row.noted(f"no laboratory tests: {error}")
