"""The table [waves] of a case file.

A key that the kind of waves does not use is an error. Every message of the models starts with the key that it is
about; `messages.explain` puts the name of the table before it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from houle.case.tables.base import OneOf, Point2, Table
from houle.registry import choices
from houle.waves.wave import GAMMA

CHOSEN = (
    "theory",
    "height",
    "period",
    "seed",
    "seeds",
    "gamma",
    "file",
    "start",
    "gap",
    "focus",
    "order",
)  # keys of some kinds only
MAKERS = ("source", "zone", "piston")
PASSING = ("solitary", "focused", "series", "paddle", "ship")  # kinds whose waves pass once: they have no steady window


class Focus(Table):
    """waves.focus: place and time of the crest of a focused or solitary wave."""

    x: float = Field(description="position of the crest [m]")
    time: float = Field(ge=0, description="time of the crest [s]")


class Source(Table):
    """waves.source: waves made by a force inside the water; they travel to both sides, or to one."""

    x: float = Field(description="middle of the source [m]")
    width: float | None = Field(
        default=None,
        gt=0,
        description="width; a wavelength when left out, a quarter of that of the peak for spectra, half of it with "
        "order = 2 [m]",
    )
    form: Literal["finite", "linear", "boussinesq"] = Field(
        default="finite",
        description="regular waves with all their harmonics; or the first alone, with the group velocity of linear "
        "theory or by the paper's eq. (5); sums of linear waves are linear with either of the first two",
    )
    side: Literal["both", "left", "right"] = Field(default="both", description="side to which the waves travel")


class Zone(Table):
    """waves.zone: a relaxation zone, which leads the flow towards the wave between x[0] and x[1]."""

    x: Point2 = Field(description="from, to; the wave is that of theory at the first and free at the second [m]")

    @model_validator(mode="after")
    def runs_to_the_right(self) -> Zone:
        if self.x[0] >= self.x[1]:
            raise ValueError(
                f"x = [{self.x[0]:g}, {self.x[1]:g}]: the wave is complete at the first and leaves at the second, "
                "which must be larger, best by one and a half wavelengths"
            )
        return self


class Piston(Table):
    """waves.piston: a wall across the tank that moves along x; the water is to its right, and none is behind it."""

    x: float = Field(gt=0, description="where it stands at rest, on the nearest face of the grid [m]")
    absorb: bool = Field(
        default=False, description="whether it also absorbs the waves that come back, by the pressure on its face"
    )


class Waves(Table):
    """[waves]: the waves of a case and their maker, one of source, zone, piston."""

    kind: Annotated[str, OneOf("waves")] = Field(description="kind of waves")
    theory: Annotated[str, OneOf("theory")] = Field(
        default="auto", description="theory of regular or solitary waves, see `houle describe theories`"
    )
    height: float | None = Field(
        default=None,
        gt=0,
        le=100,
        description="height, crest to trough; H_m0 of a spectrum; of solitary and focused waves that of the crest "
        "above still water [m]",
        examples=[0.04],
    )
    period: float | None = Field(
        default=None, gt=0, le=1e5, description="wave period, peak period of a spectrum [s]", examples=[1.2]
    )
    depth: float = Field(
        gt=0,
        le=1000,
        description="still water depth where the waves are made, that of [[water]] there [m]",
        examples=[0.25],
    )
    direction: float = Field(
        default=0.0,
        gt=-90,
        lt=90,
        description="direction of travel from the x axis, in 3D and from a source only [degrees]",
    )
    current: float = Field(
        default=0.0,
        ge=-20,
        le=20,
        description="velocity of the water that carries the waves, uniform over the depth, towards larger x; period is "
        "that seen from the bed [m/s]",
    )
    seed: int = Field(default=1, ge=0, description="seed of the random phases and frequencies: same seed, same sea")
    seeds: int | None = Field(
        default=None,
        ge=2,
        le=1000,
        description="number of runs, with this seed and those that follow, one after the other; answers are pooled",
        examples=[8],
    )
    gamma: float = Field(default=GAMMA, ge=1, le=20, description="peak enhancement of jonswap, tma and focused [-]")
    order: Literal[1, 2] = Field(
        default=1,
        description="order of a sum of waves: 1, each by itself; 2, with the waves bound to every pair of them, "
        "at the sum and at the difference of their frequencies (set-down under groups, sharp crests)",
    )
    file: str | None = Field(
        default=None,
        description="CSV beside the case file: of a series columns t_s, eta_m, the elevation above still water at the "
        "maker; of a paddle t_s and displacement_m or velocity_m_s of the wall",
    )
    start: float = Field(default=0.0, ge=-1e10, le=1e10, description="time in the file that is t = 0 of the run [s]")
    gap: float | None = Field(
        default=None,
        gt=0,
        description="longest time without a sample in the file that a line may stand for; when left out, three and a "
        "half usual steps [s]",
    )
    focus: Focus | None = Field(
        default=None, description="place and time of the crest of a focused or solitary wave {x, time}"
    )
    ramp: float | None = Field(
        default=None,
        ge=0,
        description="time in which the waves grow; two periods when left out, none for solitary, focused, series, "
        "paddle, ship [s]",
    )
    source: Source | None = Field(default=None, description="internal source {x, width, form, side}, see below")
    zone: Zone | None = Field(default=None, description="relaxation zone {x = [from, to]}, see below")
    piston: Piston | None = Field(default=None, description="moving wall {x, absorb}, see below")

    @model_validator(mode="after")
    def agrees(self) -> Waves:
        kind, theory = choices("waves")[self.kind], choices("theory")[self.theory]
        found = [f"{key} is missing: {self._what(key)}" for key in kind.needs if getattr(self, key) is None]
        allowed = {*kind.needs, *kind.takes}
        for key in CHOSEN:
            if key in self.model_fields_set and key not in allowed and getattr(self, key) is not None:
                found.append(f'{key} does not belong to kind = "{self.kind}": remove it{self._hint(key)}')
        fits = self.theory == "auto" or theory.single == (self.kind == "solitary")
        if "theory" in allowed and not fits:
            found.append(f'theory = "{self.theory}" does not give kind = "{self.kind}": see `houle describe theories`')
        given = [key for key in MAKERS if getattr(self, key) is not None]
        if len(given) != 1:
            stated = " and ".join(given) + " are given together" if given else "nothing makes the waves"
            ways = "source = {x = ...}, zone = {x = [from, to]}, piston = {x = ...}"
            found.append(f": {stated}; give exactly one of {ways}")
        if self.current and self.source is not None and (self.source.side, self.source.form) != ("both", "linear"):
            found.append(
                f'current = {self.current:g}: a source makes waves on a current with side = "both", form = "linear" '
                "only; or take zone = {x = [from, to]}"
            )
        if self.height is not None and self.kind not in ("series", "paddle") and self.height > self.depth:
            found.append(
                f"height = {self.height:g} is above depth = {self.depth:g} m: no wave stands higher than 0.83 depths; "
                "both are in metres"
            )
        if self.order == 2 and self.direction:
            found.append(f"order = 2: waves along x only, but direction = {self.direction:g}; remove one of them")
        if self.order == 2 and self.source is not None and self.source.form != "finite":
            found.append(
                f'order = 2: source.form = "{self.source.form}" makes linear waves; leave it out, or give order = 1'
            )
        if self.kind == "paddle":
            found += self._unfit_for_a_paddle(given)
        if self.kind == "ship":
            found += [
                f"{key} = {getattr(self, key):g}: a ship's waves come straight at the bank, in still water: remove it"
                for key in ("direction", "current")
                if getattr(self, key)
            ]
        if found:
            raise ValueError("\n".join(found))
        return self

    def _unfit_for_a_paddle(self, given: list[str]) -> list[str]:
        """Messages on what a record of a paddle does not go with."""
        found = []
        if len(given) == 1 and self.piston is None:
            found.append(f'{given[0]} does not make kind = "paddle": it is a wall that moves, piston = {{x = ...}}')
        if self.piston is not None and self.piston.absorb:
            found.append(
                "piston.absorb = true takes up what differs from the pressure of its own wave, which a record of a "
                "paddle does not tell: remove it, and let [[absorber]] or [[sponge]] take up waves at the other end"
            )
        if self.direction:
            found.append(f"direction = {self.direction:g}: a paddle sends waves along x only; remove it")
        return found

    @model_serializer(mode="wrap")
    def written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """The table without the defaults of keys that its kind does not use, so that it can be read back."""
        kind = choices("waves")[self.kind]
        allowed = {*kind.needs, *kind.takes}
        return {key: value for key, value in handler(self).items() if key in allowed or key not in CHOSEN}

    def _what(self, key: str) -> str:
        field = type(self).model_fields[key]
        example = f", for example {field.examples[0]}" if field.examples else ""
        return f'{field.description}{example} (kind = "{self.kind}" needs it)'

    def _hint(self, key: str) -> str:
        if key == "gamma":
            return ", its peak has gamma = 1" if self.kind == "pierson-moskowitz" else ""
        if key == "period" and self.kind == "solitary":
            return ", a solitary wave has none"
        if self.kind == "ship":
            return ", it follows from [ship]"
        return ", they are in the file" if self.kind in ("series", "paddle") and key in ("height", "period") else ""

    @property
    def maker(self) -> Source | Zone | Piston:
        """The maker that the table gives."""
        return next(m for m in (self.source, self.zone, self.piston) if m is not None)

    @property
    def place(self) -> float:
        """Place of the maker [m]: middle of the source, left end of the zone, or piston at rest."""
        return self.maker.x[0] if isinstance(self.maker, Zone) else self.maker.x

    def ramp_time(self) -> float:
        """Time in which the waves grow from nothing to their height [s]."""
        if self.ramp is not None:
            return self.ramp
        return 2 * self.period if self.period is not None and self.kind != "focused" else 0.0
