"""Stone size of rock armour for an accepted damage, and the damage of stones: Van der Meer (1988), Van Gent (2003).

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

BAND = "one standard deviation of the coefficient to either side (RECALLED)"
PLUNGING, SURGING = (6.2, 0.4), (1.0, 0.08)  # coefficients and their standard deviations

SignificantHeight = Annotated[float, Input("significant wave height H_s at the toe, H_1/3", "m", above=0)]
MeanPeriod = Annotated[float, Input("mean period T_m", "s", above=0)]
AcceptedDamage = Annotated[float, Input("damage level S that is accepted", "-", above=0)]
Permeability = Annotated[float, Input("notional permeability P, 0.1 for clay to 0.6 for rock alone", "-", above=0)]
CoreToArmour = Annotated[float, Input("D_n50 of the core over that of the armour, 0 if tight", "-", least=0)]
Stone = Annotated[float, Input("nominal diameter of the armour stones", "m", above=0)]
Waves = Annotated[float, Input("number of waves N", "-", above=0)]
Buoyant = Annotated[float, Input("relative buoyant density Delta, 1.6 of rock", "-", above=0, below=10)]


@dataclass(frozen=True, kw_only=True)
class StoneSize(Answer):
    """Armour stones that keep the damage to what is accepted."""

    D_n50: float = quantity("nominal diameter of the armour stones", "m")
    N_s: float = quantity("stability number H_s/(Delta D_n50)", "-")


@dataclass(frozen=True, kw_only=True)
class Damage(Answer):
    """Damage level of armour stones in a sea."""

    S: float = quantity("damage level A_e/D_n50^2: 2 where damage begins, 8 to 17 where the filter shows", "-")
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
    permeability: Permeability,
    damage: AcceptedDamage = 2.0,
    waves: Waves = 3000.0,
    buoyant_density: Buoyant = 1.6,
) -> StoneSize:
    """Stone size of Van der Meer: Ns = (S/sqrt N)^0.2 6.2 P^0.18 xi^-0.5 in plunging waves, with xi of the mean period.

    In surging waves Ns = (S/sqrt N)^0.2 P^-0.13 sqrt(cot a) xi^P; the two meet at xi_c = [6.2 P^0.31 sqrt(tan a)]^(1/
    (P + 0.5)). Slopes of 1:4 and flatter are taken as plunging.
    """
    slope, acting = _Slope(wave_height, mean_period, cot_slope, permeability), (damage / sqrt(waves)) ** 0.2
    large, mean, small = (wave_height / (buoyant_density * c * slope.shape * acting) for c in slope.coefficients)
    return StoneSize(
        D_n50=mean,
        N_s=slope.coefficients[1] * slope.shape * acting,
        low=small,
        high=large,
        band=BAND,
        ratios={**slope.ratios, "N": waves},
        branch=slope.branch,
    )


@formula(
    "armour-damage-van-der-meer",
    "Damage level of rock armour in deep water.",
    source="Van der Meer (1988), Rock slopes and gravel beaches under wave attack, PhD thesis, TU Delft",
    status="The Deltares toolbox asks for stones 0.7 % larger, 4 % more damage; standard deviations RECALLED",
    limits=(Limit("P", 0.1, 0.6), Limit("s_om", 0.005, 0.06), Limit("N", 0, 7500)),
    holds="deep water in front, two layers of rock, no overtopping to speak of",
    example={
        "wave_height": 3.0, "mean_period": 7.0, "cot_slope": 2.0, "permeability": 0.5, "D_n50": 1.055, "waves": 3000,
        "buoyant_density": 1.6,
    },
)  # fmt: skip
def armour_damage_van_der_meer(
    *,
    wave_height: SignificantHeight,
    mean_period: MeanPeriod,
    cot_slope: CotSlope,
    permeability: Permeability,
    D_n50: Stone,
    waves: Waves = 3000.0,
    buoyant_density: Buoyant = 1.6,
) -> Damage:
    """Damage of stones by Van der Meer, the same equations solved for S = sqrt N (Ns/c)^5.

    Ns is that of the stones, c that of S = sqrt N: in plunging waves c = 6.2 P^0.18 xi^-0.5, in surging waves
    c = P^-0.13 sqrt(cot a) xi^P.
    """
    slope, stability = _Slope(wave_height, mean_period, cot_slope, permeability), wave_height / buoyant_density / D_n50
    large, mean, small = (sqrt(waves) * (stability / (c * slope.shape)) ** 5 for c in slope.coefficients)
    return Damage(
        S=mean,
        N_s=stability,
        low=small,
        high=large,
        band=BAND,
        ratios={**slope.ratios, "N": waves},
        branch=slope.branch,
    )


class _Slope:
    """A slope in a sea as Van der Meer sees it.

    shape         factor of the stability number that slope and sea give
    coefficients  less one standard deviation, mean, and more
    """

    def __init__(self, height: float, period: float, cot_slope: float, P: float) -> None:
        xi = surf_similarity(height, period, cot_slope)
        turn = (PLUNGING[0] / SURGING[0] * P**0.31 * cot_slope**-0.5) ** (1 / (P + 0.5))
        plunging = xi < turn or cot_slope >= 4
        self.shape = P**0.18 * xi**-0.5 if plunging else P**-0.13 * sqrt(cot_slope) * xi**P
        c, error = PLUNGING if plunging else SURGING
        self.coefficients = (c - error, c, c + error)
        self.ratios = {"xi_m": xi, "xi_c": turn, "P": P, "s_om": height / deep_length(period)}
        self.branch = "plunging waves" if plunging else "surging waves"


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
    core_to_armour: CoreToArmour,
    damage: AcceptedDamage = 2.0,
    waves: Waves = 3000.0,
    buoyant_density: Buoyant = 1.6,
) -> StoneSize:
    """Stone size of Van Gent: Ns = 1.75 sqrt(cot a) (1 + D_core/D_armour)^(2/3) (S/sqrt N)^0.2, without the period."""
    stability = _van_gent(cot_slope, core_to_armour) * (damage / sqrt(waves)) ** 0.2
    size = wave_height / (buoyant_density * stability)
    return StoneSize(D_n50=size, N_s=stability, ratios={"N": waves, "cot a": cot_slope})


@formula(
    "armour-damage-van-gent",
    "Damage level of rock armour, also on shallow foreshores, from the permeability of the core.",
    source="Van Gent, Smale & Kuiper (2003), Coastal Structures 2003",
    status="RECALLED",
    limits=(Limit("N", 0, 7500),),
    example={"wave_height": 3.0, "cot_slope": 2.0, "core_to_armour": 0.3, "D_n50": 1.233, "waves": 3000},
)
def armour_damage_van_gent(
    *,
    wave_height: SignificantHeight,
    cot_slope: CotSlope,
    core_to_armour: CoreToArmour,
    D_n50: Stone,
    waves: Waves = 3000.0,
    buoyant_density: Buoyant = 1.6,
) -> Damage:
    """Damage of stones by Van Gent: S = sqrt N (Ns/[1.75 sqrt(cot a) (1 + D_core/D_armour)^(2/3)])^5."""
    stability = wave_height / buoyant_density / D_n50
    found = sqrt(waves) * (stability / _van_gent(cot_slope, core_to_armour)) ** 5
    return Damage(S=found, N_s=stability, ratios={"N": waves, "cot a": cot_slope})


def _van_gent(cot_slope: float, core_to_armour: float) -> float:
    """The stability number where S is the root of the number of waves."""
    return 1.75 * sqrt(cot_slope) * (1 + core_to_armour) ** (2 / 3)
