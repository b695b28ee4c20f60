"""A submerged porous block changes a solitary wave. No open data: numbers to compare with, not targets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.validation.check import Check, Variant, report
from houle.validation.measure import largest

if TYPE_CHECKING:
    from houle.results.run import Run

VARIANTS = (Variant("", quick=False), Variant("dx-10-mm", {"domain.spacing": 0.01}))


def compare(run: Run) -> list[Check]:
    waves = run.case.waves
    assert waves is not None and waves.height is not None
    time = run.series.time.values
    level = {str(g): run.series.eta.sel(gauge=g).values - waves.depth for g in run.series.gauge.values}
    passed = time[int(np.argmax(level["G2"]))]
    back = level["G1"][time > passed + 0.6]
    incident = float(level["G1"][time < passed].max())
    return [
        report("incident crest over the target", incident / waves.height),
        report("crest over the block, over the incident", float(level["G3"].max()) / incident),
        report("transmitted crest over the incident", float(level["G4"].max()) / incident),
        report("reflected crest over the incident", float(back.max()) / incident),
        report("largest pore velocity in the block", float(np.abs(run.series.velocity.sel(sensor="P1")).max())
               / run.case.porous[0].porosity, "m/s"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]  # fmt: skip
