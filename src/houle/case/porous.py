"""From the tables [[porous]] to porous bodies, with the coefficients of their drag and inertia."""

from __future__ import annotations

import math

from houle.case.shapes import shape_of
from houle.case.tables.tank import Porous, Resistance
from houle.medium.resistance import LAWS, Pair, from_permeability, inertia_coefficient
from houle.medium.sections import PorousBody


def porous_body(entry: Porous, dimension: int, viscosity: float, period: float) -> PorousBody:
    """The body of a table, in water of this viscosity [m2/s] and waves of this period [s], inf for steady flow."""
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
    """Canonical a [1/s], b [1/m] of a body from its table. A law needs the grain diameter [m].

    viscosity  kinematic viscosity of the water [m2/s]
    period     period of the waves [s], inf for steady flow; used by laws that depend on it, unless the table gives kc
               or a period
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
    """The coefficients of its law that a table gives, and the period of the waves if it gives neither kc nor period."""
    given = r.given
    if r.law is None or not LAWS[r.law].knows_period or {"kc", "period"} & set(given) or period == math.inf:
        return given
    return {**given, "period": period}
