"""Answers of [[force]]: horizontal force, uplift and overturning moment of the waves on a wall, event by event.

A load counts from its level at rest (`houle.analysis.events`), so that neither buoyancy nor water that pools behind a
crest is in it. Directions are those of the waves: "landward" is the way they travel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from houle.analysis.events import Events, interval, load_events
from houle.errors import CaseError
from houle.grid import FloatArray
from houle.results.answers import wall_formulas
from houle.results.answers.given import Given, Question, with_formulas, worst
from houle.results.answers.outline import outline_of
from houle.results.answers.stability import safety
from houle.results.answers.structure import Outline, Sea, Wall
from houle.results.answers.table import BOUND, BRIEF, WINDOW, Answer, Beside, not_answered
from houle.results.answers.wall import wall_of

if TYPE_CHECKING:
    from houle.case.tables.observed import Force

GODA = 250  # F_1/250 is the mean of the highest of so many waves
ENDS = ("left", "right")  # sides of the tank that waves run against
TENTH = 0.1  # part of the waves that exceed a load
ENOUGH = 20  # waves from which on a tenth of them is told


def questions(given: Given) -> Iterator[Question]:
    """A question for each [[force]]: its loads; and its safety where a weight is given.

    The question of a side that no wave runs against has no answer.
    """
    for row, table in enumerate(given.case.force):
        if given.sea is None:
            yield f"force {table.name}", partial(_whole, given, row, table)
            continue
        if table.side not in (None, *ENDS):
            yield f"force {table.name}", partial(_no_wall, table)
            continue
        walls = [wall_of(one, row, table) for one in given.each]
        yield f"force {table.name}", partial(_loads, given, walls)
        if table.weight is not None:
            runs = [partial(safety, one, wall, table) for one, wall in zip(given.each, walls, strict=True)]
            yield f"safety {table.name}", partial(worst, given, runs, lowest=True)


def _no_wall(table: Force) -> NoReturn:
    """Raises CaseError: waves run against no such side."""
    raise CaseError(f'side = "{table.side}" is no wall that waves run against; its force is in series.nc')


def _whole(given: Given, row: int, table: Force) -> Iterator[Answer]:
    """Largest and least horizontal force in the whole run, where no waves part it into events."""
    force = given.record("force", row)[:, 0] / given.width
    for word, value in (("largest", force.max()), ("least", force.min())):
        yield Answer(
            f"force {table.name}, {word} along x", float(value), "N/m", method="in the whole run", group="force"
        )


def _loads(given: Given, walls: Sequence[Wall]) -> Iterator[Answer]:
    """The rows of a wall, as it stood in each run. Raises AnalysisError, CaseError."""
    wall = walls[0]
    density, sea = given.case.fluid.density, given.sea
    assert sea is not None
    name = f"force {wall.name}"
    outline = _Front(given, sea, wall)
    towards = _events(given, walls, lambda one: one.horizontal)
    yield _impulse(given, name, wall, towards)
    largest = _largest(given, f"{name}, F_max landward", wall, towards, "N/m", "force")
    yield (
        with_formulas(largest, sea, lambda: [wall_formulas.horizontal(sea, outline.found, density)])
        if not (sea.regular)
        else _regular(largest, sea, outline, density)
    )
    yield from _statistics(given, name, wall, towards)
    away = _events(given, walls, lambda one: -one.horizontal)
    yield _largest(given, f"{name}, F_max seaward", wall, away, "N/m", "force")
    if wall.under:
        lifting = _events(given, walls, lambda one: one.upward)
        row = _largest(given, f"{name}, uplift", wall, lifting, "N/m", "force")
        yield with_formulas(row, sea, lambda: [wall_formulas.uplift(sea, outline.found, density, wall.width)])
    else:
        yield not_answered(f"{name}, uplift", "the structure stands on the floor or on a solid: no water is under it")
    tipping = _events(given, walls, lambda one: one.moment)
    row = _largest(given, f"{name}, overturning moment", wall, tipping, "N", "moment").noted(wall.about)
    yield with_formulas(
        row, sea, lambda: [wall_formulas.overturning(sea, outline.found, density, wall.width, wall.under)]
    )


def _regular(row: Answer, sea: Sea, outline: _Front, density: float) -> Answer:
    """The row with Sainflou's standing wave, which is for waves that are all alike."""

    def found() -> list[Beside]:
        return [wall_formulas.horizontal(sea, outline.found, density)]

    return with_formulas(row, replace(sea, lack=""), found)


class _Front:
    """The section in front of a wall, looked at when a formula asks for it."""

    def __init__(self, given: Given, sea: Sea, wall: Wall) -> None:
        self.given, self.sea, self.wall = given, sea, wall

    @property
    def found(self) -> Outline:
        """The outline. Raises OutlineError."""
        return self.wall.outline or outline_of(self.given.case, self.sea, self.wall.crest)


def _events(given: Given, walls: Sequence[Wall], load: Callable[[Wall], FloatArray]) -> Events:
    """Events of a load (T,) of a wall, as it stood in each run."""
    found = []
    for one, wall in zip(given.each, walls, strict=True):
        assert one.sea is not None
        late, waves, window = one.late(wall.front), one.waves(wall.front), WINDOW * one.sea.mean
        found.append(load_events(one.time[late], load(wall)[late], window=window, waves=waves))
    return Events.together(found, given.offsets)


def _impulse(given: Given, name: str, wall: Wall, found: Events) -> Answer:
    """The largest impulse, first: it depends least on the spacing."""
    method = f"force above its level at rest over time, from rest to rest, {given.when(wall.front)}"
    if not len(found):
        return not_answered(f"{name}, largest impulse", "the force stands still")
    top = int(np.argmax(found.impulses))
    begins, ends = found.spans[top]
    lasts = f"from {given.moment(begins)} on for {ends - begins:.3g} s"
    note = f"{lasts}, peak {found.peaks[top]:.4g} N/m risen in {found.rise[top]:.3g} s"
    value = float(found.impulses[top])
    return Answer(f"{name}, largest impulse landward", value, "N s/m", method=method, note=note, group="impulse")


def _largest(given: Given, name: str, wall: Wall, found: Events, unit: str, group: str) -> Answer:
    """The largest load of an event above its level at rest, with its time, rise time and impulse."""
    if not len(found):
        return not_answered(name, "it stands still", unit)
    assert given.sea is not None
    top = found.largest
    rest = float(np.median(found.rest))
    words = (
        f"at {given.moment(found.times[top])}, risen in {found.rise[top]:.3g} s, "
        f"impulse {found.impulses[top]:.3g} {unit[0]} s{unit[1:]}, at rest {rest:.4g} {unit}"
    )
    method = f"highest of {len(found)} events above the level at rest, {given.when(wall.front)}"
    row = Answer(name, float(found.peaks[top]), unit, method=method, note=words, group=group)
    return row.noted(BOUND) if found.rise[top] < BRIEF * given.sea.mean else row


def _statistics(given: Given, name: str, wall: Wall, found: Events) -> Iterator[Answer]:
    """F_1/250, and the force that a tenth of the waves exceed, with its interval."""
    waves, when = given.waves(wall.front), given.when(wall.front)
    if waves < GODA:
        few = f"{waves:.0f} waves came, {GODA} are the least: it would be F_max"
        yield not_answered(f"{name}, F_1/250", few, "N/m")
    else:
        method = f"mean of the highest {int(waves / GODA)} of {waves:.0f} waves"
        yield Answer(f"{name}, F_1/250", found.highest(1 / GODA), "N/m", method=method, group="force")
    if waves < ENOUGH or len(found) <= TENTH * waves:
        yield not_answered(f"{name}, F_10%", f"{len(found)} events of {waves:.0f} waves do not tell it", "N/m")
        return
    peaks = np.concatenate([found.peaks, np.zeros(max(0, round(waves) - len(found)))])
    low, high = interval(peaks, _tenth)
    method = f"exceeded by a tenth of the waves, {when}; interval: stationary block bootstrap of the waves"
    yield Answer(f"{name}, F_10%", float(_tenth(peaks[None])[0]), "N/m", low, high, method, group="force")


def _tenth(rows: FloatArray) -> FloatArray:
    """Load (R,) that a tenth of each row (R, W) exceeds."""
    return np.asarray(np.quantile(rows, 1.0 - TENTH, axis=1))
