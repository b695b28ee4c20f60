"""The porous bodies that tables of a case file stand for: their drag and inertia."""

from __future__ import annotations

import math

from houle.case.shapes import shape_of
from houle.case.tables.tank import Porous, Resistance
from houle.medium.resistance import LAWS, Pair, from_permeability, inertia_coefficient
from houle.medium.sections import PorousBody


def porous_body(entry: Porous, dimension: int, viscosity: float, period: float) -> PorousBody:
    """The body of a table, for water of this viscosity [m2/s] and waves of this period [s], inf: steady flow."""
    a, b = coefficients(entry.resistance, entry.porosity, entry.grain_diameter, viscosity, period)
    inertia = inertia_coefficient(entry.porosity, entry.added_mass)
    on_rate = entry.added_mass_on == "rate"
    return PorousBody(entry.name, shape_of(entry, dimension), entry.porosity, a, b, inertia, on_rate)


def coefficients(
    resistance: Resistance,
    porosity: float,
    grain_diameter: float | None,
    viscosity: float,
    period: float = math.inf,
) -> Pair:
    """Canonical a [1/s], b [1/m] of a body as its case file gives it. A law needs the grain diameter [m].

    period  of the waves [s], for the laws that know it, unless the file gives kc or a period itself; inf: steady flow
    """
    r = resistance
    if r.law is not None:
        if grain_diameter is None:
            raise ValueError(f"the law {r.law} needs a grain diameter")
        return LAWS[r.law](porosity, grain_diameter, viscosity, **stated(r, period))
    if r.permeability is not None and r.forchheimer is not None:
        return from_permeability(r.permeability, r.forchheimer, viscosity)
    if r.a is None or r.b is None:
        raise ValueError("resistance needs a law, or a and b, or permeability and forchheimer")
    return r.a, r.b


def stated(r: Resistance, period: float) -> dict[str, float]:
    """Coefficients of the law that the file states itself, and the period of the waves if it says nothing of it."""
    given = r.given
    if r.law is None or not LAWS[r.law].knows_period or {"kc", "period"} & set(given) or period == math.inf:
        return given
    return {**given, "period": period}
