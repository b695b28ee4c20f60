"""Observers: the protocol of everything that is measured in a run, from gauges to the ledger of energy.

    Site          the tank, as far as instruments need to know it
    Instrument    one instrument as the case gives it: its name and its place
    Instruments   all instruments of one kind, not yet placed in a flow
    Observer      the same instruments placed in a flow: takes a sample in each step
    Stations      names and coordinates of the values of an observer in series.nc
    Now           the flow and the ledger, of which a sample is taken
    Remark        a finding of `houle check` about where an instrument stands

An observable is one file in `houle.observe`. It holds an `Instrument`, with the keys of its table in the case file (a
user of the library can make one by hand) and its check; and the `Observer` of such instruments, with the name of the
table, its rows of `houle.fields`, its stations and its sample. The table stands in `houle.case.tables.observed`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Generic, Literal, NamedTuple, TypeVar

import numpy as np

from houle.errors import metres
from houle.fields import Field, Stations
from houle.flow.component import Component
from houle.flow.ledger import Ledger
from houle.flow.state import Flow
from houle.grid import FloatArray, Grid, axes
from houle.medium.shapes import Shape

Sample = dict[str, FloatArray | float]


@dataclass(frozen=True)
class Site:
    """The tank as far as instruments ask for it; `houle check` has one before there is a flow.

    size      of the tank [m], the last one upwards
    grid      of the whole tank, which is that of the results: a flow keeps its lowest rows
    density   of the water [kg/m3]
    porous    shapes of the porous bodies by name
    solid     shapes of the solids by name, in the order of the case
    grains    grain diameter of those porous bodies that have one [m]
    open      sides of the tank through which water comes and goes, "left" or "right"
    """

    size: tuple[float, ...]
    grid: Grid
    density: float = 1000.0
    porous: Mapping[str, Shape] = field(default_factory=dict)
    solid: Mapping[str, Shape] = field(default_factory=dict)
    grains: Mapping[str, float] = field(default_factory=dict)
    open: tuple[str, ...] = ()


class Remark(NamedTuple):
    """A finding about one instrument: its level, the key of its table, and the two numbers and the cure in words."""

    level: Literal["error", "warning", "info"]
    key: str
    text: str


class Instrument:
    """One instrument as the case gives it; a frozen dataclass with the keys of its table."""

    def check(self, site: Site) -> Iterator[Remark]:
        """Remarks on what is doubtful or wrong about the place of the instrument; none by default."""
        yield from ()

    @property
    def highest(self) -> float:
        """The highest level [m] at which the instrument looks for water, whether water is there or not.

        A run starts with rows of cells up to there at least (`houle.flow.rows`); 0 asks for none.
        """
        return 0.0


@dataclass(frozen=True)
class Now:
    """The present: the flow at the end of a step, and its ledger."""

    flow: Flow
    ledger: Ledger


R = TypeVar("R", bound=Instrument)


class Observer(Component, ABC, Generic[R]):
    """All instruments of one kind, placed in a flow. R is the class of one instrument.

    What the next sample depends on besides the flow is their `state` (`houle.flow.component`).

    table       key of the case file whose tables ask for it; "" where no table does
    instrument  R
    fields      the quantities that a sample may hold; their place is the dimension of series.nc of their values, or RUN
                for one value of all the water
    """

    table: ClassVar[str] = ""
    instrument: ClassVar[type[Instrument]]
    fields: ClassVar[tuple[Field, ...]]

    @property
    def dimension(self) -> str:
        """The dimension of series.nc that the values have, or RUN."""
        return self.fields[0].place

    @abstractmethod
    def __init__(self, instruments: Sequence[R], site: Site, flow: Flow) -> None:
        """Places the instruments: everything that does not change during a run is computed here."""

    @abstractmethod
    def sample(self, now: Now) -> Sample:
        """The values now, as copies, by the names of `fields`: an array with one row per station, or one number."""

    def after_step(self, dt: float) -> None:
        """Updates what accumulates from step to step, after a step of dt [s]; nothing by default.

        The flow is the one given to `__init__`: an observer that needs it here keeps it.
        """

    @classmethod
    @abstractmethod
    def stations(cls, instruments: Sequence[R], site: Site) -> Stations:
        """Names and coordinates of the values of these instruments."""


@dataclass(frozen=True)
class Instruments:
    """All instruments of one kind that a case has, before they are placed in a flow."""

    observer: type[Observer[Any]]
    them: tuple[Instrument, ...]
    site: Site

    def place(self, flow: Flow) -> Observer[Any]:
        """The instruments in a flow of their site."""
        return self.observer(self.them, self.site, flow)

    @property
    def stations(self) -> Stations:
        """Names and coordinates of their values in series.nc."""
        return self.observer.stations(self.them, self.site)

    def check(self) -> Iterator[tuple[int, Remark]]:
        """Pairs of the number of an instrument and a remark on what is doubtful or wrong about its place."""
        for i, one in enumerate(self.them):
            for remark in one.check(self.site):
                yield i, remark

    @property
    def highest(self) -> float:
        """The highest level [m] at which one of them looks for water."""
        return max((one.highest for one in self.them), default=0.0)


def along(kind: str, what: Sequence[Sequence[float]] | FloatArray, letters: str) -> dict[str, tuple[str, list[float]]]:
    """Coordinates for `Stations`: letter -> (sentence with the kind of instrument, values [m]).

    what: points (N, len(letters)) [m], such as places of gauges.
    """
    points = np.array(what, float).reshape(-1, len(letters))
    return {axis: (f"position of the {kind} along {axis}", points[:, a].tolist()) for a, axis in enumerate(letters)}


def outside(site: Site, key: str, value: float, axis: int) -> Iterator[Remark]:
    """A remark where a coordinate [m] of an instrument lies outside the tank."""
    name, size = axes(site.grid.dimension)[axis], site.size[axis]
    if not 0 <= value <= size:
        text = f"= {value:g} lies outside the domain, 0 <= {name} <= {size:g} m.{metres(value, size)}"
        yield Remark("error", key, text)
