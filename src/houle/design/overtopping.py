"""Mean overtopping discharge of slopes, rubble mounds and vertical walls (EurOtop 2018).

Each formula has the form q / sqrt(g H_m0^3) = c exp[-(k R_c / (H_m0 ...))^p]. The manual gives mean values of c and k
with their standard deviations. Its design value takes one standard deviation on the unsafe side of both; `low` here is
one on the other side. The scatter of measurements about the mean is larger than that band, and each formula says so.

EurOtop (2018): Manual on wave overtopping of sea defences and related structures, second edition. Van der Meer, Allsop,
Bruce, De Rouck, Kortenhaus, Pullen, Schuettrumpf, Troch & Zanuttigh.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import degrees, exp, inf, sqrt
from typing import Annotated

from houle.design.formula import Answer, Choice, Input, Limit, formula, quantity
from houle.design.inputs import (
    CotSlope,
    Depth,
    EnergyPeriod,
    Factor,
    Freeboard,
    Height,
    Obliquity,
    Permeable,
    Roughness,
)
from houle.design.sea import deep_length, discharge, surf_similarity

BAND = "one standard deviation of the coefficients to either side; the upper end is the design value"
MOST_OBLIQUE = 80.0  # degrees: waves that come in more obliquely are taken at this angle

# Mean and standard deviation of (c, k). Of slopes the deviations are the differences of design and mean values.
BREAKING = ((0.023, 0.003), (2.7, 0.20))  # (5.10), (5.12)
SURGING = ((0.09, 0.0135), (1.5, 0.15))  # (5.11), (5.13); (6.5), (6.6)
WALL = ((0.047, 0.007), (2.35, 0.23))  # (7.1)
WALL_FORESHORE = ((0.05, 0.012), (2.78, 0.17))  # (7.5)
IMPULSIVE = ((0.011, 0.0045), (2.2, 0.0))  # (7.7)
IMPULSIVE_HIGH = ((0.0014, 0.0006), (0.0, 0.0))  # (7.8)
IMPULSIVE_TURN = 1.35  # R_c / H_m0 at which (7.8) takes over
WALL_SCATTER = "Of 103 laboratory tests of vertical walls (CLASH 2004) 80 % lie within a factor of two of the mean."
IMPULSIVENESS = 0.23  # h^2 / (H_m0 L_0) up to which waves break against the wall

Pair = tuple[tuple[float, float], tuple[float, float]]
Rule = Annotated[str, Choice("how roughness fades in long waves", ("eurotop-2018", "taw-2002"))]


@dataclass(frozen=True, kw_only=True)
class Overtopping(Answer):
    """Mean overtopping discharge by a formula; `low` and `high` are its band, `high` the design value."""

    q: float = quantity("mean overtopping discharge", "m3/s/m")
    q_design: float = quantity("mean discharge plus one standard deviation, for design", "m3/s/m")


def shifted(pair: Pair, by: float) -> tuple[float, float]:
    """Coefficients (c, k), so many standard deviations towards more water."""
    (c, c_error), (k, k_error) = pair
    return c + by * c_error, k - by * k_error


def obliqueness(angle: float, slope: float) -> float:
    """gamma_beta = 1 - slope |beta|, beta in degrees and at most 80."""
    return 1 - slope * min(abs(degrees(angle)), MOST_OBLIQUE)


@formula(
    "overtopping-slope",
    "Mean overtopping of a smooth or rough slope: dike, revetment, embankment.",
    source="EurOtop (2018), eqs. (5.10) and (5.11), design (5.12) and (5.13), obliquity (5.29)",
    status="Met by the Deltares toolbox: the design values of a smooth and a rough slope are the same",
    limits=(Limit("cot a", 1.5, 8), Limit("xi", -inf, 5), Limit("|beta| in degrees", 0, MOST_OBLIQUE)),
    holds="crest above still water, one-peaked sea",
    scatter="Of 400 laboratory tests of smooth slopes (CLASH 2004) 77 % lie within a factor of two of the mean.",
    example={"wave_height": 2.0, "period": 5.0, "freeboard": 5.0, "cot_slope": 3.0},
)
def overtopping_slope(
    *,
    wave_height: Height,
    period: EnergyPeriod,
    freeboard: Freeboard,
    cot_slope: CotSlope,
    roughness: Roughness = 1.0,
    berm: Factor = 1.0,
    obliquity: Obliquity = 0.0,
    wall: Factor = 1.0,
    crest: Factor = 1.0,
) -> Overtopping:
    """Mean overtopping discharge of a slope: the smaller of what breaking and of what surging waves give.

    q* = c4/sqrt(tan a) gamma_b xi exp[-(c1 Rc/(xi Hm0 gamma_b gamma_f gamma_beta gamma_v))^1.3], at most
    c2 exp[-(c3 Rc/(Hm0 gamma_f gamma_beta gamma*))^1.3], with gamma_beta = 1 - 0.0033 |beta| (degrees). `berm` is
    gamma_b, `wall` gamma_v of a storm wall on the slope, `crest` gamma* of walls and promenades in surging waves.
    """
    xi = surf_similarity(wave_height, period, cot_slope)
    relative, oblique = freeboard / wave_height, obliqueness(obliquity, 0.0033)

    def branches(by: float) -> tuple[float, float]:
        c, k = shifted(BREAKING, by)
        steep = k * relative / (xi * berm * roughness * oblique * wall)
        top, rate = shifted(SURGING, by)
        flat = rate * relative / (roughness * oblique * crest)
        return c * sqrt(cot_slope) * berm * xi * exp(-(steep**1.3)), top * exp(-(flat**1.3))

    breaking, surging = branches(0.0)
    return _overtopping(
        wave_height,
        lambda by: min(branches(by)),
        ratios={"cot a": cot_slope, "xi": xi, "Rc/Hm0": relative, "|beta| in degrees": abs(degrees(obliquity))},
        branch="breaking waves, eq. (5.10)" if breaking < surging else "surging waves, eq. (5.11)",
    )


def faded(roughness: float, xi: float, rule: str, permeable: bool) -> float:
    """Roughness factor in waves so long that they surge over the stones: it rises to 1, or 0.60 on a permeable core.

    "eurotop-2018": from xi = 5 to 10. "taw-2002": from xi = 1.8 to 10, as for run-up.
    """
    start, length = (5.0, 5.0) if rule == "eurotop-2018" else (1.8, 8.2)
    risen = roughness + min(max(xi - start, 0.0), length) * (1 - roughness) / length
    return min(risen, max(0.60, roughness)) if permeable else risen


@formula(
    "overtopping-mound",
    "Mean overtopping of a rubble mound with steep armour, rock or concrete units.",
    source="EurOtop (2018), eqs. (6.5), design (6.6), roughness table 6.2, obliquity (6.9); rule taw-2002: TAW (2002)",
    status="Met by case study 8 of the manual",
    limits=(Limit("cot a", 1.33, 2), Limit("xi", 2.8, 4.5), Limit("|beta| in degrees", 0, MOST_OBLIQUE)),
    holds="crest above still water, no crown wall above the armour",
    scatter="Of 532 laboratory tests of rubble mounds (CLASH 2004) 29 % lie within a factor of two of the mean by the "
    "rule eurotop-2018, which gives a quarter of the water in the geometric mean, and 50 % by taw-2002, without bias.",
    example={"wave_height": 4.9, "period": 10.0, "freeboard": 5.61, "cot_slope": 1.5, "roughness": 0.44},
)
def overtopping_mound(
    *,
    wave_height: Height,
    period: EnergyPeriod,
    freeboard: Freeboard,
    cot_slope: CotSlope,
    roughness: Roughness,
    roughness_rule: Rule = "eurotop-2018",
    permeable: Permeable = True,
    obliquity: Obliquity = 0.0,
    crest_width: Annotated[float, Input("width of the permeable crest in front, G_c", "m", least=0)] = 0.0,
    stone_size: Annotated[float, Input("nominal size D_n50 of the armour", "m", above=0)] | None = None,
) -> Overtopping:
    """Mean overtopping discharge of a rubble mound: q* = c2 exp[-(c3 Rc/(Hm0 gamma_f gamma_beta))^1.3].

    Roughness fades in long waves, by one of two rules, which agree up to xi = 1.8. gamma_beta = 1 - 0.0063 |beta|
    (degrees). A crest wider than three stones lets water sink: q times min(1, 3.06 exp(-1.5 Gc/Hm0)); without a
    stone_size every crest counts as wide.
    """
    xi, relative = surf_similarity(wave_height, period, cot_slope), freeboard / wave_height
    fading = faded(roughness, xi, roughness_rule, permeable)
    wide = crest_width > 3 * (stone_size or 0.0)
    sinking = min(1.0, 3.06 * exp(-1.5 * crest_width / wave_height)) if wide else 1.0

    def star(by: float) -> float:
        c, k = shifted(SURGING, by)
        return sinking * c * exp(-((k * relative / (fading * obliqueness(obliquity, 0.0063))) ** 1.3))

    return _overtopping(
        wave_height,
        star,
        ratios={
            "cot a": cot_slope,
            "xi": xi,
            "Rc/Hm0": relative,
            "|beta| in degrees": abs(degrees(obliquity)),
            "gamma_f": fading,
            "crest factor": sinking,
        },
        branch=f"eq. (6.5), roughness by the rule {roughness_rule}",
    )


@formula(
    "overtopping-wall",
    "Mean overtopping of a vertical wall in deep water: no foreshore acts on the waves.",
    source="EurOtop (2018), eq. (7.1)",
    status="Mean met by case study 6 of the manual; standard deviations RECALLED",
    limits=(Limit("Rc/Hm0", 0.1, 3.5),),
    holds="plain wall without parapet, normal waves",
    scatter=WALL_SCATTER,
    example={"wave_height": 2.53, "freeboard": 5.94},
)
def overtopping_wall(*, wave_height: Height, freeboard: Freeboard) -> Overtopping:
    """Mean overtopping discharge of a wall without foreshore: q* = 0.047 exp[-(2.35 Rc/Hm0)^1.3]."""
    relative = freeboard / wave_height

    def star(by: float) -> float:
        c, k = shifted(WALL, by)
        return c * exp(-((k * relative) ** 1.3))

    return _overtopping(wave_height, star, ratios={"Rc/Hm0": relative}, band=f"{BAND} (deviations RECALLED)")


@formula(
    "overtopping-wall-foreshore",
    "Mean overtopping of a vertical wall behind a foreshore, on which waves break or not.",
    source="EurOtop (2018), eqs. (7.5), (7.7) and (7.8)",
    status="Means met by case study 12 of the manual; standard deviations RECALLED",
    limits=(Limit("Rc/Hm0 in (7.5)", 0, 5),),
    holds="plain wall without parapet or mound, normal waves",
    scatter=WALL_SCATTER,
    example={"wave_height": 2.22, "period": 5.7, "depth": 8.0, "freeboard": 5.67},
)
def overtopping_wall_foreshore(
    *, wave_height: Height, period: EnergyPeriod, depth: Depth, freeboard: Freeboard
) -> Overtopping:
    """Mean overtopping discharge of a wall behind a foreshore; h^2/(Hm0 L0) decides whether waves break against it.

    Above 0.23: q* = 0.05 exp(-2.78 Rc/Hm0). Up to 0.23 they break: q* = f 0.011 exp(-2.2 Rc/Hm0), from Rc/Hm0 = 1.35
    on f 0.0014 (Rc/Hm0)^-3, with f = sqrt(Hm0/(h s)), s = Hm0/L0. The last two differ by 1 % where they meet.
    """
    relative, length = freeboard / wave_height, deep_length(period)
    impulsiveness = depth**2 / (wave_height * length)
    breaking, high = impulsiveness <= IMPULSIVENESS, relative >= IMPULSIVE_TURN
    pair = (IMPULSIVE_HIGH if high else IMPULSIVE) if breaking else WALL_FORESHORE
    factor = sqrt(length / depth) if breaking else 1.0

    def star(by: float) -> float:
        c, k = shifted(pair, by)
        return factor * c * (relative**-3 if breaking and high else exp(-k * relative))

    equation = "waves break against the wall, eq. (7.8)" if high else "waves break against the wall, eq. (7.7)"
    return _overtopping(
        wave_height,
        star,
        ratios={"Rc/Hm0" if breaking else "Rc/Hm0 in (7.5)": relative, "h^2/(Hm0 L0)": impulsiveness},
        branch=equation if breaking else "waves do not break, eq. (7.5)",
        band=f"{BAND} (deviations RECALLED)",
    )


def _overtopping(
    wave_height: float, star: Callable[[float], float], *, ratios: dict[str, float], branch: str = "", band: str = BAND
) -> Overtopping:
    """The answer from q* as a function of how many standard deviations its coefficients are shifted, to more water."""
    low, mean, design = (discharge(wave_height) * star(by) for by in (-1.0, 0.0, 1.0))
    return Overtopping(q=mean, q_design=design, low=low, high=design, band=band, ratios=ratios, branch=branch)
