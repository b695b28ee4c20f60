"""Share of the waves that overtop a crest, from the run-up that 2 % of them would reach."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log
from typing import Annotated

from houle.design.formula import Answer, Input, Limit, formula, quantity
from houle.design.inputs import Freeboard

#: R_2%/H_m0 of an upright wall, at which the formula is that of Franco et al. (1994), P = exp[-(Rc/(0.91 Hm0))^2]
AT_A_WALL = 0.91 * log(50) ** 0.5


@dataclass(frozen=True, kw_only=True)
class OvertoppingShare(Answer):
    """Share of the waves that overtop by a formula."""

    P: float = quantity("share of the incident waves that overtop", "-")


@formula(
    "overtopping-share",
    "Share of the waves that overtop a crest: run-up heights that are distributed as Rayleigh says.",
    source="EurOtop (2018), chapters 5 and 6; walls: Franco, de Gerloni & Van der Meer (1994)",
    status="RECALLED",
    limits=(Limit("Rc/R2%", 0, 2),),
    holds="crest above still water",
    example={"freeboard": 3.0, "run_up": 4.0},
)
def overtopping_share(
    *,
    freeboard: Freeboard,
    run_up: Annotated[float, Input("run-up R_2% on the slope if it were higher; 1.8 H_m0 of a wall", "m", above=0)],
) -> OvertoppingShare:
    """Share of the waves that overtop, P = exp[-ln 50 (Rc/R2%)^2]: 2 % where the crest is as high as R2%."""
    relative = freeboard / run_up
    return OvertoppingShare(P=exp(-log(50) * relative**2), ratios={"Rc/R2%": relative})
