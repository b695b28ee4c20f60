"""Flux of the forced start-up against its closed form."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.validation.check import Check, Variant
from houle.validation.exact import duct_flow
from houle.validation.measure import largest, volume_checks
from houle.validation.media import medium

if TYPE_CHECKING:
    from houle.runner import Run

BEADS = {
    "porous.rock.porosity": 0.39,
    "porous.rock.grain_diameter": 0.003,
    "porous.rock.resistance": {"law": "liu-1999"},
}

VARIANTS = (Variant(), Variant("beads", BEADS), Variant("step-of-10-ms", {"time.step": 0.01}))


def compare(run: Run) -> list[Check]:
    """The target is for the step that the Courant number chooses; a fixed one is judged on the steady flux alone."""
    drive = run.case.fluid.acceleration[0]
    time, flux = run.series.time.values, run.series.velocity.sel(axis="x").isel(sensor=0).values
    exact = duct_flow(time, medium(run.case.porous[0], run.case.fluid), drive)
    error = 100.0 * np.abs(flux - exact) / exact[-1]
    return [
        Check("flux, largest error over the last", largest(error), "%", None if run.case.time.step else 0.1),
        Check("flux at the end, error", error[-1], "%", 0.1),
        *volume_checks(run),
    ]
