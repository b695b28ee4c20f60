"""Pre-flight of [[open]]: is there water at the side, does it start smoothly, does the tank keep its water.

`open_sides_fit` is one of the checks of `rules.py`; `open_rows` are the lines of `houle check`.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

import numpy as np
import shapely

from houle.boundary.open_side import CROSSINGS, NEAR, Record
from houle.case.build import history, records
from houle.case.model import Case
from houle.case.tables.sides import Open
from houle.check.section import Finding, Section
from houle.check.waves import columns
from houle.data.history import shortcomings
from houle.errors import CaseError

CRITICAL, FAST = 1.0, 0.7  # Froude numbers: from the first on no long wave goes upstream; warned of from the second
STEP = 0.02  # of the depth: a level that differs by more from that of the water at the start makes a wave
FILLED = 0.02  # of the water that an imbalance may add or take in the whole run


def open_sides_fit(s: Section) -> Iterator[Finding]:
    """Water, porous bodies, levels and speeds at the open sides, one by one; what all let in together."""
    case = s.case
    known: list[dict[str, Record]] = []
    for table in case.open:
        key = f"open.{table.side}"
        try:
            known.append(records(table, case.folder))
        except CaseError as error:
            named, _, text = str(error).partition(" ")  # open.left.file = ...
            yield Finding("error", named, text) if named.startswith(key) else Finding("error", key, f": {error}")
            continue
        if table.file is not None:
            _, held = history(table, case.folder)
            for level, text in shortcomings(held, case.time.end, table.gap):
                yield Finding(level, f"{key}.file", f'= "{table.file}" {text}')
        found = list(_side(s, table, known[-1], key))
        yield from found
    if len(known) == len(case.open) > 0:
        yield from _balance(s, known)
    if len(known) == len(case.open):
        yield from _current(s, known)


def _at(s: Section, table: Open) -> tuple[float, float]:
    """Depth of the water at the side at the start, and its level [m]; the least over the width."""
    h, size = s.grid.spacing[0], s.case.domain.size[0]
    x = np.array([h / 2 if table.side == "left" else size - h / 2])
    depth, level = columns(s, x)
    return float(depth.min()), float(np.nan_to_num(level).min())


def _side(s: Section, table: Open, known: dict[str, Record], key: str) -> Iterator[Finding]:
    case, h = s.case, s.grid.spacing
    depth, level = _at(s, table)
    if case.domain.periodic[0]:
        yield Finding("error", key, ': walls.x = "periodic" joins this side to the other: remove one of the two')
        return
    if depth < 2 * h[-1]:
        text = f": {depth:.3g} m of water stand at this side at the start, two cells, {2 * h[-1]:.3g} m, are needed"
        yield Finding("error", key, text)
        return
    reach = NEAR * h[0]
    x0 = 0.0 if table.side == "left" else case.domain.size[0] - reach
    window = shapely.box(x0, 0.0, x0 + reach, s.window[3])
    for body in s.porous:
        common = max(shapely.intersection(s.area([body], y), window).area for y in s.layers)
        if common > s.speck:
            text = f"reaches to the open {table.side} side: end it {reach:.3g} m before, in clear water"
            yield Finding("error", body.key, text)
    if "level" in known:
        yield from _level(s, known["level"], key, depth, level)
    speeds = _speeds(known, depth)
    fastest = float(np.abs(speeds).max()) if speeds is not None else 0.0
    if (froude := fastest / sqrt(max(case.fluid.gravity, 1e-12) * depth)) > FAST:
        text = (
            f": {fastest:.3g} m/s in {depth:.3g} m of water is a Froude number of {froude:.2g}; from {CRITICAL:g} on "
            "nothing goes upstream and a side cannot hold a level"
        )
        yield Finding("error" if froude >= CRITICAL and "level" in known else "warning", key, text)
    if speeds is not None and not table.ramp:
        yield from _start(s, table, float(speeds[0]), key)


def _speeds(known: dict[str, Record], depth: float) -> np.ndarray | None:
    """Velocities into the tank [m/s] at the points of the record; None when only a level is given."""
    if "velocity" in known:
        return known["velocity"].value
    return known["discharge"].value / depth if "discharge" in known and depth > 0 else None


def _level(s: Section, wanted: Record, key: str, depth: float, level: float) -> Iterator[Finding]:
    low, high, top = float(wanted.value.min()), float(wanted.value.max()), s.case.domain.size[-1]
    if high >= top or low <= level - depth:
        text = (
            f": a level from {low:g} to {high:g} m; it must lie between the floor, {level - depth:g} m, and the lid, "
        )
        yield Finding("error", key, f"{text}{top:g} m")
    elif abs(wanted.at(0.0) - level) > STEP * depth:
        text = f": the level begins at {wanted.at(0.0):g} m, that of the water beside it is {level:g} m: a wave starts"
        yield Finding("warning", key, text)


def _start(s: Section, table: Open, speed: float, key: str) -> Iterator[Finding]:
    """The water inside moves as the side does from the start, or the side starts slowly."""
    case = s.case
    moving = [w.velocity[0] for w in case.water if w.velocity is not None]
    inside = (moving[0] if moving else 0.0) * (1.0 if table.side == "left" else -1.0)
    if abs(speed - inside) > 1e-3 + 0.1 * abs(speed):
        text = (
            f": {speed:.3g} m/s come in at once, the water inside moves at {inside:.3g} m/s: a jolt; give ramp = "
            f"{case.time.end / 10:.2g} or more, or water.velocity"
        )
        yield Finding("warning", key, text)


def _balance(s: Section, known: list[dict[str, Record]]) -> Iterator[Finding]:
    """Without a level the tank fills or empties by what is let in."""
    case = s.case
    if any("level" in k for k in known):
        return
    net = 0.0
    for table, k in zip(case.open, known, strict=True):
        depth = _at(s, table)[0]
        speeds = _speeds(k, depth)
        if speeds is None:
            return  # no water there, which is said already
        time = next(iter(k.values())).time
        t = np.linspace(0.0, case.time.end, 1001)
        net += float(np.trapezoid(np.interp(t, time, speeds), t)) * depth
    held = max(s.open_water(y).area for y in s.layers)
    if abs(net) <= FILLED * held:
        return
    what = "more" if net > 0 else "less"
    rise = net / case.domain.size[0]
    level = "error" if s.depth() + rise > case.domain.size[-1] or -net > 0.9 * held else "warning"
    text = (
        f": no side has a level, and {abs(net):.3g} m2 {what} come in than go out until {case.time.end:g} s, "
        f"{1e3 * abs(rise):.0f} mm of level: give a level to one side"
    )
    yield Finding(level, "open", text)  # type: ignore[arg-type]


def _current(s: Section, known: list[dict[str, Record]]) -> Iterator[Finding]:
    """waves.current is what the open sides let through."""
    case = s.case
    if case.waves is None:
        return
    stated, flows = case.waves.current, []
    for table, k in zip(case.open, known, strict=True):
        speeds = _speeds(k, _at(s, table)[0])
        if speeds is not None:
            flows.append(float(speeds[-1]) * (1.0 if table.side == "left" else -1.0))
    if stated and not case.open and not case.domain.periodic[0]:
        text = f"= {stated:g} m/s, but the tank is closed: give [[open]] sides that let it in and out"
        yield Finding("error", "waves.current", text)
    elif flows and abs(stated - flows[0]) > 1e-3 + 0.02 * abs(flows[0]):
        text = f"= {stated:g} m/s, but {flows[0]:.3g} m/s come in: they are the same water, current = {flows[0]:.3g}"
        yield Finding("warning", "waves.current", text)


def open_rows(case: Case) -> list[tuple[str, str]]:
    """(side, words) of every open side: what is given, the speed and Froude number it means."""
    s = Section(case)
    return [(f"{table.side} side", _words(s, table)) for table in case.open]


def _words(s: Section, table: Open) -> str:
    known, (depth, _) = records(table, s.case.folder), _at(s, table)
    units = {"velocity": "m/s", "discharge": "m2/s", "level": "m"}
    said = [f"{key} {_span(record)} {units[key]}" for key, record in known.items()]
    wave = sqrt(max(s.case.fluid.gravity, 1e-12) * depth)
    speeds = _speeds(known, depth)
    if speeds is not None:
        fastest = float(np.abs(speeds).max())
        said.append(f"{fastest:.3g} m/s in {depth:.3g} m of water, Froude number {fastest / wave:.2g}")
    if table.ramp:
        said.append(f"grows in {table.ramp:g} s")
    if "level" in known:
        response = table.response or CROSSINGS * s.case.domain.size[0] / wave
        said.append("waves leave" + (f"; the level is found in some {response:.3g} s" if len(known) == 1 else ""))
    if table.file:
        said.append(table.file)
    return ", ".join(said)


def _span(record: Record) -> str:
    low, high = float(record.value.min()), float(record.value.max())
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"
