"""Drawdown at the bank against the formulas, and the stability of the bank: seepage, sliding, grains that move."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.validation.check import Check, Variant, report
from houle.validation.measure import largest
from houle.waves.ship import ShipWave

if TYPE_CHECKING:
    from houle.results.run import Run

SETTLED = 2.0  # s after the level at the bank has fallen, in which it swings

VARIANTS = (Variant("", quick=False), Variant("dx-200-mm", {"domain.spacing": 0.2}))


def compare(run: Run) -> list[Check]:
    wave, series = run.case.wave, run.series
    assert isinstance(wave, ShipWave)
    ship, time = wave.passage, series.time.values
    level = {str(g): series.eta.sel(gauge=g).values - wave.depth for g in series.gauge.values}
    late = _delay(run)
    start, end = ship.trough
    low = level["G2"][(time > start + late + SETTLED) & (time < end + late)]
    off = 100 * (-float(low.mean()) / ship.drawdown - 1)
    bank = run.summary["bank"][0]
    return [
        Check("mean level while it is low, off the drawdown at the bank", off, "%", (-5.0, 5.0), "range"),
        report("lowest level at the bank", 1e3 * float(level["G2"].min()), "mm", note=_millimetres(-ship.drawdown)),
        report("highest level at the bank", 1e3 * float(level["G2"].max()), "mm",
               note=_millimetres(ship.stern - ship.drawdown)),
        report("level at the bank in the last 3 s", 1e3 * float(level["G2"][time > time[-1] - 3].mean()), "mm"),
        report("lowest factor of safety", bank["safety"]["value"], note=f"in still water {bank['still']:.2f}"),
        report("largest exit gradient", bank["gradient"]["value"], note=f"critical {bank['critical']:.2f}"),
        report("largest excess pore pressure", bank["excess"]["value"], "Pa"),
        report("largest Shields number", bank["shields"]["value"], note=f"critical {bank['mobile']:.4f}"),
        report("  without the return current", bank["shields_in_section"]),
        report("longest time in which grains move", bank["moving"], "s"),
        *(
            report(f"lag of the lowest level at {x}", float(time[level[x].argmin()] - time[level["G2"].argmin()]), "s")
            for x in ("B1", "B2", "B3")
        ),
        *(report(f"lowest phreatic level at {x}", 1e3 * float(level[x].min()), "mm") for x in ("B1", "B2", "B3", "B4")),
        Check("volume drift", largest(series.volume_drift), "-", 1e-12),
    ]  # fmt: skip


def _delay(run: Run) -> float:
    """Time [s] of a long wave from the toe, where the passage is stated, to the gauge on the slope."""
    wave, ship = run.case.wave, run.case.ship
    assert wave is not None and ship is not None
    gauge = next(g.x for g in run.case.gauge if g.name == "G2")
    depth = np.linspace(wave.depth, wave.depth - (gauge - ship.toe) / 2.5, 101)
    return float(np.mean(1 / np.sqrt(wave.gravity * depth))) * (gauge - ship.toe)


def _millimetres(level: float) -> str:
    return f"formulas {1e3 * level:.0f}"
