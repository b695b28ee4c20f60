"""Water at rest stays at rest: speed, level, pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.validation.check import Check
from houle.validation.measure import largest, volume_checks

if TYPE_CHECKING:
    from houle.runner import Run


def compare(run: Run) -> list[Check]:
    level, fluid = run.case.water[0].below, run.case.fluid
    assert level is not None
    depth = np.array([level - sensor.at[-1] for sensor in run.case.sensor])
    weight = fluid.density * fluid.gravity
    pressure = run.series.pressure.transpose("time", "sensor").values[1:]  # the first row stands before the first solve
    return [
        Check("largest speed", largest(run.series.max_speed), "m/s", 1e-9),
        Check("level error over spacing", largest(run.series.eta.values - level) / run.case.domain.spacing, "", 1e-3),
        Check("pressure error over rho g depth", 100.0 * largest(pressure / (weight * depth) - 1.0), "%", 0.5),
        *volume_checks(run),
    ]
