"""The pictures against time: the ledger of a run, its gauges and sensors."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from houle.case.model import Case
from houle.data.laboratory import Data
from houle.flow.ledger import OPERATIONS
from houle.grid import FloatArray, Grid, axes
from houle.output import drawing
from houle.output.drawing import FAINT, LINES, headings, label, label_ends, sheet

Curves = dict[str, FloatArray]
LEFT = 0.78  # left margin for numbers and units [inches]
MOST = 10  # gauges in a picture


def ledger_picture(path: Path, case: Case, grid: Grid, series: Data) -> Path:
    """The ledger of a run against time: energy and its changes, water volume, iterations and time step."""
    energy = "J/m" if grid.dimension == 2 else "J"
    split = {name: key for name in OPERATIONS if (key := f"energy_{name}") in series and series[key].values.any()}
    level = {"": 1e3 * (series["mean_level"].values - series["mean_level"].values[0])} if "mean_level" in series else {}
    iterations = {"pressure": "pressure_iterations", "correction": "correction_iterations"}
    panels: list[tuple[str, str, Curves]] = [
        ("Energy, change since the start", energy, _energies(series)),
        ("Energy of the particles by operation, summed", energy, _named(series, split)),
        ("Water volume, relative drift", "", _named(series, {"": "volume_drift"})),
        ("Mean level, change", "mm", level),
        ("Iterations", "per step", _named(series, iterations)),
        ("Time step", "ms", {"": 1e3 * series["step_size"].values} if "step_size" in series else {}),
    ]
    panels = [entry for entry in panels if entry[2]]
    time = series["time"].values
    words = f"the ledger  ·  {float(time[-1]):g} s of simulated time"
    with drawing.style():
        page = sheet(len(panels), 2, (3.3, 1.5), case.title, words, gap=(1.65, 0.62), margins=(LEFT, 0.95, 0.5, 0.95))
        for i, (panel, (name, unit, curves)) in enumerate(zip(page.panels, panels, strict=True)):
            draw_curves(panel, time, curves, unit, "t [s]" if i + 2 >= len(panels) else "")
            headings(panel, name)
        return page.save(path)


def gauges_picture(path: Path, case: Case, grid: Grid, series: Data) -> Path:
    """The free surface at the gauges (at most MOST of them); pressure and horizontal Darcy velocity at the sensors."""
    rows: list[tuple[str, str, Curves]] = []
    words = "gauges and sensors  ·  a gap is a dry gauge"
    if "eta" in series:
        names = _places(series, "gauge", "{axis} = {value:g} m")
        chosen = np.unique(np.linspace(0, len(names) - 1, min(MOST, len(names))).round().astype(int))
        if len(chosen) < len(names):
            words += f"  ·  {len(chosen)} of {len(names)} gauges, the others are in series.nc"
        for g in chosen:
            rows.append((f"Level at {names[g]}", "m", {"": series["eta"].values[g]}))
    if "pressure" in series:
        names = _places(series, "sensor", "{value:g}")
        pressure, velocity = series["pressure"].values, series["velocity"].values
        rows.append(("Pressure", "kPa", {name: pressure[s] / 1e3 for s, name in enumerate(names)}))
        rows.append(("Darcy velocity along x", "m/s", {n: velocity[s, :, 0] for s, n in enumerate(names)}))
    right = 1.55 if any(len(curves) > 1 or "" not in curves for _, _, curves in rows) else 0.3  # for the names
    letters = ", ".join(axes(grid.dimension))
    with drawing.style():
        page = sheet(len(rows), 1, (6.4, 1.15), case.title, words, gap=(0, 0.5), margins=(LEFT, right, 0.5, 0.95))
        for i, (panel, (name, unit, curves)) in enumerate(zip(page.panels, rows, strict=True)):
            heights = _level_limits(curves[""]) if unit == "m" else None
            draw_curves(panel, series["time"].values, curves, unit, "t [s]" if i + 1 == len(rows) else "", heights)
            headings(panel, name, "" if unit == "m" else f"sensors at ({letters}) [m]")
        return page.save(path)


def draw_curves(
    panel: Axes, time: FloatArray, curves: Curves, unit: str, below: str, heights: tuple[float, float] | None = None
) -> None:
    """Draws curves named at their right ends, over a faint zero line; the axis has the unit, if need be times 10^n.

    below: label of the time axis; heights: limits of the panel, by default those of the curves.
    """
    finite = np.concatenate([values[np.isfinite(values)] for values in curves.values()])
    scale = _power_of_ten(float(np.abs(finite).max(initial=0.0)))
    last = time[-1] if time[-1] > time[0] else time[0] + 1.0
    panel.set(xlim=(time[0], last), ylim=heights or _limits(finite / 10.0**scale))
    drawing.scales(panel, True, True)
    panel.axhline(0, color=FAINT, lw=0.8, zorder=0)
    ends = []
    for (words, values), colour in zip(curves.items(), itertools.cycle(LINES), strict=False):
        panel.plot(time, values / 10.0**scale, color=colour, lw=1.2, clip_on=heights is not None)
        wet = values[np.isfinite(values)]
        if words and len(wet):
            ends.append((float(wet[-1]) / 10.0**scale, words, colour))
    label_ends(panel, ends)
    factor = "10" + str(scale).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")) if scale else ""
    words = f"[{' '.join(filter(None, (factor, unit)))}]" if factor or unit else ""
    label(panel, below, words, away=72 * (LEFT - 0.2))  # in line, however long the numbers are


def _limits(values: FloatArray) -> tuple[float, float]:
    """Limits of an axis around values, with some air; never so close that round-off looks like a wave."""
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    air = max(0.05 * (high - low), 1e-3 * max(abs(low), abs(high))) or 1.0
    return low - air, high + air


def _power_of_ten(largest: float) -> int:
    """Exponent that an axis is divided by: 0 where numbers read well, else the multiple of 3 that leaves 0.1 to 100."""
    return 0 if largest == 0 or 1e-2 <= largest < 1e4 else 3 * round((np.log10(largest) - 0.5) / 3)


def _energies(series: Data) -> Curves:
    """Change of kinetic, potential and total energy, work of makers, and (downwards) of drag, viscosity and sponges."""
    if "kinetic_energy" not in series or "potential_energy" not in series:
        return {}
    kinetic, potential = (series[f"{kind}_energy"].values for kind in ("kinetic", "potential"))
    kinetic, potential = kinetic - kinetic[0], potential - potential[0]
    lost = {"lost to drag": "drag_work", "lost to viscosity": "viscous_work", "lost to friction": "friction_work"}
    curves = {"kinetic": kinetic, "potential": potential, "sum": kinetic + potential}
    curves |= {words: -values for words, values in _named(series, lost).items()}
    if "source_work" in series and series["source_work"].values.any():
        curves |= {"from the maker": series["source_work"].values, "to the sponges": -series["sponge_work"].values}
    return curves


def _named(series: Data, names: dict[str, str]) -> Curves:
    return {words: series[name].values for words, name in names.items() if name in series}


def _places(series: Data, kind: str, form: str) -> list[str]:
    """The names of the gauges or sensors, each with its position; form: of one coordinate, from axis and value."""
    letters = [axis for axis in "xyz" if f"{kind}_{axis}" in series]
    numbers = np.stack([series[f"{kind}_{axis}"].values for axis in letters], axis=-1)
    places = [", ".join(form.format(axis=a, value=v) for a, v in zip(letters, point, strict=True)) for point in numbers]
    return [f"{name} ({place})" for name, place in zip(series[kind].values, places, strict=True)]


def _level_limits(eta: FloatArray) -> tuple[float, float] | None:
    """Limits close around the levels, but never so close that round-off looks like a wave. None when all is dry."""
    wet = eta[np.isfinite(eta)]
    if not len(wet):
        return None
    middle, half = 0.5 * (wet.max() + wet.min()), max(0.5 * (wet.max() - wet.min()), 1e-3)
    return float(middle - 1.15 * half), float(middle + 1.15 * half)
