"""Checks of what a run is made for: is it answered, and is one overtopping wave more than a few cells of water?"""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

import numpy as np
import shapely

from houle.case.messages import place
from houle.case.model import Case
from houle.case.section import CrossSection
from houle.check.finding import Finding
from houle.design.errors import DesignError
from houle.errors import CaseError
from houle.grid import FloatArray
from houle.observe.levels import crossings
from houle.results.answers.formulas import mean_overtopping, share
from houle.results.answers.outline import OutlineError, outline_of
from houle.results.answers.sea import first_place, sea_of
from houle.results.answers.table import Beside

CELLS = 20.0  # cells of water in an overtopping wave, below which its volume is coarse
PARTICLES = 4  # particles in a cell of water in a section
TINY = 1e-12  # share of the waves below which none overtops


def overtopping_resolved(s: CrossSection) -> Iterator[Finding]:
    """The discharge to expect at each crest by formula, and the size of one overtopping wave in cells of water."""
    if s.case.waves is None or not s.case.overtopping:
        return
    try:
        sea = sea_of(s.case)
    except CaseError:
        return  # `waves_fit` says why
    if sea is None or sea.lack:
        return
    for i, crest in enumerate(s.case.overtopping):
        key = place(("overtopping", i), s.case.__dict__)
        try:
            outline = outline_of(s.case, sea, crest.x)
            found, part = mean_overtopping(sea, outline), share(sea, outline).value
        except (OutlineError, DesignError) as error:
            yield Finding("info", key, f": no formula tells how much comes over: {error}")
            continue
        yield _finding(s, key, found, part, sea.mean)


def answers_come(s: CrossSection) -> Iterator[Finding]:
    """All that is asked for is answered: safety under waves, banks in water, as many waves as time.until waits for."""
    case, tables = s.case, s.case.__dict__
    for i, force in enumerate(case.force):
        if force.weight is not None and case.waves is None:
            text = f"= {force.weight:g} N/m is not used: factors of safety are answered under [waves]"
            yield Finding("warning", place(("force", i, "weight"), tables), text)
    for i, bank in enumerate(case.bank):
        x = np.linspace(*bank.x, bank.points)
        if case.waves is None and not (_level(s, x) > _ground(s, x) - bank.depth).any():
            text = f"= {list(bank.x)}: no water stands there at the start, and what stays dry is not answered"
            yield Finding("warning", place(("bank", i, "x"), tables), text)
    yield from _crests(s)
    yield from _enough_waves(case)
    if case.waves is not None and case.waves.seeds is not None:
        yield Finding("info", "waves.seeds", f"= {case.waves.seeds}: as many runs, each of the cost that is told here")


def _crests(s: CrossSection) -> Iterator[Finding]:
    """A crest stands out of the water, and outside of the zone that makes the waves."""
    zone = s.case.waves.zone if s.case.waves is not None else None
    for i, crest in enumerate(s.case.overtopping):
        key = place(("overtopping", i, "x"), s.case.__dict__)
        if zone is not None and zone.x[0] <= crest.x <= zone.x[1]:
            text = (
                f"= {crest.x:g} lies in waves.zone, {zone.x[0]:g} to {zone.x[1]:g} m, where the water is led: move it"
            )
            yield Finding("warning", key, text)
        at = np.array([crest.x])
        level, ground = float(_level(s, at)[0]), float(_ground(s, at)[0])
        if level > max(ground, crest.level or 0.0) + TINY:
            text = (
                f"= {crest.x:g}: {level - ground:.3g} m of still water stands there, so that all that goes to and fro "
                "counts: give the x of a crest, or a level above the water"
            )
            yield Finding("warning", key, text)


def _level(s: CrossSection, x: FloatArray) -> FloatArray:
    """Highest level of the water at the start (N,) [m] at x (N,) [m]; -inf where there is none."""
    found = np.nan_to_num(s.standing(x)[1], nan=-np.inf)
    return np.asarray(found.max(axis=0))


def _ground(s: CrossSection, x: FloatArray) -> FloatArray:
    """Highest top of solids and porous bodies (N,) [m] at x (N,) [m]; 0 on the floor."""
    areas = [shapely.union_all([s.area(s.solid, y), s.area(s.porous, y)]) for y in s.layers]
    tops = np.stack([np.nan_to_num(crossings(area, x)[1]) for area in areas])
    return np.asarray(tops.max(axis=0))


def _enough_waves(case: Case) -> Iterator[Finding]:
    """As many waves come until time.end as time.until waits for."""
    until = case.time.until
    if until is None or until.waves is None or case.waves is None:
        return
    try:
        sea = sea_of(case)
    except CaseError:
        return  # `waves_fit` says why
    if sea is None:
        return
    runs = case.waves.seeds or 1
    start = sea.start(first_place(case, sea))
    come = runs * max(0.0, (case.time.end - start) / sea.mean)
    if come < until.waves:
        text = (
            f"= {until.waves}: until time.end = {case.time.end:g} s some {come:.0f} waves come: "
            f"time.end = {start + until.waves * sea.mean / runs:.4g}"
        )
        yield Finding("warning", "time.until.waves", text)


def _finding(s: CrossSection, key: str, found: tuple[Beside, ...], part: float, mean: float) -> Finding:
    """The discharge by each rule, and the volume of an overtopping wave by the one that gives most."""
    volume = max(one.value for one in found) * mean / max(part, TINY)
    cells = volume / (s.grid.spacing[0] * s.grid.spacing[-1])
    told = ", ".join(f"{1e3 * one.value:.3g} l/s/m ({one.name})" for one in found)
    wave = (
        f": expect {told}; {100 * part:.2g} % of the waves overtop, with {1e3 * volume:.3g} l/m each, {cells:.3g} "
        f"cells of water or {PARTICLES * cells:.3g} particles"
    )
    if cells >= CELLS:
        return Finding("info", key, wave)
    if cells < 1.0:
        return Finding("warning", key, f"{wave}: less than a cell, this run does not tell how much comes over")
    spacing = s.case.domain.spacing * sqrt(cells / CELLS)
    return Finding("warning", key, f"{wave}: {CELLS:g} cells or more are good, domain.spacing = {spacing:.2g}")
