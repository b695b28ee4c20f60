"""Incident, reflected and transmitted wave energy, as pieces that can be resampled: one per period, or per frequency.

A wave of complex amplitude Z has the energy |Z|^2 here: only ratios count. Noise adds its own energy to a small
wave. It is taken off: for regular waves by the variance between periods, for irregular ones by the residual at the
gauges when two waves are fitted to them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle.analysis.errors import AnalysisError
from houle.analysis.levels import Gauges
from houle.analysis.separation import LEAST, Lines, operator, require_spread, spread, weights
from houle.analysis.waves import basis, harmonics
from houle.waves.dispersion import wave_number

Real = NDArray[Any]
Complex = NDArray[Any]


@dataclass(frozen=True)
class Pieces:
    """Pieces of wave energy that can be resampled.

    values  (n, 2 or 3): incident, reflected and, if measured, transmitted
    energy  gives the energy (..., c) [m2] of values (..., n, c)
    unit    word for a piece: "periods" or "frequencies"
    """

    values: NDArray
    energy: Callable[[NDArray], Real]
    unit: str


def per_period(g: Gauges, omega: float, start: float, periods: int, number: int = 3) -> Complex:
    """Amplitudes F (periods, G, M + 1) of each period by itself, phases as from t = 0.

    A steady drift of the mean level would pass for a small wave in every period: it is taken out first.
    """
    length = 2 * np.pi / omega
    most = int((length / g.step - 1) / 2)
    if most < 1:
        raise AnalysisError(f"{length / g.step:.1f} samples in a period of {length:.3g} s: 3 are needed, 20 are good")
    whole = g.between(start, start + periods * length)
    columns = np.column_stack([basis(whole.time, omega, min(number, most)), whole.time - whole.time.mean()])
    drift = np.linalg.lstsq(columns, whole.eta.T, rcond=None)[0][-1]
    g = replace(g, eta=g.eta - drift[:, None] * (g.time - whole.time.mean()))
    parts = [g.between(start + j * length, start + (j + 1) * length) for j in range(periods)]
    return np.array([harmonics(p.time, p.eta, omega, min(number, most)) for p in parts])


def regular(front: Complex, x: Real, k: float, method: str, behind: tuple[Complex, Real] | None = None) -> Pieces:
    """Pieces (periods, 2 or 3) from the first harmonics front (periods, G) at x, and (periods, G') at x' behind."""
    z = front @ _operator(method, k, x).T
    if behind is not None:
        amplitude, places = behind
        alone = len(places) == 1
        through = amplitude[:, 0] if alone else amplitude @ _operator("zelt-skjelbreia", k, places)[0]
        z = np.column_stack([z, through])
    return Pieces(z, _of_the_mean, "periods")


def _of_the_mean(z: Complex) -> Real:
    """Energy |mean|^2 over periods, less the variance of the mean: without bias if the periods are independent."""
    n, mean = z.shape[-2], z.mean(axis=-2)
    variance = np.sum(np.abs(z - mean[..., None, :]) ** 2, axis=-2) / (n * max(1, n - 1))
    return np.maximum(0.0, np.abs(mean) ** 2 - variance)


def _operator(method: str, k: float, x: Real) -> Complex:
    """Matrix (2, G) of a method that gives Z_I and Z_R from amplitudes at x (G,). Raises AnalysisError."""
    require_spread(k, x)
    _right_number(method, len(x))
    return operator(k, x, weights(k, x) if method == "zelt-skjelbreia" else np.ones(len(x)))


def _right_number(method: str, number: int) -> None:
    right = {"goda-suzuki": number == 2, "mansard-funke": number == 3, "zelt-skjelbreia": number >= 2}
    if method not in right:
        raise AnalysisError(f"method = {method!r} is not one of: {', '.join(right)}, jh2020")
    if not right[method]:
        raise AnalysisError(
            f"{method} does not go with {number} gauges: choose gauges=[...], or zelt-skjelbreia (2 or more)"
        )


def lines(g: Gauges, depth: float, band: tuple[float, float], method: str, gravity: float, taper: float) -> Lines:
    """Separates each Fourier line of band [Hz] of the whole record; the ends are tapered (cosine, a part `taper`)."""
    _right_number(method, len(g.x))
    frequency, F, unit = fourier(g, band, taper)
    k = wave_number(2 * np.pi * frequency, depth, gravity)
    apart = spread(k, g.x) >= LEAST
    energy, rest = np.zeros((len(k), 2)), np.zeros(len(k))
    energy[apart], rest[apart] = _energies(F[apart], k[apart], g.x, method)
    total = np.sum(np.abs(F) ** 2, axis=1)
    if not total.any():
        raise AnalysisError(f"the gauges hold no waves between {band[0]:.3g} and {band[1]:.3g} Hz: they are at rest")
    trust = np.where(apart, 1.0 - np.clip(_smooth(rest) / _smooth(np.where(apart, total, 0.0)), 0.0, 1.0), 0.0)
    lost = 1.0 - total[trust > 0].sum() / total.sum()
    if lost > 0.5:
        raise AnalysisError(
            f"the gauges cannot tell incident from reflected waves for {100 * lost:.0f} % of the energy between "
            f"{band[0]:.3g} and {band[1]:.3g} Hz: their spacings are near multiples of half the wavelengths there"
        )
    return Lines(frequency, unit * energy[:, 0], unit * energy[:, 1], trust)


def fourier(g: Gauges, band: tuple[float, float], taper: float) -> tuple[Real, Complex, float]:
    """Frequencies (n,) [Hz] in the band, amplitudes F (n, G), and the factor of |F|^2 in a density [1/Hz]."""
    from scipy.signal.windows import tukey

    shape = tukey(len(g.time), taper, sym=False)
    rows = (g.eta - g.eta.mean(axis=1, keepdims=True)) * shape
    frequency = np.fft.rfftfreq(len(g.time), g.step)
    inside = (frequency >= band[0]) & (frequency <= band[1]) & (frequency > 0)
    if inside.sum() < 8:
        raise AnalysisError(f"{inside.sum()} lines between {band[0]:.3g} and {band[1]:.3g} Hz: the record is too short")
    F = np.conj(np.fft.rfft(rows, axis=1)).T[inside] * 2.0 / len(g.time)
    return frequency[inside], F, 0.5 * g.step * len(g.time) / float(np.mean(shape**2))


def _energies(F: Complex, k: Real, x: Real, method: str) -> tuple[Real, Real]:
    """Energies of the two waves (n, 2) less those of the noise, and of the noise at all gauges (n,), from F (n, G).

    With P = 1 - B A (A: amplitudes from gauges, B: gauges from amplitudes) noise of variance s leaves s |P|^2 at the
    gauges, and puts s |A_row|^2 into each wave.
    """
    A = operator(k, x, weights(k, x) if method == "zelt-skjelbreia" else np.ones((len(k), len(x))))
    energy = np.abs(np.einsum("nwg,ng->nw", A, F)) ** 2
    if len(x) == 2:
        return energy, np.zeros(len(k))
    B = np.exp(1j * k[:, None, None] * x[:, None] * np.array([1.0, -1.0]))
    P = np.eye(len(x)) - B @ A
    noise = np.sum(np.abs(np.einsum("npg,ng->np", P, F)) ** 2, axis=1) / np.sum(np.abs(P) ** 2, axis=(1, 2))
    return energy - noise[:, None] * np.sum(np.abs(A) ** 2, axis=2), noise * len(x)


def _smooth(values: Real, width: int = 9) -> Real:
    """Running mean over `width` lines, fewer at the ends; never 0."""
    kernel = np.ones(min(width, len(values)))
    return np.convolve(values, kernel, "same") / np.convolve(np.ones(len(values)), kernel, "same") + 1e-300


def irregular(front: Lines, behind: Real | None = None) -> Pieces:
    """Pieces (lines, 2 or 3), each line weighted with its trust; behind: transmitted density at the same lines."""
    columns = [front.incident, front.reflected] + ([] if behind is None else [behind])
    df = front.frequency[1] - front.frequency[0]
    return Pieces(np.column_stack(columns) * front.trust[:, None] * df, _of_the_sum, "frequencies")


def _of_the_sum(values: Real) -> Real:
    """Energy of all lines together; noise that was taken off cannot make it negative."""
    return np.maximum(0.0, values.sum(axis=-2))
