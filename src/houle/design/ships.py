"""Waves of a ship in a channel: drawdown and return current, what comes to the bank, secondary waves.

Speeds are those through the water. Schijf (1949), 17th PIANC congress; CIRIA, CUR & CETMEF (2007), The Rock Manual,
section 4.3.4; DIPRO: Delft Hydraulics' program of bank protections.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import Annotated

from houle.design.errors import DesignError
from houle.design.formula import Answer, Choice, Input, Limit, formula, quantity
from houle.waves.dispersion import GRAVITY

Speed = Annotated[float, Input("speed of the ship through the water, V", "m/s", above=0)]
CanalArea = Annotated[float, Input("wet cross-section of the channel without the ship, A_c", "m2", above=0)]
ShipArea = Annotated[float, Input("wet cross-section of the ship amidships, A_s", "m2", above=0)]
CanalWidth = Annotated[float, Input("width of the channel at the water surface, b_w", "m", above=0)]
WaterDepth = Annotated[float, Input("depth of the channel", "m", above=0)]

KINDS = ("motor ship", "push convoy", "tug")


@dataclass(frozen=True, kw_only=True)
class LimitSpeed(Answer):
    """The speed that a ship cannot exceed by displacing water."""

    V_L: float = quantity("limit speed", "m/s")


@dataclass(frozen=True, kw_only=True)
class Drawdown(Answer):
    """Depression of the water and return current beside a ship, mean over the cross-section."""

    z: float = quantity("drawdown", "m")
    u: float = quantity("return current", "m/s")
    V_L: float = quantity("limit speed", "m/s")


@dataclass(frozen=True, kw_only=True)
class BankDrawdown(Answer):
    """Drawdown, return current and stern wave at the nearer bank."""

    z_bank: float = quantity("drawdown at the bank", "m")
    u_bank: float = quantity("return current at the bank", "m/s")
    z_max: float = quantity("height of the stern wave", "m")


@dataclass(frozen=True, kw_only=True)
class SecondaryWaves(Answer):
    """Short waves from bow and stern where they reach the bank."""

    H: float = quantity("height", "m")
    L: float = quantity("length", "m")
    T: float = quantity("period", "s")


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Root of a function between two numbers at which its signs differ."""
    from scipy.optimize import brentq  # a quarter of a second to load, and every run loads this module

    return float(brentq(function, low, high, xtol=1e-15))


def _limit(canal_area: float, ship_area: float, canal_width: float) -> float:
    if not ship_area < canal_area:
        raise DesignError(f"ship_area = {ship_area:g} must be below canal_area = {canal_area:g} [m2]")
    part = 1 - ship_area / canal_area
    froude = _root(lambda F: part - 1.5 * F ** (2 / 3) + 0.5 * F * F, 0.0, 1.0)
    return froude * sqrt(GRAVITY * canal_area / canal_width)


@formula(
    "ship-limit-speed",
    "Speed that a ship in a channel cannot exceed.",
    source="Schijf (1949)",
    status="Recomputed, met by no second source",
    holds="ship long against the width of the channel",
    example={"canal_area": 200.0, "ship_area": 30.0, "canal_width": 50.0},
)
def ship_limit_speed(*, canal_area: CanalArea, ship_area: ShipArea, canal_width: CanalWidth) -> LimitSpeed:
    """Limit speed of Schijf: 1 - As/Ac - 1.5 F^(2/3) + F^2/2 = 0, F = V_L/sqrt(g Ac/bw)."""
    return LimitSpeed(V_L=_limit(canal_area, ship_area, canal_width), ratios={"As/Ac": ship_area / canal_area})


@formula(
    "ship-drawdown",
    "Drawdown and return current of a ship in a channel, mean over the cross-section.",
    source="Schijf (1949)",
    status="Recomputed, met by no second source",
    holds="speed below the limit, ship long against the width of the channel",
    example={"speed": 3.0, "canal_area": 200.0, "ship_area": 30.0, "canal_width": 50.0},
)
def ship_drawdown(*, speed: Speed, canal_area: CanalArea, ship_area: ShipArea, canal_width: CanalWidth) -> Drawdown:
    """Drawdown z and return current u of Schijf: V Ac = (V + u)(Ac - As - bw z), z = [(V + u)^2 - V^2]/(2 g).

    Below the limit speed two currents fulfil this; the smaller is the ship's. Raises DesignError from the limit on.
    """
    limit = _limit(canal_area, ship_area, canal_width)
    if not speed < limit:
        raise DesignError(
            f"speed = {speed:g} must be below the limit speed of this ship in this channel, {limit:.4g} m/s (Schijf)"
        )

    def missing(w: float) -> float:
        z = (w * w - speed * speed) / (2 * GRAVITY)
        return w * (canal_area - ship_area - canal_width * z) - speed * canal_area

    most = sqrt((2 * GRAVITY * (canal_area - ship_area) / canal_width + speed**2) / 3)  # here the discharge is largest
    w = _root(missing, speed, most) if missing(most) > 0 else most
    ratios = {"As/Ac": ship_area / canal_area, "V/V_L": speed / limit}
    return Drawdown(z=(w * w - speed**2) / (2 * GRAVITY), u=w - speed, V_L=limit, ratios=ratios)


@formula(
    "ship-drawdown-at-bank",
    "Drawdown, return current and stern wave at the bank, from those of the cross-section.",
    source="The Rock Manual (2007), section 4.3.4",
    status="RECALLED",
    limits=(Limit("bw/Ls", 0, 1.5),),
    example={
        "drawdown": 0.31, "return_current": 0.883, "offset": 10.0, "depth": 4.0, "canal_area": 200.0,
        "canal_width": 50.0, "ship_length": 80.0,
    },
)  # fmt: skip
def ship_drawdown_at_bank(
    *,
    drawdown: Annotated[float, Input("drawdown, mean over the cross-section, z", "m", least=0)],
    return_current: Annotated[float, Input("return current, mean over the cross-section, u", "m/s", least=0)],
    offset: Annotated[float, Input("distance of the ship from the axis of the channel, y", "m", least=0)],
    depth: WaterDepth,
    canal_area: CanalArea,
    canal_width: CanalWidth,
    ship_length: Annotated[float, Input("length of the ship, L_s", "m", above=0)],
) -> BankDrawdown:
    """Drawdown at the bank z (1 + 2 A*), current u (1 + A*), stern wave 1.5 times that drawdown; A* = y h/Ac."""
    eccentricity = offset * depth / canal_area
    z_bank = drawdown * (1 + 2 * eccentricity)
    return BankDrawdown(
        z_bank=z_bank,
        u_bank=return_current * (1 + eccentricity),
        z_max=1.5 * z_bank,
        ratios={"A*": eccentricity, "bw/Ls": canal_width / ship_length},
    )


@formula(
    "ship-waves",
    "Height, length and period of the secondary waves of a ship at the bank.",
    source="DIPRO, in The Rock Manual (2007), section 4.3.4",
    status="Recomputed, met by no second source; the coefficient of motor ships counts in metres",
    limits=(Limit("F", 0, 0.8),),
    example={"speed": 4.0, "depth": 4.0, "distance": 40.0, "kind": "motor ship", "draught": 2.5},
)
def ship_waves(
    *,
    speed: Speed,
    depth: WaterDepth,
    distance: Annotated[float, Input("distance from the side of the ship, s", "m", above=0)],
    kind: Annotated[str, Choice("kind of ship", KINDS)],
    draught: Annotated[float, Input("draught of a motor ship, T_s", "m", above=0)] | None = None,
) -> SecondaryWaves:
    """Secondary waves H = a1 h (s/h)^(-1/3) F^4, F = V/sqrt(g h); L = 4.2 V^2/g, T = 5.1 V/g.

    a1 = 0.5 of a push convoy, 1.0 of a tug, 0.28 T_s^1.25 of a motor ship with its draught in metres.
    """
    if kind == "motor ship" and draught is None:
        raise DesignError("draught is missing: the waves of a motor ship grow with it [m]")
    coefficient = {"push convoy": 0.5, "tug": 1.0}.get(kind) or 0.28 * (draught or 0.0) ** 1.25
    froude = speed / sqrt(GRAVITY * depth)
    return SecondaryWaves(
        H=coefficient * depth * (distance / depth) ** (-1 / 3) * froude**4,
        L=4.2 * speed**2 / GRAVITY,
        T=5.1 * speed / GRAVITY,
        ratios={"F": froude, "s/h": distance / depth, "a1": coefficient},
        branch=kind,
    )
