"""The course of the computation and its output: [time] [numerics] [output]."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from houle.case.tables.base import OneOf, Table
from houle.registry import choices


class Until(Table):
    """time.until: how sure the answers have to be before a run ends. All that is given has to be met."""

    q: float | None = Field(
        default=None,
        gt=0,
        lt=1,
        description="half of the 90 % interval of the mean discharge over each [[overtopping]], as a share of it [-]",
        examples=[0.3],
    )
    run_up: float | None = Field(
        default=None,
        gt=0,
        lt=1,
        description="half of the 90 % interval of R_2% of each [[runup]], as a share of it [-]",
    )
    reflection: float | None = Field(
        default=None, gt=0, lt=1, description="half of the 90 % interval of C_R of [reflection] [-]"
    )
    waves: int | None = Field(default=None, ge=1, description="least number of waves", examples=[1000])

    @model_validator(mode="after")
    def asks_for_something(self) -> Until:
        if all(asked is None for asked in (self.q, self.run_up, self.reflection, self.waves)):
            raise ValueError("= {} asks for nothing: give one of q, run_up, reflection, waves, or remove until")
        return self


class Time(Table):
    """[time]: end of the run, and the length of its steps."""

    end: float = Field(gt=0, le=1e6, description="simulated time; the latest one with until [s]", examples=[2.0])
    until: Until | None = Field(
        default=None,
        description="the run ends as soon as its answers are as sure as this says, {q, run_up, reflection, waves}: it "
        "looks after every 20 waves, see below",
    )
    courant: float = Field(
        0.5, gt=0, le=1, description="cells that the fastest particle may cross in a step, at most [-]"
    )
    step: float | None = Field(default=None, gt=0, description="fixed time step instead of courant [s]")

    @model_validator(mode="after")
    def one_control(self) -> Time:
        if self.step is not None and "courant" in self.model_fields_set:
            raise ValueError(
                f"step = {self.step:g} and courant = {self.courant:g} are given together: keep one of them"
            )
        if self.step is not None and self.step > self.end:
            raise ValueError(f"step = {self.step:g} is longer than the whole run: 0 < step <= end = {self.end:g} s")
        return self


class Numerics(Table):
    """[numerics]: `houle describe numerics` explains the choices."""

    scheme: Annotated[str, OneOf("scheme")] = Field(
        default="houle", description="a set of choices; the keys below override it"
    )
    transfer: Annotated[str, OneOf("transfer")] = Field(default="fmpm", description="particles to grid and back")
    order: int = Field(default=4, ge=1, le=20, description="number of terms of fmpm")
    flip: float = Field(
        default=0.99, ge=0, le=1, description="share of FLIP in the blend with PIC, transfer flip only [-]"
    )
    kernel: Annotated[str, OneOf("kernel")] = Field(default="linear", description="transfer kernel")
    remesh: Annotated[str, OneOf("remesh")] = Field(
        default="conservative", description="how particles are replaced by new ones on a regular lattice"
    )
    remesh_every: int = Field(default=5, ge=1, description="least number of steps between remeshings")
    correction: float = Field(
        default=0.5, ge=0, le=1, description="position correction towards uniform volume, 0 = off [-]"
    )
    tolerance: float = Field(
        default=1e-7,
        gt=0,
        le=1e-2,
        description="tolerance of the pressure: max abs(div u_d) dt, a relative change of volume [-]",
    )

    @model_validator(mode="before")
    @classmethod
    def fill_from_scheme(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            return value
        scheme, schemes = value.get("scheme", "houle"), choices("scheme")
        return {**schemes[scheme].takes, **value} if isinstance(scheme, str) and scheme in schemes else value

    @model_validator(mode="after")
    def kernel_suits_transfer(self) -> Numerics:
        if self.transfer == "fmpm" and choices("kernel")[self.kernel].negative:
            raise ValueError(
                f'kernel = "{self.kernel}" has negative weights, for which the terms of transfer = "fmpm" do not '
                "converge: "
                'take kernel = "quadratic", or transfer = "flip"'
            )
        return self


class Output(Table):
    """[output]: intervals at which results are written."""

    every: float = Field(default=0.05, gt=0, description="interval of fields and surface profiles [s]")
    series_every: float = Field(default=0.005, gt=0, description="interval of gauges, sensors and ledger [s]")
    movie: bool = Field(default=False, description="also write an MP4 (needs the extra houle[movie])")
