"""[[open]]: sides of the tank through which water comes and goes."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from houle.case.tables.base import Table

COLUMNS = {"velocity": "velocity_m_s", "discharge": "discharge_m2_s", "level": "level_m"}  # of open.file


class Open(Table):
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
