"""Transmission of waves over and through a low-crested structure."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp
from typing import Annotated

from houle.design.formula import Answer, Input, Limit, formula, quantity
from houle.design.inputs import CotSlope, Depth, Height, Permeable
from houle.design.sea import deep_length, surf_similarity

WIDE = 10.0  # B / H_si above which the formula of wide crests is taken


@dataclass(frozen=True, kw_only=True)
class Transmission(Answer):
    """Transmission coefficient by a formula."""

    K_t: float = quantity("transmission coefficient, transmitted over incident wave height", "-")


@formula(
    "transmission-low-crest",
    "Transmission coefficient of a low-crested breakwater, narrow or wide, emerged or submerged.",
    source="d'Angremond, van der Meer & de Jong (1996); wide crests: Briganti et al. (2003)",
    status="Met by the Deltares toolbox",
    limits=(Limit("s_op", 0, 0.06), Limit("H/h", 0, 0.54), Limit("Rc/H", -2.5, 2.5)),
    holds="wide crests: rubble mounds, for which c = 0.64",
    example={"wave_height": 2.0, "peak_period": 7.0, "freeboard": 0.5, "crest_width": 5.0, "cot_slope": 2.0},
)
def transmission_low_crest(
    *,
    wave_height: Height,
    peak_period: Annotated[float, Input("peak period T_p", "s", above=0)],
    freeboard: Annotated[float, Input("crest above still water, R_c; below 0 where submerged", "m")],
    crest_width: Annotated[float, Input("width of the crest, B", "m", above=0)],
    cot_slope: CotSlope,
    permeable: Permeable = True,
    depth: Depth | None = None,
) -> Transmission:
    """Transmission coefficient K_t = -0.4 Rc/H + c (B/H)^-0.31 [1 - exp(-0.5 xi)], held between 0.075 and 0.80.

    c = 0.64 of a permeable, 0.80 of an impermeable structure. For B/H above 10: -0.35 Rc/H + 0.51 (B/H)^-0.65
    [1 - exp(-0.41 xi)], held between 0.05 and 0.93 - 0.006 B/H; the two do not meet at 10, in the sources neither. xi
    and the steepness s_op are those of the peak period; depth at the toe is only needed to look at H/h.
    """
    xi = surf_similarity(wave_height, peak_period, cot_slope)
    relative, width = freeboard / wave_height, crest_width / wave_height
    if width > WIDE:
        through, low, high = 0.51 * width**-0.65 * (1 - exp(-0.41 * xi)), 0.05, 0.93 - 0.006 * width
        found, branch = -0.35 * relative + through, "wide crest, Briganti et al. (2003)"
    else:
        through, low, high = (0.64 if permeable else 0.80) * width**-0.31 * (1 - exp(-0.5 * xi)), 0.075, 0.80
        found, branch = -0.4 * relative + through, "narrow crest, d'Angremond et al. (1996)"
    ratios = {"s_op": wave_height / deep_length(peak_period), "Rc/H": relative, "B/H": width, "xi_op": xi}
    if depth is not None:
        ratios["H/h"] = wave_height / depth
    return Transmission(K_t=max(low, min(high, found)), ratios=ratios, branch=branch)
