"""What the tables of a case file have in common."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from houle.case.messages import NAME

Name = Annotated[str, Field(pattern=NAME, max_length=80)]
Point = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)]
Point2 = Annotated[tuple[float, float], Field(strict=False)]


class Table(BaseModel):
    """A table of the case file: nothing unknown, nothing converted, nothing infinite, nothing changed later."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)
