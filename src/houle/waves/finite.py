"""The force that makes waves of finite height, found from the waves that are wanted.

A force that is the gradient of a potential P(x, y, t), uniform over the depth, makes no curl; what it changes is
Bernoulli's equation at the surface. So the surface can be given any motion: take the elevation eta that is wanted, find
the potential flow under it, and P is what Bernoulli's equation lacks,

    P = phi_t + g eta + (grad phi)^2 / 2 - W^2 (1 + (grad eta)^2) / 2

(Zakharov 1968; phi(x, y, t) the potential at the surface, W its vertical derivative there, div and grad horizontal).
Wanted are the waves of theory, let grow by s(x) from 0 to 1 over the source in a way that keeps their water together:

    eta = -div grad (s Y),    Y = sum E_j / (j k)^2 cos j theta,    theta = k_x x + k_y y - omega t

Where s is 0 the water rests, where it is 1 the flow is that of theory and P a constant in space: the force is as wide
as the source, and the waves that leave it have their bound harmonics and no free ones. To first order, and for an s
that grows slowly, it is the source of JH2020 (4), (5). Waves to the left are the mirror image; to both sides, the sum
of both in eta. The expansion of Dommermuth & Yue (1987) and West et al. (1987) gives the rise of the surface over a
known potential. Here the rise is known, and repeated substitution finds the potential, on a grid of places x phases.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

from houle.waves.wave import Array, Wave, WaveError

Spectrum = NDArray[np.complex128]

SHARPNESS = 20.0  # beta width^2 of the source (JH2020 (4); Wei, Kirby & Sinha 1999)
PHASES, POINTS = 48, 48  # points of the grid in a period; in a wavelength along x
FLAT, WHOLE = (
    3.0,
    8.0,
)  # lengths of full waves, and of the periodic stretch of water: wavelengths, or widths of the source
ORDER = 7  # order of the expansion
SHORTEST = 2.5  # largest k eta that is kept: beyond it the expansion diverges
ITERATIONS, CONVERGED = 200, 1e-6  # steps of the substitution; the largest error of d eta/dt that it leaves, relative
NEGLIGIBLE = 1e-5  # harmonics of the force beside the first


@dataclass(frozen=True)
class Potential:
    """P = sum_n Re(p_n(x) exp(-i n tau)), tau = omega t - k_y y less the phase of the wave in the middle of the source.

    x (N,) from the middle [m]; value (M, N): p_n [m2/s2]; along (M, N): d p_n / dx [m/s2]. `value` lacks the
    part that is linear in x, of waves along x.
    """

    x: Array
    along: Spectrum
    value: Spectrum


@dataclass
class _Water:
    """A periodic stretch of water on a grid (phases, places): derivatives, and the flow under its surface."""

    x: Array
    omega: float
    k_y: float
    depth: float
    highest: float = 0.0  # elevation that the expansion must carry [m]

    def __post_init__(self) -> None:
        count = len(self.x)
        k_x = 2 * pi * np.fft.rfftfreq(count, self.x[1] - self.x[0])
        self.n = np.fft.fftfreq(PHASES, 1.0 / PHASES)[:, None]
        self.by_x = 1j * k_x * (np.arange(len(k_x)) < count // 2)
        self.k = np.hypot(k_x, self.k_y * self.n)
        self.tanh = np.tanh(self.k * self.depth)
        shortest = min(SHORTEST / self.highest, 0.6 * k_x[-1]) if self.highest else 0.6 * k_x[-1]
        keep = (self.k < shortest) & (np.abs(self.n) < PHASES / 3)
        self.keep = keep.astype(float)
        with np.errstate(divide="ignore", invalid="ignore"):
            self.inverse = np.where(self.k > 0, keep / (self.k * self.tanh), 0.0)

    def to(self, field: Array) -> Spectrum:
        return np.fft.rfft2(field) * self.keep

    def back(self, spectrum: Spectrum) -> Array:
        return np.fft.irfft2(spectrum, s=(PHASES, len(self.x)))

    def by_t(self, spectrum: Spectrum) -> Spectrum:
        """Derivative by t: tau runs as t does, and a mode goes as exp(i n tau)."""
        return 1j * self.omega * self.n * spectrum

    def by_y(self, spectrum: Spectrum) -> Spectrum:
        return -1j * self.k_y * self.n * spectrum

    def rise(self, phi: Spectrum, powers: list[Array]) -> Array:
        """W = d phi/dz at the surface for a potential phi there; powers: eta^m / m! for m = 0..ORDER-1."""
        orders, total = [phi], np.zeros_like(powers[0])
        for m in range(ORDER):
            if m:
                orders.append(-self.to(self._sum(powers[1 : m + 1], orders[::-1], 1)))
            total += self._sum(powers[: m + 1], orders[::-1], 1)
        return total

    def _sum(self, powers: list[Array], orders: list[Spectrum], first: int) -> Array:
        """Sum over i of eta^i / i! times the i-th derivative by z of the order that goes with it."""
        total = np.zeros_like(powers[0])
        for i, (power, order) in enumerate(zip(powers, orders, strict=False), start=first):
            total += power * self.back(order * self.k**i * (self.tanh if i % 2 else 1.0))
        return total


@lru_cache(maxsize=8)
def potential(wave: Wave, width: float, sides: tuple[bool, bool]) -> Potential:
    """Potential of a source of this width [m] that sends the wave, of constant form, to the (right, left).

    Raises WaveError if the wave is too steep for it.
    """
    parts = wave.components()
    assert parts is not None
    cos = float(np.cos(wave.direction))
    k, k_x, k_y = wave.k, wave.k * cos, wave.k * float(np.sin(wave.direction))
    unit = max(width, 2 * pi / k_x)
    count = 2 * ceil(POINTS * WHOLE * unit * k_x / (4 * pi))
    x = (np.arange(count) / count - 0.5) * WHOLE * unit
    water = _Water(x, wave.omega, k_y, wave.depth)
    tau = np.arange(PHASES)[:, None] * (2 * pi / PHASES)
    j = np.arange(1, min(len(parts.amplitude), PHASES // 3) + 1)
    size = parts.amplitude[: len(j)] / (j * k) ** 2
    grown = (_step(x, k_x, width) - _step(x - FLAT * unit, k_x, width)) * np.exp(1j * k_x * x)
    form = np.zeros((PHASES, count))
    for wanted, first in zip(sides, (grown, _mirrored(grown)), strict=True):
        if wanted:
            power = first * np.exp(-1j * tau)
            form += sum(a * (power**i).real for i, a in zip(j, size, strict=True))
    eta = water.to(form) * water.k**2
    water = _Water(x, wave.omega, k_y, wave.depth, highest=float(np.abs(water.back(eta)).max()))
    eta *= water.keep
    phi, drift = _under(water, eta, along_x=k_y == 0.0)
    missing = _bernoulli(water, eta, phi, drift, wave.gravity)
    along = np.fft.fft(water.back(missing * water.by_x) + _rate(water, drift)[:, None], axis=0)
    return _harmonics(x, along, np.fft.fft(water.back(missing), axis=0))


def _step(x: Array, k: float, width: float) -> Spectrum:
    """The growth s (N,) of waves of wave number k that begin at x = 0, smoothed with the bell of JH2020 (4)."""
    from scipy.special import erf

    sharp = np.sqrt(SHARPNESS) / width
    return np.asarray(0.5 + 0.5 * erf(sharp * x + 0.5j * k / sharp))


def _mirrored(values: Spectrum) -> Spectrum:
    """values(-x), on a periodic grid whose middle is at half its length."""
    return np.roll(values[::-1], 1)


def _under(water: _Water, eta: Spectrum, along_x: bool) -> tuple[Spectrum, Array]:
    """The potential phi at the surface, and a uniform current (phases,) along x such that water without waves rests.

    along_x: all waves go along x, and each phase has its current; else all have the mean over the crests.
    """
    surface, rate = water.back(eta), water.back(water.by_t(eta))
    slope_x, slope_y = water.back(water.by_x * eta), water.back(water.by_y(eta))
    steep, powers = 1 + slope_x**2 + slope_y**2, [np.ones_like(surface)]
    for m in range(1, ORDER):
        powers.append(powers[-1] * surface / m)
    quiet = slice(0, max(1, len(water.x) // 64))
    phi, drift = np.zeros_like(eta), np.zeros(PHASES)
    for _ in range(ITERATIONS):
        speed_x, speed_y = water.back(water.by_x * phi), water.back(water.by_y(phi))
        drift = -speed_x[:, quiet].mean(axis=1)
        drift = drift if along_x else np.full(PHASES, drift.mean())
        rest = rate + (speed_x + drift[:, None]) * slope_x + speed_y * slope_y - water.rise(phi, powers) * steep
        left = water.to(rest)
        phi = phi + left * water.inverse
        error = float(np.abs(water.back(left)).max()) / float(np.abs(rate).max())
        if error < CONVERGED:
            return phi, drift
        if not error < 1e3:
            break
    raise WaveError(
        f"waves.source: no flow was found in which waves grow to {water.highest:.3g} m above still water in a source "
        'this narrow: leave width out (a wavelength), or give a lower height, or take waves.zone, or form = "linear"'
    )


def _bernoulli(water: _Water, eta: Spectrum, phi: Spectrum, drift: Array, gravity: float) -> Spectrum:
    """The potential P of the force, less the share of the current that changes in time (`_rate`)."""
    slope_x, slope_y = water.back(water.by_x * eta), water.back(water.by_y(eta))
    speed_x, speed_y = water.back(water.by_x * phi) + drift[:, None], water.back(water.by_y(phi))
    steep = 1 + slope_x**2 + slope_y**2
    rise = (water.back(water.by_t(eta)) + speed_x * slope_x + speed_y * slope_y) / steep
    return water.by_t(phi) + gravity * eta + water.to((speed_x**2 + speed_y**2 - rise**2 * steep) / 2)


def _rate(water: _Water, drift: Array) -> Array:
    """Change in time (phases,) of the current along x."""
    return np.asarray(np.fft.ifft(1j * water.omega * water.n[:, 0] * np.fft.fft(drift)).real)


def _harmonics(x: Array, along: Spectrum, value: Spectrum) -> Potential:
    """Harmonics of the phases (FFT along axis 0, exp(+i n tau)), as coefficients of exp(-i n tau)."""
    weight = np.where(np.arange(PHASES // 2) == 0, 1.0, 2.0)[:, None] / PHASES
    size = np.abs(along[: PHASES // 2]).max(axis=1)
    count = int(np.flatnonzero(size > NEGLIGIBLE * size[1]).max()) + 1
    return Potential(x, *(f[:count].conj() * weight[:count] for f in (along, value)))
