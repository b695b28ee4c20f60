"""Equations (18)-(20) of the paper of 2020 (method = "jh2020"), as printed, with a warning: they measure no reflection.

    H_I = H_max + H_min,   H_R = H_max - H_min          (18)
    C_R = (H_max - H_min) / (H_max + H_min)             (19)
    C_T = H_T / H_I,   C_D = 1 - C_R - C_T              (20)  (C_T is printed C_R)

They are right with H_max and H_min the largest and the smallest wave height along the envelope of a partial standing
wave. The paper's table 1 puts levels above the bed in their place, of a crest (A) and of a trough (B).
"""

from __future__ import annotations

from dataclasses import dataclass

from houle.analysis.errors import AnalysisError

WARNING = (
    "eqs (18)-(20) of the paper with levels above the bed, as in its table 1: C_R is then about the local wave "
    "height over twice the depth, not a reflection coefficient. It changes with the datum (measured from the still "
    "water level it is meaningless), H_I is about twice the depth, and C_D lacks the squares of an energy balance. "
    "Use it to compare with the printed numbers only; separate the waves (zelt-skjelbreia) to know the reflection."
)


@dataclass(frozen=True)
class Jh2020:
    """The paper's numbers; C_T and C_D are NaN without a transmitted height."""

    H_I: float
    H_R: float
    C_R: float
    C_T: float
    C_D: float
    warning: str = WARNING

    def __str__(self) -> str:
        return (
            f"jh2020: C_R {self.C_R:.3f}, C_T {self.C_T:.3f}, C_D {self.C_D:.3f} (H_I {self.H_I:.3f} m, H_R "
            f"{self.H_R:.3f} m)\n"
            f"warning: {self.warning}"
        )


def jh2020(highest: float, lowest: float, transmitted: float = float("nan")) -> Jh2020:
    """The paper's coefficients from H_max, H_min (there the levels A_e, B_e above the bed) and H_T [m].

    Raises AnalysisError unless 0 < lowest <= highest.
    """
    if not 0 < lowest <= highest:
        raise AnalysisError(f"highest = {highest:g} m, lowest = {lowest:g} m: 0 < lowest <= highest is needed")
    H_I, H_R = highest + lowest, highest - lowest
    C_R, C_T = H_R / H_I, transmitted / H_I
    return Jh2020(H_I, H_R, C_R, C_T, 1.0 - C_R - C_T)
