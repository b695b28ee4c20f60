"""The front of the collapsing column against Martin & Moyce (1952), with the stated release delay."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from houle.validation.check import Check
from houle.validation.measure import front_position, read_points, volume_checks

if TYPE_CHECKING:
    from houle.runner import Run

POINTS = read_points(Path(__file__).parent / "data" / "front.csv")
WIDTH = 0.05715  # a [m]
DELAY = 0.175  # of the laboratory's clock, in T, as stated in the literature; nothing else is shifted
THICKNESS = WIDTH / 20  # m, of the water that counts as the front
MEAN, WORST = 3.0, 8.0  # %


def compare(run: Run) -> list[Check]:
    eta, gravity = run.surface.eta, run.case.fluid.gravity
    model_time = eta.time.values * np.sqrt(2.0 * gravity / WIDTH) + DELAY
    front = front_position(eta, THICKNESS) / WIDTH
    seen = POINTS[model_time[-1] >= POINTS["T"]]
    error = 100.0 * np.abs(np.interp(seen["T"], model_time, front) / seen["Z"] - 1.0)
    return [
        Check("front, mean error", float(error.mean()), "%", MEAN, peers={"interFoam": 3.0, "REEF3D": "7-8"}),
        Check("front, largest error", float(error.max()), "%", WORST, peers={"interFoam": 8.1, "REEF3D": "18-20"}),
        *volume_checks(run),
    ]
