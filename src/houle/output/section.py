"""The vertical section of a case, ready to be drawn on: bodies, gates, scale; and particles coloured by pressure."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from houle.frame import Frame
from houle.grid import Grid
from houle.output import drawing
from houle.output.canvas import DPI, pixels
from houle.output.drawing import GREY, INK, TEXT, Panel, Sheet, sheet

DRAWN = 40000  # particles in a panel; of more, every k-th is drawn, larger
STRETCHED = 5.5  # longest panel, length over height; a longer flume is stretched upwards
LARGER = 1.42  # diameter of a disc over the side of the square the particle fills: no gaps


class Section:
    """In 2D the whole case, in 3D its middle section. levels: heights [m] that must be inside the picture."""

    def __init__(self, case: Any, grid: Grid, levels: Iterable[float]) -> None:
        self.case, self.grid = case, grid
        self.y = float(grid.axis_points(1)[grid.shape[1] // 2]) if grid.dimension == 3 else 0.0
        self.porous = drawing.bodies(case.porous, grid, self.y)
        self.solid = drawing.bodies(case.solid, grid, self.y)
        tops = [float(body.outline[:, 1].max()) for body in (*self.porous, *self.solid)]
        highest = max([*(float(level) for level in levels), *tops], default=0.0)
        self.height = min(grid.size[-1], 1.15 * highest) if highest > 0 else grid.size[-1]  # air for the words

    def sheet(self, count: int, words: str, below: float) -> Sheet:
        """Panels to scale; those of a long flume one under the other. below: inches for a legend or a colour bar."""
        ratio = self.grid.size[0] / self.height
        columns = 1 if ratio > 4 else min(count, 2 if count in (2, 4) else 3)
        across = {1: 7.5, 2: 4.2, 3: 3.1}[columns]
        size = (across, across / min(ratio, STRETCHED))
        if ratio > STRETCHED:
            words += f"  ·  heights stretched {ratio / STRETCHED:.2g} times"
        page = sheet(count, columns, size, title(self.case), words, margins=(0.62, 0.3, 0.5 + below, 0.95))
        for panel in page.panels:
            panel.limits((0.0, self.grid.size[0]), (0.0, self.height))
        return page

    def draw_water(self, panel: Panel, x: Any, level: Any) -> None:
        """The water under a surface, in front of the ground of the bodies and behind their hatching."""
        drawing.stones(panel, self.porous)
        panel.canvas.under(panel.place(x, level), drawing.SHADE, panel.box)
        drawing.hatches(panel, self.porous)

    def draw_particles(self, panel: Panel, frame: Frame, top: float) -> None:
        """Discs a little larger than the space the particles fill (bulk volume); top: the largest pressure [Pa]."""
        drawing.stones(panel, self.porous)
        drawing.hatches(panel, self.porous)
        chosen = np.arange(len(frame.volume))
        if self.grid.dimension == 3:
            chosen = np.flatnonzero(np.abs(frame.position[:, 1] - self.y) <= 0.5 * self.grid.spacing[1])
        thin = max(1, -(-len(chosen) // DRAWN))
        chosen = chosen[::thin]
        side = (frame.volume[chosen] / frame.porosity[chosen]) ** (1 / self.grid.dimension)
        radius = 0.5 * LARGER * side * np.sqrt(thin * np.prod(panel.scale))
        centres = panel.place(frame.position[chosen, 0], frame.position[chosen, -1])
        panel.canvas.discs(centres, radius, frame.pressure[chosen] / top, drawing.pressures(), panel.box)

    def draw_outlines(self, panel: Panel, time: float, *, dashed: bool = False) -> None:
        """What stands before the water, and the gates as they are at this time [s]."""
        drawing.outline_bodies(panel, self.porous, self.solid, dashed=dashed)
        drawing.draw_gates(panel, self.case.gate, time)


def highest_pressure(frames: Iterable[Frame]) -> float:
    """[Pa], a few outliers left out."""
    return max([1.0, *(float(np.quantile(f.pressure, 0.999)) for f in frames if len(f.pressure))])


def colour_bar(page: Sheet, low: float, high: float, words: str) -> None:
    """A slim bar under the panels, for values from low to high."""
    canvas, left, below = page.canvas, page.panels[0].box[0], page.canvas.box[3]
    width, top = round(min(3.2 * DPI, 0.4 * canvas.box[2])), below - round(0.41 * DPI)
    bottom = top + round(0.09 * DPI)
    table = drawing.pressures()
    canvas.colours[top:bottom, left : left + width] = table[np.linspace(0, len(table) - 1, width).round().astype(int)]
    numbers, texts = drawing.ticks(low, high, 6)
    for number, text in zip(numbers, texts, strict=True):
        x = left + (width - 1) * (number - low) / (high - low)
        canvas.rectangle((int(x), bottom, int(x) + 1, bottom + round(pixels(2.0))), GREY)
        canvas.write(x, bottom + pixels(5.5), text=text, size=8, colour=INK, anchor="mt")
    canvas.write(left + 1.03 * width, (top + bottom) / 2, text=words, size=TEXT, colour=INK, anchor="lm")


def title(case: Any) -> str:
    return case.case.title or case.case.name


def length(value: float) -> str:
    """Two digits where they are nearly right: the grid changes the spacing a little to fill the domain."""
    short = float(f"{value:.2g}")
    value = short if abs(short / value - 1) < 0.005 else value
    return f"{1e3 * value:.3g} mm" if value < 0.1 else f"{value:.3g} m"
