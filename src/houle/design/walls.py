"""Pressures of waves on vertical walls: Goda with and without Takahashi's impulsive pressure, Sainflou.

Goda's pressure is a trapezoid: p3 at the foot of the wall, p1 at still water, p4 at the top of the wall, 0 at eta*
above still water; under the wall a triangle of uplift from pu at the front edge. The wall ends h_c above still water,
its foot is h' below, d is the depth above the armour of the berm, h that in front of the berm, h_b that five
significant heights seaward. Goda (2000), Random Seas and Design of Maritime Structures, chapter 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, cosh, pi, sinh, sqrt, tanh
from typing import Annotated

from houle.design.formula import Answer, Input, formula, quantity
from houle.design.inputs import Density, Obliquity
from houle.design.sea import number_at
from houle.waves.dispersion import GRAVITY

HighestWave = Annotated[float, Input("highest wave H_max, 1.8 H_1/3 where waves do not break", "m", above=0)]
WallPeriod = Annotated[float, Input("significant period T_1/3", "s", above=0)]
FrontDepth = Annotated[float, Input("depth in front of the berm, h", "m", above=0)]
BermDepth = Annotated[float, Input("depth above the armour of the berm, d", "m", above=0)]
FootDepth = Annotated[float, Input("foot of the wall below still water, h'", "m", above=0)]
WallCrest = Annotated[float, Input("top of the wall above still water, h_c", "m", above=0)]
SeawardDepth = Annotated[float, Input("depth 5 H_1/3 seaward of the wall, h_b", "m", above=0)]


@dataclass(frozen=True, kw_only=True)
class WallPressure(Answer):
    """Pressures of the highest wave on a vertical wall, and what they add up to, per metre of wall."""

    F: float = quantity("horizontal force", "N/m")
    M: float = quantity("moment of the horizontal force about the foot", "N")
    p1: float = quantity("pressure at still water", "Pa")
    p3: float = quantity("pressure at the foot of the wall", "Pa")
    p4: float = quantity("pressure at the top of the wall", "Pa")
    pu: float = quantity("uplift at the front edge", "Pa")
    eta: float = quantity("level above still water to which pressure reaches, eta*", "m")


@dataclass(frozen=True, kw_only=True)
class StandingPressure(Answer):
    """Pressure of a standing wave at a vertical wall."""

    p_bed: float = quantity("pressure at the bed under the crest, above still water's", "Pa")
    h0: float = quantity("rise of the mean level at the wall", "m")
    length: float = quantity("length of the wave", "m")


@formula(
    "wall-goda",
    "Pressures and force of the highest wave on a vertical wall, pulsating waves.",
    source="Goda (1974, 2000)",
    status="Met by the Deltares toolbox",
    holds="waves that do not break against the wall",
    example={
        "wave_height": 5.8, "period": 8.0, "depth": 5.0, "depth_on_berm": 4.0, "foot": 6.0, "crest": 5.0,
        "depth_seaward": 5.305, "density": 1025.0,
    },
)  # fmt: skip
def wall_goda(
    *,
    wave_height: HighestWave,
    period: WallPeriod,
    depth: FrontDepth,
    depth_on_berm: BermDepth,
    foot: FootDepth,
    crest: WallCrest,
    depth_seaward: SeawardDepth,
    obliquity: Obliquity = 0.0,
    density: Density = 1000.0,
) -> WallPressure:
    """Wave pressures of Goda: p1 = (1 + cos b)/2 (a1 + a2 cos^2 b) rho g Hmax, p3 = a3 p1, p4 = p1 (1 - hc/eta*).

    eta* = 0.75 (1 + cos b) Hmax, pu = (1 + cos b)/2 a1 a3 rho g Hmax, a1 = 0.6 + [2kh/sinh 2kh]^2/2,
    a2 = min{(hb - d)/(3 hb) (Hmax/d)^2, 2d/Hmax}, a3 = 1 - h'/h (1 - 1/cosh kh). The angle b is that of the formula:
    Goda takes 15 degrees off the angle between the waves and the normal, as their direction is not sure.
    """
    a2 = _alpha_2(wave_height, depth_on_berm, depth_seaward)
    return _goda(wave_height, period, depth, foot, crest, obliquity, density, a2, {"alpha_2": a2}, "")


@formula(
    "wall-takahashi",
    "Pressures and force of the highest wave on a vertical wall on a high berm, on which waves break.",
    source="Takahashi, Tanimoto & Shimosako (1994), with Goda (2000)",
    status="Met by the example in Goda (2000), p. 140",
    holds="caissons on a rubble mound",
    example={
        "wave_height": 8.05, "period": 11.4, "depth": 10.1, "depth_on_berm": 5.6, "foot": 7.1, "crest": 3.4,
        "depth_seaward": 10.1, "berm_width": 8.0, "obliquity": 0.2617993877991494, "density": 1030.0,
    },
)  # fmt: skip
def wall_takahashi(
    *,
    wave_height: HighestWave,
    period: WallPeriod,
    depth: FrontDepth,
    depth_on_berm: BermDepth,
    foot: FootDepth,
    crest: WallCrest,
    depth_seaward: SeawardDepth,
    berm_width: Annotated[float, Input("width of the berm in front of the wall, B_M", "m", least=0)],
    obliquity: Obliquity = 0.0,
    density: Density = 1000.0,
) -> WallPressure:
    """Wave pressures of Goda with the impulsive coefficient: a* = max(a2, aI) stands in the place of a2.

    aI = aI0 aI1, aI0 = min(Hmax/d, 2), aI1 = cos d2/cosh d1 for d2 <= 0, else 1/(cosh d1 sqrt(cosh d2));
    d1 = 20 d11 (d11 <= 0) or 15 d11, d2 = 4.9 d22 (d22 <= 0) or 3 d22,
    d11 = 0.93 (BM/L - 0.12) + 0.36 ((h - d)/h - 0.6), d22 = -0.36 (BM/L - 0.12) + 0.93 ((h - d)/h - 0.6).
    """
    length = 2 * pi / number_at(period, depth)
    pulsating = _alpha_2(wave_height, depth_on_berm, depth_seaward)
    impulsive = impulsive_coefficient(wave_height, depth, depth_on_berm, berm_width, length)
    ratios = {"alpha_2": pulsating, "alpha_I": impulsive, "BM/L": berm_width / length}
    branch = "impulsive pressure" if impulsive > pulsating else "no impulsive pressure: that of Goda"
    largest = max(pulsating, impulsive)
    return _goda(wave_height, period, depth, foot, crest, obliquity, density, largest, ratios, branch)


def impulsive_coefficient(wave_height: float, depth: float, on_berm: float, berm_width: float, length: float) -> float:
    """alpha_I of Takahashi et al. (1994)."""
    width, height = berm_width / length - 0.12, (depth - on_berm) / depth - 0.6
    d11, d22 = 0.93 * width + 0.36 * height, -0.36 * width + 0.93 * height
    d1, d2 = (20 if d11 <= 0 else 15) * d11, (4.9 if d22 <= 0 else 3) * d22
    shape = cos(d2) / cosh(d1) if d2 <= 0 else 1 / (cosh(d1) * sqrt(cosh(d2)))
    return min(wave_height / on_berm, 2.0) * shape


def _alpha_2(wave_height: float, on_berm: float, seaward: float) -> float:
    return min((seaward - on_berm) / (3 * seaward) * (wave_height / on_berm) ** 2, 2 * on_berm / wave_height)


def _goda(
    wave_height: float,
    period: float,
    depth: float,
    foot: float,
    crest: float,
    angle: float,
    density: float,
    a2: float,
    ratios: dict[str, float],
    branch: str,
) -> WallPressure:
    """The trapezoid of pressures and its sums, for a coefficient alpha_2 or alpha*."""
    kh, c = number_at(period, depth) * depth, cos(angle)
    a1 = 0.6 + 0.5 * (2 * kh / sinh(2 * kh)) ** 2 if kh < 300 else 0.6
    a3 = 1 - foot / depth * (1 - 1 / cosh(min(kh, 700.0)))
    head = 0.5 * (1 + c) * density * GRAVITY * wave_height
    eta, p1 = 0.75 * (1 + c) * wave_height, head * (a1 + a2 * c * c)
    p3, p4, pu = a3 * p1, p1 * max(0.0, 1 - crest / eta), head * a1 * a3
    top = min(eta, crest)  # the wall is pressed up to here
    moment = (p3 + 2 * p1) * foot**2 / 6 + (p1 + p4) * foot * top / 2 + (p1 + 2 * p4) * top**2 / 6
    return WallPressure(
        F=0.5 * (p1 + p3) * foot + 0.5 * (p1 + p4) * top,
        M=moment,
        p1=p1,
        p3=p3,
        p4=p4,
        pu=pu,
        eta=eta,
        ratios={"alpha_1": a1, **ratios, "alpha_3": a3},
        branch=branch,
    )


@formula(
    "wall-sainflou",
    "Pressure of a standing wave at the bed of a vertical wall, and the rise of the mean level.",
    source="Sainflou (1928)",
    status="RECALLED",
    holds="standing waves that do not break, wall down to the bed",
    example={"wave_height": 2.0, "period": 8.0, "depth": 8.0},
)
def wall_sainflou(
    *,
    wave_height: Annotated[float, Input("height of the incident wave", "m", above=0)],
    period: Annotated[float, Input("period", "s", above=0)],
    depth: FrontDepth,
    density: Density = 1000.0,
) -> StandingPressure:
    """Standing wave of Sainflou at a wall: h0 = pi H^2/L coth kh, pressure at the bed rho g H/cosh kh."""
    k = number_at(period, depth)
    kh, length = k * depth, 2 * pi / k
    bed = density * GRAVITY * wave_height / cosh(min(kh, 700.0))
    rise = pi * wave_height**2 / length / tanh(kh)
    return StandingPressure(p_bed=bed, h0=rise, length=length, ratios={"kh": kh, "H/h": wave_height / depth})
