"""Impact and levels of the three-dimensional dam break against the record of MARIN (Kleefsman et al. 2005)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from houle.analysis import largest_pressure
from houle.grid import FloatArray
from houle.validation.check import Check, Variant, report
from houle.validation.measure import read_points, rms, volume_checks

if TYPE_CHECKING:
    from houle.results.run import Run

RECORD = read_points(Path(__file__).parent / "data" / "record.csv")
ARRIVAL, PEAK = 0.393, 11239.0  # s, Pa: P1 passes 500 Pa, and its largest value, in the full 1 ms record
LASTING, WINDOW = 10101.0, 0.010  # Pa, s: the largest running mean of P1 over the window in the full record
STRUCK = (0.39, 0.6)  # s
RESOLVED = 0.02  # m: coarser, the box is four cells high and the peak is reported, not judged

VARIANTS = (Variant(), Variant("dx-20-mm", {"domain.spacing": 0.02}, quick=False))


def compare(run: Run) -> list[Check]:
    series = run.series
    time, impact = series.time.values, series.pressure.sel(sensor="P1").values
    hit = np.flatnonzero(impact > 500.0)
    arrival = time[hit[0]] - ARRIVAL if hit.size else np.nan
    largest = largest_pressure(time, impact, window=WINDOW)
    peak = 100.0 * (largest.largest / PEAK - 1.0)
    brief = f"for {1e3 * largest.duration:.2g} ms, impulse {largest.impulse:.3g} Pa s"
    judged = run.case.domain.spacing <= RESOLVED + 1e-9
    levels = [report(f"{name}, rms", 1e3 * _level(run, name), "mm") for name in ("H1", "H2", "H3", "H4")]
    return [
        Check("arrival at P1, late by", float(arrival), "s", (-0.03, 0.03), "range", {"REEF3D": 0.05}),
        Check("P1, peak error", float(peak), "%", (-10.0, 10.0) if judged else None, "range", {"REEF3D": -4}, brief),
        report("P1, largest mean over 10 ms, error", 100.0 * (largest.lasting / LASTING - 1.0), "%"),
        *(
            report(f"{name}, impulse 0.39 to 0.6 s, of the record's", _impulse(run, name))
            for name in ("P1", "P2", "P3", "P4")
        ),
        *levels,
        *volume_checks(run),
    ]


def _level(run: Run, name: str) -> float:
    """Root mean square [m] of model minus record over the run, a dry gauge counted as level 0."""
    seen = RECORD[RECORD["t_s"] <= run.case.time.end]
    model = np.nan_to_num(run.series.eta.sel(gauge=name).values)
    return rms(np.interp(seen["t_s"], run.series.time.values, model) - seen[f"{name}_m"])


def _impulse(run: Run, name: str) -> float:
    """Integral of a pressure while the box is struck, over that of the record, whose samples are 10 ms apart."""
    time, record = np.linspace(*STRUCK, 22), RECORD[f"{name}_Pa"]
    fine = np.linspace(*STRUCK, 2101)
    ours = np.interp(fine, run.series.time.values, run.series.pressure.sel(sensor=name).values)
    return _mean(ours) / _mean(np.interp(time, RECORD["t_s"], record))


def _mean(values: FloatArray) -> float:
    """Mean of straight lines between even samples."""
    return float((values[1:] + values[:-1]).mean() / 2)
