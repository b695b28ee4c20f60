"""A ship's passage as the bank of its channel sees it: drawdown, stern wave and secondary waves against time.

A section across the channel is looked at. The bow passes it at `time`, and xi = V (t - time) is the way [m] of the bow
beyond it. The sizes come from formulas (`houle.design.ships`); these say little of the shape, which is composed here:

    front     the level rises by 0.1 of the mean drawdown, falls to the drawdown at the bank while the bow passes, and
              stays there. Each of the two takes a quarter of the ship's length
    stern     it rises by the height of the stern wave, 1.5 drawdowns, with the steepest slope that such a wave has
              before it breaks, 0.15, midway when the stern passes; then it falls to still water in a quarter of the
              length. Front and stern: The Rock Manual (2007), section 4.3.4, RECALLED
    secondary waves   two groups, whose highest waves are those of the cusp lines of bow and stern. These lie at
              arcsin 1/3 behind the ship (Kelvin 1887), so that they come to a bank at the distance s when the ship is
              2 sqrt(2) s beyond. A group grows in two periods and fades in four

All pieces are half cosines. **At the bank and before it.** The bank sends waves back. A long wave that comes straight
at it with half the drawdown stands twice as high there; so the incident wave is half of the primary wave. An open side
that keeps the level of the bank's record outside sends in just this half (Flather 1976): the two ways are one. The
secondary waves are incident as the formula gives them.

The current that the ship drives along the channel goes as the drawdown does. It is normal to a section across, and does
not enter the flow there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from houle.waves.dispersion import group_velocity, wave_number
from houle.waves.linear import Linear
from houle.waves.wave import KINDS, Array, Kind, WaveError

RISE = 0.1  # rise before the bow over the mean drawdown
STEEPEST = 0.15  # slope of the stern wave, height over length
PART = 0.25  # share of the ship's length in which the level rises before the bow, falls, and falls behind the stern
CUSP = 2 * sqrt(2)  # way of the ship over the distance from it that a cusp line reaches meanwhile
GROWS, FADES = 2.0, 4.0  # periods
SAMPLES = 20  # in a period of the secondary waves
SPREAD = 1.3  # slowest waves of a group take so much longer than those of its period


@dataclass(frozen=True)
class Passage:
    """The passage of a ship, in numbers; lengths in metres.

    length    of the ship                                   speed    through the water [m/s]
    distance  from the side of the ship to the bank         time     at which the bow passes the section [s]
    mean      drawdown, mean over the cross-section         drawdown   at the bank
    stern     height of the stern wave above the drawdown   current    along the bank, positive astern [m/s]
    height, period   of the secondary waves [m], [s]
    """

    length: float
    speed: float
    distance: float
    time: float
    mean: float
    drawdown: float
    stern: float
    current: float
    height: float
    period: float

    @cached_property
    def knots(self) -> tuple[Array, Array]:
        """Ways of the bow beyond the section [m] and levels at the bank [m], between which half cosines go.

        Raises WaveError for a ship that is too short beside its stern wave.
        """
        part, rise = PART * self.length, pi / 2 * self.stern / STEEPEST
        middle = part / 2, self.length - rise / 2
        if middle[0] > middle[1]:
            raise WaveError(
                f"ship.length = {self.length:g} m: a stern wave {self.stern:.3g} m high is {rise:.3g} m long, and "
                "leaves no length for the drawdown; a slower ship, or a longer one"
            )
        way = [-1.5 * part, -0.5 * part, *middle, self.length + rise / 2, self.length + rise / 2 + part]
        top = self.stern - self.drawdown
        return np.array(way), np.array([0.0, RISE * self.mean, -self.drawdown, -self.drawdown, top, 0.0])

    @property
    def trough(self) -> tuple[float, float]:
        """Times from and to which the level at the bank is lowest [s]."""
        way = self.knots[0]
        return self.time + way[2] / self.speed, self.time + way[3] / self.speed

    @property
    def arrivals(self) -> tuple[float, float]:
        """Times at which the highest secondary waves of bow and stern come to the bank [s]."""
        bow = self.time + CUSP * self.distance / self.speed
        return bow, bow + self.length / self.speed

    @property
    def end(self) -> float:
        """Time from which the water at the bank rests again [s]."""
        return max(self.time + self.knots[0][-1] / self.speed, self.arrivals[1] + FADES * self.period)

    def primary(self, t: ArrayLike) -> Array:
        """Level at the bank above still water without secondary waves [m] at times t [s]."""
        way, level = self.knots
        xi = np.clip(self.speed * (np.asarray(t, dtype=float) - self.time), way[0], way[-1])
        i = np.clip(np.searchsorted(way, xi, side="right") - 1, 0, len(way) - 2)
        share = (xi - way[i]) / np.maximum(way[i + 1] - way[i], 1e-300)
        return np.asarray(level[i] + (level[i + 1] - level[i]) * (0.5 - 0.5 * np.cos(pi * share)))

    def secondary(self, t: ArrayLike) -> Array:
        """Elevation of the secondary waves that come to the bank [m] at times t [s]."""
        waves = np.zeros(np.shape(t))
        for arrival in self.arrivals:
            tau = (np.asarray(t, dtype=float) - arrival) / self.period
            share = np.clip(np.where(tau < 0, -tau / GROWS, tau / FADES), 0.0, 1.0)
            waves = waves + self.height / 2 * (0.5 + 0.5 * np.cos(pi * share)) * np.cos(2 * pi * tau)
        return np.asarray(waves)

    def incident(self, t: ArrayLike) -> Array:
        """Elevation of the wave that comes to the bank [m]: half of the primary wave, and the secondary ones."""
        return np.asarray(self.primary(t) / 2 + self.secondary(t))

    def along(self, t: ArrayLike) -> Array:
        """Current along the bank [m/s] at times t [s], in proportion to the fall of the level."""
        return np.asarray(self.current * np.clip(-self.primary(t) / self.drawdown, 0.0, 1.0))


def earliest(ship: Passage, way: float, depth: float, gravity: float) -> float:
    """The earliest time [s] of a passage whose waves leave a maker `way` metres before the bank after t = 0."""
    slow, fast = travel(ship, way, depth, gravity)
    front = fast - ship.knots[0][0] / ship.speed
    group = slow + GROWS * ship.period - CUSP * ship.distance / ship.speed
    return max(0.0, front, group)


def travel(ship: Passage, way: float, depth: float, gravity: float) -> tuple[float, float]:
    """Times [s] in which the slowest secondary waves and the long ones go `way` metres."""
    k = wave_number(2 * pi / ship.period, depth, gravity)
    return SPREAD * way / float(group_velocity(k, depth, gravity)), way / sqrt(gravity * depth)


def record(ship: Passage, way: float, depth: float, gravity: float) -> tuple[Array, Array]:
    """Times [s] and elevations [m] of the incident wave at a bank `way` metres behind its maker.

    The record begins so early that no wave has left the maker then: such a wave would come round from the end of the
    Fourier series.
    """
    slow, _ = travel(ship, way, depth, gravity)
    first = min(ship.time + ship.knots[0][0] / ship.speed, ship.arrivals[0] - GROWS * ship.period) - slow
    step = ship.period / SAMPLES
    time: Array = first + step * np.arange(round((ship.end - first) / step) + 2, dtype=float)
    return time, ship.incident(time)


@dataclass(frozen=True)
class ShipWave(Linear):
    """The incident wave of a passage."""

    passage: Passage

    @classmethod
    def of_passage(cls, ship: Passage, wave: Linear) -> ShipWave:
        """This wave, as that of the passage."""
        return cls(**{**vars(wave), "name": "ship", "reason": "a ship's passage, by linear dispersion"}, passage=ship)


KINDS.add(
    Kind(
        "ship",
        "Drawdown, stern wave and secondary waves of the ship in [ship], as they come to the bank of its channel.",
        "below Schijf's limit speed; linear dispersion",
        "Schijf (1949), The Rock Manual (2007) 4.3.4, DIPRO; docs/waves.md",
        needs=(),
        takes=(),
        place=8,
    )
)
