"""The evaluation of the results: [reflection] [reference]."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from houle.case.tables.base import Table


class Reflection(Table):
    """[reflection]: how much of the waves the structure reflects, transmits and dissipates, at the end of the run."""

    structure: Annotated[
        tuple[float, ...],
        Field(
            strict=False,
            min_length=1,
            max_length=2,
            description="x of its first face and of its back; the back is left out when a wall follows [m]",
            examples=[[6.1, 7.6]],
        ),
    ]
    gauges: Annotated[
        tuple[str, ...], Field(strict=False, min_length=2, description="names of the gauges in front of the structure")
    ]
    behind: Annotated[
        tuple[str, ...], Field(strict=False, description="names of the gauges behind it; without any there is no C_T")
    ] = ()
    method: Literal["zelt-skjelbreia", "mansard-funke", "goda-suzuki", "jh2020"] = Field(
        default="zelt-skjelbreia", description="how incident and reflected waves are separated, see docs/analysis.md"
    )
    window: Annotated[tuple[float, float], Field(strict=False)] | None = Field(
        default=None,
        description="from, to; when left out, from when the waves are steady until they come again from the maker [s]",
    )
    theory: bool = Field(default=True, description="whether linear theory of the section is given too")
    twin: bool = Field(
        default=True,
        description="whether the same flume is computed without the structure, for the quality of its waves",
    )

    @model_validator(mode="after")
    def makes_sense(self) -> Reflection:
        most = {"goda-suzuki": 2, "mansard-funke": 3}.get(self.method)
        if most is not None and len(self.gauges) != most:
            raise ValueError(
                f'gauges names {len(self.gauges)}, method = "{self.method}" takes {most}: name {most}, or take '
                '"zelt-skjelbreia" for any number'
            )
        if self.window is not None and not 0 <= self.window[0] < self.window[1]:
            raise ValueError(f"window = [{self.window[0]:g}, {self.window[1]:g}]: two times, the earlier one first [s]")
        return self


class Reference(Table):
    """[reference]: laboratory points, drawn in the pictures and scored at the end of the run."""

    surface: str = Field(description="CSV beside the case file with columns t_s, x_m, eta_m")
    error: float | None = Field(default=None, gt=0, description="measurement error [m]")
    label: str = Field(default="laboratory", description="name in the pictures")
    volume: float | None = Field(default=None, gt=0, description="water volume of the experiment [m3], 2D [m2]")
