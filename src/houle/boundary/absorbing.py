"""The control of a paddle: it makes a wave, or absorbs waves actively, or both. Section 14 of docs/theory.md.

A wave that reaches a wall is not reflected if the wall moves as the wave would move it: away from where the wave came
from, with the velocity omega / c_0 per elevation of the wave, where c_0 is wave height over stroke in linear wave maker
theory. The paddle finds the elevation of the travelling wave in the pressure on its face (`waves.piston.Reading`),
subtracts that of the wave it makes itself, and follows the rest. In long waves this is the law u = -sqrt(g/d) eta
(Schaffer & Klopman 2000, J. Waterw. Port Coast. Ocean Eng. 126, 88); here it holds for all waves of one frequency, and
nearly so around it.

The pressure responds at once to the acceleration of the paddle, as if a mass hung on it. The law is therefore solved
together with this response: otherwise it is unstable. The last reading is one to two steps older than the middle of the
step that begins, so a line through the last readings is extrapolated to there.
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

READINGS = 4  # readings through which the line goes
TERMS = 200  # terms of the series of the pressure on an accelerated wall


class WaveCommand(Command):
    """Moves a paddle by the law of a wave, or absorbs, or both.

    law      displacement of the paddle for the wave that it makes; None: it makes none
    read     how the elevation of a travelling wave follows from the pressure on the face
    absorb   whether it gives way to waves that come back
    z        middles of the layers of cells [m]; weights: those of `read` in these layers
    answer   reading that an acceleration of the paddle of 1 m/s2 makes by itself [m / (m/s2)]
    memory   [displacement given way so far [m], velocity of giving way in this step and in the last [m/s], number of
             readings, then time [s] and reading [m] of the last `READINGS` of them]
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
        """Velocity [m/s] with which it gives way to the waves that it reads, and comes back to rest.

        s is the velocity per elevation of an absorbing wall, (27b). hung is the response of the pressure to the change
        of velocity in the step: s (reading + answer dv/kick) with v on both sides is solved for v.
        """
        m = self.memory
        s, kick = self.read.speed, tank.kick_of(dt)
        hung = s * self.answer / kick
        m[2] = m[1]
        m[1] = (hung * m[1] - paddle.water * s * self._expected_excess(tank.time + dt / 2)) / (1.0 + hung)
        velocity = m[1] - m[0] * self.read.back
        m[0] += velocity * dt
        return float(velocity)

    def notice(self, tank: Tank, paddle: Paddle) -> None:
        """Keeps the reading of this step, without the wave that it makes and the response to its own acceleration."""
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
        """Elevation of the travelling wave by the pressure on the face [m], the mean over y in 3D."""
        g, d, c = self.read.gravity, self.read.depth, paddle.column
        level = np.nan_to_num(tank.eta[c], nan=d)[..., None]
        still = g * (d - self.z)
        beyond = np.where(tank.active[c] == 1, tank.pressure[c] - still, g * (level - d))
        return float(np.mean(np.sum(self.weights * beyond, axis=-1))) / g

    def _expected_excess(self, t: float) -> float:
        """The reading [m] to be expected at the time t [s]: on the least-squares line through the last ones."""
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
    """p/rho [m2/s2] at the heights z (N,) [m] of a wall that is accelerated at 1 m/s2 into water at rest.

    At the first instant the surface has not moved and has p = 0. The series is over the modes cos k_j z of the bed.
    """
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
    return Paddle("piston", grid, rest, 1, WaveCommand(law, read, grid, absorb))


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
    """The absorber of a case: it takes the depth of the water where it stands at the start."""
    rest, way = grid.nearest_face(x), 1 if side == "left" else -1
    column = round(rest / grid.spacing[0]) + min(way, 0)
    depth = float(np.mean(water.depths(grid)[column]))
    read = reading_of(case.wave, depth, case.gravity, period)
    return Paddle(name, grid, rest, way, WaveCommand(None, read, grid, True))


BOUNDARIES.add(
    BoundaryKind(
        "piston",
        "A wall that moves: every wave along x; regular ones to second order, long and solitary ones follow the water. "
        "absorb = true absorbs the waves that come back.",
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
