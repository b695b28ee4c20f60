"""Effect of an uncertain porosity and grain size on the drag of a porous body.

Porosity is seldom known better than to 0.02, and the quadratic drag b is proportional to (1-n)/n^3 in most laws: an
error of 0.02 in the porosity makes one of a fifth in b, however well the flow is computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Annotated

from houle.design.errors import DesignError
from houle.design.formula import Answer, Choice, Input, formula, quantity
from houle.design.inputs import Diameter, Porosity, Viscosity
from houle.medium.resistance import LAWS, Pair

LawName = Annotated[str, Choice("law of resistance", LAWS)]


@dataclass(frozen=True, kw_only=True)
class DragRange(Answer):
    """Drag a u + b |u| u of a porous body with its range; `low` and `high` are those of b."""

    b: float = quantity("coefficient of the quadratic drag", "1/m")
    b_low: float = quantity("smallest b within the errors of porosity and grain diameter", "1/m")
    b_high: float = quantity("largest b within the errors of porosity and grain diameter", "1/m")
    b_spread: float = quantity("half the range of b over b", "-")
    a: float = quantity("coefficient of the linear drag", "1/s")
    a_low: float = quantity("smallest a within the errors of porosity and grain diameter", "1/s")
    a_high: float = quantity("largest a within the errors of porosity and grain diameter", "1/s")


def drag_of(law: str, porosity: float, grain_diameter: float, viscosity: float, period: float | None = None) -> Pair:
    """Coefficients (a, b) [1/s, 1/m] of a law; the period [s] counts where the law knows it."""
    given = {"period": period} if period is not None and LAWS[law].knows_period else {}
    return LAWS[law](porosity, grain_diameter, viscosity, **given)


def beyond(law: str, porosity: float, grain_diameter: float, where: str, reynolds: float = nan) -> tuple[str, ...]:
    """Sentences about the porosity, grain diameter [m] or Reynolds number of a body that lie outside a law's range."""
    row = LAWS[law]
    numbers = (
        ("porosity", porosity, row.porosity),
        ("grain diameter [m]", grain_diameter, row.diameter),
        ("Reynolds number", reynolds, row.reynolds),
    )
    return tuple(
        f"the {name} of the {where}, {value:.4g}, is outside {low:g} to {high:g}, the range of {law}"
        for name, value, (low, high) in numbers
        if value < low or value > high
    )


@formula(
    "drag-range",
    "Range of the drag of a porous body whose porosity and grain diameter are known with an error.",
    source="The law of resistance that is chosen, see `houle describe resistance`",
    status="Derived: the law at the corners of the range",
    holds="as the law does",
    example={"porosity": 0.39, "grain_diameter": 0.02, "porosity_error": 0.02},
)
def drag_range(
    *,
    porosity: Porosity,
    grain_diameter: Diameter,
    law: LawName = "van-gent-1995",
    porosity_error: Annotated[float, Input("error of the porosity, to either side", "-", least=0, below=0.5)] = 0.02,
    diameter_error: Annotated[float, Input("error of the grain diameter, to either side", "m", least=0)] = 0.0,
    period: Annotated[float, Input("period of the waves", "s", above=0)] | None = None,
    viscosity: Viscosity = 1.0e-6,
) -> DragRange:
    """Coefficients a and b of a law of resistance, with what they become at the ends of porosity and grain diameter.

    In every law a and b only grow or only fall with the porosity, and so with the grain diameter: the largest and the
    smallest drag are at the four corners of the two ranges.
    """
    if not (porosity_error < min(porosity, 1 - porosity) and diameter_error < grain_diameter):
        raise DesignError(
            f"porosity_error = {porosity_error:g} and diameter_error = {diameter_error:g} must leave a porosity "
            f"between 0 and 1 and a grain: they are about {porosity:g} and {grain_diameter:g} m"
        )
    ends = ((1, 1), (1, -1), (-1, 1), (-1, -1))
    pairs = [
        drag_of(law, porosity + i * porosity_error, grain_diameter + j * diameter_error, viscosity, period)
        for i, j in ((0, 0), *ends)
    ]
    (a, *a_ends), (b, *b_ends) = zip(*pairs, strict=True)
    b_low, b_high = min(b_ends), max(b_ends)
    return DragRange(
        b=b,
        b_low=b_low,
        b_high=b_high,
        b_spread=(b_high - b_low) / (2 * b) if b else 0.0,
        a=a,
        a_low=min(a_ends),
        a_high=max(a_ends),
        low=b_low,
        high=b_high,
        band=f"{_percent(b_low, b)} to {_percent(b_high, b)} %, for a porosity of {porosity:g} +- {porosity_error:g} "
        f"and a grain diameter of {grain_diameter:g} +- {diameter_error:g} m",
        ratios={"n": porosity},
        branch=f"law {law}: {LAWS[law].source}",
        outside=beyond(law, porosity, grain_diameter, "body"),
    )


def _percent(end: float, value: float) -> str:
    """Distance of an end of a range from the value, in per cent of that."""
    return f"{100 * (end / value - 1):+.0f}" if value else "0"
