"""The force of a source that makes a sum of waves to second order: found from the surface that is wanted.

As in `houle.waves.finite` the force is the gradient of a potential P(x, t) that is uniform over the depth, and P is
what Bernoulli's equation at the surface lacks. Here it is expanded to second order, for every pair of components, about
the still water level, where phi_z is known from the rise of the surface:

    phi_1,z = eta_1,t                          P_1 = phi_1,t + g eta_1
    phi_2,z = eta_2,t + (eta_1 phi_1,x)_x      P_2 = phi_2,t + g eta_2 + (phi_1,x^2 + phi_1,z^2)/2 + eta_1 phi_1,tz

Wanted are waves that grow by s(x) = 1/2 + erf(sqrt(beta) x)/2 over the source, and where s is 1 P is constant: what
leaves has its bound waves and no free ones. Water is kept: eta_1 is (s e^{ikx}/ik)_x, sums likewise. The set-down
under groups is a long wave, whose flux q(t) the source must give or take: it stands in the source as a heap,
-s'(x) int q dt. Slow differences, whose heap would be high, are left out of a sea (`second_order.steady`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, pi

import numpy as np

from houle.waves import dispersion
from houle.waves.finite import SHARPNESS
from houle.waves.pairs import Complex, Nodes
from houle.waves.second_order import Kernel, SecondOrder, steady
from houle.waves.wave import Array, ramp

FORCE_NODES = 20  # frequencies between which the force is interpolated
FLAT, WHOLE = 2.0, 8.0  # lengths of full waves, and of the periodic stretch of water, in its units
ROOM = 4.0  # depths in a unit at least: the flow under the growing waves ends with exp(-pi x/d)
POINTS, IN_WIDTH = 10.0, 40.0  # points of the stretch in the shortest wave of second order, and in a width
STEPS = 400  # steps of the ramp in which the heap is integrated


@dataclass
class _Stretch:
    """A periodic stretch of water of first and second order, its surface known.

    x  (nx,) places [m], 0 the middle of the source; sharp: sqrt(beta) [1/m]
    """

    x: Array
    flat: float
    sharp: float
    depth: float
    gravity: float

    @classmethod
    def of(cls, wave: SecondOrder, width: float) -> _Stretch:
        """The stretch around a source of this width [m]."""
        unit = max(width, wave.length, ROOM * wave.depth)
        shortest = pi / float(wave.parts.k.max())
        count = 2 * ceil(WHOLE * unit * max(POINTS / (2 * shortest), IN_WIDTH / (2 * width)))
        x: Array = (np.arange(count) / count - 0.5) * WHOLE * unit
        return cls(x, FLAT * unit, float(np.sqrt(SHARPNESS)) / width, wave.depth, wave.gravity)

    def __post_init__(self) -> None:
        kappa = 2 * pi * np.fft.fftfreq(len(self.x), self.x[1] - self.x[0])
        self.by_x = 1j * kappa * (np.arange(len(kappa)) != len(kappa) // 2)
        stiff = np.abs(kappa) * np.tanh(np.abs(kappa) * self.depth)
        self.inverse = np.divide(1.0, stiff, out=np.zeros_like(stiff), where=stiff > 0)
        self.quiet = slice(0, max(1, len(self.x) // 64))

    def slope(self, field: Complex) -> Complex:
        return np.fft.ifft(np.fft.fft(field) * self.by_x)

    def bell(self, at: float = 0.0) -> Array:
        """s'(x - at) [1/m]."""
        return np.asarray(self.sharp / np.sqrt(pi) * np.exp(-((self.sharp * (self.x - at)) ** 2)))

    def grown(self, k: Array) -> Complex:
        """s e^{ikx}, which ends again at `flat`, for wave numbers k (n,): (n, nx)."""
        from scipy.special import erf

        share = (erf(self.sharp * self.x) - erf(self.sharp * (self.x - self.flat))) / 2
        return np.asarray(share * np.exp(1j * np.asarray(k)[:, None] * self.x))

    def kept(self, k: Array) -> Complex:
        """Waves of wave numbers k that grow with the water that they carry."""
        return self.slope(self.grown(k)) / (1j * np.asarray(k)[:, None])

    def mirrored(self, field: Complex) -> Complex:
        """field(-x), on a grid whose middle is at half its length."""
        return np.roll(field[..., ::-1], 1, axis=-1)

    def sided(self, field: Complex, side: str) -> Complex:
        """Waves to the right as waves to a side."""
        if side == "right":
            return field
        return self.mirrored(field) + (field if side == "both" else 0.0)

    def speed(self, rise: Complex) -> Complex:
        """Velocity along x at the still water level under a surface that rises so; 0 where the water is quiet."""
        found = np.fft.ifft(np.fft.fft(rise) * self.inverse * self.by_x)
        return np.asarray(found - found[..., self.quiet].mean(-1, keepdims=True))


@dataclass(frozen=True)
class Force:
    """A force along x at some places, in the components of a wave.

    every    frequencies of all components [rad/s]; turned (N, m) vectors of their sums, first (m, nx) force of each
             [m/s2]
    omega    frequencies of those with bound waves [rad/s]; phasors (M, r) vectors of the sums over pairs
    sums, differences  (nx, r, r) force of the pairs of vectors; rest (nx,): its mean, which a sea has none of [m/s2]
    heap     (nx,) force of a heap of 1 m2
    heaped   (M, M) heap of each pair [m2]; flux: the mean of its rate [m2/s]
    duration time in which the waves grow [s]
    """

    every: Array
    turned: Complex
    first: Complex
    omega: Array
    phasors: Complex
    sums: Complex
    differences: Complex
    rest: Array
    heap: Array
    heaped: Complex
    flux: float
    duration: float

    def at(self, t: float) -> Array:
        """The force at the time t [s], (nx,) [m/s2]; what is of second order grows with the square of the ramp."""
        grown = float(ramp(t, self.duration))
        f = np.einsum("i,im->m", np.exp(-1j * self.every * t), self.turned, optimize=False)
        linear = np.einsum("m,mx->x", f, self.first, optimize=False).real
        f = np.einsum("i,im->m", np.exp(-1j * self.omega * t), self.phasors, optimize=False)
        pairs = np.einsum("xab,ab->x", self.sums, np.outer(f, f), optimize=False)
        pairs = pairs + np.einsum("xab,ab->x", self.differences, np.outer(f, f.conj()), optimize=False)
        return np.asarray(grown * linear + grown**2 * (pairs.real - self.rest) + self.heap * self.heap_at(t))

    def heap_at(self, t: float) -> float:
        """The water that the heap holds [m2]."""
        if t < self.duration:
            return float(np.interp(t, *self._growing))
        return self._heap(t) - self._heap(self.duration) + float(self._growing[1][-1])

    def _heap(self, t: float) -> float:
        beat = np.exp(-1j * self.omega * t)
        rows = np.einsum("ij,j->i", self.heaped, beat.conj(), optimize=False)
        return float(np.sum(beat * rows).real) + self.flux * t

    @cached_property
    def _growing(self) -> tuple[Array, Array]:
        """Times of the ramp [s], and the heap then [m2]: its rate grows with the square of the ramp."""
        times = np.linspace(0.0, self.duration, STEPS + 1)
        if not self.duration:
            return np.zeros(1), np.zeros(1)
        heap = np.array([self._heap(float(t)) for t in times])
        grown = ramp((times[1:] + times[:-1]) / 2, self.duration) ** 2
        return times, np.concatenate([[0.0], np.cumsum(grown * np.diff(heap))])


def half_reach(width: float, depth: float) -> float:
    """Length to each side of the middle of a source [m] beyond which its force of second order is below a hundredth."""
    return 0.75 * width + 0.75 * depth


def pair_force(wave: SecondOrder, width: float, side: str, middle: float, x: Array, duration: float) -> Force:
    """The force of a source of this width [m] around x = `middle` [m], growing in `duration` [s], at places x [m]."""
    water = _Stretch.of(wave, width)
    components, every = Nodes.of(wave.pairs.omega, wave.pairs.amplitude, FORCE_NODES), wave.parts
    flow = _First.of(water, components.omega, side)
    tables = [np.moveaxis(_at(water, flow.pairs(sign, side), x - middle), -1, 0) for sign in (1, -1)]
    vectors = components.few(tables)
    sums, differences = (vectors.T @ components.led(table) @ vectors for table in tables)
    phasors, rest = components.unit @ vectors, np.zeros(len(x))
    heaped, flux = _heaps(wave, components, water.sharp)
    if wave.closed:
        rest, flux = np.einsum("xab,ab->x", differences.real, phasors.T @ phasors, optimize=False), 0.0
    linear = Nodes.of(every.omega, every.amplitude, FORCE_NODES)
    first = linear.lead @ _at(water, _First.of(water, linear.omega, side).force(), x - middle)
    way = -1.0 if side == "left" else 1.0
    turned, pairs = (np.exp(1j * (way * parts.k * middle + parts.phase)) for parts in (every, wave.pairs))
    bell = water.slope(water.bell().astype(complex)) * (2.0 if side == "both" else 1.0)
    heap = -wave.gravity * _at(water, bell, x - middle).real
    return Force(
        every.omega, linear.unit * turned[:, None], first,
        wave.pairs.omega, phasors * pairs[:, None], sums, differences, rest,
        heap, heaped * np.outer(pairs, pairs.conj()), flux, duration,
    )  # fmt: skip


def _at(water: _Stretch, field: Complex, x: Array) -> Complex:
    """A field (..., nx) of the stretch at other places."""
    from scipy.interpolate import CubicSpline  # a quarter of a second to load, for sources of second order alone

    return np.asarray(CubicSpline(water.x, field, axis=-1)(x))


def _heaps(wave: SecondOrder, nodes: Nodes, sharp: float) -> tuple[Complex, float]:
    """The heap of each pair (N, N) [m2], and the mean of its rate [m2/s]."""
    parts, d, g = wave.pairs, wave.depth, wave.gravity
    found = Kernel.of(nodes.omega[:, None], nodes.omega, d, g, -1)
    rate = found.omega * found.level / found.wave * np.exp(-(found.wave**2) / (4 * sharp**2))
    rate = nodes.unit @ nodes.led(rate) @ nodes.unit.T
    line = parts.omega[:, None] - parts.omega
    share = np.divide(1.0, line, out=np.zeros_like(line), where=line != 0)
    if wave.closed:
        share *= steady(line, wave.omega)
    return 1j * rate * share, float(np.trace(rate))


@dataclass
class _First:
    """The waves of first order in the source, for the nodes: omega [rad/s], k [rad/m], elevations eta (n, nx) [-]."""

    water: _Stretch
    omega: Array
    k: Array
    eta: Complex

    @classmethod
    def of(cls, water: _Stretch, omega: Array, side: str) -> _First:
        """The waves of these frequencies [rad/s] to a side."""
        k = dispersion.wave_number(omega, water.depth, water.gravity)
        return cls(water, omega, k, water.sided(water.kept(k), side))

    def __post_init__(self) -> None:
        self.rise = -1j * self.omega[:, None] * self.eta
        self.u = self.water.speed(self.rise)

    def force(self) -> Complex:
        """The gradient of P_1 (n, nx)."""
        return -1j * self.omega[:, None] * self.u + self.water.gravity * self.water.slope(self.eta)

    def pairs(self, sign: int, side: str) -> Complex:
        """The gradient of P_2 of all pairs (n, n, nx), half of it for each order of the pair, without the heap."""
        return np.stack([self._row(i, sign, side) for i in range(len(self.omega))])

    def _row(self, i: int, sign: int, side: str) -> Complex:
        water, g = self.water, self.water.gravity
        eta, rise, u = ((f if sign > 0 else f.conj()) for f in (self.eta, self.rise, self.u))
        pair = Kernel.of(self.omega[i], self.omega, water.depth, g, sign)
        line = pair.omega[:, None]
        carried = (self.eta[i] * u + self.u[i] * eta) / 4
        heights = (self.omega[i] ** 2 + self.omega[:, None] ** 2) / 2 * self.eta[i] * eta
        head = ((self.u[i] * u + self.rise[i] * rise) / 2 - heights) / 2
        level, given = self._wanted(pair, sign, side)
        speed = water.speed(-1j * line * level + given + water.slope(carried))
        return np.asarray(-1j * line * speed + water.slope(g * level + head))

    def _wanted(self, pair: Kernel, sign: int, side: str) -> tuple[Complex, Complex]:
        """Elevation of second order that is wanted without the heap, and the rate at which the heap grows."""
        water = self.water
        size = pair.level[:, None]
        if sign > 0:
            return water.sided(size * water.kept(pair.wave), side), np.zeros((1, len(water.x)), complex)
        flux = (pair.omega * pair.level / pair.wave * np.exp(-(pair.wave**2) / (4 * water.sharp**2)))[:, None]
        end = np.exp(1j * pair.wave[:, None] * water.flat) * water.bell(water.flat)
        heap = flux * (end - water.bell())
        return water.sided(size * water.grown(pair.wave), side), water.sided(heap, side)
