"""The figures of the page: dam breaks with both schemes, u_x under waves, and the coefficients."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from houle.case.section import CrossSection
from houle.data import laboratory
from houle.grid import FloatArray, Grid
from houle.output import drawing
from houle.output.drawing import GREY, INK, LABORATORY, LINES, WATER, colour_bar, headings, label, sheet
from houle.output.pressure import pressure_scale
from houle.output.section import SectionPicture, length
from houle.reproduction.measured import INSTANTS, Found, Pair, Printed, Reading, WaveRun
from houle.results.run import Run

OURS, PAPERS = WATER, LABORATORY
SCHEMES = {"houle": OURS, "jh2020": PAPERS}
DIVERGING = "RdBu_r"
HEIGHT = 0.36  # height shown in the panels of the waves [m]
PANEL = (7.4, 1.2)  # size of a panel [inches]


def pressures(path: Path, pair: Pair, words: str) -> Path:
    """Pressure of the particles at the paper's instants, the two schemes one above the other."""
    runs = {"houle": pair.ours, "jh2020": pair.papers}
    frames = [[run.fields.frame(run.fields.nearest(t)) for t in INSTANTS] for run in runs.values()]
    grid = _grid(pair.ours)
    section = SectionPicture(pair.ours.case, [float(f.position[:, -1].max()) for row in frames for f in row])
    section.height = min(section.height, 0.42)
    scale = pressure_scale(f for row in frames for f in row)
    with drawing.style():
        size = (3.1, 3.1 * section.height / grid.size[0])
        page = sheet(6, 3, size, words, _pressure_words(pair), margins=(0.62, 0.3, 0.95, 0.95))
        for row, (scheme, run) in enumerate(runs.items()):
            for column, time in enumerate(INSTANTS):
                panel, frame = page.panels[3 * row + column], frames[row][column]
                section.draw(panel, time, over=True)
                marks = section.draw_particles(panel, frame, scale)
                panel.plot(grid.axis_points(0), frame.eta, color=INK, lw=0.9, zorder=3)
                gained = f"water {100 * pair.gain(run, time):+.1f} %" if scheme == "jh2020" else ""
                headings(panel, f"{scheme}, t = {time:g} s", gained)
        page.label_outside("x [m]", "z [m]")
        colour_bar(page, marks, "pressure [kPa]")
        page.legend([Line2D([], [], color=INK, lw=0.9, label="free surface")], above=0.28)
        return page.save(path)


def _pressure_words(pair: Pair) -> str:
    return f"pressure of the particles, above with houle's scheme, below with the paper's  ·  {_spacing(pair.ours)}"


def profiles(path: Path, pair: Pair, words: str) -> Path:
    """The surface of both schemes at the instants of the laboratory, with its points."""
    file = pair.ours.case.laboratory
    assert file is not None
    points, scores, grid = laboratory.read(file), pair.scores(), _grid(pair.ours)
    times = [row for row in scores if row[0] > 0][:6]
    section = SectionPicture(pair.ours.case, [float(points.eta.max())])
    error = pair.ours.case.reference.error if pair.ours.case.reference else None
    with drawing.style():
        size = (3.1, 3.1 * section.height / grid.size[0])
        measured = f"  ·  measured to ±{1e3 * error:g} mm" if error else ""
        sub = f"free surface  ·  {_spacing(pair.ours)}{measured}  ·  rms of houle, of jh2020"
        page = sheet(len(times), 3, size, words, sub, margins=(0.62, 0.3, 0.8, 0.95))
        for panel, (time, one, other) in zip(page.panels, times, strict=True):
            section.draw(panel, time)
            for run, colour in ((pair.ours, OURS), (pair.papers, PAPERS)):
                x = run.surface.x.values
                panel.plot(x, laboratory.level(run.surface, time, x), color=colour, lw=1.3, zorder=3)
            here = np.abs(points.time - time) < laboratory.SAME
            panel.plot(points.x[here], points.eta[here], "o", color=INK, ms=2.6, mfc="white", mew=0.7, zorder=4)
            headings(panel, f"t = {time:.4g} s", f"rms {1e3 * one:.1f}, {1e3 * other:.1f} mm")
        page.label_outside("x [m]", "z [m]")
        circle: dict[str, Any] = {"marker": "o", "ls": "none", "ms": 3.4, "mfc": "white", "mew": 0.8}
        page.legend(
            [
                Line2D([], [], color=OURS, label="houle"),
                Line2D([], [], color=PAPERS, label="jh2020"),
                Line2D([], [], color=INK, label=pair.ours.case.reference.label if pair.ours.case.reference else "",
                       **circle),
            ]
        )  # fmt: skip
        return page.save(path)


def offsets(path: Path, pairs: Sequence[Pair]) -> Path:
    """Volume and mean level of the paper's scheme against time: the defect the paper admits."""
    with drawing.style():
        title = "The paper's scheme gains water at every remeshing"
        page = sheet(2, 2, (3.4, 2.1), title, "scheme jh2020; dotted: the same with houle's scheme",
                     gap=(0.85, 0.4), margins=(0.62, 1.0, 0.6, 0.95))  # fmt: skip
        volume, level = page.panels
        ends: tuple[list[Any], list[Any]] = ([], [])
        for pair, colour in zip(pairs, LINES, strict=False):
            drift = pair.papers.series.volume_drift
            volume.plot(drift.time, 100 * drift.values, color=colour)
            ours = pair.ours.series.volume_drift
            volume.plot(ours.time, 100 * ours.values, color=colour, ls=":", lw=1.8)
            times = pair.papers.surface.time.values
            lifted = [1e3 * pair.offset(float(t)) for t in times]
            level.plot(times, lifted, color=colour)
            ends[0].append((100 * float(drift.values[-1]), pair.name, colour))
            ends[1].append((lifted[-1], pair.name, colour))
        level.axhline(0.0, color=GREY, lw=1.6, ls=":")
        headings(volume, "Water more than at the start [%]")
        headings(level, "Mean level above that of houle [mm]")
        for panel, found in zip(page.panels, ends, strict=True):
            panel.set_xlim(0, None)
            label(panel, "t [s]", "")
            drawing.scales(panel, True, True)
            drawing.label_ends(panel, found)
        return page.save(path)


def velocities(path: Path, wave: WaveRun, row: Printed, largest: float) -> Path:
    """u_x at the two instants of the paper's figure and once more when waves are steady, with points A, B, C."""
    times = [*row.instants, _steady(wave)]
    words = f"Waves on a porous block: {row.slope}° face, H₀ = {1e3 * row.height:.0f} mm"
    reach = (0.0, float(wave.run.case.domain.size[0]) - wave.origin)
    stretched = PANEL[1] / HEIGHT / (PANEL[0] / reach[1])
    sub = (
        f"horizontal Darcy velocity, as in figure {row.figure} of the paper  ·  {_spacing(wave.run)}  ·  heights "
        f"stretched {stretched:.2g} times"
    )
    heads = [
        (f"t = {times[0]:.4g} s", f"printed {row.top:.2f} s, read as tens of seconds"),
        (f"t = {times[1]:.4g} s", f"printed {row.bottom:.2f} s; A, B, C as in the paper's table 1"),
        (f"t = {times[2]:.4g} s", "waves steady, highest level at the face"),
    ]
    with drawing.style():
        page = sheet(3, 1, PANEL, words, sub, gap=(0.3, 0.4), margins=(0.62, 0.3, 0.95, 0.95))
        for i, (panel, time, (left, right)) in enumerate(zip(page.panels, times, heads, strict=True)):
            image = _field(panel, wave, time, largest)
            if i == 1:
                _points(panel, wave, wave.read(time))
            headings(panel, left, right)
            panel.set(xlim=reach, ylim=(0, HEIGHT))
        page.label_outside("x from the source [m]", "z [m]")
        colour_bar(page, image, "$u_x$ [m/s]", mathematics=True)
        return page.save(path)


def _steady(wave: WaveRun) -> float:
    """The frame with the highest level at the face, in the first period of the window [s]."""
    surface, start = wave.run.surface, wave.entry["window"]["start"]
    inside = np.flatnonzero((surface.time.values >= start) & (surface.time.values < start + wave.entry["period"]))
    column = int(np.argmin(np.abs(surface.x.values - wave.face)))
    return float(surface.time.values[inside[np.argmax(surface.eta.values[inside, column])]])


def speed(wave: WaveRun) -> float:
    """The largest |u_x| at the wet cells of the frames of the last period [m/s], a few outliers left out."""
    reader, period = wave.run.fields, wave.entry["period"]
    found = []
    for i in np.flatnonzero(reader.times >= reader.times[-1] - period):
        frame = reader.frame(int(i))
        found.append(np.quantile(np.abs(frame.cell_velocity[..., 0])[frame.cell_fill > 0.5], 0.998))
    return float(max(found))


def _field(panel: Axes, wave: WaveRun, time: float, largest: float) -> Any:
    """u_x as an image that ends at the free surface; body, still water and surface over it."""
    frame, grid = wave.run.fields.frame(wave.run.fields.nearest(time)), _grid(wave.run)
    x, shift = grid.axis_points(0), wave.origin
    u = _up_to_the_surface(frame.cell_velocity[..., 0], frame.cell_fill)
    extent = (-shift, grid.size[0] - shift, 0.0, grid.size[1])
    body = CrossSection(wave.run.case).porous[0].shape.section((0.0, 0.0, grid.size[0], grid.size[-1]))
    outline = shapely.get_coordinates(body) - [shift, 0.0]
    panel.add_patch(Polygon(outline, fc="#faf8f3", ec="#d5ccb8", hatch="////", lw=0, zorder=0.5))
    scale = Normalize(-largest, largest)
    look: Any = {"origin": "lower", "aspect": "auto", "interpolation": "bilinear", "zorder": 1}
    image = panel.imshow(u.T, cmap=matplotlib.colormaps[DIVERGING], norm=scale, extent=extent, **look)
    level = np.nan_to_num(frame.eta)
    edge = np.concatenate([[[-shift, 0.0]], np.stack([x - shift, level], 1), [[grid.size[0] - shift, level[-1]]],
                           [[grid.size[0] - shift, 0.0]]])  # fmt: skip
    image.set_clip_path(Polygon(edge, transform=panel.transData))
    panel.axhline(wave.depth, color=GREY, lw=0.5, ls=(0, (8, 5)), zorder=2)
    panel.plot(x - shift, frame.eta, color=INK, lw=0.9, zorder=3)
    panel.add_patch(Polygon(outline, fc="none", ec="#4b4436", lw=1.0, ls=(0, (4, 2)), zorder=4))
    panel.spines["right"].set_visible(True)
    return image


def _up_to_the_surface(u: FloatArray, fill: FloatArray) -> FloatArray:
    """Values (nx, nz), that of the highest full cell of each column carried upwards into partly filled ones."""
    wet = fill > 0.5
    top = np.where(wet.any(axis=1), wet.shape[1] - 1 - np.argmax(wet[:, ::-1], axis=1), 0)
    rows = np.minimum(np.arange(u.shape[1])[None, :], top[:, None])
    return np.take_along_axis(u, rows, axis=1)


def _points(panel: Axes, wave: WaveRun, found: Reading) -> None:
    ground = {"fc": "white", "ec": "none", "alpha": 0.8, "pad": 0.6}
    for name, (x, level) in (("A", found.A), ("B", found.B), ("C", found.C)):
        panel.plot(x - wave.origin, level, "o", color=INK, ms=3.5, mfc="white", mew=0.9, zorder=5)
        look: Any = {"textcoords": "offset points", "ha": "center", "fontweight": "bold", "bbox": ground, "zorder": 6}
        panel.annotate(f"{name} {level:.3f} m", (x - wave.origin, level), (0, 8), fontsize=drawing.SMALL, **look)


def coefficients(path: Path, found: Found, flume: int, curves: dict[float, list[tuple[float, float]]]) -> Path:
    """C_R of the rows of the table, and against period and grains, by formula, by separation and by theory."""
    with drawing.style():
        title = "C_R by the paper's formula and by separation of the waves"
        page = sheet(2, 2, (3.5, 2.6), title, "bars: 95 % intervals; theory: linear, Lorentz friction, upright face",
                     gap=(0.75, 0.4), margins=(0.62, 1.0, 0.85, 0.95))  # fmt: skip
        _rows(page.panels[0], found, flume)
        _periods(page.panels[1], found, curves)
        mark: Any = {"ls": "none"}
        page.legend(
            [
                Line2D([], [], marker="x", color=GREY, ms=5, mew=1.4, label="printed in the paper", **mark),
                Line2D([], [], marker="s", color=PAPERS, ms=4.5, label="paper's formula, our waves", **mark),
                Line2D([], [], marker="o", color=OURS, ms=5, label="separated", **mark),
                Line2D([], [], marker="_", color=INK, ms=11, mew=1.4, label="theory", **mark),
            ]
        )
        return page.save(path)


def _rows(panel: Axes, found: Found, flume: int) -> None:
    names = []
    for i, p in enumerate(found.table):
        names.append(f"{p.slope}°\n{1e3 * p.height:.0f} mm")
        panel.plot(i, p.C_R, "x", color=GREY, ms=6, mew=1.4, zorder=3)
        if (w := found.row(p, flume)) is not None:
            _mark(panel, i, w)
            if np.isfinite(w.theory):
                panel.plot(i, w.theory, "_", color=INK, ms=14, mew=1.4, zorder=4)
    under: Any = {"xycoords": panel.get_xaxis_transform(), "textcoords": "offset points", "ha": "center", "va": "top"}
    for i, name in enumerate(names):
        panel.annotate(name, (i, 0.0), (0, -6), **under)
    panel.set_xlim(-0.6, len(names) - 0.4)
    panel.set_ylim(0, None)
    drawing.scales(panel, False, True)
    headings(panel, f"The rows of table 1, flume of {flume} m")


def _mark(panel: Axes, x: float, w: WaveRun) -> None:
    low, high = w.interval
    panel.vlines(x, low, high, color=OURS, lw=1.4, zorder=3)
    panel.plot(x, w.C_R, "o", color=OURS, ms=5, zorder=5)
    panel.plot(x, w.formula.C_R, "s", color=PAPERS, ms=4.5, zorder=4)


def _periods(panel: Axes, found: Found, curves: dict[float, list[tuple[float, float]]]) -> None:
    ends = []
    for (diameter, line), style in zip(curves.items(), ((0, (4, 2)), "-", (0, (1, 1.2))), strict=False):
        t, c = zip(*line, strict=True)
        panel.plot(t, c, color=INK, lw=1.1, ls=style)
        ends.append((c[-1], f"d50 = {1e3 * diameter:g} mm", INK))
    lowest = min(p.height for p in found.table)
    for w in found.waves:
        if w.entry and w.job.slope == 90 and w.job.height == lowest and w.job.part != "scheme":
            _mark(panel, w.entry["period"], w)
    panel.set_ylim(0, None)
    label(panel, "T [s]", "")
    drawing.scales(panel, True, True)
    headings(panel, f"Upright, {1e3 * lowest:.0f} mm: periods and grains")
    drawing.label_ends(panel, ends)


def _grid(run: Run) -> Grid:
    return run.case.domain.grid


def _spacing(run: Run) -> str:
    return f"spacing {length(max(_grid(run).spacing))}"
