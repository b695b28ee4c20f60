"""The vertical section of a case, ready to be drawn on: bodies, gates, scale; and particles coloured by pressure."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D

from houle.flow.snapshot import Snapshot
from houle.grid import FloatArray, Grid
from houle.medium.shapes import shape_of
from houle.medium.thin_solids import at_width, solid_windows
from houle.output import drawing
from houle.output.drawing import Sheet, sheet

WIDER = 1.42  # side of a mark over that of the square the particle fills: the water has no gaps
STRETCHED = 5.5  # longest panel, length over height; a longer flume is stretched upwards
LOW = 0.12  # share of the still water depth below which waves are too low to be seen beside it
SUCTION = 0.1  # of the largest pressure: less is round-off and splashes
CLOSE = 1.6  # heights of such waves that are shown above and below still water


class Section:
    """In 2D the whole case, in 3D its middle section. levels: heights [m] that must be inside the picture."""

    def __init__(self, case: Any, grid: Grid, levels: Iterable[float]) -> None:
        self.case, self.grid = case, grid
        self.y = float(grid.axis_points(1)[grid.shape[1] // 2]) if grid.dimension == 3 else 0.0
        self.porous = drawing.bodies(case.porous, grid, self.y)
        self.solid = drawing.bodies(case.solid, grid, self.y)
        self.thickened = at_width(solid_windows(grid, [shape_of(s, grid.dimension) for s in case.solid]), self.y)
        tops = [float(body.outline[:, 1].max()) for body in (*self.porous, *self.solid)]
        self.bands = drawing.bands(case, self.y)
        highest = max([*(float(level) for level in levels), *tops], default=0.0)
        air = 1.35 if self.waves else 1.15  # for the words
        self.floor, self.height = 0.0, min(grid.size[-1], air * highest) if highest > 0 else grid.size[-1]

    def look_close(self, eta: FloatArray) -> None:
        """Shows the surface only, if what moves in eta [m] are low waves."""
        moved = float(np.nanmax(np.abs(eta - self.still_water), initial=0.0))
        if self.waves and 0.0 < 2 * moved < LOW * self.still_water:
            self.floor, self.height = (self.still_water + s * 2 * CLOSE * moved for s in (-1, 1))

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
        ratio = self.grid.size[0] / (self.height - self.floor)
        columns = 1 if ratio > 4 else min(count, 2 if count in (2, 4) else 3)
        across = {1: 7.5, 2: 4.2, 3: 3.1}[columns]
        size = (across, across / min(ratio, STRETCHED))
        if ratio > STRETCHED:
            times = ratio / STRETCHED
            words += f"  ·  heights stretched {round(times, 1 if times < 10 else None):g} times"
        left = 0.78 if self.floor else 0.62  # for numbers of more digits
        return sheet(count, columns, size, title(self.case), words, margins=(left, 0.3, 0.5 + below, 0.95))

    def draw(self, panel: Axes, time: float, *, over: bool = False) -> list[Line2D]:
        """Everything that stands still, and the gates as they are at this time [s], which are returned."""
        panel.set(xlim=(0, self.grid.size[0]), ylim=(self.floor, self.height))
        panel.spines["right"].set_visible(True)
        drawing.draw_thickened(panel, self.thickened)
        drawing.draw_bodies(panel, self.porous, self.solid, over=over)
        if self.waves:
            drawing.draw_still_water(panel, self.still_water)
            drawing.draw_bands(panel, self.bands)
            if self.case.waves is not None and self.case.waves.source is not None:
                drawing.draw_source(panel, self.case.waves.source.x)
        drawing.draw_open(panel, self.case.open, self.grid.size[0])
        return drawing.draw_gates(panel, self.case.gate, time, self.height)

    def draw_paddles(self, panel: Axes, wet: FloatArray) -> None:
        """Moving walls, where the water ends: wet are the places x [m] of it."""
        waves = self.case.waves
        sides = {absorber.side for absorber in self.case.absorber}
        sides |= {"left"} if waves is not None and waves.piston is not None else set()
        if len(wet):
            ends = {"left": (0.0, float(wet.min())), "right": (self.grid.size[0], float(wet.max()))}
            drawing.draw_paddles(panel, [ends[side] for side in sorted(sides)])

    def draw_particles(self, panel: Axes, frame: Snapshot, scale: Normalize) -> AxesImage:
        """The image of `pressures` at the pixels of the panel; for the next frame, set_data() is enough."""
        box = panel.get_window_extent()
        pixels = (round(box.width / panel.figure.dpi * drawing.DPI), round(box.height / panel.figure.dpi * drawing.DPI))
        extent = (0.0, self.grid.size[0], 0.0, self.height)
        look: Any = {"origin": "lower", "aspect": "auto", "interpolation": "nearest", "zorder": 2}
        return panel.imshow(self.pressures(frame, pixels), cmap=drawing.pressures(), norm=scale, extent=extent, **look)

    def pressures(self, frame: Snapshot, pixels: tuple[int, int]) -> FloatArray:
        """[kPa] at the pixels (z, x) of a panel, NaN where no water is.

        A particle covers a rectangle a little larger than the space it fills (bulk volume); where they overlap, the
        mean is taken. All have the size of the middle one.
        """
        chosen = np.arange(len(frame.volume))
        if self.grid.dimension == 3:
            chosen = np.flatnonzero(np.abs(frame.position[:, 1] - self.y) <= 0.5 * self.grid.spacing[1])
        volume = frame.volume[chosen] / frame.porosity[chosen]
        side = float(np.median(volume)) ** (1 / self.grid.dimension) if len(chosen) else 0.0
        x, z = frame.position[chosen, 0], frame.position[chosen, -1]
        at = [
            np.floor(p * (n / size))
            for p, n, size in zip((x, z), pixels, (self.grid.size[0], self.height), strict=True)
        ]
        inside = (at[0] >= 0) & (at[0] < pixels[0]) & (at[1] >= 0) & (at[1] < pixels[1])
        pixel = (at[0] * pixels[1] + at[1])[inside].astype(np.int64)
        all_pixels = pixels[0] * pixels[1]
        count = np.asarray(np.bincount(pixel, minlength=all_pixels), float).reshape(pixels)
        weights = frame.pressure[chosen][inside] / 1e3
        total = np.asarray(np.bincount(pixel, weights, all_pixels), float).reshape(pixels)
        for axis, length_of_axis in enumerate((self.grid.size[0], self.height)):
            reach = int(np.ceil(0.5 * (WIDER * side / length_of_axis * pixels[axis] - 1.0)))
            count, total = _spread(count, reach, axis), _spread(total, reach, axis)
        return np.divide(total, count, out=np.full(pixels, np.nan), where=count > 0.5).T


def _spread(values: FloatArray, reach: int, axis: int) -> FloatArray:
    """Sum over the neighbours within `reach` along an axis."""
    if reach <= 0:
        return values
    wide = np.pad(values, [(reach + 1, reach) if a == axis else (0, 0) for a in range(values.ndim)])
    sums = np.moveaxis(np.cumsum(wide, axis=axis), axis, 0)
    return np.moveaxis(sums[2 * reach + 1 :] - sums[: -2 * reach - 1], 0, axis)


def pressure_scale(frames: Iterable[Snapshot]) -> Normalize:
    """[kPa] from 0, or from the suction in closed ducts, to the largest pressure; a few outliers left out."""
    ends = np.array([np.quantile(f.pressure, (0.01, 0.999)) / 1e3 for f in frames if len(f.pressure)]).reshape(-1, 2)
    high = float(max([1e-3, *ends[:, 1]]))
    low = float(min([0.0, *ends[:, 0]]))
    return Normalize(low if low < -SUCTION * high else 0.0, high)


def colour_bar(page: Sheet, marks: Any, words: str, mathematics: bool = False) -> None:
    """A slim bar under the panels; `mathematics`: between dollars in the words."""
    width, height = page.figure.get_size_inches()
    first = page.panels[0].get_position()
    bar = page.figure.add_axes((first.x0, 0.32 / height, min(3.2 / width, 0.4), 0.09 / height))
    low, high = marks.get_clim()
    bar.imshow(np.linspace(low, high, 256)[None], cmap=marks.cmap, extent=(low, high, 0.0, 1.0), aspect="auto")
    bar.set_yticks([])
    bar.set_frame_on(False)
    bar.tick_params(length=2)
    bar.locator_params(axis="x", nbins=6)
    bar.text(1.03, 0.5, words, transform=bar.transAxes, va="center", parse_math=mathematics)


def title(case: Any) -> str:
    return case.case.title or case.case.name


def length(value: float) -> str:
    """Two digits where they are nearly right: the grid changes the spacing a little to fill the domain."""
    short = float(f"{value:.2g}")
    value = short if abs(short / value - 1) < 0.005 else value
    return f"{1e3 * value:.3g} mm" if value < 0.1 else f"{value:.3g} m"
