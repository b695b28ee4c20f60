"""Incident and reflected waves from the amplitudes at several places.

At the places x_p the amplitude at omega is F_p = Z_I exp(i k x_p) + Z_R exp(-i k x_p), with eta_p = Re(F_p exp(-i
omega t)): Z_I goes to +x, Z_R comes back, both are referred to x = 0.

References: Goda & Suzuki (1976) Proc. 15th ICCE, 828-845 (two gauges); Mansard & Funke (1980) Proc. 17th ICCE, 154-172
(least squares, three); Zelt & Skjelbreia (1992) Proc. 23rd ICCE, 777-790 (any number, weights from the spacings);
Lin & Huang (2004) Coastal Eng. 51, 395-406 (free and bound harmonics). The weights of Zelt & Skjelbreia are those in
common use; the paper was not at hand.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError
from houle.waves.dispersion import GRAVITY, wave_number

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
LEAST = float(np.sin(2 * np.pi * 0.05))  # Goda & Suzuki use two gauges for 0.05 < spacing / L < 0.45
APART = 0.03  # least singular value over the largest: noise in an amplitude is at most some 30 times that at a gauge


def weights(k: ArrayLike, x: ArrayLike) -> Real:
    """Weights of Zelt & Skjelbreia: W_p = sum_q sin^2(D) / (1 + (D / pi)^2), D = k (x_p - x_q).

    All are 0 at singular spacings.

    k [rad/m] of any shape, x (G,) [m]; returns k.shape + (G,).
    """
    places = np.asarray(x, dtype=float)
    d = np.multiply.outer(np.asarray(k, dtype=float), places[:, None] - places[None, :])
    return np.sum(np.sin(d) ** 2 / (1.0 + (d / np.pi) ** 2), axis=-1)


def spread(k: ArrayLike, x: ArrayLike) -> Real:
    """Sharpness with which the places tell the two waves apart: 0 not at all (half wavelengths apart), 1 best.

    It is sqrt(1 - |mean of exp(2 i k x)|^2), of the shape of k; for two gauges |sin(k (x2 - x1))|.
    """
    mean = np.abs(
        np.mean(np.exp(2j * np.multiply.outer(np.asarray(k, dtype=float), np.asarray(x, dtype=float))), axis=-1)
    )
    return np.sqrt(np.maximum(0.0, 1.0 - mean**2))


def require_spread(k: float, x: ArrayLike) -> None:
    """Raises AnalysisError where the places (nearly) coincide in phase."""
    places, found = np.asarray(x, dtype=float), float(spread(k, x))
    if found < LEAST:
        length = 2 * np.pi / k
        gaps = ", ".join(f"{g / length:.3f}" for g in np.diff(np.sort(places)))
        raise AnalysisError(
            f"the gauges stand {gaps} wavelengths apart (L = {length:.3g} m): that is too near to a multiple of half "
            f"a wavelength to tell incident from reflected waves (spread {found:.2f} < {LEAST:.2f}). Two gauges need "
            "0.05 to 0.45 L; better three at 0.1 L and 0.25 L from the first"
        )


def goda_suzuki(F: ArrayLike, x: ArrayLike, k: float) -> tuple[complex, complex]:
    """Z_I, Z_R from two gauges: the solution of two equations. Raises AnalysisError for singular spacings."""
    amplitude, places = np.asarray(F, dtype=complex), np.asarray(x, dtype=float)
    _need(len(places) == 2, f"goda-suzuki takes 2 gauges, {len(places)} were given: choose two, or zelt-skjelbreia")
    require_spread(k, places)
    first, second = amplitude
    turn = np.exp(1j * k * (places[1] - places[0]))
    incident = (second - first / turn) / (turn - 1.0 / turn)  # at the first gauge
    reflected = (first * turn - second) / (turn - 1.0 / turn)
    start = np.exp(1j * k * places[0])
    return complex(incident / start), complex(reflected * start)


def mansard_funke(F: ArrayLike, x: ArrayLike, k: float) -> tuple[complex, complex]:
    """Z_I, Z_R from three gauges, least squares with equal weights. Raises AnalysisError for singular spacings."""
    _need(np.size(x) == 3, f"mansard-funke takes 3 gauges, {np.size(x)} were given: choose three, or zelt-skjelbreia")
    return least_squares(F, x, k, np.ones(3))


def zelt_skjelbreia(F: ArrayLike, x: ArrayLike, k: float) -> tuple[complex, complex]:
    """Z_I, Z_R from any number of gauges, weighted by the spacings. Raises AnalysisError for singular spacings."""
    return least_squares(F, x, k, weights(k, x))


def least_squares(F: ArrayLike, x: ArrayLike, k: float, weight: Real) -> tuple[complex, complex]:
    """Z_I, Z_R minimising sum over p of W_p |F_p - Z_I exp(i k x_p) - Z_R exp(-i k x_p)|^2."""
    amplitude, places = np.asarray(F, dtype=complex), np.asarray(x, dtype=float)
    _need(len(places) >= 2, "one gauge cannot tell incident from reflected waves: two or more are needed")
    require_spread(k, places)
    incident, reflected = operator(k, places, weight) @ amplitude
    return complex(incident), complex(reflected)


def operator(k: ArrayLike, x: ArrayLike, weight: Real) -> Complex:
    """Matrices k.shape + (2, G) that give Z_I and Z_R from F (G,), for weights k.shape + (G,)."""
    wave = np.exp(1j * np.multiply.outer(np.asarray(k, dtype=float), np.asarray(x, dtype=float)))
    s0, s2 = weight.sum(axis=-1)[..., None], np.sum(weight * wave**2, axis=-1)[..., None]
    forward, back = weight / wave, weight * wave
    rows = np.stack([s0 * forward - np.conj(s2) * back, s0 * back - s2 * forward], axis=-2)
    return rows / (s0**2 - np.abs(s2) ** 2)[..., None]


def _need(right: bool, message: str) -> None:
    if not right:
        raise AnalysisError(message)


@dataclass(frozen=True)
class Components:
    """The parts of one harmonic m, complex amplitudes [m] referred to x = 0; the first harmonic has no free part.

    `residual` is the part of the rms amplitude that they do not explain; NaN when there is no gauge to spare.
    `resolved`: False when the gauges cannot tell these parts from each other; they are then the smallest that explain
    the signal.
    """

    order: int
    incident: complex
    reflected: complex
    free_incident: complex
    free_reflected: complex
    residual: float
    resolved: bool


@dataclass(frozen=True)
class Lines:
    """The separated spectrum: frequency (n,) [Hz], energy densities (n,) [m2/Hz], and how each line was used.

    trust (n,): 0 where the gauges cannot tell the waves apart at that frequency, else the part of their energy that two
    waves explain (1 with two gauges: there is nothing to judge by).
    """

    frequency: Real
    incident: Real
    reflected: Real
    trust: Real


def separate_xt(
    x: ArrayLike, F: ArrayLike, omega: float, depth: float, k: float | None = None, gravity: float = GRAVITY
) -> list[Components]:
    """Least squares of eta(x, t) over all gauges: forward and backward waves of each harmonic, bound and free.

    x (G,), F (G, M + 1) from waves.harmonics (over whole periods the harmonics do not disturb each other, so the fit
    in t and then in x is the fit in (x, t)). Bound harmonics move with the primary wave, exp(+-i m k x); free ones
    obey the dispersion relation of m omega. k is that of the primary wave; linear theory when None. A harmonic above
    the first takes four gauges; where they cannot tell bound from free (short arrays, shallow water) the least
    amplitudes that explain the signal are given. With fewer gauges only bound waves are fitted.
    """
    places, amplitudes = np.asarray(x, dtype=float), np.asarray(F, dtype=complex)
    primary = float(wave_number(omega, depth, gravity)) if k is None else k
    require_spread(primary, places)
    middle = places.mean()
    found = []
    for m in range(1, amplitudes.shape[1]):
        numbers = [m * primary, -m * primary]
        if m > 1 and len(places) >= 4:
            free = float(wave_number(m * omega, depth, gravity))
            numbers += [free, -free]
        waves = np.exp(1j * np.outer(places - middle, numbers))
        z, _, rank, _ = np.linalg.lstsq(waves, amplitudes[:, m], rcond=APART)
        rest, size = np.linalg.norm(amplitudes[:, m] - waves @ z), np.linalg.norm(amplitudes[:, m])
        spare = len(places) > len(numbers) and size > 0
        z = np.append(z * np.exp(-1j * np.array(numbers) * middle), np.zeros(4 - len(numbers)))
        incident, reflected, free_in, free_back = (complex(value) for value in z)
        unexplained = float(rest / size) if spare else float("nan")
        found.append(Components(m, incident, reflected, free_in, free_back, unexplained, bool(rank == len(numbers))))
    return found


def fit_wave_number(x: ArrayLike, F: ArrayLike, start: float, reach: float = 0.1) -> float:
    """The k [rad/m] within a part `reach` of `start` whose two waves explain F (G,) best. Takes four gauges."""
    from scipy.optimize import minimize_scalar

    places, amplitude = np.asarray(x, dtype=float), np.asarray(F, dtype=complex)
    _need(len(places) >= 4, f"fitting the wave number takes 4 gauges, {len(places)} were given")

    def unexplained(k: float) -> float:
        waves = np.exp(1j * np.outer(places - places.mean(), [k, -k]))
        return float(np.linalg.norm(amplitude - waves @ np.linalg.lstsq(waves, amplitude, rcond=None)[0]) ** 2)

    trial = start * np.linspace(1 - reach, 1 + reach, 81)
    best = int(np.argmin([unexplained(k) for k in trial]))
    _need(
        0 < best < 80,
        f"no wave number within {100 * reach:.0f} % of {start:g} rad/m explains the gauges: wrong period?",
    )
    low, high = trial[best - 1], trial[best + 1]
    return float(minimize_scalar(unexplained, bounds=(low, high), method="bounded", options={"xatol": 1e-10}).x)
