"""The run must reach its end and keep its volume; heights and set-up stand beside Hansen & Svendsen (1979)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from houle.grid import FloatArray
from houle.validation.check import Check, Variant, report
from houle.validation.measure import largest, read_points, rms

if TYPE_CHECKING:
    from houle.results.run import Run

RECORD = read_points(Path(__file__).parent / "data" / "heights.csv")
BREAKING = int(np.argmax(RECORD["height_m"]))  # the gauge with the largest height
PERIODS = 6  # periods at the end over which means are taken

VARIANTS = (
    Variant("", quick=False),
    Variant("dx-20-mm", {"domain.spacing": 0.02}),
    Variant("dx-10-mm", {"domain.spacing": 0.01}, quick=False),
)


def compare(run: Run) -> list[Check]:
    assert run.case.waves is not None
    height, setup = heights(run)
    highest = int(np.argmax(height))
    incident, out, inside = slice(0, 7), slice(0, BREAKING + 1), slice(BREAKING + 1, None)
    off = height - RECORD["height_m"]
    return [
        Check("end of the run", float(run.series.time[-1]), "s", run.case.time.end - 1e-6, "min"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
        report("height in front of the beach", 1e3 * height[incident].mean(), "mm", _beside("height_m", incident)),
        report("largest height", 1e3 * height[highest], "mm", _beside("height_m", slice(BREAKING, BREAKING + 1))),
        report(
            "largest height, from the toe",
            float(RECORD["x_m"][highest]),
            "m",
            {"record": round(float(RECORD["x_m"][BREAKING]), 2)},
        ),
        report("height, rms, before breaking", 1e3 * rms(off[out]), "mm"),
        report("height, rms, broken waves", 1e3 * rms(off[inside]), "mm"),
        report(
            "lowest mean level", 1e3 * setup.min(), "mm", {"record": round(1e3 * float(RECORD["setup_m"].min()), 1)}
        ),
        report("set-up at the last gauge", 1e3 * setup[-1], "mm", _beside("setup_m", slice(-1, None))),
        report("set-up, rms", 1e3 * rms(setup - RECORD["setup_m"]), "mm"),
    ]


def heights(run: Run) -> tuple[FloatArray, FloatArray]:
    """Height from crest to trough, mean over the last periods, and mean level over still water [m], of each gauge."""
    assert run.case.waves is not None and run.case.waves.period is not None
    time, period, depth = run.series.time.values, run.case.waves.period, run.case.waves.depth
    eta = run.series.eta.transpose("gauge", "time").values - depth
    number = np.ceil((time[-1] - time) / period - 1e-6).astype(int)  # 1: the last period
    each = [eta[:, number == n] for n in range(1, PERIODS + 1)]
    height = np.mean([np.nanmax(e, axis=1) - np.nanmin(e, axis=1) for e in each], axis=0)
    return height, np.nanmean(np.concatenate(each, axis=1), axis=1)


def _beside(name: str, gauges: slice) -> dict[str, float]:
    """The mean of the record at these gauges [mm]."""
    return {"record": round(1e3 * float(RECORD[name][gauges].mean()), 1)}
