"""A structure on which forces are observed, as a wall under attack: its loads and its heel, seen along the waves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from houle.case.section import CrossSection
from houle.case.shapes import shape_of
from houle.grid import FloatArray
from houle.medium.shapes import polygons
from houle.results.answers.structure import Outline, Wall

if TYPE_CHECKING:
    import shapely

    from houle.case.tables.observed import Force
    from houle.results.answers.given import Given
    from houle.results.answers.structure import Sea

CLEAR = 0.25  # spacings above the ground from which on water is under a body


def wall_of(given: Given, row: int, table: Force) -> Wall:
    """The structure of a [[force]] in a sea."""
    sea = given.sea
    assert sea is not None
    if table.side is not None:
        return _side(given, row, table, sea)
    area = _area(given, table)
    x0, z0, x1, _ = area.bounds
    direction = 1.0 if 0.5 * (x0 + x1) > sea.maker else -1.0
    corners = np.array(_corners(area))
    base = corners[corners[:, 1] < z0 + 1e-6][:, 0]
    toe, heel = (base.min(), base.max()) if direction > 0 else (base.max(), base.min())
    at = table.heel if table.heel is not None else (float(heel), float(z0))
    top = corners[corners[:, 1] > corners[:, 1].max() - 1e-6][:, 0]
    loads = _loads(given, row, direction, at)
    return Wall(
        table.name, float(toe), float(top.mean()), float(abs(heel - toe)), _water_under(given, area, direction),
        *loads, _about(at), float(direction * (at[0] - area.centroid.x)),
    )  # fmt: skip


def _side(given: Given, row: int, table: Force, sea: Sea) -> Wall:
    """A side of the tank as a wall that stands on the bed in front of it and reaches up to the lid."""
    x = given.case.domain.size[0] if table.side == "right" else 0.0
    direction = 1.0 if x > sea.maker else -1.0
    h = given.case.domain.spacing
    depth = float(np.nanmin(CrossSection(given.case).standing(np.array([x - direction * h]))[0]))
    lid = given.case.domain.size[-1]
    outline = Outline(
        "wall", x, lid - sea.level, 0.0, depth, False, 0.0, lid - sea.level, False, on_berm=depth, foot=depth,
        words=f"side {table.side!r} of the tank, depth {depth:.3g} m",
    )  # fmt: skip
    at = (float(given.series["structure_about_x"].values[row]), float(given.series["structure_about_z"].values[row]))
    loads = _loads(given, row, direction, at)
    return Wall(table.name, x, x, 0.0, False, *loads, _about(at), 0.0, outline)


def _area(given: Given, table: Force) -> shapely.Geometry:
    """The section of the structure."""
    named = {**{b.name: b for b in given.case.porous}, **{b.name: b for b in given.case.solid}}
    size = given.case.domain.size
    return shape_of(named[str(table.body)], given.case.dimension).section((0.0, 0.0, size[0], size[-1]))


def _corners(area: shapely.Geometry) -> list[tuple[float, float]]:
    """Corners of an area, of all its parts."""
    return [(float(x), float(z)) for part in polygons(area) for x, z in part.exterior.coords]


def _loads(
    given: Given, row: int, direction: float, at: tuple[float, ...]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Horizontal force in a direction, upward force, moment about a point, each (T,) and per metre of width."""
    force = given.record("force", row) / given.width
    moment = given.record("moment", row) / given.width
    moment = moment if moment.ndim == 1 else moment[:, 1]
    x, z = (float(given.series[f"structure_about_{axis}"].values[row]) for axis in "xz")
    moved = moment - (at[-1] - z) * force[:, 0] + (at[0] - x) * force[:, -1]
    return direction * force[:, 0], force[:, -1], direction * moved


def _water_under(given: Given, area: shapely.Geometry, direction: float) -> bool:
    """True if water can reach the underside of a structure: open space or a porous body, no floor and no solid."""
    section = CrossSection(given.case)
    x0, z0, x1, _ = area.bounds
    below = z0 - CLEAR * section.grid.spacing[-1]
    if below <= 0.0:
        return False
    import shapely as geometry

    line = geometry.LineString([(x0, below), (x1, below)])
    layer = section.layers[len(section.layers) // 2]
    return bool(geometry.difference(line, section.area(section.solid, layer)).length > 0.5 * (x1 - x0))


def _about(at: tuple[float, ...]) -> str:
    return f"moment about ({at[0]:.4g}, {at[-1]:.4g}) m, positive when it tips the structure landward"
