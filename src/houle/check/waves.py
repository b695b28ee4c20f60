"""Checks of [waves] and [[sponge]]: do theory and grid carry the wave, do maker and sponges stand in the right water?

`waves_fit` and `sponges_fit` are two of the CHECKS of `rules.py`; `report.py` describes a wave in which nothing is
wrong. A maker "acts" over an interval in x (`case.acting.reach`): a source over its width, a piston over its stroke.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from math import asin, degrees, inf, pi, radians, sin, sqrt
from typing import Literal

import numpy as np
import shapely

from houle.boundary.internal_source import ACTS, LONGEST, SHORTEST, left_out, require_source
from houle.boundary.sponge import damping, left_over, sent_back, sides
from houle.case.acting import Reach, reach, source_of
from houle.case.messages import place
from houle.case.model import Case
from houle.case.section import CrossSection
from houle.case.tables.boundaries import Sponge
from houle.case.tables.waves import Piston, Source, Waves, Zone
from houle.case.wave import read_motion, read_record, rest_of
from houle.check.finding import Finding
from houle.check.wave_theory import assess
from houle.data.history import shortcomings
from houle.errors import CaseError, metres
from houle.medium import shapes
from houle.waves import record
from houle.waves.dispersion import group_velocity, wave_number
from houle.waves.paddle import PaddleWave, RecordedMotion
from houle.waves.wave import Wave

LONG, LONG_OF_A_SOLITARY = 1.25, 0.9  # wavelengths: a zone or a sponge shorter than this is warned of
SHORT = 0.5  # wavelengths: a zone shorter than this is an error for periodic waves
SAME = 1e-3  # depths that differ by no more are the same: [m], or as a share of the depth if that is more
TOLD = 0.35  # share of the rms of a record that a source may leave out without a warning (`left_out`)
OVER = 10.0  # cells in the least depth over a bar: with five the third harmonic behind it is a third too low
GROUP = 0.95  # share of the crest of a focused group that the waves make which arrive in time
RECORDED = ("series", "paddle", "ship")  # waves with no one length
COARSE = 0.02  # share of the stroke by which lines between samples of a paddle may miss the curve: 11 a period
MOVES = 0.05  # share of its largest speed up to which a paddle counts as at rest
SHARP = 0.5  # g: more than a laboratory's paddle is accelerated by
SAMPLES = 51  # places along a maker at which the depth is compared


def waves_fit(s: CrossSection) -> Iterator[Finding]:
    """The wave of [waves] suits theory, grid and depth, and maker, bodies, lid and gauges suit the wave."""
    table, case = s.case.waves, s.case
    if table is None:
        return
    try:
        wave = case.wave
        assert wave is not None
    except CaseError as error:
        yield _told("error", str(error))
        return
    for level, text in assess(wave, max(s.grid.spacing)):
        if level != "info":
            yield _told("warning" if isinstance(wave, PaddleWave) else level, text)
    look = {Source: _source, Zone: _zone, Piston: _piston}[type(table.maker)]
    found = list(look(s, wave))
    yield from found
    if all(f.level != "error" for f in found):  # else the maker stands nowhere
        yield from _depth(s, wave)
        yield from _stones(s, wave)
    yield from _lid(s, wave)
    yield from _gauges(s, wave)
    yield from _crests(s, wave)
    if table.kind == "series":
        yield from _record(s, wave)
    if isinstance(wave, PaddleWave):
        yield from _motion(s, wave.motion)
    if table.focus is not None:
        yield from _focus(s, wave)


def _told(level: Literal["error", "warning"], message: str) -> Finding:
    """A message as a finding; if it begins with a key, such as waves.height, this is the key of the finding."""
    named = re.match(r"((?:waves|ship)[.\w]*)(.+)", message, re.DOTALL)
    return Finding(level, named[1], named[2].removeprefix(" ")) if named else Finding(level, "waves", f": {message}")


def _record(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """The record covers the run and has no holes, and the source can make nearly all of it."""
    table, end = s.case.waves, s.case.time.end
    assert table is not None and table.file is not None
    known = read_record(table, s.case.folder)
    lead = record.LEAD * float(known.time[-1] - known.time[0])
    outside = f"{lead:.3g} s of half a cosine lead to still water"
    for level, text in shortcomings(known, end, table.gap, 0.0, outside):
        yield Finding(level, "waves.file", f'= "{table.file}" {text}')
    parts = wave.components()
    if isinstance(table.maker, Source) and parts is not None:
        width = source_of(table, wave).width
        if share := left_out(parts, width):
            text = (
                f'= "{table.file}": a source {width:.3g} m wide leaves out its mean and the waves that are not '
                f"{SHORTEST * width:.3g} to {LONGEST * width:.3g} m long, {share:.1%} of the rms of the record and the "
                "ends that lead it to still water; waves.zone or waves.piston make them"
            )
            yield Finding("warning" if share > TOLD else "info", "waves.file", text)


def _motion(s: CrossSection, motion: RecordedMotion) -> Iterator[Finding]:
    """The record of a paddle meets the clock of the run, starts at rest, is sampled well, and is that of a paddle."""
    table, case = s.case.waves, s.case
    assert table is not None and table.file is not None and table.piston is not None
    quantity, known = read_motion(table, case.folder)
    still = rest_of(quantity)
    name = f'= "{table.file}"'
    for level, text in shortcomings(known, case.time.end, table.gap, still, "the wall stands still", "a curve"):
        yield Finding(level, "waves.file", f"{name} {text}")
    if quantity == "displacement" and motion.zero:
        place = case.domain.grid.nearest_face(table.piston.x) - motion.zero
        text = f"{name} has {motion.zero:.4g} m at the start of the run: its 0 is at x = {place:.4g} m"
        yield Finding("info", "waves.file", text)
    start = max(0.0, float(known.time[0]))
    if start < case.time.end and (speed := abs(float(motion.velocity(start)))) > MOVES * motion.fastest:
        text = (
            f"= {table.start:g} s: the wall starts at {speed:.3g} m/s at once; start where the record is at rest, or "
        )
        text += "give ramp"
        yield Finding("warning", "waves.start", text)
    if (off := motion.coarse) > COARSE:
        text = (
            f"{name} has {motion.samples}: the curve through them lies {off:.1%} of its range off "
            f"straight lines, so it is a guess; {COARSE:.0%} come of some eleven samples to a period"
        )
        yield Finding("warning", "waves.file", text)
    if motion.hardest > SHARP * (g := case.fluid.gravity):
        text = (
            f"{name}: the wall is accelerated by up to {motion.hardest:.3g} m/s2, {motion.hardest / g:.2g} g: noise in "
            "the samples, or other units than the header says?"
        )
        yield Finding("warning", "waves.file", text)


def _focus(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """The focus lies inside the tank and before the end of the run, and all waves can reach it in time."""
    table, case = s.case.waves, s.case
    assert table is not None and table.focus is not None
    x, time, size, end = table.focus.x, table.focus.time, case.domain.size[0], case.time.end
    if not 0 <= x <= size:
        text = f"= {x:g} lies outside the domain, 0 <= x <= {size:g} m.{metres(x, size)}"
        yield Finding("error", "waves.focus.x", text)
        return
    if time > end:
        yield Finding("error", "waves.focus.time", f"= {time:g} s is after the end of the run, time.end = {end:g} s")
    left = table.source is not None and table.source.side == "left"
    way = (table.place - x) if left else (x - table.place)
    if way < 0:
        text = f"= {x:g} m lies behind the maker at x = {table.place:g} m, whose waves go to the "
        cure = f"left: x < {table.place:g}" if left else f"right: x > {table.place:g}"
        more = ', or side = "left"' if table.source is not None and not left else ""
        yield Finding("error", "waves.focus.x", f"{text}{cure}{more}")
        return
    arrives, earliest = _leaves(table, wave, way)
    if time < earliest:
        what = "the crest" if wave.components() is None else "the slow waves of the group"
        text = (
            f"= {time:g} s: {what} would have to pass the maker, {way:.3g} m away, at t = {time - arrives:.3g} s; "
            f"time = {earliest + 0.005:.2f} or later"
        )
        yield Finding("error", "waves.focus.time", text)


def _leaves(table: Waves, wave: Wave, way: float) -> tuple[float, float]:
    """Travel time of a crest from the maker over the distance `way` [m], and the earliest time of the crest there [s].

    A single wave travels with its celerity and needs the time of its front in addition. The waves of a group travel
    with their group velocities, the shorter the slower: the slowest of those that make `GROUP` of the crest counts, and
    a period is added. A zone makes waves at its middle.
    """
    parts = wave.components()
    if parts is None:
        arrives = way / wave.celerity
        return arrives, arrives + wave.length / 2 / wave.celerity
    if table.zone is not None:
        way = max(0.0, way - (table.zone.x[1] - table.zone.x[0]) / 2)
    speed = group_velocity(parts.k, wave.depth, wave.gravity) + table.current * np.cos(parts.direction)
    order = np.argsort(-speed)
    share = np.cumsum(parts.amplitude[order]) / parts.amplitude.sum()
    arrives = way / float(speed[order][np.searchsorted(share, GROUP)])
    return arrives, arrives + wave.period


def _source(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """The source lies inside the tank with all its width, under no sponge, and waves behind it are absorbed."""
    table, size = s.case.waves, s.case.domain.size[0]
    assert table is not None and table.source is not None
    x = table.source.x
    try:
        require_source(source_of(table, wave), table.kind, wave)
    except CaseError as error:
        yield _told("error", str(error))
        return
    if not 0 < x < size:
        text = f"= {x:g} lies outside the domain, 0 < x < {size:g} m.{metres(x, size)}"
        yield Finding("error", "waves.source.x", text)
        return
    low, high = reach(s.case, wave)
    half = (high - low) / 2
    if low < 0 or high > size:
        wall, room = (0.0, x) if low < 0 else (size, size - x)
        cure = f"or width = {0.99 * room / ACTS:.2g}"
        if 2 * half < size:
            cure = f"x = {half if low < 0 else size - half:.3g}, {cure}"
        text = (
            f"= {x:g} m: a source {half / ACTS:.3g} m wide acts {half:.3g} m to each side, and the wall at {wall:g} m "
            f"would cut it: {cure}"
        )
        yield Finding("error", "waves.source.x", text)
    for i, sponge in enumerate(s.case.sponge):
        left, right = sponge.box[0][0], sponge.box[1][0]
        if left < high and right > low:
            inside = left < x < right
            yield Finding(
                "error" if inside else "warning",
                _key(s.case, i),
                f"from x = {left:g} to {right:g} m lies over the source, which acts from {low:.3g} to {high:.3g} m: "
                f"{'it damps what is made' if inside else 'the waves come out lower'}; end it before, or move the "
                "source",
            )
    if table.source.side == "both":
        yield from _taken_up(s, low)
    if table.direction:
        yield from _oblique(s, wave)


def _oblique(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """Oblique waves fit the width of the tank a whole number of times, as its sides are joined; walls would reflect."""
    case = s.case
    assert case.waves is not None
    angle, width = case.waves.direction, case.domain.size[1]
    if not case.domain.periodic[1]:
        text = f'= {angle:g} degrees: the walls along x send oblique waves back; domain.walls = {{y = "periodic"}}'
        yield Finding("warning", "waves.direction", text)
        return
    waves = width * sin(radians(abs(angle))) / wave.length
    if abs(waves - round(waves)) > 0.01 or round(waves) == 0:
        near = {m for m in (int(waves), int(waves) + 1) if m > 0 and m * wave.length <= width}
        fitting = [f"{degrees(asin(m * wave.length / width)):.3g}" for m in sorted(near)]
        cure = f"{' or '.join(fitting)} degrees" if fitting else f"a width above {wave.length:.3g} m"
        text = f"= {angle:g} degrees puts {waves:.2f} waves along y = {width:g} m, whose sides are joined: {cure}"
        yield Finding("error", "waves.direction", text)


def _taken_up(s: CrossSection, low: float) -> Iterator[Finding]:
    """A sponge absorbs the waves that a source sends to the left."""
    if s.case.domain.periodic[0] or any(sponge.box[0][0] <= s.case.domain.spacing for sponge in s.case.sponge):
        return
    text = (
        f'= "both" sends waves to the left too, and the wall at x = 0 sends them back: put a [[sponge]] between it '
        f'and {low:.3g} m, or give side = "right"'
    )
    yield Finding("warning", "waves.source.side", text)


def _zone(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """The zone begins at the left wall, is long enough, holds no sponge, and its waves travel along x."""
    case, size, h = s.case, s.case.domain.size[0], s.grid.spacing[0]
    assert case.waves is not None and case.waves.zone is not None
    start, end = case.waves.zone.x
    if case.waves.direction:
        text = f"= {case.waves.direction:g} degrees: a zone leads waves along x only; 0, or take waves.source"
        yield Finding("error", "waves.direction", text)
    if case.domain.periodic[0]:
        yield Finding("error", "waves.zone", 'begins at the left wall, but walls.x = "periodic" has none: remove that')
    if abs(start) > h / 2:
        text = f"= [{start:g}, {end:g}]: the zone begins at the left wall, x = [0, {end:g}]"
        yield Finding("error", "waves.zone.x", text)
    elif end >= size:
        text = f"= [{start:g}, {end:g}] ends outside the domain, 0 < x < {size:g} m.{metres(end, size)}"
        yield Finding("error", "waves.zone.x", text)
    elif (share := (end - start) / wave.length) < _long_enough(case) and wave.name not in RECORDED:
        text = (
            f"= [{start:g}, {end:g}] is {share:.2f} of the wavelength {wave.length:.3g} m: the longer, the better the "
            f"wave and the less comes back; x = [0, {1.5 * wave.length:.3g}]"
        )
        yield Finding("error" if share < SHORT and _periodic(case) else "warning", "waves.zone.x", text)
    for i, sponge in enumerate(case.sponge):
        if sponge.box[0][0] < end:
            text = f"begins at x = {sponge.box[0][0]:g} m, inside waves.zone, which ends at {end:g} m: begin it after"
            yield Finding("error", _key(case, i), text)


def _piston(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """The piston stands inside the tank; everything else about it is checked by `boundaries.moving_walls_fit`."""
    table, size = s.case.waves, s.case.domain.size[0]
    assert table is not None and table.piston is not None
    if not 0 < table.piston.x < size:
        text = f"= {table.piston.x:g} lies outside the domain, 0 < x < {size:g} m.{metres(table.piston.x, size)}"
        yield Finding("error", "waves.piston.x", text)


def _periodic(case: Case) -> bool:
    return case.waves is not None and case.waves.kind != "solitary"


def _long_enough(case: Case) -> float:
    """Length of a zone or a sponge below which it is warned of [wavelengths]."""
    return LONG if _periodic(case) else LONG_OF_A_SOLITARY


def _depth(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """waves.depth is the depth of the still water wherever the maker acts."""
    low, high = reach(s.case, wave)
    x = np.linspace(low, high, SAMPLES)[1:-1]
    standing = s.standing(x)[0]
    allowed = max(SAME, SAME * wave.depth)
    off = np.abs(standing - wave.depth)
    if off.max() <= allowed:
        return
    layer, worst = np.unravel_index(np.argmax(off), off.shape)
    found, where = float(standing[layer, worst]), float(x[worst])
    even = np.ptp(standing) <= allowed
    at = f"from x = {low:.3g} to {high:.3g} m" if even else f"at x = {where:.3g} m"
    cure = f"depth = {found:.6g}, or another level of [[water]]" if even and found > 0 else (
        f"the maker acts from {low:.3g} to {high:.3g} m and needs this depth all along: move it, make it shorter, or "
        "change [[water]] or [[solid]]"
    )  # fmt: skip
    there = f"the water is {found:.4g} m deep" if found > 0 else "there is no water"
    yield Finding("error", "waves.depth", f"= {wave.depth:g} m, but {there} {at}: {cure}")


def _stones(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """No porous body stands where the maker acts."""
    low, high = reach(s.case, wave)
    for body, (x0, x1) in _porous_in(s, shapely.box(low, 0.0, high, s.window[3])):
        text = f"reaches into the maker of waves, x {x0:.3g} to {x1:.3g} m: it acts from {low:.3g} to {high:.3g} m, in "
        yield Finding("error", body, text + "clear water only; move one of them")


def _porous_in(s: CrossSection, window: shapely.Geometry, span: Reach = (-inf, inf)) -> Iterator[tuple[str, Reach]]:
    """Keys of the porous bodies in a window of the section, in layers within a span of y, and their x there [m]."""
    for body in s.porous:
        for layer in _layers(s, span):
            common = shapely.intersection(s.area([body], layer), window)
            if common.area > s.speck:
                yield body.key, (common.bounds[0], common.bounds[2])
                break


def _layers(s: CrossSection, span: Reach) -> list[shapes.Span]:
    """Layers with their middle in a span of y [m]; in 2D the one layer, always."""
    return [y for y in s.layers if s.case.dimension == 2 or span[0] <= (y[0] + y[1]) / 2 <= span[1]]


def _crests(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """There are enough cells in the water over submerged crests, where short harmonics arise; their length is told."""
    level, h = s.depth(), s.grid.spacing[-1]
    for body in (*s.solid, *s.porous):
        left = level - float(body.shape.bounds[1][-1])
        if left <= 0.0 or left >= wave.depth * (1 - SAME):
            continue
        if (cells := left / h) < OVER * (1 - 1e-9):
            third = ""
            if _periodic(s.case) and wave.name not in RECORDED:
                short = _third(wave, left, s.case.fluid.gravity)
                third = f", and third harmonics {short:.2g} m long, {short / max(s.grid.spacing):.0f} cells"
            text = (
                f"leaves {left:.3g} m of water over its crest, {cells:.1f} cells{third}: with 5 and 29 the third "
                f"harmonic behind a bar was a third too low, {OVER:g} and 58 keep it; domain.spacing = "
                f"{left / OVER:.2g}"
            )
            yield Finding("warning", body.key, text)


def _third(wave: Wave, depth: float, gravity: float) -> float:
    """Length of a free wave of three times the frequency, in water of another depth [m]."""
    return 2 * pi / float(wave_number(6 * pi / wave.period, depth, gravity))


def _lid(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """The crests stay below the lid, even those of a wave that is fully reflected, which are twice as high."""
    top, still = s.case.domain.size[-1], s.depth()
    freeboard = top - still
    if freeboard >= 2 * wave.crest:
        return
    h = s.grid.spacing[-1]
    better = still + 2 * wave.crest + 2 * h
    if freeboard < wave.crest + h:
        text = (
            f"= {top:g} m high leaves {freeboard:.3g} m above the still water, the crests rise {wave.crest:.3g} m: "
            f"they would hit the lid; height {better:.3g}"
        )
        yield Finding("error", "domain.size", text)
    elif wave.name not in RECORDED:
        text = (
            f"= {top:g} m high leaves {freeboard:.3g} m above the still water: crests of {wave.crest:.3g} m "
            f"of a wave that is sent back whole rise {2 * wave.crest:.3g} m and more; height {better:.3g}"
        )
        yield Finding("warning", "domain.size", text)


def _gauges(s: CrossSection, wave: Wave) -> Iterator[Finding]:
    """No gauge lies in the maker or in a sponge."""
    case = s.case
    assert case.waves is not None
    what = {Source: "waves.source", Zone: "waves.zone", Piston: "the reach of waves.piston"}[type(case.waves.maker)]
    low, high = reach(case, wave)
    if isinstance(case.waves.maker, Piston):
        high = low + wave.depth
    spans = [(what, "the wave is not complete there", low, high)]
    for i, sponge in enumerate(case.sponge):
        spans.append((_key(case, i), "the wave is damped there", sponge.box[0][0], sponge.box[1][0]))
    for i, gauge in enumerate(case.gauge):
        for name, why, low, high in spans:
            if low < gauge.x < high:
                text = f"= {gauge.x:g} m lies in {name}, x {low:.3g} to {high:.3g} m: {why}; move the gauge out of it"
                yield Finding("warning", f"{place(('gauge', i), case.__dict__)}.x", text)


def sponges_fit(s: CrossSection) -> Iterator[Finding]:
    """Each sponge lies inside the tank, touches one side, takes in the whole depth and is long enough."""
    try:
        wave = s.case.wave
    except CaseError:
        wave = None  # waves_fit reports the error
    for i, sponge in enumerate(s.case.sponge):
        found = list(_placed(s, i, sponge))
        yield from found
        if not found:
            yield from _filled(s, i, sponge)
            yield from _long(s, i, sponge, wave)


def _key(case: Case, i: int) -> str:
    return place(("sponge", i), case.__dict__)


def _placed(s: CrossSection, i: int, sponge: Sponge) -> Iterator[Finding]:
    """The sponge lies inside the domain and touches one side of it, which is a wall."""
    case, size = s.case, s.case.domain.size
    names = ("x", "z") if case.dimension == 2 else ("x", "y", "z")
    key, slack = f"{_key(case, i)}.box", 1e-6 * case.domain.spacing
    for axis, (low, high) in enumerate(zip(*sponge.box, strict=True)):
        if low < -slack or high > size[axis] + slack:
            value = low if low < -slack else high
            name = names[axis]
            text = f"reaches {name} = {value:g}, outside the domain 0 <= {name} <= {size[axis]:g} m: cut it there."
            yield Finding("error", key, text + metres(value, size[axis]))
            return
    near = min(s.grid.spacing) / 2
    touched = sides(sponge.box, size, near)
    if len(touched) != 1:
        low, high = sponge.box[0][0], sponge.box[1][0]
        if len(touched) > 1:
            text = "touches two sides of the tank that meet: it must touch one, make two sponges of it"
        elif low <= near and high >= size[0] - near:
            text = f"goes from side to side, x 0 to {size[0]:g} m: it must touch one side only, and leave water free"
        else:
            text = (
                f"from x = {low:g} to {high:g} m touches no side of the tank: one end must lie at x = 0 or "
                f"x = {size[0]:g} m" + (", or at a side along y" if case.dimension == 3 else "")
            )
        yield Finding("error", key, text)
    elif case.domain.periodic[touched[0][0]]:
        axes = "xy"[touched[0][0]]
        text = f'lies at a side that domain.walls.{axes} = "periodic" joins to the other: there is no wall to shield'
        yield Finding("error", key, text)


def _filled(s: CrossSection, i: int, sponge: Sponge) -> Iterator[Finding]:
    """The box holds all the water between its ends, and no porous body."""
    (x0, z0), (x1, z1) = ((corner[0], corner[-1]) for corner in sponge.box)
    span = (sponge.box[0][1], sponge.box[1][1]) if s.case.dimension == 3 else (-inf, inf)
    between = shapely.box(x0, 0.0, x1, s.window[3])
    for layer in _layers(s, span):
        water = shapely.intersection(s.open_water(layer), between)
        if water.area <= s.speck:
            yield Finding("error", _key(s.case, i), f"holds no water, x {x0:g} to {x1:g} m: remove it, or move it")
            return
        _, low, _, high = water.bounds
        if low < z0 - 1e-9 or high > z1 + 1e-9:
            text = (
                f"goes from z = {z0:g} to {z1:g} m, the water there from {low:g} to {high:g} m: what is outside passes "
                f"undamped; z from 0 to {s.window[3]:g}"
            )
            yield Finding("warning", f"{_key(s.case, i)}.box", text)
            break
    for body, (low, high) in _porous_in(s, shapely.box(x0, z0, x1, z1), span):
        text = f"reaches into {_key(s.case, i)}, x {low:.3g} to {high:.3g} m: both would damp; let them touch at most"
        yield Finding("error", body, text)


def _long(s: CrossSection, i: int, sponge: Sponge, wave: Wave | None) -> Iterator[Finding]:
    """The sponge is long enough beside the wave: a short one reflects it."""
    axis, _ = sides(sponge.box, s.case.domain.size, min(s.grid.spacing) / 2)[0]
    if wave is None or wave.name in RECORDED:
        return
    long, _, back = absorbed(s.case, sponge, wave, axis)
    if long < _long_enough(s.case) * wave.length:
        share = f", some {100 * back:.0f} %" if _periodic(s.case) else ""
        text = (
            f"is {long:.3g} m long, {long / wave.length:.2f} of the wavelength {wave.length:.3g} m: a short sponge "
            f"sends waves back{share}; {1.5 * wave.length:.3g} m are good"
        )
        yield Finding("warning", f"{_key(s.case, i)}.box", text)


def absorbed(case: Case, sponge: Sponge, wave: Wave | None, axis: int) -> tuple[float, float, float]:
    """Length of a sponge along its axis [m], its largest rate [1/s], and the share of the amplitude that it sends back.

    Without a wave, or for a solitary one, the share is what is left of a long wave after the way in and out.
    """
    long = sponge.box[1][axis] - sponge.box[0][axis]
    speed = wave.group_velocity if wave is not None else sqrt(case.fluid.gravity * CrossSection(case).depth())
    strength = sponge.strength or damping(speed, long)
    if wave is None or not _periodic(case):
        return long, strength, left_over(strength, speed, long)
    return long, strength, sent_back(strength, long, 2 * pi / wave.length, speed)
