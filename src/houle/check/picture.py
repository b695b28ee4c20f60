"""The picture of the section that `houle check` draws."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from houle.case.model import Case
from houle.check.boundaries import moving_walls
from houle.check.section import CrossSection
from houle.check.waves import reach
from houle.medium.thin_solids import at_width

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LONGEST = 5.5  # of the picture of a section, its length over its height
ROOM, NAME = 9.0, 1.5  # inches: for a title, for a name
LETTER = 0.8  # of a wide one, of its size


def draw(case: Case, file: Path) -> None:
    """The section of the case as a picture (3D: at mid width): water, bodies, wave maker, sponges, gauges, gates.

    The heights of a long flume are enlarged, by a factor that the picture names.
    """
    import matplotlib

    with matplotlib.rc_context({"text.parse_math": False}):  # names may hold $
        figure = _figure(case)
        figure.savefig(file, dpi=150, format="png", metadata={"Title": f"section of {case.case.name}"})


def _figure(case: Case) -> Figure:
    """The picture of the section, laid out when it is saved."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from houle.output.drawing import fitted

    s = CrossSection(case)
    layer = next(y for y in s.layers if case.dimension == 2 or y[0] <= case.domain.size[1] / 2 <= y[1])
    width, height = case.domain.size[0], case.domain.size[-1]
    enlarged = enlargement(width, height)
    above = max(22.0, 12.0 + _names(case)[1])
    tall = min(9.3 * enlarged * height / width, 9.0) + 1.5 + (above - 22.0) / 72
    figure = Figure(figsize=(10, tall), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    _fill(axes, s.open_water(layer), facecolor="#a9d3ee", edgecolor="none", label="water")
    hatches = ("xx", "\\\\", "//", "..", "oo")
    for i, body in enumerate(s.porous):
        words = f"{body.row.name}, n = {body.row.porosity:g}"
        area = shapely.difference(s.area([body], layer), s.area(s.solid, layer))
        _fill(axes, area, facecolor="none", edgecolor="#8a6d3b", hatch=hatches[i % 5], linewidth=1.2, label=words)
    for box in at_width(s.windows, case.domain.size[1] / 2):
        window = shapely.box(box.lower[0], box.lower[-1], box.upper[0], box.upper[-1])
        _fill(axes, window, facecolor="#bbbbbb", edgecolor="none", label="counts as solid")
    _fill(axes, s.area(s.solid, layer), facecolor="#777777", edgecolor="#333333", label="solid")
    for gate in case.gate:
        face = s.grid.nearest_face(gate.x)
        axes.plot([face, face], [0, height], color="#c0392b", linewidth=3, label=f"gate, {gate.speed:g} m/s", zorder=4)
    for table in case.open:
        side = 0.0 if table.side == "left" else width
        look: Any = {"color": "#1f5f8b", "linewidth": 5, "linestyle": (0, (0.6, 0.8)), "clip_on": False, "zorder": 5}
        axes.plot([side, side], [0, height], label="open side", **look)
    _waves(axes, case, s)
    _gauges(axes, case)
    for sensor in case.sensor:
        axes.plot(sensor.at[0], sensor.at[-1], "o", color="#2c3e50", markersize=5, clip_on=False)
        at = (sensor.at[0], sensor.at[-1])
        fitted(axes.annotate(sensor.name, at, (5, 5), textcoords="offset points", fontsize=8), NAME)
    axes.set(xlim=(0, width), ylim=(0, height), xlabel="x [m]", ylabel="z [m]", aspect=enlarged, anchor="S")
    title = axes.set_title(" ".join((case.case.title or case.case.name).split()), loc="left", pad=above)
    fitted(title, ROOM - 2.2 if enlarged > 1 else ROOM)
    if enlarged > 1:
        axes.set_title(f"heights enlarged {enlarged:g} times", loc="right", pad=above, fontsize=9, color="#5d6d7e")
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    columns = min(5, len(unique))
    place: Any = {"loc": "outside lower center", "ncols": columns, "frameon": False}
    for entry in figure.legend(unique.values(), unique.keys(), **place).get_texts():
        fitted(entry, 9.6 / columns - 0.6)
    return figure


def enlargement(width: float, height: float) -> float:
    """Factor of the heights that makes a section no longer than LONGEST times its height: 1 for most."""
    needed = width / height / LONGEST
    power = 10.0 ** np.floor(np.log10(max(needed, 1.0)))
    return float(next(f * power for f in (1, 2, 3, 4, 5, 6, 8, 10) if needed <= f * power * (1 + 1e-9)))


def _names(case: Case) -> tuple[dict[str, Any], float]:
    """How the names of gauges are written, upright where they would not stand side by side; their height [points]."""
    places = sorted(gauge.x for gauge in case.gauge)
    longest = max([len(gauge.name) for gauge in case.gauge], default=0)
    if all(b - a >= 0.008 * case.domain.size[0] * longest for a, b in pairwise(places)):
        return {"fontsize": 8}, 8.0
    return {"rotation": 90, "fontsize": 6}, min(72 * NAME, 6 * LETTER * longest)


def _gauges(axes: Any, case: Case) -> None:
    """Lines with their names above."""
    from houle.output.drawing import fitted

    look = _names(case)[0]
    for gauge in case.gauge:
        axes.axvline(gauge.x, color="#2c3e50", linestyle="--", linewidth=0.9)
        at = (gauge.x, case.domain.size[-1])
        name = axes.annotate(gauge.name, at, (0, 3), textcoords="offset points", ha="center", va="bottom", **look)
        fitted(name, NAME)


def _waves(axes: Any, case: Case, s: CrossSection) -> None:
    """Zones and sponges hatched, the source dashed where it acts, the still water level; their names at the top."""
    if case.waves is None and not case.sponge and not case.absorber:
        return
    height, colour = case.domain.size[-1], "#4d6f8c"
    axes.axhline(s.depth(), color="#1f5f8b", linewidth=0.8, linestyle=(0, (8, 3)), label="still water level")
    bands = [(p.box[0][0], p.box[1][0], p.name, "//") for p in case.sponge]
    wave = case.wave
    for wall in moving_walls(case, wave, s.depth()):
        name = wall.key.rpartition(".")[2]
        bands.append((*wall.span, name, "|||"))
        axes.axvline(wall.rest, color="#22303c", linewidth=2.2)
    if case.waves is not None and case.waves.piston is None and wave is not None:
        low, high = reach(case, wave)
        source = case.waves.source is not None
        bands.append(
            (
                low,
                high,
                f"source, {case.waves.kind}" if source else f"zone, {case.waves.kind}",
                "" if source else "\\\\",
            )
        )
        if source:
            axes.axvline(case.waves.place, color=colour, linewidth=1.4, linestyle=(0, (5, 2)))
    for low, high, words, hatch in bands:
        axes.axvspan(low, high, facecolor="none", edgecolor=colour, hatch=hatch, linewidth=0, alpha=0.45)
        for x in (low, high):
            axes.axvline(x, color=colour, linewidth=0.6, linestyle="-" if hatch else ":")
        box = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}
        at = ((low + high) / 2, height)
        axes.annotate(
            words, at, (0, -4), textcoords="offset points", ha="center", va="top", fontsize=8, color=colour, bbox=box
        )


def _fill(axes: Any, area: shapely.Geometry, **style: Any) -> None:
    """Polygons with their holes, one legend entry."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    for part in shapely.get_parts(area):
        if part.geom_type != "Polygon" or part.is_empty:
            continue
        rings = [Outline(np.asarray(r.coords), closed=True) for r in (part.exterior, *part.interiors)]
        axes.add_patch(PathPatch(Outline.make_compound_path(*rings), **style))
