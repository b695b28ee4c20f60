"""The result of a reflection analysis, in numbers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle.analysis.levels import Gauges
from houle.analysis.separation import Components, Lines
from houle.analysis.window import Window

Interval = tuple[float, float]


@dataclass(frozen=True)
class Measured:
    """The coefficients C_R = H_R / H_I, C_T = H_T / H_I, C_D = 1 - C_R^2 - C_T^2; NaN where gauges are missing.

    Heights [m] are 2 |Z| of the first harmonic (regular) or H_m0 in the band (irregular). Intervals are (low, high) of
    the stated confidence; `covers` says what is in them. `residual`: part of the amplitude at the gauges that an
    incident and a reflected wave do not explain. `spread`: see separation.spread.
    """

    kind: str
    method: str
    period: float
    depth: float
    wave_number: float
    C_R: float
    C_T: float
    C_D: float
    interval_R: Interval
    interval_T: Interval
    interval_D: Interval
    H_I: float
    H_R: float
    H_T: float
    window: Window
    residual: float
    spread: float
    confidence: float
    covers: str
    notes: tuple[str, ...]
    towards: float
    record: Gauges = field(repr=False)
    harmonics: tuple[Components, ...] = field(repr=False, default=())
    amplitudes: NDArray[Any] | None = field(repr=False, default=None)
    lines: Lines | None = field(repr=False, default=None)

    def __str__(self) -> str:
        wave = "T" if self.kind == "regular" else "T_p"
        height = "H of the first harmonic:" if self.kind == "regular" and self.method != "jh2020" else "H"
        height = height if self.kind == "regular" else "H_m0"
        parts = [
            ("C_R", self.C_R, self.interval_R),
            ("C_T", self.C_T, self.interval_T),
            ("C_D", self.C_D, self.interval_D),
        ]
        number = len(self.record.x)
        rows = [f"reflection: {self.kind} waves, {wave} = {self.period:.4g} s, {self.method}, {number} gauges in front"]
        rows += [f"  {name}  {_pm(value, span)}" for name, value, span in parts if np.isfinite(value)]
        heights = f"incident {self.H_I:.4g} m, reflected {self.H_R:.4g} m"
        rows.append(f"  {height}  {heights}" + (f", transmitted {self.H_T:.4g} m" if np.isfinite(self.H_T) else ""))
        rows.append(f"  window {self.window}")
        rows.append(f"  interval ({100 * self.confidence:g} %): {self.covers}")
        if np.isfinite(self.residual):
            rows.append(f"  two waves leave {100 * self.residual:.2g} % of the amplitude at the gauges unexplained")
        return "\n".join([*rows, *(f"  note: {note}" for note in self.notes)])


def _pm(value: float, span: Interval) -> str:
    return f"{value:.3f}" + (f"   ({span[0]:.3f} to {span[1]:.3f})" if np.isfinite(span[0]) else "   (no interval)")
