"""The interface of all waves: x along the direction of travel, z upwards from the BED, a crest at x = 0, t = 0.

A theory is a class that fills `Wave` and writes `elevation`, `velocity` and `velocity_on`. To add one, write its module
in this folder, with its row of `THEORIES` at the end, as in cnoidal.py: the case file, `houle describe theories` and
the tests find it there.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.errors import CaseError
from houle.registry import Choices

Array = NDArray[np.float64]
GAMMA = 3.3  # peak enhancement of the JONSWAP spectrum when none is given


class WaveError(CaseError):
    """A theory cannot give the wave that is asked for. The message names both numbers and the cure."""


@dataclass(frozen=True)
class Components:
    """elevation = sum amplitude cos(k (x cos direction + y sin direction) - omega t + phase); arrays of one length.

    amplitude [m], omega [rad/s], k [rad/m], phase [rad], direction [rad].
    """

    amplitude: Array
    omega: Array
    k: Array
    phase: Array
    direction: Array

    @property
    def first(self) -> Components:
        """The first component alone."""
        return Components(*(part[:1] for part in (self.amplitude, self.omega, self.k, self.phase, self.direction)))

    def chosen(self, which: NDArray[np.bool_]) -> Components:
        """The components for which `which` (N,) is true."""
        parts = (self.amplitude, self.omega, self.k, self.phase, self.direction)
        return self if which.all() else Components(*(part[which] for part in parts))

    @property
    def moving(self) -> Components:
        """The components that go up and down: all but the mean, whose omega is 0."""
        return self.chosen(self.omega > 0)

    @property
    def mean(self) -> float:
        """Level about which the surface goes up and down [m], above still water."""
        still = self.omega == 0
        return float(np.sum(self.amplitude[still] * np.cos(self.phase[still])))

    @property
    def energy_period(self) -> float:
        """Energy period T_m-1,0 = m_-1/m_0 [s]; the mean does not count."""
        parts = self.moving
        energy = parts.amplitude**2
        return float(2 * pi * np.sum(energy / parts.omega) / np.sum(energy))

    def elevation(self, x: ArrayLike, t: ArrayLike, y: ArrayLike = 0.0) -> Array:
        """Elevation [m] at x, y [m] and t [s], broadcast against each other."""
        x, y, t = (np.asarray(v, dtype=float)[..., None] for v in (x, y, t))
        along = x * np.cos(self.direction) + y * np.sin(self.direction)
        return (self.amplitude * np.cos(self.k * along - self.omega * t + self.phase)).sum(-1)


@dataclass(frozen=True)
class Wave(ABC):
    """A wave over a flat bed, travelling in +x.

    name       theory                              reason     why it was chosen, one sentence, "" if the user did
    height     [m] crest to trough (Hm0 of a spectrum, crest above still water of a solitary wave or focused group)
    period     [s] (peak period of a spectrum; time in which a solitary wave passes)
    length     [m] of the wave of that period      depth      still water depth [m]
    celerity   speed of the crests [m/s] in the flume     gravity    [m/s2]
    group_velocity  speed of the energy [m/s]
    phase      [rad] added to k x - omega t
    direction  [rad] of travel, from the x axis of a tank in 3D: x of the wave is x cos + y sin of the tank
    """

    name: str
    reason: str
    height: float
    period: float
    length: float
    depth: float
    celerity: float
    group_velocity: float
    gravity: float
    phase: float
    direction: float

    @property
    def k(self) -> float:
        """Wave number [rad/m]."""
        return 2 * pi / self.length

    @property
    def omega(self) -> float:
        """Angular frequency [rad/s]."""
        return 2 * pi / self.period

    @property
    @abstractmethod
    def crest(self) -> float:
        """Highest elevation above still water [m]; of a random sea the level that it stays below in practice."""

    @abstractmethod
    def elevation(self, x: ArrayLike, t: ArrayLike) -> Array:
        """Height of the surface above still water [m] at x [m], t [s], broadcast."""

    @abstractmethod
    def velocity(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        """(u, w) [m/s] at x, z [m] (broadcast), z from the bed; above the crest the values at the crest's level."""

    @abstractmethod
    def velocity_on(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        """(u, w) [m/s], each (nx, nz), on columns x (nx,) and levels z (nz,): for a grid this is much faster."""

    def along_on(self, x: ArrayLike, z: ArrayLike, t: float) -> Array:
        """The horizontal velocity u alone, as in `velocity_on`."""
        return self.velocity_on(x, z, t)[0]

    def up_on(self, x: ArrayLike, z: ArrayLike, t: float) -> Array:
        """The vertical velocity w alone, as in `velocity_on`."""
        return self.velocity_on(x, z, t)[1]

    def components(self) -> Components | None:
        """The elevation as a sum of cosines; None for a wave that has no period (solitary)."""
        return None

    def flux(self, x: ArrayLike, t: float, nodes: int = 24) -> Array:
        """Integral of u from the bed to the surface [m2/s] at x, by Gauss-Legendre quadrature."""
        x = np.atleast_1d(np.asarray(x, dtype=float))
        points, weights = np.polynomial.legendre.leggauss(nodes)
        level = self.depth + self.elevation(x, t)
        u, _ = self.velocity(x[:, None], level[:, None] * (points + 1) / 2, t)
        return (u * weights).sum(-1) * level / 2


def ramp(t: ArrayLike, duration: float) -> Array:
    """Share of the full wave at time t [s]: half a cosine from 0 at t = 0 to 1 at t = duration, 1 if duration = 0."""
    share = np.clip(np.asarray(t, dtype=float) / duration, 0, 1) if duration > 0 else np.ones(np.shape(t))
    return 0.5 - 0.5 * np.cos(pi * share)


@dataclass(frozen=True)
class Theory:
    """A theory of regular or of single waves, as the case file and `houle describe theories` know it.

    make    (height, period, depth, gravity, phase, direction) -> Wave of a regular wave; of a single one
            (height, depth, gravity, crest, direction) -> Wave with its crest at x = `crest` [m] at t = 0; None: it
            chooses among the others
    single  true: its wave is one crest alone
    place   number by which lists are sorted
    """

    name: str
    what: str
    range: str
    source: str
    make: Callable[..., Wave] | None
    place: int
    single: bool = False


@dataclass(frozen=True)
class Kind:
    """A kind of waves that a case can have; needs, takes: keys of [waves] that it must have and that it may have."""

    name: str
    what: str
    range: str
    source: str
    needs: tuple[str, ...]
    takes: tuple[str, ...]
    place: int


THEORIES: Choices[Theory] = Choices("wave theory", package="houle.waves")
KINDS: Choices[Kind] = Choices("kind of waves", package="houle.waves")
