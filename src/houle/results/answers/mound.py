"""Answers from inside a mound: decay of the wave pressure between sensors, and the set-up of the phreatic line."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import isfinite, pi, sqrt
from typing import TYPE_CHECKING

import numpy as np

from houle.analysis.decay import pressure_decay
from houle.analysis.events import interval
from houle.case.shapes import shape_of
from houle.design.mound import SLOWER, pore_pressure
from houle.errors import CaseError
from houle.grid import FloatArray
from houle.results.answers.formulas import beside
from houle.results.answers.given import Given, Question, with_formulas
from houle.results.answers.table import WINDOW, Answer, Beside
from houle.waves.dispersion import wave_number

if TYPE_CHECKING:
    from houle.case.tables import observed
    from houle.case.tables.tank import Porous
    from houle.results.answers.structure import Sea

LEVEL = 0.5  # spacings by which sensors of one level may differ in height
FINE = 8  # places in a spacing at which the body is looked for
COVERS = "interval: stationary block bootstrap of the waves"


@dataclass(frozen=True)
class Row:
    """Sensors in one porous body at one level.

    numbers  of the sensors in the case, from the seaward face inwards
    way      (N,) from that face [m]      width  of the body at the level [m]
    x, z     of the outermost sensor [m]
    """

    body: Porous
    numbers: tuple[int, ...]
    names: tuple[str, ...]
    way: FloatArray
    width: float
    x: float
    z: float


def questions(given: Given) -> Iterator[Question]:
    """A question for each row of sensors in a porous body, and for each [[phreatic]]; none without a train of waves."""
    if given.sea is None or given.single:
        return
    for row in _rows(given, given.sea):
        yield f"mound {row.body.name}, decay of the pressure at z = {row.z:.3g} m", partial(_decay, given, row)
    for table in given.case.phreatic:
        yield f"phreatic {table.name}, set-up", partial(_set_up, given, table)


def _rows(given: Given, sea: Sea) -> Iterator[Row]:
    """Rows of two sensors or more."""
    case, spacing = given.case, given.case.domain.spacing
    shapes = [(body, shape_of(body, case.dimension)) for body in case.porous]
    groups: dict[tuple[str, int], list[int]] = {}
    for number, sensor in enumerate(case.sensor):
        at = np.array(sensor.at)
        inside = [body.name for body, shape in shapes if float(shape.distance(at)) < 0.0]
        if inside:  # the last one holds where bodies overlap
            groups.setdefault((inside[-1], round(sensor.at[-1] / (LEVEL * spacing))), []).append(number)
    for (name, _), numbers in groups.items():
        body, shape = next(pair for pair in shapes if pair[0].name == name)
        first = np.array(case.sensor[numbers[0]].at)
        line = np.repeat(first[None], round(FINE * case.domain.size[0] / spacing) + 1, axis=0)
        line[:, 0] = np.linspace(0.0, case.domain.size[0], len(line))
        within = line[shape.distance(line) < 0.0, 0]
        face = within[np.argmin(np.abs(within - sea.maker))]
        way = np.array([abs(case.sensor[n].at[0] - face) for n in numbers])
        if len(np.unique(way)) < 2:
            continue
        order = np.argsort(way, kind="stable")
        kept = tuple(numbers[i] for i in order)
        names = tuple(case.sensor[n].name for n in kept)
        x = case.sensor[kept[0]].at[0]
        yield Row(body, kept, names, way[order], float(np.ptp(within)), x, float(first[-1]))


def _decay(given: Given, row: Row) -> Iterator[Answer]:
    """The decay along a row of sensors, and the largest gradient between its ends. Raises AnalysisError, CaseError."""
    sea, case = given.sea, given.case
    assert sea is not None
    waves, pressure, time = int(given.waves(row.x)), _pressures(given, row), _times(given, row.x)
    if (pressure == 0.0).any():
        dry = row.names[int((pressure == 0.0).any(axis=1).argmax())]
        raise CaseError(f"sensor {dry} falls dry")
    found = pressure_decay(time, pressure, row.way, waves=waves, window=WINDOW * sea.mean)
    length = _length(given) / sqrt(SLOWER)
    to_delta = length / (2 * pi)
    name = f"mound {row.body.name}, decay of the pressure at z = {row.z:.3g} m"
    low, high = found.low * to_delta, found.high * to_delta
    method = f"delta of p_0 exp(-delta 2 pi x/L'), L' {length:.3g} m, {', '.join(row.names)}, {given.when(row.x)}"
    answer = Answer(name, found.rate * to_delta, "-", low, high, f"{method}; {COVERS}", group="decay")
    answer = answer.noted(
        f"root mean square {', '.join(f'{p:.3g}' for p in found.rms)} Pa at {', '.join(f'{x:.3g}' for x in row.way)} m "
        f"from the face of {row.body.name}, {row.width:.3g} m wide there",
        f"the sensors lie within {100 * found.misfit:.2g} % of the line" if len(row.way) > 2 else "",
    )
    yield with_formulas(answer, _told(sea), lambda: [_formula(given, row, sea)])
    seaward = (pressure[-1] - pressure[0]) / (case.fluid.density * case.fluid.gravity * np.ptp(row.way))
    most = int(seaward.argmax())
    yield Answer(
        f"mound {row.body.name}, largest seaward gradient at z = {row.z:.3g} m", float(seaward[most]), "-",
        method=f"between {row.names[0]} and {row.names[-1]}, {given.when(row.x)}",
        note=f"at {given.moment(time[most])}",
    )  # fmt: skip


def _pressures(given: Given, row: Row) -> FloatArray:
    """Pressures (N, T) [Pa] of the sensors, of all runs one after the other. Raises AnalysisError."""
    records = [
        [one.record("pressure", n)[late] for n in row.numbers] for one in given.each for late in (one.late(row.x),)
    ]
    return np.concatenate([np.stack(record) for record in records], axis=1)


def _times(given: Given, x: float) -> FloatArray:
    """Times [s] of the rows of all runs that are looked at at x [m], one run after the other."""
    times = [one.time[one.late(x)] + shift for one, shift in zip(given.each, given.offsets, strict=True)]
    return np.concatenate(times)


def _told(sea: Sea) -> Sea:
    """The sea, also where its waves are all alike: the formula was measured in such waves."""
    return replace(sea, lack="") if sea.regular else sea


def _length(given: Given) -> float:
    """Length [m] of the waves of the peak period in the depth in which they are made."""
    wave, sea = given.case.wave, given.sea
    assert wave is not None and sea is not None
    period = wave.period if isfinite(sea.height) else sea.mean
    return float(2 * pi / wave_number(2 * pi / period, sea.depth))


def _formula(given: Given, row: Row, sea: Sea) -> Beside:
    """The decay by Oumeraci & Partenscky and Burcharth et al. Raises DesignError."""
    found = pore_pressure(
        pressure=1.0, x=0.0, wave_height=sea.height, wave_length=_length(given), porosity=row.body.porosity,
        core_width=row.width,
    )  # fmt: skip
    return replace(beside(found, "pore-pressure, 0.0141 sqrt(n) L_p^2/(Hs b)"), value=found.delta)


def _set_up(given: Given, table: observed.Phreatic) -> Iterator[Answer]:
    """The mean of a phreatic line above still water where it is highest. Raises AnalysisError; CaseError if dry."""
    sea = given.sea
    assert sea is not None
    mine = np.flatnonzero(np.asarray(given.series["phreatic"].values) == table.name)
    places = np.asarray(given.series["phreatic_x"].values)[mine]
    x = float(places[np.argmin(np.abs(places - sea.maker))])
    levels = [np.stack([one.record("phreatic_level", int(n))[one.late(x)] for n in mine]) for one in given.each]
    waves, level = int(given.waves(x)), np.concatenate(levels, axis=1) - sea.level
    wet = np.isfinite(level).all(axis=1)
    if not wet.any():
        raise CaseError("every place of the line falls dry")
    highest = int(np.flatnonzero(wet)[np.argmax(level[wet].mean(axis=1))])
    means = np.array([part.mean() for part in np.array_split(level[highest], waves)])
    low, high = interval(means, lambda rows: rows.mean(axis=1))
    row = Answer(
        f"phreatic {table.name}, set-up", float(level[highest].mean()), "m", low, high,
        f"mean above still water, {given.when(x)}; {COVERS}", group="set-up",
    )  # fmt: skip
    yield row.noted(
        f"at x = {places[highest]:.4g} m, the highest of {int(wet.sum())} places; {level[highest].min():+.3g} to "
        f"{level[highest].max():+.3g} m in time"
    )
