"""The observables of a run: [[gauge]] [[sensor]] [[runup]] [[overtopping]] [[force]] [[phreatic]] [[flux]]
[[bank]] [[armour]].

`Observed` lists the tables. An observer in `houle.observe` names the table that asks for it, and its instruments have
the same keys. `disagreements` of a table checks it against the rest of the case file; the instrument itself checks the
place where it stands.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, ClassVar, Literal, get_args

from pydantic import Field, model_validator

from houle.case.messages import nearest
from houle.case.tables.base import Name, Point, Point2, Table

Bodies = Mapping[str, tuple[str, ...]]  # "porous" or "solid" -> names of these bodies


class Row(Table):
    """Base of the tables of observables. prefix: beginning of the names of tables that give none."""

    prefix: ClassVar[str]

    name: Name = ""

    def disagreements(self, dimension: int, bodies: Bodies) -> Iterator[tuple[str, str]]:
        """Contradictions to the rest of the case: pairs of key, "" for the whole table, and text with the cure."""
        yield from ()


class Gauge(Row):
    """[[gauge]]: level of the free surface in a column, NaN when dry."""

    prefix = "G"

    name: Name = Field(default="", description="name in the results; G1, G2, ... when left out")
    x: float = Field(description="position [m]")
    y: float | None = Field(default=None, description="position, 3D only [m]")

    def disagreements(self, dimension: int, bodies: Bodies) -> Iterator[tuple[str, str]]:
        return _in_3d_only(self.y, dimension)


class Sensor(Row):
    """[[sensor]]: pressure and Darcy velocity at a point."""

    prefix = "P"

    name: Name = Field(default="", description="name in the results; P1, P2, ... when left out")
    at: Point = Field(description="position [x, z], 3D [x, y, z] [m]")

    def disagreements(self, dimension: int, bodies: Bodies) -> Iterator[tuple[str, str]]:
        return _as_many_numbers("at", self.at, dimension)


class RunUp(Row):
    """[[runup]]: the end of the connected water on a slope or at a wall."""

    prefix = "R"

    name: Name = Field(default="", description="name in the results; R1, R2, ... when left out")
    x: Point2 = Field(description="range, from a place always in the water to the crest or the wall [m]")
    threshold: float | None = Field(
        default=None, gt=0, description="water thinner than this is not counted, half a spacing when left out [m]"
    )


class Overtopping(Row):
    """[[overtopping]]: volume of water that comes over a crest."""

    prefix = "O"

    name: Name = Field(default="", description="name in the results; O1, O2, ... when left out")
    x: float = Field(description="position of the crest [m]")
    level: float | None = Field(
        default=None, ge=0, description="what passes below it is not counted; when left out, all is [m]"
    )
    to: Literal["left", "right"] = Field(default="right", description="the side behind the crest")


class Force(Row):
    """[[force]]: force and moment of the water on a solid, a porous body, or a side of the tank."""

    prefix = "F"

    name: Name = Field(default="", description="name in the results; F1, F2, ... when left out")
    body: str | None = Field(default=None, description="name of a [[solid]] or [[porous]]")
    side: Literal["left", "right", "front", "back", "bottom", "top"] | None = Field(
        default=None, description="side of the tank, instead of a body"
    )
    about: Point | None = Field(
        default=None, description="point of the moments; middle of the base or foot of the wall when left out [m]"
    )
    weight: float | None = Field(
        default=None,
        gt=0,
        description="weight of the structure in air, for its safety against sliding and tilting [N/m], 3D [N]",
    )
    friction: float | None = Field(
        default=None, gt=0, le=2, description="friction between its base and the ground, for the safety [-]"
    )
    heel: Point2 | None = Field(
        default=None,
        description="point [x, z] about which it would tilt; landward corner of its base when left out [m]",
    )

    @model_validator(mode="after")
    def one_thing(self) -> Force:
        if (self.body is None) == (self.side is None):
            given = "both body and side are given" if self.body else "neither body nor side is given"
            raise ValueError(f': {given}; give body = "name of a solid or porous body", or side = "right", ...')
        return self

    def disagreements(self, dimension: int, bodies: Bodies) -> Iterator[tuple[str, str]]:
        yield from _as_many_numbers("about", self.about, dimension)
        if dimension == 2 and self.side in ("front", "back"):
            yield "side", f'= "{self.side}" exists in 3D only; this domain has two sizes'
        yield from _named(self.body, bodies, "porous", "solid")
        for key in ("weight", "friction", "heel"):
            if getattr(self, key) is not None and self.body not in bodies["solid"]:
                yield key, "belongs to a body = ... that is a [[solid]]: remove it"
        if self.friction is not None and self.weight is None:
            yield "weight", f"is missing: friction = {self.friction:g} holds no structure without it [N/m]"


class Phreatic(Row):
    """[[phreatic]]: level of the water in the pores of a body."""

    prefix = "L"

    name: Name = Field(default="", description="name in the results; L1, L2, ... when left out")
    body: str = Field(description="name of a [[porous]]")
    x: Annotated[tuple[float, ...], Field(strict=False, min_length=1)] | None = Field(
        default=None, description="positions; every column of the grid in the body when left out [m]"
    )
    y: float | None = Field(default=None, description="position, 3D only [m]")

    def disagreements(self, dimension: int, bodies: Bodies) -> Iterator[tuple[str, str]]:
        yield from _in_3d_only(self.y, dimension)
        yield from _named(self.body, bodies, "porous")


class Flux(Row):
    """[[flux]]: discharge through an upright section."""

    prefix = "Q"

    name: Name = Field(default="", description="name in the results; Q1, Q2, ... when left out")
    x: float = Field(description="position [m]")
    between: Point2 | None = Field(default=None, description="two levels, floor and lid when left out [m]")


class Bank(Row):
    """[[bank]]: heads and velocities along the face of a porous bank, and from them whether it holds."""

    prefix = "bank-"

    name: Name = Field(default="", description="name in the results; bank-1, bank-2, ... when left out")
    body: str = Field(description="name of a [[porous]]")
    x: Point2 = Field(description="stretch of its face, from, to [m]")
    points: int = Field(default=8, ge=2, le=1000, description="number of places along the stretch")
    depth: float = Field(
        gt=0, le=100, description="depth below the face, along its normal, of the plane on which it might slide [m]"
    )
    above: float | None = Field(
        default=None,
        gt=0,
        le=100,
        description="height over the face at which the water is observed; one and a half spacings when left out [m]",
    )
    friction_angle: float = Field(gt=0, lt=90, description="angle of internal friction of the grains [degrees]")
    grain_density: float = Field(default=2650.0, gt=0, le=2e4, description="density of the grains [kg/m3]")
    y: float | None = Field(default=None, description="position, 3D only [m]")

    def disagreements(self, dimension: int, bodies: Bodies) -> Iterator[tuple[str, str]]:
        yield from _in_3d_only(self.y, dimension)
        yield from _named(self.body, bodies, "porous")
        if self.x[0] >= self.x[1]:
            yield "x", f"= [{self.x[0]:g}, {self.x[1]:g}]: the smaller x first"


class Armour(Row):
    """[[armour]]: gradients in the outer stones of an armour layer, and the water over them: indicators of its load."""

    prefix = "armour-"

    name: Name = Field(default="", description="name in the results; armour-1, armour-2, ... when left out")
    body: str = Field(description="name of a [[porous]]")
    x: Point2 | None = Field(
        default=None, description="stretch of its top, from, to; all of it when left out [m]", examples=[[6.4, 7.4]]
    )
    stone: float | None = Field(
        default=None,
        gt=0,
        le=10,
        description="nominal diameter D_n50 of the stones; 0.84 times the grain_diameter of the body when left out [m]",
    )
    stone_density: float = Field(default=2650.0, gt=0, le=2e4, description="density of the stones [kg/m3]")
    permeability: float | None = Field(
        default=None,
        ge=0.1,
        le=0.6,
        description="notional permeability P of Van der Meer; when left out by what is under the armour",
    )
    y: float | None = Field(default=None, description="position, 3D only [m]")

    def disagreements(self, dimension: int, bodies: Bodies) -> Iterator[tuple[str, str]]:
        yield from _in_3d_only(self.y, dimension)
        yield from _named(self.body, bodies, "porous")
        if self.x is not None and self.x[0] >= self.x[1]:
            yield "x", f"= [{self.x[0]:g}, {self.x[1]:g}]: the smaller x first"


class Observed(Table):
    """The tables of observables of a case, in the order in which they are sampled."""

    gauge: Annotated[tuple[Gauge, ...], Field(strict=False, description="free surface gauges")] = ()
    sensor: Annotated[tuple[Sensor, ...], Field(strict=False, description="pressure and velocity sensors")] = ()
    runup: Annotated[tuple[RunUp, ...], Field(strict=False, description="run-up on slopes and walls")] = ()
    overtopping: Annotated[tuple[Overtopping, ...], Field(strict=False, description="water over crests")] = ()
    force: Annotated[tuple[Force, ...], Field(strict=False, description="forces on structures")] = ()
    phreatic: Annotated[tuple[Phreatic, ...], Field(strict=False, description="levels inside structures")] = ()
    flux: Annotated[tuple[Flux, ...], Field(strict=False, description="discharge through sections")] = ()
    bank: Annotated[tuple[Bank, ...], Field(strict=False, description="stability of the faces of banks")] = ()
    armour: Annotated[tuple[Armour, ...], Field(strict=False, description="loads on the stones of armour layers")] = ()

    @classmethod
    def observed(cls) -> dict[str, type[Row]]:
        """The tables by their keys in the case file."""
        kinds = {key: (*get_args(info.annotation), None)[0] for key, info in cls.model_fields.items()}
        return {key: kind for key, kind in kinds.items() if isinstance(kind, type) and issubclass(kind, Row)}


def _in_3d_only(y: float | None, dimension: int) -> Iterator[tuple[str, str]]:
    if (y is None) == (dimension == 3):
        yield "y", f"is {'missing in 3D: add y [m]' if dimension == 3 else 'given in 2D: remove it'}"


def _as_many_numbers(key: str, point: tuple[float, ...] | None, dimension: int) -> Iterator[tuple[str, str]]:
    if point is not None and len(point) != dimension:
        yield key, f"has {len(point)} numbers, domain.size has {dimension}: give {dimension}"


def _named(body: str | None, bodies: Bodies, *kinds: str) -> Iterator[tuple[str, str]]:
    """An error if not exactly one body of these kinds has this name."""
    names = [name for kind in kinds for name in bodies[kind]]
    if body is None or names.count(body) == 1:
        return
    if body in names:
        yield "body", f'= "{body}" is the name of a porous body and of a solid: rename one of them'
        return
    what = "porous body or solid" if "solid" in kinds else "porous body"
    there = f" There are: {', '.join(names)}" if names else f" The case has no {what}"
    yield "body", f'= "{body}" is the name of no {what}.{nearest(body, names)}{there}'
