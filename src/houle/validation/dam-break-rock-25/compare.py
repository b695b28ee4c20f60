"""A blind run: the data are kept apart. What can be said without them: the instants are there, and the volume."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.data.laboratory import level
from houle.validation.check import Check, Variant, report
from houle.validation.measure import at_time, volume_checks

if TYPE_CHECKING:
    from houle.results.run import Run

INSTANTS = np.round(np.arange(0.0, 2.21, 0.2), 1)
PLACES = np.array([0.15, 0.445, 0.75])

VARIANTS = (Variant("dx-10-mm", {"domain.spacing": 0.01}), Variant("", quick=False))


def compare(run: Run) -> list[Check]:
    wanted = [t for t in INSTANTS if t <= run.case.time.end + 1e-9]
    wet = [float(np.isfinite(at_time(run.surface.eta, t)).mean()) for t in wanted]
    last = ", ".join(f"{z:.4f}" for z in level(run.surface, wanted[-1], PLACES))
    return [
        Check("instants of the laboratory", len(wet), "", len(wanted), "min", note="data kept apart: not scored"),
        report("wet share of the worst profile", min(wet)),
        report("time of the last profile", wanted[-1], "s", note=f"{last} m before, in and behind the rock"),
        *volume_checks(run),
    ]
