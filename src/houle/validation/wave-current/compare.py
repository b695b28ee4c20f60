"""Length and height of waves on a current, and the current itself."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from houle import analysis
from houle.results.reflection import first_harmonic, wave_of
from houle.validation.check import Check, Variant, report
from houle.validation.measure import largest
from houle.waves import dispersion

if TYPE_CHECKING:
    from houle.results.run import Run

PERIODS = 4  # periods that are measured
LENGTH, HEIGHT, CURRENT = 1.0, 3.0, 2.0  # %


def _current(speed: float) -> dict[str, Any]:
    """The case with another current [m/s]."""
    return {
        "water[0].velocity": [speed, 0.0],
        "waves.current": speed,
        "open[0].velocity": speed,
        "open[1].velocity": -speed,
    }


VARIANTS = (
    Variant("", quick=False),
    Variant("dx-25-mm", {"domain.spacing": 0.025}),
    Variant("opposing", _current(-0.1), quick=False),
)


def compare(run: Run) -> list[Check]:
    wave, table = wave_of(run.case), run.case.waves
    assert table is not None
    series, omega = run.series, 2 * np.pi / wave.period
    late = series.sel(time=slice(float(series.time[-1]) - PERIODS * wave.period + 1e-6, None))
    time, x = late.time.values, late.gauge_x.values
    eta = late.eta.transpose("gauge", "time").values - wave.depth
    mean, fundamental = analysis.harmonics(time, eta, omega, 2)[:, :2].T
    k = float(np.polyfit(x, np.unwrap(np.angle(fundamental)), 1)[0])
    back = dispersion.wave_number(omega, wave.depth, wave.gravity, -table.current)
    both = np.exp(1j * np.outer(x, [k, -float(back)]))
    gone, come = np.abs(np.linalg.lstsq(both, fundamental, rcond=None)[0])
    duration = float(time[-1] - time[0])
    flows = [float(v[-1] - v[0]) / duration for v in (late.inflow, late.outflow)]
    wanted = abs(table.current) * wave.depth
    still = 2 * np.pi / float(dispersion.wave_number(omega, wave.depth, wave.gravity))
    return [
        Check("wavelength off theory on the current", 100 * abs(wave.k / k - 1), "%", LENGTH),
        report("wavelength over that of still water", 2 * np.pi / k / still, note=f"theory {wave.length / still:.3f}"),
        Check("height off the target", 100 * abs(2 * gone / first_harmonic(wave) - 1), "%", HEIGHT),
        report("of it comes back from the sponge", 100 * come / gone, "%"),
        Check("discharge in, off the current", 100 * abs(flows[0] / wanted - 1), "%", CURRENT),
        Check("discharge out, off the current", 100 * abs(flows[1] / wanted - 1), "%", CURRENT),
        report("mean level off still water", 1e3 * float(mean.real.mean()), "mm"),
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
    ]
