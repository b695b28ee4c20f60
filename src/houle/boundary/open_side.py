"""Open sides of the tank: water comes in or goes out at a velocity, with a discharge, or towards a level outside.

At every step each open side has one velocity into the tank for each of its faces. It enters the pressure system as a
flux, and the faces keep it (protocol.py); `exchange.py` lets in and takes out the very volume that it carries.

    velocity, discharge    u_in = U(t), or q(t) over the wet depth
    level                  u_in = U + sqrt(g/d) (level(t) - eta)          (Flather 1976)

The second lets long waves leave: what comes from inside with u = -sqrt(g/d) eta passes unchanged. U is that of the
case when velocity or discharge are given beside the level; else it is found: dU/dt = sqrt(g/d) (level - eta) / T, so
that in the end the level is that asked for, whatever flows. T, the response, is long beside the waves. A wave that a
relaxation zone at the side makes is part of what is outside: its elevation of the level, its velocity of U.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from houle.errors import SimulationError
from houle.flow.particles import Particles
from houle.grid import FloatArray, Grid
from houle.waves.wave import Wave, ramp

if TYPE_CHECKING:
    from houle.flow.state import Flow

NEAR = 3  # columns over which the level at the side is taken: that of one is noisy by some thousandths of the depth
CROSSINGS = 4.0  # of the tank by a long wave, the response of a level: critical damping if its other end is closed
THIN = 0.25  # of a half cell: less water at the surface belongs to the half cell below


@dataclass(frozen=True)
class Record:
    """A value against time: linear between its points, constant before and after."""

    time: FloatArray
    value: FloatArray

    def at(self, t: float) -> float:
        return float(np.interp(t, self.time, self.value))


@dataclass
class OpenSide:
    """One open side. Shapes: rows = grid.shape[1:], its faces; halves = twice as many along each axis.

    speed (rows) into the tank [m/s]; wet (halves) share of each half face that is under water; after `drive`.
    follows: U of a level [m/s]; owed: volume [m^d] that should have gone out and was not there yet.
    came, went: volume [m^d] that has come in and gone out since the start.
    long_from: end of the zone from which long waves come back that it is to let through [m]; 0: none.
    outgoing: their elevation, smoothed over the time in which they cross the zone [m].
    excess: what flows in through the zone besides its wave, per width, after `drive` [m2/s].
    shear (rows): of `speed`, what differs from its mean over the wet depth, but for the wave of a zone [m/s].
    """

    far: bool
    prescribed: dict[str, Record]
    ramp: float
    response: float
    gravity: float
    grid: Grid
    open: FloatArray  # (rows) open part of the faces
    wave: Wave | None = None
    wave_ramp: float = 0.0
    follows: float = 0.0
    owed: float = 0.0
    came: float = 0.0
    went: float = 0.0
    long_from: float = 0.0
    outgoing: float = 0.0
    excess: float = 0.0
    speed: FloatArray = field(init=False)
    wet: FloatArray = field(init=False)
    shear: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        rows = self.grid.shape[1:]
        self.speed, self.wet = np.zeros(rows), np.zeros(tuple(2 * n for n in rows))
        self.shear = np.zeros(rows)

    @classmethod
    def of(
        cls,
        far: bool,
        prescribed: dict[str, Record],
        ramp: float,
        response: float | None,
        gravity: float,
        grid: Grid,
        open_faces: FloatArray,
        water: Particles,
    ) -> OpenSide:
        """The right side of the tank if `far`, else the left one.

        prescribed  velocity [m/s], discharge [m2/s] or level [m] against time
        response    of a level [s]; None: `CROSSINGS` of the tank by a long wave
        open_faces  open part of the faces along x; water: at the start
        """
        depths = water.depths(grid)[-NEAR:] if far else water.depths(grid)[:NEAR]
        depth = max(float(np.mean(depths)), grid.spacing[-1])
        speed = math.sqrt(max(gravity, 1e-12) * depth)
        response = response or CROSSINGS * grid.size[0] / speed
        side = cls(far, prescribed, ramp, response, gravity, grid, open_faces[-1 if far else 0].copy())
        near = np.abs(water.position[:, 0] - side.x) < NEAR * grid.spacing[0]
        if near.any():
            side.follows = side.sign * float(np.average(water.velocity[near, 0], weights=water.volume[near]))
        return side

    # ---- where it is ---------------------------------------------------------------------------------------------

    @property
    def sign(self) -> float:
        """Sign of an x-velocity that comes in."""
        return -1.0 if self.far else 1.0

    @property
    def x(self) -> float:
        return self.grid.size[0] if self.far else 0.0

    @property
    def face(self) -> int:
        """Number of its faces along x."""
        return self.grid.shape[0] if self.far else 0

    @property
    def cell(self) -> int:
        return self.grid.shape[0] - 1 if self.far else 0

    @property
    def area(self) -> float:
        """Area of half a face [m^(d-1)]."""
        return float(np.prod([h / 2 for h in self.grid.spacing[1:]]))

    @property
    def state(self) -> FloatArray:
        return np.array([self.follows, self.owed, self.came, self.went, self.outgoing])

    @state.setter
    def state(self, values: FloatArray) -> None:
        self.follows, self.owed, self.came, self.went, self.outgoing = map(float, values)

    def passing(self) -> float:
        """Discharge towards larger x that what damps in front of the side is to let through, per width [m2/s]."""
        return self.sign * self.excess

    # ---- what flows ----------------------------------------------------------------------------------------------

    def drive(self, flow: Flow, dt: float) -> None:
        """Sets speed and wet for a step of dt [s] that begins at flow.time: the velocity of its middle."""
        middle, level = flow.time + dt / 2, self.level(flow)
        self.wet = self._wet(level)
        shape = (*self.speed.shape[:-1], 1)
        depth = (self._depths() if self.grid.dimension == 3 else np.array(self._depths())).reshape(shape)
        inwards = mean = self._mean(middle, depth)
        self.excess = float(np.mean(inwards * depth))
        if self.long_from > 0.0:
            self.excess -= float(np.mean(np.sqrt(self.gravity * depth))) * self._outgoing(flow, dt)
        if "level" in self.prescribed:
            inwards = inwards + self._towards_level(flow.time, dt, level, depth)
        self._carry_shear(flow, dt, float(np.mean(mean)))
        speed = inwards + self.shear
        if self.wave is not None:
            z = self.grid.axis_points(self.grid.dimension - 1)
            u = self.wave.velocity_on(np.array([self.x]), z, middle)[0][0]
            speed = speed + self.sign * float(ramp(middle, self.wave_ramp)) * u
        self.speed = np.where((self.open > 0.0) & (depth > 0.0), speed, 0.0)

    def _carry_shear(self, flow: Flow, dt: float, mean: float) -> None:
        """Shear goes out with the water at the velocity -mean [m/s], or none comes in with it.

        None in front of a relaxation zone: what it leads to the wave has no shear of its own.
        """
        if self.wave is not None:
            return
        share = -math.expm1(-abs(mean) * dt / self.grid.spacing[0])
        one_in = self.face + (-1 if self.far else 1)
        inside = self.sign * flow.velocity[0][one_in] if mean < 0.0 else 0.0
        self.shear = self._off_mean(flow, (1.0 - share) * self.shear + share * inside)

    def _off_mean(self, flow: Flow, u: FloatArray) -> FloatArray:
        """What the velocities (rows) differ from their mean over the wet depth; above the surface as just below it."""
        top = np.where(flow.active[self.cell] > 0, np.arange(u.shape[-1]), 0)
        u = np.take_along_axis(u, np.maximum.accumulate(top, axis=-1), axis=-1)
        weight = self._wet_rows() * self.open
        wet = weight.sum(axis=-1, keepdims=True)
        return np.where(wet > 0.0, u - (weight * u).sum(axis=-1, keepdims=True) / np.maximum(wet, 1e-300), 0.0)

    def _wet_rows(self) -> FloatArray:
        """Share of each face that is under water."""
        pairs = [n for row in self.speed.shape for n in (row, 2)]
        return self.wet.reshape(pairs).mean(axis=tuple(range(1, len(pairs), 2)))

    def rest(self, flow: Flow) -> None:
        """Lets water pass as it moves inside, for the first pressure; what goes out starts with its shear."""
        self.speed = self.sign * flow.velocity[0][self.face]
        self.wet = self._wet(self.level(flow))
        if self.wave is None and float(np.sum(self._wet_rows() * self.open * self.speed)) < 0.0:
            self.shear = self._off_mean(flow, self.speed)

    def level(self, flow: Flow) -> FloatArray:
        """Level of the water at the side [m], (ny,) or () in 2D; 0 where dry."""
        n = min(NEAR, self.grid.shape[0])
        columns = np.nan_to_num(flow.eta[-n:] if self.far else flow.eta[:n])
        return np.asarray(columns.mean(axis=0))

    def _wet(self, level: FloatArray) -> FloatArray:
        h = self.grid.spacing[-1] / 2
        low = np.arange(2 * self.grid.shape[-1])
        if self.grid.dimension == 3:
            level = np.repeat(level, 2)[:, None]
        return np.clip(level / h - low, 0.0, 1.0)

    def halves(self, rows: FloatArray) -> FloatArray:
        """Values of the faces at their halves."""
        for axis in range(rows.ndim):
            rows = np.repeat(rows, 2, axis=axis)
        return rows

    def _depths(self) -> FloatArray:
        """Open wet depth [m], (ny,) or () in 2D."""
        depth = (self.wet * self.halves(self.open)).sum(axis=-1) * self.grid.spacing[-1] / 2
        return depth.reshape(-1, 2).mean(axis=1) if self.grid.dimension == 3 else depth

    def _mean(self, t: float, depth: FloatArray) -> FloatArray | float:
        """U into the tank [m/s]."""
        grown = float(ramp(t, self.ramp))
        if "velocity" in self.prescribed:
            return grown * self.prescribed["velocity"].at(t)
        if "discharge" not in self.prescribed:
            return self.follows
        mean = float(depth.mean())
        if mean < self.grid.spacing[-1]:
            raise SimulationError(
                f"the open side at x = {self.x:g} m has run dry: {mean:.3g} m of water",
                place=(self.x,) + (0.0,) * (self.grid.dimension - 1),
                diagnosis="A discharge needs a depth of one cell at least; more water, or a lower floor, at the side.",
            )
        return grown * self.prescribed["discharge"].at(t) / mean

    def _outgoing(self, flow: Flow, dt: float) -> float:
        """Elevation of what comes to the zone from inside [m]: that beyond the wave and the level outside."""
        assert self.wave is not None
        first = max(0, min(round(self.long_from / self.grid.spacing[0]), self.grid.shape[0] - NEAR))
        levels = flow.eta[first : first + NEAR]
        wet = levels[np.isfinite(levels)]
        known = self.prescribed["level"].at(flow.time) if "level" in self.prescribed else self.wave.depth
        known += float(ramp(flow.time, self.wave_ramp)) * float(self.wave.elevation(self.long_from, flow.time))
        comes = float(wet.mean()) - known if wet.size else 0.0  # nothing from where all is dry
        time = self.long_from / math.sqrt(max(self.gravity, 1e-12) * self.wave.depth)
        self.outgoing += -math.expm1(-dt / time) * (comes - self.outgoing)
        return self.outgoing

    def _towards_level(self, t: float, dt: float, level: FloatArray, depth: FloatArray) -> FloatArray:
        wanted = self.prescribed["level"].at(t)
        if self.wave is not None:
            wanted += float(ramp(t, self.wave_ramp)) * float(self.wave.elevation(self.x, t))
        rate = np.sqrt(self.gravity / np.maximum(depth, self.grid.spacing[-1]))
        pull = rate * (wanted - level.reshape(depth.shape))
        if len(self.prescribed) == 1:
            self.follows += dt / self.response * float(pull.mean())
        return np.asarray(pull)

    # ---- in the pressure system ----------------------------------------------------------------------------------

    def feed(self, flow: Flow) -> None:
        """Adds the flux through the side to the right-hand side of its pressure cells."""
        flux = self.open * self.speed / self.grid.spacing[0]
        flow.work.rhs[self.cell] += np.where(flow.active[self.cell], flux, 0.0)

    def impose(self, flow: Flow) -> None:
        """Gives the faces their velocity, below and above the surface."""
        flow.velocity[0][self.face] = self.sign * self.speed
        flow.work.valid[0][self.face] = 1

    def power(self, flow: Flow) -> float:
        """Power of the pressure on what comes in, less that on what goes out, over the density [m^d m2/s3]."""
        force = np.where(flow.active[self.cell], flow.pressure[self.cell] * self.open * self.speed, 0.0)
        return float(force.sum()) * self.area * 2 ** (self.grid.dimension - 1)
