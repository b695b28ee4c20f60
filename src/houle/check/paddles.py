"""Pre-flight of moving walls, waves.piston and [[absorber]]: have they room, and water in front of them alone?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
import shapely

from houle.boundary.paddle import ROOM
from houle.case.build import law_of_piston
from houle.case.messages import metres, place
from houle.case.model import Case
from houle.check.section import Finding, Section
from houle.check.waves import columns
from houle.errors import CaseError
from houle.waves.dispersion import wave_number
from houle.waves.wave import Wave

GIVES = (
    0.5  # of the way that a wave itself moves the water to and fro: an absorbing wall is taken to need this and more
)
FRONT = 6  # cells in front of a moving wall where nothing else may stand


@dataclass(frozen=True)
class MovingWall:
    """key in the case file, place at rest [m], side of the water, furthest way to the left and the right [m]."""

    key: str
    rest: float
    water: int
    way: tuple[float, float]

    @property
    def span(self) -> tuple[float, float]:
        """Between which it moves [m]."""
        return self.rest + self.way[0], self.rest + self.way[1]


def moving_walls(case: Case, wave: Wave | None, depth: float) -> list[MovingWall]:
    """Those of a case; depth: of still water [m]. Raises CaseError for waves that a piston cannot make."""
    found = []
    if case.waves is not None and case.waves.piston is not None and wave is not None:
        law, _, rest = law_of_piston(case, wave)
        low, high = law.reach
        more = GIVES * (high - low) / 2 if case.waves.piston.absorb else 0.0
        found.append(MovingWall("waves.piston", rest, 1, (low - more, high + more)))
    for i, table in enumerate(case.absorber):
        water = 1 if table.side == "left" else -1
        to, fro = _yields(wave, depth)
        way = (-to, fro) if water > 0 else (-fro, to)
        found.append(
            MovingWall(place(("absorber", i), case.__dict__), case.domain.grid.nearest_face(table.x), water, way)
        )
    return found


def _yields(wave: Wave | None, depth: float) -> tuple[float, float]:
    """How far a wall that absorbs gives way and comes forward [m]: with the wave; a single one pushes it on."""
    if wave is None:
        return 0.1 * depth, 0.1 * depth
    if wave.components() is None:
        return 2 * wave.height / depth * sqrt(4 * depth**3 / (3 * wave.height)), 0.1 * depth
    swing = wave.crest / (wave.k * depth) if wave.k * depth < 1 else wave.crest
    return 1.5 * swing, 1.5 * swing


def paddles_fit(s: Section) -> Iterator[Finding]:
    """Each moving wall has room behind it, clear water in front, and a tank that it can divide."""
    case = s.case
    if not case.absorber and (case.waves is None or case.waves.piston is None):
        return
    try:
        wave = case.wave
        walls = moving_walls(case, wave, s.depth())
    except CaseError as error:
        if str(error).startswith(("waves.piston", "waves.direction")):  # else told by waves_fit
            yield Finding("error", "waves.piston", f": {error}")
        return
    yield from _alone(s, walls)
    yield from _periods(s)
    for wall in walls:
        found = list(_room(s, wall))
        yield from found
        if not found:
            yield from _clear(s, wall)
            yield from _seen(s, wall)


def _alone(s: Section, walls: list[MovingWall]) -> Iterator[Finding]:
    """One at each end at most, nothing that they cannot stand beside."""
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
    if case.gate:
        yield Finding("error", key, "and a [[gate]] cannot stand in one tank: remove one")
    if case.numerics.scheme == "jh2020" or case.numerics.remesh == "paper":
        yield Finding("error", key, 'needs numerics.scheme = "houle" with remesh = "conservative" or "none"')


def _periods(s: Section) -> Iterator[Finding]:
    """An absorber is tuned to waves that the grid carries."""
    depth, h = s.depth(), s.grid.spacing[0]
    for i, table in enumerate(s.case.absorber):
        if table.period is None or depth <= 0:
            continue
        length = 2 * pi / float(wave_number(2 * pi / table.period, depth, s.case.fluid.gravity))
        if length < 2 * h:
            text = f"= {table.period:g} s: waves of {length:.2g} m, less than two cells of {h:.3g} m; give that of "
            yield Finding("error", f"{place(('absorber', i), s.case.__dict__)}.period", f"{text}the waves that come")


def _room(s: Section, wall: MovingWall) -> Iterator[Finding]:
    """It stays in the tank, a few cells away from its sides, and never meets another one."""
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


def _clear(s: Section, wall: MovingWall) -> Iterator[Finding]:
    """No structure where it moves or right in front of it; behind it nothing matters."""
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
    standing = columns(s, np.array([beside]))[0]
    if standing.min() <= 0.0:
        yield Finding("error", f"{wall.key}.x", f"= {wall.rest:g} m: there is no water in front of it; move it")


def _seen(s: Section, wall: MovingWall) -> Iterator[Finding]:
    """What is observed stands in the water at all times."""
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
