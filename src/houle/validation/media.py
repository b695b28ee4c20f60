"""The medium of a porous body of a case, as the exact solutions take it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.case.porous import coefficients
from houle.medium.resistance import inertia_coefficient
from houle.validation.exact import PorousMedium

if TYPE_CHECKING:
    from houle.case.tables.tank import Fluid, Porous


def medium(body: Porous, fluid: Fluid) -> PorousMedium:
    """Porosity, a, b and inertia of the body."""
    a, b = coefficients(body.resistance, body.porosity, body.grain_diameter, fluid.viscosity)
    inertia = inertia_coefficient(body.porosity, body.added_mass)
    return PorousMedium(body.porosity, a, b, inertia, body.added_mass_on == "rate")


def bed_top(body: Porous) -> float:
    """Level [m] of the top of a box, mean level of the top of a polygon that is a box with a sloping top."""
    if body.box is not None:
        return body.box[1][-1]
    assert body.polygon is not None
    level = np.array([z for _, z in body.polygon])
    return float(level[level > level.min()].mean())
