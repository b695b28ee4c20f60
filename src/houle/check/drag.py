"""The drag of the porous bodies of a case in every convention in use, and warnings where a law is used out of range."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt
from typing import Any

from houle.case.model import Case
from houle.case.porous import coefficients, stated
from houle.case.section import CrossSection, Entry
from houle.case.tables.tank import Fluid, Porous
from houle.medium.resistance import (
    LAWS,
    Law,
    inertia_coefficient,
    steady_velocity,
)

REFERENCE_VELOCITY = 0.10  # Darcy velocity [m/s] at which the laws are compared
STILL = 0.1  # hydraulic gradient [-] assumed for a body in level water: waves make one of this order


@dataclass(frozen=True)
class DragSheet:
    """The drag of one porous body in every convention in use, so that it can be compared with any paper.

    `words` names the law with its coefficients; `warnings` says where the body lies outside the range in which the law
    was measured.
    """

    name: str
    words: str
    source: str
    status: str
    porosity: float
    grain_diameter: float | None  # [m]
    period: float | None  # period of oscillating flow [s]: inf in steady flow, None if kc or a and b are given
    a: float  # [1/s]
    oscillating: float  # part of a that the factor 1 + 7.5/KC makes [1/s]
    b: float  # [1/m]
    permeability: float  # K_p = nu/a [m2]
    forchheimer: float  # C_f = b sqrt(K_p) [-]
    inertia: float  # C_r [-]
    added_mass_on: str  # "motion", or "rate": before du/dt alone
    velocity: float  # expected Darcy velocity [m/s]
    gradient: float  # drag at the expected velocity / g
    linear_share: float  # a / (a + b u) at the expected velocity
    reference_gradient: float  # drag at REFERENCE_VELOCITY / g
    reynolds: float | None  # u_d d50 / nu
    warnings: tuple[str, ...]


def drag_sheets(case: Case) -> list[DragSheet]:
    """The sheet of every porous body, at the Darcy velocity of steady flow under the gradient that is expected."""
    section, period = CrossSection(case), case.drag_period
    drop = section.drop()
    return [
        drag_sheet(b.row, case.fluid, gradient=expected_gradient(section, b, drop), period=period)
        for b in section.porous
    ]


def drag_of(case: Case) -> list[dict[str, Any]]:
    """The entries of run.json about the porous bodies: each law with its coefficients, and the drag that they make."""
    return [
        {"name": p.name, "law": p.words, "a": p.a, "b": p.b, "inertia": p.inertia,
         "added_mass_on": p.added_mass_on, "period": p.period, "oscillating": p.oscillating}
        for p in drag_sheets(case)
    ]  # fmt: skip


def expected_gradient(section: CrossSection, body: Entry, drop: float) -> float:
    """Hydraulic gradient [-] to expect: drop of level over length of the body, at most 1; STILL in level water."""
    if drop < section.grid.spacing[-1]:
        return STILL
    return float(min(1.0, drop / section.extent(body)[0]))


def drag_sheet(
    body: Porous, fluid: Fluid, velocity: float | None = None, gradient: float = 1.0, period: float = inf
) -> DragSheet:
    """The sheet of a body.

    velocity  Darcy velocity to expect [m/s]; None: that of steady flow under the hydraulic gradient [-]
    period    period of the waves [s], as in `coefficients`
    """
    n, d, r = body.porosity, body.grain_diameter, body.resistance
    a, b = coefficients(r, n, d, fluid.viscosity, period)
    u = steady_velocity(a, b, gradient, fluid.gravity) if velocity is None else velocity
    drag = lambda v: (a + b * v) * v / fluid.gravity if fluid.gravity else inf  # noqa: E731
    permeability = fluid.viscosity / a if a else inf
    law = LAWS.get(r.law or "")
    taken = law.taken(**stated(r, period)) if law else {}
    values = ", ".join(f"{k} = {v:.4g} s" if k == "period" else f"{k} = {v:g}" for k, v in taken.items() if v < inf)
    known = taken["period"] if "period" in taken and taken["kc"] == inf else None
    steady = law(n, d or 1.0, fluid.viscosity, **{**taken, "period": inf})[0] if law and known is not None else a
    named = f"{r.law}: {values}" if values else str(r.law)
    reynolds = u * d / fluid.viscosity if d is not None and fluid.viscosity and u < inf else None
    return DragSheet(
        name=body.name,
        words=named if law else ("permeability, forchheimer" if r.permeability is not None else "a, b"),
        source=law.source if law else "given in the case file",
        status=law.status if law else "",
        porosity=n,
        grain_diameter=d,
        period=known,
        a=a,
        oscillating=a - steady,
        b=b,
        permeability=permeability,
        forchheimer=b * sqrt(permeability) if b else 0.0,
        inertia=inertia_coefficient(n, body.added_mass),
        added_mass_on=body.added_mass_on,
        velocity=u,
        gradient=drag(u) if u < inf else 0.0,
        linear_share=a / (a + b * u) if u < inf else 0.0,
        reference_gradient=drag(REFERENCE_VELOCITY),
        reynolds=reynolds,
        warnings=tuple(_stretched(law, n, d, reynolds)) if law else (),
    )


def _stretched(law: Law, n: float, d: float | None, reynolds: float | None) -> list[str]:
    """One line, with both numbers, for each property of a body that is outside the range of its law."""
    looked_at = (("porosity", n, law.porosity, ""), ("grain_diameter", d, law.diameter, " m"))
    found = [
        f"{word} = {value:g}{unit} is outside {low:g} to {high:g}{unit}, the range behind the law"
        for word, value, (low, high), unit in looked_at
        if value is not None and not low * 0.999 <= value <= high * 1.001
    ]
    if reynolds is not None and not law.reynolds[0] <= reynolds <= law.reynolds[1]:
        low, high = law.reynolds
        found.append(
            f"Reynolds number u_d d50/nu = {reynolds:.0f} is outside {low:g} to {high:g}, the range behind the law"
        )
    return found
