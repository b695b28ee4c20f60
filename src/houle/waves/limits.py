"""The highest wave that there can be, and the numbers that tell which theory holds for a wave."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, tanh


def ursell(height: float, length: float, depth: float) -> float:
    """Ursell number H L^2 / d^3."""
    return height * length**2 / depth**3


def ursell_height(k: float) -> float:
    """Height [depths] of a wave of wave number k [rad per depth] whose Ursell number is 26; k counts as 3 at most."""
    return 26 * min(k, 3.0) ** 2 / (4 * pi**2)


def miche(length: float, depth: float) -> float:
    """Highest regular wave [m], H/L = 0.142 tanh(k d). Miche (1944), Annales des Ponts et Chaussees 114."""
    return 0.142 * length * tanh(2 * pi * depth / length)


def mccowan(depth: float) -> float:
    """Highest solitary wave as used in practice [m], H = 0.78 d. McCowan (1894), Philosophical Magazine 38."""
    return 0.78 * depth


def williams(length: float, depth: float) -> float:
    """Highest steady wave [m]: Fenton's (1990) fit, eq. (32), to the computations of Williams (1981), within 1 %.

    Its ends: H/L = 0.141 in deep water, H/d = 0.833 for the solitary wave.
    """
    r = length / depth
    above = 0.141063 * r + 0.0095721 * r**2 + 0.0077829 * r**3
    return depth * above / (1 + 0.0788340 * r + 0.0317567 * r**2 + 0.0093407 * r**3)


@dataclass(frozen=True)
class Limits:
    """kh, H/L, Ursell number [-] of a wave; highest wave by each criterion [m]; the height over the lowest [-]."""

    kh: float
    steepness: float
    ursell: float
    miche: float
    mccowan: float
    williams: float
    share: float

    @property
    def breaking(self) -> float:
        """The highest wave that is reckoned with [m]: the lowest of the three."""
        return min(self.miche, self.mccowan, self.williams)


def limits(height: float, length: float, depth: float) -> Limits:
    """The limits of a wave of this height and length in water of this depth [m]."""
    highest = miche(length, depth), mccowan(depth), williams(length, depth)
    return Limits(
        2 * pi * depth / length, height / length, ursell(height, length, depth), *highest, height / min(highest)
    )
