"""There are no open laboratory data: levels in front of and in the beads are reported, the volume is checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.data.laboratory import level
from houle.validation.check import Check, Variant, report
from houle.validation.measure import volume_checks

if TYPE_CHECKING:
    from houle.results.run import Run

PLACES = np.array([0.15, 0.35, 0.445])

VARIANTS = (
    Variant("dx-10-mm", {"domain.spacing": 0.01}),
    Variant("", quick=False),
    Variant("jensen-2014", {"porous.beads.resistance": {"law": "jensen-2014"}}, quick=False),
)


def compare(run: Run) -> list[Check]:
    found = []
    for time in (0.4, 0.8, 1.2):  # the instants of the paper's figures
        before, entering, middle = level(run.surface, time, PLACES)
        note = f"{entering:.4f} m at x = 0.35 m, {middle:.4f} m in the middle of the beads"
        found.append(report(f"level before the beads at {time:g} s", before, "m", note=note))
    return [*found, *volume_checks(run)]
