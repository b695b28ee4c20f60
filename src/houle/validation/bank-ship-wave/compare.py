"""Stability of the bank: exit gradient, Shields number, lag of the phreatic line."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from houle import analysis
from houle.validation.check import Check, Variant, report
from houle.validation.measure import largest

if TYPE_CHECKING:
    from houle.results.run import Run

SLOPE = math.atan(1 / 2.5)
ABOVE = 0.15  # height of the velocity sensor over the face [m]
SCHIJF = 0.203  # drawdown of the ship [m]; the record holds half of it

VARIANTS = (Variant("", quick=False), Variant("dx-200-mm", {"domain.spacing": 0.2}))


def compare(run: Run) -> list[Check]:
    bank, fluid, series = run.case.porous[0], run.case.fluid, run.series
    assert run.case.waves is not None and bank.grain_diameter is not None
    time, depth = series.time.values, run.case.waves.depth
    level = {str(g): series.eta.sel(gauge=g).values - depth for g in series.gauge.values}
    place = {sensor.name: sensor.at for sensor in run.case.sensor}
    leaving = analysis.exit_gradient(
        time, series.pressure.sel(sensor="inside").values, series.pressure.sel(sensor="outside").values,
        place["inside"], place["outside"], bank.porosity, density=fluid.density, gravity=fluid.gravity,
    )  # fmt: skip
    along = series.velocity.sel(sensor="face").transpose("time", ...).values @ [math.cos(SLOPE), math.sin(SLOPE)]
    moved = analysis.shields(along, ABOVE, bank.grain_diameter, slope=SLOPE, viscosity=fluid.viscosity)
    fallen = float(level["G2"].min())
    return [
        report(
            "lowest level at the bank", 1e3 * fallen, "mm", note=f"drawdown of the ship (Schijf) {-1e3 * SCHIJF:.0f}"
        ),
        report("level at the bank in the last 3 s", 1e3 * float(level["G2"][time > time[-1] - 3].mean()), "mm"),
        report("largest exit gradient", leaving.largest, note=f"critical {leaving.critical:.2f}"),
        report("safety against the critical gradient", leaving.safety),
        report("time above the critical gradient", leaving.time_above, "s"),
        report("largest Shields number at the face", moved.largest, note=f"critical {moved.critical:.4f}"),
        report("part of the time in which grains move", 100 * moved.moving, "%"),
        *(
            report(f"lag of the lowest level at {x}", float(time[level[x].argmin()] - time[level["G2"].argmin()]), "s")
            for x in ("B1", "B2", "B3")
        ),
        *(report(f"lowest phreatic level at {x}", 1e3 * float(level[x].min()), "mm") for x in ("B1", "B2", "B3", "B4")),
        Check("volume drift", largest(series.volume_drift), "-", 1e-12),
    ]
