"""The pictures of a run: surface, pressure, plan (3D); those of ledger and gauges are in curves.py."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D

from houle.case.model import Case
from houle.data import laboratory
from houle.data.laboratory import Data
from houle.flow.snapshot import Snapshot
from houle.grid import FloatArray, Grid
from houle.output import drawing
from houle.output.curves import gauges_picture, ledger_picture
from houle.output.drawing import LABORATORY, SHADE, WATER, colour_bar, headings, sheet
from houle.output.fields import FieldsReader
from houle.output.pressure import BAR, pressure_scale
from houle.output.section import SectionPicture, length

MOST = 6  # panels of a sheet without laboratory times

__all__ = ["gauges_picture", "ledger_picture", "plan_picture", "pressure_picture", "surface_picture", "write_pictures"]


def write_pictures(
    directory: Path | str, case: Case, grid: Grid, series: Data, surface: Data, fields: FieldsReader
) -> list[Path]:
    """Writes all pictures that the run has data for, and returns their paths."""
    folder = Path(directory)
    file = case.laboratory
    points = laboratory.read(file) if file else None
    made = [surface_picture(folder / "surface.png", case, grid, surface, points)]
    made.append(pressure_picture(folder / "pressure.png", case, fields, points))
    if grid.dimension == 3:
        made.append(plan_picture(folder / "plan.png", case, grid, surface))
    made.append(ledger_picture(folder / "ledger.png", case, grid, series))
    if "eta" in series or "pressure" in series:
        made.append(gauges_picture(folder / "gauges.png", case, grid, series))
    return made


def surface_picture(path: Path, case: Case, grid: Grid, surface: Data, points: laboratory.Points | None = None) -> Path:
    """The surface at the laboratory times, with the points and the rms error of each panel; else at times of the run.

    In 3D the level is the mean over the wet columns across the width, as it is scored.
    """
    times = _times(surface["time"].values, points)
    score = laboratory.score(points, surface) if points else None
    rms = dict(zip(score.times, score.rms, strict=True)) if score else {}
    section = SectionPicture(case, [np.nanmax(surface["eta"].values, initial=0.0), *(points.eta if points else [])])
    if points is None:
        section.look_close(surface["eta"].values)
    with drawing.style():
        computed = Line2D([], [], color=WATER, lw=1.5, label="computed")
        key = [computed, *_laboratory_key(points, case)]
        page = section.sheet(len(times), _surface_words(case, grid, points, score), key)
        for number, (panel, time) in enumerate(zip(page.panels, times, strict=True)):
            x, eta = _profile(surface, time, grid)
            section.draw(panel, time, wet=x[~np.isnan(eta)])
            panel.fill_between(x, 0, eta, color=SHADE, lw=0, zorder=0.55)
            panel.plot(x, eta, color=WATER, lw=1.5, zorder=3)
            _laboratory(panel, points, time, case)
            error = f"rms {1e3 * rms[time]:.1f} mm" if time in rms else ""
            headings(panel, f"t = {time:.4g} s", error, raised=section.raised(page, number))
        page.label_outside("x [m]", "z [m]")
        section.name(page)
        return page.save(path)


def pressure_picture(path: Path, case: Case, fields: FieldsReader, points: laboratory.Points | None = None) -> Path:
    """Particles coloured by their pressure, at the size of the space they fill; in 3D those of the middle section."""
    frames = [fields.frame(fields.nearest(time)) for time in _times(fields.times, points)]
    section = SectionPicture(case, [np.max(frame.position[:, -1], initial=0.0) for frame in frames])
    scale = pressure_scale(frames)
    with drawing.style():
        key = _laboratory_key(points, case)
        page = section.sheet(len(frames), _pressure_words(section, frames), key, below=BAR)
        for number, (panel, frame) in enumerate(zip(page.panels, frames, strict=True)):
            section.draw(panel, frame.time, over=True, wet=frame.position[:, 0])
            marks = section.draw_particles(panel, frame, scale)
            _laboratory(panel, points, frame.time, case)
            headings(panel, f"t = {frame.time:.4g} s", raised=section.raised(page, number))
        page.label_outside("x [m]", "z [m]")
        colour_bar(page, marks, "pressure [kPa]", above=section.key_top)
        section.name(page)
        return page.save(path)


def plan_picture(path: Path, case: Case, grid: Grid, surface: Data) -> Path:
    """Level of the free surface seen from above, in 3D."""
    available = surface["time"].values
    times = _times(available, None)
    along, across = grid.size[0], grid.size[1]
    columns = 1 if along / across > 5 else min(len(times), 2 if along / across > 1.8 else 3)
    width = {1: 7.5, 2: 4.2, 3: 3.1}[columns]
    scale = Normalize(float(np.nanmin(surface["eta"].values)), float(np.nanmax(surface["eta"].values)))
    with drawing.style():
        words = f"level of the free surface from above  ·  spacing {length(max(grid.spacing))}  ·  white: dry"
        size = (width, width * across / along)
        page = sheet(len(times), columns, size, case.title, words, margins=(0.62, 0.3, 0.95, 0.95))
        look: Any = {"origin": "lower", "extent": (0.0, along, 0.0, across), "aspect": "auto"}
        look |= {"interpolation": "nearest", "cmap": drawing.pressures(), "norm": scale}
        for panel, time in zip(page.panels, times, strict=True):
            mesh = panel.imshow(surface["eta"].values[np.argmin(np.abs(available - time))], **look)
            headings(panel, f"t = {time:.4g} s")
        page.label_outside("x [m]", "y [m]")
        colour_bar(page, mesh, "level above z = 0 [m]")
        return page.save(path)


def _laboratory(panel: Axes, points: laboratory.Points | None, time: float, case: Case) -> None:
    """Draws the measured points of a time: open circles with the error of the measurement."""
    if points is None or not (here := np.abs(points.time - time) < laboratory.SAME).any():
        return
    error = (case.reference.error if case.reference else None) or 0.0
    x, eta = points.x[here], points.eta[here]
    panel.vlines(x, eta - error, eta + error, color=LABORATORY, lw=0.7, zorder=4.5)
    panel.plot(x, eta, "o", color=LABORATORY, ms=2.8, mfc="white", mew=0.9, zorder=4.5)


def _laboratory_key(points: laboratory.Points | None, case: Case) -> list[Line2D]:
    if points is None or case.reference is None:
        return []
    marks: dict[str, Any] = {"marker": "o", "ls": "none", "ms": 3.6, "mfc": "white", "mew": 0.9}
    return [Line2D([], [], color=LABORATORY, label=case.reference.label, **marks)]


def _surface_words(case: Case, grid: Grid, points: laboratory.Points | None, score: laboratory.Score | None) -> str:
    words = [f"free surface, spacing {length(max(grid.spacing))}"]
    if points and case.reference is not None and case.reference.error:
        words.append(f"points measured to ±{1e3 * case.reference.error:g} mm")
    if score:
        words.append(f"rms of all points {1e3 * score.overall:.1f} mm")
    return "  ·  ".join(words)


def _pressure_words(section: SectionPicture, frames: Sequence[Snapshot]) -> str:
    particles = f"{max(len(frame.volume) for frame in frames):,}".replace(",", " ")
    words = f"pressure of the particles  ·  spacing {length(max(section.grid.spacing))}  ·  {particles} particles"
    return words + (f"  ·  section at y = {section.y:.3g} m" if section.grid.dimension == 3 else "")


def _profile(surface: Data, time: float, grid: Grid) -> tuple[FloatArray, FloatArray]:
    """x (N,) and level (N,) [m] of the surface, linear in time and carried on to the walls; NaN where dry."""
    x = np.concatenate([[0.0], grid.axis_points(0), [grid.size[0]]])
    stored, eta = surface["time"].values, surface["eta"].values
    after = int(np.clip(np.searchsorted(stored, time), 0, len(stored) - 1))
    level = laboratory.along(eta[after])
    if after > 0 and time < stored[after]:
        weight = (time - stored[after - 1]) / (stored[after] - stored[after - 1])
        level = (1.0 - weight) * laboratory.along(eta[after - 1]) + weight * level
    return x, np.concatenate([level[:1], level, level[-1:]])


def _times(available: FloatArray, points: laboratory.Points | None) -> list[float]:
    """The laboratory times [s] that the run has reached; if there are none, some of its own, evenly spread."""
    reached = [t for t in points.times if t <= available[-1] + laboratory.SAME] if points else []
    if reached:
        start = available[0] < reached[0] and len(reached) in (3, 5)  # the start fills the sheet
        return [float(available[0]), *reached] if start else reached
    wanted = np.linspace(available[0], available[-1], min(MOST, len(available)))
    chosen = np.unique([np.argmin(np.abs(available - t)) for t in wanted])
    if len(chosen) > 2 and available[chosen[-1]] - available[chosen[-2]] < 0.5 * (wanted[1] - wanted[0]):
        chosen = np.delete(chosen, -2)  # the end of a run, just after the frame before it
    return [float(available[i]) for i in chosen]
