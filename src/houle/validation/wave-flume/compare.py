"""Height, decay, celerity, shape and level of waves in an empty flume; both sides of the internal source."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.grid import FloatArray
from houle.results import reflection
from houle.results.reflection import first_harmonic, wave_of
from houle.validation.check import Check, Variant, report
from houle.validation.flume import empty, one_sided, two_sided, wall
from houle.validation.measure import largest
from houle.validation.waves import card, second_harmonic, window

if TYPE_CHECKING:
    from houle.results.run import Run
    from houle.waves.wave import Wave

HEIGHT, SIDES, SPURIOUS = 2.0, 1.0, 2.0  # %
DECAY, CELERITY, LOSS = 0.5, 0.5, 2.0  # % per wavelength, %, % of the energy per wavelength
SHAPE, LEVEL = 4.0, 0.1  # % of H (rms), mm
WALL = 0.98

VARIANTS = (
    Variant("", quick=False),
    Variant("dx-20-mm", {"domain.spacing": 0.02}),
    Variant("dx-5-mm", {"domain.spacing": 0.005}, quick=False),
    Variant("H-80-mm", empty(1.2, 0.08), quick=False),
    Variant("H-80-mm-dx-20-mm", {**empty(1.2, 0.08), "domain.spacing": 0.02}, quick=False),
    Variant("source-H-80-mm", one_sided(1.2, 0.08), quick=False),
    Variant("source-H-80-mm-dx-20-mm", {**one_sided(1.2, 0.08), "domain.spacing": 0.02}, quick=False),
    Variant("wall", {**wall(1.2, 0.02), "domain.spacing": 0.02, "time.courant": 1.0, "output.every": 10.0}),
    *(
        Variant(f"source-T-{period:g}-s", {**two_sided(period, 0.01), "domain.spacing": 0.02}, quick=period == 1.0)
        for period in (1.0, 1.5, 2.0)
    ),
)


def compare(run: Run) -> list[Check]:
    waves = run.case.waves
    assert waves is not None
    drift = Check("volume drift", largest(run.series.volume_drift), "-", 1e-12)
    if run.case.reflection is not None:
        return [*_at_wall(run), drift]
    both = waves.source is not None and waves.source.side == "both"
    return [*(_from_source(run) if both else _travelling(run)), drift]


def _at_wall(run: Run) -> list[Check]:
    """Standing waves in front of a solid wall."""
    found = reflection.measure(run)
    low, high = found.interval_R
    wave = wave_of(run.case)
    return [
        Check("C_R of a solid wall", found.C_R, "", WALL, "min", note=f"{low:.3f} to {high:.3f}"),
        report("unexplained by two waves", 100 * found.residual, "%"),
        report("incident height over the target", found.H_I / first_harmonic(wave)),
    ]


def _travelling(run: Run) -> list[Check]:
    """Waves that have left the maker to the right."""
    wave, found = wave_of(run.case), card(run)
    fine, steep = run.case.domain.spacing < 0.011, wave.height > 0.05
    return [
        Check("height over the target", 100 * abs(found.height / found.target - 1), "%", HEIGHT),
        Check("decay per wavelength", 100 * found.decay, "%", DECAY if fine and not steep else None),
        Check("celerity off Fenton", 100 * abs(found.celerity), "%", CELERITY if not steep else None),
        Check("rms distance from Fenton, of H", 100 * _shape_error(run, wave), "%", SHAPE, note="phase fitted"),
        *_second_harmonic(run, wave),
        Check("reflection of the sponge", 100 * found.reflection, "%", SPURIOUS),
        Check("mean level, drift in the window", 1e3 * abs(found.drift), "mm", LEVEL if not steep else None),
        report("mean level off still water", 1e3 * found.set_down, "mm"),
        Check("energy lost in numbers, per wavelength", 100 * abs(_lost(run)), "%", LOSS),
    ]


def _from_source(run: Run) -> list[Check]:
    """Waves to both sides."""
    names = [gauge.name for gauge in run.case.gauge]
    right = card(run, [n for n in names if n.startswith("R")], 1.0)
    left = card(run, [n for n in names if n.startswith("L")], -1.0)
    return [
        Check("height to the right over the target", 100 * abs(right.height / right.target - 1), "%", HEIGHT),
        Check("height to the left over the target", 100 * abs(left.height / left.target - 1), "%", HEIGHT),
        Check("left over right", 100 * abs(left.height / right.height - 1), "%", SIDES),
        Check("energy lost in numbers, per wavelength", 100 * abs(_lost(run)), "%", LOSS),
        Check("reflection of the right sponge", 100 * right.reflection, "%", SPURIOUS),
        Check("reflection of the left sponge", 100 * left.reflection, "%", SPURIOUS),
        Check("mean level, drift in the window", 1e3 * max(abs(right.drift), abs(left.drift)), "mm", LEVEL),
    ]


def _shape_error(run: Run, wave: Wave) -> float:
    """rms between levels and theory over gauges and window, of the height; one shift in time for all gauges."""
    late = run.series.sel(time=slice(*window(run)))
    eta: FloatArray = late.eta.transpose("gauge", "time").values - wave.depth
    x, time = late.gauge_x.values[:, None], late.time.values[None, :]

    def distance(shift: float) -> float:
        return float(np.sqrt(np.mean((eta - wave.elevation(x, time - shift)) ** 2)))

    shifts = np.linspace(-0.5, 0.5, 201) * wave.period
    return min(distance(s) for s in shifts) / wave.height


def _second_harmonic(run: Run, wave: Wave) -> list[Check]:
    parts = wave.components()
    if parts is None or len(parts.k) < 2:
        return []
    bound, along = second_harmonic(run, back=False) / wave.height
    exact = 100 * parts.amplitude[1] / wave.height
    return [
        report("bound second harmonic, of H", 100 * bound, "%", note=f"Fenton {exact:.2f}"),
        report("free second harmonic, of H", 100 * along, "%"),
    ]


def _lost(run: Run) -> float:
    """Part of the energy of the waves that neither sponges nor viscosity took, per wavelength."""
    return float(run.summary["wave_energy"]["lost_per_wavelength"])
