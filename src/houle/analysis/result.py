"""The answer of houle.analysis.reflection."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from houle.analysis.measured import Measured


@dataclass(frozen=True)
class Reflection(Measured):
    """The result of a reflection analysis, and its picture.

    The coefficients are C_R = H_R / H_I, C_T = H_T / H_I, C_D = 1 - C_R^2 - C_T^2; NaN where gauges are missing.

    Heights [m] are 2 |Z| of the first harmonic (regular) or H_m0 in the band (irregular). Intervals are (low, high) of
    the stated confidence; `covers` says what is in them. `residual`: part of the amplitude at the gauges that an
    incident and a reflected wave do not explain. `spread`: see separation.spread.
    """

    def plot(self, path: str | os.PathLike[str]) -> Path:
        """A picture (PNG): signals and window, the separated waves along the flume, harmonics or spectrum."""
        from houle.analysis.picture import draw

        return draw(self, Path(path))
