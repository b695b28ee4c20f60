"""What a record of the surface holds: harmonics, period, waves between zero crossings, spectra and moments."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def harmonics(time: ArrayLike, eta: ArrayLike, omega: float, number: int = 1) -> Complex:
    """Complex amplitudes F (..., number + 1), least squares: eta = F_0 + sum over m of Re(F_m exp(-i m omega t)).

    time (T,) [s], eta (..., T) [m]. F_0 is the (real) mean. Exact for such a signal whatever the sampling; noise is
    least when the record holds whole periods. Raises AnalysisError when the samples cannot tell the harmonics apart.
    """
    t, rows = np.asarray(time, dtype=float), np.asarray(eta, dtype=float)
    return _complex(
        np.linalg.lstsq(basis(t, omega, number), rows.reshape(-1, len(t)).T, rcond=None)[0], number
    ).reshape(*rows.shape[:-1], number + 1)


def basis(t: Real, omega: float, number: int) -> Real:
    """Columns 1, cos(m omega t), sin(m omega t), m = 1 to number: (T, 1 + 2 number). Raises AnalysisError."""
    turns = omega * (t[-1] - t[0]) * len(t) / (len(t) - 1) / (2 * np.pi)
    if turns < 0.9 or len(t) < (2 * number + 1) * max(1.0, turns):
        raise AnalysisError(
            f"{len(t)} samples over {turns:.2f} periods cannot hold {number} harmonics: a period and "
            f"{2 * number + 1} samples in each are needed"
        )
    phase = omega * t[:, None] * np.arange(1, number + 1)
    return np.hstack([np.ones((len(t), 1)), np.cos(phase), np.sin(phase)])


def _complex(solution: Real, number: int) -> Complex:
    """(1 + 2 number, rows) -> (rows, number + 1): c cos + s sin = Re((c + i s) exp(-i m omega t))."""
    first = solution[:1].astype(complex)
    return np.vstack([first, solution[1 : number + 1] + 1j * solution[number + 1 :]]).T


def find_omega(time: ArrayLike, eta: ArrayLike, number: int = 3) -> float:
    """Angular frequency [rad/s] of a regular wave with harmonics, from all the rows of eta (..., T) together.

    Starts at the highest line of the periodogram, then Gauss-Newton on the least-squares fit: exact for an exact
    signal. Raises AnalysisError when there is no oscillation, or fewer than two periods.
    """
    t = np.asarray(time, dtype=float)
    rows = np.asarray(eta, dtype=float).reshape(-1, len(t))
    rows = rows - rows.mean(axis=1, keepdims=True)
    step, size = (t[-1] - t[0]) / (len(t) - 1), 8 * len(t)
    power = np.sum(np.abs(np.fft.rfft(rows * np.hanning(len(t)), size)) ** 2, axis=0)
    first = int(np.argmax(power))
    span = step * len(t)
    if power[first] == 0 or first * span / (size * step) < 1.9:
        raise AnalysisError(
            "no regular wave is found: the record is flat, or shorter than two periods; give the period"
        )
    omega = 2 * np.pi * first / (size * step)
    number = max(1, min(number, int(np.pi / step / omega)))
    m = np.arange(1, number + 1)
    for _ in range(40):
        columns = basis(t, omega, number)
        solution = np.linalg.lstsq(columns, rows.T, rcond=None)[0]
        c, s = solution[1 : number + 1], solution[number + 1 :]
        cos, sin = columns[:, 1 : number + 1], columns[:, number + 1 :]
        slope = t[:, None] * (cos @ (m[:, None] * s) - sin @ (m[:, None] * c))  # d(model)/d(omega)
        slope = slope - columns @ np.linalg.lstsq(columns, slope, rcond=None)[0]
        change = float(np.sum(slope * (rows.T - columns @ solution)) / np.sum(slope**2))
        omega += float(np.clip(change, -0.5 / span, 0.5 / span))
        if abs(change) < 1e-13 * omega:
            break
    return omega


@dataclass(frozen=True)
class Waves:
    """Waves between zero crossings: `heights` (N,) [m] and `periods` (N,) [s] in order of time."""

    heights: Real
    periods: Real

    @property
    def N(self) -> int:
        return len(self.heights)

    @property
    def H_m(self) -> float:
        return float(self.heights.mean())

    @property
    def H_rms(self) -> float:
        return float(np.sqrt(np.mean(self.heights**2)))

    @property
    def H_max(self) -> float:
        return float(self.heights.max())

    @property
    def T_z(self) -> float:
        return float(self.periods.mean())

    @property
    def H_13(self) -> float:
        """Significant wave height H_1/3 [m]."""
        return float(self.heights[self._highest(3)].mean())

    @property
    def H_110(self) -> float:
        """H_1/10 [m]: mean of the highest tenth; NaN with fewer than ten waves."""
        return float(self.heights[self._highest(10)].mean()) if self.N >= 10 else float("nan")

    @property
    def T_13(self) -> float:
        """Mean period of the highest third [s]."""
        return float(self.periods[self._highest(3)].mean())

    def _highest(self, part: int) -> NDArray[np.intp]:
        return np.argsort(-self.heights, kind="stable")[: max(1, round(self.N / part))]

    def __str__(self) -> str:
        return (
            f"{self.N} waves: H_m {self.H_m:.4g}, H_1/3 {self.H_13:.4g}, H_1/10 {self.H_110:.4g}, H_max "
            f"{self.H_max:.4g} m; T_z {self.T_z:.4g}, T_1/3 {self.T_13:.4g} s"
        )


def zero_crossing(time: ArrayLike, eta: ArrayLike, direction: str = "down", threshold: float = 0.0) -> Waves:
    """Waves from one zero crossing ("down" or "up") to the next, about the mean; crossings are linear between samples.

    Waves lower than `threshold` [m] are left out (noise). IAHR list of sea state parameters (1989): down-crossing is
    the usual choice for structures. Raises AnalysisError when there is no whole wave.
    """
    t, z = np.asarray(time, dtype=float), np.asarray(eta, dtype=float)
    if direction not in ("down", "up"):
        raise AnalysisError(f'direction = {direction!r}: "down" or "up"')
    z = (z - z.mean()) * (1.0 if direction == "up" else -1.0)
    before = np.flatnonzero((z[:-1] < 0) & (z[1:] >= 0))
    if len(before) < 2:
        raise AnalysisError(f"no whole wave between {len(before)} zero {direction}-crossings")
    cross = t[before] - z[before] * (t[before + 1] - t[before]) / (z[before + 1] - z[before])
    parts = [z[i + 1 : j + 1] for i, j in itertools.pairwise(before)]
    heights = np.array([p.max() - p.min() for p in parts])
    keep = heights >= threshold
    if not keep.any():
        raise AnalysisError(f"no wave is as high as the threshold {threshold:g} m; the highest is {heights.max():g} m")
    return Waves(heights[keep], np.diff(cross)[keep])


@dataclass(frozen=True)
class Spectrum:
    """One-sided variance density `density` (F,) [m2/Hz] at `frequency` (F,) [Hz], evenly spaced from 0."""

    frequency: Real
    density: Real

    def band(self, low: float, high: float) -> Spectrum:
        """Zero outside low <= f <= high [Hz]."""
        inside = (self.frequency >= low) & (self.frequency <= high)
        return Spectrum(self.frequency, np.where(inside, self.density, 0.0))

    def moment(self, order: int) -> float:
        """m_n = integral of f^n S df [m2 / s^n]; the line at f = 0 is left out."""
        f = self.frequency[1:]
        return float(np.sum(f**order * self.density[1:]) * (self.frequency[1] - self.frequency[0]))

    @property
    def H_m0(self) -> float:
        return float(4.0 * np.sqrt(self.moment(0)))

    @property
    def T_m10(self) -> float:
        """Energy period T_m-1,0 [s]."""
        return self.moment(-1) / self.moment(0)

    @property
    def T_m01(self) -> float:
        return self.moment(0) / self.moment(1)

    @property
    def T_m02(self) -> float:
        return float(np.sqrt(self.moment(0) / self.moment(2)))

    @property
    def T_p(self) -> float:
        """Peak period [s]: a parabola through the highest line and its neighbours."""
        i = int(np.argmax(self.density[1:])) + 1
        if i + 1 >= len(self.density):
            return float(1.0 / self.frequency[i])
        a, b, c = self.density[i - 1 : i + 2]
        shift = 0.5 * (a - c) / (a - 2 * b + c) if a - 2 * b + c < 0 else 0.0
        return float(1.0 / (self.frequency[i] + shift * (self.frequency[1] - self.frequency[0])))

    def __str__(self) -> str:
        return f"H_m0 {self.H_m0:.4g} m, T_p {self.T_p:.4g} s, T_m-1,0 {self.T_m10:.4g} s"


def spectrum(time: ArrayLike, eta: ArrayLike, segment: float | None = None) -> Spectrum:
    """Welch's estimate: Hann windows of `segment` [s], an eighth of the record if None, half overlapping."""
    from scipy.signal import welch

    t, z = np.asarray(time, dtype=float), np.asarray(eta, dtype=float)
    step = (t[-1] - t[0]) / (len(t) - 1)
    size = len(t) // 8 if segment is None else round(segment / step)
    if not 16 <= size <= len(t):
        raise AnalysisError(
            f"segment = {size * step:g} s must lie between 16 samples and the record of {len(t) * step:g} s"
        )
    frequency, density = welch(z - z.mean(), 1.0 / step, nperseg=size)
    return Spectrum(frequency, density)
