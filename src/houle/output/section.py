"""The vertical section of a case, ready to be drawn on: bodies, gates, scale; and particles coloured by pressure."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Normalize

from houle.frame import Frame
from houle.grid import Grid
from houle.output import drawing
from houle.output.drawing import Sheet, sheet

DRAWN = 40000  # particles in a panel; of more, every k-th is drawn, larger
STRETCHED = 5.5  # longest panel, length over height; a longer flume is stretched upwards


class Section:
    """In 2D the whole case, in 3D its middle section. levels: heights [m] that must be inside the picture."""

    def __init__(self, case: Any, grid: Grid, levels: Iterable[float]) -> None:
        self.case, self.grid = case, grid
        self.y = float(grid.axis_points(1)[grid.shape[1] // 2]) if grid.dimension == 3 else 0.0
        self.porous = drawing.bodies(case.porous, grid, self.y)
        self.solid = drawing.bodies(case.solid, grid, self.y)
        tops = [float(body.outline[:, 1].max()) for body in (*self.porous, *self.solid)]
        self.bands = drawing.bands(case, self.y)
        highest = max([*(float(level) for level in levels), *tops], default=0.0)
        air = 1.35 if self.waves else 1.15  # for the words
        self.height = min(grid.size[-1], air * highest) if highest > 0 else grid.size[-1]

    @property
    def waves(self) -> bool:
        """Whether something makes or damps waves."""
        return self.case.waves is not None or len(self.bands) > 0

    @property
    def still_water(self) -> float:
        """Highest level of the water at the start [m]."""
        tops = []
        for water in self.case.water:
            corners = water.box or water.polygon
            tops.append(water.below if corners is None else max(corner[-1] for corner in corners))
        return float(max(tops))

    def sheet(self, count: int, words: str, below: float) -> Sheet:
        """Panels to scale; those of a long flume one under the other. below: inches for a legend or a colour bar."""
        ratio = self.grid.size[0] / self.height
        columns = 1 if ratio > 4 else min(count, 2 if count in (2, 4) else 3)
        across = {1: 7.5, 2: 4.2, 3: 3.1}[columns]
        size = (across, across / min(ratio, STRETCHED))
        if ratio > STRETCHED:
            words += f"  ·  heights stretched {ratio / STRETCHED:.2g} times"
        return sheet(count, columns, size, title(self.case), words, margins=(0.62, 0.3, 0.5 + below, 0.95))

    def draw(self, panel: Axes, time: float, *, over: bool = False) -> None:
        """Everything that stands still, and the gates as they are at this time [s]."""
        panel.set(xlim=(0, self.grid.size[0]), ylim=(0, self.height))
        panel.spines["right"].set_visible(True)
        panel.locator_params(nbins=5)
        drawing.draw_bodies(panel, self.porous, self.solid, over=over)
        if self.waves:
            drawing.draw_still_water(panel, self.still_water)
            drawing.draw_bands(panel, self.bands)
            if self.case.waves is not None and self.case.waves.source is not None:
                drawing.draw_source(panel, self.case.waves.source.x)
        drawing.draw_gates(panel, self.case.gate, time, self.height)

    def draw_particles(self, panel: Axes, frame: Frame, scale: Normalize) -> EllipseCollection:
        """Discs a little larger than the space the particles fill (bulk volume), so that the water is without gaps."""
        chosen = np.arange(len(frame.volume))
        if self.grid.dimension == 3:
            chosen = np.flatnonzero(np.abs(frame.position[:, 1] - self.y) <= 0.5 * self.grid.spacing[1])
        thin = max(1, -(-len(chosen) // DRAWN))
        chosen = chosen[::thin]
        size = 1.42 * (frame.volume[chosen] / frame.porosity[chosen]) ** (1 / self.grid.dimension) * np.sqrt(thin)
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


def pressure_scale(frames: Iterable[Frame]) -> Normalize:
    """[kPa] from 0 to the largest pressure, a few outliers left out."""
    return Normalize(
        0.0, max([1e-3, *(float(np.quantile(f.pressure, 0.999)) / 1e3 for f in frames if len(f.pressure))])
    )


def colour_bar(page: Sheet, marks: Any, words: str) -> None:
    """A slim bar under the panels."""
    width, height = page.figure.get_size_inches()
    first = page.panels[0].get_position()
    box = page.figure.add_axes((first.x0, 0.32 / height, min(3.2 / width, 0.4), 0.09 / height))
    bar = page.figure.colorbar(marks, cax=box, orientation="horizontal")
    bar.outline.set_visible(False)
    bar.ax.tick_params(length=2, labelsize=8)
    bar.ax.locator_params(nbins=6)
    bar.ax.text(1.03, 0.5, words, transform=bar.ax.transAxes, va="center", fontsize=8.5)


def title(case: Any) -> str:
    return case.case.title or case.case.name


def length(value: float) -> str:
    """Two digits where they are nearly right: the grid changes the spacing a little to fill the domain."""
    short = float(f"{value:.2g}")
    value = short if abs(short / value - 1) < 0.005 else value
    return f"{1e3 * value:.3g} mm" if value < 0.1 else f"{value:.3g} m"
