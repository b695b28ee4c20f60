"""The waves of a ship at the bank: sizes of the formulas, times of arrival, half of what the bank doubles, refusals."""

from dataclasses import replace
from math import asin, sqrt, tan
from typing import get_args

import numpy as np
import pytest
from pydantic import ValidationError

from houle import design
from houle.case.ship import estimate
from houle.case.tables.ship import Ship
from houle.case.tables.waves import Waves
from houle.case.wave import make
from houle.design.ships import KINDS
from houle.waves.ship import CUSP, RISE, STEEPEST, earliest, record
from houle.waves.wave import WaveError

DEPTH, GRAVITY = 2.0, 9.81
BOAT = {
    "kind": "motor ship", "length": 30.0, "beam": 5.0, "draught": 1.3, "speed": 2.2, "distance": 8.0, "width": 34.0,
    "bed_width": 24.0, "toe": 12.0,
}  # fmt: skip


def ship(**changes):
    return Ship.model_validate({k: v for k, v in {**BOAT, **changes}.items() if v is not ...})


def wave(depth=DEPTH, gravity=GRAVITY, **changes):
    table = Waves(kind="ship", depth=depth, zone={"x": (0.0, 5.0)})
    return make(table, gravity, ship=ship(**changes))


PASSAGE = wave().passage
T = np.arange(0.0, 60.0, 0.01)


def test_the_numbers_are_those_of_schijf_the_rock_manual_and_dipro():
    """Channel 2 (34 + 24) / 2 = 58 m2, ship 5 x 1.3 = 6.5 m2, 34/2 - 8 - 5/2 = 6.5 m off the axis."""
    beside = design.ship_drawdown(speed=2.2, canal_area=58.0, ship_area=6.5, canal_width=34.0)
    assert pytest.approx((2.2 + beside.u) * (58.0 - 6.5 - 34.0 * beside.z)) == 2.2 * 58.0  # continuity
    assert beside.z == pytest.approx(((2.2 + beside.u) ** 2 - 2.2**2) / (2 * 9.81))  # energy
    star = 6.5 * 2.0 / 58.0
    found = {"mean": beside.z, "drawdown": beside.z * (1 + 2 * star), "current": beside.u * (1 + star)}
    found |= {"stern": 1.5 * found["drawdown"], "period": 5.1 * 2.2 / 9.81}
    found["height"] = 0.28 * 1.3**1.25 * 2.0 * (8.0 / 2.0) ** (-1 / 3) * (2.2 / sqrt(9.81 * 2.0)) ** 4
    assert {key: getattr(PASSAGE, key) for key in found} == pytest.approx(found)


def test_the_cross_section_of_the_channel_is_a_trapezium_or_is_given():
    assert estimate(ship(), DEPTH).area == 58.0
    assert estimate(ship(bed_width=..., area=58.0), DEPTH) == estimate(ship(), DEPTH)
    assert estimate(ship(midship=0.9), DEPTH).section == pytest.approx(0.9 * 6.5)


def test_the_level_falls_by_the_drawdown_while_the_ship_passes_and_rises_by_the_stern_wave():
    start, end = PASSAGE.trough
    level = PASSAGE.primary(T)
    assert level.min() == pytest.approx(-PASSAGE.drawdown)
    assert np.ptp(level[(start < T) & (end > T)]) == 0.0
    assert level.max() == pytest.approx(PASSAGE.stern - PASSAGE.drawdown, rel=1e-4)
    assert PASSAGE.primary(PASSAGE.time) == pytest.approx((RISE * PASSAGE.mean - PASSAGE.drawdown) / 2)  # at the bow
    middle = PASSAGE.primary(PASSAGE.time + 30.0 / 2.2)  # at the stern
    assert middle == pytest.approx(PASSAGE.stern / 2 - PASSAGE.drawdown)


def test_the_stern_wave_is_as_steep_as_it_can_be_and_nothing_else_is_steeper():
    slope = np.diff(PASSAGE.primary(T)) / (0.01 * PASSAGE.speed)
    assert slope.max() == pytest.approx(STEEPEST, rel=1e-3) and -slope.min() < STEEPEST


def test_the_water_is_at_rest_before_and_after():
    assert not PASSAGE.incident(PASSAGE.time - 50.0) and not PASSAGE.incident(PASSAGE.end)
    assert PASSAGE.primary(PASSAGE.end - 0.01) == 0.0 and PASSAGE.secondary(PASSAGE.end - 0.5)


def test_secondary_waves_come_on_the_cusp_lines_of_bow_and_stern():
    """Kelvin's angle is arcsin 1/3: the line of the bow is s / tan of it behind the bow at the distance s."""
    assert pytest.approx(1 / tan(asin(1 / 3))) == CUSP
    level, (bow, stern) = PASSAGE.secondary(T), PASSAGE.arrivals
    first, last = T[:-1][T[:-1] < bow + 5], T[bow + 5 < T]
    assert T[np.argmax(level[: len(first)])] == pytest.approx(bow, abs=0.01)
    assert last[np.argmax(level[bow + 5 < T])] == pytest.approx(stern, abs=0.01)
    assert bow - PASSAGE.time == pytest.approx(2.83 * 8.0 / 2.2, rel=1e-3) and stern - bow == pytest.approx(30.0 / 2.2)
    assert level.max() == pytest.approx(PASSAGE.height / 2, rel=1e-3)
    assert np.ptp(level) == pytest.approx(PASSAGE.height, rel=0.1)


def test_the_return_current_flows_while_the_level_is_down():
    along, (start, end) = PASSAGE.along(T), PASSAGE.trough
    assert along[(start < T) & (end > T)] == pytest.approx(PASSAGE.current)
    assert along.min() == 0.0 and along[start - 4.0 > T].max() == 0.0


def test_the_wave_at_the_toe_is_half_of_the_drawdown_and_all_of_the_secondary_waves():
    """Within the components that a record leaves out, 1e-3 of its rms."""
    found = wave()
    level = found.elevation(12.0, T)
    expected = PASSAGE.primary(T) / 2 + PASSAGE.secondary(T)
    assert np.abs(level - expected).max() < 0.01 * PASSAGE.drawdown
    assert found.name == "ship" and "passage" in found.reason


def test_long_waves_leave_the_maker_before_they_arrive_and_short_ones_still_earlier():
    found = wave(time=40.0, distance=5.0)
    ship_ = found.passage
    long_ = found.elevation(0.0, T)
    fall = ship_.trough[0] - 12.0 / sqrt(GRAVITY * DEPTH)
    assert long_[np.argmin(np.abs(T - fall))] == pytest.approx(-ship_.drawdown / 2, abs=1.5 * ship_.height)
    before = found.elevation(0.0, np.arange(-60.0, 0.0, 0.01))
    assert np.abs(before).max() < 1e-3 * ship_.drawdown


@pytest.mark.parametrize("toe", [6.0, 12.0, 100.0])
def test_by_default_the_passage_is_so_late_that_its_waves_leave_the_maker_in_the_run(toe):
    found = wave(toe=toe)
    t = np.arange(-100.0, found.passage.end, 0.02)
    level = found.elevation(0.0, t)
    assert np.sum(level[t < 0] ** 2) < 4e-4 * np.sum(level**2)
    assert found.passage.time == earliest(replace(found.passage, time=0.0), toe, DEPTH, GRAVITY) > 0
    level = found.elevation(toe, t)
    assert np.abs(level - found.passage.incident(t)).max() < 0.01 * found.passage.drawdown


def test_the_mean_of_the_record_is_that_of_half_the_primary_wave():
    """Water leaves with the drawdown and comes back with the stern wave; what is left is told, not taken away."""
    step = 1e-3
    t = np.arange(0.0, 60.0, step)
    area = np.sum(PASSAGE.primary(t)) * step * PASSAGE.speed  # of the level over the way of the ship [m2]
    part, rise = 30.0 / 4, np.pi / 2 * PASSAGE.stern / STEEPEST
    bow, top, low = RISE * PASSAGE.mean, PASSAGE.stern - PASSAGE.drawdown, PASSAGE.drawdown
    by_hand = part * bow / 2 + part * (bow - low) / 2 - low * (30.0 - part / 2 - rise / 2)
    by_hand += rise * (top - low) / 2 + part * top / 2
    assert area == pytest.approx(by_hand, rel=1e-4)
    moved, level = record(PASSAGE, 12.0, DEPTH, GRAVITY)
    half = np.sum(level) * (moved[1] - moved[0]) * PASSAGE.speed
    assert half == pytest.approx(by_hand / 2, rel=0.01)  # the secondary waves have no mean but that of their envelope


def test_the_kinds_of_ships_are_those_of_the_formula():
    assert get_args(Ship.model_fields["kind"].annotation) == KINDS
    heights = [wave(kind=kind).passage.height for kind in ("tug", "push convoy")]
    assert heights[0] == pytest.approx(2 * heights[1])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"bed_width": ...}, "neither bed_width nor area is given"),
        ({"area": 58.0}, "both bed_width and area are given"),
        ({"bed_width": 40.0}, "bed_width = 40 is above width = 34 m"),
        ({"beam": 35.0}, "beam = 35 must be below width = 34 m"),
        ({"distance": 40.0}, r"distance = 40: the ship would leave the channel.* 29 m; 0 < distance <= 14.5 m"),
        ({"distance": 20.0}, r"distance = 20: the ship would be nearer to the other bank.*; 0 < distance <= 14.5 m"),
        ({"speed": -1.0}, "speed"),
        ({"midship": 1.2}, "midship"),
        ({"kind": "liner"}, "kind"),
    ],
)
def test_a_ship_beside_its_channel_is_refused_by_the_table(changes, said):
    with pytest.raises(ValidationError, match=said):
        ship(**changes)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"speed": 3.0}, r"ship.speed = 3: 0 < speed < 2.461 m/s, the limit speed .* 11.2% of this channel \(Schijf\)"),
        ({"beam": 10.0, "draught": 6.0}, r"ship.beam = 10 m and draught = 6 m fill 60 m2, the whole channel has 58 m2"),
        ({"draught": 1.9, "speed": 2.0}, r"ship.draught = 1.9 m, and 0.\d+ m by which .* the bed of 2 m"),
        ({"bed_width": ..., "area": 80.0}, r"ship.area = 80: a channel 34 m wide has at most 68 m2"),
        ({"toe": 0.0}, r"ship.toe = 0: the waves come from x = 0 m"),
        ({"speed": 1e-6}, r"ship.speed = 1e-06: .* 1000 at most; speed > 0.35\d* m/s"),
        ({"length": 1.5}, r"ship.length = 1.5 m: a stern wave 0.272 m high is 2.84 m long"),
        ({"gravity": 3.7}, r"fluid.gravity = 3.7"),
    ],
)
def test_a_ship_that_no_formula_holds_for_is_refused(changes, said):
    with pytest.raises(WaveError, match=said):
        wave(**changes)
