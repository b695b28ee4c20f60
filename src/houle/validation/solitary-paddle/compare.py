"""Height and time of solitary waves that a laboratory's paddle makes, beside published heights and gauges 1 to 4."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from houle.grid import FloatArray
from houle.validation.check import Check, Variant, report
from houle.validation.measure import largest, read_points

if TYPE_CHECKING:
    from houle.results.run import Run

DATA = Path(__file__).parent / "data"
PUBLISHED = {"a": 0.045, "b": 0.096}  # H/d (Briggs et al. 1995)
HEIGHT = 3.0  # %
MEAN = 5  # samples of the gauges in two periods of the hum in them: their mean is free of it
STILL = 25.0  # s, until when the gauges show still water
PASSED = 31.5  # s, when the crest has passed, and nothing is back from the island
SECONDS = 0.04  # s, between the samples of the gauges

A = {"waves.file": "data/paddle-a.csv", "gauge": [{"name": "G1-G4", "x": 6.1077}]}
FINE = {"domain.spacing": 0.01}
VARIANTS = (
    Variant(),
    Variant("A", A),
    Variant("dx-10-mm", FINE, quick=False),
    Variant("A-dx-10-mm", {**A, **FINE}, quick=False),
)


def compare(run: Run) -> list[Check]:
    waves = run.case.waves
    assert waves is not None and waves.file is not None
    case, depth = Path(waves.file).stem[-1], waves.depth
    time = waves.start + np.arange(0.0, run.case.time.end - SECONDS, SECONDS)  # on the clock of the files
    eta = np.interp(time - waves.start, run.series.time.values, run.series.eta.isel(gauge=0).values) - depth
    height, at = crest(time, eta)
    seen = np.array([crest(*gauge) for gauge in gauges(case)])
    record, late = float(seen[:, 0].mean()), at - float(seen[:, 1].mean())
    paddle = run.series.paddle_position.isel(paddle=0).values
    celerity = np.sqrt(run.case.fluid.gravity * (depth + height))
    gone, came = swept(time, eta, celerity), np.mean([swept(t, e, celerity) for t, e in gauges(case)])
    moved = float(np.ptp(paddle)) * depth
    return [
        Check("height off the published", 100 * abs(height / depth / PUBLISHED[case] - 1), "%", HEIGHT,
              note=f"H/d = {height / depth:.4f}, published {PUBLISHED[case]:g}"),
        report("height off gauges 1 to 4", 100 * (height / record - 1), "%",
               note=f"{1e3 * height:.2f} mm, gauges {1e3 * record:.2f} mm above what they show before the wave"),
        report("crest later than at gauges 1 to 4", late, "s"),
        report("water in the wave, of what the wall moved", gone / moved, "", {"gauges": round(came / moved, 2)}),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]  # fmt: skip


def gauges(case: str) -> list[tuple[FloatArray, FloatArray]]:
    """Times [s] and elevations [m] of the four gauges, above what they show before the wave."""
    table = read_points(DATA / f"gauges-{case}.csv")
    time = table["t_s"]
    return [(time, table[name] - table[name][time < STILL].mean()) for name in table.dtype.names[1:]]


def crest(time: FloatArray, eta: FloatArray) -> tuple[float, float]:
    """Height [m] and time [s] of the crest, top of a parabola, in running means over MEAN samples."""
    time, eta = _smooth(time, eta)
    i = int(np.argmax(np.where(time < PASSED, eta, 0.0)))
    near = slice(i - 4, i + 5)
    a, b, c = np.polyfit(time[near] - time[i], eta[near], 2)
    return float(c - b * b / (4 * a)), float(time[i] - b / (2 * a))


def swept(time: FloatArray, eta: FloatArray, celerity: float) -> float:
    """Water [m2] in the wave: that above still water, from its beginning until it falls to a twentieth of the crest."""
    time, eta = _smooth(time, eta)
    top = int(np.argmax(np.where(time < PASSED, eta, 0.0)))
    end = top + int(np.argmax(eta[top:] < eta[top] / 20))
    return celerity * SECONDS * float(eta[:end].sum())


def _smooth(time: FloatArray, eta: FloatArray) -> tuple[FloatArray, FloatArray]:
    half = MEAN // 2
    return time[half:-half], np.convolve(eta, np.full(MEAN, 1.0 / MEAN), mode="valid")
