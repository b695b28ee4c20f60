"""Sheets of panels laid out in inches, with the colours, scales, words and keys that all our pictures share.

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
from matplotlib.text import Annotation, Text
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation

from houle.output.atomic import replacing
from houle.output.labels import apart, in_rows

INK, GREY, FAINT = "#22303c", "#7d8a96", "#dfe4e8"
WATER, SHADE = "#1f5f8b", "#dceaf4"
LABORATORY = "#c44e17"
STONE, STONE_LINE, SOLID, PALE = "#f3efe6", "#8c8069", "#b3bac0", "#dbdee0"
LINES = ("#1f5f8b", "#d98c1f", "#4d8f6b", "#8a5a9e", "#6b7680", "#c44e17", "#22303c", "#5aa9d6")
DPI = 150
KEY_MARK = 0.42  # length of the mark of an entry of a key and of the gap after it [inches]
ROW = 0.17  # height of a row of a key [inches]
TEXT, SMALL = 8.5, 7.5  # points; every other size costs a search for its font
LEAST = 6.0  # points: smaller cannot be read
WIDEST = 1.2  # width of the widest letter over the size of the font
DIGIT, WIDTHS = 0.64, {".": 0.32, "−": 0.84}  # width of a digit, and of signs in numbers, over the size of the font
COMPRESSION = 1  # level for PNG: takes a third of the time of the usual 6

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
    """Colours from shallow green to deep blue, monotone in lightness, without the palest, which vanish on white."""
    colours = matplotlib.colormaps["YlGnBu"](np.linspace(0.13, 1.0, 256))
    return LinearSegmentedColormap.from_list("pressures", colours)


class Panel(Axes):
    """Axes without ticks of their own, which take as long as all the rest of a picture: `scales` draws them."""

    def grid(self, *_: Any, **__: Any) -> None:
        """Does nothing: a panel has no grid lines."""


@dataclass(frozen=True)
class Sheet:
    """A figure and its panels, in reading order."""

    figure: Figure
    panels: list[Axes]
    columns: int

    def save(self, path: Path) -> Path:
        """Saves the sheet as PNG, whole or not at all."""
        import houle

        with replacing(path) as temporary:
            made_by = {"Software": f"houle {houle.__version__}"}
            packing: Any = {"compress_level": COMPRESSION}
            canvas = FigureCanvasAgg(self.figure)
            canvas.print_figure(temporary, format="png", dpi=DPI, metadata=made_by, pil_kwargs=packing)
        return path

    def legend(self, handles: Sequence[Any], above: float = 0.1) -> None:
        """Puts a legend in one row into the lower margin at the right; above: inches from the edge of the sheet."""
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

    def key(self, handles: Sequence[Any], above: float = 0.1) -> None:
        """Puts a legend of many marks under the panels, in rows from the left.

        above: inches from the edge of the sheet to the last row.

        `key_height` tells how much of the lower margin it takes.
        """
        width, height = self.figure.get_size_inches()
        left, room = _key_span(self.panels, width)
        rows = in_rows(_entries(handles, room), room)
        for n, row in enumerate(rows):
            place = (left / width, (above + (len(rows) - 1 - n) * ROW) / height)
            look: Any = {"loc": "lower left", "bbox_to_anchor": place, "ncols": len(row), "fontsize": TEXT}
            look |= {"handlelength": 1.6, "columnspacing": 1.4, "borderpad": 0, "borderaxespad": 0}
            made = self.figure.legend(handles=[handles[i] for i in row], **look)
            for text, i in zip(made.get_texts(), row, strict=True):
                fitted(text, _entries(handles, room)[i] - KEY_MARK)

    def label_outside(self, x: str, y: str) -> None:
        """Axis labels and numbers at the left and lower sides of the sheet only, once the limits are set."""
        for i, panel in enumerate(self.panels):
            last, first = i + self.columns >= len(self.panels), i % self.columns == 0
            wide = scales(panel, last, first)
            label(panel, x if last else "", y if first else "", max(31.0, wide + 0.75 * TEXT))


def key_height(handles: Sequence[Any], room: float) -> float:
    """Height of a key in the lower margin [inches], where it may be as long as `room` [inches]."""
    return ROW * len(in_rows(_entries(handles, room), room))


def _entries(handles: Sequence[Any], room: float) -> list[float]:
    """Length of each entry of a key [inches], a little more than most letters need; longer ones are set smaller."""
    return [min(room, KEY_MARK + 0.62 * TEXT / 72 * max(1, len(str(handle.get_label())))) for handle in handles]


def _key_span(panels: Sequence[Axes], width: float) -> tuple[float, float]:
    """Left end and length of a key under some panels of a figure so wide [inches]."""
    left = min(panel.get_position().x0 for panel in panels) * width
    return left, width - left - 0.2


@contextlib.contextmanager
def style() -> Iterator[None]:
    """Sets the style of the figures that are drawn inside."""
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
    """A sheet of panels with a title and a line under it: size, gaps, margins (left, right, bottom, top) in inches."""
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
    """Writes a title in bold and a line under it at the top, from `left` on and no longer than `room` [inches]."""
    width, height = figure.get_size_inches()
    for words, size, y, colour, weight in ((title, points, 0.26, INK, "bold"), (subtitle, TEXT, 0.49, GREY, "normal")):
        line = " ".join(part.strip() for part in words.splitlines())
        look: Any = {"fontsize": size, "color": colour, "weight": weight, "va": "center", "parse_math": mathematics}
        fitted(figure.text(left / width, 1 - y / height, line, **look), room)


def fitted(text: Text, room: float) -> Text:
    """Sets a line smaller until it is no longer than `room` [inches]; where LEAST is still too long, it is cut ("…").

    Mathematics is not cut. Returns the same text.
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


def panel_size(panel: Axes) -> tuple[float, float]:
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
    """Draws ticks on the lower and the left side within the present limits; below, left: with numbers.

    Returns how far the numbers at the left reach beyond the panel [points], 0 without.
    """
    reach = 0.0
    for sideways, limits, numbers in ((False, panel.get_xlim(), below), (True, panel.get_ylim(), left)):
        low, high = sorted(limits)
        air = 1e-9 * (high - low)
        most = 5 if sideways else max(1, min(5, int(panel_size(panel)[0] / 0.5)))
        all_ticks = MaxNLocator(nbins=most, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
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
    """The values in words, all with as many digits as tell them apart, and with a proper minus sign."""
    step = min((b - a for a, b in itertools.pairwise(values)), default=abs(values[0]) if len(values) else 0.0) or 1.0
    digits = next((d for d in range(12) if all(abs(round(v, d) - v) < 1e-3 * step for v in values)), 12)
    return [f"{round(v, digits) + 0.0:.{digits}f}".replace("-", "−") for v in values]


def headings(panel: Axes, left: str, right: str = "", mathematics: bool = False, raised: float = 0.0) -> Annotation:
    """Writes above a panel what it shows, in bold, and a number at the right. Returns the former.

    raised: so many points higher, over the names of gauges.
    """
    room, up = panel_size(panel)[0], 5 + raised
    if right:
        beside = _beside(panel, (1, 1), (0, up), right, ha="right", va="baseline", color=GREY, parse_math=mathematics)
        room -= _length(fitted(beside, 0.6 * room)) + 0.1
    first = _beside(panel, (0, 1), (0, up), left, ha="left", va="baseline", fontweight="bold", parse_math=mathematics)
    fitted(first, room)
    return first


def label(panel: Axes, x: str, y: str, away: float = 31.0) -> None:
    """Writes the names of the axes: x under the panel, y at its left, so many points away."""
    if x:
        _beside(panel, (0.5, 0), (0, -24), x, ha="center", va="baseline")
    if y:
        _beside(panel, (0, 0.5), (-away, 0), y, ha="center", va="center", rotation=90)


def _beside(panel: Axes, at: tuple[float, float], shift: tuple[float, float], words: str, **look: Any) -> Annotation:
    """Writes words some points away from a place of the panel, (0, 0) to (1, 1)."""
    look |= {"xycoords": "axes fraction", "textcoords": "offset points", "annotation_clip": False}
    return panel.annotate(words, at, shift, **look)


def label_ends(panel: Axes, ends: Sequence[tuple[float, str, str]], points: float = SMALL) -> None:
    """Names curves at their right ends, pushed apart where they overlap: (height in data, words, colour) of each."""
    panel.get_ylim()  # settles the limits: without it the transforms are those of an empty panel
    to_points = 72.0 / panel.figure.dpi
    (_, low), (_, high) = (to_points * corner for corner in panel.transAxes.transform([(0, 0), (0, 1)]))
    heights = [to_points * panel.transData.transform((0.0, y))[1] for y, _, _ in ends]
    room = (1.0 - panel.get_position().x1) / panel.get_position().width * panel_size(panel)[0] - 8 / 72
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


def colour_bar(page: Sheet, marks: Any, words: str, mathematics: bool = False, above: float = 0.0) -> None:
    """Draws a slim colour bar under the panels, `above` inches higher; mathematics: the words hold some, in dollars."""
    width, height = page.figure.get_size_inches()
    first = page.panels[0].get_position()
    bar = page.figure.add_axes((first.x0, (0.32 + above) / height, min(3.2 / width, 0.4), 0.09 / height))
    low, high = marks.get_clim()
    bar.imshow(np.linspace(low, high, 256)[None], cmap=marks.cmap, extent=(low, high, 0.0, 1.0), aspect="auto")
    bar.set_yticks([])
    bar.set_frame_on(False)
    bar.tick_params(length=2)
    bar.locator_params(axis="x", nbins=6)
    bar.text(1.03, 0.5, words, transform=bar.transAxes, va="center", parse_math=mathematics)


def text_length(text: Text) -> float:
    """Length of a line of a figure [points]."""
    return 72.0 * _length(text)
