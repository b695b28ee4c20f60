"""Flux of the forced start-up against its closed form."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from houle.grid import FloatArray
from houle.validation.check import Check, Variant, report
from houle.validation.exact import duct_flow
from houle.validation.measure import largest, observed_order, volume_checks
from houle.validation.media import medium

if TYPE_CHECKING:
    from houle.results.run import Run

BEADS = {
    "porous.rock.porosity": 0.39,
    "porous.rock.grain_diameter": 0.003,
    "porous.rock.resistance": {"law": "liu-1999"},
}

STEPS = {"step-8-ms": 0.008, "step-4-ms": 0.004, "": 0.002}
SHORT = 0.0025  # s: longer steps do not resolve the start, and are judged on the steady flux alone

VARIANTS = (
    *(Variant(name, {"time.step": step}) for name, step in STEPS.items()),
    Variant("beads", BEADS),
    Variant("beads-step-20-ms", {**BEADS, "time.step": 0.02}),
)


def compare(run: Run) -> list[Check]:
    error = _error(run)
    resolved = run.case.time.step is not None and run.case.time.step <= SHORT
    return [
        Check("flux, largest error over the last", largest(error), "%", 0.1 if resolved else None),
        Check("flux at the end, error", error[-1], "%", 0.1),
        *volume_checks(run),
    ]


def across(runs: Mapping[str, Run]) -> list[Check]:
    """Order of the time step."""
    errors = [largest(_error(runs[name])) for name in STEPS if name in runs]
    return [report("order in time", observed_order(list(STEPS.values()), errors))] if len(errors) == 3 else []


def _error(run: Run) -> FloatArray:
    """Error of the Darcy velocity at the sensor, in % of the last exact one."""
    drive = run.case.fluid.acceleration
    assert drive is not None
    time, flux = run.series.time.values, run.series.velocity.sel(axis="x").isel(sensor=0).values
    exact = duct_flow(time, medium(run.case.porous[0], run.case.fluid), drive[0])
    return 100.0 * np.abs(flux - exact) / exact[-1]
