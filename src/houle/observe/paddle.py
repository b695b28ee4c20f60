"""Positions of the moving walls of a case: the piston that makes waves, and walls that absorb them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from houle.fields import Field, Stations
from houle.flow.observer import Instrument, Now, Observer, Sample, Site
from houle.flow.state import Flow


@dataclass(frozen=True)
class MovingWall(Instrument):
    """The moving wall of this name, which stands at x = rest [m] before it moves."""

    name: str
    rest: float


class PaddlePositions(Observer[MovingWall]):
    """Positions of the moving walls of a flow, all of them."""

    instrument = MovingWall
    fields = (Field("paddle_position", "X", "m", "paddle", "position of the moving wall along x"),)

    def __init__(self, instruments: Sequence[MovingWall], site: Site, flow: Flow) -> None:
        """Nothing is placed: the flow has its moving walls in the order of the case."""

    @classmethod
    def stations(cls, instruments: Sequence[MovingWall], site: Site) -> Stations:
        rest = {"rest": ("position of the moving wall at rest", [wall.rest for wall in instruments])}
        return Stations([wall.name for wall in instruments], rest, cls.fields)

    def sample(self, now: Now) -> Sample:
        walls = now.flow.boundaries.walls
        return {} if walls is None else {"paddle_position": walls[:, 0].copy()}
