"""Open sides of the tank: water enters or leaves at a velocity, with a discharge, or towards a level outside.

In each step an open side gives every one of its faces a velocity into the tank, (30) in docs/theory.md. It enters the
pressure system as a flux, and the faces keep it after the projection. Exactly the volume that it carries is let in or
taken out, particle by particle.

    velocity, discharge    u_in = U(t), or q(t) over the wet depth
    level                  u_in = U + sqrt(g/d) (level(t) - eta)          (Flather 1976)

d is the wet depth and eta the level of the water at the side. The second form lets long waves leave: one that comes
from inside with u = -sqrt(g/d) eta passes unchanged. Where the case gives a velocity or a discharge beside the level, U
is that. Otherwise it is found from dU/dt = sqrt(g/d) (level - eta) / T, (31), so that in the end the water has the
level that is asked for, whatever flows. T, the response, is long beside the period of the waves. If a relaxation zone
at the side makes a wave, the wave belongs to the outside: its elevation is added to the level, its velocity to U.

Sponges and zones in front of a side, in its half of the tank, would hold up the flow through it. So the side pushes the
water there by + sigma U, where sigma is their damping: they then lead the water towards the flow through the side
instead of to rest. This flow is the current and the long waves that leave, without the wave that a zone makes.

**Particles.** Inside the tank, next to each half face of a side, lies a row of particles. The water that enters through
the half face in a step is a thin slice: it joins the first particle of the row until that is full, with the water of a
half cell; then a new particle begins. The water that leaves is a slice as well, taken from the first particles of the
row; a particle without water is removed. So the particles next to the side grow or shrink with the flow, and neither
volume nor level jumps when one passes. A particle stands for the water between its two ends, and lies at their middle.
Water that ought to leave but is not within a cell of the side is owed, and taken in later steps.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from houle.data.history import Record
from houle.errors import CaseError, SimulationError
from houle.flow.boundaries import BOUNDARIES, Boundaries, Boundary, BoundaryKind, Surroundings, Tank
from houle.flow.component import State
from houle.flow.particles import Particles
from houle.grid import Faces, FloatArray, Grid
from houle.medium.medium import Medium
from houle.waves.wave import Wave, ramp

NEAR = 3  # columns over which the level at the side is averaged: one column is noisy by thousandths of the depth
CROSSINGS = 4.0  # times that a long wave crosses the tank in the response: critical damping if the other end is closed
THIN = 0.25  # share of a half face: less water at the surface is counted with the half face below
SPARE = 1e-3  # share by which a particle may be overfull, so that slow water makes no tiny particles
EDGE = 1e-6  # cells: a particle so near to the side was stopped by it
KEPT = ("follows", "owed", "came", "went", "outgoing")  # numbers in the state of a side


@dataclass(eq=False)
class OpenSide(Boundary):
    """One open side of the tank.

    Shapes: rows = grid.shape[1:], the faces of the side; halves = twice as many along each axis, its half faces.

    far         True for the right side, False for the left one
    prescribed  "velocity" [m/s], "discharge" [m2/s], "level" [m], as far as given: records against time
    ramp        time in which velocity and discharge grow from nothing [s]
    response    T of a level that is given alone [s]
    open        (rows) open area fraction of the faces
    wave        the wave of a relaxation zone at the side, None without; wave_ramp: time in which it grows [s]
    follows     U where a level is given alone [m/s]
    owed        volume that should have gone out and was not there yet [m^d]
    came, went  volume that has come in and gone out since the start [m^d]
    long_from   inner end of a zone through which long waves from inside are let pass [m]; 0: none are
    outgoing    elevation of these waves, smoothed over the time in which they cross the zone [m]
    excess      discharge per width into the tank without that of the wave of the zone [m2/s], set by `drive`
    speed       (rows) velocity into the tank [m/s], set by `drive`
    wet         (halves) share of each half face that is under water, set by `drive`
    shear       (rows) difference of `speed`, without the wave of a zone, from its mean over the wet depth [m/s]
    damped      damping of the faces along x in its half of the tank [1/s]; None without any
    depths      depth of the water at these faces at the start [m], (nx + 1, [ny])
    """

    far: bool
    prescribed: dict[str, Record]
    ramp: float
    response: float
    gravity: float
    grid: Grid
    open: FloatArray
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
    work: ClassVar[Literal["source_work", "open_work"]] = "open_work"

    def __post_init__(self) -> None:
        rows = self.grid.shape[1:]
        self.speed, self.wet = np.zeros(rows), np.zeros(tuple(2 * n for n in rows))
        self.shear = np.zeros(rows)
        self.name = f"the open {'right' if self.far else 'left'} side"
        self.damped: FloatArray | None = None
        self.depths = np.zeros(0)

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
        """The right side of the tank if `far`, else the left one; U starts as the velocity of the water near it.

        response    [s]; None: the time of `CROSSINGS` crossings of the tank by a long wave
        gravity     downwards [m/s2]
        open_faces  open area fraction of all faces along x
        water       particles at the start
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
        """Sign of the x-component of a velocity into the tank."""
        return -1.0 if self.far else 1.0

    @property
    def x(self) -> float:
        """Position of the side [m]."""
        return self.grid.size[0] if self.far else 0.0

    @property
    def face(self) -> int:
        """Number along x of the faces of the side."""
        return self.grid.shape[0] if self.far else 0

    @property
    def cell(self) -> int:
        """Number along x of the cells at the side."""
        return self.grid.shape[0] - 1 if self.far else 0

    @property
    def area(self) -> float:
        """Area of a half face [m^(d-1)]: of a half in 2D, of a quarter in 3D."""
        return float(np.prod([h / 2 for h in self.grid.spacing[1:]]))

    def join(self, tank: Tank, boundaries: Boundaries) -> None:
        """Takes the damping in front of it. CaseError where it is behind a wall, given twice, or near a gate."""
        h = self.grid.spacing[0]
        for other in boundaries:
            if isinstance(other, OpenSide) and other is not self and other.far == self.far:
                raise CaseError(f"{self.name} is given twice: put both into one table")
            for _, water in other.images():
                if water == self.sign:
                    raise CaseError(f"{self.name} is behind {other.name}, where no water is: remove one")
            for x, _ in other.gates():
                if abs(x - self.x) < NEAR * h:
                    raise CaseError(
                        f"{other.name} at x = {x:g} m stands in the {NEAR} columns, {NEAR * h:.3g} m, over which "
                        f"{self.name} reads its level: move it inwards"
                    )
        if boundaries.damping:
            middle = (self.grid.shape[0] + 1) // 2
            self.damped = boundaries.damping[0].copy()
            self.damped[slice(None, middle) if self.far else slice(middle, None)] = 0.0
            depths = tank.particles.depths(self.grid)
            padded = np.concatenate([depths[:1], depths, depths[-1:]])
            self.depths = np.maximum(0.5 * (padded[:-1] + padded[1:]), self.grid.spacing[-1])

    def touches(self) -> dict[int, slice]:
        return {} if self.damped is None else {0: slice(0, len(self.damped))}

    def push(self, t: float, acceleration: Faces) -> None:
        """Pushes the damped water in front of it towards the flow through it, by sigma U with U = excess / depth."""
        if self.damped is not None:
            acceleration[0] += self.damped * (self.sign * self.excess / self.depths)[..., None]

    # ---- what flows ----------------------------------------------------------------------------------------------

    def drive(self, tank: Tank, dt: float) -> None:
        """Sets speed, wet, excess and shear for a step of dt [s] that begins at tank.time: those of its middle."""
        middle, level = tank.time + dt / 2, self.level(tank)
        self.wet = self._wet(level)
        shape = (*self.speed.shape[:-1], 1)
        depth = (self._depths() if self.grid.dimension == 3 else np.array(self._depths())).reshape(shape)
        inwards = mean = self._mean(middle, depth)
        self.excess = float(np.mean(inwards * depth))
        if self.long_from > 0.0:
            self.excess -= float(np.mean(np.sqrt(self.gravity * depth))) * self._outgoing(tank, dt)
        if "level" in self.prescribed:
            inwards = inwards + self._towards_level(tank.time, dt, level, depth)
        self._carry_shear(tank, dt, float(np.mean(mean)))
        speed = inwards + self.shear
        if self.wave is not None:
            z = self.grid.axis_points(self.grid.dimension - 1)
            u = self.wave.velocity_on(np.array([self.x]), z, middle)[0][0]
            speed = speed + self.sign * float(ramp(middle, self.wave_ramp)) * u
        self.speed = np.where((self.open > 0.0) & (depth > 0.0), speed, 0.0)

    def _carry_shear(self, tank: Tank, dt: float, mean: float) -> None:
        """Advances the shear by (32): it leaves with the water, and water that enters has none.

        mean: U into the tank [m/s]. A side with a relaxation zone has no shear: the zone leads the flow to the wave.
        """
        if self.wave is not None:
            return
        share = -math.expm1(-abs(mean) * dt / self.grid.spacing[0])
        one_in = self.face + (-1 if self.far else 1)
        inside = self.sign * tank.velocity[0][one_in] if mean < 0.0 else 0.0
        self.shear = self._off_mean(tank, (1.0 - share) * self.shear + share * inside)

    def _off_mean(self, tank: Tank, u: FloatArray) -> FloatArray:
        """Differences of velocities (rows) from their mean over the wet depth; above the surface as just below it."""
        top = np.where(tank.active[self.cell] > 0, np.arange(u.shape[-1]), 0)
        u = np.take_along_axis(u, np.maximum.accumulate(top, axis=-1), axis=-1)
        weight = self._wet_rows() * self.open
        wet = weight.sum(axis=-1, keepdims=True)
        return np.where(wet > 0.0, u - (weight * u).sum(axis=-1, keepdims=True) / np.maximum(wet, 1e-300), 0.0)

    def _wet_rows(self) -> FloatArray:
        """Share of each face that is under water (rows)."""
        pairs = [n for row in self.speed.shape for n in (row, 2)]
        return self.wet.reshape(pairs).mean(axis=tuple(range(1, len(pairs), 2)))

    def prepare(self, tank: Tank) -> None:
        """Lets water pass as it moves inside, for the first pressure; if it flows out, with its shear."""
        self.speed = self.sign * tank.velocity[0][self.face]
        self.wet = self._wet(self.level(tank))
        if self.wave is None and float(np.sum(self._wet_rows() * self.open * self.speed)) < 0.0:
            self.shear = self._off_mean(tank, self.speed)

    def level(self, tank: Tank) -> FloatArray:
        """Level of the water at the side [m], (ny,) or () in 2D; 0 where dry."""
        n = min(NEAR, self.grid.shape[0])
        columns = np.nan_to_num(tank.eta[-n:] if self.far else tank.eta[:n])
        return np.asarray(columns.mean(axis=0))

    def _wet(self, level: FloatArray) -> FloatArray:
        """Share of each half face that is under water with this level [m] (halves)."""
        h = self.grid.spacing[-1] / 2
        low = np.arange(2 * self.grid.shape[-1])
        if self.grid.dimension == 3:
            level = np.repeat(level, 2)[:, None]
        return np.clip(level / h - low, 0.0, 1.0)

    def halves(self, rows: FloatArray) -> FloatArray:
        """Values (rows) of the faces, repeated on their half faces (halves)."""
        for axis in range(rows.ndim):
            rows = np.repeat(rows, 2, axis=axis)
        return rows

    def _depths(self) -> FloatArray:
        """Depth of the open wet part of the side [m], (ny,) or () in 2D."""
        depth = (self.wet * self.halves(self.open)).sum(axis=-1) * self.grid.spacing[-1] / 2
        return depth.reshape(-1, 2).mean(axis=1) if self.grid.dimension == 3 else depth

    def _mean(self, t: float, depth: FloatArray) -> FloatArray | float:
        """U at the time t [s], into the tank [m/s]; depth: of the open wet part [m]."""
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

    def _outgoing(self, tank: Tank, dt: float) -> float:
        """Elevation [m] of long waves that come to the zone from inside, smoothed: `outgoing` after a step of dt [s].

        It is the level at the end of the zone less that of the outside and of the wave.
        """
        assert self.wave is not None
        first = max(0, min(round(self.long_from / self.grid.spacing[0]), self.grid.shape[0] - NEAR))
        levels = tank.eta[first : first + NEAR]
        wet = levels[np.isfinite(levels)]
        known = self.prescribed["level"].at(tank.time) if "level" in self.prescribed else self.wave.depth
        known += float(ramp(tank.time, self.wave_ramp)) * float(self.wave.elevation(self.long_from, tank.time))
        comes = float(wet.mean()) - known if wet.size else 0.0  # nothing from where all is dry
        time = self.long_from / math.sqrt(max(self.gravity, 1e-12) * self.wave.depth)
        self.outgoing += -math.expm1(-dt / time) * (comes - self.outgoing)
        return self.outgoing

    def _towards_level(self, t: float, dt: float, level: FloatArray, depth: FloatArray) -> FloatArray:
        """sqrt(g/d) (level outside - level) [m/s] of (30); where only a level is given, U follows (31) over dt [s]."""
        wanted = self.prescribed["level"].at(t)
        if self.wave is not None:
            wanted += float(ramp(t, self.wave_ramp)) * float(self.wave.elevation(self.x, t))
        rate = np.sqrt(self.gravity / np.maximum(depth, self.grid.spacing[-1]))
        pull = rate * (wanted - level.reshape(depth.shape))
        if len(self.prescribed) == 1:
            self.follows += dt / self.response * float(pull.mean())
        return np.asarray(pull)

    # ---- in the pressure system ----------------------------------------------------------------------------------

    def feed(self, tank: Tank) -> None:
        """Adds the flux through the side to the right-hand side of its pressure cells."""
        flux = self.open * self.speed / self.grid.spacing[0]
        tank.work.rhs[self.cell] += np.where(tank.active[self.cell], flux, 0.0)

    def impose(self, tank: Tank) -> None:
        """Gives the faces their velocity, below the surface and above it."""
        tank.velocity[0][self.face] = self.sign * self.speed
        tank.work.valid[0][self.face] = 1

    def power(self, tank: Tank) -> float:
        """Power of the pressure on the water that enters, less that on what leaves, over the density [m^d m2/s3]."""
        force = np.where(tank.active[self.cell], tank.pressure[self.cell] * self.open * self.speed, 0.0)
        return float(force.sum()) * self.area * 2 ** (self.grid.dimension - 1)

    def exchange(self, tank: Tank, dt: float) -> None:
        """Lets in and takes out exactly the volume that passes the faces in a step of dt [s]."""
        slices = _Slices.of(self, dt)
        _take(tank, self, slices)
        _let_in(tank, self, slices, dt)

    # ---- checkpoints ---------------------------------------------------------------------------------------------

    def state(self) -> State:
        return {"shear": self.shear, **{name: np.array(getattr(self, name)) for name in KEPT}}

    def restore(self, state: Mapping[str, FloatArray]) -> None:
        self.shear = np.array(state["shear"])
        for name in KEPT:
            setattr(self, name, float(state[name]))


@dataclass
class _Slices:
    """The slices of water that pass the R half faces of a side in a step, as flat arrays.

    volume  (R,) volume that enters [m^d], negative if it leaves
    wet     (R,) share of the half face that the slice fills, up to 1 + `THIN`
    bottom  (R,) height of the lower end of the half face [m]
    """

    volume: FloatArray
    wet: FloatArray
    bottom: FloatArray

    @classmethod
    def of(cls, side: OpenSide, dt: float) -> _Slices:
        wet = side.wet * side.halves(np.where(side.open > 0.0, 1.0, 0.0))
        volume = dt * side.area * wet * side.halves(side.open * side.speed)
        thin = (wet[..., 1:] > 0.0) & (wet[..., 1:] < THIN) & (wet[..., :-1] > 0.0)
        for values in (volume, wet):
            values[..., :-1] += np.where(thin, values[..., 1:], 0.0)
            values[..., 1:][thin] = 0.0
        bottom = np.broadcast_to(np.arange(wet.shape[-1]) * side.grid.spacing[-1] / 2, wet.shape)
        return cls(volume.ravel(), wet.ravel(), bottom.ravel())


def _near(tank: Tank, side: OpenSide, reach: float) -> tuple[NDArray[np.intp], FloatArray, NDArray[np.intp]]:
    """Particles within `reach` cells of the side: their numbers, distances from it [m], numbers of their half faces."""
    p, h = tank.particles, side.grid.spacing
    distance = np.abs(p.position[:, 0] - side.x)
    chosen = np.flatnonzero(distance < reach * h[0])
    row = np.zeros(len(chosen), np.intp)
    for a, n in enumerate(side.grid.shape[1:], start=1):
        half = np.clip((p.position[chosen, a] / (h[a] / 2)).astype(np.intp), 0, 2 * n - 1)
        row = row * (2 * n) + half
    return chosen, distance[chosen], row


def _take(tank: Tank, side: OpenSide, slices: _Slices) -> None:
    """Takes out the water that leaves: from each row the slice of its half face, the rest from any particle nearby."""
    demand = np.maximum(-slices.volume, 0.0)
    total = float(demand.sum()) + side.owed
    if total <= 0.0:
        return
    p = tank.particles
    chosen, distance, row = _near(tank, side, 1.0)
    order = np.lexsort((distance, row))
    chosen, distance, row = chosen[order], distance[order], row[order]
    volume = p.volume[chosen]
    taken = _first(volume, row, demand[row])
    rest, left = total - float(taken.sum()), volume - taken
    if rest > 0.0:
        nearest = np.argsort(distance, kind="stable")
        more = np.zeros_like(taken)
        more[nearest] = _first(left[nearest], np.zeros(len(row), np.intp), np.full(len(row), rest))
        taken, left = taken + more, left - more
    gone = left <= 0.0
    went = float(taken.sum())
    side.went, side.owed = side.went + went, max(0.0, total - went)
    strip = side.area * np.maximum(slices.wet[row], THIN)  # section of the water that a particle stands for
    stopped = distance < EDGE * side.grid.spacing[0]
    distance = np.where(stopped, left / (2 * strip), distance + taken / (2 * strip))
    changed = taken > 0.0
    p.position[chosen[changed], 0] = side.x + side.sign * np.minimum(distance, side.grid.spacing[0])[changed]
    p.volume[chosen] = np.where(gone, p.volume[chosen], left)
    keep = np.ones(len(p), bool)
    keep[chosen[gone]] = False
    if not keep.all():
        tank.particles = p.select(keep)


def _first(volume: FloatArray, group: NDArray[np.intp], demand: FloatArray) -> FloatArray:
    """Volumes (N,) that particles give when those of a group are asked in turn for the demand of the group.

    volume (N,) of the particles; group (N,) their numbers, equal ones side by side; demand (N,) that of their group.
    """
    if len(volume) == 0:
        return volume
    before = np.cumsum(volume) - volume
    start = np.flatnonzero(np.concatenate([[True], np.diff(group) != 0]))
    before = before - np.repeat(before[start], np.diff(np.append(start, len(group))))
    return np.clip(demand - before, 0.0, volume)


def _let_in(tank: Tank, side: OpenSide, slices: _Slices, dt: float) -> None:
    """Lets in the water that enters: it joins the first particle of its row, or is a new one if that is full."""
    rows = np.flatnonzero(slices.volume > 0.0)
    if len(rows) == 0:
        return
    came = slices.volume[rows]
    h, p = side.grid.spacing, tank.particles
    position = _middles(side, slices, rows)
    speed = side.halves(side.speed).ravel()[rows]
    position[:, 0] = side.x + side.sign * np.maximum(0.5 * speed * dt, 2 * EDGE * h[0])
    velocity = _velocity(tank, side, position)
    velocity[:, 0] = side.sign * speed

    chosen, distance, row = _near(tank, side, 0.5)
    order = np.lexsort((distance, row))
    first = order[np.concatenate([[True], np.diff(row[order]) != 0])] if len(order) else order
    there = np.full(len(slices.volume), -1)
    there[row[first]] = chosen[first]
    host = there[rows]
    full = (1.0 + SPARE) * slices.wet[rows] * side.area * h[0] / 2
    joins = (host >= 0) & (p.volume[host] + came <= full)

    p.join(host[joins], position[joins], velocity[joins], came[joins])
    tank.particles = p.append(position[~joins], velocity[~joins], came[~joins])
    side.came += float(came.sum())


def _middles(side: OpenSide, slices: _Slices, rows: NDArray[np.intp]) -> FloatArray:
    """Middles (K, d) of the wet parts of the half faces with these numbers (K,) [m]; x is that of the side."""
    h = side.grid.spacing
    at = np.full((len(rows), len(h)), side.x)
    at[:, -1] = slices.bottom[rows] + slices.wet[rows] * h[-1] / 4
    if len(h) == 3:
        at[:, 1] = (rows // side.wet.shape[-1] + 0.5) * h[1] / 2
    return at


def _velocity(tank: Tank, side: OpenSide, position: FloatArray) -> FloatArray:
    """Velocity (N, d) along the side of the water in its cells [m/s], linear between faces; 0 across the side."""
    h, shape = side.grid.spacing, side.grid.shape
    cell = [np.clip((position[:, a] / h[a]).astype(np.intp), 0, shape[a] - 1) for a in range(1, len(h))]
    velocity = np.zeros_like(position)
    for a in range(1, len(h)):
        u, low = tank.velocity[a][side.cell], tuple(cell)
        high = tuple(c + 1 if b == a else c for b, c in enumerate(cell, start=1))
        s = position[:, a] / h[a] - cell[a - 1]
        velocity[:, a] = (1 - s) * u[low] + s * u[high]
    return velocity


def _make(
    case: Surroundings,
    grid: Grid,
    medium: Medium,
    water: Particles,
    *,
    side: str,
    prescribed: dict[str, Record],
    ramp: float,
    response: float | None,
) -> OpenSide:
    """The side of a case; a left one takes part in the wave of a relaxation zone, if there is one."""
    far, faces = side == "right", medium.open_faces[0].astype(float)
    made = OpenSide.of(far, prescribed, ramp, response, case.gravity, grid, faces, water)
    if case.zone is not None and not far:
        made.wave, made.wave_ramp = case.wave, case.ramp
        made.long_from = case.zone[1] if case.lets_long else 0.0
    return made


BOUNDARIES.add(
    BoundaryKind(
        "open",
        "A side through which water comes and goes: at a velocity, with a discharge, or towards a level.",
        "Flather (1976); docs/theory.md",
        _make,
        place=3,
    )
)
