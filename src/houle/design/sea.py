"""Numbers of a sea state that many formulas are written in: deep-water length, surf similarity, unit of discharge."""

from __future__ import annotations

from math import pi, sqrt

from houle.waves.dispersion import GRAVITY, wave_number


def deep_length(period: float) -> float:
    """L_0 = g T^2 / (2 pi), the length of a wave in deep water [m]."""
    return GRAVITY * period**2 / (2 * pi)


def surf_similarity(wave_height: float, period: float, cot_slope: float) -> float:
    """xi = tan(alpha) / sqrt(H / L_0) [-]."""
    return 1 / (cot_slope * sqrt(wave_height / deep_length(period)))


def number_at(period: float, depth: float) -> float:
    """Wave number of linear theory [rad/m]."""
    return float(wave_number(2 * pi / period, depth))


def discharge(wave_height: float) -> float:
    """sqrt(g H^3), by which a mean discharge per metre is made dimensionless [m3/s/m]."""
    return sqrt(GRAVITY * wave_height**3)
