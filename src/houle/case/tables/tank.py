"""The tank, the water and the bodies in it: [case] [domain] [fluid] [[water]] [[porous]] [[solid]]"""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from houle.case import messages
from houle.case.messages import TABLE, WORD
from houle.case.tables.base import Name, Point, Point2, Table, is_a_box
from houle.grid import Grid
from houle.medium.resistance import LAWS

SIDES = ("left", "right", "front", "back", "bottom", "top")
SIDES_2D = ("left", "right", "bottom", "top")
MOST_CELLS = 1e15  # most cells in a domain: more cannot be counted; the checks say whether memory holds them


class Head(Table):
    """[case]: name and title."""

    name: Name = Field(
        description="short name of the case and of its result folder: letters, digits, hyphens, underscores, points"
    )
    title: str = Field(default="", max_length=500, description="one line for pictures and reports")


class Rough(Table):
    """A side of the tank along which the water rubs: walls.bottom = {roughness = 0.001}."""

    roughness: float = Field(
        ge=0, le=1, description="Nikuradse's equivalent sand roughness k_s, 0 = smooth [m]", examples=[0.001]
    )


def _form(value: Any) -> str:
    """The form in which a side is given, so that a wrong one is told about that form alone."""
    return TABLE if isinstance(value, dict | Rough) else WORD


Word = Annotated[Literal["slip", "no-slip"], Tag(WORD)]
Side = Annotated[Word | Annotated[Rough, Tag(TABLE)], Discriminator(_form)]


class Walls(Table):
    """domain.walls: one word for all sides, or a table of sides. x = "periodic" joins left and right (y in 3D)."""

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
        if isinstance(value, dict) and list(value) == ["roughness"]:
            return dict.fromkeys(SIDES, value)
        if not isinstance(value, str):
            return value
        if value not in ("slip", "no-slip"):
            later = ": an open side is a table [[open]], with its side" if value == "open" else ""
            raise ValueError(f'= "{value}" is not one of "slip", "no-slip", or a table of sides{later}')
        return dict.fromkeys(SIDES, value)

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
        """Per axis, the last one up: whether the low and the high side are no-slip walls."""
        pairs = [("left", "right"), ("front", "back"), ("bottom", "top")]
        chosen = pairs if dimension == 3 else [pairs[0], pairs[2]]
        return tuple((getattr(self, a) == "no-slip", getattr(self, b) == "no-slip") for a, b in chosen)

    def rough(self, dimension: int, smooth: bool) -> dict[str, float]:
        """The sides that rub and their roughness [m], in 2D those of the section; smooth: "no-slip" is roughness 0."""
        found = {}
        for side in SIDES if dimension == 3 else SIDES_2D:
            given = getattr(self, side)
            if isinstance(given, Rough):
                found[side] = given.roughness
            elif smooth and given == "no-slip" and not self._joined(side):
                found[side] = 0.0
        return found

    def _joined(self, side: str) -> bool:
        """True for a side that is joined with the opposite one."""
        return bool((self.x and side in ("left", "right")) or (self.y and side in ("front", "back")))

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> dict[str, Any]:
        return {"anyOf": [{"enum": ["slip", "no-slip"]}, handler.resolve_ref_schema(handler(core_schema))]}


class Domain(Table):
    """[domain]: a box with one corner at the origin. Two sizes make it 2D (x, z), three 3D (x, y, z)."""

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
    spacing: float = Field(gt=0, description="grid spacing; particles start half a spacing apart [m]", examples=[0.005])
    walls: Walls = Field(default=Walls(), description='"slip", "no-slip", or a table of sides')

    @model_validator(mode="after")
    def fits(self) -> Domain:
        if self.spacing > min(self.size) * (1 + 1e-9):
            hint = messages.guess("spacing", self.spacing, upper=min(self.size) / 5)
            raise ValueError(
                f"spacing = {self.spacing:g} is larger than the domain, {self.size_text}: "
                f"0 < spacing <= {min(self.size):g} m, best below {min(self.size) / 20:g}.{hint}"
            )
        cells = math.prod(length / self.spacing for length in self.size)
        if cells > MOST_CELLS:
            raise ValueError(
                f"spacing = {self.spacing:g} makes {cells:.2g} cells of the domain, {self.size_text}: at most "
                f"{MOST_CELLS:g}, from spacing = {self.spacing * (cells / MOST_CELLS) ** (1 / self.dimension):.2g} m on"
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
        """Per axis, the last one up: whether its two sides are joined."""
        joined = [self.walls.x is not None, self.walls.y is not None]
        return (*joined[: self.dimension - 1], False)

    @property
    def grid(self) -> Grid:
        return Grid.fit(self.size, self.spacing, self.periodic)


class Fluid(Table):
    """[fluid]: properties of the water, and the forces that act on all of it."""

    density: float = Field(default=1000.0, ge=100, le=20000, description="density of the water [kg/m3]")
    viscosity: float = Field(default=1.0e-6, ge=0, lt=0.1, description="kinematic viscosity [m2/s]")
    gravity: float = Field(default=9.81, ge=0, le=100, description="gravity, downwards along the last axis [m/s2]")
    smagorinsky: float = Field(
        default=0.0, ge=0, le=0.5, description="Smagorinsky constant of the eddy viscosity, 0 = off [-]"
    )
    acceleration: Point | None = Field(default=None, description="uniform push added to gravity, per axis [m/s2]")


class Shape(Table):
    """A region: one of box, polygon, below. Several tables of the same kind add up to their union."""

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
            stated = " and ".join(given) + " are given together" if given else "no shape is given"
            raise ValueError(
                f": {stated}; give exactly one of box = [[x, z], [x, z]], polygon = [[x, z], ...], below = level"
            )
        if self.box is not None:
            is_a_box(self.box)
        return self


class Water(Shape):
    """[[water]]: a region that holds water at the start; inside a porous body the water fills its pores."""

    velocity: Point | None = Field(
        default=None, description="Darcy velocity at the start, per axis; at rest when left out [m/s]"
    )


class Solid(Shape):
    """[[solid]]: an impermeable body."""

    prefix: ClassVar[str] = "solid-"

    name: Name = Field(default="", description="name in messages and pictures; solid-1, ... when left out")
    roughness: float | None = Field(
        default=None,
        ge=0,
        le=1,
        description="Nikuradse's equivalent sand roughness k_s of its surface, 0 = smooth; the water slips along it "
        "when left out [m]",
        examples=[0.001],
    )


class Resistance(Table):
    """porous.resistance: a published law, or the canonical pair a, b, or permeability and forchheimer."""

    law: str | None = Field(
        default=None,
        description="published law, see `houle describe resistance`",
        json_schema_extra=lambda schema: schema.update(enum=list(LAWS)),
    )
    alpha: float | None = Field(
        default=None, ge=0, le=1e5, description="linear coefficient of the law, the published one when left out [-]"
    )
    beta: float | None = Field(
        default=None, ge=0, le=1e3, description="quadratic coefficient of the law, the published one when left out [-]"
    )
    kc: float | None = Field(
        default=None,
        gt=0,
        description="one Keulegan-Carpenter number for the body, instead of that of the velocity at each place [-]",
    )
    period: float | None = Field(
        default=None,
        gt=0,
        description="period of oscillating flow, for KC from the velocity at each place; that of [waves] when left "
        "out, steady flow without waves [s]",
    )
    a: float | None = Field(
        default=None, ge=0, description="canonical linear coefficient, drag = a u_d + b abs(u_d) u_d [1/s]"
    )
    b: float | None = Field(default=None, ge=0, description="canonical quadratic coefficient [1/m]")
    permeability: float | None = Field(default=None, gt=0, le=1, description="permeability K_p = nu/a [m2]")
    forchheimer: float | None = Field(
        default=None, ge=0, le=1e3, description="Forchheimer coefficient C_f = b sqrt(K_p) [-]"
    )

    @property
    def given(self) -> dict[str, float]:
        """The coefficients of the law that the table gives."""
        return {k: v for k in ("alpha", "beta", "kc", "period") if (v := getattr(self, k)) is not None}

    @model_validator(mode="after")
    def one_way(self) -> Resistance:
        if self.law is not None and self.law not in LAWS:
            raise ValueError(
                f'law = "{self.law}" is not known.{messages.nearest(self.law, LAWS)} Laws: {", ".join(LAWS)}'
            )
        ways = [
            [k for k in keys if getattr(self, k) is not None]
            for keys in (("law",), ("a", "b"), ("permeability", "forchheimer"))
        ]
        if [len(w) for w in ways] not in ([1, 0, 0], [0, 2, 0], [0, 0, 2]):
            stated = ", ".join(k for w in ways for k in w) or "nothing"
            raise ValueError(f": {stated} given; give law = ..., or both a and b, or both permeability and forchheimer")
        extra = set(self.given) - set(LAWS[self.law].coefficients if self.law else {})
        if extra:
            raise ValueError(f"{min(extra)} does not belong to {self.law or 'coefficients given directly'}: remove it")
        if self.kc is not None and self.period is not None:
            raise ValueError(
                f": kc = {self.kc:g} and period = {self.period:g} s are two ways to say the same; give one"
            )
        return self


class Porous(Shape):
    """[[porous]]: a rigid porous body."""

    prefix: ClassVar[str] = "porous-"

    name: Name = Field(default="", description="name in messages, pictures and --set; porous-1, ... when left out")
    porosity: float = Field(gt=0, le=1, description="pore volume / total volume [-]", examples=[0.45])
    grain_diameter: float | None = Field(
        default=None, gt=0, le=5, description="median grain diameter d50, needed by every law [m]"
    )
    resistance: Resistance = Field(
        description="drag of the body, see below: {law = ...}, {a, b} or {permeability, forchheimer}"
    )
    added_mass: float = Field(default=0.34, ge=0, le=10, description="gamma in C_r = 1 + gamma (1-n)/n [-]")
    added_mass_on: Literal["motion", "rate"] = Field(
        default="motion",
        description='term that C_r multiplies: "motion", all of Du/Dt; "rate", the local du/dt alone',
    )

    @model_validator(mode="after")
    def law_has_grains(self) -> Porous:
        if self.resistance.law is not None and self.grain_diameter is None:
            raise ValueError(f'grain_diameter is missing: resistance.law = "{self.resistance.law}" needs it [m]')
        return self
