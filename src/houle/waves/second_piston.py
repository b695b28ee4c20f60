"""Wave maker theory to second order for sums of waves: how a piston must move to send out bound waves and no free ones.

The problem of Schaffer (1996, Ocean Engng. 23, 47), with all modes that stay near the piston, for every pair of
frequencies; `houle.waves.piston` has the conventions, and the same for one frequency. A difference is the sum with a
component of frequency -omega, whose modes are -k*. For a pair of displacements of 1 m, half of it counted for each
order of the pair, with K = k_j + k_l and W = omega_1 + omega_2 the bound potentials are

    (g K tanh K d - W^2) B = -i b_j b_l/2 {W (q_1 q_2 - k_j k_l) - r/2} ,    q = omega^2/g ,
    r = omega_1 k_l^2 + omega_2 k_j^2 - omega_1 omega_2 (omega_1^3 + omega_2^3)/g^2 ,

and at the face phi_2,x = X_2' - X_1 phi_1,xx. Its projection on the wave that is free to travel with W vanishes: X_2'.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import degrees, pi

import numpy as np

from houle.waves.pairs import Complex, Nodes
from houle.waves.piston import LAYERS, Motion, Reading, linear_motion, modes, overlap, response
from houle.waves.second_order import SLOWEST, SecondOrder, steady
from houle.waves.wave import Array, WaveError, ramp

PAIR_NODES = 24  # frequencies between which the transfer functions are interpolated
MODES, FOR_READING = 60, 12  # modes near the piston for its motion, and for the pressure on it
CLOSE = 3e-4  # relative distance of two frequencies below which the transfer function is its limit
WANDERS = 8.0  # times the slowest: faster differences are followed whole, to 1/4000
SAMPLES = 16  # instants in a peak period at which the slow velocity of a record is taken
TIMES, ROWS = 4000, 256  # instants at which the reach is looked for; those that are computed at a time


def transfer(
    first: float, second: float, depth: float, gravity: float, read: Reading | None = None
) -> tuple[complex, complex]:
    """Velocity [1/(m s)] of a piston and its reading [1/m], per product of two displacements.

    The frequency is first + second [rad/s]; a negative `second` stands for the conjugate of a component. The reading is
    that of the wave alone; 0 if no `read` is given.
    """
    count = MODES if read is None else FOR_READING
    (k, b), (m, c) = (_modes(omega, depth, gravity, count) for omega in (first, second))
    both, bound, total = k[:, None] + m, _bound(first, second, k, m, b, c, gravity), first + second
    bound = bound / (gravity * both * np.tanh(both * depth) - total**2)
    free = modes(abs(total), depth, gravity, count)

    def face(mode: complex) -> complex:  # i W X_2 of the bound waves and of first order at the face, over a mode
        through = 1j * np.sum(both * bound * overlap(both, mode, depth))
        moved = np.sum(k**2 * b * overlap(k, mode, depth)) + np.sum(m**2 * c * overlap(m, mode, depth))
        return complex(through + 0.25 * moved)

    velocity = -face(free[0]) * free[0] / np.sinh(free[0] * depth)
    if read is None:
        return complex(velocity), 0j
    area = np.sinh(free[1:] * depth) / free[1:]
    square = depth / 2 + np.sinh(2 * free[1:] * depth) / (4 * free[1:])
    left = velocity * area + np.array([face(mode) for mode in free[1:]])
    near = 1j * left * np.cosh(free[1:] * depth) / (free[1:] * square)
    seen = np.sum(bound * read.of_modes(both)) + np.sum(near * read.of_modes(free[1:]))
    z = (np.arange(LAYERS) + 0.5) * (depth / LAYERS)
    up, rise = ((size * n / np.cosh(n * depth) * np.sinh(np.outer(z, n))).sum(-1) for n, size in ((k, b), (m, c)))
    moved = (first * second / 2 + (first**2 + second**2) / 2 - up * rise / 2) / 2
    return complex(velocity), complex(-1j * total * seen + np.sum(read.weights(z, depth / LAYERS) * moved)) / gravity


def _modes(omega: float, depth: float, gravity: float, count: int) -> tuple[Complex, Complex]:
    """Wave numbers [rad/m] and potentials [m/s] of the modes of a displacement of 1 m; omega may be negative."""
    k = modes(abs(omega), depth, gravity, count)
    k = k if omega > 0 else -k.conj()
    return k, -gravity / omega * response(k, depth)


def _bound(first: float, second: float, k: Complex, m: Complex, b: Complex, c: Complex, gravity: float) -> Complex:
    """Drive of the bound potentials of all pairs of modes [m/s3]."""
    j, n, g = k[:, None], m[None, :], gravity
    turn = (first + second) * ((first * second / g) ** 2 - j * n)
    rise = first * n**2 + second * j**2 - first * second * (first**3 + second**3) / g**2
    return np.asarray(-0.5j * np.outer(b, c) * (turn - rise / 2))


@lru_cache(maxsize=8)
def _tables(omega: tuple[float, ...], depth: float, gravity: float, read: Reading | None) -> tuple[Complex, ...]:
    """Velocity and reading of the sums (n, n), then of the differences, of all pairs of these frequencies [rad/s]."""
    found = np.zeros((4, len(omega), len(omega)), complex)
    for i, j in zip(*np.triu_indices(len(omega)), strict=True):
        for at, sign in ((0, 1), (2, -1)):
            first, second = omega[i], omega[j]
            if sign < 0 and abs(first - second) < CLOSE * (first + second):
                middle = (first + second) / 2
                first, second = middle * (1 + CLOSE), middle * (1 - CLOSE)
            velocity, _ = transfer(first, sign * second, depth, gravity)
            seen = transfer(first, sign * second, depth, gravity, read)[1] if read is not None else 0j
            found[at : at + 2, i, j] = velocity, seen
            found[at : at + 2, j, i] = (velocity, seen) if sign > 0 else (velocity.conjugate(), seen.conjugate())
    for at in (2, 3):  # the differences of a frequency with itself are a mean
        np.fill_diagonal(found[at], found[at].diagonal().real)
    return tuple(found)


@dataclass(frozen=True)
class PairMotion:
    """Motion of a piston to second order: that of first order, and what the pairs of its components ask for.

    What is slow in the second order would start with a jump; so it is its velocity that grows with the ramp squared.

    first      motion of first order
    omega      frequencies of the components with bound waves [rad/s]; phasors (N, m): vectors of the sums over pairs
    speed      velocity [m/s] of the sums and of the differences between the vectors, (m, m) each; reading: the same [m]
    slow       frequencies of slow differences [rad/s] with which the piston would wander
    held       complex amplitudes [m] of the displacement in them that it leaves out
    mean       velocity [m/s] and reading [m] of the components with themselves that it leaves out
    """

    first: Motion
    omega: Array
    phasors: Complex
    speed: tuple[Complex, Complex]
    reading: tuple[Complex, Complex]
    slow: Array
    held: Complex
    mean: tuple[float, float]

    theory = "second order"

    def way(self, t: float, dt: float, offset: float) -> float:
        """Way of the piston [m], that of second order by the midpoint rule: a time step is a hundredth of a period."""
        middle = t + dt / 2
        grown = float(ramp(middle, self.first.duration)) ** 2
        way = dt * float(self.velocity(np.array([middle]))[0])
        return self.first.way(t, dt, offset) + grown * way

    def velocity(self, t: Array) -> Array:
        """Velocity of second order at the times t (n,) [s], without its ramp [m/s]."""
        held = np.real(1j * self.slow * self.held * np.exp(1j * self.slow * t[:, None])).sum(-1)
        return self._sum(self.speed, t) - held - self.mean[0]

    def expected(self, t: float, offset: float, read: Reading) -> float:
        grown = float(ramp(t, self.first.duration)) ** 2
        second = float(self._sum(self.reading, np.array([t]))[0]) - self.mean[1]
        return self.first.expected(t, offset, read) + grown * second

    def _sum(self, kernels: tuple[Complex, Complex], t: Array) -> Array:
        f = np.einsum("ti,im->tm", np.exp(1j * self.omega * t[:, None]), self.phasors, optimize=False)
        sums, differences = kernels
        rows = np.einsum("ta,ab->tb", f, sums, optimize=False), np.einsum("ta,ab->tb", f, differences, optimize=False)
        return np.asarray((rows[0] * f + rows[1] * f.conj()).real.sum(-1))

    @property
    def differences(self) -> PairMotion:
        """The motion without its sums of frequencies."""
        return replace(self, speed=(np.zeros_like(self.speed[0]), self.speed[1]))

    @cached_property
    def reach(self) -> tuple[float, float]:
        """Furthest displacements [m] from rest that are to be expected, to the left and to the right.

        The slow ones are followed until the components come again, or those of a sea would with equal steps.
        """
        low, high = self.first.reach
        if len(self.omega) < 2:
            return low, high
        times: Array = np.asarray(np.linspace(0.0, 2 * pi / float(np.median(np.diff(self.omega))), TIMES), dtype=float)
        followed = self.differences
        slow = np.concatenate([followed.velocity(times[i : i + ROWS]) for i in range(0, len(times), ROWS)])
        way = np.concatenate([[0.0], np.cumsum((slow[1:] + slow[:-1]) / 2 * np.diff(times))])
        return low + float(way.min()), high + float(way.max())


def pair_motion(wave: SecondOrder, rest: float, read: Reading, duration: float, absorbs: bool) -> PairMotion:
    """The motion that sends the wave out from a piston at rest at x = `rest` [m], growing in `duration` [s].

    absorbs: whether the reading is asked for. Raises WaveError for oblique waves.
    """
    if wave.direction:
        raise WaveError(f"waves.direction = {degrees(wave.direction):g}: a piston makes waves along x only")
    first = linear_motion(wave.parts, wave.depth, wave.gravity, rest, read, duration)
    taken = np.isin(first.omega, wave.pairs.omega)
    omega, size = first.omega[taken], first.amplitude[taken]
    nodes = Nodes.of(omega, np.abs(size), PAIR_NODES)
    tables = _tables(tuple(map(float, nodes.omega)), wave.depth, wave.gravity, read if absorbs else None)
    sums, seen, differences, seen_slow = (nodes.led(table) for table in tables)
    phasors = nodes.unit * (size / np.abs(size))[:, None]
    found = PairMotion(
        first, omega, phasors, (sums, differences), (seen, seen_slow), np.zeros(0), np.zeros(0, complex), (0.0, 0.0)
    )
    if not wave.closed:
        return found
    mean, level = (float(np.sum((phasors @ kernel) * phasors.conj()).real) for kernel in (differences, seen_slow))
    peak = wave.peak
    found = replace(found, mean=(mean, level))
    slow, held = _of_record(found, wave.step, peak) if wave.step else _wandering(omega, phasors, differences, peak)
    return replace(found, slow=slow, held=held)


def _of_record(motion: PairMotion, step: float, peak: float) -> tuple[Array, Complex]:
    """As `_wandering` for frequencies that are multiples of `step` [rad/s]: from the velocity over their period."""
    count = 2 * int(np.ceil(SAMPLES * peak / step / 2))
    times: Array = np.asarray(2 * pi / step / count * np.arange(count), dtype=float)
    slow = motion.differences
    velocity = np.concatenate([slow.velocity(times[i : i + ROWS]) for i in range(0, count, ROWS)])
    kept = slice(1, int(WANDERS * peak / SLOWEST / step) + 1)
    speed: Complex = (2 / count * np.fft.rfft(velocity))[kept]
    line: Array = np.asarray(step * np.arange(count // 2 + 1)[kept], dtype=float)
    return line, np.asarray((1 - steady(line, peak)) * speed / (1j * line))


def _wandering(omega: Array, phasors: Complex, differences: Complex, peak: float) -> tuple[Array, Complex]:
    """Slow differences [rad/s] and the complex amplitudes [m] of the displacement in them that a piston leaves out.

    It follows them with the share `steady`: it would go far in the slow ones, and never come back.
    """
    n, m = np.triu_indices(len(omega), 1)
    n, m = (m, n) if omega[-1] > omega[0] else (n, m)
    line = omega[n] - omega[m]
    near = (line > 0) & (line < WANDERS * peak / SLOWEST)
    n, m, line = n[near], m[near], line[near]
    speed = 2 * np.einsum("ia,ab,ib->i", phasors[n], differences, phasors[m].conj(), optimize=True)
    return line, (1 - steady(line, peak)) * speed / (1j * line)
