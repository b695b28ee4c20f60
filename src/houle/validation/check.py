"""Result of a comparison: one number, its target, and the numbers of other codes for the same case."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Kind = Literal["max", "min", "range", "report"]


@dataclass(frozen=True)
class Check:
    """A number and its target: at most `limit` ("max"), at least ("min"), between two ("range"), or none ("report").

    peers: results of other codes, name -> number or words, in the same unit. A value that is not finite never passes.
    """

    name: str
    value: float
    unit: str = ""
    limit: float | tuple[float, float] | None = None
    kind: Kind = "max"
    peers: Mapping[str, Any] = field(default_factory=dict)
    note: str = ""

    @property
    def passed(self) -> bool:
        low, high = self.bounds
        return math.isfinite(self.value) and low <= self.value <= high

    @property
    def bounds(self) -> tuple[float, float]:
        if isinstance(self.limit, tuple):
            return self.limit
        if self.kind == "report" or self.limit is None:
            return -math.inf, math.inf
        return (self.limit, math.inf) if self.kind == "min" else (-math.inf, self.limit)

    @property
    def target(self) -> str:
        """The limit in words."""
        low, high = self.bounds
        if math.isinf(low) and math.isinf(high):
            return ""
        if math.isinf(low):
            return f"<= {high:g}"
        return f">= {low:g}" if math.isinf(high) else f"{low:g} .. {high:g}"


def report(name: str, value: float, unit: str = "", peers: Mapping[str, Any] | None = None, note: str = "") -> Check:
    """A number without a target."""
    return Check(name, value, unit, None, "report", peers or {}, note)


@dataclass(frozen=True)
class Variant:
    """The same case with other values: overrides as of `houle.load`. quick: also part of `houle validate --quick`."""

    name: str = ""
    overrides: Mapping[str, Any] = field(default_factory=dict)
    quick: bool = True
