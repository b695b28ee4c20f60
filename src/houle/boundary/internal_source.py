"""A source inside the water: a force that makes waves, the gradient of a potential that is uniform over the depth.

Regular waves of finite height get all their harmonics from the potential of `houle.waves.finite`; a sum of linear
waves gets the force of JH2020 (4), (5).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from houle.errors import CaseError
from houle.flow.boundaries import BOUNDARIES, Boundaries, Boundary, BoundaryKind, Surroundings, Tank
from houle.flow.particles import Particles
from houle.grid import Faces, FloatArray, Grid
from houle.medium.medium import Medium
from houle.waves.dispersion import frequency, group_velocity
from houle.waves.finite import SHARPNESS, Potential, Spectrum, potential
from houle.waves.wave import Components, Wave, WaveError, ramp

NWOGU = -0.390  # of the Boussinesq equations of Nwogu (1993), in (5)
WIDTH, NARROW = 1.0, 0.25  # wavelengths: of a source for regular waves, for a spectrum with its short waves
SHORTEST, LONGEST = 0.3, 16.0  # widths of a source: other waves of a record it does not make
LEAVES = 0.5  # of the rms of a record with its two ends, what it leaves out at most: some 0.3 of any that is cut
ACTS = 0.75  # widths to each side of a source where its force is more than a thousandth of its largest
REACH = 1.25  # widths to each side of the source where its force is not negligible: exp(-20 * 1.25^2) = 3e-14
FADE = 1.0  # widths from where what an oblique wave asks for further out (1e-3 of the force) is led to 0


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


class _Force(Boundary):
    """What is common to all sources. acts: where from and to its force counts [m]."""

    name = "waves.source"
    acts: tuple[float, float] = (0.0, 0.0)

    def join(self, tank: Tank, boundaries: Boundaries) -> None:
        """CaseError where a moving wall stands in its force, or before it: behind a wall is no water to push."""
        low, high = self.acts
        for wall in boundaries:
            for x, water in wall.images():
                if (x > low) if water > 0 else (x < high):
                    raise CaseError(
                        f"{self.name} pushes the water from x = {low:.3g} to {high:.3g} m, but there is none behind "
                        f"{wall.name} at x = {x:.4g} m: move one of them"
                    )


@dataclass(eq=False)
class InternalSource(_Force):
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
        found = cls(
            first, chosen * shapes, size, k_x, parts.omega, y[:, None] * k_y + there, duration, k_y, chosen * across,
            faces[:, None] * k_y + there,
        )  # fmt: skip
        found.acts = source.x - ACTS * source.width, source.x + ACTS * source.width
        return found

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


@dataclass(eq=False)
class FiniteSource(_Force):
    """Adds sum_n r^n Re(F_n(x) exp(-i n tau)), tau = omega t - k_y y - psi, r the ramp; the mean, n = 0, grows as r^2.

    That is how the harmonics of a wave grow with its height, so that it is nearly right already while it grows.

    first     number of the first face along x that it pushes, and of the first cell
    along_x   F_n on these faces (faces, M); along_y on the cells between (cells, M), none in 2D [m/s2]
    phase     k_y y + psi at the cell centres along y (ny,), on the faces across (ny + 1,) [rad]; one and none in 2D
    """

    first: int
    along_x: Spectrum
    along_y: Spectrum
    omega: float
    phase: tuple[FloatArray, FloatArray]
    duration: float  # of the ramp [s]

    @staticmethod
    def force(wave: Wave, width: float, side: str) -> Potential:
        """side: "both", "left" or "right". Raises WaveError."""
        return potential(wave, width, (side != "left", side != "right"))

    @classmethod
    def of(cls, wave: Wave, grid: Grid, place: float, width: float, side: str, duration: float) -> FiniteSource:
        """At x = place [m]."""
        from scipy.interpolate import CubicSpline

        found = cls.force(wave, width, side)
        h, count = grid.spacing[0], grid.shape[0]
        first, last = (round((place + s * REACH * width) / h) for s in (-1, 1))
        first, last = max(1, first), min(count - 1, last)
        faces: FloatArray = np.arange(first, last + 1, dtype=float) * h - place
        k_x, k_y = wave.k * np.cos(wave.direction), wave.k * np.sin(wave.direction)
        psi = k_x * place * (-1.0 if side == "left" else 1.0) + wave.phase
        along_x = CubicSpline(found.x, found.along.T)(faces)
        along_y, phase = np.zeros((0, along_x.shape[1]), complex), (np.array([psi]), np.zeros(0))
        if grid.dimension == 3:
            phase = (k_y * grid.axis_points(1) + psi, k_y * grid.axis_points(1, on_faces=True) + psi)
        if grid.dimension == 3 and k_y:
            n, value = np.arange(along_x.shape[1]), CubicSpline(found.x, found.value.T)
            centres, oblique = faces[:-1] + h / 2, n > 0
            along_y = 1j * k_y * n * value(centres) * _share(centres, width)[:, None]
            slope = (_share(faces + h / 2, width) - _share(faces - h / 2, width)) / h
            led = along_x * _share(faces, width)[:, None] + value(faces) * slope[:, None]
            along_x = np.where(oblique, led, along_x)
        source = cls(first, along_x, along_y, wave.omega, phase, duration)
        source.acts = place - ACTS * width, place + ACTS * width
        return source

    def touches(self) -> dict[int, slice]:
        across = {1: slice(self.first, self.first + len(self.along_y))} if self.along_y.size else {}
        return {0: slice(self.first, self.first + len(self.along_x))} | across

    def push(self, t: float, acceleration: Faces) -> None:
        force = self._force(self.along_x, self.phase[0], t)
        here = acceleration[0][self.first : self.first + len(force)]
        here += force[..., None] if here.ndim == 3 else force
        if self.along_y.size:
            force = self._force(self.along_y, self.phase[1], t)
            acceleration[1][self.first : self.first + len(force)] += force[..., None]

    def _force(self, shapes: Spectrum, phase: FloatArray, t: float) -> FloatArray:
        """(places, phases)"""
        n = np.arange(shapes.shape[1])
        grown = float(ramp(t, self.duration)) ** np.where(n == 0, 2, n)
        beat = grown[:, None] * np.exp(-1j * n[:, None] * (self.omega * t - phase))
        return np.asarray(np.einsum("xn,ny->xy", shapes, beat, optimize=False).real)


def _share(x: FloatArray, width: float) -> FloatArray:
    """1 inside of FADE widths, 0 outside of REACH, half a cosine between."""
    way = np.clip((np.abs(x) / width - FADE) / (REACH - FADE), 0.0, 1.0)
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * way))


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


def _make(
    case: Surroundings, grid: Grid, medium: Medium, water: Particles, *, source: Source, kind: str, current: float
) -> InternalSource | FiniteSource:
    assert case.wave is not None
    return make_source(source, kind, case.wave, grid, case.ramp, current)


BOUNDARIES.add(
    BoundaryKind(
        "source",
        "A force inside the water: regular waves and sums of cosines, to one side or both, oblique in 3D. Wants a "
        "sponge behind it.",
        "Wei, Kirby & Sinha (1999); the paper's (4), (5)",
        _make,
        place=4,
    )
)
