"""The picture of a reflection analysis: signals at the gauges, the window, and the waves they are separated into."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from houle.analysis.measured import Measured
from houle.output.atomic import replacing
from houle.output.drawing import DPI, FAINT, GREY, INK, LABORATORY, SHADE, SMALL, TEXT, WATER, fitted, headline, style

INCIDENT, REFLECTED = WATER, LABORATORY
SIZE, GAP, LEFT, RIGHT, TOP, BOTTOM = (6.4, 1.75), 0.75, 0.78, 0.9, 0.95, 0.72  # inches: size of a panel, gaps, margins
MOST_GAUGES = 6  # gauges that are drawn, evenly chosen when there are more


def draw(r: Measured, path: Path) -> Path:
    """Draws signals with the window shaded, the envelope along the flume (regular waves), and harmonics or spectrum."""
    with style():
        figure, panels = _sheet(r, 3 if r.amplitudes is not None else 2)
        _signals(panels[0], r)
        if r.amplitudes is not None:
            _envelope(panels[1], r)
        if r.lines is not None:
            _spectrum(panels[-1], r)
        elif r.harmonics:
            _harmonics(panels[-1], r)
        with replacing(path) as temporary:
            FigureCanvasAgg(figure).print_figure(temporary, format="png", dpi=DPI)
    return path


def _sheet(r: Measured, count: int) -> tuple[Figure, list[Axes]]:
    """A figure of panels one under another, with the coefficients as the title and the colours at the foot."""
    width, height = LEFT + SIZE[0] + RIGHT, TOP + count * SIZE[1] + (count - 1) * GAP + BOTTOM
    figure = Figure(figsize=(width, height))
    panels = []
    for i in range(count):
        y = height - TOP - (i + 1) * SIZE[1] - i * GAP
        panels.append(figure.add_axes((LEFT / width, y / height, SIZE[0] / width, SIZE[1] / height)))
    wave = f"{r.kind} waves, ${'T' if r.kind == 'regular' else 'T_p'}$ = {r.period:.4g} s, {r.method}"
    headline(figure, LEFT, SIZE[0] + RIGHT / 2, _numbers(r), wave, points=10, mathematics=True)
    colours = {"incident": INCIDENT, "reflected": REFLECTED}
    keys = [Line2D([], [], color=c, lw=2.5, label=name) for name, c in colours.items()]
    place = ((LEFT + SIZE[0]) / width, 0.1 / height)
    figure.legend(handles=keys, loc="lower right", bbox_to_anchor=place, ncols=2, frameon=False, borderaxespad=0)
    return figure, panels


def _numbers(r: Measured) -> str:
    every = (("C_R", r.C_R, r.interval_R), ("C_T", r.C_T, r.interval_T), ("C_D", r.C_D, r.interval_D))
    known = [(name, value, span) for name, value, span in every if np.isfinite(value)]
    between = [f" ({low:.3f} to {high:.3f})" if np.isfinite(low) else "" for _, _, (low, high) in known]
    return "   ".join(f"${name}$ = {value:.3f}{span}" for (name, value, _), span in zip(known, between, strict=True))


def _headings(panel: Axes, left: str, right: str = "") -> None:
    panel.set_title(left, loc="left", fontsize=9, fontweight="bold", pad=4)
    panel.set_title(right, loc="right", fontsize=TEXT, color=GREY, pad=4)


def _signals(panel: Axes, r: Measured) -> None:
    g = r.record
    rows = np.unique(np.linspace(0, len(g.x) - 1, min(len(g.x), MOST_GAUGES)).round().astype(int))
    levels = g.eta[rows] - g.eta[rows].mean(axis=1, keepdims=True)
    gap = 1.1 * float(np.ptp(levels, axis=1).max())
    panel.axvspan(r.window.start, r.window.end, color=SHADE, lw=0, zorder=0)
    for row, (level, number) in enumerate(zip(levels, rows, strict=True)):
        base = -row * gap
        panel.axhline(base, color=FAINT, lw=0.6, zorder=0.5)
        panel.plot(g.time, base + level, color=INK, lw=0.8)
        words = f"{g.names[number]}" if "=" in g.names[number] else f"{g.names[number]}, {r.towards * g.x[number]:g} m"
        name = panel.annotate(words, (1.0, base), (5, 0), xycoords=panel.get_yaxis_transform(),
                              textcoords="offset points", va="center", fontsize=SMALL, color=GREY)  # fmt: skip
        fitted(name, RIGHT - 0.12)
    panel.set_xlim(g.time[0], g.time[-1])
    panel.set_yticks([])
    panel.spines["left"].set_visible(False)
    panel.set_xlabel("t [s]")
    _headings(
        panel,
        f"Surface at the gauges, lines {1e3 * gap:.3g} mm apart",
        f"shaded: {r.window.periods} periods, {r.window.start:.4g} to {r.window.end:.4g} s",
    )


def _envelope(panel: Axes, r: Measured) -> None:
    """Amplitude of the first harmonic: measured at the gauges, and of the two waves between them."""
    assert r.amplitudes is not None
    first, x = r.harmonics[0], r.record.x
    margin = 0.15 * 2 * np.pi / r.wave_number
    along = np.linspace(x.min() - margin, x.max() + margin, 400)
    wave = np.exp(1j * r.wave_number * along)
    both = np.abs(first.incident * wave + first.reflected / wave)
    panel.axhline(1e3 * abs(first.incident), color=INCIDENT, lw=1.2)
    panel.axhline(1e3 * abs(first.reflected), color=REFLECTED, lw=1.2)
    panel.plot(r.towards * along, 1e3 * both, color=GREY, lw=1.2)
    panel.plot(r.towards * x, 1e3 * np.abs(r.amplitudes[:, 1]), "o", color=INK, ms=4.5 if len(x) < 30 else 1.5)
    panel.set_ylim(0, None)
    panel.set_xlim(*sorted(r.towards * along[[0, -1]]))
    panel.set_xlabel("x [m]")
    panel.set_ylabel("[mm]")
    unexplained = f"unexplained {100 * r.residual:.2f} %" if np.isfinite(r.residual) else ""
    _headings(panel, "First harmonic: at the gauges, and the two waves together", unexplained)


def _harmonics(panel: Axes, r: Measured) -> None:
    sizes = [("incident", 0, INCIDENT, 1.0), ("reflected", 1, REFLECTED, 1.0)]
    sizes += [("free_incident", 2, INCIDENT, 0.45), ("free_reflected", 3, REFLECTED, 0.45)]
    largest = 1e3 * abs(r.harmonics[0].incident)
    for part in r.harmonics:
        shown = sizes if part.order > 1 else sizes[:2]
        for name, place, colour, alpha in shown:
            height = 1e3 * abs(getattr(part, name))
            at = part.order + 0.17 * (place - 0.5 * (len(shown) - 1))
            panel.bar(at, height, 0.15, color=colour, alpha=alpha)
            if height > 1e-3 * largest:
                panel.annotate(
                    f"{height:.2g}", (at, height), (0, 2), textcoords="offset points", ha="center", fontsize=7
                )
    panel.set_ylim(0, 1.15 * panel.get_ylim()[1])
    panel.set_xticks([part.order for part in r.harmonics])
    panel.set_xlabel("harmonic")
    panel.set_ylabel("[mm]")
    _headings(panel, "Separated amplitudes", "pale: free waves; dark: moving with the primary wave")


def _spectrum(panel: Axes, r: Measured) -> None:
    assert r.lines is not None
    f, width = r.lines.frequency, max(1, len(r.lines.frequency) // 30)
    kernel = np.ones(width) / width
    for density, colour in ((r.lines.incident, INCIDENT), (r.lines.reflected, REFLECTED)):
        panel.plot(f, 1e6 * density, color=colour, lw=0.4, alpha=0.35)
        panel.plot(f, 1e6 * np.convolve(density, kernel, "same"), color=colour, lw=1.4)
    top = 1e6 * float(np.convolve(r.lines.incident, kernel, "same").max())
    lost = r.lines.trust == 0
    if lost.any():
        panel.plot(f[lost], np.zeros(lost.sum()), "|", color=GREY, ms=6)
    panel.set_xlim(f[0], f[-1])
    panel.set_ylim(0, 1.5 * top)
    panel.set_xlabel("f [Hz]")
    panel.set_ylabel(r"[mm$^2$/Hz]", parse_math=True)
    _headings(panel, f"Separated spectrum, mean of {width} lines", "grey ticks: lines left out" if lost.any() else "")
