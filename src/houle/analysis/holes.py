"""Records as instruments write them: holes, codes for missing values, times that are rounded, uneven, or no times.

Nothing is filled in silently: `notes` say what was done. A record that cannot be used is refused, with the sample.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError
from houle.data.csv_table import missing_codes

Real = NDArray[np.float64]
UNITS = (1.0, 1e-2, 1e-3)  # units [m] in which a code for missing values may have been written
HIGHEST = 1e5  # [m] no water stands so high: it is a code or another unit
ROUNDED = 0.3  # share of the interval: rounded times may be off even ones by so much
TOLD = 0.02  # share of the interval: a note says if times are farther off
HOLE = 1.5  # a wider gap between two samples is a hole [intervals]
SHORT = 0.1  # share of the mean period: shorter holes are bridged by a straight line


@dataclass(frozen=True)
class Record:
    """A checked record: time (T,) rising [s]; eta (R, T) [m], NaN where missing; notes on what was done."""

    time: Real
    eta: Real
    notes: tuple[str, ...]


def seconds(time: Any) -> Real:
    """Times as numbers [s]; dates count from the first one."""
    t = np.asarray(time)
    if t.dtype.kind in "mM":
        return np.asarray((t - t.flat[0]) / np.timedelta64(1, "ns") * 1e-9 if t.size else t.astype(float), dtype=float)
    return np.asarray(t, dtype=float)


def rising(time: Any, least: int = 3) -> Real:
    """Times (T,) [s] as numbers. Raises AnalysisError, with the sample, unless they are finite and rise."""
    t = seconds(time)
    if t.ndim != 1 or len(t) < least:
        raise AnalysisError(f"time has shape {t.shape}: a row of {least} or more times in s is needed")
    if not np.all(np.isfinite(t)):
        i = int(np.flatnonzero(~np.isfinite(t))[0])
        raise AnalysisError(f"the times are no times: sample {i} has t = {t[i]:g}")
    if not np.all(np.diff(t) > 0):
        i = int(np.flatnonzero(np.diff(t) <= 0)[0]) + 1
        raise AnalysisError(
            f"the times do not rise: sample {i} has t = {t[i]:.10g} s after {t[i - 1]:.10g} s. Sort the record, leave "
            "out double samples"
        )
    return t


def record(time: Any, eta: ArrayLike, least: int = 3) -> Record:
    """Checks time (T,) and eta (..., T); codes and numbers that are not finite become NaN. Raises AnalysisError."""
    t = rising(time, least)
    rows = np.array(eta, dtype=float)
    if rows.ndim == 0 or rows.shape[-1] != len(t):
        raise AnalysisError(f"eta has shape {rows.shape} and time {t.shape}: one level for each time is needed")
    rows = rows.reshape(-1, len(t))
    rows[~np.isfinite(rows)] = np.nan
    notes = []
    for row in rows:
        codes = np.flatnonzero(missing_codes(row, UNITS))
        if codes.size:
            notes.append(
                f"{row[codes[0]]:g} (first at t = {t[codes[0]]:g} s, {codes.size} times) is taken for a missing value"
            )
            row[codes] = np.nan
    if np.isnan(rows).all(axis=-1).any():
        raise AnalysisError("the record holds no levels")
    if (high := np.argwhere(np.abs(rows) > HIGHEST)).size:
        value, at = rows[tuple(high[0])], t[high[0][1]]
        raise AnalysisError(f"the level at t = {at:g} s is {value:g}: levels are heights in m")
    return Record(t, rows, tuple(notes))


def spacing(t: Real) -> tuple[float, bool]:
    """The interval between samples [s]; True if all of them stand at (nearly) whole multiples of it."""
    gaps = np.diff(t)
    step, number = float(np.median(gaps)), np.round(gaps / np.median(gaps))
    for _ in range(3):
        number = np.maximum(1.0, np.round(gaps / step))
        near = number < HOLE
        step = float(gaps[near].sum() / number[near].sum()) if near.any() else step
    at = np.concatenate([[0.0], np.cumsum(number)])
    off = t - t[0] - step * at
    parts = np.split(off, np.flatnonzero(number > HOLE) + 1)  # after a hole the clock may have gone on by a part
    return step, all(np.ptp(part) <= 2 * ROUNDED * step for part in parts)


def even(found: Record) -> tuple[float, float, Real, tuple[str, ...]]:
    """First time, interval [s], one row of levels (N,) at even times, NaN in holes; and notes."""
    t, z, notes = found.time, found.eta[0], list(found.notes)
    gaps = np.diff(t)
    mean = float((t[-1] - t[0]) / (len(t) - 1))
    if np.all(np.abs(gaps - mean) < 0.01 * mean):
        return float(t[0]), mean, z, tuple(notes)
    step, regular = spacing(t)
    size = round((t[-1] - t[0]) / step) + 1
    if size > 50 * len(t):
        raise AnalysisError(f"the record is nearly all holes: {len(t)} samples at {step:g} s over {t[-1] - t[0]:g} s")
    times = t[0] + step * np.arange(size)
    known = np.flatnonzero(np.isfinite(z))
    off = float(np.abs(t - times[np.clip(np.round((t - t[0]) / step).astype(int), 0, size - 1)]).max())
    if off > TOLD * step:
        kind = "rounded" if regular else f"uneven ({gaps.min():.3g} to {gaps.max():.3g} s apart)"
        notes.append(f"the times are {kind}: levels at every {step:.4g} s are interpolated")
    levels = np.interp(times, t[known], z[known])
    wide = HOLE * step if regular else 3.0 * float(np.quantile(gaps, 0.9))
    left, right = t[known[:-1]], t[known[1:]]
    for a, b in zip(left[right - left > wide], right[right - left > wide], strict=True):
        levels[(times > a + 0.5 * step) & (times < b - 0.5 * step)] = np.nan
    levels[(times < t[known[0]] - 0.5 * step) | (times > t[known[-1]] + 0.5 * step)] = np.nan
    return float(t[0]), step, levels, tuple(notes)


def holes(z: Real) -> list[tuple[int, int]]:
    """The holes of z (N,): first and one past the last sample of each run of NaN."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.isnan(z).astype(int), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def mean_period(t: Real, z: Real) -> float:
    """Mean time between up-crossings of the mean [s], holes aside; the length of the record without any."""
    known = np.isfinite(z)
    above = np.sign(z[known] - z[known].mean())
    crossings = int(np.sum(above[1:] != above[:-1]))
    step = float(np.median(np.diff(t)))
    return 2.0 * step * len(above) / crossings if crossings else float(t[-1] - t[0])


def bridged(t0: float, step: float, z: Real, notes: Sequence[str]) -> tuple[Real, tuple[str, ...]]:
    """Levels with the short holes bridged by straight lines, and what to say about all of them."""
    found = holes(z)
    if not found:
        return z, tuple(notes)
    times: Real = np.asarray(step * np.arange(len(z)), dtype=float)
    known, filled = np.isfinite(z), z.copy()
    longest = SHORT * mean_period(times, z)
    short = [(a, b) for a, b in found if (b - a + 1) * step <= longest + step and a > 0 and b < len(z)]
    for a, b in short:
        filled[a:b] = np.interp(times[a:b], times[known], z[known])
    long = [hole for hole in found if hole not in short]
    words = f"{int(np.isnan(z).sum())} of {len(z)} samples are missing"
    if short:
        words += f"; {len(short)} holes of no more than {longest:.3g} s are bridged by straight lines"
    if long:
        a, b = max(long, key=lambda hole: hole[1] - hole[0])
        words += f"; {len(long)} are left out, the longest from t = {t0 + step * a:.5g} to {t0 + step * b:.5g} s"
    return filled, (*notes, words)
