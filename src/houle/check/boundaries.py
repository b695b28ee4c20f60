"""Checks of the boundaries that move or let water through: gates, open sides, pistons and absorbing walls.

`gates_fit`, `open_sides_fit` and `moving_walls_fit` are three of the CHECKS of `rules.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi, sqrt

import numpy as np
import shapely

from houle.boundary.open_side import NEAR
from houle.boundary.paddle import ROOM
from houle.case.acting import MovingWall, moving_walls, reach
from houle.case.messages import place
from houle.case.section import CrossSection
from houle.case.tables.boundaries import Open, history, records
from houle.check.finding import Finding
from houle.data.history import Record, shortcomings
from houle.errors import CaseError, metres
from houle.waves.dispersion import wave_number
from houle.waves.wave import Wave

CRITICAL, FAST = 1.0, 0.7  # Froude numbers: no long wave travels upstream above the first; the second is warned of
STEP = 0.02  # share of the depth by which a level at the side may differ at the start without a warning
FILLED = 0.02  # share of the water that all sides together may add or take in the whole run without a warning
FRONT = 6  # cells in front of a moving wall where nothing else may stand


def gates_fit(s: CrossSection) -> Iterator[Finding]:
    """Each gate stands inside the domain; tells the face of the grid on which it is put."""
    h, size = s.grid.spacing[0], s.case.domain.size[0]
    for i, gate in enumerate(s.case.gate):
        key = place(("gate", i, "x"), s.case.__dict__)
        if not h / 2 < gate.x < size - h / 2:
            hint = metres(gate.x, size)
            yield Finding("error", key, f"= {gate.x:g} does not lie inside the domain, 0 < x < {size:g} m.{hint}")
        else:
            face = s.grid.nearest_face(gate.x)
            text = f"= {gate.x:g} m: the gate stands on the nearest face of the grid, x = {face:.6g} m"
            yield Finding("info", key, text)


# ---- open sides ------------------------------------------------------------------------------------------------------


def open_sides_fit(s: CrossSection) -> Iterator[Finding]:
    """Each open side has sound records, water beside it and no obstacle; together they keep the tank filled."""
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
            _, record = history(table, case.folder)
            for level, text in shortcomings(record, case.time.end, table.gap):
                yield Finding(level, f"{key}.file", f'= "{table.file}" {text}')
        found = list(_side(s, table, known[-1], key))
        yield from found
    if len(known) == len(case.open) > 0:
        yield from _balance(s, known)
    if len(known) == len(case.open):
        yield from _current(s, known)


def water_beside(s: CrossSection, table: Open) -> tuple[float, float]:
    """Depth and level of the water at an open side at the start [m], each the least over the width of the tank."""
    h, size = s.grid.spacing[0], s.case.domain.size[0]
    x = np.array([h / 2 if table.side == "left" else size - h / 2])
    depth, level = s.standing(x)
    return float(depth.min()), float(np.nan_to_num(level).min())


def _side(s: CrossSection, table: Open, known: dict[str, Record], key: str) -> Iterator[Finding]:
    """One side: depth, bodies and gates near it, level, Froude number, sudden start. known: its records by key."""
    case, h = s.case, s.grid.spacing
    depth, level = water_beside(s, table)
    if case.domain.periodic[0]:
        yield Finding("error", key, ': walls.x = "periodic" joins this side to the other: remove one of the two')
        return
    if depth < 2 * h[-1]:
        text = f": {depth:.3g} m of water stand at this side at the start, two cells, {2 * h[-1]:.3g} m, are needed"
        yield Finding("error", key, text)
        return
    clear = NEAR * h[0]
    x0 = 0.0 if table.side == "left" else case.domain.size[0] - clear
    window = shapely.box(x0, 0.0, x0 + clear, s.window[3])
    for body in s.porous:
        common = max(shapely.intersection(s.area([body], y), window).area for y in s.layers)
        if common > s.speck:
            text = f"reaches to the open {table.side} side: end it {clear:.3g} m before, in clear water"
            yield Finding("error", body.key, text)
    for i, gate in enumerate(case.gate):
        if abs(gate.x - (0.0 if table.side == "left" else case.domain.size[0])) < clear:
            text = f"= {gate.x:g} m stands in the {NEAR} columns, {clear:.3g} m, over which the open {table.side} side "
            yield Finding("error", place(("gate", i, "x"), case.__dict__), f"{text}reads its level: move it inwards")
    if "level" in known:
        yield from _level(s, known["level"], key, depth, level)
    speeds = inflow(known, depth)
    fastest = float(np.abs(speeds).max()) if speeds is not None else 0.0
    if (froude := fastest / sqrt(max(case.fluid.gravity, 1e-12) * depth)) > FAST:
        text = (
            f": {fastest:.3g} m/s in {depth:.3g} m of water is a Froude number of {froude:.2g}; from {CRITICAL:g} on "
            "nothing goes upstream and a side cannot hold a level"
        )
        yield Finding("error" if froude >= CRITICAL and "level" in known else "warning", key, text)
    if speeds is not None and not table.ramp:
        yield from _start(s, table, float(speeds[0]), key)


def inflow(known: dict[str, Record], depth: float) -> np.ndarray | None:
    """Velocities into the tank [m/s] at the points of the record; None when only a level is given."""
    if "velocity" in known:
        return known["velocity"].value
    return known["discharge"].value / depth if "discharge" in known and depth > 0 else None


def _level(s: CrossSection, wanted: Record, key: str, depth: float, level: float) -> Iterator[Finding]:
    """The level outside stays between floor and lid, and begins at that of the water beside the side."""
    low, high, top = float(wanted.value.min()), float(wanted.value.max()), s.case.domain.size[-1]
    if high >= top or low <= level - depth:
        text = (
            f": a level from {low:g} to {high:g} m; it must lie between the floor, {level - depth:g} m, and the lid, "
        )
        yield Finding("error", key, f"{text}{top:g} m")
    elif abs(wanted.at(0.0) - level) > STEP * depth:
        text = f": the level begins at {wanted.at(0.0):g} m, that of the water beside it is {level:g} m: this makes a "
        text += "wave; begin at the same level"
        yield Finding("warning", key, text)


def _start(s: CrossSection, table: Open, speed: float, key: str) -> Iterator[Finding]:
    """A side without a ramp begins with the velocity of the water inside."""
    case = s.case
    moving = [w.velocity[0] for w in case.water if w.velocity is not None]
    inside = (moving[0] if moving else 0.0) * (1.0 if table.side == "left" else -1.0)
    if abs(speed - inside) > 1e-3 + 0.1 * abs(speed):
        text = (
            f": {speed:.3g} m/s come in at once, the water inside moves at {inside:.3g} m/s: a jolt; give ramp = "
            f"{case.time.end / 10:.2g} or more, or water.velocity"
        )
        yield Finding("warning", key, text)


def _balance(s: CrossSection, known: list[dict[str, Record]]) -> Iterator[Finding]:
    """Inflow and outflow balance if no side has a level: otherwise the tank would fill or empty."""
    case = s.case
    if any("level" in k for k in known):
        return
    net = 0.0
    for table, k in zip(case.open, known, strict=True):
        depth = water_beside(s, table)[0]
        speeds = inflow(k, depth)
        if speeds is None:
            return  # there is no water, which `_side` reports
        time = next(iter(k.values())).time
        t = np.linspace(0.0, case.time.end, 1001)
        net += float(np.trapezoid(np.interp(t, time, speeds), t)) * depth
    water = max(s.open_water(y).area for y in s.layers)  # [m2]
    if abs(net) <= FILLED * water:
        return
    what = "more" if net > 0 else "less"
    rise = net / case.domain.size[0]
    level = "error" if s.depth() + rise > case.domain.size[-1] or -net > 0.9 * water else "warning"
    text = (
        f": no side has a level, and {abs(net):.3g} m2 {what} come in than go out until {case.time.end:g} s, "
        f"{1e3 * abs(rise):.0f} mm of level: give a level to one side"
    )
    yield Finding(level, "open", text)  # type: ignore[arg-type]


def _current(s: CrossSection, known: list[dict[str, Record]]) -> Iterator[Finding]:
    """waves.current is the velocity of the flow through the open sides."""
    case = s.case
    if case.waves is None:
        return
    stated, flows = case.waves.current, []
    for table, k in zip(case.open, known, strict=True):
        speeds = inflow(k, water_beside(s, table)[0])
        if speeds is not None:
            flows.append(float(speeds[-1]) * (1.0 if table.side == "left" else -1.0))
    if stated and not case.open and not case.domain.periodic[0]:
        text = f"= {stated:g} m/s, but the tank is closed: give [[open]] sides that let it in and out"
        yield Finding("error", "waves.current", text)
    elif flows and abs(stated - flows[0]) > 1e-3 + 0.02 * abs(flows[0]):
        text = f"= {stated:g} m/s, but {flows[0]:.3g} m/s come in: they are the same water, current = {flows[0]:.3g}"
        yield Finding("warning", "waves.current", text)


# ---- moving walls ----------------------------------------------------------------------------------------------------


def moving_walls_fit(s: CrossSection) -> Iterator[Finding]:
    """Each moving wall has room to move, clear water in front of it, and nothing behind it that needs water."""
    case = s.case
    if not case.absorber and (case.waves is None or case.waves.piston is None):
        return
    try:
        wave = case.wave
        walls = moving_walls(case, wave, s.depth())
    except CaseError as error:
        if str(error).startswith(("waves.piston", "waves.direction")):  # waves_fit reports others
            yield Finding("error", "waves.piston", f": {error}")
        return
    yield from _alone(s, walls)
    for wall in walls:
        yield from _beside(s, wall, wave)
    yield from _periods(s)
    for wall in walls:
        found = list(_space(s, wall))
        yield from found
        if not found:
            yield from _clear(s, wall)
            yield from _seen(s, wall)


def _alone(s: CrossSection, walls: list[MovingWall]) -> Iterator[Finding]:
    """At most one wall stands at each end, and the case has nothing that moving walls do not allow."""
    case = s.case
    for water, end in ((1, "left"), (-1, "right")):
        those = [wall for wall in walls if wall.water == water]
        if len(those) > 1:
            text = f"and {those[0].key} both close the water at its {end} end: remove one"
            if those[0].key == "waves.piston":
                text += "; waves.piston = {absorb = true} makes waves and absorbs"
            yield Finding("error", those[1].key, text)
    key = walls[0].key
    if case.domain.periodic[0]:
        yield Finding(
            "error", key, 'is a wall across the tank, but domain.walls.x = "periodic" joins its ends: remove one'
        )
    for i, side in enumerate(case.open):
        if any((wall.water > 0) == (side.side == "left") for wall in walls):
            yield Finding("error", place(("open", i), case.__dict__), f"is behind {key}, where no water is: remove one")
    if case.waves is not None and case.waves.piston is not None and case.waves.current:
        text = f"= {case.waves.current:g} m/s: a piston lets no current through; take waves.source or waves.zone"
        yield Finding("error", "waves.current", text)
    if case.numerics.scheme == "jh2020" or case.numerics.remesh == "paper":
        yield Finding("error", key, 'needs numerics.scheme = "houle" with remesh = "conservative" or "none"')


def _beside(s: CrossSection, wall: MovingWall, wave: Wave | None) -> Iterator[Finding]:
    """No gate and no maker of waves stands where the wall moves, or behind it, where no water is."""
    case, margin = s.case, ROOM * s.grid.spacing[0]
    for i, gate in enumerate(case.gate):
        key = place(("gate", i, "x"), case.__dict__)
        end = wall.span[1] + margin if wall.water > 0 else wall.span[0] - margin
        if wall.water * (gate.x - wall.rest) <= 0.0:
            yield Finding("error", key, f"= {gate.x:g} m is behind {wall.key}, where no water is: remove one")
        elif wall.water * (gate.x - end) < 0.0:
            text = f"= {gate.x:g} m: {wall.key} moves between {wall.span[0]:.3g} and {wall.span[1]:.3g} m and needs "
            text += f"{ROOM} cells, {margin:.3g} m, before it for the mirror images of the water: x = "
            yield Finding("error", key, text + f"{end + wall.water * s.grid.spacing[0]:.4g}, or move the wall")
    if case.waves is None or case.waves.piston is not None or wave is None:
        return
    low, high = reach(case, wave)
    if (wall.span[1] > low) if wall.water > 0 else (wall.span[0] < high):
        key = "waves.zone" if case.waves.zone is not None else "waves.source"
        text = f"makes waves from x = {low:.3g} to {high:.3g} m, but {wall.key} moves between {wall.span[0]:.3g} and "
        yield Finding("error", key, text + f"{wall.span[1]:.3g} m, and no water is behind it: move one of them")


def _periods(s: CrossSection) -> Iterator[Finding]:
    """Each absorber is tuned to waves that the grid can carry."""
    depth, h = s.depth(), s.grid.spacing[0]
    for i, table in enumerate(s.case.absorber):
        if table.period is None or depth <= 0:
            continue
        length = 2 * pi / float(wave_number(2 * pi / table.period, depth, s.case.fluid.gravity))
        if length < 2 * h:
            text = f"= {table.period:g} s: waves of {length:.2g} m, less than two cells of {h:.3g} m; give that of "
            yield Finding("error", f"{place(('absorber', i), s.case.__dict__)}.period", f"{text}the waves that come")


def _space(s: CrossSection, wall: MovingWall) -> Iterator[Finding]:
    """The wall stays in the tank, at least `ROOM` cells away from its sides, wherever it moves."""
    size, h = s.case.domain.size[0], s.grid.spacing[0]
    low, high = wall.span
    margin = ROOM * h
    if not 0 < wall.rest < size:
        text = f"= {wall.rest:g} lies outside the domain, 0 < x < {size:g} m.{metres(wall.rest, size)}"
        yield Finding("error", f"{wall.key}.x", text)
    elif low < margin:
        text = (
            f"= {wall.rest:g} m: it goes {wall.rest - low:.3g} m to the left and needs {ROOM} cells, {margin:.3g} m, "
            f"more before the side at x = 0: x = {wall.rest - low + margin + h:.3g}, and the flume further right"
        )
        yield Finding("error", f"{wall.key}.x", text)
    elif high > size - margin:
        text = (
            f"= {wall.rest:g} m: it goes {high - wall.rest:.3g} m to the right and needs {ROOM} cells, {margin:.3g} m, "
            f"more before the side at x = {size:g}: x = {size - (high - wall.rest) - margin - h:.4g}, or longer"
        )
        yield Finding("error", f"{wall.key}.x", text)


def _clear(s: CrossSection, wall: MovingWall) -> Iterator[Finding]:
    """No structure and no sponge stands where the wall moves or close in front of it, and water does."""
    low, high = wall.span
    front = FRONT * s.grid.spacing[0]
    low, high = (low, high + front) if wall.water > 0 else (low - front, high)
    window = shapely.box(low, 0.0, high, s.window[3])
    for body in (*s.porous, *s.solid):
        for layer in s.layers:
            common = shapely.intersection(s.area([body], layer), window)
            if common.area > s.speck:
                x0, x1 = common.bounds[0], common.bounds[2]
                text = (
                    f"stands in the way of {wall.key}, x {x0:.3g} to {x1:.3g} m: that moves between {wall.span[0]:.3g} "
                    f"and {wall.span[1]:.3g} m and needs {front:.3g} m of clear water before it; move one of them"
                )
                yield Finding("error", body.key, text)
                break
    for i, sponge in enumerate(s.case.sponge):
        if sponge.box[0][0] < high and sponge.box[1][0] > low:
            key = place(("sponge", i), s.case.__dict__)
            yield Finding("error", key, f"lies where {wall.key} moves, x {low:.3g} to {high:.3g} m: remove it")
    beside = wall.rest + wall.water * 0.5 * s.grid.spacing[0]
    standing = s.standing(np.array([beside]))[0]
    if standing.min() <= 0.0:
        yield Finding("error", f"{wall.key}.x", f"= {wall.rest:g} m: there is no water in front of it; move it")


def _seen(s: CrossSection, wall: MovingWall) -> Iterator[Finding]:
    """Gauges, sensors and forces lie in the water in front of a moving wall at all times."""
    low, high = wall.span
    places = [("gauge", i, g.x) for i, g in enumerate(s.case.gauge)]
    places += [("sensor", i, p.at[0]) for i, p in enumerate(s.case.sensor)]
    for key, i, x in places:
        if (x < high) if wall.water > 0 else (x > low):
            name = place((key, i), s.case.__dict__)
            side = "behind" if wall.water * (x - wall.rest) < 0 else "in the way of"
            text = f"= {x:g} m is {side} {wall.key}, which moves from {low:.3g} to {high:.3g} m: move it into the water"
            yield Finding("warning", f"{name}.{'x' if key == 'gauge' else 'at'}", text)
    for i, force in enumerate(s.case.force):
        if force.side == ("left" if wall.water > 0 else "right"):
            key = place(("force", i), s.case.__dict__)
            yield Finding("warning", f"{key}.side", f'= "{force.side}" is a dry wall behind {wall.key}: its force is 0')
