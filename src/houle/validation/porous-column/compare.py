"""Wetted depth of a column of water entering a dry bed against the exact solution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.grid import FloatArray
from houle.validation.check import Check, Variant, report
from houle.validation.exact import column_infiltration
from houle.validation.measure import largest, lowest_water, rms
from houle.validation.media import bed_top, medium

if TYPE_CHECKING:
    from houle.results.run import Run

RMS, WORST = 0.5, 2.0  # mm, at a spacing of 5 mm and the step of the case
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
    Variant("step-1-ms", {"time.step": 0.001}, quick=False),
    Variant("step-4-ms", {"time.step": 0.004}, quick=False),
)


def compare(run: Run) -> list[Check]:
    body, width = run.case.porous[0], run.case.domain.size[0]
    top, n = bed_top(body), body.porosity
    layer = float(run.series.volume[0]) / width
    time, exact_medium = run.series.time.values, medium(body, run.case.fluid)
    exact, _, _ = column_infiltration(time, exact_medium, layer, run.case.fluid.gravity)
    left = run.series.eta.isel(gauge=0).values - top
    error = 1e3 * ((layer - left) / n - exact)
    fine = run.case.domain.spacing < 0.0051 and (run.case.time.step or 1.0) < 0.0021
    return [
        Check("wetted depth, rms", rms(error), "mm", RMS if fine else None),
        Check("wetted depth, largest", largest(error), "mm", WORST if fine else None),
        report("wetted depth at the end", float((layer - left[-1]) / n), "m", note=f"exact {exact[-1]:.4f} m"),
        Check("front of the particles, error", _front_error(run, top, exact), "mm", 1e3 * run.case.domain.spacing),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]


def _front_error(run: Run, top: float, exact: FloatArray) -> float:
    """Largest distance [mm] of the lowest water from the exact front."""
    fields, time, errors = run.fields, run.series.time.values, []
    for i, instant in enumerate(fields.times):
        frame = fields.frame(i)
        low = lowest_water(frame.position, frame.volume, frame.porosity, run.case.domain.spacing / 2)
        errors.append(top - low - np.interp(instant, time, exact))
    return 1e3 * largest(np.array(errors))
