"""What is observed during a run: [[gauge]] [[sensor]] [[runup]] [[overtopping]] [[force]] [[phreatic]] [[flux]]."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from houle.case.tables.base import Name, Point, Point2, Table


class Gauge(Table):
    """[[gauge]]: level of the free surface in a column, NaN when dry."""

    name: Name = Field(default="", description="name in the results; G1, G2, ... when left out")
    x: float = Field(description="position [m]")
    y: float | None = Field(default=None, description="position, 3D only [m]")


class Sensor(Table):
    """[[sensor]]: pressure and Darcy velocity at a point."""

    name: Name = Field(default="", description="name in the results; P1, P2, ... when left out")
    at: Point = Field(description="position [x, z], 3D [x, y, z] [m]")


class RunUp(Table):
    """[[runup]]: where the water ends on a slope or at a wall."""

    name: Name = Field(default="", description="name in the results; R1, R2, ... when left out")
    x: Point2 = Field(description="range, from a place always in the water to the crest or the wall [m]")
    threshold: float | None = Field(
        default=None, gt=0, description="water thinner than this is not counted, half a spacing when left out [m]"
    )


class Overtopping(Table):
    """[[overtopping]]: water that comes over a crest."""

    name: Name = Field(default="", description="name in the results; O1, O2, ... when left out")
    x: float = Field(description="position of the crest [m]")
    level: float | None = Field(
        default=None, ge=0, description="what passes below it is not counted; when left out, all is [m]"
    )
    to: Literal["left", "right"] = Field(default="right", description="the side behind the crest")


class Force(Table):
    """[[force]]: force and moment of the water on a solid, a porous body, or a side of the tank."""

    name: Name = Field(default="", description="name in the results; F1, F2, ... when left out")
    body: str | None = Field(default=None, description="name of a [[solid]] or [[porous]]")
    side: Literal["left", "right", "front", "back", "bottom", "top"] | None = Field(
        default=None, description="side of the tank, instead of a body"
    )
    about: Point | None = Field(
        default=None, description="point of the moments; middle of the base or foot of the wall when left out [m]"
    )

    @model_validator(mode="after")
    def one_thing(self) -> Force:
        if (self.body is None) == (self.side is None):
            given = "both body and side are given" if self.body else "neither body nor side is given"
            raise ValueError(f': {given}; give body = "name of a solid or porous body", or side = "right", ...')
        return self


class Phreatic(Table):
    """[[phreatic]]: level of the water in the pores of a body."""

    name: Name = Field(default="", description="name in the results; L1, L2, ... when left out")
    body: str = Field(description="name of a [[porous]]")
    x: Annotated[tuple[float, ...], Field(strict=False, min_length=1)] | None = Field(
        default=None, description="positions; every column of the grid in the body when left out [m]"
    )
    y: float | None = Field(default=None, description="position, 3D only [m]")


class Flux(Table):
    """[[flux]]: discharge through an upright section."""

    name: Name = Field(default="", description="name in the results; Q1, Q2, ... when left out")
    x: float = Field(description="position [m]")
    between: Point2 | None = Field(default=None, description="two levels, floor and lid when left out [m]")
