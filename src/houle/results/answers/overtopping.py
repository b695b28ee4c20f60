"""Answers of [[overtopping]]: mean discharge, share of the waves, single volumes and their Weibull distribution."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from math import nan
from typing import TYPE_CHECKING

import numpy as np

from houle.analysis.errors import AnalysisError
from houle.analysis.events import mean_interval, per_wave
from houle.analysis.volumes import Volumes, wave_volumes
from houle.analysis.weibull import Weibull, weibull_fit
from houle.grid import FloatArray
from houle.results.answers import formulas
from houle.results.answers.given import Given, Question, with_formulas, with_tests
from houle.results.answers.outline import outline_of
from houle.results.answers.table import Answer, Beside, not_answered

if TYPE_CHECKING:
    from houle.case.tables.observed import Overtopping
    from houle.results.answers.structure import Outline, Sea

ENOUGH = 10  # overtopping waves from which on their volumes have a distribution
LEAST = 1.0  # cells of water: a smaller volume is counted in the discharge and not as a wave
COARSE = 20.0  # cells of water in a wave, below which its volume is coarse
COVERS = "interval: stationary block bootstrap of the waves, those that did not overtop included"


def questions(given: Given) -> Iterator[Question]:
    """One question for each [[overtopping]]."""
    for row, table in enumerate(given.case.overtopping):
        yield f"overtopping {table.name}", Crest(given, row, table).rows


class Crest:
    """A crest of a run: the volume that came over it, wave by wave."""

    def __init__(self, given: Given, row: int, table: Overtopping) -> None:
        self.given, self.row, self.table, self.x = given, row, table, table.x
        self.cell = float(np.prod(given.case.domain.grid.spacing)) / given.width

    @cached_property
    def outline(self) -> Outline:
        """The section in front of the crest. Raises OutlineError."""
        assert self.given.sea is not None
        return outline_of(self.given.case, self.given.sea, self.x)

    @property
    def sea(self) -> Sea:
        assert self.given.sea is not None
        return self.given.sea

    def rows(self) -> Iterator[Answer]:
        """The rows of the crest. Raises AnalysisError, CaseError."""
        name, when = f"overtopping {self.table.name}", self.given.when(self.x)
        if self.given.sea is None or self.given.single:
            volume = float(self._record(self.given)[-1])
            yield Answer(f"{name}, volume", volume, "m3/m", method=f"all that came over, {when}")
            return
        runs = [self._waves(one) for one in self.given.each]
        found = _together([one for one, *_ in runs], self.given.offsets)
        slots, counts = (np.concatenate([run[i] for run in runs]) for i in (1, 2))
        yield from self._discharge(name, found, slots, when)
        if found.total > 0.0 and not len(found.volumes):
            yield not_answered(f"{name}, share of the waves", "each wave brought less than a cell of water", "-")
        else:
            yield self._share(name, counts, when)
        if len(found.volumes):
            yield from self._volumes(name, found.volumes, when)

    def _record(self, given: Given) -> FloatArray:
        """The volume so far (T,) [m3/m] of a run."""
        return given.record("overtopping_volume", self.row) / given.width

    def _waves(self, given: Given) -> tuple[Volumes, FloatArray, FloatArray]:
        """The overtopping waves of a run; volume, and number, in the slot of each wave. Raises AnalysisError."""
        assert given.sea is not None
        late = given.late(self.x)
        time, volume = given.time[late], self._record(given)[late]
        found = wave_volumes(time, volume, period=given.sea.mean, least=LEAST * self.cell)
        waves = max(round(given.waves(self.x)), len(found.volumes))
        span = (float(time[0]), float(time[-1]), waves)
        return (
            found, per_wave(found.times, found.volumes, *span), per_wave(found.times, np.ones(len(found.times)), *span)
        )  # fmt: skip

    def _discharge(self, name: str, found: Volumes, slots: FloatArray, when: str) -> Iterator[Answer]:
        """The mean discharge in m3/s/m with all that stands beside it, and once more in l/s/m."""
        known = found.q > 0.0  # water that flows back counts negative
        ends = mean_interval(slots) if known else (nan, nan)
        low, high = (found.q * end / float(slots.mean()) if end == end else nan for end in ends)
        row = Answer(
            f"{name}, mean discharge", found.q, "m3/s/m", low, high, f"volume over time, {when}; {COVERS}",
            group="discharge",
        )  # fmt: skip
        if not len(found.volumes) and found.q > 0.0:
            row = row.noted(f"each wave brought less than a cell of water, {self.cell:.3g} m3/m: none is counted")
        elif not len(found.volumes):
            row = row.noted(_none_of(len(slots)))
        if found.q < 0.0:
            row = row.noted("more water flowed back than came over")
        elif len(found.volumes) and low != low:
            row = row.noted(f"{len(found.volumes)} overtopping waves give no interval, 3 or more do")
        row = with_formulas(row, self.given.sea, lambda: formulas.mean_overtopping(self.sea, self.outline))
        row = with_tests(row, self.given.sea, lambda: formulas.laboratory_tests(self.sea, self.outline))
        row = self._described(row)
        yield row
        yield replace(_litres(row, f"{name}, the same in litres"), note="")

    def _described(self, row: Answer) -> Answer:
        """The row with section and sea in its note, if they were used."""
        if not row.formulas:
            return row
        if row.tests is not None and (far := [w for w in row.tests.words if not w.startswith("row ")]):
            row = row.noted(f"tests: {', '.join(far)}")
        armour = (
            f"gamma_f {formulas.roughness(self.outline):g}, two layers of rock" if self.outline.kind == "mound" else ""
        )
        return row.noted(f"section: {self.outline.words}", armour, f"sea: {self.sea.words}")

    def _share(self, name: str, slots: FloatArray, when: str) -> Answer:
        """Share of the waves that overtop, from the number in each wave's slot."""
        low, high = mean_interval(slots)
        method = f"{slots.sum():.0f} overtopping waves of {len(slots)}, {when}; {COVERS}"
        share = float(slots.mean())
        row = Answer(f"{name}, share of the waves", share, "-", low, min(1.0, high) if high == high else nan, method)
        return with_formulas(
            replace(row, group="share"), self.given.sea, lambda: [formulas.share(self.sea, self.outline)]
        )

    def _volumes(self, name: str, volumes: FloatArray, when: str) -> Iterator[Answer]:
        """The largest volume, and scale and shape of the Weibull distribution of all."""
        fitted, why = self._fitted(volumes)
        cells = float(volumes.mean()) / self.cell
        coarse = f"a mean overtopping wave is {cells:.3g} cells of water"
        largest = Answer(
            f"{name}, V_max", float(volumes.max()), "m3/m", method=f"largest of {len(volumes)} volumes, {when}",
            note=coarse + (f", fewer than {COARSE:g}: coarse" if cells < COARSE else ""), group="volume",
        )  # fmt: skip
        if fitted is not None:
            expected = fitted.expected_largest(len(volumes))
            beside = Beside("a (ln N_ow)^(1/b) of the volumes here", expected)
            largest = replace(largest, formulas=(beside,))
        yield largest
        yield from self._weibull(name, fitted, why, len(volumes))

    def _fitted(self, volumes: FloatArray) -> tuple[Weibull | None, str]:
        """The distribution of the volumes, or None and why there is none."""
        if len(volumes) < ENOUGH:
            return None, f"{len(volumes)} overtopping waves, {ENOUGH} are the least"
        try:
            return weibull_fit(volumes, least=LEAST * self.cell), ""
        except AnalysisError:
            low, high = volumes.min(), volumes.max()
            return None, f"volumes of {low:.4g} to {high:.4g} m3/m are too much alike to determine it"

    def _weibull(self, name: str, fitted: Weibull | None, why: str, count: int) -> Iterator[Answer]:
        """Shape and scale of the volumes of single waves."""
        if fitted is None:
            yield not_answered(f"{name}, Weibull b", why)
            return
        method = f"maximum likelihood of {count} volumes above {LEAST:g} cell of water, P(V > v) = exp(-(v/a)^b)"
        yield Answer(f"{name}, Weibull b", fitted.shape, "-", *fitted.shape_interval, method, group="shape")
        yield Answer(f"{name}, Weibull a", fitted.scale, "m3/m", *fitted.scale_interval, method, group="volume")


def _together(runs: list[Volumes], offsets: FloatArray) -> Volumes:
    """The volumes of several runs as those of one."""
    times = [one.times + offset for one, offset in zip(runs, offsets, strict=True)]
    total, duration = sum(one.total for one in runs), sum(one.duration for one in runs)
    return Volumes(np.concatenate([one.volumes for one in runs]), np.concatenate(times), total, duration)


def _none_of(waves: int) -> str:
    """The number of waves of which none came over, and the share that may overtop all the same."""
    return f"none of {waves} waves came over: up to {100 * (1 - 0.1 ** (1 / waves)):.2g} % of them may (90 %)"


def _litres(row: Answer, name: str) -> Answer:
    """The same discharge in l/s/m."""

    def times(one: Beside) -> Beside:
        points = tuple(1e3 * p for p in one.points)
        return replace(one, value=1e3 * one.value, low=1e3 * one.low, high=1e3 * one.high, points=points)

    return replace(
        row, name=name, unit="l/s/m", value=1e3 * row.value, low=1e3 * row.low, high=1e3 * row.high, group="",
        formulas=tuple(times(one) for one in row.formulas), tests=times(row.tests) if row.tests is not None else None,
    )  # fmt: skip
