"""The picture of the section of a case: one painter for `houle check`, the pictures of a run, reports and films.

In 2D it shows the whole case, in 3D its middle section: the water or what a run computed, porous bodies hatched, solids
filled and the windows of thin solids paler, gates, open sides, moving walls, what makes or damps waves, still water,
gauges and sensors. Bodies are named in the key under the panels and not on them, so that no word covers a structure.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path as Outline

from houle.case.acting import Band, acting, walls_at_rest
from houle.case.model import Case
from houle.case.section import CrossSection, Entry
from houle.flow.snapshot import Snapshot
from houle.grid import FloatArray
from houle.medium.sections import Span
from houle.medium.shapes import polygons
from houle.medium.thin_solids import at_width
from houle.output import drawing
from houle.output.drawing import FAINT, GREY, INK, PALE, SHADE, SMALL, SOLID, STONE, STONE_LINE, WATER, Sheet, sheet
from houle.output.labels import apart, leader, near_points
from houle.output.pressure import pressure_image

LONGEST = 5.5  # length of a panel over its height; the heights of a longer flume are stretched
STRETCHES = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)  # and ten, a hundred, ... times as much
ACROSS = {1: 7.5, 2: 4.2, 3: 3.1}  # width of a panel [inches], by the number of columns
TALLEST = {1: 6.5, 2: 4.2, 3: 3.6}  # largest height of a panel [inches]
LOW = 0.12  # share of the still water depth below which waves are too low to be seen beside it
ROUND_OFF = 1e-3  # share of the still water depth below which waves are not told from round-off
CLOSE = 1.6  # height shown above and below still water, in heights of low waves
HATCHES = ("////", "\\\\\\\\", "....", "xxxx", "oo", "||||", "----", "++")
UPRIGHT = 6.0  # size of names that stand upright [points]
LONGEST_NAME = 1.0  # longest name of a gauge or sensor [inches]
MOST_NAMES = 40  # sensors up to which they have names, not only marks
ASIDE = 8.0  # distance of a name from its gauge [points] from which on all names stand upright
NAMES_RISE = 6.0  # points from a panel to the names above it


class SectionPicture:
    """A picture of the section of a case, between two heights [m].

    levels are heights that must be inside; without them the whole tank is shown, up to its lid.
    """

    def __init__(self, case: Case, levels: Iterable[float] | None = None) -> None:
        self.case, self.section = case, CrossSection(case)
        self.grid = grid = self.section.grid
        self.y = float(grid.axis_points(1)[grid.shape[1] // 2]) if grid.dimension == 3 else 0.0
        self.layer = _layer_at(self.section.layers, self.y, grid.dimension)
        self.solid = self.section.area(self.section.solid, self.layer)
        self.porous = [self._body(entry) for entry in self.section.porous]
        self.windows = at_width(self.section.windows, self.y)
        self.bands = acting(case, self.section.depth(), self.y)
        self.still_water = self._still_water()
        self.floor, self.height = 0.0, self._height(levels)

    def _body(self, entry: Entry) -> shapely.Geometry:
        return shapely.difference(self.section.area([entry], self.layer), self.solid)

    def _still_water(self) -> float | None:
        """Level of the water at the start [m]; None if there are several and no waves, or the water reaches the lid."""
        level, near = self.section.depth(), 1e-3 * self.grid.spacing[-1]
        one = self.waves or self.section.drop() < near
        return level if one and 0.0 < level < self.grid.size[-1] - near else None

    def _height(self, levels: Iterable[float] | None) -> float:
        """Top of the picture [m], with air for the words."""
        if levels is None:
            return self.grid.size[-1]
        bodies = [float(shapely.bounds(area)[3]) for area in (self.solid, *self.porous) if not area.is_empty]
        highest = max([*(float(level) for level in levels), *bodies], default=0.0)
        air = 1.35 if self.waves else 1.15
        return min(self.grid.size[-1], air * highest) if highest > 0 else self.grid.size[-1]

    @property
    def waves(self) -> bool:
        """True where something makes or damps waves."""
        return self.case.waves is not None or len(self.bands) > 0

    def look_close(self, eta: FloatArray) -> None:
        """Shows only the surface if its levels eta [m] are those of low waves."""
        if self.still_water is None or not self.waves:
            return
        moved = float(np.nanmax(np.abs(eta - self.still_water), initial=0.0))
        if 0.0 < 2 * moved < LOW * self.still_water:
            moved = max(moved, ROUND_OFF * self.still_water)
            self.floor, self.height = (self.still_water + s * 2 * CLOSE * moved for s in (-1, 1))

    # ---- sheets --------------------------------------------------------------------------------------------------

    def sheet(self, count: int, words: str, key: Sequence[Any] = (), below: float = 0.0) -> Sheet:
        """A sheet of panels to scale, those of a long flume one under the other, over a key of the marks and of `key`.

        below: inches for a colour bar between panels and key; the key ends `key_top` inches above the lower edge.
        """
        ratio = self.grid.size[0] / (self.height - self.floor)
        columns = 1 if ratio > 4 else min(count, 2 if count in (2, 4) else 3)
        across = min(ACROSS[columns], TALLEST[columns] * ratio)
        times = stretch(ratio)
        if times > 1.0:
            words += f"  ·  heights stretched {times:g} times"
        left, right = 0.78 if self.floor else 0.62, 0.3  # on the left for numbers of more digits
        self.marks = [*key, *self.key()]
        room = max(left + columns * across + (columns - 1) * 0.3 + right, 6.0) - left - 0.2
        self.key_top = drawing.key_height(self.marks, room) + 0.1
        self.names = _Names(self.case, across)
        margins = (left, right, 0.5 + self.key_top + below, 0.95 + self.names.height / 72)
        return sheet(count, columns, (across, across / ratio * times), self.case.title, words, margins=margins)

    def key(self) -> list[Any]:
        """Entries of the key: everything that the picture shows, in the order of the case file."""
        found: list[Any] = []
        for entry, hatch in self._hatched():
            words = f"{entry.row.name}, n = {entry.row.porosity:g}"
            found.append(Patch(fc=STONE, ec=STONE_LINE, hatch=hatch, lw=0.9, label=words))
        if not self.solid.is_empty:
            found.append(Patch(fc=SOLID, ec=GREY, lw=0.7, label="solid"))
        if self.windows:
            found.append(Patch(fc=PALE, ec="none", label="counts as solid"))
        for speed in dict.fromkeys(gate.speed for gate in self.case.gate):
            found.append(Line2D([], [], color=INK, lw=1.6, label=f"gate, {speed:g} m/s"))
        if self.case.open:
            found.append(Line2D([], [], color=INK, lw=2.4, ls=(0, (0.6, 1.0)), label="open side"))
        if self.still_water is not None:
            found.append(Line2D([], [], color=GREY, lw=0.8, ls=(0, (8, 3)), label="still water level"))
        if self.case.gauge:
            found.append(Line2D([], [], color=INK, lw=0.7, ls=(0, (4, 2)), label="gauge"))
        if self.case.sensor:
            found.append(Line2D([], [], color=INK, marker="o", ms=3.4, mec="white", mew=0.6, ls="none", label="sensor"))
        return found

    def _hatched(self) -> list[tuple[Entry, str]]:
        """The porous bodies that the section meets, and the hatch of each."""
        there = [entry for entry, area in zip(self.section.porous, self.porous, strict=True) if not area.is_empty]
        return [(entry, HATCHES[i % len(HATCHES)]) for i, entry in enumerate(there)]

    # ---- panels --------------------------------------------------------------------------------------------------

    def draw(self, panel: Axes, time: float, *, over: bool = False, wet: FloatArray | None = None) -> list[Line2D]:
        """Draws the section and returns its gates, lifted as at this time [s].

        over: the outlines of bodies are dashed, over water that is drawn by others. wet: places x [m] of the water,
        which moving walls touch; None: the walls are at rest.
        """
        panel.set(xlim=(0, self.grid.size[0]), ylim=(self.floor, self.height))
        panel.spines["right"].set_visible(True)
        panel.spines["top"].set_visible(self.height >= (1.0 - 1e-9) * self.grid.size[-1])  # the lid of the tank
        self._draw_bodies(panel, over)
        if self.still_water is not None:
            self._draw_still_water(panel, self.still_water)
        _draw_bands(panel, self.bands)
        for x in [self.case.waves.place] if self.case.waves is not None and self.case.waves.source is not None else []:
            panel.axvline(x, color=INK, lw=0.9, ls=(0, (5, 3)), zorder=2.6)
        self.draw_walls(panel, wet)
        self._draw_open(panel)
        for gauge in self.case.gauge:
            panel.axvline(gauge.x, color=INK, lw=0.7, ls=(0, (4, 2)), zorder=3.4)
        at = self._sensors()
        panel.plot(*at.T, "o", color=INK, ms=3.4, mec="white", mew=0.6, zorder=4.6, clip_on=False)
        return self.draw_gates(panel, time)

    def _draw_bodies(self, panel: Axes, over: bool) -> None:
        areas = dict(zip((entry.key for entry in self.section.porous), self.porous, strict=True))
        for entry, hatch in self._hatched():
            area, dash = areas[entry.key], (0, (4, 2)) if over else "-"
            _fill(panel, area, fc=STONE, ec="none", zorder=0.5)
            _fill(panel, area, fc="none", ec=STONE_LINE, hatch=hatch, lw=0.0, alpha=0.55, zorder=2.2)
            _fill(panel, area, fc="none", ec=STONE_LINE, lw=0.9, ls=dash, zorder=4 if over else 2.5)
        for window in self.windows:
            (x0, *_, z0), (x1, *_, z1) = window.lower, window.upper
            _fill(panel, shapely.box(x0, z0, x1, z1), fc=PALE, ec="none", zorder=3.9)
        _fill(panel, self.solid, fc=SOLID, ec=GREY, lw=0.7, zorder=4)

    def draw_water(self, panel: Axes) -> None:
        """Draws the water at the start, with its edge if it has more than one level."""
        edge = WATER if self.still_water is None else "none"
        _fill(panel, self.section.open_water(self.layer), fc=SHADE, ec=edge, lw=0.7, zorder=0.55)

    def _draw_still_water(self, panel: Axes, level: float) -> None:
        """Draws the still water level: a dashed line with the triangle that marks water levels."""
        panel.axhline(level, color=GREY, lw=0.8, ls=(0, (8, 3)), zorder=2.3)
        first = walls_at_rest(self.case).get("left", 0.0)
        look: Any = {"xycoords": "data", "textcoords": "offset points", "color": GREY, "zorder": 4.7, "fontsize": SMALL}
        panel.annotate("\u25bd", (first, level), (7, -0.5), ha="center", va="bottom", **look)

    def draw_walls(self, panel: Axes, wet: FloatArray | None) -> None:
        """Draws the walls that move, and the dry space behind them."""
        size = self.grid.size[0]
        for side, rest in walls_at_rest(self.case).items():
            if wet is not None and not len(wet):
                continue
            x = rest if wet is None else float(wet.min() if side == "left" else wet.max())
            end = 0.0 if side == "left" else size
            panel.axvspan(min(end, x), max(end, x), fc=FAINT, ec="none", zorder=2.5)
            panel.axvline(x, color=INK, lw=1.6, zorder=4.2)

    def _draw_open(self, panel: Axes) -> None:
        """Draws dots along the sides through which water comes and goes."""
        look: Any = {"color": INK, "lw": 2.4, "ls": (0, (0.6, 1.0)), "zorder": 6, "clip_on": False}
        for side in self.case.open:
            x = 0.0 if side.side == "left" else self.grid.size[0]
            panel.plot([x, x], [0.0, 1.0], transform=panel.get_xaxis_transform(), **look)

    def draw_gates(self, panel: Axes, time: float) -> list[Line2D]:
        """Draws the gates that are still in the picture, lifted as at this time [s], and returns them."""
        feet = [(self.grid.nearest_face(gate.x), max(0.0, time - gate.start) * gate.speed) for gate in self.case.gate]
        look: Any = {"color": INK, "lw": 1.6, "solid_capstyle": "butt", "zorder": 5}
        return [panel.plot([x, x], [foot, self.height], **look)[0] for x, foot in feet if foot < self.height]

    def draw_particles(self, panel: Axes, frame: Snapshot, scale: Normalize) -> AxesImage:
        """The image of `pressures` at the pixels of the panel; for the next frame, set_data() is enough."""
        box = panel.get_window_extent()
        pixels = (round(box.width / panel.figure.dpi * drawing.DPI), round(box.height / panel.figure.dpi * drawing.DPI))
        extent = (0.0, self.grid.size[0], 0.0, self.height)
        look: Any = {"origin": "lower", "aspect": "auto", "interpolation": "nearest", "zorder": 2}
        return panel.imshow(self.pressures(frame, pixels), cmap=drawing.pressures(), norm=scale, extent=extent, **look)

    def pressures(self, frame: Snapshot, pixels: tuple[int, int]) -> FloatArray:
        """Pressure [kPa] at the pixels (z, x) of a panel, NaN where no water is."""
        return pressure_image(frame, self.grid, self.y, self.height, pixels)

    # ---- names ---------------------------------------------------------------------------------------------------

    def name(self, page: Sheet) -> None:
        """Writes the names of gauges, sensors, makers and dampers in the panels of the first row, and the key."""
        for panel in page.panels[: page.columns]:
            self.names.draw(panel)
            _name_bands(panel, self.bands)
        self._name_sensors(page.panels[0])
        page.key(self.marks)

    def raised(self, page: Sheet, panel: int) -> float:
        """Points by which the heading of a panel stands higher, over the names."""
        return self.names.height if panel < page.columns else 0.0

    def _sensors(self) -> FloatArray:
        """Places (N, 2) [m] of the sensors that the picture shows."""
        at = np.array([(s.at[0], s.at[-1]) for s in self.case.sensor], float).reshape(-1, 2)
        return at[(at[:, 1] >= self.floor) & (at[:, 1] <= self.height)]

    def _name_sensors(self, panel: Axes) -> None:
        at = self._sensors()
        names = [s.name for s in self.case.sensor if self.floor <= s.at[-1] <= self.height]
        if not 0 < len(at) <= MOST_NAMES:
            return
        size = 72.0 * np.array(drawing.panel_size(panel))
        scale = size / [self.grid.size[0], self.height - self.floor]
        points = (at - [0.0, self.floor]) * scale
        look: Any = {"xycoords": "axes points", "ha": "center", "va": "center", "fontsize": SMALL, "zorder": 6.5}
        look["bbox"] = {"fc": "white", "ec": "none", "alpha": 0.75, "pad": 0.6}
        made = [panel.annotate(name, (0.0, 0.0), color=INK, **look) for name in names]
        wide = [min(72 * LONGEST_NAME, drawing.text_length(drawing.fitted(text, LONGEST_NAME))) for text in made]
        sizes = np.stack([np.array(wide), np.full(len(wide), 1.1 * SMALL)], axis=1)
        bodies = shapely.union_all([self.solid, *self.porous])
        bodies = shapely.transform(bodies, lambda corner: (corner - [0.0, self.floor]) * scale)
        lines = [gauge.x * scale[0] for gauge in self.case.gauge]
        middles = near_points(points, sizes, (float(size[0]), float(size[1])), bodies, lines)
        for text, point, middle, words in zip(made, points, middles, sizes, strict=True):
            text.xy = tuple(middle)
            text.set_position(tuple(middle))
            if (line := leader(point, middle, words)) is not None:
                ends = line / size
                panel.plot(*ends.T, color=GREY, lw=0.5, transform=panel.transAxes, zorder=4.5)


class _Names:
    """The names of gauges above a panel of a width [inches]: side by side, or upright where these would overlap.

    height is what they take above the panel [points]. Where there are too many, some are left out.
    """

    def __init__(self, case: Case, across: float) -> None:
        room, length = 72.0 * across, case.domain.size[0]
        gauges = sorted(case.gauge, key=lambda gauge: gauge.x)
        longest = max((len(gauge.name) for gauge in gauges), default=0)
        wide = [0.66 * SMALL * len(gauge.name) + 4.0 for gauge in gauges]
        at = [gauge.x / length * room for gauge in gauges]
        aside = apart(at, wide, 0.0, room) if gauges else []
        self.upright = max(map(abs, aside), default=0.0) > ASIDE or longest * 0.66 * SMALL > 72
        if self.upright:
            each = 1.3 * UPRIGHT
            step = max(1, int(np.ceil(len(gauges) * each / room)))
            gauges, wide = gauges[::step], [each] * len(gauges[::step])
        self.gauges, self.wide = gauges, wide
        self.points = UPRIGHT if self.upright else SMALL
        tall = min(72 * LONGEST_NAME, 0.72 * UPRIGHT * longest) if self.upright else 1.2 * SMALL
        self.height = tall + NAMES_RISE if gauges else 0.0

    def draw(self, panel: Axes) -> None:
        """Writes the names above the panel, with a line from each to its gauge."""
        if not self.gauges:
            return
        width, tall = (72.0 * side for side in drawing.panel_size(panel))
        low, high = panel.get_xlim()
        at = [(gauge.x - low) / (high - low) * width for gauge in self.gauges]
        shifts = apart(at, self.wide, 0.5 * self.wide[0], width - 0.5 * self.wide[-1])
        look: Any = {"xycoords": "axes points", "ha": "center", "va": "bottom", "annotation_clip": False}
        look |= {"rotation": 90} if self.upright else {}
        for gauge, x, shift in zip(self.gauges, at, shifts, strict=True):
            name = panel.annotate(gauge.name, (x + shift, tall + NAMES_RISE - 1.0), fontsize=self.points, **look)
            drawing.fitted(name, LONGEST_NAME)
            ends = np.array([[x, tall], [x + shift, tall + NAMES_RISE - 2.0]]) / [width, tall]
            panel.plot(*ends.T, color=INK, lw=0.6, transform=panel.transAxes, clip_on=False, zorder=3.4)


def draw(case: Case, file: Path) -> Path:
    """Writes the picture of the section of a case that `houle check` leaves."""
    with drawing.style():
        return case_sheet(case).save(file)


def case_sheet(case: Case) -> Sheet:
    """The section of a case up to the lid of the tank, with the water at the start."""
    picture = SectionPicture(case)
    words = f"section, spacing {length(max(picture.grid.spacing))}"
    if picture.grid.dimension == 3:
        words += f"  ·  at y = {picture.y:.3g} m of {picture.grid.size[1]:g} m"
    water = Patch(fc=SHADE, ec=WATER, lw=0.7, label="water")
    page = picture.sheet(1, words, [water])
    (panel,) = page.panels
    picture.draw_water(panel)
    picture.draw(panel, 0.0)
    page.label_outside("x [m]", "z [m]")
    picture.name(page)
    return page


def stretch(ratio: float) -> float:
    """Factor of the heights that makes a panel of this length over height no longer than LONGEST; 1 for most."""
    needed = ratio / LONGEST
    power = 10.0 ** np.floor(np.log10(max(needed, 1.0)))
    return float(next(f * power for f in STRETCHES if needed <= f * power * (1 + 1e-9)))


def _layer_at(layers: Sequence[Span], y: float, dimension: int) -> Span:
    return next(span for span in layers if dimension == 2 or span[0] <= y <= span[1])


def _draw_bands(panel: Axes, bands: Sequence[Band]) -> None:
    """Draws thin lines around the stretches in which waves are made or damped."""
    for band in bands:
        if band.hatch:
            panel.axvspan(band.low, band.high, fc="none", ec=GREY, hatch=band.hatch, lw=0, alpha=0.6, zorder=2.4)
        for x in (band.low, band.high):
            panel.axvline(x, color=GREY, lw=0.6, ls="-" if band.hatch else ":", zorder=2.4)


def _name_bands(panel: Axes, bands: Sequence[Band]) -> None:
    """Writes the names of these stretches at the top of the panel."""
    if not bands:
        return
    width, tall = (72.0 * side for side in drawing.panel_size(panel))
    low, high = panel.get_xlim()
    ground = {"fc": "white", "ec": "none", "alpha": 0.85, "pad": 0.8}
    look: Any = {"xycoords": "axes points", "ha": "center", "va": "top", "fontsize": SMALL, "zorder": 5, "bbox": ground}
    names = [panel.annotate(band.words, (0.0, tall - 3.0), color=INK, **look) for band in bands]
    wide = [drawing.text_length(drawing.fitted(name, width / 72 / len(names))) + 5.0 for name in names]
    at = [((band.low + band.high) / 2 - low) / (high - low) * width for band in bands]
    order = np.argsort(at)
    ends = 0.5 * wide[order[0]], width - 0.5 * wide[order[-1]]
    for name, x, shift in zip(names, at, apart(at, wide, *ends), strict=True):
        name.xy = (x + shift, tall - 3.0)
        name.set_position(name.xy)


def _fill(panel: Axes, area: shapely.Geometry, **look: Any) -> None:
    """Fills polygons with holes."""
    for part in polygons(area):
        rings = [Outline(np.asarray(r.coords), closed=True) for r in (part.exterior, *part.interiors)]
        panel.add_patch(PathPatch(Outline.make_compound_path(*rings), **look))


def length(value: float) -> str:
    """A length in words, with two digits if they are nearly right: the grid fits the spacing to the domain."""
    short = float(f"{value:.2g}")
    value = short if abs(short / value - 1) < 0.005 else value
    return f"{1e3 * value:.3g} mm" if value < 0.1 else f"{value:.3g} m"
