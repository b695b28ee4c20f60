"""Flux through a saturated plug, and the pressure jump at its two faces, against the closed form."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.validation.check import Check, Variant
from houle.validation.exact import bernoulli_jump, duct_flow
from houle.validation.measure import largest, line_at
from houle.validation.media import medium

if TYPE_CHECKING:
    from houle.results.run import Run

ROCK = {
    "porous.plug.grain_diameter": 0.0159,
    "porous.plug.added_mass": 0.34,
    "porous.plug.resistance": {"law": "jensen-2014", "alpha": 500.0, "beta": 2.0, "kc": 128.0},
}
VARIANTS = (Variant(), Variant("rock", ROCK), Variant("dx-10-mm", {"domain.spacing": 0.01}))


def compare(run: Run) -> list[Check]:
    body, fluid, series = run.case.porous[0], run.case.fluid, run.series
    assert body.box is not None
    (start, _), (stop, _) = body.box
    time, flux = series.time.values, series.velocity.sel(axis="x").mean("sensor").values
    rock = medium(body, fluid)
    exact = duct_flow(time, rock, fluid.acceleration[0], run.case.domain.size[0], stop - start)
    late = time >= 0.6 * time[-1]
    scale = fluid.density * bernoulli_jump(float(flux[late].mean()), body.porosity, rock.convective)
    x, pressure = series.sensor_x.values, series.pressure.transpose("sensor", "time").values[:, late]

    def at(where: float, part: np.ndarray) -> np.ndarray:
        return line_at(x[part], pressure[part], where)

    before, inside, behind = x < start, (x > start) & (x < stop), x > stop
    entry = float(np.mean(at(start, before) - at(start, inside)) / scale)
    leaving = float(np.mean(at(stop, behind) - at(stop, inside)) / scale)
    jump = (0.99, 1.01)
    return [
        Check("flux, largest error over the last", 100.0 * largest(flux - exact) / exact[-1], "%", 0.1),
        Check("flux at the end, error", 100.0 * abs(flux[-1] / exact[-1] - 1.0), "%", 0.1),
        Check("pressure jump going in, over the exact one", entry, "", jump, "range"),
        Check("pressure jump coming out, over the exact one", leaving, "", jump, "range"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]
