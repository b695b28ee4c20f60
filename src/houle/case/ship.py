"""From the table [ship] to the passage of the ship, by the published formulas of `houle.design`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import sqrt

from houle.case.tables.ship import Ship
from houle.design.errors import DesignError
from houle.design.ships import (
    BankDrawdown,
    Drawdown,
    SecondaryWaves,
    ship_drawdown,
    ship_drawdown_at_bank,
    ship_limit_speed,
    ship_waves,
)  # fmt: skip
from houle.waves.dispersion import GRAVITY
from houle.waves.ship import Passage, earliest
from houle.waves.wave import WaveError

MOST = 1000  # secondary waves in the time of a passage: more are too short to be computed, and too low to matter
WEIGHED = 0.01  # gravity may differ so much from that of the formulas


@dataclass(frozen=True)
class Estimate:
    """The answers of the formulas about a ship in its channel: area A_c, section A_s [m2], and the offset [m].

    offset  of the ship from the axis of the channel, towards the bank
    """

    area: float
    section: float
    offset: float
    beside: Drawdown
    bank: BankDrawdown
    waves: SecondaryWaves


def estimate(ship: Ship, depth: float) -> Estimate:
    """Drawdown, return current and waves of a ship in water of this depth [m].

    Raises WaveError for a channel that is no channel, a ship that fills it, one faster than its limit speed, and one
    that touches the ground.
    """
    area, section = _area(ship, depth), ship.midship * ship.beam * ship.draught
    offset = max(0.0, ship.width / 2 - ship.distance - ship.beam / 2)
    if section >= area:
        raise WaveError(
            f"ship.beam = {ship.beam:g} m and draught = {ship.draught:g} m fill {section:.4g} m2, the whole channel "
            f"has {area:.4g} m2: a smaller ship, or a larger channel"
        )
    limit = ship_limit_speed(canal_area=area, ship_area=section, canal_width=ship.width).V_L
    if not ship.speed < limit:
        raise WaveError(
            f"ship.speed = {ship.speed:g}: 0 < speed < {limit:.4g} m/s, the limit speed of a ship that fills "
            f"{section / area:.1%} of this channel (Schijf); slower, a smaller ship, or a larger channel"
        )
    try:
        beside = ship_drawdown(speed=ship.speed, canal_area=area, ship_area=section, canal_width=ship.width)
        bank = ship_drawdown_at_bank(
            drawdown=beside.z, return_current=beside.u, offset=offset, depth=depth, canal_area=area,
            canal_width=ship.width, ship_length=ship.length,
        )  # fmt: skip
        waves = ship_waves(speed=ship.speed, depth=depth, distance=ship.distance, kind=ship.kind, draught=ship.draught)
    except DesignError as error:
        raise WaveError(f"ship: {error}") from None
    if ship.draught + beside.z >= depth:
        raise WaveError(
            f"ship.draught = {ship.draught:g} m, and {beside.z:.3g} m by which the ship sinks with the water, reach "
            f"the bed of {depth:g} m of water: draught < {depth - beside.z:.3g} m, or a slower ship"
        )
    return Estimate(area, section, offset, beside, bank, waves)


def _area(ship: Ship, depth: float) -> float:
    """Wet cross-section of the channel [m2]. Raises WaveError for one that is larger than width times depth."""
    if ship.bed_width is not None:
        return depth * (ship.width + ship.bed_width) / 2
    assert ship.area is not None
    if ship.area > ship.width * depth * (1 + 1e-9):
        raise WaveError(
            f"ship.area = {ship.area:g}: a channel {ship.width:g} m wide has at most {ship.width * depth:.4g} m2 with "
            f"waves.depth = {depth:g} m"
        )
    return ship.area


def passage_of(ship: Ship, depth: float, gravity: float, place: float) -> Passage:
    """The passage of the ship, whose waves are made at x = `place` [m] in water of this depth [m].

    Raises WaveError as `estimate` does, and for another gravity or a bank before the maker.
    """
    if abs(gravity / GRAVITY - 1) > WEIGHED:
        raise WaveError(f'fluid.gravity = {gravity:g}: waves.kind = "ship" is by formulas for {GRAVITY:g} m/s2')
    if ship.toe <= place:
        raise WaveError(f"ship.toe = {ship.toe:g}: the waves come from x = {place:g} m, toe > {place:g} m")
    found = estimate(ship, depth)
    passage = Passage(
        length=ship.length, speed=ship.speed, distance=ship.distance, time=ship.time or 0.0, mean=found.beside.z,
        drawdown=found.bank.z_bank, stern=found.bank.z_max, current=found.bank.u_bank, height=found.waves.H,
        period=found.waves.T,
    )  # fmt: skip
    count = (passage.end - passage.time - passage.knots[0][0] / passage.speed) / passage.period
    if count > MOST:
        raise WaveError(
            f"ship.speed = {ship.speed:g}: it passes so slowly that {count:.3g} of its secondary waves, T = "
            f"{passage.period:.3g} s, go by, {MOST} at most; speed > {ship.speed * sqrt(count / MOST):.3g} m/s"
        )
    if ship.time is not None:
        return passage
    return replace(passage, time=earliest(passage, ship.toe - place, depth, gravity))
