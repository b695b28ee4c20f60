"""Boundaries of the water besides its makers of waves: [[gate]] [[open]] [[sponge]] [[absorber]].

A boundary of `houle.boundary` is made from the keys of its table, by the row of the same name (`houle.registry`). To
add one, write its class and row there, and here its table and its line of `Boundaries`. Its place is checked when a run
is set up, by `Boundary.join`; `houle check` looks at it only if a function in `houle.check.boundaries` does.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from houle.case.tables.base import Name, Point, Table, is_a_box
from houle.case.tables.ship import Ship
from houle.case.tables.waves import Waves
from houle.data.csv_table import columns_in
from houle.data.files import require_file
from houle.data.history import History, Record, read_history
from houle.errors import CaseError
from houle.registry import choices

COLUMNS = {"velocity": "velocity_m_s", "discharge": "discharge_m2_s", "level": "level_m"}  # key -> column in open.file
LEAST = 2  # fewest rows in open.file


class Standing(Table):
    """Base of the tables of boundaries. prefix: beginning of the names of tables that give none; "" without names."""

    prefix: ClassVar[str] = ""

    def keys(self, folder: Path) -> dict[str, Any]:
        """The arguments of `BoundaryKind.make`: the keys of the table. Raises CaseError for a bad file in `folder`."""
        return {key: getattr(self, key) for key in type(self).model_fields}


class Gate(Standing):
    """[[gate]]: a thin plate across the tank that is lifted. It and its lower edge stand on the nearest grid lines."""

    x: float = Field(description="position [m]")
    speed: float = Field(gt=0, le=100, description="upward speed of its lower edge [m/s]")
    start: float = Field(default=0.0, ge=0, description="time at which it starts to rise [s]")


class Absorber(Standing):
    """[[absorber]]: a wall across the tank that gives way to the waves that reach it (active absorption)."""

    prefix = "absorber-"

    name: Name = Field(default="", description="name in messages and results; absorber-1, ... when left out")
    x: float = Field(gt=0, description="where it stands at rest, on the nearest face of the grid [m]")
    side: Literal["left", "right"] = Field(
        default="right", description="end of the water at which it stands; behind it is no water"
    )
    period: float | None = Field(
        default=None,
        gt=0,
        le=1e5,
        description="period of the waves that it absorbs best; that of [waves] when left out, without [waves] that of "
        "long waves [s]",
    )


class Open(Standing):
    """[[open]]: a side through which water comes and goes, at a velocity or discharge, towards a level, or both."""

    side: Literal["left", "right"] = Field(description="side of the tank; left is x = 0")
    velocity: float | None = Field(
        default=None,
        ge=-50,
        le=50,
        description="mean velocity over the depth, positive into the tank on either side [m/s]",
    )
    discharge: float | None = Field(
        default=None,
        ge=-1e4,
        le=1e4,
        description="discharge per metre of width, positive into the tank on either side [m2/s]",
    )
    level: float | None = Field(
        default=None,
        gt=0,
        le=1e4,
        description="level above z = 0 that is kept outside; long waves leave the tank [m]",
        examples=[0.25],
    )
    file: str | None = Field(
        default=None,
        description="CSV beside the case file with column t_s and one or two of velocity_m_s, discharge_m2_s, level_m",
    )
    start: float = Field(default=0.0, ge=-1e10, le=1e10, description="time in the file that is t = 0 of the run [s]")
    gap: float | None = Field(
        default=None,
        gt=0,
        description="longest time without a row in the file that a straight line may stand for; when left out, three "
        "and a half usual steps [s]",
    )
    ramp: float = Field(default=0.0, ge=0, description="time in which velocity or discharge grow from nothing [s]")
    response: float | None = Field(
        default=None,
        gt=0,
        description="time in which a level without velocity or discharge finds the flow that keeps it; four times that "
        "of a long wave through the tank when left out [s]",
    )

    @model_validator(mode="after")
    def one_way(self) -> Open:
        given = [key for key in COLUMNS if getattr(self, key) is not None]
        if self.file is not None and given:
            raise ValueError(f"file and {given[0]} are given together: keep one of them")
        if self.file is None and not given:
            raise ValueError(": nothing is given; give velocity, discharge, level, or file = a CSV with one of them")
        if "velocity" in given and "discharge" in given:
            raise ValueError("velocity and discharge are given together: keep one of them")
        if self.file is None and "level" not in given and self.response is not None:
            raise ValueError("response belongs to level: remove it")
        if self.file is None and (self.start or self.gap is not None):
            raise ValueError(f"{'start' if self.start else 'gap'} belongs to file: remove it")
        if given == ["level"] and self.ramp:
            raise ValueError("ramp belongs to velocity and discharge: remove it, or give the level as a file")
        return self

    def keys(self, folder: Path) -> dict[str, Any]:
        return {"side": self.side, "prescribed": records(self, folder), "ramp": self.ramp, "response": self.response}


def records(table: Open, folder: Path) -> dict[str, Record]:
    """The records that an open side prescribes, by the keys of COLUMNS. Raises CaseError for a bad file."""
    if table.file is None:
        constant = {key: getattr(table, key) for key in COLUMNS if getattr(table, key) is not None}
        return {key: Record(np.zeros(1), np.array([value])) for key, value in constant.items()}
    names, known = history(table, folder)
    return {name: Record(known.time, value) for name, value in zip(names, known.values, strict=True)}


def history(table: Open, folder: Path) -> tuple[list[str], History]:
    """Keys of COLUMNS in the file of an open side, and their values on the clock of the run. Raises CaseError."""
    file, key = folder / str(table.file), f"open.{table.side}.file"
    require_file(file, key)
    found = columns_in(file, tuple(COLUMNS.values()), key)
    there = {name: column for name, column in COLUMNS.items() if column in found}
    if not there or {"velocity", "discharge"} <= set(there):
        raise CaseError(
            f"{key} = {file} needs a column t_s and one of velocity_m_s, discharge_m2_s, level_m, or level_m with one "
            f"of the others; it has {', '.join(there.values()) or 'none of them'}"
        )
    return list(there), read_history(file, tuple(there.values()), key, LEAST, table.start)


class Sponge(Standing):
    """[[sponge]]: absorbs waves on their way to the side of the tank that it touches."""

    prefix = "sponge-"

    name: Name = Field(default="", description="name in messages and pictures; sponge-1, ... when left out")
    box: Annotated[tuple[Point, Point], Field(strict=False)] = Field(
        description="corners [[x, z], [x, z]]; one end at a side of the tank [m]"
    )
    strength: float | None = Field(
        default=None,
        gt=0,
        le=1e4,
        description="largest rate at which it slows the water down; when left out, 0.3 % of the waves comes back [1/s]",
    )

    @model_validator(mode="after")
    def is_a_box(self) -> Sponge:
        is_a_box(self.box)
        return self


class Boundaries(Table):
    """The tables of a case about everything in the tank besides water, bodies and instruments."""

    open: Annotated[tuple[Open, ...], Field(strict=False, description="open sides")] = ()
    gate: Annotated[tuple[Gate, ...], Field(strict=False, description="lifting gates")] = ()
    waves: Waves | None = None
    ship: Ship | None = None
    sponge: Annotated[tuple[Sponge, ...], Field(strict=False, description="wave absorbers")] = ()
    absorber: Annotated[tuple[Absorber, ...], Field(strict=False, description="walls that absorb waves")] = ()

    @property
    def standing(self) -> list[tuple[str, Standing]]:
        """All tables of boundaries with their keys, but for the maker of waves, which is in [waves]."""
        keys = [key for key in type(self).model_fields if key in choices("boundary")]
        return [(key, table) for key in keys for table in getattr(self, key)]
