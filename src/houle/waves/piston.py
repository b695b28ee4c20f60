"""Wave maker theory: how a piston, a vertical wall that moves along x, must move to send out a given wave.

Linear: Biesel & Suquet (1951, La Houille Blanche 6). Regular waves to second order: the piston's double harmonic that
leaves no free wave of twice the frequency, from the wave maker problem solved by Schaffer (1996, Ocean Engng. 23, 47),
here for one frequency and by its own sums over modes. Long waves of finite height: the piston goes with the mean
velocity of the water at its own place (Goring 1979, Caltech KH-R-38).

Below, z is from the bed and quantities are Re{. e^(i omega t)}. A mode is cosh k_j z / cosh k_j d e^(-i k_j x) with
omega^2 = g k_j tanh k_j d: k_0 = k travels, k_j = -i kappa_j, j >= 1, stays near the piston.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import degrees, pi
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.waves.dispersion import wave_number
from houle.waves.wave import Array, Components, Wave, WaveError, ramp

Complex = NDArray[np.complex128]
MODES = 60  # modes that stay near the piston: with so many the double harmonic is within half a per cent
FEW = 4  # components up to which a motion is a sum of harmonics, not a spectrum
RETURN = 10.0  # periods in which a wall that has given way comes back to rest
LONG_PERIOD = 40.0  # longest period that counts for this [sqrt(d/g)]
LONGEST = 1e-3  # kd of long waves
TIMES = 2000  # instants at which the reach of a motion with a mean is looked for
NODES = 12  # points over the depth for the mean velocity
LAYERS = 40  # layers over the depth in which the pressure of a steady wave is read
LONG = 8 * pi**2 / 3  # H L^2 / d^3 from which on second order is not enough (Madsen 1971, J. Geophys. Res. 76, 8672)


def biesel(kd: ArrayLike) -> Array:
    """Wave height over stroke, far from the piston: 4 sinh^2 kd / (2 kd + sinh 2 kd)."""
    x = np.minimum(np.asarray(kd, dtype=float), 300.0)
    return 4 * np.sinh(x) ** 2 / (2 * x + np.sinh(2 * x))


def modes(omega: float, depth: float, gravity: float, count: int = MODES) -> Complex:
    """Wave numbers [rad/m] of the modes: k_0, which travels, and `count` k_j, which stay near the piston."""
    nu = omega**2 * depth / gravity  # = -y tan y, with y in ((j - 1/2) pi, j pi)
    j = np.arange(1, count + 1)
    y = j * pi - np.arctan(nu / (j * pi))
    for _ in range(50):
        y = j * pi - np.arctan(nu / y)
    return np.concatenate([[wave_number(omega, depth, gravity) + 0j], -1j * y / depth])


def response(k: Complex, depth: float) -> Complex:
    """Elevation of the modes at the piston over i times its displacement: c_j = sinh^2 k_j d / (k_j int cosh^2)."""
    x = k * depth
    return 4 * np.sinh(x) ** 2 / (2 * x + np.sinh(2 * x))


@dataclass(frozen=True)
class Motion:
    """Displacement of a piston as harmonics, Re{sum amplitude e^(i omega t)}, and its reading of its own wave.

    amplitude  complex amplitudes [m]
    order      1 or 2: the power of the ramp with which each harmonic grows
    reading    complex amplitudes of `Reading` [m] when only the wave that is sent out is there
    duration   time in which the wave grows [s]
    drift      velocity [m/s] with which the piston goes along with the mean of a record, a long wave: with the slow
               harmonics it rests before and after
    mean       reading of that long wave [m]
    """

    omega: Array
    amplitude: Complex
    order: NDArray[np.int64]
    reading: Complex
    duration: float
    drift: float = 0.0
    mean: float = 0.0

    def displacement(self, t: float) -> float:
        """Displacement from rest [m] at time t [s]."""
        return self._sum(self.amplitude, t) + float(ramp(t, self.duration)) * self.drift * t

    def way(self, t: float, dt: float, offset: float) -> float:
        return self.displacement(t + dt) - self.displacement(t)

    def expected(self, t: float, offset: float, read: Reading) -> float:
        return self._sum(self.reading, t) + float(ramp(t, self.duration)) * self.mean

    def _sum(self, amplitude: Complex, t: float) -> float:
        grown = float(ramp(t, self.duration))
        return float(np.sum(grown**self.order * np.real(amplitude * np.exp(1j * self.omega * t))))

    @property
    def theory(self) -> str:
        return "second order" if self.order.max() == 2 else "first order"

    @property
    def reach(self) -> tuple[float, float]:
        """Furthest displacements [m] from rest, to the left and to the right.

        For few harmonics it is their sum, for a spectrum that which 1 in 3000 waves exceeds, 2 Hs / 2. A piston that
        goes along with the mean of a record is followed until the record comes again.
        """
        if self.drift:
            times = np.linspace(0.0, 2 * pi / float(np.diff(self.omega).min()), TIMES)
            way = np.array([self.displacement(float(t)) for t in times])
            return float((way - way[0]).min()), float((way - way[0]).max())
        size = np.abs(self.amplitude)
        far = float(size.sum() if len(size) <= FEW else min(size.sum(), 4 * np.sqrt(np.sum(size**2) / 2)))
        return -far, far


@dataclass(frozen=True)
class Reading:
    """Reads the travelling wave from the pressure on a wall: the part that goes as cosh k z, in which no other mode is.

    The modes of one frequency are orthogonal over the depth, so what stays near the wall leaves no trace: unlike in the
    level at the wall, to which the wall's own acceleration adds. (Absorption from forces: Salter 1981.)
    """

    k: float
    depth: float
    gravity: float

    def weights(self, z: NDArray[np.floating], height: float) -> Array:
        """Elevation per p/(rho g) in layers of that height [m] with middles z [m]: exact for the travelling mode."""
        inside = np.clip(self.depth - (z - height / 2), 0.0, height) / height
        shape = np.cosh(self.k * np.minimum(z, self.depth))
        return inside * shape / np.sum(inside * shape**2) * np.cosh(self.k * self.depth)

    def of_modes(self, k: Complex) -> Complex:
        """Reading per elevation of each mode: 1 for the travelling one, 0 for the others of its frequency."""
        K, d = self.k, self.depth
        square = d / 2 + np.sinh(2 * K * d) / (4 * K)
        return overlap(k, K, d) * np.cosh(K * d) / square

    @property
    def omega(self) -> float:
        """Frequency of the waves that are taken up whole [rad/s]."""
        return float(np.sqrt(self.gravity * self.k * np.tanh(self.k * self.depth)))

    @property
    def speed(self) -> float:
        """Velocity of the wall per elevation of the wave it sends out or absorbs [1/s]."""
        return self.omega / float(biesel(self.k * self.depth))

    @property
    def back(self) -> float:
        """Rate [1/s] at which a wall that has given way comes back to rest."""
        longest = LONG_PERIOD * float(np.sqrt(self.depth / self.gravity))
        return 1.0 / (RETURN * min(2 * pi / self.omega, longest))

    def comes_back(self, omega: float) -> float:
        """Share of the amplitude of a wave of omega [rad/s] that a wall which absorbs by this reading sends back.

        Linear theory: the wall fixed sends all back; moving by X it adds i c_0 X, and it moves by what it reads of the
        wave before it, of what it adds and of what stays near it.
        """
        k = modes(omega, self.depth, self.gravity)
        c, seen = response(k, self.depth), self.of_modes(k)
        own = 1j * omega + self.back + 1j * self.speed * np.sum(c * seen)
        return float(abs(1.0 - 2j * self.speed * seen[0] * c[0] / own))


def overlap(a: ArrayLike, b: complex, depth: float) -> Complex:
    """int_0^d cosh a z cosh b z dz / cosh a d."""
    a = np.asarray(a, dtype=complex)
    a = np.where(np.abs(a - b) < 1e-9 * abs(b), a * (1 + 1e-6), a)
    return (a * np.tanh(a * depth) * np.cosh(b * depth) - b * np.sinh(b * depth)) / (a**2 - b**2)


def second_order(motion: Motion, depth: float, gravity: float, read: Reading) -> Motion:
    """The motion of one component with its double harmonic, and the reading of its own wave at both frequencies."""
    omega, first = float(motion.omega[0]), complex(motion.amplitude[0])
    second, reading = double_harmonic(omega, first, depth, gravity, read)
    return Motion(
        np.array([omega, 2 * omega]),
        np.array([first, second]),
        np.array([1, 2]),
        np.array([motion.reading[0], reading]),
        motion.duration,
    )


def double_harmonic(
    omega: float, first: complex, depth: float, gravity: float, read: Reading, count: int = MODES
) -> tuple[complex, complex]:
    """Displacement [m] at 2 omega that a piston needs beside `first` at omega to send out no free second harmonic.

    The second number is its reading at 2 omega [m]. phi_2 is the sum of bound waves, one for each pair of modes, and
    of free ones that stay near the piston and close the balance at its face, phi_2,x = X_2' - X_1 phi_1,xx. What is
    read is the pressure, -phi_2,t - |grad phi_1|^2 / 2 and the change of that of first order over X_1.
    """
    k = modes(omega, depth, gravity, count)
    b = -gravity / omega * first * response(k, depth)  # amplitudes of phi_1
    free = modes(2 * omega, depth, gravity, count)
    kj, kl = k[:, None], k[None, :]
    force = 1j * omega * np.outer(b, b) * (kj * kl + (kj**2 + kl**2) / 4 - 1.5 * omega**4 / gravity**2)
    both = kj + kl
    bound = force / (gravity * both * np.tanh(both * depth) - 4 * omega**2)

    def face(mode: complex) -> complex:  # flux of bound waves and first order at the face, over a mode
        through = 1j * np.sum(both * bound * overlap(both, mode, depth))
        return complex(through + 0.5 * first * np.sum(k**2 * b * overlap(k, mode, depth)))

    area = np.sinh(free * depth) / free  # int cosh over the depth, for each mode
    second = 0.5j / omega * face(free[0]) / area[0]
    square = depth / 2 + np.sinh(2 * free * depth) / (4 * free)
    left = np.array([2j * omega * second * a + face(f) for a, f in zip(area[1:], free[1:], strict=True)])
    near = 1j * left * np.cosh(free[1:] * depth) / (free[1:] * square[1:])
    z = (np.arange(LAYERS) + 0.5) * (depth / LAYERS)
    upward = (b * k / np.cosh(k * depth) * np.sinh(np.outer(z, k))).sum(-1)
    moved = 0.5 * omega**2 * first**2 - 0.25 * ((1j * omega * first) ** 2 + upward**2)
    read_phi = np.sum(bound * read.of_modes(both)) + np.sum(near * read.of_modes(free[1:]))
    reading = (-2j * omega * read_phi + np.sum(read.weights(z, depth / LAYERS) * moved)) / gravity
    return second, complex(reading)


def linear_motion(parts: Components, depth: float, gravity: float, x: float, read: Reading, duration: float) -> Motion:
    """The motion to first order, each component by itself; its crests pass x as those of the components would.

    The mean of a record is a long wave, with which the piston goes.
    """
    slow, parts = parts.mean, parts.moving
    there = parts.k * np.cos(parts.direction) * x + parts.phase
    wanted = parts.amplitude * np.exp(-1j * there)  # conjugate of e^(i (k x - omega t + phase)) at t = 0
    ways, readings = [], []
    for omega, elevation in zip(parts.omega, wanted, strict=True):
        k = modes(float(omega), depth, gravity)
        c = response(k, depth)
        ways.append(elevation / (1j * c[0]))
        readings.append(elevation * np.sum(c / c[0] * read.of_modes(k)))
    ones = np.ones(len(ways), np.int64)
    felt = slow * float(read.of_modes(np.array([LONGEST / depth + 0j]))[0].real)
    return Motion(
        parts.omega, np.array(ways), ones, np.array(readings), duration, slow * float(np.sqrt(gravity / depth)), felt
    )


class Law(Protocol):
    """The law by which a piston moves, and the reading of its own wave."""

    def way(self, t: float, dt: float, offset: float) -> float:
        """Way of the piston [m] from t to t + dt [s], when it stands at this offset from rest [m]."""

    def expected(self, t: float, offset: float, read: Reading) -> float:
        """The reading [m] on its face when no wave comes back."""

    @property
    def reach(self) -> tuple[float, float]:
        """Furthest offsets from rest, to the left and to the right [m]."""

    @property
    def theory(self) -> str:
        """The theory in words."""


@dataclass(frozen=True)
class Follower:
    """A piston at X that goes with the water, dX/dt = mean velocity over the depth in the wave at X (Goring 1979)."""

    wave: Wave
    rest: float
    duration: float

    @property
    def theory(self) -> str:
        return "goes with the water (Goring)"

    def speed(self, t: float, offset: float) -> float:
        x = np.array([self.rest + offset])
        level = self.wave.depth + float(self.wave.elevation(x, t)[0])
        return float(self.wave.flux(x, t, NODES)[0]) / level * float(ramp(t, self.duration))

    def way(self, t: float, dt: float, offset: float) -> float:
        """Way of the piston [m] by the midpoint rule: a time step is a hundredth of a period and less."""
        middle = offset + dt / 2 * self.speed(t, offset)
        return dt * self.speed(t + dt / 2, middle)

    def expected(self, t: float, offset: float, read: Reading) -> float:
        """Reading of its own wave [m]: the pressure by Bernoulli's law in the frame that runs with the wave."""
        w, z = self.wave, (np.arange(LAYERS) + 0.5) * (self.wave.depth / LAYERS)
        x = np.array([self.rest + offset])
        eta = float(w.elevation(x, t)[0])
        u, v = w.velocity(x, np.concatenate([z, [w.depth + eta]]), t)
        head = ((u - w.celerity) ** 2 + v**2) / (2 * w.gravity)
        weights = read.weights(z, w.depth / LAYERS)
        return float(ramp(t, self.duration)) * float(np.sum(weights * (eta + head[-1] - head[:-1])))

    @cached_property
    def reach(self) -> tuple[float, float]:
        """Furthest offsets from rest [m], to the left and to the right, found by moving it."""
        end = 3 * self.wave.period + self.duration
        if self.wave.components() is None:  # a single wave: until its tail has passed
            end = 3 * self.wave.length / self.wave.celerity
        times = np.linspace(0.0, end, 300)
        offsets = [0.0]
        for t, dt in zip(times, np.diff(times), strict=False):
            offsets.append(offsets[-1] + self.way(float(t), float(dt), offsets[-1]))
        return min(offsets), max(offsets)


def law_of(wave: Wave, rest: float, read: Reading, duration: float, *, regular: bool) -> Law:
    """The law of a piston, at rest at x = `rest` [m], that makes a wave. Raises WaveError for one that it cannot make.

    Long regular waves and single ones by following the water, other regular waves to second order, the rest to first.

    duration  time in which the wave grows [s]
    """
    if wave.direction:
        raise WaveError(
            f"waves.direction = {degrees(wave.direction):g}: a piston makes waves along x only; take waves.source"
        )
    parts = wave.components()
    if parts is None or (regular and wave.height * wave.length**2 > LONG * wave.depth**3):
        return Follower(wave, rest, duration)
    if not regular:
        return linear_motion(parts, wave.depth, wave.gravity, rest, read, duration)
    motion = linear_motion(parts.first, wave.depth, wave.gravity, rest, read, duration)
    return second_order(motion, wave.depth, wave.gravity, read)


def reading_of(wave: Wave | None, depth: float, gravity: float, period: float | None = None) -> Reading:
    """The reading for waves of a period [s]: by default that of the wave; for a single wave or none, of long waves."""
    if period is None and wave is not None and wave.components() is not None:
        period = wave.period
    k = float(wave_number(2 * pi / period, depth, gravity)) if period is not None else LONGEST / depth
    return Reading(k, depth, gravity)
