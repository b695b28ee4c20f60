"""The section in front of a crest as published formulas see it: slope, mound or wall, freeboard, toe, crest width.

The drawing of the case is looked at along upright lines, a quarter of a spacing apart, from the crest seawards. Ground
is steep from 1:10 on, what is flatter and not between steep parts is foreshore (EurOtop 2018, section 5.3); flat parts
up to a quarter of the deep-water wavelength are a berm. The slope is that of the front between 1.5 H_m0 below still
water, or the toe, and 1.5 H_m0 above, or the crest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from houle.case.section import CrossSection
from houle.errors import CaseError
from houle.grid import FloatArray
from houle.results.answers.structure import Outline, Sea

if TYPE_CHECKING:
    from houle.case.model import Case

FINE = 4  # upright lines in a spacing
STEEP = 0.1  # slope from which ground belongs to the structure
FLAT = 1 / 15  # slope up to which a part of the front is a berm
WALL = 0.2  # cotangent up to which a front counts as a wall
REACH = 1.5  # wave heights above and below still water between which the slope is taken
NEAR = 0.3  # wave heights about still water in which a wall is told from a slope
CREST = 0.5  # spacings by which a crest may lie lower and still be level


class OutlineError(CaseError):
    """The section in front of a crest is none that a formula knows; the message says why."""


@dataclass(frozen=True)
class Profile:
    """The ground seen from above along distances seaward of the crest (N,) [m]: its top and that of the solids alone.

    Heights are above still water. direction: +1 where the waves travel to larger x; x: of the crest;
    level: of still water above z = 0.
    """

    away: FloatArray
    top: FloatArray
    solid: FloatArray
    x: float
    direction: float
    step: float
    level: float

    def place(self, away: float) -> float:
        """The place x [m] at a distance seaward of the crest."""
        return self.x - self.direction * away

    def reaches(self, level: float, top: FloatArray | None = None) -> float:
        """Distance [m] of the seaward end of the ground around the crest that is as high as a level."""
        low = np.flatnonzero((self.top if top is None else top) < level)
        first = int(low[0]) if len(low) else len(self.away) - 1
        if first == 0:
            return 0.0
        a, b = (float(self.top[i]) for i in (first - 1, first))
        share = (a - level) / (a - b) if a > b else 0.5
        return float(self.away[first - 1] + share * self.step)


def outline_of(case: Case, sea: Sea, x: float) -> Outline:
    """The section seaward of a crest at x [m]. Raises OutlineError where it is none that a formula knows."""
    section = CrossSection(case)
    profile = _profile(section, sea, x)
    emerged = profile.top >= 0.0
    if not emerged[0]:
        raise OutlineError(f"at x = {x:g} m nothing stands above still water")
    end = int(np.argmin(emerged)) if not emerged.all() else 0
    if end == 0:
        raise OutlineError(f"between the maker and x = {x:g} m there is no water")
    crest = float(profile.top[:end].max())
    toe = _toe(profile, end, 1.56 * sea.period**2 / 4)
    armour, width = _armour(profile, end, crest, CREST * case.domain.spacing)
    depth = -float(profile.top[min(toe + 1, len(profile.top) - 1)])
    height = sea.height if isfinite(sea.height) else depth
    cot, berm = _slope(profile, max(-depth, -REACH * height), min(armour, REACH * height))
    face = profile.reaches(0.0)
    kind = "slope" if _solid_at(profile, face) else "mound"
    wall = _slope(profile, -NEAR * min(height, depth), NEAR * min(height, armour))[0] < WALL
    if wall and kind == "mound":
        raise OutlineError("its front is an upright porous face")
    away, top = profile.away[toe:], profile.top[toe:]
    found = Outline(
        kind="wall" if wall else kind,
        x=profile.place(face),
        freeboard=crest,
        cot_slope=0.0 if wall else cot,
        depth=depth,
        foreshore=bool(len(away) > 2 and np.ptp(top[1:]) > CREST * case.domain.spacing),
        crest_width=0.0 if wall or kind == "slope" else width,
        armour_crest=crest if wall or kind == "slope" else armour,
        permeable=kind == "mound" and not _solid_behind(profile, face, 0.5 * height, section),
        berm=0.0 if wall else berm,
        **(_wall(profile, face, depth, section) if wall else {}),
    )
    return _told(found)


def emerged(case: Case, sea: Sea, start: float, end: float) -> float | None:
    """The place x [m] of the highest ground between two, seen from the first; None where all lies below still water."""
    section = CrossSection(case)
    x = np.linspace(start, end, max(3, int(abs(end - start) / section.grid.spacing[0] * FINE)))[1:-1]
    layer = section.layers[len(section.layers) // 2]
    top = _tops(section.area([*section.solid, *section.porous], layer), x, section.window[3]) - sea.level
    return float(x[int(np.argmax(top > top.max() - 1e-6))]) if top.max() >= 0.0 else None


def _profile(section: CrossSection, sea: Sea, x: float) -> Profile:
    """The ground from a crest at x [m] seawards to the maker."""
    direction = 1.0 if x > sea.maker else -1.0
    step = section.grid.spacing[0] / FINE
    count = int(abs(x - sea.maker) / step)
    if count < 2:
        raise OutlineError(f"x = {x:g} m lies at the maker of the waves")
    away = np.asarray(np.arange(count) * step, dtype=float)
    layer = section.layers[len(section.layers) // 2]
    solid = section.area(section.solid, layer)
    ground = shapely.union_all([solid, section.area(section.porous, layer)])
    place = x - direction * away
    tops = [_tops(area, place, section.window[3]) - sea.level for area in (ground, solid)]
    return Profile(away, tops[0], tops[1], x, direction, step, sea.level)


def _tops(area: shapely.Geometry, x: FloatArray, lid: float) -> FloatArray:
    """Top of an area at x (N,) [m], 0 where there is none."""
    ends = np.stack([np.stack([x, np.full_like(x, z)], axis=-1) for z in (0.0, lid)], axis=1)
    return np.nan_to_num(shapely.bounds(shapely.intersection(shapely.linestrings(ends), area))[:, 3])


def _toe(profile: Profile, end: int, berm: float) -> int:
    """Number of the most seaward line of the structure: flat parts between steep ones are no longer than `berm` [m]."""
    rise = (profile.top[:-1] - profile.top[1:]) / profile.step
    steep = np.flatnonzero(rise > STEEP)
    steep = steep[steep >= end - 1]
    if not len(steep):
        raise OutlineError("its front is nowhere steeper than 1:10")
    gaps = np.flatnonzero(np.diff(steep) * profile.step > berm)
    return int(steep[gaps[0]] if len(gaps) else steep[-1])


def _armour(profile: Profile, end: int, crest: float, slack: float) -> tuple[float, float]:
    """Level of the armour's crest above still water, and its width [m]: of the porous ground in front of any wall."""
    porous = profile.top[:end] > profile.solid[:end] + 1e-9
    if not porous.any():
        return crest, 0.0
    walls = np.flatnonzero(~porous)
    first = int(walls[-1]) + 1 if len(walls) else 0  # the armour in front of the most seaward wall begins here
    if first >= end:
        return crest, 0.0
    level = float(profile.top[first:end].max())
    return level, float(np.count_nonzero(profile.top[first:end] > level - slack) * profile.step)


def _slope(profile: Profile, low: float, high: float) -> tuple[float, float]:
    """Cotangent of the front between two levels, without its flat parts, and the length of these [m]."""
    near, far = profile.reaches(high), profile.reaches(low)
    inside = (profile.away[:-1] >= near) & (profile.away[1:] <= far)
    rise = np.abs(np.diff(profile.top)) / profile.step
    flat = float(np.count_nonzero(inside & (rise < FLAT)) * profile.step)
    flat = flat if flat > FINE * profile.step else 0.0  # the rounding of a corner
    return (far - near - flat) / (high - low), flat


def _solid_at(profile: Profile, face: float) -> bool:
    """True if the ground at the water's edge is solid."""
    i = int(np.clip(face / profile.step, 0, len(profile.top) - 1))
    i = max(0, i - 1)
    return bool(profile.solid[i] >= profile.top[i] - 1e-9)


def _solid_behind(profile: Profile, face: float, below: float, section: CrossSection) -> bool:
    """True if a solid lies between the face and the crest at a level so far below still water [m]."""
    level = profile.level - below
    line = shapely.LineString([(profile.place(face), level), (profile.x, level)])
    layer = section.layers[len(section.layers) // 2]
    return bool(shapely.intersection(line, section.area(section.solid, layer)).length > profile.step)


def _wall(profile: Profile, face: float, depth: float, section: CrossSection) -> dict[str, Any]:
    """Berm and foot of a wall: depth above the berm in front, width of the berm, lower edge of the wall."""
    front = int(np.ceil(face / profile.step)) + 1
    before = float(profile.top[min(front, len(profile.top) - 1)])
    flat = np.flatnonzero(profile.top[front:] < before - 0.1 * max(depth + before, profile.step))
    width = float(flat[0] * profile.step) if len(flat) and -before < depth - profile.step else 0.0
    inside = profile.place(max(0.0, face - 2 * profile.step))
    layer = section.layers[len(section.layers) // 2]
    line = shapely.LineString([(inside, 0.0), (inside, section.window[3])])
    low = float(shapely.bounds(shapely.intersection(line, section.area(section.solid, layer)))[1])
    foot = profile.level - low
    return {"on_berm": -before, "berm_width": width, "foot": foot if np.isfinite(foot) else inf}


def _told(o: Outline) -> Outline:
    """The outline with its words."""
    front = {
        "slope": f"impermeable slope 1:{o.cot_slope:.3g}",
        "mound": f"permeable armour 1:{o.cot_slope:.3g} on a{' permeable' if o.permeable else 'n impermeable'} core",
        "wall": "upright wall",
    }[o.kind]
    words = [front, f"R_c {o.freeboard:.3g} m", f"depth at the toe {o.depth:.3g} m"]
    if o.kind == "mound":
        words.append(f"crest of the armour {o.crest_width:.3g} m wide at {o.armour_crest:.3g} m")
    if o.berm:
        words.append(f"a berm of {o.berm:.3g} m is left out of the slope (gamma_b = 1)")
    if o.kind == "wall" and o.on_berm < o.depth - 1e-6:
        words.append(f"a berm of {o.berm_width:.3g} m in front, {o.on_berm:.3g} m below still water")
    if o.foreshore:
        words.append("a foreshore, at whose end the waves are taken as at the maker")
    return replace(o, words=", ".join(words))
