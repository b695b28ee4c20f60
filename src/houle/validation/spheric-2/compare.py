"""Impact and levels of the three-dimensional dam break against the record of MARIN (Kleefsman et al. 2005)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from houle.validation.check import Check, Variant, report
from houle.validation.measure import period_mean, read_points, rms, volume_checks

if TYPE_CHECKING:
    from houle.runner import Run

RECORD = read_points(Path(__file__).parent / "data" / "record.csv")
ARRIVAL, PEAK = 0.393, 11239.0  # s, Pa: P1 passes 500 Pa, and its largest value, in the full 1 ms record
LASTING, WINDOW = 10101.0, 0.010  # Pa, s: the largest running mean of P1 over the window in the full record
RESOLVED = 0.02  # m: coarser, the box is four cells high and the peak is reported, not judged

VARIANTS = (Variant(), Variant("dx-20-mm", {"domain.spacing": 0.02}, quick=False))


def compare(run: Run) -> list[Check]:
    series = run.series
    time, impact = series.time.values, series.pressure.sel(sensor="P1").values
    hit = np.flatnonzero(impact > 500.0)
    arrival = time[hit[0]] - ARRIVAL if hit.size else np.nan
    peak = 100.0 * (impact.max() / PEAK - 1.0)
    lasting = period_mean(impact, WINDOW / (time[1] - time[0])).max()
    judged = run.case.domain.spacing <= RESOLVED + 1e-9
    levels = [report(f"{name}, rms", 1e3 * _level(run, name), "mm") for name in ("H1", "H2", "H3", "H4")]
    return [
        Check("arrival at P1, late by", float(arrival), "s", (-0.03, 0.03), "range", {"REEF3D": 0.05}),
        Check("P1, peak error", float(peak), "%", (-10.0, 10.0) if judged else None, "range", {"REEF3D": -4}),
        report("P1, largest mean over 10 ms, error", 100.0 * float(lasting / LASTING - 1.0), "%"),
        *levels,
        *volume_checks(run),
    ]


def _level(run: Run, name: str) -> float:
    """Root mean square [m] of model minus record over the run, a dry gauge counted as level 0."""
    seen = RECORD[RECORD["t_s"] <= run.case.time.end]
    model = np.nan_to_num(run.series.eta.sel(gauge=name).values)
    return rms(np.interp(seen["t_s"], run.series.time.values, model) - seen[f"{name}_m"])
