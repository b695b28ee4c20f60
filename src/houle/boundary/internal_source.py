"""A source inside the water: a force that makes waves, the gradient of a potential that is uniform over the depth.

Regular waves of finite height get all their harmonics from the potential of `houle.waves.finite`; a sum of linear
waves gets the force of JH2020 (4), (5), to second order that of `houle.waves.second_source`. Section 14 of
docs/theory.md has them.
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
from houle.waves.second_order import SecondOrder
from houle.waves.second_source import Force, half_reach, pair_force
from houle.waves.wave import Components, Wave, WaveError, ramp

NWOGU = -0.390  # alpha in (24): the constant of the Boussinesq equations of Nwogu (1993)
WIDTH, NARROW = 1.0, 0.25  # wavelengths: width of a source for regular waves, and for a spectrum with its short waves
WIDER = 0.5  # wavelengths: width for sums of waves of second order, in which the water does not rise so high
SHORTEST, LONGEST = 0.3, 16.0  # widths of a source: of a record it makes the waves with lengths between these
MOST_LEFT_OUT = 0.5  # share of the rms of a record that a source may leave out; the ends of any cut record are some 0.3
ACTS = 0.75  # widths to each side of a source within which its force exceeds a thousandth of its largest
REACH = 1.25  # widths to each side of a source within which its force is not negligible: exp(-20 * 1.25^2) = 3e-14
FADE = 1.0  # widths: the force of an oblique wave, which does not end by itself (1e-3 of it), fades from here to REACH


@dataclass(frozen=True)
class Source:
    """A source inside the water, as the case gives it.

    x      middle of the source [m]; width: its width [m]
    form   "finite": a regular wave with all its harmonics; "linear", "boussinesq": the first harmonic alone, with the
           group velocity of linear theory or that of the Boussinesq equations, (23) or (24)
    side   sides to which the waves leave: "both", "left" or "right"
    """

    x: float
    width: float
    form: str
    side: str


class _Force(Boundary):
    """Base of the sources. acts: interval along x within which the force counts [m]."""

    name = "waves.source"
    acts: tuple[float, float] = (0.0, 0.0)

    def join(self, tank: Tank, boundaries: Boundaries) -> None:
        """Raises CaseError where some of its force would act behind a moving wall, where no water is."""
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
    """The momentum source of JH2020 (4), (5), corrected, for sums of linear waves: (22) to (25) in docs/theory.md.

    The force is the gradient of a potential that is uniform over the depth: a bell G(x) times oscillations in time,
    with G = exp(-beta (x - x0)^2) and beta = 20 / width^2. For waves to both sides each component is pushed along x by
    -g (D/omega) G' sin theta, where theta = omega t - k_x x0 - k_y y - psi, with + k_x x0 for waves to the left alone.
    For waves to one side it is half of that, with a part added whose waves cancel those on the other side:
    -g (D/2 omega) (G' sin theta +- G''/k_x cos theta). Oblique waves are pushed along y as well, by the derivative of
    the same potential: without this they would be too low by the squared cosine of the angle. Regular waves with their
    harmonics have `FiniteSource`.

    first          number of the first face along x that it pushes
    shapes         G' [1/m] and +-G''  [1/m2] on these faces (2, faces), the second 0 for waves to both sides
    size           g D / omega of the components [m2/s2], halved for one side
    k_x, k_y       wave numbers of the components [rad/m]; omega: their frequencies [rad/s]
    offset         omega t - theta on the faces across x [rad], (ny, components); one row in 2D
    duration       time in which the force grows from nothing [s]
    across         G [-] and +-G' [1/m] at the cells between these faces, for the push along y (2, cells)
    offset_across  the same on the faces across y [rad], (ny + 1, components); no row in 2D
    """

    first: int
    shapes: FloatArray
    size: FloatArray
    k_x: FloatArray
    omega: FloatArray
    offset: FloatArray
    duration: float
    k_y: FloatArray
    across: FloatArray
    offset_across: FloatArray

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
        """The source that makes the components `parts` of the wave, in time `duration` [s], on a current [m/s]."""
        h, count = grid.spacing[0], grid.shape[0]
        beta = SHARPNESS / source.width**2
        first, last = (round((source.x + s * REACH * source.width) / h) for s in (-1, 1))
        first, last = max(1, first), min(count - 1, last)
        x: FloatArray = np.arange(first, last + 1, dtype=float) * h - source.x
        shapes, across = _bell(x, beta)[1:], _bell(x[:-1] + h / 2, beta)[:2]
        k_x, k_y = parts.k * np.cos(parts.direction), parts.k * np.sin(parts.direction)
        reach = sqrt(pi / beta) * np.exp(-(k_x**2) / (4 * beta))  # I of (23), the Fourier transform of G at k_x
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
    """Group velocity [m/s] of the components as it stands in D, (23): of potential flow, or (24) of Boussinesq's."""
    if form != "boussinesq":
        return np.asarray(group_velocity(parts.k, depth, gravity))
    k, omega = parts.k, parts.omega
    bracket = omega**2 - (NWOGU + 1 / 3) * gravity * k**4 * depth**3
    return bracket / (omega * k * (1 - NWOGU * (k * depth) ** 2))


@dataclass(eq=False)
class FiniteSource(_Force):
    """The source of a regular wave of finite height with all its harmonics, (25a) and (25b) in docs/theory.md.

    It pushes the water with sum_n r^n Re(F_n(x) exp(-i n theta)), where r is the ramp from 0 to 1 and theta that of
    `InternalSource`; the mean, n = 0, grows as r^2. The harmonics of a wave grow with its height in this way, so that
    the force is nearly right already while the wave grows.

    first     number of the first face along x that it pushes, and of the first cell
    along_x   F_n on these faces (faces, M) [m/s2]
    along_y   F_n of the push along y at the cells between them (cells, M) [m/s2]; no row in 2D
    omega     frequency [rad/s]
    phase     omega t - theta [rad] at the cell centres along y (ny,), and on the faces across y (ny + 1,); one value
              and none in 2D
    duration  time of the ramp [s]
    """

    first: int
    along_x: Spectrum
    along_y: Spectrum
    omega: float
    phase: tuple[FloatArray, FloatArray]
    duration: float

    @staticmethod
    def force(wave: Wave, width: float, side: str) -> Potential:
        """The potential of the force, for waves to a side: "both", "left" or "right". Raises WaveError without one."""
        return potential(wave, width, (side != "left", side != "right"))

    @classmethod
    def of(cls, wave: Wave, grid: Grid, place: float, width: float, side: str, duration: float) -> FiniteSource:
        """The source around x = place [m]. Raises WaveError where the wave is too steep for a source so narrow."""
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
        """The push [m/s2] at the time t [s], (places along x, phases along y), of harmonics F_n at these places."""
        n = np.arange(shapes.shape[1])
        grown = float(ramp(t, self.duration)) ** np.where(n == 0, 2, n)
        beat = grown[:, None] * np.exp(-1j * n[:, None] * (self.omega * t - phase))
        return np.asarray(np.einsum("xn,ny->xy", shapes, beat, optimize=False).real)


@dataclass(eq=False)
class PairSource(_Force):
    """The source of a sum of waves to second order, `houle.waves.second_source`, for waves along x.

    first  number of the first face along x that it pushes
    """

    first: int
    force: Force

    @classmethod
    def of(cls, source: Source, wave: SecondOrder, grid: Grid, duration: float) -> PairSource:
        """The source that makes the wave, in time `duration` [s]."""
        h, count = grid.spacing[0], grid.shape[0]
        half = REACH * source.width + wave.depth
        first, last = max(1, round((source.x - half) / h)), min(count - 1, round((source.x + half) / h))
        x: FloatArray = np.arange(first, last + 1, dtype=float) * h
        found = cls(first, pair_force(wave, source.width, source.side, source.x, x, duration))
        reach = half_reach(source.width, wave.depth)
        found.acts = source.x - reach, source.x + reach
        return found

    def touches(self) -> dict[int, slice]:
        return {0: slice(self.first, self.first + len(self.force.heap))}

    def push(self, t: float, acceleration: Faces) -> None:
        force = self.force.at(t)
        here = acceleration[0][self.first : self.first + len(force)]
        here += force.reshape((-1,) + (1,) * (here.ndim - 1))


def _share(x: FloatArray, width: float) -> FloatArray:
    """Kept share of the force of an oblique wave at x: 1 within FADE widths, 0 beyond REACH, a cosine between."""
    way = np.clip((np.abs(x) / width - FADE) / (REACH - FADE), 0.0, 1.0)
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * way))


def source_width(given: float | None, kind: str, wave: Wave) -> float:
    """Width [m] of a source for waves of this kind: as given, else in proportion to the wavelength."""
    share = WIDER if isinstance(wave, SecondOrder) else NARROW
    return given or (WIDTH if kind == "regular" else share) * wave.length


def oscillations(wave: Wave, kind: str, width: float) -> Components:
    """The components of the wave that a source of this width [m] makes. Raises WaveError if it cannot make the wave.

    Of a record it leaves out the mean, and waves whose length does not suit its width, if they are little (`left_out`).
    """
    parts = wave.components()
    if parts is None:
        raise WaveError(f"waves.source cannot make a {kind} wave, which is no sum of cosines: take waves.zone")
    if kind == "series" and isinstance(wave, SecondOrder):
        raise WaveError(
            "waves.order = 2: a source does not make records to second order, the set-down in which is longer than it "
            "can; take waves.zone or waves.piston, or order = 1"
        )
    if kind == "series" and (share := left_out(parts, width)) > MOST_LEFT_OUT:
        low, high = SHORTEST * width, LONGEST * width
        raise WaveError(
            f"waves.source cannot make the mean of the record, nor waves that are not {low:.3g} to {high:.3g} m long, "
            f"{SHORTEST:g} to {LONGEST:g} of its widths: here {share:.0%} of the rms of the record and the ends that "
            f"lead it to still water, {MOST_LEFT_OUT:.0%} at most. Take waves.zone or waves.piston, another width, or "
            "a record without its mean"
        )
    return parts.chosen(_suits(parts, width)) if kind == "series" else parts


def left_out(parts: Components, width: float) -> float:
    """Share of the rms of a record in waves too long or too short for a source of this width [m].

    For these the potential of the source would lift the water by many wave heights H. It goes as H/(k width), for waves
    to one side as H/(k width)^2, which makes 36 heights for waves of 16 widths; for short waves, several of which fit
    into the source, it goes as exp(k^2/4 beta), which makes 240 heights for waves of 0.3 widths.
    """
    energy = parts.amplitude**2 * np.where(parts.omega > 0, 0.5, 1.0)
    return float(np.sqrt(energy[~_suits(parts, width)].sum() / energy.sum()))


def _suits(parts: Components, width: float) -> NDArray[np.bool_]:
    turns = parts.k * width
    return (turns * LONGEST >= 2 * pi) & (turns * SHORTEST <= 2 * pi)


def is_finite(source: Source, kind: str, parts: Components) -> bool:
    """True for a source that makes all harmonics of the wave, False for one that makes its linear components."""
    return source.form == "finite" and kind == "regular" and len(parts.k) > 1


def require_source(source: Source, kind: str, wave: Wave) -> None:
    """Raises WaveError if the source cannot make this wave. The potential that it finds is cached for the source."""
    if is_finite(source, kind, oscillations(wave, kind, source.width)):
        FiniteSource.force(wave, source.width, source.side)


def make_source(
    source: Source, kind: str, wave: Wave, grid: Grid, duration: float, current: float = 0.0
) -> InternalSource | FiniteSource | PairSource:
    """The source of waves of this kind, growing in `duration` [s]. Raises WaveError for waves that it cannot make."""
    parts = oscillations(wave, kind, source.width)
    if isinstance(wave, SecondOrder):
        return PairSource.of(source, wave, grid, duration)
    if is_finite(source, kind, parts):
        return FiniteSource.of(wave, grid, source.x, source.width, source.side, duration)
    if kind == "regular":
        parts = parts.first
    return InternalSource.of(source, parts, wave, grid, duration, current)


def _make(
    case: Surroundings, grid: Grid, medium: Medium, water: Particles, *, source: Source, kind: str, current: float
) -> InternalSource | FiniteSource | PairSource:
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
