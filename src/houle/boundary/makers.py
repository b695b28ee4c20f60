"""What makes the waves of a run: a force inside the water, or a zone in which the flow is led towards the wave.

A maker adds accelerations to the faces. What damps (a relaxation zone, a sponge) is a linear resistance, and enters the
implicit drag with the pressure: it limits no time step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, log, pi, sqrt
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from houle.boundary.finite_source import REACH, FiniteSource
from houle.grid import Faces, FloatArray, Grid
from houle.waves.dispersion import frequency, group_velocity
from houle.waves.finite import SHARPNESS
from houle.waves.wave import Components, Wave, WaveError, ramp

NWOGU = -0.390  # of the Boussinesq equations of Nwogu (1993), in (5)
WIDTH, NARROW = 1.0, 0.25  # wavelengths: of a source for regular waves, for a spectrum with its short waves
FIRM, HARD = 2.0, 8.0  # of a zone where it begins to damp, in the strength of a sponge; and at the wall, in that
SHORTEST, LONGEST = 0.3, 16.0  # widths of a source: other waves of a record it does not make
LEAVES = 0.5  # of the rms of a record with its two ends, what it leaves out at most: some 0.3 of any that is cut
LEFT_OVER = 0.003  # of the amplitude of a wave that went through a sponge and back


class Maker(Protocol):
    """Adds to the accelerations of the faces [m/s2] what makes the waves at time t [s]."""

    def push(self, t: float, acceleration: Faces) -> None: ...

    def touches(self) -> dict[int, slice]:
        """Axes of the faces that it pushes, and which of them along x."""

    def resist(self, rate: Faces) -> None:
        """Adds what it damps to the linear resistance of the faces [1/s]."""


@dataclass(frozen=True)
class Source:
    """A source inside the water: its middle x [m], its width [m], the form of its push, and where the waves go.

    form  "finite": regular waves with all their harmonics; "linear", "boussinesq": the first alone, by group velocity
    side  "both", "left" or "right"
    """

    x: float
    width: float
    form: str
    side: str


@dataclass
class InternalSource:
    """The momentum source of JH2020 (4), (5), corrected: the gradient of a potential G(x) times oscillations.

    For what is a sum of linear waves; regular waves with harmonics have FiniteSource.

    G = exp(-beta (x - x0)^2), beta = 20 / width^2, uniform over the depth. To both sides each component is pushed by
    -g (D/omega) G' sin(omega t - k_y y - psi); to one side by half of that with the part added whose waves on the other
    side cancel: -g (D/2 omega) (G' sin(...) +- G''/k_x cos(...)). Oblique waves are pushed along y as well, by the
    other derivative of the same potential: without it they would come out lower, by the squared cosine of the angle.

    first     number of the first face along x that it pushes
    shapes    G' [1/m] and +-G''  [1/m2] on these faces (2, faces); across: G [-] and +-G' [1/m] between them
    size      g D / omega of the components [m2/s2], halved for one side; k_x, k_y [rad/m]
    """

    first: int
    shapes: FloatArray
    size: FloatArray
    k_x: FloatArray
    omega: FloatArray
    offset: FloatArray  # k_y y + psi [rad], (ny, components); one row in 2D
    duration: float  # of the ramp [s]
    k_y: FloatArray
    across: FloatArray
    offset_across: FloatArray  # on the faces along y (ny + 1, components); no row in 2D

    @classmethod
    def of(
        cls,
        source: Source,
        parts: Components,
        wave: Wave,
        grid: Grid,
        duration: float,
        current: float = 0.0,
    ) -> InternalSource:
        h, count = grid.spacing[0], grid.shape[0]
        beta = SHARPNESS / source.width**2
        first, last = (round((source.x + s * REACH * source.width) / h) for s in (-1, 1))
        first, last = max(1, first), min(count - 1, last)
        x: FloatArray = np.arange(first, last + 1, dtype=float) * h - source.x
        shapes, across = _bell(x, beta)[1:], _bell(x[:-1] + h / 2, beta)[:2]
        k_x, k_y = parts.k * np.cos(parts.direction), parts.k * np.sin(parts.direction)
        reach = sqrt(pi / beta) * np.exp(-(k_x**2) / (4 * beta))  # I, the strength of G at k_x
        height = 2 * parts.amplitude
        speed, sigma = _speed(source.form, parts, wave.depth, wave.gravity), parts.omega
        if current:  # the push oscillates with sigma for the water that runs through it, the energy leaves with c_g + U
            speed, sigma = speed + current * np.cos(parts.direction), frequency(parts.k, wave.depth, wave.gravity)
        strength = height * speed * np.cos(parts.direction) / reach  # D of (5)
        size = wave.gravity * strength / sigma
        sign = {"both": 0.0, "right": 1.0, "left": -1.0}[source.side]
        if sign:
            size = size / 2
        y, faces = np.zeros(1), np.zeros(0)
        if grid.dimension == 3:
            y, faces = grid.axis_points(1), grid.axis_points(1, on_faces=True)
        there = k_x * source.x * (sign or 1.0) + parts.phase
        chosen = np.array([[1.0], [sign]])
        return cls(
            first, chosen * shapes, size, k_x, parts.omega, y[:, None] * k_y + there, duration, k_y, chosen * across,
            faces[:, None] * k_y + there,
        )  # fmt: skip

    def resist(self, rate: Faces) -> None:
        """It damps nothing."""

    def touches(self) -> dict[int, slice]:
        found = {0: slice(self.first, self.first + self.shapes.shape[1])}
        oblique = len(self.offset_across) and self.k_y.any()
        return found | ({1: slice(self.first, self.first + self.across.shape[1])} if oblique else {})

    def push(self, t: float, acceleration: Faces) -> None:
        theta = self.omega * t - self.offset
        grown = float(ramp(t, self.duration))
        beat = -grown * np.stack([(self.size * np.sin(theta)).sum(-1), (self.size / self.k_x * np.cos(theta)).sum(-1)])
        here = acceleration[0][self.first : self.first + self.shapes.shape[1]]
        force = self.shapes[0][:, None] * beat[0] + self.shapes[1][:, None] * beat[1]  # (faces, ny)
        here += force[..., None] if here.ndim == 3 else force
        if here.ndim == 3 and self.k_y.any():
            theta, size = self.omega * t - self.offset_across, grown * self.k_y * self.size
            beat = np.stack([(size * np.cos(theta)).sum(-1), -(size / self.k_x * np.sin(theta)).sum(-1)])
            force = self.across[0][:, None] * beat[0] + self.across[1][:, None] * beat[1]  # (cells, ny faces)
            acceleration[1][self.first : self.first + self.across.shape[1]] += force[..., None]


def _bell(x: FloatArray, beta: float) -> FloatArray:
    """G = exp(-beta x^2), its first and its second derivative (3, ...)."""
    bell = np.exp(-beta * x**2)
    return np.stack([bell, -2 * beta * x * bell, (4 * beta**2 * x**2 - 2 * beta) * bell])


def _speed(form: str, parts: Components, depth: float, gravity: float) -> FloatArray:
    """The factor of D that is the group velocity [m/s]: exact for potential flow, or of the Boussinesq equations."""
    if form != "boussinesq":
        return np.asarray(group_velocity(parts.k, depth, gravity))
    k, omega = parts.k, parts.omega
    bracket = omega**2 - (NWOGU + 1 / 3) * gravity * k**4 * depth**3
    return bracket / (omega * k * (1 - NWOGU * (k * depth) ** 2))


@dataclass
class RelaxationZone:
    """The flow is led towards the wave, the harder the further in: du/dt = ... + sigma (u_wave - u).

    What comes back from the structure is damped on its way in, by a sigma that grows gently enough to send little back.
    Where the zone begins at a wall, the wave of theory would cross it: over the first third the wave grows from
    nothing, so that the water it needs comes from the level there, and sigma grows faster, so that the flow follows. An
    open side lets the wave pass, and needs neither. The vertical velocity is what continuity asks for.

    faces, cells  of axis 0, those it covers
    """

    wave: Wave
    faces: slice
    cells: slice
    x: FloatArray  # of the faces of axis 0 [m]
    z: FloatArray  # of the centres along the last axis [m]
    steep: float  # spacing of the last axis over that of axis 0
    sigma: tuple[FloatArray, FloatArray]  # on faces and centres [1/s]
    share: FloatArray  # of the wave, on faces, 0 at a wall
    duration: float
    up: int  # the last axis

    def push(self, t: float, acceleration: Faces) -> None:
        grown = float(ramp(t, self.duration))
        u = self.share[:, None] * self.wave.along_on(self.x, self.z, t)
        w = np.pad(np.cumsum(u[:-1] - u[1:], axis=1), ((0, 0), (1, 0))) * self.steep
        pairs = ((0, self.faces, u), (len(acceleration) - 1, self.cells, w))
        for (axis, where, velocity), sigma in zip(pairs, self.sigma, strict=True):
            force = (grown * sigma)[:, None] * velocity
            acceleration[axis][where] += force[:, None, :] if acceleration[axis].ndim == 3 else force

    def touches(self) -> dict[int, slice]:
        return {0: self.faces, self.up: self.cells}

    @classmethod
    def of(cls, x: tuple[float, float], wave: Wave, grid: Grid, duration: float, wall: bool = True) -> RelaxationZone:
        """Between x[0], where the wave is complete, and x[1] [m]; wall: whether the side of the tank is a wall."""
        start, end = x
        h, n = grid.spacing[0], grid.shape[0]
        if grid.dimension == 3 and wave.direction:
            raise WaveError("waves.zone leads waves along x only; take waves.source for oblique waves")
        faces = slice(max(0, round(start / h)), min(n, round(end / h)) + 1)
        cells = slice(faces.start, faces.stop - 1)
        points = (grid.axis_points(0, on_faces=True)[faces], grid.axis_points(0)[cells])
        firm = FIRM * damping(wave.group_velocity, end - start)
        inwards = [(end - p) / (end - start) for p in points]  # 0 where the waves leave the zone, 1 at its start
        at_faces, at_centres = (firm * (s**2 + (HARD * s**6 if wall else 0.0)) for s in inwards)
        up = grid.dimension - 1
        return cls(
            wave, faces, cells, points[0], grid.axis_points(up), grid.spacing[up] / h,
            sigma=(at_faces, at_centres),
            share=smooth(3 * (1 - inwards[0])) if wall else np.ones(len(points[0])),
            duration=duration, up=up,
        )  # fmt: skip

    def resist(self, rate: Faces) -> None:
        """Adds sigma to the linear resistance of the faces [1/s]."""
        last = len(rate) - 1
        for axis, r in enumerate(rate):
            where, sigma = (self.faces, self.sigma[0]) if axis == 0 else (self.cells, self.sigma[1])
            r[where] += sigma.reshape((-1,) + (1,) * last)


@dataclass
class Stream:
    """Leads what damps in front of an open side towards the flow through it, which it would hold up: + sigma U.

    A current, and the long waves that leave; what the side lets in of the wave of a zone is not in it.

    rate       of the faces along x, what damps there [1/s]
    depth      of the water at these faces (nx + 1, [ny]) [m]
    discharge  towards larger x now, per width [m2/s]
    """

    rate: FloatArray
    depth: FloatArray
    discharge: Callable[[], float]

    def push(self, t: float, acceleration: Faces) -> None:
        acceleration[0] += self.rate * (self.discharge() / self.depth)[..., None]

    def touches(self) -> dict[int, slice]:
        return {0: slice(0, len(self.rate))}

    def resist(self, rate: Faces) -> None:
        """It damps nothing of its own."""


def smooth(s: FloatArray) -> FloatArray:
    """0 below 0, 1 above 1, smooth between (two continuous derivatives)."""
    s = np.clip(s, 0, 1)
    return s**3 * (10 - 15 * s + 6 * s**2)


def damping(group_velocity: float, length: float) -> float:
    """The largest rate sigma [1/s] of a sponge of this length [m] that grows with the square of the way into it.

    A wave that goes in and comes back keeps exp(-sigma length / (3 c_g)) of its amplitude: LEFT_OVER. Uniform over
    the depth, it slows water down at the rate sigma and takes half of that from the amplitude, both ways.
    """
    return -3 * log(LEFT_OVER) * group_velocity / length


def left_over(strength: float, group_velocity: float, length: float) -> float:
    """Share of the amplitude of a wave that a sponge of this strength [1/s] lets come back: `damping` backwards."""
    return exp(-strength * length / (3 * group_velocity))


def source_width(given: float | None, kind: str, wave: Wave) -> float:
    """Width [m] of a source of waves of this kind: as given, or in proportion to the wavelength."""
    return given or (WIDTH if kind == "regular" else NARROW) * wave.length


def oscillations(wave: Wave, kind: str, width: float) -> Components:
    """What a source of this width [m] can make: the components of the wave. Raises WaveError if they are not all of it.

    Of a record it leaves out the mean and what does not suit its width, if that is little: see `left_out`.
    """
    parts = wave.components()
    if parts is None:
        raise WaveError(f"waves.source cannot make a {kind} wave, which is no sum of cosines: take waves.zone")
    if kind == "series" and (share := left_out(parts, width)) > LEAVES:
        low, high = SHORTEST * width, LONGEST * width
        raise WaveError(
            f"waves.source cannot make the mean of the record and what is not {low:.3g} to {high:.3g} m long, "
            f"{SHORTEST:g} to {LONGEST:g} of its widths: {share:.0%} of the rms with what leads to still water, "
            f"{LEAVES:.0%} at most; take waves.zone or waves.piston, another width, or a record without its mean"
        )
    return parts.chosen(_suits(parts, width)) if kind == "series" else parts


def left_out(parts: Components, width: float) -> float:
    """Share of the rms in waves so long or so short that a source of this width [m] would raise the water by depths.

    Its potential goes as H/(k width), to one side as H/(k width)^2: at 16 widths 36 heights; for short waves, of which
    it holds several, as exp(k^2/4 beta): at 0.3 widths 240 heights.
    """
    energy = parts.amplitude**2 * np.where(parts.omega > 0, 0.5, 1.0)
    return float(np.sqrt(energy[~_suits(parts, width)].sum() / energy.sum()))


def _suits(parts: Components, width: float) -> NDArray[np.bool_]:
    turns = parts.k * width
    return (turns * LONGEST >= 2 * pi) & (turns * SHORTEST <= 2 * pi)


def is_finite(source: Source, kind: str, parts: Components) -> bool:
    """Whether the source makes all harmonics of the wave."""
    return source.form == "finite" and kind == "regular" and len(parts.k) > 1


def require_source(source: Source, kind: str, wave: Wave) -> None:
    """Raises WaveError if the source cannot make this wave. What it finds out is kept for the source."""
    if is_finite(source, kind, oscillations(wave, kind, source.width)):
        FiniteSource.force(wave, source.width, source.side)


def make_source(
    source: Source, kind: str, wave: Wave, grid: Grid, duration: float, current: float = 0.0
) -> InternalSource | FiniteSource:
    """The force that makes waves of this kind and grows in the time `duration` [s]. Raises WaveError."""
    parts = oscillations(wave, kind, source.width)
    if is_finite(source, kind, parts):
        return FiniteSource.of(wave, grid, source.x, source.width, source.side, duration)
    if kind == "regular":
        parts = parts.first
    return InternalSource.of(source, parts, wave, grid, duration, current)
