"""The tables of a case file together, in the order in which they are written out."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from houle.case.tables.base import Table
from houle.case.tables.boundaries import Boundaries
from houle.case.tables.control import Numerics, Output, Time
from houle.case.tables.observed import Observed
from houle.case.tables.results import Reference, Reflection
from houle.case.tables.tank import Domain, Fluid, Head, Porous, Solid, Water


class Tank(Table):
    """The tables of a case about the tank, the water and the bodies in it."""

    case: Head
    domain: Domain
    fluid: Fluid = Fluid()
    water: Annotated[
        tuple[Water, ...], Field(strict=False, min_length=1, description="where water stands at the start")
    ]
    porous: Annotated[tuple[Porous, ...], Field(strict=False, max_length=100, description="porous bodies")] = ()
    solid: Annotated[tuple[Solid, ...], Field(strict=False, description="impermeable bodies")] = ()


class Course(Table):
    """The tables of a case about the course of the run and what is made of its results."""

    time: Time
    numerics: Numerics = Numerics()
    output: Output = Output()
    reflection: Reflection | None = None
    reference: Reference | None = None


class Tables(Course, Observed, Boundaries, Tank):
    """All tables of a case file."""
