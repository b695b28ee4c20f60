"""The run must reach its end and keep its volume; breaking and set-up stand beside Hansen & Svendsen (1979)."""

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
BROKEN = int(np.argmax(RECORD["height_m"])) + 1  # the first gauge behind the one with the largest height
BEFORE = 6.5  # m from the toe: waves do not break before, in the record nor in any run
PERIODS = 8  # periods at the end over which means are taken

VARIANTS = (
    Variant("", quick=False),
    Variant("dx-20-mm", {"domain.spacing": 0.02}),
    Variant("dx-10-mm", {"domain.spacing": 0.01}, quick=False),
)


def compare(run: Run) -> list[Check]:
    height, level = heights(run)
    place, highest = breaking(height)
    known_place, known_highest = breaking(RECORD["height_m"])
    in_front, growing, behind = slice(0, 7), RECORD["x_m"] < BEFORE, slice(BROKEN, None)
    off = height / RECORD["height_m"] - 1.0
    return [
        Check("end of the run", float(run.series.time[-1]), "s", run.case.time.end - 1e-6, "min"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
        report("height in front of the beach", 1e3 * height[in_front].mean(), "mm", _mean("height_m", in_front)),
        report("height up to 6.5 m from the toe, off by", 100 * off[growing].mean(), "%"),
        report("largest height", 1e3 * highest, "mm", _beside(1e3 * known_highest, "within 5 %")),
        report("largest height, from the toe", place, "m", _beside(known_place, "within 0.3 m")),
        report("height behind breaking, off by", 100 * off[behind].mean(), "%", {"wanted": "within 10 %"}),
        report("height behind breaking, rms", 1e3 * rms((height - RECORD["height_m"])[behind]), "mm"),
        report("lowest mean level", 1e3 * level.min(), "mm", _beside(1e3 * RECORD["setup_m"].min(), "")),
        report("set-up at the last gauge", 1e3 * level[-1], "mm", _beside(1e3 * RECORD["setup_m"][-1], "within 35 %")),
        report("mean level, rms", 1e3 * rms(level - RECORD["setup_m"]), "mm"),
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


def breaking(height: FloatArray) -> tuple[float, float]:
    """Place from the toe and size [m] of the largest height, by a parabola through three gauges."""
    top = int(np.clip(np.argmax(height), 1, len(height) - 2))
    a, b, c = np.polyfit(RECORD["x_m"][top - 1 : top + 2], height[top - 1 : top + 2], 2)
    return float(-0.5 * b / a), float(c - 0.25 * b * b / a)


def _mean(name: str, gauges: slice) -> dict[str, float]:
    """The mean of the record at these gauges [mm]."""
    return {"record": round(1e3 * float(RECORD[name][gauges].mean()), 1)}


def _beside(record: float, wanted: str) -> dict[str, float | str]:
    """The number of the record, and how near to it the run should come."""
    return {"record": round(float(record), 2), **({"wanted": wanted} if wanted else {})}
