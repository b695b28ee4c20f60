"""Amplitude, period and energy of a wave in a closed basin; convergence against the non-linear solution."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from houle.grid import FloatArray
from houle.validation.check import Check, Variant, report
from houle.validation.exact import dispersion, released_wave, standing_wave_frequency
from houle.validation.measure import (
    fundamental,
    grid_convergence_index,
    largest,
    mean_period,
    observed_order,
    period_mean,
    rms,
    sliding_amplitude,
    volume_checks,
)

if TYPE_CHECKING:
    from houle.results.run import Run

GROWTH = 1.002
SHORT = {"time.end": 2.8, "time.step": 0.001}  # two periods, a step so short that the spacing decides
EXACT = {10: 0.992, 50: 0.989}  # non-linear wave of 20 mm (exact.released_wave), in between 0.986 to 0.999
LONG, FINE, SMALL = 70.6, {"dx-20-mm": 0.02, "dx-10-mm": 0.01, "dx-5-mm": 0.005}, 0.005


def still_and_cosine(amplitude: float, depth: float = 0.25, length: float = 1.0, pieces: int = 100) -> dict:
    """The water of the case with another amplitude [m]."""
    x = np.linspace(length, 0.0, pieces + 1)
    surface = np.stack([x, depth + amplitude * np.cos(np.pi * x / length)], axis=1)
    return {"water": [{"polygon": [[0.0, 0.0], [length, 0.0], *surface.tolist()]}]}


STEPS = {f"step-{1e3 * s:g}-ms": {"time.step": s} for s in (0.002, 0.005, 0.01)}
VARIANTS = (
    Variant(),
    *(Variant(name, step, quick=False) for name, step in STEPS.items()),
    Variant("amplitude-5-mm", still_and_cosine(SMALL)),
    Variant("50-periods", {"time.end": LONG}, quick=False),
    *(Variant(f"50-periods-{name}", {"time.end": LONG, **step}, quick=False) for name, step in STEPS.items()),
    *(Variant(name, {**SHORT, "domain.spacing": dx}, quick=False) for name, dx in FINE.items()),
)


def compare(run: Run) -> list[Check]:
    start, depth, length = _shape(run)
    gravity = run.case.fluid.gravity
    period = 2.0 * np.pi / dispersion(np.pi / length, depth, gravity)
    exact = 2.0 * np.pi / standing_wave_frequency(start, np.pi / length, depth, gravity)
    time, wave = run.series.time.values, fundamental(run.series.eta, length)
    small, count = start < 0.6 * run.case.domain.spacing, int(time[-1] / period - 0.5)
    centres, amplitude = sliding_amplitude(time, wave, period)
    if count < 9:  # too short to judge: the runs for the order of convergence
        return [report("amplitude, last period", amplitude[-1] / start)]
    last = amplitude[np.argmin(np.abs(centres - count * period))] / start
    wrong = 100.0 * abs(mean_period(time, wave) / exact - 1.0)
    energy = period_mean(_energy(run, length), period / (time[1] - time[0]))
    gained = 100.0 * (energy / energy[0] - 1.0)
    note = f"exact {exact:.4f} s, small waves {period:.4f} s"
    return [
        _kept(last, count, small),
        Check("amplitude, largest", float(amplitude.max() / start), "", GROWTH),
        Check("period error", wrong, "%", 0.5 if small else 0.3, peers={"REEF3D": "0.13"}, note=note),
        report("energy, mean of a period, largest over the first", gained.max(), "%"),
        report("energy, mean of a period, last over the first", gained[-1], "%"),
        *volume_checks(run),
    ]


def across(runs: Mapping[str, Run]) -> list[Check]:
    """Error of the fundamental over two periods against the fully non-linear solution, at three spacings."""
    if not runs.keys() >= FINE.keys():
        return []
    errors = [100.0 * _distance(runs[name]) for name in FINE]
    order = observed_order(list(FINE.values()), errors)
    return [
        *(report(f"error at {name}, over the amplitude", e, "%") for name, e in zip(FINE, errors, strict=True)),
        Check("order of convergence", order, "", 1.8, "min"),
        report("grid convergence index at 5 mm", grid_convergence_index(errors[1] - errors[2], 2.0, order), "%"),
    ]


def _kept(last: float, count: int, small: bool) -> Check:
    """The amplitude after ten or fifty periods over the first. It beats with the free second mode: see EXACT."""
    name = f"amplitude after {count} periods"
    if small:
        return Check(name, last, "", 0.90, "min")
    exact = {"exact": EXACT[count]} if count in EXACT else {}
    if count > 20:
        return Check(name, last, "", 0.90, "min", exact)
    return Check(name, last, "", (0.97, 1.00), "range", exact)


def _distance(run: Run) -> float:
    start, depth, length = _shape(run)
    time: FloatArray = run.series.time.values
    exact = released_wave(time, start, length, depth, run.case.fluid.gravity)[:, 0]
    return rms(fundamental(run.series.eta, length) - exact) / start


def _energy(run: Run, length: float) -> FloatArray:
    """Kinetic energy of the water and potential energy rho g / 2 (eta - mean)^2 of the surface at the gauges [J/m]."""
    level = run.series.eta - run.series.eta.mean("gauge")
    weight = run.case.fluid.density * run.case.fluid.gravity * length
    return (run.series.kinetic_energy + 0.5 * weight * (level**2).mean("gauge")).values


def _shape(run: Run) -> tuple[float, float, float]:
    """Amplitude, depth and length [m] of the water at the start."""
    polygon = run.case.water[0].polygon
    assert polygon is not None
    level = np.array([z for _, z in polygon[2:]])
    return float(np.ptp(level) / 2), float((level.max() + level.min()) / 2), largest(np.array(polygon)[:, 0])
