"""Stokes waves of order 2 to 5, from the coefficients of raschii: Fenton (1985), J. Waterway, Port, Coastal and Ocean
Engineering 111(2), "A fifth-order Stokes theory for steady waves".

The wave number belongs to the given period in a closed flume. Its return current is the mean of the series itself
(`steady.transport`), so that no water is pumped at any order; it agrees with Fenton's (1985) section 5 to the order.
"""

from __future__ import annotations

from functools import partial
from math import cosh, pi, sqrt

import numpy as np

from houle.waves import dispersion
from houle.waves.steady import Steady, transport
from houle.waves.wave import THEORIES, Array, Theory, WaveError

TERMS = ((1, 1), (2, 2), (3, 1), (3, 3), (4, 2), (4, 4), (5, 1), (5, 3), (5, 5))  # order in kH/2, harmonic
ITERATIONS = 60


def series(k: float, height: float, depth: float, gravity: float, order: int) -> tuple[Array, Array, float]:
    """Harmonics j = 1..order of the surface, E_j [m], and of the velocity, C_j [m/s]; the celerity [m/s].

    The velocity is sum C_j cosh(j k z) cos(j theta). The celerity is that where the mean Eulerian velocity is zero.
    """
    from raschii import StokesWave  # here: only Stokes waves need it

    wave = StokesWave(height=height, depth=depth, length=2 * pi / k, N=order, g=gravity)
    data, e = wave.data, k * height / 2
    heights, speeds = np.zeros(5), np.zeros(5)
    for power, j in TERMS:
        speeds[j - 1] += e**power * data[f"A{power}{j}"] * j
    heights[:] = (
        e + e**3 * data["B31"] - e**5 * (data["B53"] + data["B55"]),
        e**2 * data["B22"] + e**4 * data["B42"],
        -(e**3) * data["B31"] + e**5 * data["B53"],
        e**4 * data["B44"],
        e**5 * data["B55"],
    )
    return heights[:order] / k, speeds[:order] * data["C0"] * sqrt(gravity / k), float(wave.c)


def second_harmonic(height: float, length: float, depth: float) -> float:
    """Amplitude of the second harmonic over the height, by Stokes' second order (dimensionless, grows with H)."""
    k = 2 * pi / length
    return float(series(k, height, depth, 9.81, 2)[0][1]) / height


def stokes(
    height: float, period: float, depth: float, gravity: float, phase: float, direction: float, order: int = 5
) -> Steady:
    """The Stokes wave of this order, height [m] and period [s] in a closed flume. Raises WaveError if there is none."""
    omega = 2 * pi / period
    k = linear = float(dispersion.wave_number(omega, depth, gravity))
    if order * k * depth > 300:
        raise WaveError(f"stokes: kh = {k * depth:.3g} is too deep for the series: give a depth below {60 / k:.3g} m")
    for _ in range(ITERATIONS):  # omega = k c(k), c changes slowly with k
        heights, speeds, mean = series(k, height, depth, gravity, order)
        current = -transport(k, depth, heights, speeds) / depth
        celerity = mean + current
        before, k = k, k * (1 + (omega / (k * celerity) - 1) / 1.5) if celerity > 0 else -1.0
        if not linear / 4 < k < 4 * linear:
            break
        if abs(k - before) < 1e-14 * k:
            return Steady(
                name=f"stokes-{order}",
                reason="",
                height=height,
                period=period,
                length=2 * pi / k,
                depth=depth,
                celerity=omega / k,
                group_velocity=float(dispersion.group_velocity(linear, depth, gravity)),
                gravity=gravity,
                phase=phase,
                direction=direction,
                heights=heights,
                speeds=speeds,
                current=current,
            )
    kh = linear * depth
    raise WaveError(
        f"stokes-{order}: no wave of height {height:g} m and period {period:g} s in {depth:g} m of water "
        f'(kh = {kh:.3g}, cosh = {cosh(kh):.3g}): the series does not converge; use theory = "fenton"'
    )


URSELL = {"stokes-2": 10.0, "stokes-3": 20.0, "stokes-4": 30.0, "stokes-5": 40.0}  # Fenton (1985, 1990): 40 for order 5
WORDS = (
    "Power series in kH/2 to second order, closed flume.",
    "Power series in kH/2 to third order, closed flume.",
    "Power series in kH/2 to fourth order, closed flume.",
    "Power series in kH/2 to fifth order, closed flume.",
)
for order, (name, words) in enumerate(zip(URSELL, WORDS, strict=True), start=2):
    holds = f"Ursell number below {URSELL[name]:g}"
    THEORIES.add(Theory(name, words, holds, "Fenton (1985); raschii", partial(stokes, order=order), place=order))
