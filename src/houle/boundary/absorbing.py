"""What moves a paddle: the law of the wave it makes, and active absorption of what comes back.

A wave that reaches a wall is not sent back if the wall moves as the wave itself would move it: with the velocity
omega / c_0 per elevation of the wave, c_0 of linear wave maker theory, away from where the wave came from. The paddle
finds the elevation of the travelling wave in the pressure on its face (`waves.piston.Reading`), takes off what its own
wave gives, and follows the rest: the law u = -sqrt(g/d) eta of long waves (Schaffer & Klopman 2000, J. Waterw. Port
Coast. Ocean Eng. 126, 88), right for all waves of one frequency and nearly so around it.

The pressure answers at once to the acceleration of the paddle: the law is therefore solved together with that answer,
as for a mass that hangs on the paddle. What it reads is older than the step that begins by one to two steps: the line
through the last readings goes on to the middle of the step.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi

import numpy as np

from houle.boundary.paddle import Command, Paddle
from houle.flow.boundaries import BOUNDARIES, BoundaryKind, Surroundings, Tank
from houle.flow.component import State
from houle.flow.particles import Particles
from houle.grid import FloatArray, Grid
from houle.medium.medium import Medium
from houle.waves.piston import Law, Reading, reading_of

READINGS = 4  # through which the line goes
TERMS = 200  # of the pressure on an accelerated wall


class Drive(Command):
    """Moves a paddle by a law, or absorbs, or both.

    memory  [way given so far, velocity of giving in this step and in the last, count of readings, (time, reading) ...]
    """

    def __init__(self, law: Law | None, read: Reading, grid: Grid, absorb: bool) -> None:
        self.law, self.read, self.absorb = law, read, absorb
        self.z = grid.axis_points(grid.dimension - 1)
        self.weights = read.weights(self.z, grid.spacing[-1])
        self.answer = float(np.sum(self.weights * pushed(self.z, read.depth))) / read.gravity
        self.memory = np.zeros(4 + 2 * READINGS)

    def way(self, tank: Tank, paddle: Paddle, dt: float) -> float:
        offset = paddle.x - paddle.rest
        way = self.law.way(tank.time, dt, offset) if self.law is not None else 0.0
        return way + dt * self._give(tank, paddle, dt) if self.absorb else way

    def _give(self, tank: Tank, paddle: Paddle, dt: float) -> float:
        """Velocity [m/s] with which it gives way to what it reads, and comes back."""
        m = self.memory
        s, kick = self.read.speed, tank.kick_of(dt)
        hung = s * self.answer / kick
        m[2] = m[1]
        m[1] = (hung * m[1] - paddle.water * s * self._expected_excess(tank.time + dt / 2)) / (1.0 + hung)
        velocity = m[1] - m[0] * self.read.back
        m[0] += velocity * dt
        return float(velocity)

    def notice(self, tank: Tank, paddle: Paddle) -> None:
        if not self.absorb:
            return
        m, made = self.memory, 0.0
        if self.law is not None:
            made = self.law.expected(tank.time, paddle.x - paddle.rest, self.read)
        moved = paddle.water * self.answer * (m[1] - m[2]) / tank.kick
        m[4:-2] = m[6:]
        m[-2:] = tank.time, self.elevation(tank, paddle) - made - moved
        m[3] = min(m[3] + 1, READINGS)

    def elevation(self, tank: Tank, paddle: Paddle) -> float:
        """Elevation of the travelling wave in the pressure on the face [m]."""
        g, d, c = self.read.gravity, self.read.depth, paddle.column
        level = np.nan_to_num(tank.eta[c], nan=d)[..., None]
        still = g * (d - self.z)
        beyond = np.where(tank.active[c] == 1, tank.pressure[c] - still, g * (level - d))
        return float(np.mean(np.sum(self.weights * beyond, axis=-1))) / g

    def _expected_excess(self, t: float) -> float:
        """The reading at time t [s], on the line through the last ones."""
        count = int(self.memory[3])
        if count == 0:
            return 0.0
        time, value = self.memory[4:].reshape(READINGS, 2)[READINGS - count :].T
        mean = time.mean()
        spread = float(np.sum((time - mean) ** 2))
        slope = float(np.sum((time - mean) * value)) / spread if spread > 0.0 else 0.0
        return float(value.mean() + slope * (t - mean))

    def state(self) -> State:
        return {"memory": self.memory.copy()}

    def restore(self, state: Mapping[str, FloatArray]) -> None:
        self.memory[...] = state["memory"]


def pushed(z: FloatArray, depth: float) -> FloatArray:
    """p/rho [m2/s2] on a wall that is accelerated at 1 m/s2 into water at rest: the surface stays, p = 0 there."""
    k = (np.arange(TERMS) + 0.5) * pi / depth
    terms = 2 / (depth * k**2) * np.where(np.arange(TERMS) % 2, -1.0, 1.0)
    return np.where(z < depth, np.cos(np.outer(z, k)) @ terms, 0.0)


def _piston(
    case: Surroundings,
    grid: Grid,
    medium: Medium,
    water: Particles,
    *,
    rest: float,
    law: Law,
    read: Reading,
    absorb: bool,
) -> Paddle:
    return Paddle("piston", grid, rest, 1, Drive(law, read, grid, absorb))


def _absorber(
    case: Surroundings,
    grid: Grid,
    medium: Medium,
    water: Particles,
    *,
    name: str,
    x: float,
    side: str,
    period: float | None,
) -> Paddle:
    """It absorbs by the depth of the water where it stands."""
    rest, way = grid.nearest_face(x), 1 if side == "left" else -1
    column = round(rest / grid.spacing[0]) + min(way, 0)
    depth = float(np.mean(water.depths(grid)[column]))
    read = reading_of(case.wave, depth, case.gravity, period)
    return Paddle(name, grid, rest, way, Drive(None, read, grid, True))


BOUNDARIES.add(
    BoundaryKind(
        "piston",
        "A wall that moves: every wave along x; regular ones to second order, long and solitary ones follow the water. "
        "absorb = true takes up what comes back.",
        "Biesel & Suquet (1951); Schaffer (1996); Goring (1979)",
        _piston,
        place=1,
    )
)
BOUNDARIES.add(
    BoundaryKind(
        "absorber",
        "A wall that moves with the waves that reach it: active absorption at an end of the water.",
        "Schaffer & Klopman (2000); pressure on the face, docs/theory.md, section 14",
        _absorber,
        place=2,
    )
)
