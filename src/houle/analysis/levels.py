"""Levels of the water at gauges along a flume: the form in which every analysis takes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from houle.analysis.errors import AnalysisError

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Gauges:
    """Levels of the water at gauges along a flume.

    time   (T,) [s], evenly spaced and rising
    x      (G,) places of the gauges [m]
    eta    (G, T) levels [m] above any fixed level, finite
    names  one for each gauge
    notes  remarks of the reader of the source, in words
    """

    time: Real
    x: Real
    eta: Real
    names: tuple[str, ...]
    notes: str = ""

    @property
    def step(self) -> float:
        """Sampling interval [s]."""
        return float((self.time[-1] - self.time[0]) / (len(self.time) - 1))

    def pick(self, chosen: Sequence[str | int] | None) -> Gauges:
        """The chosen gauges, by name or number, in this order; all of them when None."""
        if chosen is None:
            return self
        unknown = [c for c in chosen if (c not in self.names if isinstance(c, str) else not 0 <= c < len(self.names))]
        if unknown:
            raise AnalysisError(f"there is no gauge {unknown[0]!r}; there are: {', '.join(self.names)}")
        rows = [self.names.index(c) if isinstance(c, str) else int(c) for c in chosen]
        return Gauges(self.time, self.x[rows], self.eta[rows], tuple(self.names[r] for r in rows), self.notes)

    def between(self, start: float, end: float) -> Gauges:
        """The samples of start <= time < end (to a thousandth of the sampling interval)."""
        keep = (self.time >= start - 1e-3 * self.step) & (self.time < end - 1e-3 * self.step)
        if not keep.any():
            raise AnalysisError(
                f"no sample between {start:g} and {end:g} s; the record goes from {self.time[0]:g} to "
                f"{self.time[-1]:g} s"
            )
        return Gauges(self.time[keep], self.x, self.eta[:, keep], self.names, self.notes)
