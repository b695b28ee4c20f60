"""Crest and celerity of a solitary wave over 20 depths, and its run-up on a wall, against third-order theory."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.grid import FloatArray
from houle.validation.check import Check, Variant, report
from houle.validation.measure import largest
from houle.waves.cnoidal import solitary

if TYPE_CHECKING:
    from houle.results.run import Run

CREST, CELERITY, RUN_UP = 1.0, 0.2, 2.0  # %
VARIANTS = (
    Variant("", quick=False),
    Variant("dx-20-mm", {"domain.spacing": 0.02}),
)


def compare(run: Run) -> list[Check]:
    waves, gravity = run.case.waves, run.case.fluid.gravity
    assert waves is not None and waves.height is not None
    depth, fine = waves.depth, run.case.domain.spacing < 0.011
    time, eta = run.series.time.values, run.series.eta.transpose("gauge", "time").values - depth
    x = run.series.gauge_x.values
    coming = time < time[eta[-1].argmax()]  # not yet back from the wall
    peaks = np.array([peak(time[coming], row) for row in eta[:-1, coming]])
    crest = peaks[:, 1]
    speed = float(np.polyfit(peaks[:, 0], x[:-1], 1)[0])
    exact = solitary(float(crest.mean()), depth, gravity, order=3).celerity
    climbed, top = peak(time, eta[-1])[1], run_up(float(crest[-1]), depth)
    return [
        report("crest at the first gauge over the target", float(crest[0] / waves.height)),
        Check("crest after 20 depths, off the first", 100 * abs(1 - crest[-1] / crest[0]), "%",
              CREST if fine else None),
        Check("celerity off third order", 100 * abs(speed / exact - 1), "%", CELERITY if fine else None,
              note=f"{speed:.4f} m/s, theory {exact:.4f} for the crest as it is"),
        Check("run-up off third order", 100 * abs(climbed / top - 1), "%", RUN_UP if fine else None,
              note=f"{1e3 * climbed:.1f} mm, theory {1e3 * top:.1f} for the crest that arrives"),
        report("level behind the wave", 1e3 * float(eta[0][time > peaks[0, 0] + 2.5][:50].mean()), "mm"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]  # fmt: skip


def run_up(height: float, depth: float) -> float:
    """At a vertical wall [m], R/d = 2 e (1 + e/4 + 3 e^2/8), e = H/d (Su & Mirie 1980, J. Fluid Mech. 98, 509-525)."""
    e = height / depth
    return depth * 2 * e * (1 + e / 4 + 3 * e * e / 8)


def peak(time: FloatArray, eta: FloatArray) -> tuple[float, float]:
    """Time [s] and height [m] of the crest: the parabola through what is within a fifth of its height."""
    i = int(np.argmax(eta))
    near = np.abs(np.arange(len(eta)) - i) < max(3, int(np.sum(eta > 0.8 * eta[i])) // 2)
    a, b, c = np.polyfit(time[near] - time[i], eta[near], 2)
    return float(time[i] - b / (2 * a)), float(c - b * b / (4 * a))
