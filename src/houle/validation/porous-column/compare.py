"""Wetted depth of a column of water entering a dry bed against the exact solution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.validation.check import Check, Variant, report
from houle.validation.exact import column_infiltration
from houle.validation.measure import largest, rms, wetted_depth
from houle.validation.media import bed_top, medium

if TYPE_CHECKING:
    from houle.runner import Run

RMS, WORST = 0.5, 2.0  # mm, at a spacing of 5 mm
BED = {"name": "bed", "porosity": 0.49, "grain_diameter": 0.0159, "added_mass": 0.34}
BED |= {"resistance": {"law": "jensen-2014", "alpha": 500.0, "beta": 2.0, "kc": 128.0}}


def bed(low: float, high: float) -> dict:
    """The bed with its top from `low` at the left to `high` at the right, and the water, 0.2 m above its mean top."""
    top, mean = [[0.05, high], [0.0, low]], 0.5 * (low + high)
    water = {"polygon": [[0.0, low], [0.05, high], [0.05, mean + 0.2], [0.0, mean + 0.2]]}
    return {"porous": [{**BED, "polygon": [[0.0, 0.0], [0.05, 0.0], *top]}], "water": [water]}


VARIANTS = (
    Variant(),
    Variant("off-the-grid-lines", bed(0.4525, 0.4525)),
    Variant("sloping-1-to-10", bed(0.4475, 0.4525)),
    Variant("dx-10-mm", {"domain.spacing": 0.01}),
)


def compare(run: Run) -> list[Check]:
    body, width = run.case.porous[0], run.case.domain.size[0]
    top, n = bed_top(body), body.porosity
    layer = float(run.series.volume[0]) / width
    time, exact_medium = run.series.time.values, medium(body, run.case.fluid)
    exact, _, _ = column_infiltration(time, exact_medium, layer, run.case.fluid.gravity)
    left = run.series.eta.isel(gauge=0).values - top
    error = 1e3 * ((layer - left) / n - exact)
    fine = run.case.domain.spacing <= 0.005 + 1e-9
    return [
        Check("wetted depth, rms", rms(error), "mm", RMS if fine else None),
        Check("wetted depth, largest", largest(error), "mm", WORST if fine else None),
        report("wetted depth at the end", float((layer - left[-1]) / n), "m", note=f"exact {exact[-1]:.4f} m"),
        Check("h + n s over the layer, less 1", 100.0 * _balance(run, top, n, layer, width), "%", 0.1),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]


def _balance(run: Run, top: float, n: float, layer: float, width: float) -> float:
    """Largest defect of the layer seen by the gauge plus the water that the particles have brought into the bed."""
    series, defects = run.series, []
    fields = run.fields
    for i, time in enumerate(fields.times):
        frame = fields.frame(i)
        left = float(np.interp(time, series.time.values, series.eta.isel(gauge=0).values)) - top
        filled = n * wetted_depth(frame.position, frame.volume, top, n, width)
        defects.append((left + filled) / layer - 1.0)
    return largest(np.array(defects))
