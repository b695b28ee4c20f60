"""Parts of the flume in which a case acts on the water: makers of waves, sponges, moving walls and their reach."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

from houle.boundary.internal_source import ACTS, Source, source_width
from houle.case.messages import place
from houle.case.model import Case
from houle.case.tables.waves import Piston, Waves, Zone
from houle.waves.paddle import PaddleWave
from houle.waves.piston import Law, Reading, law_of, reading_of
from houle.waves.second_order import SecondOrder
from houle.waves.second_piston import pair_motion
from houle.waves.second_source import half_reach
from houle.waves.wave import Wave

NEARBY = 3.0  # depths in front of a piston over which the depth has to be even
GIVES = 0.5  # share of half its stroke that an absorbing piston is expected to move further to each side

Reach = tuple[float, float]  # least and largest x [m]


def law_of_piston(case: Case, wave: Wave) -> tuple[Law, Reading, float]:
    """The law by which the piston of a case moves, its reading of the pressure, and its place at rest [m].

    Raises CaseError for waves that a piston cannot make.
    """
    waves = case.waves
    assert waves is not None and waves.piston is not None
    rest = case.domain.grid.nearest_face(waves.piston.x)
    read = reading_of(wave, wave.depth, wave.gravity)
    if isinstance(wave, PaddleWave):
        return wave.motion, read, rest
    if isinstance(wave, SecondOrder):
        return pair_motion(wave, rest, read, waves.ramp_time(), waves.piston.absorb), read, rest
    return law_of(wave, rest, read, waves.ramp_time(), regular=waves.kind == "regular"), read, rest


def source_of(table: Waves, wave: Wave) -> Source:
    """The source of [waves], with its width even where the case gives none."""
    given = table.source
    assert given is not None
    return Source(given.x, source_width(given.width, table.kind, wave), given.form, given.side)


def reach(case: Case, wave: Wave) -> Reach:
    """Ends of the interval along x in which the maker of waves acts [m]; for a piston, that in front of it."""
    assert case.waves is not None
    maker = case.waves.maker
    if isinstance(maker, Zone):
        return maker.x
    if isinstance(maker, Piston):
        return maker.x, maker.x + NEARBY * wave.depth
    width = source_of(case.waves, wave).width
    half = half_reach(width, wave.depth) if isinstance(wave, SecondOrder) else ACTS * width
    return maker.x - half, maker.x + half


@dataclass(frozen=True)
class MovingWall:
    """A piston or an absorbing wall, and the space that it needs along x.

    key    its key in the case file
    rest   its place at rest [m]
    water  side of the water: 1 for the right, -1 for the left
    way    furthest displacements that are expected, to the left (negative) and to the right [m]
    """

    key: str
    rest: float
    water: int
    way: tuple[float, float]

    @property
    def span(self) -> tuple[float, float]:
        """Leftmost and rightmost place of the wall [m]."""
        return self.rest + self.way[0], self.rest + self.way[1]


def moving_walls(case: Case, wave: Wave | None, depth: float) -> list[MovingWall]:
    """The pistons and absorbing walls of a case in still water of this depth [m].

    Raises CaseError for waves that a piston cannot make.
    """
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
    """Expected distances by which an absorbing wall gives way and comes forward [m]; a single wave pushes it away."""
    if wave is None:
        return 0.1 * depth, 0.1 * depth
    if wave.components() is None:
        return 2 * wave.height / depth * sqrt(4 * depth**3 / (3 * wave.height)), 0.1 * depth
    swing = wave.crest / (wave.k * depth) if wave.k * depth < 1 else wave.crest
    return 1.5 * swing, 1.5 * swing


@dataclass(frozen=True)
class Band:
    """A part of the flume, between two places x [m], where something acts: its name, and its hatch in pictures."""

    low: float
    high: float
    words: str
    hatch: str


def acting(case: Case, depth: float, y: float) -> list[Band]:
    """Bands along x where a case acts on still water of this depth [m]: relaxation zone or source, sponges, reach of
    moving walls. In 3D the sponges that reach over this y [m] count.
    """
    found = [
        Band(low[0], high[0], sponge.name, "//")
        for sponge in case.sponge
        for low, high in (sponge.box,)
        if len(low) == 2 or low[1] <= y <= high[1]
    ]
    wave = case.wave
    found += [Band(*wall.span, wall.key.rpartition(".")[2], "|||") for wall in moving_walls(case, wave, depth)]
    if case.waves is not None and case.waves.piston is None and wave is not None:
        words, hatch = ("source", "") if case.waves.source is not None else ("zone", "\\\\")
        found.append(Band(*reach(case, wave), f"{words}, {case.waves.kind}", hatch))
    return found


def walls_at_rest(case: Case) -> dict[str, float]:
    """Places of the moving walls of a case at rest [m], by the end of the water that each closes."""
    found: dict[str, float] = {a.side: case.domain.grid.nearest_face(a.x) for a in case.absorber}
    if case.waves is not None and case.waves.piston is not None:
        found["left"] = case.domain.grid.nearest_face(case.waves.piston.x)
    return found
