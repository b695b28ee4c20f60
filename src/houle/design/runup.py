"""Run-up on slopes: the level that 2 % of the waves of a sea exceed, and that of one solitary wave."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, inf, sqrt

from houle.design.formula import Answer, Limit, formula, quantity
from houle.design.inputs import CotSlope, Depth, EnergyPeriod, Factor, Height, Obliquity, Permeable, Roughness
from houle.design.overtopping import BAND, MOST_OBLIQUE, obliqueness
from houle.design.sea import surf_similarity

BREAKING = (1.65, 0.10)  # coefficient of (5.1) and its standard deviation
SURGING = (1.0, 0.07)  # factor of (5.2) and its standard deviation
PERMEABLE = 1.97  # largest R_2%/H_m0 on a permeable core
ROUGH = 0.60  # roughness factor up to which a slope counts as a rubble mound for oblique waves


@dataclass(frozen=True, kw_only=True)
class RunUpLevel(Answer):
    """Run-up by a formula, above still water."""

    R_2: float = quantity("run-up that 2 % of the waves exceed, R_2%", "m")
    R_2_design: float = quantity("run-up plus one standard deviation, for design", "m")


@dataclass(frozen=True, kw_only=True)
class SolitaryRunUp(Answer):
    """Run-up of a solitary wave by a formula, above still water."""

    R: float = quantity("run-up", "m")


@formula(
    "run-up-slope",
    "Run-up that 2 % of the waves exceed, on a smooth or rough slope.",
    source="EurOtop (2018), eqs. (5.1) and (5.2), obliquity (5.28) and (6.9)",
    status="Recomputed, met by no second source; standard deviations RECALLED",
    limits=(Limit("|beta| in degrees", 0, MOST_OBLIQUE),),
    holds="slope higher than the run-up",
    example={"wave_height": 2.0, "period": 5.0, "cot_slope": 3.0},
)
def run_up_slope(
    *,
    wave_height: Height,
    period: EnergyPeriod,
    cot_slope: CotSlope,
    roughness: Roughness = 1.0,
    berm: Factor = 1.0,
    obliquity: Obliquity = 0.0,
    permeable: Permeable = False,
) -> RunUpLevel:
    """Run-up R_2% on a slope: the smaller of what breaking and of what surging waves give.

    R/Hm0 = 1.65 gamma_b gamma_f gamma_beta xi, at most gamma_fs gamma_b gamma_beta (4 - 1.5/sqrt(gamma_b xi)), on a
    permeable core at most 1.97. In surging waves roughness fades: gamma_fs rises from gamma_f at xi = 1.8 to 1 at 10.
    gamma_beta = 1 - 0.0022 |beta| (degrees), 1 - 0.0063 |beta| of rough slopes, gamma_f up to 0.60.
    """
    xi = surf_similarity(wave_height, period, cot_slope)
    fading = roughness + min(max(xi - 1.8, 0.0), 8.2) * (1 - roughness) / 8.2
    oblique = obliqueness(obliquity, 0.0063 if roughness <= ROUGH else 0.0022)

    def branches(by: float) -> tuple[float, float]:
        rate, top = (mean + by * error for mean, error in (BREAKING, SURGING))
        surging = top * fading * berm * oblique * (4 - 1.5 / sqrt(berm * xi))
        return rate * berm * roughness * oblique * xi, min(surging, top * PERMEABLE if permeable else inf)

    low, mean, design = (wave_height * min(branches(by)) for by in (-1.0, 0.0, 1.0))
    breaking, surging = branches(0.0)
    return RunUpLevel(
        R_2=mean,
        R_2_design=design,
        low=low,
        high=design,
        band=f"{BAND} (deviations RECALLED)",
        ratios={"cot a": cot_slope, "xi": xi, "|beta| in degrees": abs(degrees(obliquity)), "gamma_f surging": fading},
        branch="breaking waves, eq. (5.1)" if breaking < surging else "surging waves, eq. (5.2)",
    )


@formula(
    "run-up-solitary",
    "Run-up of a solitary wave that does not break, on a plane smooth slope.",
    source="Synolakis (1987), J. Fluid Mech. 185, 523-545, the run-up law",
    status="Read; the formula is met by several sources",
    limits=(Limit("(H/d) / limit of breaking", 0, 1),),
    holds="smooth slope that rises from a level bed",
    scatter="On 1:19.85 at H/d = 0.019, two thirds of the limit, it is 14 to 17 % above the laboratory.",
    example={"wave_height": 0.0019, "depth": 0.1, "cot_slope": 19.85},
)
def run_up_solitary(*, wave_height: Height, depth: Depth, cot_slope: CotSlope) -> SolitaryRunUp:
    """Run-up of a solitary wave of a height over a depth: R/d = 2.831 sqrt(cot b) (H/d)^1.25.

    It does not break on the way up as long as H/d < 0.8183 (cot b)^(-10/9). wave_height is that over the level bed.
    """
    relative = wave_height / depth
    limit = 0.8183 * cot_slope ** (-10 / 9)
    run_up = depth * 2.831 * sqrt(cot_slope) * relative**1.25
    return SolitaryRunUp(R=run_up, ratios={"H/d": relative, "(H/d) / limit of breaking": relative / limit})
