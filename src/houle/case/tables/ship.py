"""The table [ship] of a case file: a ship, and the channel through which it goes past the section."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from houle.case.tables.base import Table


class Ship(Table):
    """[ship]: a ship that passes the section along its channel; [waves] with kind = "ship" makes its waves."""

    kind: Literal["motor ship", "push convoy", "tug"] = Field(description="kind of ship, for its secondary waves")
    length: float = Field(gt=0, le=1000, description="length [m]")
    beam: float = Field(gt=0, le=200, description="beam [m]")
    draught: float = Field(gt=0, le=50, description="draught [m]")
    midship: float = Field(
        default=1.0, gt=0, le=1, description="midship coefficient: immersed cross-section over beam times draught [-]"
    )
    speed: float = Field(gt=0, le=50, description="speed through the water [m/s]")
    distance: float = Field(
        gt=0,
        le=1e4,
        description="from the side of the ship to the water's edge at the nearer bank, that of the case [m]",
    )
    width: float = Field(gt=0, le=1e4, description="width of the channel at the water surface [m]")
    bed_width: float | None = Field(
        default=None, ge=0, description="width of its bed, where its cross-section is a trapezium [m]"
    )
    area: float | None = Field(
        default=None, gt=0, description="its wet cross-section without the ship, instead of bed_width [m2]"
    )
    toe: float = Field(description="x at which the bank begins, and the waves are those of the passage [m]")
    time: float | None = Field(
        default=None,
        ge=0,
        description="when the bow passes; when left out, as early as the waves can be made [s]",
    )

    @model_validator(mode="after")
    def is_a_channel(self) -> Ship:
        if (self.bed_width is None) == (self.area is None):
            given = "both bed_width and area are given" if self.area else "neither bed_width nor area is given"
            raise ValueError(f": {given}; give one of them, for the wet cross-section of the channel")
        if self.bed_width is not None and self.bed_width > self.width:
            raise ValueError(f"bed_width = {self.bed_width:g} is above width = {self.width:g} m, that at the surface")
        if self.beam >= self.width:
            raise ValueError(f"beam = {self.beam:g} must be below width = {self.width:g} m, that of the channel")
        room = self.width - self.beam
        if self.distance > room / 2 * (1 + 1e-9):
            if self.distance > room:
                where = f"the ship would leave the channel, whose width less the beam is {room:g} m"
            else:
                where = "the ship would be nearer to the other bank, for which the formulas are"
            raise ValueError(f"distance = {self.distance:g}: {where}; 0 < distance <= {room / 2:g} m")
        return self
