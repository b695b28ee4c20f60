"""The base of the tables of a case file, and the kinds of values that several of them have."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core import PydanticKnownError, core_schema

from houle.case import messages
from houle.case.messages import NAME
from houle.registry import choices

Name = Annotated[str, Field(pattern=NAME, max_length=80)]
Point = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)]
Point2 = Annotated[tuple[float, float], Field(strict=False)]


class Table(BaseModel):
    """Base of the tables: no unknown keys, no conversion of types, no infinite numbers, no change after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class OneOf:
    """A word of the case file that names a choice of `houle.registry`: `Annotated[str, OneOf("kernel")]`."""

    def __init__(self, kind: str) -> None:
        self.kind = kind

    @property
    def allowed(self) -> list[str]:
        """The names of the choices."""
        return list(choices(self.kind))

    def check(self, value: object) -> str:
        """The value, if it is the name of a choice. Raises PydanticKnownError for anything else."""
        if isinstance(value, str) and value in choices(self.kind):
            return value
        raise PydanticKnownError("literal_error", {"expected": ", ".join(self.allowed)})

    def __get_pydantic_core_schema__(self, source: object, handler: object) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.check)

    def __get_pydantic_json_schema__(self, schema: object, handler: object) -> dict[str, Any]:
        return {"enum": self.allowed, "type": "string"}


def is_a_box(box: tuple[Point, Point]) -> None:
    """Raises ValueError if the corners are not the lower and the upper one of a box."""
    low, high = box
    if len(low) != len(high):
        raise ValueError(f"box has corners of {len(low)} and {len(high)} numbers: both need the same")
    if any(a >= b for a, b in zip(low, high, strict=True)):
        raise ValueError(f"box = {messages.show(box)} is empty: the lower corner must stand first, all below")
