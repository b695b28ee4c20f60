"""The pictures of a run, to be shown around: surface, pressure, plan (3D); ledger and gauges are in curves.py."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D

from houle import laboratory
from houle.frame import Frame
from houle.grid import FloatArray, Grid
from houle.output import drawing
from houle.output.curves import gauges_picture, ledger_picture
from houle.output.drawing import LABORATORY, SHADE, WATER, Sheet, headings, sheet

DRAWN = 40000  # particles in a panel; of more, every k-th is drawn, larger
MOST = 6  # panels of a sheet without laboratory times


def write_pictures(
    directory: Path | str, case: Any, grid: Grid, series: xr.Dataset, surface: xr.Dataset, fields: Any
) -> list[Path]:
    """All pictures that the run has data for. fields: FieldsReader; case: the case file, for bodies, gates, laboratory."""
    folder = Path(directory)
    file = laboratory.path(case)
    points = laboratory.read(file) if file else None
    made = [surface_picture(folder / "surface.png", case, grid, surface, points)]
    made.append(pressure_picture(folder / "pressure.png", case, grid, fields, points))
    if grid.dimension == 3:
        made.append(plan_picture(folder / "plan.png", case, grid, surface))
    made.append(ledger_picture(folder / "ledger.png", case, grid, series))
    if series.sizes.get("gauge", 0) or series.sizes.get("sensor", 0):
        made.append(gauges_picture(folder / "gauges.png", case, grid, series))
    return made


# ---- the free surface


def surface_picture(
    path: Path, case: Any, grid: Grid, surface: xr.Dataset, points: laboratory.Points | None = None
) -> Path:
    """The surface at the laboratory times with the points and their error, rms per panel; else at times of the run.

    In 3D the level is the mean over the wet columns across the width, as it is scored.
    """
    times = _times(surface.time.values, points)
    score = laboratory.score(points, surface) if points else None
    porous, solid = drawing.bodies(case.porous, grid, _middle(grid)), drawing.bodies(case.solid, grid, _middle(grid))
    high = _height(
        grid, [np.nanmax(surface.eta.values, initial=0.0), *(points.eta if points else [])], [*porous, *solid]
    )
    with drawing.style():
        page = _section_sheet(case, grid, len(times), high, _surface_words(case, grid, points, score), below=0.22)
        for panel, time in zip(page.panels, times, strict=True):
            _section(panel, grid, high)
            drawing.draw_bodies(panel, porous, solid)
            drawing.draw_gates(panel, case.gate, time, high)
            x, eta = _profile(surface, time, grid)
            panel.fill_between(x, 0, eta, color=SHADE, lw=0, zorder=0.55)
            (line,) = panel.plot(x, eta, color=WATER, lw=1.5, zorder=3, label="computed")
            rms = score.rms[score.times.index(time)] if score and time in score.times else None
            _laboratory(panel, points, time, case.reference)
            headings(panel, f"t = {time:.4g} s", f"rms {1e3 * rms:.1f} mm" if rms is not None else "")
        page.label_outside("x [m]", "z [m]")
        page.legend([line, *_laboratory_key(points, case)])
        return page.save(path)


def _surface_words(case: Any, grid: Grid, points: laboratory.Points | None, score: laboratory.Score | None) -> str:
    words = [f"free surface, spacing {_length(max(grid.spacing))}"]
    if points:
        words.append(
            "points measured" + (f" to $\\pm${1e3 * case.reference.error:g} mm" if case.reference.error else "")
        )
    if score:
        words.append(f"rms of all points {1e3 * score.overall:.1f} mm")
    return "  ·  ".join(words)


def _laboratory(panel: Axes, points: laboratory.Points | None, time: float, reference: Any) -> None:
    """The measured points of a time, open circles with the error of the measurement."""
    if points is None or not (here := points.time == time).any():
        return
    look: dict[str, Any] = {
        "ms": 2.8,
        "mfc": "white",
        "mew": 0.9,
        "ecolor": LABORATORY,
        "elinewidth": 0.7,
        "color": LABORATORY,
    }
    panel.errorbar(
        points.x[here],
        points.eta[here],
        yerr=reference.error,
        fmt="o",
        ls="none",
        zorder=3.5,
        **look,
    )


def _laboratory_key(points: laboratory.Points | None, case: Any) -> list[Line2D]:
    if points is None:
        return []
    return [
        Line2D(
            [], [], marker="o", ls="none", ms=3.6, mfc="white", mew=0.9, color=LABORATORY, label=case.reference.label
        )
    ]


# ---- the pressure


def pressure_picture(path: Path, case: Any, grid: Grid, fields: Any, points: laboratory.Points | None = None) -> Path:
    """Particles coloured by their pressure, at the size of the space they fill; in 3D those of the middle section."""
    frames = [fields.frame(fields.nearest(time)) for time in _times(fields.times, points)]
    porous, solid = drawing.bodies(case.porous, grid, _middle(grid)), drawing.bodies(case.solid, grid, _middle(grid))
    tops = [np.max(frame.position[:, -1], initial=0.0) for frame in frames]
    high = _height(grid, tops, [*porous, *solid])
    with drawing.style():
        page = _section_sheet(case, grid, len(frames), high, _pressure_words(grid, frames), below=0.45)
        scale = Normalize(0.0, max(1e-3, *(np.quantile(f.pressure, 0.999) / 1e3 for f in frames if len(f.pressure))))
        for panel, frame in zip(page.panels, frames, strict=True):
            _section(panel, grid, high)
            drawing.draw_bodies(panel, porous, solid, over=True)
            drawing.draw_gates(panel, case.gate, frame.time, high)
            marks = draw_particles(panel, frame, grid, scale)
            _laboratory(panel, points, _same(points, frame.time), case.reference)
            headings(panel, f"t = {frame.time:.4g} s")
        page.label_outside("x [m]", "z [m]")
        colour_bar(page, marks, "pressure [kPa]")
        page.legend(_laboratory_key(points, case))
        return page.save(path)


def draw_particles(panel: Axes, frame: Frame, grid: Grid, scale: Normalize) -> EllipseCollection:
    """Discs of the bulk size of the particles, so that the water fills the picture."""
    chosen = np.arange(len(frame.volume))
    if grid.dimension == 3:
        chosen = np.flatnonzero(np.abs(frame.position[:, 1] - _middle(grid)) <= 0.5 * grid.spacing[1])
    thin = -(-len(chosen) // DRAWN) or 1
    chosen = chosen[::thin]
    size = 1.42 * (frame.volume[chosen] / frame.porosity[chosen]) ** (1 / grid.dimension) * np.sqrt(thin)
    marks = EllipseCollection(
        size,
        size,
        np.zeros(len(chosen)),
        units="xy",
        offsets=frame.position[chosen][:, [0, -1]],
        transOffset=panel.transData,
        cmap=drawing.pressures(),
        norm=scale,
        linewidths=0,
        zorder=2,
    )
    marks.set_array(frame.pressure[chosen] / 1e3)
    panel.add_collection(marks)
    return marks


def colour_bar(page: Sheet, marks: Any, words: str) -> None:
    """A slim bar under the panels."""
    width, height = page.figure.get_size_inches()
    first = page.panels[0].get_position()
    box = page.figure.add_axes((first.x0, 0.32 / height, min(3.2 / width, 0.4), 0.09 / height))
    bar = page.figure.colorbar(marks, cax=box, orientation="horizontal", extend="neither")
    bar.outline.set_visible(False)
    bar.ax.tick_params(length=2, labelsize=8)
    bar.ax.text(1.03, 0.5, words, transform=bar.ax.transAxes, va="center", fontsize=8.5)


def _pressure_words(grid: Grid, frames: Sequence[Frame]) -> str:
    words = ["particles and their pressure", f"spacing {_length(max(grid.spacing))}"]
    words.append(f"{max(len(frame.volume) for frame in frames):,} particles".replace(",", " "))
    if grid.dimension == 3:
        words.append(f"section at y = {_middle(grid):.3g} m")
    return "  ·  ".join(words)


# ---- the plan, in 3D


def plan_picture(path: Path, case: Any, grid: Grid, surface: xr.Dataset) -> Path:
    """Level of the free surface seen from above."""
    times = _times(surface.time.values, None)
    length, width = grid.size[0], grid.size[1]
    scale = Normalize(float(np.nanmin(surface.eta)), float(np.nanmax(surface.eta)))
    with drawing.style():
        columns = 1 if length / width > 2.5 else min(3, len(times))
        across = min(9.0, 8.6 if columns == 1 else 9.0 / columns)
        words = f"level of the free surface from above  ·  spacing {_length(max(grid.spacing))}  ·  white: dry"
        margins = (0.62, 0.25, 0.95, 0.95)
        page = sheet(
            len(times),
            columns,
            (across, across * width / length),
            case.case.title or case.case.name,
            words,
            margins=margins,
        )
        for panel, time in zip(page.panels, times, strict=True):
            eta = surface.eta.sel(time=time, method="nearest").values
            mesh = panel.pcolormesh(
                grid.axis_points(0, True), grid.axis_points(1, True), eta, cmap=drawing.pressures(), norm=scale
            )
            panel.set(xlim=(0, length), ylim=(0, width), aspect="equal")
            headings(panel, f"t = {time:.4g} s")
        page.label_outside("x [m]", "y [m]")
        colour_bar(page, mesh, "level above z = 0 [m]")
        return page.save(path)


# ---- the section


def _section_sheet(case: Any, grid: Grid, count: int, high: float, words: str, below: float = 0.0) -> Sheet:
    """Panels to scale where the section allows it; a long flume is stretched upwards, one panel under the other."""
    ratio = grid.size[0] / high
    columns = 1 if ratio > 4 else min(count, 2 if count in (2, 4) else 3)
    across = {1: 7.5, 2: 4.2, 3: 3.1}[columns]
    size = (across, across / min(ratio, 5.5))
    margins = (0.62, 0.3, 0.5 + below, 0.95)
    return sheet(count, columns, size, case.case.title or case.case.name, words, margins=margins)


def _section(panel: Axes, grid: Grid, high: float) -> None:
    panel.set(xlim=(0, grid.size[0]), ylim=(0, high))
    panel.spines["right"].set_visible(True)
    panel.locator_params(nbins=5)


def _height(grid: Grid, levels: Sequence[float], shapes: Sequence[drawing.Body]) -> float:
    """Of the section shown [m]: all water, points and bodies, and some air with room for the words."""
    wanted = max([*(float(v) for v in levels), *(float(b.outline[:, 1].max()) for b in shapes)])
    return min(grid.size[-1], 1.15 * wanted) if wanted > 0 else grid.size[-1]


def _profile(surface: xr.Dataset, time: float, grid: Grid) -> tuple[FloatArray, FloatArray]:
    """x and level, carried to the walls; NaN where dry stays a gap."""
    x = np.concatenate([[0.0], grid.axis_points(0), [grid.size[0]]])
    near = surface.eta.interp(time=np.clip(time, surface.time.values[0], surface.time.values[-1]))
    eta = near.mean("y").values if "y" in near.dims else near.values
    return x, np.concatenate([eta[:1], eta, eta[-1:]])


def _times(available: FloatArray, points: laboratory.Points | None) -> list[float]:
    """The laboratory times that the run has reached, or some of its own, evenly spread."""
    if points:
        reached = [t for t in points.times if t <= available[-1] + laboratory.SAME]
        if reached:
            start = available[0] < reached[0] and len(reached) in (3, 5)  # fills the sheet
            return [float(available[0]), *reached] if start else reached
    chosen = np.unique(np.linspace(0, len(available) - 1, min(MOST, len(available))).round().astype(int))
    return [float(available[i]) for i in chosen]


def _same(points: laboratory.Points | None, time: float) -> float:
    """The laboratory time equal to this one to round-off, else this one."""
    times = points.times if points else []
    return next((t for t in times if abs(t - time) < laboratory.SAME), time)


def _middle(grid: Grid) -> float:
    """y of the cells in the middle section of a 3D domain [m]; 0 in 2D."""
    return float(grid.axis_points(1)[grid.shape[1] // 2]) if grid.dimension == 3 else 0.0


def _length(value: float) -> str:
    """Two digits where they are nearly right: the grid changes the spacing a little to fill the domain."""
    short = float(f"{value:.2g}")
    value = short if abs(short / value - 1) < 0.005 else value
    return f"{1e3 * value:.3g} mm" if value < 0.1 else f"{value:.3g} m"


__all__ = ["gauges_picture", "ledger_picture", "plan_picture", "pressure_picture", "surface_picture", "write_pictures"]
