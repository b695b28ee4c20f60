"""Run-up: the highest level of each wave on a slope, and the level that 2 % exceed (EurOtop 2018, chapter 5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError
from houle.analysis.holes import record

LEAST_WAVES = 50  # one wave in fifty is 2 %


@dataclass(frozen=True)
class RunUp:
    """`peaks` (N,) [m]: run-ups above still water at `times` (N,) [s], rising; of so many incident `waves`."""

    peaks: NDArray[np.float64]
    times: NDArray[np.float64]
    waves: int

    @property
    def R_max(self) -> float:
        return float(self.peaks.max())

    @property
    def R_mean(self) -> float:
        return float(self.peaks.mean())

    @property
    def R_13(self) -> float:
        """Mean of the highest third [m]."""
        return float(np.sort(self.peaks)[::-1][: max(1, round(len(self.peaks) / 3))].mean())

    @property
    def R_2(self) -> float:
        """Run-up that 2 % of the incident waves exceed [m]; NaN with fewer than 50 waves."""
        return self.exceeded(0.02) if self.waves >= LEAST_WAVES else float("nan")

    def exceeded(self, part: float) -> float:
        """Level exceeded by this part of the incident waves [m], linear between ranks; NaN beyond the data."""
        rank = part * self.waves
        if not 1.0 <= rank <= len(self.peaks):
            return float("nan")
        return float(np.interp(rank, np.arange(1, len(self.peaks) + 1), np.sort(self.peaks)[::-1]))

    def __str__(self) -> str:
        few = "" if self.waves >= LEAST_WAVES else f" ({LEAST_WAVES} waves are needed for R_2%)"
        return (
            f"{len(self.peaks)} run-ups of {self.waves} waves: R_2% {self.R_2:.4g}, R_1/3 {self.R_13:.4g}, "
            f"R_max {self.R_max:.4g} m{few}"
        )


def run_up(time: ArrayLike, level: ArrayLike, *, waves: int | None = None, threshold: float = 0.0) -> RunUp:
    """Highest level of each run-up: between an up-crossing of the mean level of the water's edge and the next one.

    time, level (T,): the edge of the water above still water [s, m]. `waves`: incident waves in the record (the number
    of run-ups if None). Run-ups that rise less than `threshold` [m] above the mean are left out. Raises AnalysisError.
    """
    found = record(time, level)
    t, z = found.time, found.eta[0]
    if len(found.eta) != 1 or np.isnan(z).any():
        at = f": there is none at t = {t[np.isnan(z)][0]:g} s" if np.isnan(z).any() else ""
        said = "".join(f"; {note}" for note in found.notes)
        raise AnalysisError(f"run-up: time and level must be two rows of numbers of one length, without gaps{at}{said}")
    if (gaps := np.diff(t)).max() > 3 * np.median(gaps) and not np.all(np.abs(gaps - gaps.mean()) < 0.01 * gaps.mean()):
        i = int(np.argmax(gaps))
        raise AnalysisError(f"run-up: there is no level between t = {t[i]:g} and {t[i + 1]:g} s: shorten the record")
    above = z - z.mean()
    up = np.flatnonzero((above[:-1] < 0) & (above[1:] >= 0)) + 1
    ends = np.append(up, len(z))[1:]
    tops = [int(a + np.argmax(z[a:b])) for a, b in zip(up, ends, strict=True)]
    tops = [i for i in tops if above[i] >= threshold and i < len(z) - 1]  # the last may still be rising
    if not tops:
        raise AnalysisError("there is no whole run-up in the record")
    if waves is not None and waves < len(tops):
        raise AnalysisError(f"{len(tops)} run-ups from {waves} incident waves: raise threshold, or correct waves")
    return RunUp(z[tops], t[tops], len(tops) if waves is None else waves)
