"""The front of the collapsing column against Martin & Moyce (1952), with the stated release delay."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from houle.grid import FloatArray
from houle.validation.check import Check, report
from houle.validation.measure import front_position, read_points, volume_checks

if TYPE_CHECKING:
    from houle.results.run import Run

DATA = Path(__file__).parent / "data"
POINTS, TABLE = read_points(DATA / "front.csv"), read_points(DATA / "table2.csv")
WIDTH = 0.05715  # a [m]
DELAY = 0.175  # delay of the laboratory's clock, as T = t sqrt(2 g/a), stated in the literature; no other shift
THICKNESS = WIDTH / 20  # [m] thinner water does not count as the front
MEAN, WORST = 3.0, 8.0  # %


def compare(run: Run) -> list[Check]:
    eta, gravity = run.surface.eta, run.case.fluid.gravity
    model_time = eta.time.values * np.sqrt(2.0 * gravity / WIDTH) + DELAY
    front = front_position(eta, THICKNESS) / WIDTH
    error, printed = (_errors(points, model_time, front) for points in (POINTS, TABLE))
    worst = f"at T = {POINTS['T'][error.argmax()]:g}; {np.sort(error)[-2]:.1f} % elsewhere"
    return [
        Check("front, mean error", float(error.mean()), "%", MEAN, peers={"interFoam": 3.0, "REEF3D": "7-8"}),
        Check(
            "front, largest error", float(error.max()), "%", WORST,
            peers={"interFoam": 8.1, "REEF3D": "18-20"}, note=worst,
        ),
        report("front, mean error, printed table up to T = 3.33", float(printed.mean()), "%"),
        report("front, largest error, printed table up to T = 3.33", float(printed.max()), "%"),
        *volume_checks(run),
    ]  # fmt: skip


def _errors(points: Any, time: FloatArray, front: FloatArray) -> FloatArray:
    """Relative error [%] at the laboratory's times that the run has reached."""
    seen = points[time[-1] >= points["T"]]
    found: FloatArray = 100.0 * np.abs(np.interp(seen["T"], time, front) / seen["Z"] - 1.0)
    return found
