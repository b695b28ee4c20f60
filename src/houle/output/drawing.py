"""How our pictures look: sheets of panels laid out in inches, colours, bodies, labels at the ends of lines.

The colours are told apart by people who do not see red and green: lightness differs, no meaning hangs on hue alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid
from houle.output.canvas import DPI, Box, Canvas, Dashes, pixels, rgb, width_of

INK, GREY, FAINT = "#22303c", "#7d8a96", "#dfe4e8"
WATER, SHADE = "#1f5f8b", "#dceaf4"
LABORATORY = "#c44e17"
STONE, STONE_LINE, HATCH, SOLID = "#f3efe6", "#8c8069", "#d5ccb8", "#c3c8cc"
LINES = ("#1f5f8b", "#d98c1f", "#4d8f6b", "#8a5a9e", "#6b7680", "#c44e17", "#22303c", "#5aa9d6")
TEXT, SMALL = 8.5, 8.0  # points

# YlGnBu of ColorBrewer (Harrower & Brewer 2003): from shallow green to deep blue, monotone in lightness
_YLGNBU = ("#ffffd9", "#edf8b1", "#c7e9b4", "#7fcdbb", "#41b6c4", "#1d91c0", "#225ea8", "#253494", "#081d58")
PALEST = 0.13  # left out, it would vanish on white


def pressures() -> FloatArray:
    """A table (256, 3) of colours from low to high."""
    places, stops = np.linspace(PALEST, 1.0, 256), np.linspace(0.0, 1.0, len(_YLGNBU))
    return np.stack([np.interp(places, stops, [rgb(c)[a] for c in _YLGNBU]) for a in range(3)], axis=-1)


def ticks(low: float, high: float, most: int = 5) -> tuple[FloatArray, list[str]]:
    """Round numbers in a range, at most so many steps from one to the next, and how they are written."""
    span = max(high - low, 1e-300)
    power = 10.0 ** np.floor(np.log10(span / most))
    step = next(f * power for f in (1.0, 2.0, 2.5, 5.0, 10.0, 20.0) if span <= most * f * power)
    numbers = step * np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1)
    digits = next(d for d in range(300) if round(step * 10**d) and abs(step * 10**d / round(step * 10**d) - 1) < 1e-6)
    return numbers, [f"{number + 0.0:.{digits}f}".replace("-", "−") for number in numbers]


class Panel:
    """A box of the canvas with an x and a y axis. `limits(x, y)` first; then draw, then `frame`."""

    def __init__(self, canvas: Canvas, box: Box) -> None:
        self.canvas, self.box = canvas, box
        self.x, self.y = (0.0, 1.0), (0.0, 1.0)

    def limits(self, x: tuple[float, float], y: tuple[float, float]) -> None:
        self.x, self.y = x, y

    @property
    def scale(self) -> FloatArray:
        """Pixels per unit along x and y (upwards)."""
        x0, y0, x1, y1 = self.box
        return np.array([(x1 - x0) / (self.x[1] - self.x[0]), (y1 - y0) / (self.y[1] - self.y[0])])

    def place(self, x: Any, y: Any) -> FloatArray:
        """Pixels (k, 2) of points."""
        along = self.box[0] + (np.asarray(x, float) - self.x[0]) * self.scale[0]
        return np.stack(
            np.broadcast_arrays(along, self.box[3] - (np.asarray(y, float) - self.y[0]) * self.scale[1]), -1
        )

    def line(self, x: Any, y: Any, colour: str, width: float, dashes: Dashes | None = None) -> None:
        """Clipped at the panel, but for half its width: a line on the edge is whole."""
        margin = int(np.ceil(0.5 * pixels(width)))
        x0, y0, x1, y1 = self.box
        self.canvas.line(self.place(x, y), colour, width, (x0 - margin, y0 - margin, x1 + margin, y1 + margin), dashes)

    def rule(self, y: float, colour: str) -> None:
        """A hair line across the panel, where it is inside."""
        if self.y[0] <= y <= self.y[1]:
            row = min(int(self.place(0.0, y)[1]), self.box[3] - 1)
            self.canvas.rectangle((self.box[0], row, self.box[2], row + 1), colour)

    def frame(self, x: str | None, y: str | None, *, right: bool = False, label_at: float | None = None) -> None:
        """Axes with ticks. A label, "" for numbers alone, None for neither; label_at: pixels left of the panel."""
        x0, y0, x1, y1 = self.box
        rectangle, write = self.canvas.rectangle, self.canvas.write
        length = round(pixels(3.0))
        rectangle((x0, y0, x0 + 1, y1 + 1), GREY)
        rectangle((x0, y1, x1, y1 + 1), GREY)
        if right:
            rectangle((x1 - 1, y0, x1, y1), GREY)
        numbers, words = ticks(*self.x)
        for at, text in zip(self.place(numbers, self.y[0]), words, strict=True):
            column = min(int(at[0]), x1 - 1)
            rectangle((column, y1, column + 1, y1 + 1 + length), GREY)
            if x is not None:
                write(at[0], y1 + length + pixels(3.5), text=text, size=TEXT, colour=INK, anchor="mt")
        numbers, words = ticks(*self.y)
        for at, text in zip(self.place(self.x[0], numbers), words, strict=True):
            row = min(int(at[1]), y1)
            rectangle((x0 - length, row, x0, row + 1), GREY)
            if y is not None:
                write(x0 - length - pixels(3.5), at[1], text=text, size=TEXT, colour=INK, anchor="rm")
        if x:
            write((x0 + x1) / 2, y1 + pixels(24.0), text=x, size=TEXT, colour=INK, anchor="ms")
        if y:
            widest = max((width_of(text, TEXT) for text in words), default=0.0)
            away = label_at or length + widest + pixels(10.0)
            write(x0 - away, (y0 + y1) / 2, text=y, size=TEXT, colour=INK, upward=True)

    def heading(self, left: str, right: str = "") -> None:
        """Above the panel: what it shows in bold, a number beside it."""
        base = self.box[1] - pixels(4.5)
        self.canvas.write(self.box[0], base, text=left, size=9, colour=INK, bold=True)
        if right:
            self.canvas.write(self.box[2], base, text=right, size=TEXT, colour=GREY, anchor="rs")


@dataclass(frozen=True)
class Key:
    """An entry of a legend: a line, or a ring."""

    label: str
    colour: str
    ring: bool = False


@dataclass(frozen=True)
class Sheet:
    """A canvas and its panels, in reading order."""

    canvas: Canvas
    panels: list[Panel]
    columns: int

    def save(self, path: Path) -> Path:
        return self.canvas.save(path)

    def legend(self, keys: Sequence[Key], above: float = 0.1) -> None:
        """In the lower margin at the right, so many inches above the edge."""
        x = float(max(panel.box[2] for panel in self.panels))
        y = self.canvas.box[3] - DPI * above - pixels(4.0)
        for key in reversed(keys):
            x -= width_of(key.label, TEXT)
            self.canvas.write(x, y, text=key.label, size=TEXT, colour=INK, anchor="lm")
            x -= pixels(7.0)
            if key.ring:
                self.canvas.rings(np.array([[x - pixels(7.0), y]]), 1.8, key.colour, 0.9, self.canvas.box)
            else:
                self.canvas.line(np.array([[x - pixels(14.0), y], [x, y]]), key.colour, 1.5, self.canvas.box)
            x -= pixels(26.0)

    def frames(self, x: str, y: str) -> None:
        """Axes of all panels, with numbers and labels at the left and lower sides of the sheet only."""
        for i, panel in enumerate(self.panels):
            last = i + self.columns >= len(self.panels)
            panel.frame(x if last else None, y if i % self.columns == 0 else None, right=True)


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
    canvas = Canvas(round(DPI * width), round(DPI * height))
    panels = []
    for i in range(count):
        row, column = divmod(i, columns)
        x, y = left + column * (size[0] + gap[0]), top + row * (size[1] + gap[1])
        x0, y0, x1, y1 = (round(DPI * edge) for edge in (x, y, x + size[0], y + size[1]))
        panels.append(Panel(canvas, (x0, y0, x1, y1)))
    room = DPI * (width - left - right)
    for words, most, y, colour, bold in ((title, 12.0, 0.26, INK, True), (subtitle, TEXT, 0.49, GREY, False)):
        points = min(most, most * room / max(1.0, width_of(words, most, bold)))  # a long title is set smaller, not cut
        canvas.write(DPI * left, DPI * y, text=words, size=points, colour=colour, bold=bold, anchor="lm")
    return Sheet(canvas, panels, columns)


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
            words = ", ".join(filter(None, [entry.name, f"$n$ = {porosity:g}" if porosity else ""]))
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


def stones(panel: Panel, porous: Sequence[Body]) -> None:
    """The ground of porous bodies."""
    for body in porous:
        panel.canvas.polygon(panel.place(*body.outline.T), STONE, panel.box)


def hatches(panel: Panel, porous: Sequence[Body]) -> None:
    """The hatching of porous bodies."""
    for body in porous:
        panel.canvas.polygon(panel.place(*body.outline.T), HATCH, panel.box, hatch=pixels(5.0))


def outline_bodies(panel: Panel, porous: Sequence[Body], solid: Sequence[Body], *, dashed: bool) -> None:
    """Outlines and words of porous bodies; solids, filled. They lie before the water."""
    for body in porous:
        closed = np.concatenate([body.outline, body.outline[:1]])
        panel.line(closed[:, 0], closed[:, 1], STONE_LINE, 0.9, (pixels(3.6), pixels(1.8)) if dashed else None)
        x, y = panel.place(body.outline[:, 0].mean(), body.outline[:, 1].max())
        if body.words:
            look: Any = {"size": 7.5, "colour": STONE_LINE, "anchor": "ms", "halo": True}
            panel.canvas.write(x, y - pixels(4.0), text=body.words, **look)
    for body in solid:
        closed = np.concatenate([body.outline, body.outline[:1]])
        panel.canvas.polygon(panel.place(*body.outline.T), SOLID, panel.box)
        panel.line(closed[:, 0], closed[:, 1], GREY, 0.7)


def draw_gates(panel: Panel, gates: Sequence[Any], time: float) -> None:
    """The plates that are still in the picture, lifted as far as they are at this time [s]."""
    for gate in gates:
        foot = max(0.0, time - gate.start) * gate.speed
        if foot < panel.y[1]:
            panel.line([gate.x, gate.x], [foot, panel.y[1]], INK, 1.6)


def label_ends(panel: Panel, ends: Sequence[tuple[float, str, str]]) -> None:
    """(height in data, words, colour) of curves: the words beside their right ends, pushed apart where they overlap."""
    heights = [-float(panel.place(0.0, y)[1]) for y, _, _ in ends]  # upwards
    shifts = apart(heights, 1.25 * pixels(SMALL), -panel.box[3], -panel.box[1])
    for height, shift, (_, words, colour) in zip(heights, shifts, ends, strict=True):
        at = (panel.box[2] + pixels(5.0), -(height + shift))
        panel.canvas.write(*at, text=words, size=SMALL, colour=colour, anchor="lm")


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
