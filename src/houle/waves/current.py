"""Waves on a current that is uniform over the depth: the same waves, carried along.

Seen from the moving water nothing has changed: a wave of wave number k oscillates with sigma(k), in a flume that is
closed for it. Seen from the bed it has omega = sigma + k U, runs with c + U, and its energy with c_g + U. U is the
component of the current along the wave. A case names the period that a gauge sees, 2 pi / omega.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from houle.waves import dispersion
from houle.waves.linear import Linear
from houle.waves.wave import Array, Wave, WaveError

ITERATIONS, CONVERGED = 30, 1e-13


def wave_number(omega: ArrayLike, depth: float, gravity: float, current: float) -> Array:
    """Wave numbers [rad/m] of frequencies seen from the bed [rad/s]. WaveError for a wave that the current stops."""
    k = dispersion.wave_number(omega, depth, gravity, current)
    if np.isnan(k).any():
        shortest = 2 * pi / float(np.max(np.asarray(omega)[np.isnan(k)]))
        raise WaveError(
            f"waves.current = {current:g} m/s along the waves stops those of {shortest:.3g} s, whose energy runs slower"
            f" than that in {depth:g} m of water: give a weaker counter-current, or a longer period"
        )
    return k


def carried(still: Callable[[float], Wave], period: float, depth: float, gravity: float, current: float) -> Wave:
    """The wave of this period [s] on a current, seen from the bed; still(T) gives that of period T in water at rest.

    Raises WaveError for a wave that the current stops, and what still() raises.
    """
    if not current:
        return still(period)
    k = float(wave_number(2 * pi / period, depth, gravity, current))
    relative = 2 * pi / (2 * pi / period - k * current)
    wave, before = still(relative), None
    for _ in range(ITERATIONS):  # secant method for 1/T = 1/T_r + U/L(T_r)
        miss = 1 / relative + current / wave.length - 1 / period
        if abs(miss) * period < CONVERGED:
            break
        slope = -1 / relative**2 if before is None else (miss - before[1]) / (relative - before[0])
        before = (relative, miss)
        relative -= miss / slope
        wave = still(relative)
    else:
        raise WaveError(f"waves.current = {current:g} m/s: no wave of {period:g} s was found on it; a weaker current")
    if isinstance(wave, Linear):
        omega = np.array([2 * pi / period])
        wave = replace(wave, parts=replace(wave.parts, omega=omega))
    return replace(wave, period=period, celerity=wave.length / period, group_velocity=wave.group_velocity + current)


def moved(wave: Wave, current: float) -> Wave:
    """A wave without a period (solitary), carried along."""
    return replace(wave, celerity=wave.celerity + current, group_velocity=wave.group_velocity + current)
