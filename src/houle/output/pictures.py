"""The pictures of a run, to be shown around: surface, pressure, plan (3D); ledger and gauges are in curves.py."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from houle import laboratory
from houle.frame import Frame
from houle.grid import FloatArray, Grid
from houle.laboratory import Data
from houle.output import drawing
from houle.output.curves import gauges_picture, ledger_picture
from houle.output.drawing import LABORATORY, WATER, Key, Panel, sheet
from houle.output.section import Section, colour_bar, highest_pressure, length, title

MOST = 6  # panels of a sheet without laboratory times

__all__ = ["gauges_picture", "ledger_picture", "plan_picture", "pressure_picture", "surface_picture", "write_pictures"]


def write_pictures(
    directory: Path | str, case: Any, grid: Grid, series: Data, surface: Data, fields: Any
) -> list[Path]:
    """All pictures that the run has data for. fields: a FieldsReader; case: for bodies, gates and laboratory points."""
    folder = Path(directory)
    file = laboratory.path(case)
    points = laboratory.read(file) if file else None
    made = [surface_picture(folder / "surface.png", case, grid, surface, points)]
    made.append(pressure_picture(folder / "pressure.png", case, grid, fields, points))
    if grid.dimension == 3:
        made.append(plan_picture(folder / "plan.png", case, grid, surface))
    made.append(ledger_picture(folder / "ledger.png", case, grid, series))
    if "eta" in series or "pressure" in series:
        made.append(gauges_picture(folder / "gauges.png", case, grid, series))
    return made


def surface_picture(path: Path, case: Any, grid: Grid, surface: Data, points: laboratory.Points | None = None) -> Path:
    """The surface at the laboratory times with the points and their error, rms per panel; else at times of the run.

    In 3D the level is the mean over the wet columns across the width, as it is scored.
    """
    times = _times(surface["time"].values, points)
    score = laboratory.score(points, surface) if points else None
    rms = dict(zip(score.times, score.rms, strict=True)) if score else {}
    section = Section(case, grid, [np.nanmax(surface["eta"].values, initial=0.0), *(points.eta if points else [])])
    page = section.sheet(len(times), _surface_words(case, grid, points, score), below=0.22)
    for panel, time in zip(page.panels, times, strict=True):
        x, eta = _profile(surface, time, grid)
        section.draw_water(panel, x, eta)
        section.draw_outlines(panel, time)
        panel.line(x, eta, WATER, 1.5)
        panel.heading(f"t = {time:.4g} s", f"rms {1e3 * rms[time]:.1f} mm" if time in rms else "")
    page.frames("x [m]", "z [m]")
    for panel, time in zip(page.panels, times, strict=True):
        _laboratory(panel, points, time, case)
    page.legend([Key("computed", WATER), *_laboratory_key(points, case)])
    return page.save(path)


def pressure_picture(path: Path, case: Any, grid: Grid, fields: Any, points: laboratory.Points | None = None) -> Path:
    """Particles coloured by their pressure, at the size of the space they fill; in 3D those of the middle section."""
    frames = [fields.frame(fields.nearest(time)) for time in _times(fields.times, points)]
    section = Section(case, grid, [np.max(frame.position[:, -1], initial=0.0) for frame in frames])
    top = highest_pressure(frames)
    page = section.sheet(len(frames), _pressure_words(section, frames), below=0.45)
    for panel, frame in zip(page.panels, frames, strict=True):
        section.draw_particles(panel, frame, top)
        section.draw_outlines(panel, frame.time, dashed=True)
        panel.heading(f"t = {frame.time:.4g} s")
    page.frames("x [m]", "z [m]")
    for panel, frame in zip(page.panels, frames, strict=True):
        _laboratory(panel, points, frame.time, case)
    colour_bar(page, 0.0, top / 1e3, "pressure [kPa]")
    page.legend(_laboratory_key(points, case), above=0.28)
    return page.save(path)


def plan_picture(path: Path, case: Any, grid: Grid, surface: Data) -> Path:
    """Level of the free surface seen from above, in 3D."""
    available = surface["time"].values
    times = _times(available, None)
    along, across = grid.size[0], grid.size[1]
    columns = 1 if along / across > 5 else min(len(times), 2 if along / across > 1.8 else 3)
    width = {1: 7.5, 2: 4.2, 3: 3.1}[columns]
    low, high = float(np.nanmin(surface["eta"].values)), float(np.nanmax(surface["eta"].values))
    high = max(high, low + 1e-9)
    words = f"level of the free surface from above  ·  spacing {length(max(grid.spacing))}  ·  white: dry"
    size = (width, width * across / along)
    page = sheet(len(times), columns, size, title(case), words, margins=(0.62, 0.3, 0.95, 0.95))
    for panel, time in zip(page.panels, times, strict=True):
        panel.limits((0.0, along), (0.0, across))
        _paint(panel, surface["eta"].values[np.argmin(np.abs(available - time))], low, high)
        panel.heading(f"t = {time:.4g} s")
    page.frames("x [m]", "y [m]")
    colour_bar(page, low, high, "level above z = 0 [m]")
    return page.save(path)


def _paint(panel: Panel, eta: FloatArray, low: float, high: float) -> None:
    """Cells (ny, nx) of a plan that fills the panel, coloured by their value; white where it is NaN."""
    x0, y0, x1, y1 = panel.box
    column = (np.arange(x1 - x0) + 0.5) / (x1 - x0) * eta.shape[1]
    row = (np.arange(y1 - y0)[::-1] + 0.5) / (y1 - y0) * eta.shape[0]
    values = eta[np.ix_(row.astype(int), column.astype(int))]
    table = drawing.pressures()
    colours = table[np.rint((np.nan_to_num(values, nan=low) - low) / (high - low) * (len(table) - 1)).astype(int)]
    panel.canvas.blend(np.isfinite(values), x0, y0, colours)


def _laboratory(panel: Panel, points: laboratory.Points | None, time: float, case: Any) -> None:
    """The measured points of a time, open circles with the error of the measurement."""
    if points is None or not (here := np.abs(points.time - time) < laboratory.SAME).any():
        return
    x, eta, error = points.x[here], points.eta[here], case.reference.error or 0.0
    bars = np.stack([eta - error, eta + error, np.full(len(eta), np.nan)], axis=-1)
    panel.line(np.repeat(x, 3), bars.ravel(), LABORATORY, 0.7)
    panel.canvas.rings(panel.place(x, eta), 1.4, LABORATORY, 0.9, panel.canvas.box)


def _laboratory_key(points: laboratory.Points | None, case: Any) -> list[Key]:
    return [] if points is None else [Key(case.reference.label, LABORATORY, ring=True)]


def _surface_words(case: Any, grid: Grid, points: laboratory.Points | None, score: laboratory.Score | None) -> str:
    words = [f"free surface, spacing {length(max(grid.spacing))}"]
    if points and case.reference.error:
        words.append(f"points measured to ±{1e3 * case.reference.error:g} mm")
    if score:
        words.append(f"rms of all points {1e3 * score.overall:.1f} mm")
    return "  ·  ".join(words)


def _pressure_words(section: Section, frames: Sequence[Frame]) -> str:
    particles = f"{max(len(frame.volume) for frame in frames):,}".replace(",", " ")
    words = f"pressure of the particles  ·  spacing {length(max(section.grid.spacing))}  ·  {particles} particles"
    return words + (f"  ·  section at y = {section.y:.3g} m" if section.grid.dimension == 3 else "")


def _profile(surface: Data, time: float, grid: Grid) -> tuple[FloatArray, FloatArray]:
    """x and level, linear in time, carried to the walls; NaN where dry stays a gap."""
    x = np.concatenate([[0.0], grid.axis_points(0), [grid.size[0]]])
    stored, eta = surface["time"].values, surface["eta"].values
    after = int(np.clip(np.searchsorted(stored, time), 0, len(stored) - 1))
    level = laboratory.along(eta[after])
    if after > 0 and time < stored[after]:
        weight = (time - stored[after - 1]) / (stored[after] - stored[after - 1])
        level = (1.0 - weight) * laboratory.along(eta[after - 1]) + weight * level
    return x, np.concatenate([level[:1], level, level[-1:]])


def _times(available: FloatArray, points: laboratory.Points | None) -> list[float]:
    """The laboratory times that the run has reached, or some of its own, evenly spread."""
    reached = [t for t in points.times if t <= available[-1] + laboratory.SAME] if points else []
    if reached:
        start = available[0] < reached[0] and len(reached) in (3, 5)  # the start fills the sheet
        return [float(available[0]), *reached] if start else reached
    chosen = np.unique(np.linspace(0, len(available) - 1, min(MOST, len(available))).round().astype(int))
    return [float(available[i]) for i in chosen]
