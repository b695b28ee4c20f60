"""Contents of a record of the surface: harmonics, period, waves between zero crossings, spectra and moments.

Records may have holes: NaN, codes such as -9999, or missing times. holes.py says how they are treated.
"""

from __future__ import annotations

import itertools
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis import holes
from houle.analysis.errors import AnalysisError

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def harmonics(time: ArrayLike, eta: ArrayLike, omega: float, number: int = 1) -> Complex:
    """Complex amplitudes F (..., number + 1), least squares: eta = F_0 + sum over m of Re(F_m exp(-i m omega t)).

    time (T,) [s], eta (..., T) [m]. F_0 is the (real) mean. Exact for such a signal whatever the sampling; noise is
    least when the record holds whole periods. Raises AnalysisError when the samples cannot tell the harmonics apart.
    """
    t, rows = np.asarray(time, dtype=float), np.asarray(eta, dtype=float)
    if t.ndim != 1 or len(t) < 2 or rows.shape[-1:] != t.shape:
        raise AnalysisError(f"eta has shape {rows.shape} and time {t.shape}: one level for each time is needed")
    if not np.all(np.isfinite(rows)):
        i = int(np.argwhere(~np.isfinite(rows))[0][-1])
        raise AnalysisError(f"there is no level at t = {t[i]:g} s: leave the sample out")
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
    signal. Samples without level in any row are left out, and a warning says so; uneven times are used as they are.
    Raises AnalysisError when there is no oscillation, or fewer than two periods.
    """
    found = holes.record(time, eta)
    known = np.asarray(np.isfinite(found.eta).all(axis=0))
    t, rows = found.time[known], found.eta[:, known]
    if len(t) < 8:
        raise AnalysisError(f"{len(t)} samples with levels in all rows cannot tell a period")
    whole, step = found.time, float((found.time[-1] - found.time[0]) / (len(found.time) - 1))
    middle = rows.mean(axis=1, keepdims=True)
    filled = np.where(known, np.nan_to_num(found.eta) - middle, 0.0)
    if not np.all(np.abs(np.diff(whole) - step) < 0.01 * step):
        step, _ = holes.spacing(whole)
        size = round(float(whole[-1] - whole[0]) / step) + 1
        if size > 50 * len(whole):
            raise AnalysisError(f"the record is nearly all holes: {len(t)} samples over {whole[-1] - whole[0]:g} s")
        filled, at = np.zeros((len(rows), size)), np.round((t - whole[0]) / step).astype(int)
        filled[:, np.clip(at, 0, size - 1)] = rows - middle
    if found.notes or not known.all():
        words = f"{int(np.sum(~known))} of {len(known)} samples without level are left out"
        warnings.warn("find_omega: " + "; ".join([*found.notes, words]), stacklevel=2)
    rows = rows - middle
    length, size = filled.shape[1], 8 * filled.shape[1]
    power = np.sum(np.abs(np.fft.rfft(filled * np.hanning(length), size)) ** 2, axis=0)
    first = int(np.argmax(power))
    span = step * length
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
    """Waves between zero crossings: `heights` (N,) [m] and `periods` (N,) [s] in order of time; `notes` on holes."""

    heights: Real
    periods: Real
    notes: tuple[str, ...] = ()

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
        ) + "".join(f"\n  note: {note}" for note in self.notes)


def zero_crossing(time: ArrayLike, eta: ArrayLike, direction: str = "down", threshold: float = 0.0) -> Waves:
    """Waves from one zero crossing ("down" or "up") to the next, about the mean; crossings are linear between samples.

    Waves lower than `threshold` [m] are left out (noise). IAHR list of sea state parameters (1989): down-crossing is
    the usual choice for structures. Times may be uneven; a wave with a hole longer than a tenth of the mean period is
    left out, and `notes` say so. Raises AnalysisError when there is no whole wave.
    """
    if direction not in ("down", "up"):
        raise AnalysisError(f'direction = {direction!r}: "down" or "up"')
    found = holes.record(time, eta)
    known = np.isfinite(found.eta[0])
    t, z, notes = found.time[known], found.eta[0, known], list(found.notes)
    if len(t) < 3:
        raise AnalysisError(f"{len(t)} samples hold no wave")
    z = (z - z.mean()) * (1.0 if direction == "up" else -1.0)
    step, regular = holes.spacing(found.time)
    wide = max((holes.HOLE if regular else 3.0) * step, step + holes.SHORT * holes.mean_period(t, z))
    broken = np.concatenate([[0], np.cumsum(np.diff(t) > wide)])  # holes before each sample
    before = np.flatnonzero((z[:-1] < 0) & (z[1:] >= 0))
    if len(before) < 2:
        raise AnalysisError(f"no whole wave between {len(before)} zero {direction}-crossings")
    cross = t[before] - z[before] * (t[before + 1] - t[before]) / (z[before + 1] - z[before])
    parts = [z[i + 1 : j + 1] for i, j in itertools.pairwise(before)]
    heights = np.array([p.max() - p.min() for p in parts])
    whole = broken[before[1:] + 1] == broken[before[:-1]]
    if broken[-1] or not known.all():
        i = int(np.argmax(np.diff(t)))
        notes.append(
            f"{broken[-1]} holes, {int(np.sum(~known))} samples without level, the longest from t = {t[i]:.5g} to "
            f"{t[i + 1]:.5g} s: {int(np.sum(~whole))} waves across holes are left out"
        )
    if not whole.any():
        raise AnalysisError(f"no whole wave between holes, the first after t = {t[int(np.argmax(broken > 0)) - 1]:g} s")
    keep = whole & (heights >= threshold)
    if not keep.any():
        raise AnalysisError(f"no wave is as high as the threshold {threshold:g} m; the highest is {heights.max():g} m")
    return Waves(heights[keep], np.diff(cross)[keep], tuple(notes))


@dataclass(frozen=True)
class Spectrum:
    """One-sided variance density `density` (F,) [m2/Hz] at `frequency` (F,) [Hz], evenly spaced from 0.

    `notes` say what was done about holes and uneven times.
    """

    frequency: Real
    density: Real
    notes: tuple[str, ...] = ()

    def band(self, low: float, high: float) -> Spectrum:
        """The same spectrum with zero density outside low <= f <= high [Hz]."""
        inside = (self.frequency >= low) & (self.frequency <= high)
        return Spectrum(self.frequency, np.where(inside, self.density, 0.0), self.notes)

    def moment(self, order: int) -> float:
        """m_n = integral of f^n S df [m2 / s^n]; the line at f = 0 is left out."""
        f = self.frequency[1:]
        return float(np.sum(f**order * self.density[1:]) * (self.frequency[1] - self.frequency[0]))

    @property
    def H_m0(self) -> float:
        return float(4.0 * np.sqrt(self.moment(0)))

    @property
    def T_m10(self) -> float:
        """Energy period T_m-1,0 [s]; NaN without energy, like the two below."""
        return self._ratio(-1, 0)

    @property
    def T_m01(self) -> float:
        return self._ratio(0, 1)

    @property
    def T_m02(self) -> float:
        return float(np.sqrt(self._ratio(0, 2)))

    def _ratio(self, order: int, other: int) -> float:
        """Ratio of two moments; NaN for water at rest."""
        below = self.moment(other)
        return self.moment(order) / below if below > 0.0 else float("nan")

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
        words = f"H_m0 {self.H_m0:.4g} m, T_p {self.T_p:.4g} s, T_m-1,0 {self.T_m10:.4g} s"
        return words + "".join(f"\n  note: {note}" for note in self.notes)


def spectrum(time: ArrayLike, eta: ArrayLike, segment: float | None = None) -> Spectrum:
    """Welch's estimate: Hann windows of `segment` [s], an eighth of the record if None, half overlapping.

    Short holes are bridged, no window lies across a longer one (with segment=None it is no longer than the longest
    part without); uneven times are interpolated. `notes` of the answer say so. Raises AnalysisError.
    """
    from scipy.signal import welch

    t0, step, z, notes = holes.even(holes.record(time, eta))
    z, notes = holes.bridged(t0, step, z, notes)
    edges = np.concatenate([[0], *holes.holes(z), [len(z)]]).astype(int)
    parts = [z[a:b] for a, b in zip(edges[::2], edges[1::2], strict=True) if b > a]
    size, longest = len(z) // 8 if segment is None else round(segment / step), max(len(part) for part in parts)
    size = min(size, longest) if segment is None and len(parts) > 1 else size
    if not 16 <= size <= longest:
        between = " without holes" if len(parts) > 1 else ""
        raise AnalysisError(
            f"segment = {size * step:g} s must lie between 16 samples and the record of {longest * step:g} s{between}"
        )
    used = [part for part in parts if len(part) >= size]
    middle = np.concatenate(used).mean()
    found = [welch(part - middle, 1.0 / step, nperseg=size) for part in used]
    shares = [1 + (len(part) - size) // (size - size // 2) for part in used]
    density = np.average([density for _, density in found], axis=0, weights=shares)
    if len(parts) > 1:
        notes = (*notes, f"{sum(shares)} windows of {size * step:.4g} s in {len(used)} parts without holes")
    return Spectrum(found[0][0], density, notes)
