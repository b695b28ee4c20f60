"""Checks of what a run is made for: is one overtopping wave more than a few cells of water?"""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

from houle.case.messages import place
from houle.case.section import CrossSection
from houle.check.finding import Finding
from houle.design.errors import DesignError
from houle.errors import CaseError
from houle.results.answers.formulas import mean_overtopping, share
from houle.results.answers.outline import OutlineError, outline_of
from houle.results.answers.sea import sea_of
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
