"""Reflection of a sea from a slope."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, tanh

from houle.design.formula import Answer, Limit, formula, quantity
from houle.design.inputs import CotSlope, EnergyPeriod, Height, Roughness
from houle.design.sea import surf_similarity


@dataclass(frozen=True, kw_only=True)
class ReflectionOfSlope(Answer):
    """Reflection coefficient of a slope by a formula."""

    K_r: float = quantity("reflection coefficient, reflected over incident H_m0", "-")


@formula(
    "reflection-slope",
    "Reflection coefficient of a smooth or rough slope in a sea.",
    source="Zanuttigh & Van der Meer (2008), Coastal Engineering 55, 771-780",
    status="RECALLED",
    limits=(Limit("xi", 1),),
    holds="all slopes; roughness by the table of run-up and overtopping",
    example={"wave_height": 0.1, "period": 1.45, "cot_slope": 2.0, "roughness": 0.40},
)
def reflection_slope(
    *, wave_height: Height, period: EnergyPeriod, cot_slope: CotSlope, roughness: Roughness = 1.0
) -> ReflectionOfSlope:
    """Reflection coefficient K_r = tanh(a xi^b), a = 0.167 [1 - exp(-3.2 gamma_f)], b = 0.86 + 1.49 (gamma_f - 0.38)^2.

    wave_height and period are those of the incident waves.
    """
    xi = surf_similarity(wave_height, period, cot_slope)
    a, b = 0.167 * (1 - exp(-3.2 * roughness)), 1.49 * (roughness - 0.38) ** 2 + 0.86
    return ReflectionOfSlope(K_r=tanh(a * xi**b), ratios={"xi": xi})
