"""Measurements for the comparisons, of arrays or xarray objects: they know no case."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from houle.flow.snapshot import Snapshot
from houle.grid import FloatArray
from houle.validation.check import Check

if TYPE_CHECKING:
    from houle.results.run import Run


def read_points(path: Path) -> Any:
    """Reads a CSV with # comments and a line of names as a structured array, one field per name."""
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return np.genfromtxt(lines, delimiter=",", names=True)


def at_time(data: xr.DataArray, time: float) -> xr.DataArray:
    """The record at this time [s]; KeyError when there is none within half a millisecond."""
    return data.sel(time=time, method="nearest", tolerance=5e-4)


def water_left_of(x: FloatArray, frame: Snapshot) -> FloatArray:
    """Water [m2] (N,) to the left of the places x (N,) [m], from the particles: squares of bulk volume V / n (2D)."""
    side = np.sqrt(frame.volume / frame.porosity)
    share = (np.asarray(x)[:, None] - frame.position[:, 0] + side / 2) / side
    return np.clip(share, 0.0, 1.0) @ frame.volume


def rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def front_position(eta: xr.DataArray, thickness: float) -> FloatArray:
    """Foremost x [m] (T,) of the water joined to the left wall and at least this thick [m], linear between columns.

    Drops thrown ahead do not count. Without any such column: 0.
    """
    x, front = eta.x.values, np.zeros(eta.sizes["time"])
    for i, row in enumerate(np.nan_to_num(eta.transpose("time", "x").values)):
        thin = np.flatnonzero(row < thickness)
        last = (thin[0] if thin.size else len(x)) - 1
        if last < 0:
            continue
        if last + 1 == len(x):
            front[i] = x[-1]
            continue
        share = (row[last] - thickness) / (row[last] - row[last + 1])
        front[i] = x[last] + share * (x[last + 1] - x[last])
    return front


def lowest_water(position: FloatArray, volume: FloatArray, porosity: FloatArray, width: float) -> float:
    """Level z [m] of the underside of the lowest particle, a box of bulk volume V/n on a base `width` [m] wide (2D)."""
    return float(np.min(position[:, -1] - volume / porosity / (2.0 * width)))


def fundamental(eta: xr.DataArray, length: float) -> FloatArray:
    """Amplitude (T,) [m] of cos(pi x / length) in the levels of gauges at the middles of equal parts of the basin."""
    weight = np.cos(np.pi * eta.gauge_x.values / length)
    return 2.0 / len(weight) * eta.transpose("time", "gauge").values @ weight


def sliding_amplitude(time: FloatArray, signal: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
    """Centres [s] and amplitudes of sinusoids, with a mean, fitted to the period around every quarter period."""
    centres = np.arange(time[0] + period / 2, time[-1] - period / 2 + 1e-9, period / 4)
    angle = 2.0 * np.pi / period * time
    basis = np.stack([np.cos(angle), np.sin(angle), np.ones_like(angle)], axis=1)
    found = []
    for centre in centres:
        inside = np.abs(time - centre) <= period / 2 + 1e-9
        cosine, sine, _ = np.linalg.lstsq(basis[inside], signal[inside], rcond=None)[0]
        found.append(np.hypot(cosine, sine))
    return centres, np.array(found)


def period_mean(values: FloatArray, samples: float) -> FloatArray:
    """Running mean over a period of so many samples (the whole number next to it), full windows only."""
    return np.convolve(values, np.full(round(samples), 1.0 / round(samples)), mode="valid")


def mean_period(time: FloatArray, signal: FloatArray) -> float:
    """Mean period [s] from the zero crossings, straight line through their times. NaN with fewer than three."""
    at = np.flatnonzero(np.sign(signal[:-1]) * np.sign(signal[1:]) < 0)
    if len(at) < 3:
        return float("nan")
    crossing = time[at] - signal[at] * (time[at + 1] - time[at]) / (signal[at + 1] - signal[at])
    return float(2.0 * np.polyfit(np.arange(len(at)), crossing, 1)[0])


def noise(time: FloatArray, signal: FloatArray, above: float = 20.0) -> float:
    """Root mean square of the part of an evenly sampled signal above a frequency [Hz]; it is mirrored at its ends."""
    both = np.concatenate([signal, signal[::-1]])
    spectrum = np.fft.rfft(both)
    spectrum[np.fft.rfftfreq(len(both), time[1] - time[0]) < above] = 0.0
    return rms(np.fft.irfft(spectrum, len(both)))


def line_at(x: FloatArray, values: FloatArray, where: float) -> FloatArray:
    """The straight line through values (P, T) at x (P,), carried on to `where`: (T,)."""
    slope, offset = np.polyfit(x, values, 1)
    return slope * where + offset


def observed_order(spacings: Sequence[float], errors: Sequence[float]) -> float:
    """Slope of log error against log spacing, least squares."""
    return float(np.polyfit(np.log(spacings), np.log(errors), 1)[0])


def grid_convergence_index(difference: float, ratio: float, order: float, safety: float = 1.25) -> float:
    """Roache's estimate of the error of the finer of two grids: 1.25 |difference| / (ratio^order - 1)."""
    return safety * abs(difference) / (ratio**order - 1.0) if order > 0.0 else float("nan")


def volume_checks(run: Run) -> list[Check]:
    """Water is neither made nor lost, and the surface stands as high as the volume says, at every sample."""
    plan = float(np.prod(run.case.domain.size[:-1]))
    level = 1e3 * np.abs(run.series.mean_level.values - run.series.volume.values / plan)
    note = f"at the end {level[-1]:.2g} mm"
    return [
        Check("volume drift", largest(run.series.volume_drift), "-", 1e-12),
        Check("mean level against volume, largest", level.max(), "mm", 0.1, note=note),
    ]


def rest_checks(run: Run) -> list[Check]:
    """Water at rest below a level, from t = 0 on: speed, level, pressure at the sensors, volume."""
    level, fluid = run.case.water[0].below, run.case.fluid
    assert level is not None
    depth = np.array([level - sensor.at[-1] for sensor in run.case.sensor])
    pressure = run.series.pressure.transpose("time", "sensor").values / (fluid.density * fluid.gravity * depth)
    return [
        Check("largest speed", largest(run.series.max_speed), "m/s", 1e-9),
        Check("level error over spacing", largest(run.series.eta.values - level) / run.case.domain.spacing, "", 1e-3),
        Check("pressure error over rho g depth", 100.0 * largest(pressure - 1.0), "%", 0.5),
        *volume_checks(run),
    ]


def largest(values: xr.DataArray | FloatArray) -> float:
    """Largest magnitude; NaN when one is NaN."""
    return float(np.max(np.abs(np.asarray(values))))
