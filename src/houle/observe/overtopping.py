"""[[overtopping]]: water that comes over a crest, its volume since the start and its rate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from houle.fields import Field, Stations
from houle.flow.crest import Crest
from houle.flow.observer import Instrument, Now, Observer, Remark, Sample, Site, outside
from houle.flow.state import Flow
from houle.grid import FloatArray


@dataclass(frozen=True)
class Overtopping(Instrument):
    """A crest at x [m].

    level  water that passes below it is not counted [m]; None: all is counted
    to     the side behind the crest, "left" or "right"
    """

    name: str
    x: float
    level: float | None = None
    to: str = "right"

    def check(self, site: Site) -> Iterator[Remark]:
        """The crest stands in the tank, has a side behind it, and keeps clear of open sides."""
        yield from outside(site, "x", self.x, 0)
        if site.grid.periodic[0]:
            text = 'cannot tell the side behind the crest where walls = {x = "periodic"}: observe a [[flux]]'
            yield Remark("error", "", text)
        h = site.grid.spacing[0]
        for side in site.open:
            if abs(self.x - (site.grid.size[0] if side == "right" else 0.0)) < h:
                text = f"= {self.x:g} lies within a spacing of {h:.3g} m of the open side {side!r}, where water comes "
                yield Remark("error", "x", text + "and goes: move it inwards")
        if self.level is not None:
            yield from outside(site, "level", self.level, site.grid.dimension - 1)

    @property
    def highest(self) -> float:
        return self.level or 0.0


class Overtoppings(Observer[Overtopping]):
    """Volume [m^d] of water that has crossed each crest since the start, and its rate in the last step.

    The flow books what crosses where it moves particles (`houle.flow.crest`).
    """

    table = "overtopping"
    instrument = Overtopping
    fields = (
        Field(
            "overtopping_volume",
            "V_o",
            "m3",
            "overtopping",
            "volume of water that has come over the crest above the level given, since the start of the run",
            unit_2d="m2",
        ),
        Field(
            "overtopping_discharge",
            "q_o",
            "m3 s-1",
            "overtopping",
            "discharge of water over the crest: the change of overtopping_volume in a time step, over its length",
            unit_2d="m2 s-1",
            instant="middle",
        ),
    )

    def __init__(self, instruments: Sequence[Overtopping], site: Site, flow: Flow) -> None:
        self.crests = [Crest(flow.grid, flow.medium, one.x, one.level, one.to == "right") for one in instruments]
        self.volume, self.discharge = np.zeros((2, len(self.crests)))
        flow.crests.extend(self.crests)

    @classmethod
    def stations(cls, instruments: Sequence[Overtopping], site: Site) -> Stations:
        places = {
            "x": ("position of the crest along x", [one.x for one in instruments]),
            "level": ("level at the crest below which water is not counted", [one.level or 0.0 for one in instruments]),
        }
        return Stations([one.name for one in instruments], places, cls.fields)

    def sample(self, now: Now) -> Sample:
        return {"overtopping_volume": self.volume, "overtopping_discharge": self.discharge}

    def after_step(self, dt: float) -> None:
        before, self.volume = self.volume, np.array([crest.passed for crest in self.crests])
        self.discharge = (self.volume - before) / dt

    def state(self) -> dict[str, FloatArray]:
        return {"volume": self.volume, "discharge": self.discharge}

    def restore(self, state: Mapping[str, FloatArray]) -> None:
        self.volume, self.discharge = np.array(state["volume"]), np.array(state["discharge"])
        for crest, passed in zip(self.crests, self.volume, strict=True):
            crest.passed = float(passed)
