"""Stone size of rock armour for an accepted damage: Van der Meer (1988), Van Gent, Smale & Kuiper (2003).

S = A_e / D_n50^2 is the damage level of a slope, 2 where damage begins; D_n50 the nominal diameter, the cube root of
the volume of the median stone; Delta = rho_stone / rho_water - 1; N_s = H_s / (Delta D_n50).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Annotated

from houle.design.formula import Answer, Input, Limit, formula, quantity
from houle.design.inputs import CotSlope
from houle.design.sea import deep_length, surf_similarity

PLUNGING, SURGING = (6.2, 0.4), (1.0, 0.08)  # coefficients and their standard deviations

SignificantHeight = Annotated[float, Input("significant wave height H_s at the toe, H_1/3", "m", above=0)]
MeanPeriod = Annotated[float, Input("mean period T_m", "s", above=0)]
Damage = Annotated[float, Input("damage level S that is accepted", "-", above=0)]
Waves = Annotated[float, Input("number of waves N", "-", above=0)]
Buoyant = Annotated[float, Input("relative buoyant density Delta, 1.6 of rock", "-", above=0, below=10)]


@dataclass(frozen=True, kw_only=True)
class StoneSize(Answer):
    """Armour stones that keep the damage to what is accepted."""

    D_n50: float = quantity("nominal diameter of the armour stones", "m")
    N_s: float = quantity("stability number H_s/(Delta D_n50)", "-")


@formula(
    "armour-van-der-meer",
    "Size of rock armour in deep water for a damage level.",
    source="Van der Meer (1988), Rock slopes and gravel beaches under wave attack, PhD thesis, TU Delft",
    status="The Deltares toolbox gives 0.7 % more; standard deviations RECALLED",
    limits=(Limit("P", 0.1, 0.6), Limit("s_om", 0.005, 0.06), Limit("N", 0, 7500)),
    holds="deep water in front, two layers of rock, no overtopping to speak of",
    example={
        "wave_height": 3.0, "mean_period": 7.0, "cot_slope": 2.0, "permeability": 0.5, "damage": 2.0, "waves": 3000,
        "buoyant_density": 1.6,
    },
)  # fmt: skip
def armour_van_der_meer(
    *,
    wave_height: SignificantHeight,
    mean_period: MeanPeriod,
    cot_slope: CotSlope,
    permeability: Annotated[float, Input("notional permeability P, 0.1 for clay to 0.6 for rock alone", "-", above=0)],
    damage: Damage = 2.0,
    waves: Waves = 3000.0,
    buoyant_density: Buoyant = 1.6,
) -> StoneSize:
    """Stone size of Van der Meer: Ns = (S/sqrt N)^0.2 6.2 P^0.18 xi^-0.5 in plunging waves, with xi of the mean period.

    In surging waves Ns = (S/sqrt N)^0.2 P^-0.13 sqrt(cot a) xi^P; the two meet at xi_c = [6.2 P^0.31 sqrt(tan a)]^(1/
    (P + 0.5)). Slopes of 1:4 and flatter are taken as plunging.
    """
    xi, P = surf_similarity(wave_height, mean_period, cot_slope), permeability
    turn = (PLUNGING[0] / SURGING[0] * P**0.31 * cot_slope**-0.5) ** (1 / (P + 0.5))
    plunging = xi < turn or cot_slope >= 4
    acting = (damage / sqrt(waves)) ** 0.2
    shape = P**0.18 * xi**-0.5 if plunging else P**-0.13 * sqrt(cot_slope) * xi**P
    c, error = PLUNGING if plunging else SURGING
    large, mean, small = (wave_height / (buoyant_density * by * shape * acting) for by in (c - error, c, c + error))
    return StoneSize(
        D_n50=mean,
        N_s=c * shape * acting,
        low=small,
        high=large,
        band="one standard deviation of the coefficient to either side (RECALLED)",
        ratios={"xi_m": xi, "xi_c": turn, "P": P, "s_om": wave_height / deep_length(mean_period), "N": waves},
        branch="plunging waves" if plunging else "surging waves",
    )


@formula(
    "armour-van-gent",
    "Size of rock armour for a damage level, also on shallow foreshores, from the permeability of the core.",
    source="Van Gent, Smale & Kuiper (2003), Coastal Structures 2003",
    status="RECALLED",
    limits=(Limit("N", 0, 7500),),
    example={"wave_height": 3.0, "cot_slope": 2.0, "core_to_armour": 0.3, "damage": 2.0, "waves": 3000},
)
def armour_van_gent(
    *,
    wave_height: SignificantHeight,
    cot_slope: CotSlope,
    core_to_armour: Annotated[float, Input("D_n50 of the core over that of the armour, 0 if tight", "-", least=0)],
    damage: Damage = 2.0,
    waves: Waves = 3000.0,
    buoyant_density: Buoyant = 1.6,
) -> StoneSize:
    """Stone size of Van Gent: Ns = 1.75 sqrt(cot a) (1 + D_core/D_armour)^(2/3) (S/sqrt N)^0.2, without the period."""
    stability = 1.75 * sqrt(cot_slope) * (1 + core_to_armour) ** (2 / 3) * (damage / sqrt(waves)) ** 0.2
    size = wave_height / (buoyant_density * stability)
    return StoneSize(D_n50=size, N_s=stability, ratios={"N": waves, "cot a": cot_slope})
