"""Checks of [ship]: what the formulas say of it and where they end, whether the run sees the passage, and the grid.

`ship_fits` is one of the CHECKS of `rules.py`; `ship_rows` are the rows of the report.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

import numpy as np

from houle.case.model import Case
from houle.case.section import CrossSection
from houle.case.ship import Estimate, estimate
from houle.check.finding import Finding
from houle.check.wave_theory import CELLS_PER_HEIGHT, CELLS_PER_LENGTH
from houle.errors import CaseError
from houle.waves.ship import CUSP, STEEPEST, ShipWave, earliest

FAST = 0.9  # share of the limit speed that ships seldom exceed
EARLY = 0.02  # share of the rms of the waves that may have left the maker before the run begins
BEFORE = 50  # instants in each period of the secondary waves at which that is looked for
SAME = 1e-3  # relative: depths that differ by no more are the same


def ship_fits(s: CrossSection) -> Iterator[Finding]:
    """The formulas hold for the ship, the run is long enough, and the grid carries the secondary waves."""
    try:
        wave = s.case.wave
    except CaseError:
        return  # waves_fit reports the error
    if s.case.ship is None or not isinstance(wave, ShipWave):
        return
    found = estimate(s.case.ship, wave.depth)
    yield from _formulas(s.case, found)
    yield from _toe(s, wave)
    yield from _times(s.case, wave)
    yield from _waves_on_grid(s, found)


def _formulas(case: Case, found: Estimate) -> Iterator[Finding]:
    """The ship is slower than ships are at most, and inside the ranges of the formulas."""
    ship = case.ship
    assert ship is not None
    if (share := found.beside.ratios["V/V_L"]) > FAST:
        text = (
            f"= {ship.speed:g} m/s is {share:.0%} of the limit speed {found.beside.V_L:.4g} m/s (Schijf): ships seldom "
            f"exceed {FAST:.0%}, and there the drawdown depends on every hundredth; speed = "
            f"{FAST * found.beside.V_L:.3g}"
        )
        yield Finding("warning", "ship.speed", text)
    for sentence in (*found.beside.outside, *found.bank.outside, *found.waves.outside):
        yield Finding("warning", "ship", f": {sentence}")


def _toe(s: CrossSection, wave: ShipWave) -> Iterator[Finding]:
    """The bank begins in the tank, and the bed before it is as deep as where the waves are made."""
    ship, case = s.case.ship, s.case
    assert ship is not None and case.waves is not None
    if ship.toe >= case.domain.size[0]:
        text = f"= {ship.toe:g} lies outside the domain, {case.waves.place:g} < toe < {case.domain.size[0]:g} m"
        yield Finding("error", "ship.toe", text)
        return
    x = np.linspace(case.waves.place, ship.toe, 51)[1:-1]
    off = np.abs(s.standing(x)[0] - wave.depth)
    if off.max() > SAME * wave.depth:
        where = float(x[np.unravel_index(np.argmax(off), off.shape)[1]])
        text = (
            f"= {ship.toe:g} m: the water before it is not {wave.depth:g} m deep all along, at x = {where:.3g} m it "
            f"differs by {off.max():.3g} m: give the end of the level bed"
        )
        yield Finding("warning", "ship.toe", text)


def _times(case: Case, wave: ShipWave) -> Iterator[Finding]:
    """The waves leave the maker after the start of the run, and have come to the bank before its end."""
    passage, ship, waves = wave.passage, case.ship, case.waves
    assert ship is not None and waves is not None
    way = ship.toe - waves.place
    last = passage.end + 2 * way / sqrt(wave.gravity * wave.depth)
    if case.time.end < passage.end:
        text = (
            f"= {case.time.end:g} s: the bow passes at {passage.time:.3g} s, the last secondary waves come to the bank "
            f"by {passage.end:.3g} s; end = {last:.3g}"
        )
        yield Finding("warning", "time.end", text)
    t = np.arange(passage.time - 100 * passage.period, passage.end, passage.period / BEFORE)
    level = wave.elevation(waves.place, t)
    share = sqrt(float(np.sum(level[t < 0] ** 2)) / float(np.sum(level**2)))
    if share > EARLY:
        first = earliest(passage, way, wave.depth, wave.gravity)
        text = (
            f"= {passage.time:g} s: {share:.0%} of the rms of the waves would have to leave x = {waves.place:g} m "
            f"before the run begins, to be at the bank in time; time = {first:.3g}, or leave it out"
        )
        yield Finding("warning", "ship.time", text)


def _waves_on_grid(s: CrossSection, found: Estimate) -> Iterator[Finding]:
    """The grid carries the secondary waves, whose height and length are small beside those of the drawdown."""
    h, (least, _) = max(s.grid.spacing), CELLS_PER_LENGTH
    if (cells := found.waves.L / h) < least * (1 - 1e-9):
        text = (
            f"= {h:.3g} m is {cells:.3g} cells in a secondary wave of L = {found.waves.L:.3g} m: with fewer than "
            f"{least:g} it decays on its way; spacing = {found.waves.L / least:.3g}"
        )
        yield Finding("warning", "domain.spacing", text)
    if (cells := found.waves.H / h) < CELLS_PER_HEIGHT * (1 - 1e-9):
        text = (
            f"= {h:.3g} m is {cells:.2g} cells in the height of a secondary wave, H = {found.waves.H:.3g} m: below "
            f"{CELLS_PER_HEIGHT:g} levels scatter; spacing = {found.waves.H / CELLS_PER_HEIGHT:.3g}"
        )
        yield Finding("warning", "domain.spacing", text)


def ship_rows(case: Case) -> list[tuple[str, str]]:
    """Rows (name, words) about the ship, and what the formulas say that it does at the bank, with their sources."""
    ship, wave = case.ship, case.wave
    if ship is None or not isinstance(wave, ShipWave):
        return []
    found, passage, h = estimate(ship, wave.depth), wave.passage, max(case.domain.grid.spacing)
    size = (
        f"{ship.length:g} x {ship.beam:g} x {ship.draught:g} m at {ship.speed:g} m/s, {ship.distance:g} m from the bank"
    )
    blocked = f"A_c = {found.area:.4g} m2, {ship.width:g} m wide; the ship fills {found.section / found.area:.1%}"
    share, offset = found.beside.ratios["V/V_L"], f"{found.offset:.3g} m off the axis"
    bank, waves = found.bank, found.waves
    bow, stern = passage.arrivals
    start, end = passage.trough
    return [
        ("ship", f"{ship.kind}, {size}"),
        ("channel", blocked),
        ("limit speed", f"V_L = {found.beside.V_L:.4g} m/s, V/V_L = {share:.3f}: {found.beside.source}"),
        ("drawdown", f"{found.beside.z:.3g} m, mean over the cross-section; at the bank {bank.z_bank:.3g} m, {offset}"),
        ("return current", f"{found.beside.u:.3g} m/s; at the bank {bank.u_bank:.3g} m/s, along it: not in this flow"),
        ("stern wave", f"{bank.z_max:.3g} m above the drawdown, slope {STEEPEST:g}: {bank.source}"),
        ("secondary waves", f"H = {waves.H:.3g} m, L = {waves.L:.3g} m, T = {waves.T:.3g} s: {waves.source}"),
        ("on the grid", f"H/dx = {waves.H / h:.2g}, L/dx = {waves.L / h:.3g}"),
        (
            "at the bank",
            f"bow passes at {passage.time:.3g} s, lowest level {start:.3g} to {end:.3g} s, highest secondary waves "
            f"{bow:.3g} and {stern:.3g} s ({CUSP:.3g} distances after bow and stern)",
        ),
        ("sent in", "half of the drawdown and of the stern wave, which the bank sends back and so doubles"),
    ]
