"""The case file: what may stand in it, in which unit, within which range. Data only; unknown keys are errors.

The models are named as the TOML tables. They know the file, not the physics of the whole: `checks.py` looks at that.
What a writer gets wrong is explained by `case_errors.py`, one line per finding. To add a key, add a field with its unit
and range.
"""

from __future__ import annotations

import copy
import hashlib
import json
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationError, model_validator

from houle import case_errors
from houle.case_files import NAME, find, override, read_toml, to_toml
from houle.errors import CaseError
from houle.grid import Grid
from houle.resistance import LAWS
from houle.waves.table import Waves

# What `scheme` stands for. Any single key of [numerics] overrides it.
SCHEMES: dict[str, dict[str, Any]] = {
    "houle": {
        "transfer": "fmpm",
        "order": 4,
        "flip": 0.99,
        "kernel": "linear",
        "remesh": "conservative",
        "remesh_every": 5,
        "correction": 0.5,
        "tolerance": 1e-7,
    },
    "jh2020": {
        "transfer": "flip",
        "order": 1,
        "flip": 1.0,
        "kernel": "gaussian-taylor2",
        "remesh": "paper",
        "remesh_every": 200,
        "correction": 0.0,
        "tolerance": 1e-7,
    },
}

WAVE_SHARE = 1.0 / 3.0  # of the Courant limit of the shortest wave on the grid: what keeps long waves from decaying

Name = Annotated[str, Field(pattern=NAME, max_length=80)]
Point = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)]
Point2 = Annotated[tuple[float, float], Field(strict=False)]
Side = Literal["slip", "no-slip"]


class Table(BaseModel):
    """A table of the case file: nothing unknown, nothing converted, nothing infinite, nothing changed later."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Head(Table):
    """[case]"""

    name: Name = Field(description="short name of the case, also of its result folder: letters, digits, - _ .")
    title: str = Field(default="", description="one line for pictures and reports")


class Walls(Table):
    """domain.walls: one word for every side, or a table. Opposite sides are joined by x = "periodic" (y in 3D)."""

    left: Side = Field(default="slip", description="side x = 0")
    right: Side = Field(default="slip", description="side x = size[0]")
    front: Side = Field(default="slip", description="side y = 0, 3D only")
    back: Side = Field(default="slip", description="side y = size[1], 3D only")
    bottom: Side = Field(default="slip", description="floor, z = 0")
    top: Side = Field(default="slip", description="lid, z = size[-1]")
    x: Literal["periodic"] | None = Field(default=None, description="joins left and right")
    y: Literal["periodic"] | None = Field(default=None, description="joins front and back, 3D only")

    @model_validator(mode="before")
    @classmethod
    def one_word(cls, value: Any) -> Any:
        if not isinstance(value, str):
            return value
        if value not in ("slip", "no-slip"):
            later = " (open sides belong to a later version)" if value == "open" else ""
            raise ValueError(f'= "{value}" is not one of "slip", "no-slip", or a table of sides{later}')
        return dict.fromkeys(("left", "right", "front", "back", "bottom", "top"), value)

    @model_validator(mode="after")
    def joined_sides_have_no_wall(self) -> Walls:
        for axis, pair in (("x", ("left", "right")), ("y", ("front", "back"))):
            both = [s for s in pair if s in self.model_fields_set]
            if getattr(self, axis) and both and len(self.model_fields_set) < 6:
                raise ValueError(
                    f'{both[0]} is given although {axis} = "periodic" joins that side: remove one of the two'
                )
        return self

    def no_slip(self, dimension: int) -> tuple[tuple[bool, bool], ...]:
        """Per axis, last up: whether the low and the high side hold the water back along them."""
        pairs = [("left", "right"), ("front", "back"), ("bottom", "top")]
        chosen = pairs if dimension == 3 else [pairs[0], pairs[2]]
        return tuple((getattr(self, a) == "no-slip", getattr(self, b) == "no-slip") for a, b in chosen)

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> dict[str, Any]:
        return {"anyOf": [{"enum": ["slip", "no-slip"]}, handler.resolve_ref_schema(handler(core_schema))]}


class Domain(Table):
    """[domain]: a box from the origin. Two sizes: 2D (x, z); three: 3D (x, y, z)."""

    size: Annotated[
        tuple[Annotated[float, Field(gt=0, le=1e5)], ...],
        Field(
            strict=False,
            min_length=2,
            max_length=3,
            description="length along each axis, the last is up [m]",
            examples=[[1.0, 0.5]],
        ),
    ]
    spacing: float = Field(gt=0, description="grid spacing; particles start at half of it [m]", examples=[0.005])
    walls: Walls = Field(default=Walls(), description='"slip", "no-slip", or a table of sides')

    @model_validator(mode="after")
    def fits(self) -> Domain:
        if self.spacing > min(self.size) * (1 + 1e-9):
            hint = case_errors.guess("spacing", self.spacing, upper=min(self.size) / 5)
            raise ValueError(
                f"spacing = {self.spacing:g} is larger than the domain, {self.size_text}: "
                f"0 < spacing <= {min(self.size):g} m, best below {min(self.size) / 20:g}.{hint}"
            )
        given = self.walls.model_fields_set
        if self.dimension == 2 and (self.walls.y or (len(given) < 6 and {"front", "back"} & given)):
            raise ValueError("walls: y, front and back exist in 3D only; this domain has two sizes")
        return self

    @property
    def dimension(self) -> int:
        return len(self.size)

    @property
    def size_text(self) -> str:
        return " x ".join(f"{s:g}" for s in self.size) + " m"

    @property
    def periodic(self) -> tuple[bool, ...]:
        """Per axis, last up."""
        joined = [self.walls.x is not None, self.walls.y is not None]
        return (*joined[: self.dimension - 1], False)

    @property
    def grid(self) -> Grid:
        return Grid.fit(self.size, self.spacing, self.periodic)


class Fluid(Table):
    """[fluid]"""

    density: float = Field(default=1000.0, ge=100, le=20000, description="density of the water [kg/m3]")
    viscosity: float = Field(default=1.0e-6, ge=0, lt=0.1, description="kinematic viscosity [m2/s]")
    gravity: float = Field(default=9.81, ge=0, le=100, description="gravity, downwards along the last axis [m/s2]")
    smagorinsky: float = Field(
        default=0.0, ge=0, le=0.5, description="Smagorinsky constant of the eddy viscosity, 0 = off [-]"
    )
    acceleration: Point | None = Field(default=None, description="uniform push added to gravity, per axis [m/s2]")

    @property
    def eddy_viscosity(self) -> float:
        """The Smagorinsky constant [-], 0 = off."""
        return self.smagorinsky


class Shape(Table):
    """One of box, polygon, below. Several tables of the same kind add up to their union."""

    box: Annotated[tuple[Point, Point], Field(strict=False)] | None = Field(
        default=None, description="lower and upper corner [[x, z], [x, z]], 3D [[x, y, z], [x, y, z]] [m]"
    )
    polygon: Annotated[tuple[Point2, ...], Field(strict=False, min_length=3)] | None = Field(
        default=None,
        description="corners [[x, z], ...] in the vertical section; in 3D it goes through the whole width [m]",
    )
    below: float | None = Field(default=None, gt=0, description="everything below this level z [m]")

    @model_validator(mode="after")
    def one_shape(self) -> Shape:
        given = [k for k in ("box", "polygon", "below") if getattr(self, k) is not None]
        if len(given) != 1:
            held = " and ".join(given) + " are given together" if given else "no shape is given"
            raise ValueError(
                f": {held}; give exactly one of box = [[x, z], [x, z]], polygon = [[x, z], ...], below = level"
            )
        if self.box is not None:
            _is_a_box(self.box)
        return self


def _is_a_box(box: tuple[Point, Point]) -> None:
    """Raises ValueError."""
    low, high = box
    if len(low) != len(high):
        raise ValueError(f"box has corners of {len(low)} and {len(high)} numbers: both need the same")
    if any(a >= b for a, b in zip(low, high, strict=True)):
        raise ValueError(f"box = {case_errors.show(box)} is empty: the lower corner must stand first, all below")


class Water(Shape):
    """[[water]]: where water stands at the start. Inside a porous body it fills the pores."""


class Solid(Shape):
    """[[solid]]: impermeable."""

    name: Name = Field(default="", description="for messages and pictures; solid-1, ... when left out")


class Resistance(Table):
    """porous.resistance: a published law, or the canonical pair a, b, or permeability and forchheimer."""

    law: str | None = Field(
        default=None,
        description="published law, see `houle describe resistance`",
        json_schema_extra={"enum": list(LAWS)},
    )
    alpha: float | None = Field(default=None, ge=0, le=1e5, description="linear coefficient of the law [-]")
    beta: float | None = Field(default=None, ge=0, le=1e3, description="quadratic coefficient of the law [-]")
    kc: float | None = Field(default=None, gt=0, description="Keulegan-Carpenter number, left out in steady flow [-]")
    a: float | None = Field(
        default=None, ge=0, description="canonical linear coefficient, drag = a u_d + b abs(u_d) u_d [1/s]"
    )
    b: float | None = Field(default=None, ge=0, description="canonical quadratic coefficient [1/m]")
    permeability: float | None = Field(default=None, gt=0, le=1, description="K_p = nu/a [m2]")
    forchheimer: float | None = Field(default=None, ge=0, le=1e3, description="C_f = b sqrt(K_p) [-]")

    @property
    def given(self) -> dict[str, float]:
        """Coefficients of the law that the file states itself."""
        return {k: v for k in ("alpha", "beta", "kc") if (v := getattr(self, k)) is not None}

    @model_validator(mode="after")
    def one_way(self) -> Resistance:
        if self.law is not None and self.law not in LAWS:
            raise ValueError(
                f'law = "{self.law}" is not known.{case_errors.nearest(self.law, LAWS)} Laws: {", ".join(LAWS)}'
            )
        ways = [
            [k for k in keys if getattr(self, k) is not None]
            for keys in (("law",), ("a", "b"), ("permeability", "forchheimer"))
        ]
        if [len(w) for w in ways] not in ([1, 0, 0], [0, 2, 0], [0, 0, 2]):
            held = ", ".join(k for w in ways for k in w) or "nothing"
            raise ValueError(f": {held} given; give law = ..., or both a and b, or both permeability and forchheimer")
        extra = set(self.given) - set(LAWS[self.law].coefficients if self.law else {})
        if extra:
            raise ValueError(f"{min(extra)} does not belong to {self.law or 'coefficients given directly'}: remove it")
        return self


class Porous(Shape):
    """[[porous]]: a rigid porous body."""

    name: Name = Field(default="", description="for messages, pictures and --set; porous-1, ... when left out")
    porosity: float = Field(gt=0, le=1, description="pore volume / total volume [-]", examples=[0.45])
    grain_diameter: float | None = Field(
        default=None, gt=0, le=5, description="median grain diameter d50, needed by every law [m]"
    )
    resistance: Resistance = Field(description="{law = ...}, {a, b} or {permeability, forchheimer}")
    added_mass: float = Field(default=0.34, ge=0, le=10, description="gamma in C_r = 1 + gamma (1-n)/n [-]")

    @model_validator(mode="after")
    def law_has_grains(self) -> Porous:
        if self.resistance.law is not None and self.grain_diameter is None:
            raise ValueError(f'grain_diameter is missing: resistance.law = "{self.resistance.law}" needs it [m]')
        return self


class Gate(Table):
    """[[gate]]: a thin plate across the domain at x, lifted. It stands on the nearest face of the grid."""

    x: float = Field(description="position [m]")
    speed: float = Field(gt=0, le=100, description="upward speed of its lower edge [m/s]")
    start: float = Field(default=0.0, ge=0, description="time at which it starts to rise [s]")


class Sponge(Table):
    """[[sponge]]: takes up waves on their way to the side of the tank that it touches."""

    name: Name = Field(default="", description="for messages and pictures; sponge-1, ... when left out")
    box: Annotated[tuple[Point, Point], Field(strict=False)] = Field(
        description="corners [[x, z], [x, z]]; one end at a side of the tank [m]"
    )
    strength: float | None = Field(
        default=None,
        gt=0,
        le=1e4,
        description="largest rate at which it slows the water down; when left out, 1 % of the waves comes back [1/s]",
    )

    @model_validator(mode="after")
    def is_a_box(self) -> Sponge:
        _is_a_box(self.box)
        return self


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
        default=None, description="of the tank, instead of a body"
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


class Time(Table):
    """[time]"""

    end: float = Field(gt=0, le=1e6, description="simulated time [s]", examples=[2.0])
    courant: float = Field(
        0.5, gt=0, le=1, description="cells a pore may be crossed in one step, sets the time step [-]"
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

    scheme: Literal["houle", "jh2020"] = Field(
        default="houle", description="a set of choices; the keys below override it"
    )
    transfer: Literal["fmpm", "flip", "pic", "apic"] = Field(default="fmpm", description="particles to grid and back")
    order: int = Field(default=4, ge=1, le=20, description="number of terms of fmpm")
    flip: float = Field(
        default=0.99, ge=0, le=1, description="share of FLIP in the blend with PIC, transfer flip only [-]"
    )
    kernel: Literal["linear", "quadratic", "m4prime", "gaussian", "gaussian-taylor2", "gaussian-cell"] = Field(
        default="linear", description="transfer kernel"
    )
    remesh: Literal["conservative", "paper", "none"] = Field(
        default="conservative", description="how particles are made regular again"
    )
    remesh_every: int = Field(default=5, ge=1, description="least number of steps between remeshings")
    correction: float = Field(
        default=0.5, ge=0, le=1, description="position correction towards uniform volume, 0 = off [-]"
    )
    tolerance: float = Field(
        default=1e-7, gt=0, le=1e-2, description="of the pressure: max abs(div u_d) dt, a relative volume change [-]"
    )

    @model_validator(mode="before")
    @classmethod
    def fill_from_scheme(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            return value
        scheme = value.get("scheme", "houle")
        return {**SCHEMES.get(scheme if isinstance(scheme, str) else "", {}), **value}

    @model_validator(mode="after")
    def kernel_suits_transfer(self) -> Numerics:
        if self.transfer == "fmpm" and self.kernel == "m4prime":
            raise ValueError(
                'kernel = "m4prime" has negative weights, for which the terms of transfer = "fmpm" do not converge: '
                'take kernel = "quadratic", or transfer = "flip"'
            )
        return self


class Output(Table):
    """[output]"""

    every: float = Field(default=0.05, gt=0, description="interval of fields and surface profiles [s]")
    series_every: float = Field(default=0.005, gt=0, description="interval of gauges, sensors and ledger [s]")
    movie: bool = Field(default=False, description="also write an MP4 (needs the extra houle[movie])")


class Reflection(Table):
    """[reflection]: how much of the waves the structure sends back, lets through and swallows, said at the end."""

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
        tuple[str, ...], Field(strict=False, description="names of those behind it; without any no C_T")
    ] = ()
    method: Literal["zelt-skjelbreia", "mansard-funke", "goda-suzuki", "jh2020"] = Field(
        default="zelt-skjelbreia", description="how incident and reflected waves are told apart, see docs/analysis.md"
    )
    window: Annotated[tuple[float, float], Field(strict=False)] | None = Field(
        default=None, description="from, to; when left out, after the waves are steady and before they come again [s]"
    )
    theory: bool = Field(default=True, description="also linear theory, if the structure is one vertical block")
    twin: bool = Field(default=True, description="also the quality of the waves, from the same flume without structure")

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


PREFIXES = {  # of names
    "porous": "porous-", "solid": "solid-", "sponge": "sponge-", "gauge": "G", "sensor": "P", "runup": "R",
    "overtopping": "O", "force": "F", "phreatic": "L", "flux": "Q",
}  # fmt: skip


class Case(Table):
    """A case file of houle: waves and dam-break flow through porous structures. SI units throughout."""

    case: Head
    domain: Domain
    fluid: Fluid = Fluid()
    water: Annotated[
        tuple[Water, ...], Field(strict=False, min_length=1, description="where water stands at the start")
    ]
    porous: Annotated[tuple[Porous, ...], Field(strict=False, description="porous bodies")] = ()
    solid: Annotated[tuple[Solid, ...], Field(strict=False, description="impermeable bodies")] = ()
    gate: Annotated[tuple[Gate, ...], Field(strict=False, description="lifting gates")] = ()
    waves: Waves | None = None
    sponge: Annotated[tuple[Sponge, ...], Field(strict=False, description="wave absorbers")] = ()
    gauge: Annotated[tuple[Gauge, ...], Field(strict=False, description="free surface gauges")] = ()
    sensor: Annotated[tuple[Sensor, ...], Field(strict=False, description="pressure and velocity sensors")] = ()
    runup: Annotated[tuple[RunUp, ...], Field(strict=False, description="run-up on slopes and walls")] = ()
    overtopping: Annotated[tuple[Overtopping, ...], Field(strict=False, description="water over crests")] = ()
    force: Annotated[tuple[Force, ...], Field(strict=False, description="forces on structures")] = ()
    phreatic: Annotated[tuple[Phreatic, ...], Field(strict=False, description="levels inside structures")] = ()
    flux: Annotated[tuple[Flux, ...], Field(strict=False, description="discharge through sections")] = ()
    time: Time
    numerics: Numerics = Numerics()
    output: Output = Output()
    reflection: Reflection | None = None
    reference: Reference | None = None
    _path: Path | None = PrivateAttr(None)

    @model_validator(mode="before")
    @classmethod
    def fill_names(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            return value
        value = dict(value)
        for key, prefix in PREFIXES.items():
            rows = value.get(key)
            if isinstance(rows, (list, tuple)):
                value[key] = [
                    {"name": f"{prefix}{i}", **row} if isinstance(row, dict) else row
                    for i, row in enumerate(rows, start=1)
                ]
        return value

    @model_validator(mode="after")
    def dimensions_agree(self) -> Case:
        d, found = self.domain.dimension, []
        for key in ("water", "porous", "solid", "sponge"):
            for i, shape in enumerate(getattr(self, key)):
                if shape.box is not None and len(shape.box[0]) != d:
                    place = case_errors.place((key, i, "box"), self.__dict__)
                    found.append(
                        f"{place} has corners of {len(shape.box[0])} numbers, domain.size has {d}: give {d} everywhere"
                    )
        for i, sensor in enumerate(self.sensor):
            if len(sensor.at) != d:
                place = case_errors.place(("sensor", i, "at"), self.__dict__)
                found.append(f"{place} has {len(sensor.at)} numbers, domain.size has {d}: give {d}")
        if self.fluid.acceleration is not None and len(self.fluid.acceleration) != d:
            found.append(
                f"fluid.acceleration has {len(self.fluid.acceleration)} numbers, domain.size has {d}: give {d}"
            )
        if self.waves is not None and self.waves.direction and d == 2:
            found.append(f"waves.direction = {self.waves.direction:g} degrees in 2D, where waves go along x: remove it")
        for key in ("gauge", "phreatic"):
            for i, row in enumerate(getattr(self, key)):
                if (row.y is None) == (d == 3):
                    place = case_errors.place((key, i, "y"), self.__dict__)
                    found.append(f"{place} is {'missing in 3D: add y [m]' if d == 3 else 'given in 2D: remove it'}")
        found += self._unknown_bodies()
        for i, force in enumerate(self.force):
            place = case_errors.place(("force", i), self.__dict__)
            if force.about is not None and len(force.about) != d:
                found.append(f"{place}.about has {len(force.about)} numbers, domain.size has {d}: give {d}")
            if d == 2 and force.side in ("front", "back"):
                found.append(f'{place}.side = "{force.side}" exists in 3D only; this domain has two sizes')
        for key in PREFIXES:
            names = [row.name for row in getattr(self, key)]
            found += [
                f"{key}: the name {n} is given twice; names must differ"
                for n in sorted({n for n in names if names.count(n) > 1})
            ]
        found += self._reflection_fits()
        if found:
            raise ValueError("\n".join(found))
        return self

    def _unknown_bodies(self) -> list[str]:
        """What is wrong with the names of bodies whose force or phreatic line is asked for."""
        porous, solid = [b.name for b in self.porous], [b.name for b in self.solid]
        wanted = [("force", i, f.body, porous + solid) for i, f in enumerate(self.force) if f.body is not None]
        wanted += [("phreatic", i, p.body, porous) for i, p in enumerate(self.phreatic)]
        found = []
        for key, i, name, names in wanted:
            what = f'{case_errors.place((key, i, "body"), self.__dict__)} = "{name}"'
            if name not in names:
                kind = "porous body" if key == "phreatic" else "porous body or solid"
                there = f" There are: {', '.join(names)}" if names else f" The case has no {kind}"
                found.append(f"{what} is the name of no {kind}.{case_errors.nearest(name, names)}{there}")
            elif names.count(name) > 1:
                found.append(f"{what} is the name of a porous body and of a solid: rename one of them")
        return found

    def _reflection_fits(self) -> list[str]:
        """What is wrong between [reflection] and the rest."""
        asked = self.reflection
        if asked is None:
            return []
        if self.waves is None or self.waves.kind in ("solitary", "focused", "series"):
            held = "there are no [waves]" if self.waves is None else f'waves.kind = "{self.waves.kind}"'
            return [f"reflection needs regular or irregular waves, {held}: remove [reflection]"]
        place = {gauge.name: gauge.x for gauge in self.gauge}
        named = [("gauges", name) for name in asked.gauges] + [("behind", name) for name in asked.behind]
        found = [
            f"reflection.{key}: there is no gauge {name}.{case_errors.nearest(name, place)} There are: "
            f"{', '.join(place) or 'none'}"
            for key, name in named
            if name not in place
        ]
        start, structure = self.waves.start, asked.structure
        outside = [x for x in structure if not 0 <= x <= self.domain.size[0]]
        if outside:
            return [*found, f"reflection.structure: {outside[0]:g} m is outside the tank, 0 to {self.domain.size[0]:g}"]
        towards = 1.0 if structure[0] > start else -1.0
        if len(structure) == 2 and towards * (structure[1] - structure[0]) <= 0:
            found.append(
                f"reflection.structure = [{structure[0]:g}, {structure[1]:g}]: first the face that the waves from "
                f"x = {start:g} m meet, then the back"
            )
        for key, name in named:
            after = key == "behind"
            beyond = structure[-1] if after else structure[0]
            if name in place and (towards * (place[name] - beyond) > 0) != after:
                found.append(
                    f"reflection.{key}: gauge {name} stands at {place[name]:g} m, {'not ' if after else ''}behind "
                    f"{beyond:g} m: move it, or name another"
                )
        return found

    @property
    def folder(self) -> Path:
        """Where the other files lie that it names."""
        return self._path.parent if self._path else Path()

    @property
    def path(self) -> Path | None:
        """The file it came from, if any: other files it names lie beside it."""
        return self._path

    @property
    def dimension(self) -> int:
        return self.domain.dimension

    @property
    def acceleration(self) -> tuple[float, ...]:
        """Gravity and fluid.acceleration together, per axis, last up [m/s2]."""
        push = self.fluid.acceleration or (0.0,) * self.dimension
        return (*push[:-1], push[-1] - self.fluid.gravity)

    def to_dict(self) -> dict[str, Any]:
        """Plain lists, tables and numbers as a file would hold them, defaults written out; `load` reads it back."""
        data = self.model_dump(mode="json", exclude_none=True)
        if self.time.step is not None:
            del data["time"]["courant"]
        return data

    def to_toml(self) -> str:
        """A case file that gives the same case."""
        return to_toml(self.to_dict())

    @property
    def hash(self) -> str:
        """16 hexadecimal digits of everything in the case, defaults included."""
        return hashlib.sha256(json.dumps(self.to_dict(), sort_keys=True).encode()).hexdigest()[:16]


def schema() -> dict[str, Any]:
    """JSON Schema of the case file, for editors and forms."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Case.model_json_schema()}


def load(source: str | Path | dict[str, Any] | Case, overrides: dict[str, Any] | None = None) -> Case:
    """The case in a file, or the shipped case of that name, or the tables of a dict. SI units.

    overrides  {"domain.spacing": 0.01, "porous.dam.porosity": 0.4}: a body, gauge or sensor by its name or its
    number from 0.
    Raises CaseError, one line per finding: key, value, allowed range, cure. Whether the shapes fit together is looked
    at by `checks.require`.
    """
    if isinstance(source, Case):
        if not overrides:
            return source
        path, data = source.path, source.to_dict()
        if "numerics.scheme" in overrides:  # what the old scheme had set does not stand in the way of the new one
            old = SCHEMES[source.numerics.scheme]
            data["numerics"] = {k: v for k, v in data["numerics"].items() if old.get(k) != v}
    elif isinstance(source, dict):
        path, data = None, copy.deepcopy(source)
    else:
        path = find(source)
        data = read_toml(path)
    for key, value in (overrides or {}).items():
        override(data, key, value)
        if key in ("time.step", "time.courant"):
            data["time"].pop("courant" if key == "time.step" else "step", None)
    try:
        case = Case.model_validate(data)
    except ValidationError as error:
        raise CaseError(case_errors.explain(error, Case, data)) from None
    case._path = path
    return case
