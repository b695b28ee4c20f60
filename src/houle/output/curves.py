"""The pictures against time: the ledger of a run, its gauges and sensors."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from houle.fields import OPERATIONS
from houle.grid import FloatArray, Grid
from houle.output import drawing
from houle.output.drawing import FAINT, LINES, headings, label_ends, sheet

Curves = dict[str, FloatArray]
LEFT = 0.78  # inches, for numbers and units


def ledger_picture(path: Path, case: Any, grid: Grid, series: xr.Dataset) -> Path:
    """What the run conserved and what it cost: energy and who changed it, volume, iterations, time step."""
    energy = "J/m" if grid.dimension == 2 else "J"
    split = {name: f"energy_{name}" for name in OPERATIONS}
    level = {"": 1e3 * (series.mean_level - series.mean_level[0]).values} if "mean_level" in series else {}
    panels: list[tuple[str, str, Curves]] = [
        ("Energy, change since the start", energy, _energies(series)),
        ("Energy by operation, summed", energy, _named(series, split)),
        ("Water volume, relative drift", "", _named(series, {"": "volume_drift"})),
        ("Mean level, change", "mm", level),
        (
            "Iterations",
            "per step",
            _named(series, {"pressure": "pressure_iterations", "correction": "correction_iterations"}),
        ),
        ("Time step", "ms", {"": 1e3 * series.step_size.values} if "step_size" in series else {}),
    ]
    panels = [entry for entry in panels if entry[2]]
    with drawing.style():
        words = f"the ledger  ·  {float(series.time[-1]):g} s of simulated time"
        title = case.case.title or case.case.name
        page = sheet(len(panels), 2, (3.3, 1.5), title, words, gap=(1.65, 0.62), margins=(LEFT, 0.95, 0.5, 0.95))
        for panel, (name, unit, curves) in zip(page.panels, panels, strict=True):
            draw_curves(panel, series.time.values, curves, unit)
            headings(panel, name)
        for panel in page.panels[-2:]:
            panel.set_xlabel("t [s]")
        return page.save(path)


def gauges_picture(path: Path, case: Any, grid: Grid, series: xr.Dataset) -> Path:
    """The free surface at each gauge, pressure and horizontal Darcy velocity at the sensors."""
    rows: list[tuple[str, str, Curves]] = []
    if "eta" in series:
        for g, name in enumerate(_places(series, "gauge", "{axis} = {value:g} m")):
            rows.append((f"Level at {name}", "m", {"": series.eta.values[g]}))
    if "pressure" in series:
        names = _places(series, "sensor", "{value:g}")
        rows.append(("Pressure", "kPa", {name: series.pressure.values[s] / 1e3 for s, name in enumerate(names)}))
        rows.append(
            ("Darcy velocity along x", "m/s", {n: series.velocity.values[s, :, 0] for s, n in enumerate(names)})
        )
    with drawing.style():
        title, words = case.case.title or case.case.name, "gauges and sensors  ·  a gap is a dry gauge"
        right = 1.55 if any(len(curves) > 1 or "" not in curves for _, _, curves in rows) else 0.3  # for the names
        page = sheet(len(rows), 1, (6.4, 1.15), title, words, gap=(0, 0.5), margins=(LEFT, right, 0.5, 0.95))
        for panel, (name, unit, curves) in zip(page.panels, rows, strict=True):
            draw_curves(panel, series.time.values, curves, unit)
            if unit == "m":
                _level_limits(panel, curves[""])
            headings(
                panel,
                name,
                "" if unit == "m" else f"sensors at ({', '.join('xz' if grid.dimension == 2 else 'xyz')}) [m]",
            )
        page.panels[-1].set_xlabel("t [s]")
        return page.save(path)


def draw_curves(panel: Axes, time: FloatArray, curves: Curves, unit: str) -> None:
    """Lines named at their right ends, the zero line faint, the unit on the axis with a power of ten if need be."""
    scale = _power_of_ten(max((np.nanmax(np.abs(v)) for v in curves.values() if np.isfinite(v).any()), default=0.0))
    panel.axhline(0, color=FAINT, lw=0.8, zorder=0)
    ends = []
    for (words, values), colour in zip(curves.items(), itertools.cycle(LINES), strict=False):
        panel.plot(time, values / 10.0**scale, color=colour, lw=1.2)
        wet = values[np.isfinite(values)]
        if words and len(wet):
            ends.append((float(wet[-1]) / 10.0**scale, words, colour))
    panel.set_xlim(time[0], max(time[-1], time[0] + 1e-12))
    panel.locator_params(axis="both", nbins=5)
    label_ends(panel, ends)
    factor = f"$10^{{{scale}}}$" if scale else ""
    panel.set_ylabel(f"[{factor} {unit}]".replace("[ ", "[").replace(" ]", "]") if factor or unit else "")
    width = panel.get_window_extent().width / panel.figure.dpi  # inches
    panel.yaxis.set_label_coords((0.26 - LEFT) / width, 0.5)  # in line, however long the numbers are


def _power_of_ten(largest: float) -> int:
    """0 where numbers read well as they are, else the multiple of 3 that leaves them between 0.1 and 100."""
    return 0 if largest == 0 or 1e-2 <= largest < 1e4 else 3 * round((np.log10(largest) - 0.5) / 3)


def _energies(series: xr.Dataset) -> Curves:
    """Change of kinetic, potential and total energy, and what was lost on purpose (downwards)."""
    if "kinetic_energy" not in series or "potential_energy" not in series:
        return {}
    kinetic, potential = (
        series[name].values - series[name].values[0] for name in ("kinetic_energy", "potential_energy")
    )
    lost = {"lost to drag": "drag_work", "lost to viscosity": "viscous_work"}
    curves = {"kinetic": kinetic, "potential": potential, "sum": kinetic + potential}
    return curves | {words: -values for words, values in _named(series, lost).items()}


def _named(series: xr.Dataset, names: dict[str, str]) -> Curves:
    return {words: series[name].values for words, name in names.items() if name in series}


def _places(series: xr.Dataset, kind: str, form: str) -> list[str]:
    """The names of the gauges or sensors, each with its position; form: of one coordinate, from axis and value."""
    axes = [axis for axis in "xyz" if f"{kind}_{axis}" in series]
    numbers = np.stack([series[f"{kind}_{axis}"].values for axis in axes], axis=-1)
    places = [", ".join(form.format(axis=a, value=v) for a, v in zip(axes, point, strict=True)) for point in numbers]
    return [f"{name} ({place})" for name, place in zip(series[kind].values, places, strict=True)]


def _level_limits(panel: Axes, eta: FloatArray) -> None:
    """Close around the surface; never so close that round-off looks like a wave."""
    wet = eta[np.isfinite(eta)]
    if len(wet):
        middle, half = 0.5 * (wet.max() + wet.min()), max(0.5 * (wet.max() - wet.min()), 1e-3)
        panel.set_ylim(middle - 1.15 * half, middle + 1.15 * half)
