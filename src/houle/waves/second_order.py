"""Sums of linear waves to second order: the bound waves at the sums and the differences of all frequencies.

Sharma & Dean (1981, Soc. Petrol. Engrs. J. 21, 129), Longuet-Higgins & Stewart (1962), for waves along one line. At the
still water level, z = d, with eta_1 = sum a_i cos theta_i and q_i = omega_i^2 / g,

    phi_2,tt + g phi_2,z = -[(grad phi_1)^2]_t - eta_1 (phi_1,tt + g phi_1,z)_z
    g eta_2 = -phi_2,t - (grad phi_1)^2 / 2 - eta_1 phi_1,tz ,

of which each pair of components gives, with K = k_i +- k_j, W = omega_i +- omega_j, and the ordered pairs summed,

    phi_2 = 1/2 sum a_i a_j P cosh(K z)/cosh(K d) sin(theta_i +- theta_j)
    (g K tanh K d - W^2) P = -W g^2/(omega_i omega_j) (k_i k_j -+ q_i q_j) - (c_i +- c_j)/2
    c = (g^2 k^2 - omega^4)/omega
    eta_2 = 1/(2g) sum a_i a_j [W P - g^2/(2 omega_i omega_j) (k_i k_j -+ q_i q_j) + (omega_i^2 + omega_j^2)/2] cos( ) .

A component with itself makes a mean. In a sea the mean level is the still water level and no water is pumped, as in all
waves here (`closed`): the mean of eta_2 is left out, and the mean of u is that which takes back the transport of the
crests. A group that comes and goes has water at rest before and after it, and keeps its set-down and the flux of that.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from houle.waves import dispersion
from houle.waves.linear import Linear, _product, profiles
from houle.waves.pairs import Complex, Nodes
from houle.waves.wave import Array, Components

PAIRED = 0.499, 3.501  # frequencies of the components that have bound waves, in peak frequencies
SLOWEST = 64.0  # peak periods: slower differences are, in a sea, less than half waves
NEAR = 1e-4  # relative difference of two frequencies below which the kernel of differences is its limit
ROWS = 256  # places that are computed at a time
LEVELS = 9  # levels at which the velocity decides which vectors are needed
KEPT = 4  # sets of levels whose tables are kept


@dataclass(frozen=True)
class Kernel:
    """The waves bound to pairs of frequencies, per product of two amplitudes, half counted for each order of a pair.

    wave    wave number K of the pair [rad/m], with its sign; omega: W [rad/s]
    level   elevation [1/m]
    speed   velocity u at the still water level [1/(m s)], K P / 2
    """

    wave: Array
    omega: Array
    level: Array
    speed: Array

    @classmethod
    def of(cls, first: Array, second: Array, depth: float, gravity: float, sign: int) -> Kernel:
        """The kernel of the sums (sign = 1) or differences (-1) of frequencies `first` and `second` [rad/s]."""
        g, a, b = gravity, *np.broadcast_arrays(first, second)
        if sign < 0:
            middle, close = (a + b) / 2, np.abs(a - b) < NEAR * (a + b)
            a, b = np.where(close, middle * (1 + NEAR), a), np.where(close, middle * (1 - NEAR), b)
        k, m = (dispersion.wave_number(v, depth, g) for v in (a, b))
        wave, omega = k + sign * m, a + sign * b
        square = g**2 / (a * b) * (k * m - sign * (a * b / g) ** 2)  # (grad phi_1)^2
        rise = ((g * k) ** 2 - a**4) / a + sign * ((g * m) ** 2 - b**4) / b
        potential = -(omega * square + rise / 2) / (g * wave * np.tanh(wave * depth) - omega**2)
        level = (omega * potential - square / 2 + (a**2 + b**2) / 2) / (2 * g)
        return cls(wave, omega, level, wave * potential / 2)

    def along(self, z: Array, depth: float) -> Array:
        """Kernel of u at the levels z (nz,) [m]: (nz, ...). Above the still water level it is that at it."""
        return self.speed * _hyperbolic(self.wave, z, depth, 1.0)

    def up(self, z: Array, depth: float) -> Array:
        """Kernel of w at the levels z (nz,) [m], which goes with the sine: (nz, ...)."""
        return self.speed * _hyperbolic(self.wave, z, depth, -1.0)


def _hyperbolic(k: Array, z: Array, depth: float, sign: float) -> Array:
    """cosh(k z)/cosh(k d) for sign = 1, sinh(k z)/cosh(k d) for -1, (nz, *k.shape); z counts up to the depth."""
    x, low = np.abs(k), np.minimum(np.asarray(z, dtype=float), depth).reshape((-1,) + (1,) * np.ndim(k))
    value = (np.exp(x * (low - depth)) + sign * np.exp(-x * (low + depth))) / (1 + np.exp(-2 * x * depth))
    return np.asarray(value if sign > 0 else np.sign(k) * value)


def steady(omega: Array, peak: float) -> Array:
    """Share of a frequency [rad/s] in the bound waves of a sea that counts as waves, and not as its mean state."""
    return np.asarray(omega**4 / (omega**4 + (peak / SLOWEST) ** 4))


@dataclass(frozen=True)
class SecondOrder(Linear):
    """A sum of Airy waves with the waves bound to them.

    closed  True for a sea, without a mean level or transport; False for a group, before and after which all is at rest
    step    frequency of which those of a record are multiples [rad/s]; 0 for others
    band    least and largest frequency of the components that have waves bound to them [rad/s]
    """

    closed: bool = True
    step: float = 0.0
    band: tuple[float, float] = (0.0, np.inf)

    @classmethod
    def of_linear(cls, wave: Linear, closed: bool, peak: float | None = None, step: float = 0.0) -> SecondOrder:
        """The wave with its bound waves.

        peak, step: of a record, its peak frequency [rad/s] and that of which its frequencies are multiples. The peak
        decides which components have bound waves; without it that of the wave does, and the bound waves raise the level
        that no crest is expected to pass. Waves shorter than sqrt(2 g / Hm0) have none: they ride on the long ones,
        which the expansion would take for a growth in height (Stansberg 1998; DNV-RP-C205).
        """
        given = {f.name: getattr(wave, f.name) for f in fields(Linear)}
        if peak is None:
            sigma = dispersion.frequency(np.array([wave.k]), wave.depth, wave.gravity)
            given["highest"] += float(Kernel.of(sigma, sigma, wave.depth, wave.gravity, 1).level[0]) * wave.highest**2
        middle, height = peak or wave.omega, 4 * float(np.sqrt(np.sum(wave.parts.moving.amplitude**2) / 2))
        highest = min(PAIRED[1] * middle, float(np.sqrt(2 * wave.gravity / height)))
        return cls(**given, closed=closed, step=step, band=(PAIRED[0] * middle, highest))

    @property
    def peak(self) -> float:
        """Peak frequency [rad/s]; that of a record is not the frequency of its largest component."""
        return self.band[0] / PAIRED[0]

    @cached_property
    def pairs(self) -> Components:
        """The components that have waves bound to them."""
        return self.parts.chosen((self.parts.omega > self.band[0]) & (self.parts.omega < self.band[1]))

    @cached_property
    def _nodes(self) -> Nodes:
        sigma = dispersion.frequency(self.pairs.k, self.depth, self.gravity)  # seen from the water, on a current
        return Nodes.of(sigma, self.pairs.amplitude)

    @cached_property
    def kernels(self) -> tuple[Kernel, Kernel]:
        """The kernels of the sums and of the differences of the frequencies of the nodes."""
        omega = self._nodes.omega
        sums, differences = (Kernel.of(omega[:, None], omega, self.depth, self.gravity, s) for s in (1, -1))
        return sums, differences

    @property
    def sizes(self) -> tuple[float, float]:
        """Significant heights, 4 times the rms [m], of the bound waves at the sums and at the differences."""
        found = []
        for kernel, alone in zip(self.kernels, (0.5, 1.0), strict=True):
            led = self._nodes.led(kernel.level)
            own = np.einsum("ia,ab,ib->i", self._nodes.unit, led, self._nodes.unit, optimize=True)
            found.append(4 * float(np.sqrt(np.sum(led**2) - alone * np.sum(own**2))))
        return found[0], found[1]

    @cached_property
    def _vectors(self) -> Array:
        z = np.linspace(0.0, self.depth, LEVELS)
        given = [k.level for k in self.kernels] + [k.along(z, self.depth) for k in self.kernels]
        return self._nodes.few(given, self._profile(np.append(z, self.depth + self.highest)))

    def _profile(self, z: Array) -> Array:
        """The velocity u of first order per amplitude at the nodes, at the levels z (nz,) [m]: (nz, n) [1/s]."""
        k = dispersion.wave_number(self._nodes.omega, self.depth, self.gravity)
        speed = dispersion.celerity(k, self.depth, self.gravity)
        return np.asarray(speed * profiles(k, self._level(z), self.depth)[0])

    @cached_property
    def _others(self) -> Linear | None:
        """The components without bound waves; None if all have them."""
        kept = np.isin(self.parts.omega, self.pairs.omega)
        given = {f.name: getattr(self, f.name) for f in fields(Linear)}
        return None if kept.all() else Linear(**(given | {"parts": self.parts.chosen(~kept)}))

    @cached_property
    def _basis(self) -> Array:
        """The vectors v_r (R, N)."""
        return np.ascontiguousarray((self._nodes.unit @ self._vectors).T)

    def _few(self, kernel: Array) -> Array:
        """A kernel (..., n, n) at the nodes as one between the vectors, (..., R, R)."""
        return self._vectors.T @ self._nodes.led(kernel) @ self._vectors

    def _table(self, sums: Array, differences: Array) -> Array:
        """Two kernels (m, n, n) at the nodes as numbers per product of two F, (m, R (R + 1)); see `_products`."""
        few = [self._few(kernel) for kernel in (sums, differences)]
        r, s = np.triu_indices(self._vectors.shape[1])
        return np.concatenate([np.where(r == s, 1.0, 2.0) * table[:, r, s] for table in few], axis=1)

    def _products(self, x: Array, t: ArrayLike) -> Complex:
        """F_r F_s, then F_r F*_s, for r <= s: (nx, R (R + 1))."""
        p = self.pairs
        theta = p.k * x[:, None] - p.omega * np.asarray(t, dtype=float)[..., None] + p.phase
        return _products(_product(np.cos(theta), self._basis) + 1j * _product(np.sin(theta), self._basis))

    def _sums(self, x: Array, t: float) -> Complex:
        """F (nx, R) at one time [s]; the places are kept from one time to the next."""
        key = x.tobytes()
        if key not in self._places:
            self._places.clear()
            theta = self.pairs.k * x[:, None] + self.pairs.phase
            self._places[key] = np.cos(theta), np.sin(theta)
        (cos, sin), turn = self._places[key], self.pairs.omega * t
        ahead, across = self._basis * np.cos(turn), self._basis * np.sin(turn)
        return _product(cos, ahead) + _product(sin, across) + 1j * (_product(sin, ahead) - _product(cos, across))

    @cached_property
    def _places(self) -> dict[bytes, tuple[Array, Array]]:
        return {}

    @cached_property
    def _levels(self) -> Array:
        return self._table(*(k.level[None] for k in self.kernels))[0]

    @cached_property
    def _still(self) -> tuple[float, float]:
        """Mean level [m] and mean velocity [m/s] that are taken off in a closed flume."""
        if not self.closed:
            return 0.0, 0.0
        p, sigma = self.pairs, dispersion.frequency(self.pairs.k, self.depth, self.gravity)
        alone = Kernel.of(sigma, sigma, self.depth, self.gravity, -1)
        carried = p.amplitude**2 * self.gravity * p.k / (2 * sigma * self.depth)
        return float(np.sum(p.amplitude**2 * alone.level)), float(np.sum(p.amplitude**2 * alone.speed + carried))

    @cached_property
    def _tables(self) -> dict[bytes, tuple[Array, Array]]:
        return {}

    def _speeds(self, z: Array) -> tuple[Array, Array]:
        """Tables of u and w at the levels z (nz,) [m], kept for the last few sets of levels."""
        key = z.tobytes()
        if key not in self._tables:
            while len(self._tables) >= KEPT:
                self._tables.pop(next(iter(self._tables)))
            u = self._table(*(k.along(z, self.depth) for k in self.kernels))
            sums, differences = (k.up(z, self.depth) for k in self.kernels)
            w = self._table(sums, (differences - differences.swapaxes(1, 2)) / 2)  # no w of a wave with itself
            self._tables[key] = u, w
        return self._tables[key]

    def _along(self, z: Array) -> Array:
        """Table of u of first and second order at the levels z (nz,) [m], (nz, R + R (R + 1))."""
        key = b"along" + z.tobytes()
        if key not in self._tables:
            first = self._profile(z) @ self._nodes.lead.T @ self._vectors
            both = np.concatenate([first, self._speeds(z)[0]], axis=1)
            self._tables[key] = both, both
        return self._tables[key][0]

    def bound(self, x: ArrayLike, t: ArrayLike) -> Array:
        """The elevation of second order [m], at x [m] and t [s], broadcast."""
        x, t = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(t, dtype=float))
        out = np.empty(x.size)
        for i in range(0, x.size, ROWS):
            products = self._products(x.flat[i : i + ROWS], t.flat[i : i + ROWS])
            out[i : i + ROWS] = np.einsum("xp,p->x", products.real, self._levels, optimize=False)
        return out.reshape(x.shape) - self._still[0]

    def bound_record(self, place: float, start: float, step: float, count: int) -> Array:
        """As `bound` at x = place [m] and times start + n step [s], for components whose period is count steps.

        The mean level of a sea is here the slow part of the level, so that nothing is left where the record is at rest.
        """
        p = self.pairs
        line = np.rint(p.omega * count * step / (2 * np.pi)).astype(int)
        turned = self._basis * np.exp(1j * (p.k * place - p.omega * start + p.phase))
        spectrum = np.zeros((len(turned), count), complex)
        spectrum[:, line] = turned
        f = np.fft.fft(spectrum, axis=1).T
        sums, differences = (self._few(kernel.level) for kernel in self.kernels)
        bound = np.asarray(((f @ sums + f.conj() @ differences) * f).real.sum(-1))
        if not self.closed:
            return bound
        lines, omega = (
            np.fft.rfft(bound),
            np.asarray(2 * np.pi / (count * step) * np.arange(count // 2 + 1), dtype=float),
        )
        return np.asarray(np.fft.irfft(lines * steady(omega, self.peak), count))

    def elevation(self, x: ArrayLike, t: ArrayLike) -> Array:
        return super().elevation(x, t) + self.bound(x, t)

    def velocity_on(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        u, w = super().velocity_on(x, z, t)
        products = self._products(np.asarray(x, dtype=float), t)
        tables = self._speeds(np.asarray(z, dtype=float))
        return u + _product(products.real.copy(), tables[0]) - self._still[1], w + _product(
            products.imag.copy(), tables[1]
        )

    def along_on(self, x: ArrayLike, z: ArrayLike, t: float) -> Array:
        x, z = np.asarray(x, dtype=float), np.asarray(z, dtype=float)
        f = self._sums(x, t)
        u = _product(np.concatenate([f.real, _products(f).real], axis=1), self._along(z)) - self._still[1]
        return u if self._others is None else u + self._others.along_on(x, z, t)

    def up_on(self, x: ArrayLike, z: ArrayLike, t: float) -> Array:
        return self.velocity_on(x, z, t)[1]

    def velocity(self, x: ArrayLike, z: ArrayLike, t: float) -> tuple[Array, Array]:
        x, z = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(z, dtype=float))
        u, w = super().velocity(x, z, t)
        more = np.empty((2, x.size))
        for i in range(0, x.size, ROWS):
            products = self._products(x.flat[i : i + ROWS], t)
            tables = self._speeds(z.flat[i : i + ROWS].copy())
            for out, part, table in zip(more, (products.real, products.imag), tables, strict=True):
                out[i : i + ROWS] = (part * table).sum(-1)
        return u + more[0].reshape(x.shape) - self._still[1], w + more[1].reshape(x.shape)


def _products(f: Complex) -> Complex:
    """F_r F_s, then F_r F*_s, for r <= s: (n, R) -> (n, R (R + 1))."""
    r, s = np.triu_indices(f.shape[1])
    return np.concatenate([f[:, r] * f[:, s], f[:, r] * f[:, s].conj()], axis=1)
