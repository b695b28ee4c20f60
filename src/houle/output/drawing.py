"""How our pictures look: sheets of panels laid out in inches, colours, bodies, labels at the ends of lines.

Nothing here touches the state of matplotlib or opens a window: figures are made by hand and drawn by Agg. The colours
are told apart by people who do not see red and green (lightness differs, and no meaning hangs on hue alone).

Short runs should not wait for their pictures. What costs time in matplotlib, and is therefore not here: pyplot, layout
engines and tight boxes, ticks, titles and axis labels that look for a free place, mathematical text, path effects, and
one artist per point.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap, LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.markers import TICKDOWN, TICKLEFT
from matplotlib.patches import Polygon, Rectangle
from matplotlib.text import Annotation, Text
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from houle.grid import Grid
from houle.medium.shapes import Box
from houle.output.atomic import replacing

INK, GREY, FAINT = "#22303c", "#7d8a96", "#dfe4e8"
WATER, SHADE = "#1f5f8b", "#dceaf4"
LABORATORY = "#c44e17"
STONE, STONE_LINE, SOLID, PALE = "#f3efe6", "#8c8069", "#c3c8cc", "#dbdee0"
LINES = ("#1f5f8b", "#d98c1f", "#4d8f6b", "#8a5a9e", "#6b7680", "#c44e17", "#22303c", "#5aa9d6")
DPI = 150
TEXT, SMALL = 8.5, 7.5  # points; every other size costs a search for its font
LEAST = 6.0  # points: smaller cannot be read
WIDEST = 1.2  # no letter is wider, of its size
DIGIT, WIDTHS = 0.64, {".": 0.32, "−": 0.84}  # of letters in numbers, of their size
COMPRESSION = 1  # of PNG: a third of the time of the usual 6

_STYLE: dict[str, Any] = {
    "font.family": ["DejaVu Sans"],
    "font.size": TEXT,
    "text.color": INK,
    "text.parse_math": False,  # a title may hold $; mathematics of ours is set where it is asked for
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.4,
    "lines.solid_capstyle": "round",
    "hatch.linewidth": 0.5,
    "legend.frameon": False,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
}


def pressures() -> Colormap:
    """From shallow green to deep blue, monotone in lightness; the palest end is left out, it would vanish on white."""
    colours = matplotlib.colormaps["YlGnBu"](np.linspace(0.13, 1.0, 256))
    return LinearSegmentedColormap.from_list("pressures", colours)


class Panel(Axes):
    """Axes without ticks of their own, which cost as much as all the rest of a picture: `scales` draws them."""

    def grid(self, *_: Any, **__: Any) -> None:
        """There is none."""


@dataclass(frozen=True)
class Sheet:
    """A figure and its panels, in reading order."""

    figure: Figure
    panels: list[Axes]
    columns: int

    def save(self, path: Path) -> Path:
        """PNG, whole or not at all."""
        import houle

        with replacing(path) as temporary:
            made_by = {"Software": f"houle {houle.__version__}"}
            packing: Any = {"compress_level": COMPRESSION}
            canvas = FigureCanvasAgg(self.figure)
            canvas.print_figure(temporary, format="png", dpi=DPI, metadata=made_by, pil_kwargs=packing)
        return path

    def legend(self, handles: Sequence[Any], above: float = 0.1) -> None:
        """In the lower margin at the right, so many inches above the edge."""
        if not handles:
            return
        height = self.figure.get_size_inches()[1]
        edge = max(panel.get_position().x1 for panel in self.panels)
        self.figure.legend(
            handles=handles,
            loc="lower right",
            bbox_to_anchor=(edge, above / height),
            ncols=len(handles),
            fontsize=TEXT,
            handlelength=1.6,
            columnspacing=1.4,
            borderpad=0,
            borderaxespad=0,
        )

    def label_outside(self, x: str, y: str) -> None:
        """Axis labels and numbers at the left and lower sides of the sheet only, once the limits are set."""
        for i, panel in enumerate(self.panels):
            last, first = i + self.columns >= len(self.panels), i % self.columns == 0
            wide = scales(panel, last, first)
            label(panel, x if last else "", y if first else "", max(31.0, wide + 0.75 * TEXT))


@contextlib.contextmanager
def style() -> Iterator[None]:
    """The look above, for what is drawn inside."""
    with matplotlib.rc_context(_STYLE):  # type: ignore[arg-type]
        yield


def sheet(
    count: int,
    columns: int,
    size: tuple[float, float],
    title: str,
    subtitle: str,
    *,
    gap: tuple[float, float] = (0.3, 0.42),
    margins: tuple[float, float, float, float] = (0.62, 0.25, 0.5, 0.95),
) -> Sheet:
    """Panels of a size, gaps, and margins (left, right, bottom, top), all in inches; a title and a line under it."""
    rows = -(-count // columns)
    left, right, bottom, top = margins
    width = max(left + columns * size[0] + (columns - 1) * gap[0] + right, 6.0)
    height = top + rows * size[1] + (rows - 1) * gap[1] + bottom
    figure = Figure(figsize=(width, height))
    panels = []
    for i in range(count):
        row, column = divmod(i, columns)
        x, y = left + column * (size[0] + gap[0]), height - top - (row + 1) * size[1] - row * gap[1]
        panel = figure.add_axes((x / width, y / height, size[0] / width, size[1] / height), axes_class=Panel)
        panel.xaxis.set_visible(False)
        panel.yaxis.set_visible(False)
        panels.append(panel)
    headline(figure, left, width - left - min(right, left), title, subtitle)
    return Sheet(figure, panels, columns)


def headline(
    figure: Figure, left: float, room: float, title: str, subtitle: str, points: float = 12.0, mathematics: bool = False
) -> None:
    """A title in bold and a line under it at the top, from `left` on and no longer than `room`, both in inches."""
    width, height = figure.get_size_inches()
    for words, size, y, colour, weight in ((title, points, 0.26, INK, "bold"), (subtitle, TEXT, 0.49, GREY, "normal")):
        line = " ".join(part.strip() for part in words.splitlines())
        look: Any = {"fontsize": size, "color": colour, "weight": weight, "va": "center", "parse_math": mathematics}
        fitted(figure.text(left / width, 1 - y / height, line, **look), room)


def fitted(text: Text, room: float) -> Text:
    """A line set smaller until it is no longer than `room` [inches]; what LEAST does not bring in ends in an ellipsis.

    Mathematics is set smaller only. Returns the same text.
    """
    words, points = text.get_text(), float(text.get_fontsize())
    if not text.get_parse_math() and WIDEST * points * len(words) <= 72 * room:
        return text
    if (size := points * room / max(_length(text), 1e-9)) < points:
        text.set_fontsize(size if text.get_parse_math() else max(LEAST, size))
    if not text.get_parse_math() and size < LEAST:
        keep = int(len(words) * size / LEAST) + 1
        while keep > 0 and _length(text) > room:
            text.set_text(words[:keep].rstrip() + "…")
            keep -= 1
    return text


def _room(panel: Axes) -> tuple[float, float]:
    """Width and height of a panel [inches]."""
    figure: Any = panel.figure
    width, height = figure.get_size_inches()
    place = panel.get_position()
    return float(place.width * width), float(place.height * height)


def _length(text: Text) -> float:
    """Length of a line of a figure [inches], with a hundredth for the letters' hinting at another resolution."""
    figure: Any = text.figure
    canvas = figure.canvas if isinstance(figure.canvas, FigureCanvasAgg) else FigureCanvasAgg(figure)
    extent = text.get_window_extent(canvas.get_renderer())
    return 1.01 * float(max(extent.width, extent.height) if text.get_rotation() else extent.width) / figure.dpi


def scales(panel: Axes, below: bool, left: bool) -> float:
    """Ticks on the lower and the left side within the present limits, with numbers where it is said.

    Returns how far the numbers at the left reach beyond the panel [points], 0 without.
    """
    reach = 0.0
    for sideways, limits, numbers in ((False, panel.get_xlim(), below), (True, panel.get_ylim(), left)):
        low, high = sorted(limits)
        air = 1e-9 * (high - low)
        all_ticks = MaxNLocator(nbins=5, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        at = [float(tick) for tick in np.asarray(all_ticks) if low - air <= tick <= high + air]
        zero = [0.0] * len(at)
        across = panel.get_yaxis_transform() if sideways else panel.get_xaxis_transform()
        mark: Any = {"marker": TICKLEFT if sideways else TICKDOWN, "ls": "none", "ms": 3.0, "mew": 0.6, "color": GREY}
        line = Line2D(zero if sideways else at, at if sideways else zero, transform=across, clip_on=False, **mark)
        panel.add_artist(line)
        if not numbers:
            continue
        shift = (-6.5 / 72, 0.0) if sideways else (0.0, -6.5 / 72)
        place = across + ScaledTranslation(*shift, panel.figure.dpi_scale_trans)
        look: Any = {"ha": "right", "va": "center_baseline"} if sideways else {"ha": "center", "va": "top"}
        for tick, words in zip(at, as_numbers(at), strict=True):
            x, y = (0.0, tick) if sideways else (tick, 0.0)
            panel.text(x, y, words, transform=place, **look)
            if sideways:
                reach = max(reach, 6.5 + TEXT * sum(WIDTHS.get(letter, DIGIT) for letter in words))
    return reach


def as_numbers(values: Sequence[float]) -> list[str]:
    """All with as many digits as tell them apart, with a minus sign that is one."""
    step = min((b - a for a, b in itertools.pairwise(values)), default=abs(values[0]) if len(values) else 0.0) or 1.0
    digits = next((d for d in range(12) if all(abs(round(v, d) - v) < 1e-3 * step for v in values)), 12)
    return [f"{round(v, digits) + 0.0:.{digits}f}".replace("-", "−") for v in values]


def headings(panel: Axes, left: str, right: str = "", mathematics: bool = False) -> Annotation:
    """Above a panel, no longer than it: what it shows in bold, which is returned; a number beside it."""
    room = _room(panel)[0]
    if right:
        beside = _beside(panel, (1, 1), (0, 5), right, ha="right", va="baseline", color=GREY, parse_math=mathematics)
        room -= _length(fitted(beside, 0.6 * room)) + 0.1
    first = _beside(panel, (0, 1), (0, 5), left, ha="left", va="baseline", fontweight="bold", parse_math=mathematics)
    fitted(first, room)
    return first


def label(panel: Axes, x: str, y: str, away: float = 31.0) -> None:
    """Under the axis of a panel and beside the other, so many points away."""
    if x:
        _beside(panel, (0.5, 0), (0, -24), x, ha="center", va="baseline")
    if y:
        _beside(panel, (0, 0.5), (-away, 0), y, ha="center", va="center", rotation=90)


def _beside(panel: Axes, at: tuple[float, float], shift: tuple[float, float], words: str, **look: Any) -> Annotation:
    """Words some points away from a place of the panel, (0, 0) to (1, 1)."""
    look |= {"xycoords": "axes fraction", "textcoords": "offset points", "annotation_clip": False}
    return panel.annotate(words, at, shift, **look)


@dataclass(frozen=True)
class Body:
    """The outline (k, 2) of a porous body in the (x, z) section [m], and the words on it."""

    outline: NDArray[np.float64]
    words: str


def bodies(entries: Sequence[Any], grid: Grid, y: float = 0.0) -> list[Body]:
    """Sections at y of the shapes of a case: entries with box, polygon or below, perhaps name and porosity."""
    found = []
    for entry in entries:
        outline = _outline(entry, grid, y)
        if outline is not None:
            porosity = getattr(entry, "porosity", None)
            words = ", ".join(filter(None, [entry.name, f"n = {porosity:g}" if porosity else ""]))
            found.append(Body(outline, words))
    return found


def _outline(entry: Any, grid: Grid, y: float) -> NDArray[np.float64] | None:
    if getattr(entry, "polygon", None) is not None:
        return np.array(entry.polygon, dtype=float)
    if getattr(entry, "below", None) is not None:
        lower, upper = np.zeros(grid.dimension), np.array([*grid.size[:-1], entry.below])
    else:
        lower, upper = np.array(entry.box, dtype=float)
    if len(lower) == 3 and not lower[1] <= y <= upper[1]:
        return None
    (x0, z0), (x1, z1) = lower[[0, -1]], upper[[0, -1]]
    return np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]])


def draw_bodies(
    panel: Axes, porous: Sequence[Body], solid: Sequence[Body], *, over: bool = False, words: bool = True
) -> None:
    """Porous bodies hatched, solids filled. over: a second, thin outline above what is drawn in between."""
    for body in porous:
        panel.add_patch(Polygon(body.outline, fc=STONE, ec="none", zorder=0.5))
        panel.add_patch(Polygon(body.outline, fc="none", ec="#d5ccb8", hatch="////", lw=0, zorder=0.6))
        dash: Any = (0, (4, 2)) if over else "-"
        panel.add_patch(Polygon(body.outline, fc="none", ec=STONE_LINE, lw=0.9, ls=dash, zorder=4 if over else 2.5))
    if words:
        _names(panel, [body for body in porous if body.words])
    for body in solid:
        panel.add_patch(Polygon(body.outline, fc=SOLID, ec=GREY, lw=0.7, zorder=4))


def draw_thickened(panel: Axes, windows: Sequence[Box]) -> None:
    """What counts as solid around thin ones, paler than these."""
    for window in windows:
        (x0, *_, z0), (x1, *_, z1) = window.lower, window.upper
        panel.add_patch(Rectangle((x0, z0), x1 - x0, z1 - z0, fc=PALE, ec="none", zorder=3.9))


def _names(panel: Axes, named: Sequence[Body]) -> None:
    """The words of bodies over their tops, pushed apart where layers lie close, never above the panel."""
    ground = {"fc": "white", "ec": "none", "alpha": 0.75, "pad": 0.8}
    look: Any = {"ha": "center", "va": "bottom", "fontsize": SMALL, "color": STONE_LINE, "zorder": 5, "bbox": ground}
    (left, right), (low, high), room = panel.get_xlim(), panel.get_ylim(), _room(panel)[0]
    tall = 72 * _room(panel)[1]  # points
    tops = [tall * (body.outline[:, 1].max() - low) / (high - low) + 3.0 for body in named]
    line = 1.35 * SMALL
    for body, top, shift in zip(named, tops, apart(tops, line, 0.0, tall - line), strict=True):
        at = (float(body.outline[:, 0].mean()), 0.0)
        name = panel.annotate(
            body.words, at, (0, top + shift), xycoords=panel.get_xaxis_transform(), textcoords="offset points", **look
        )
        fitted(name, room)
        half = (right - left) * min(0.5, 0.5 * _length(name) / room)  # a long name is moved inwards
        name.xy = (float(np.clip(at[0], left + half, right - half)), 0.0)


@dataclass(frozen=True)
class Band:
    """What acts on the water between two places x [m]: hatched, with its name at the top."""

    low: float
    high: float
    words: str


def bands(case: Any, y: float) -> list[Band]:
    """Relaxation zone and sponges of a case, in the section at y of a case in 3D."""
    zone = case.waves.zone if case.waves is not None else None
    found = [] if zone is None else [Band(zone.x[0], zone.x[1], "zone")]
    for sponge in case.sponge:
        low, high = sponge.box
        if len(low) == 2 or low[1] <= y <= high[1]:
            found.append(Band(low[0], high[0], "sponge"))
    return found


def draw_bands(panel: Axes, found: Sequence[Band]) -> None:
    """Thin lines at 45 degrees, over the water."""
    for band in found:
        panel.axvspan(band.low, band.high, fc="none", ec=GREY, hatch="//", lw=0, zorder=2.4)
        for x in (band.low, band.high):
            panel.axvline(x, color=GREY, lw=0.6, zorder=2.4)
        _at_the_top(panel, (band.low + band.high) / 2, band.words)


def draw_source(panel: Axes, x: float) -> None:
    """Where a wave maker inside the water stands."""
    panel.axvline(x, color=INK, lw=0.9, ls=(0, (5, 3)), zorder=2.6)
    _at_the_top(panel, x, "source")


def draw_open(panel: Axes, sides: Sequence[Any], length: float) -> None:
    """Dots along the sides of the tank, of this length [m], through which water comes and goes."""
    look: Any = {"color": INK, "lw": 2.4, "ls": (0, (0.6, 1.0)), "zorder": 6, "clip_on": False}
    for side in sides:
        x = 0.0 if side.side == "left" else length
        panel.plot([x, x], [0.0, 1.0], transform=panel.get_xaxis_transform(), **look)
        align = {"left": (6, "left"), "right": (-6, "right")}[side.side]
        at: Any = {"xycoords": panel.get_xaxis_transform(), "textcoords": "offset points"}
        panel.annotate(
            "open", (x, 1.0), (align[0], -3), ha=align[1], va="top", fontsize=SMALL, color=INK, zorder=5, **at
        )


def draw_paddles(panel: Axes, ends: Sequence[tuple[float, float]]) -> None:
    """(side of the tank, place) of walls that move: the wall, and the dry room behind it."""
    for side, x in ends:
        panel.axvspan(min(side, x), max(side, x), fc=FAINT, ec="none", zorder=2.5)
        panel.axvline(x, color=INK, lw=1.6, zorder=4.2)


def draw_still_water(panel: Axes, level: float) -> None:
    panel.axhline(level, color=GREY, lw=0.6, ls=(0, (10, 5)), zorder=2.3)


def _at_the_top(panel: Axes, x: float, words: str) -> None:
    ground = {"fc": "white", "ec": "none", "alpha": 0.75, "pad": 0.8}
    look: Any = {"ha": "center", "va": "top", "fontsize": SMALL, "color": INK, "zorder": 5, "bbox": ground}
    panel.annotate(words, (x, 1.0), (0, -3), xycoords=panel.get_xaxis_transform(), textcoords="offset points", **look)


def draw_gates(panel: Axes, gates: Sequence[Any], time: float, top: float) -> list[Line2D]:
    """The plates that are still in the picture, lifted as far as they are at this time [s]."""
    feet = [(gate.x, max(0.0, time - gate.start) * gate.speed) for gate in gates]
    look: Any = {"color": INK, "lw": 1.6, "solid_capstyle": "butt", "zorder": 5}
    return [panel.plot([x, x], [foot, top], **look)[0] for x, foot in feet if foot < top]


def label_ends(panel: Axes, ends: Sequence[tuple[float, str, str]], points: float = SMALL) -> None:
    """(height in data, words, colour) of curves: the words beside their right ends, pushed apart where they overlap."""
    panel.get_ylim()  # settles the limits: without it the transforms are those of an empty panel
    to_points = 72.0 / panel.figure.dpi
    (_, low), (_, high) = (to_points * corner for corner in panel.transAxes.transform([(0, 0), (0, 1)]))
    heights = [to_points * panel.transData.transform((0.0, y))[1] for y, _, _ in ends]
    room = (1.0 - panel.get_position().x1) / panel.get_position().width * _room(panel)[0] - 8 / 72
    for (y, words, colour), shift in zip(ends, apart(heights, points * 1.25, low, high), strict=True):
        name = panel.annotate(
            words,
            (1.0, y),
            (5, shift),
            xycoords=panel.get_yaxis_transform(),
            textcoords="offset points",
            va="center",
            fontsize=points,
            color=colour,
            annotation_clip=False,
        )
        fitted(name, room)


def apart(heights: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """Shifts that bring neighbours `gap` apart, in their order; a crowd stays about its middle, and in range."""

    def spread(crowd: Sequence[float]) -> NDArray[np.float64]:
        half = 0.5 * gap * (len(crowd) - 1)
        middle = np.clip(np.mean(crowd), min(low + half, high - half), max(low + half, high - half))
        return middle + gap * np.arange(len(crowd)) - half

    order = np.argsort(heights, kind="stable")
    crowds = [[heights[i]] for i in order]
    k = 0
    while k + 1 < len(crowds):
        if spread(crowds[k])[-1] + gap > spread(crowds[k + 1])[0] + 1e-9:
            crowds[k : k + 2] = [crowds[k] + crowds[k + 1]]
            k = max(0, k - 1)
        else:
            k += 1
    placed = np.concatenate([spread(crowd) for crowd in crowds]) if crowds else np.empty(0)
    shifts = np.zeros(len(heights))
    shifts[order] = placed - np.asarray(heights)[order]
    return shifts.tolist()
