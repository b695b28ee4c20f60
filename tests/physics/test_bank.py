"""A bank in still water and under a ship: pressures, safety, and the drawdown that comes to it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from situations import simulation

import houle
from houle.case.model import load
from houle.check.rules import check
from houle.errors import CaseError
from houle.results.answers import table
from houle.results.bank import Seen, stability
from houle.waves.ship import ShipWave

LEVEL, RHO_G = 0.5, 1000.0 * 9.81
GRAVEL = {"name": "gravel", "porosity": 0.4, "grain_diameter": 0.01, "resistance": {"law": "van-gent-1995"}}
FACE = {"body": "gravel", "x": [0.8, 1.8], "points": 5, "depth": 0.1, "friction_angle": 35.0}


def dyke(**changes: Any) -> dict[str, Any]:
    """Still water before and in a slope of 1:2 that comes out of the water at x = 1.5 m."""
    polygon = [[0.5, 0.0], [2.4, 0.0], [2.4, 0.7], [1.9, 0.7]]
    return {
        "case": {"name": "dyke"},
        "domain": {"size": [2.4, 0.8], "spacing": 0.04},
        "water": [{"below": LEVEL}],
        "porous": [{**GRAVEL, "polygon": polygon}],
        "bank": [{**FACE, **changes}],
        "time": {"end": 1.0},
        "numerics": {"tolerance": 1e-12},
    }


def test_still_water_presses_with_its_depth_and_the_slope_is_as_safe_as_dry_grains():
    case = load(dyke())
    sim = simulation(dyke())
    seen = sim.sample()
    x = 0.8 + 0.2 * np.arange(0.5, 5)
    z, cos = (x - 0.5) / 2, 2 / np.sqrt(5)
    depth = np.maximum(LEVEL - z, 0.0)
    assert seen["bank_pressure_face"] == pytest.approx(RHO_G * depth, abs=0.01)
    assert seen["bank_pressure_inside"] == pytest.approx(RHO_G * np.maximum(LEVEL - z + 0.1 * cos, 0.0), abs=0.01)
    assert seen["bank_speed"] == pytest.approx(0.0, abs=1e-9)
    under = {key: np.repeat(np.asarray(seen[key])[:3, None], 2, axis=1) for key in seen if key.startswith("bank")}
    table = {**FACE, "x": [0.8, 1.4], "points": 3}
    found = stability(
        load(dyke(**table)), "bank-1",
        Seen(np.array([0.0, 1.0]), under["bank_pressure_face"], under["bank_pressure_inside"], under["bank_speed"]),
    )  # fmt: skip
    assert found.safety.value == pytest.approx(np.tan(np.radians(35.0)) / 0.5, rel=1e-4) == found.still
    assert found.gradient.value == pytest.approx(0.0, abs=1e-4) and found.excess.value == pytest.approx(0.0, abs=0.1)
    assert found.critical == pytest.approx(1.65 * 0.6 * cos) and found.unstable == found.lifting == found.moving == 0.0
    assert case.bank[0].name == "bank-1"


def test_a_run_ends_with_the_answers_about_its_banks(tmp_path):
    """Water at rest before a bank whose pores stand higher: it comes out, and the slope is less safe than at rest."""
    case = dyke() | {"time": {"end": 0.2}, "output": {"every": 0.1, "series_every": 0.02}}
    case["water"] = [{"box": [[0.0, 0.0], [1.0, 0.3]]}, {"polygon": [[1.0, 0.0], [2.4, 0.0], [2.4, 0.5], [1.0, 0.5]]}]
    found = houle.run(case, tmp_path / "run", progress=False)
    (bank,) = found.summary["bank"]
    assert bank["bank"] == "bank-1" and bank["critical"] == pytest.approx(1.65 * 0.6 * 2 / np.sqrt(5))
    assert 0.0 < bank["safety"]["value"] < bank["still"] and bank["gradient"]["value"] > 0.0
    assert bank["shields"]["value"] == bank["shields_in_section"] > 0.0 == bank["current"]
    rows = {row["name"]: row for row in found.summary["answers"]["rows"]}
    for key, name, limit in (
        ("safety", "factor of safety", "still"),
        ("gradient", "exit gradient", "critical"),
        ("shields", "Shields number", "mobile"),
    ):
        row = rows[f"bank bank-1, {name}"]
        assert row["value"] == bank[key]["value"] and row["formula_value"] == bank[limit]
        assert f"at x = {bank[key]['x']:.4g} m" in row["note"]
    assert rows["bank bank-1, excess pore pressure"]["unit"] == "Pa"
    assert (tmp_path / "run" / "answers.csv").read_text().count("bank bank-1") == 4


def test_a_body_without_grains_has_no_shields_number(tmp_path):
    case = dyke() | {"time": {"end": 0.04}, "output": {"every": 0.02, "series_every": 0.02}}
    del case["porous"][0]["grain_diameter"]
    case["porous"][0]["resistance"] = {"a": 100.0, "b": 500.0}
    found = houle.run(case, tmp_path / "run", progress=False)
    (bank,) = found.summary["bank"]
    assert bank["shields"] is None
    names = [row["name"].partition(", ")[2] for row in found.summary["answers"]["rows"]]
    assert names == ["factor of safety", "exit gradient", "excess pore pressure"]


def test_a_bank_in_a_solid_and_one_of_no_grains_are_told(tmp_path):
    case = dyke() | {"solid": [{"name": "wall", "box": [[1.2, 0.3], [1.4, 0.8]]}]}
    found = [str(f) for f in check(load(case)) if f.key == "bank.bank-1.x"]
    assert len(found) == 1 and "lies in solid.wall" in found[0]
    case = dyke() | {"time": {"end": 0.04}, "output": {"every": 0.02, "series_every": 0.02}}
    case["porous"][0]["porosity"] = 1.0
    found = houle.run(case, tmp_path / "run", progress=False).summary
    assert "0 < porosity < 1" in found["bank"][0]["problem"]
    ((name, why),) = table.lines(found["answers"])
    assert name == "bank bank-1" and "0 < porosity < 1" in why


def test_a_bank_that_faces_right_and_one_in_3d_are_seen_alike():
    flat = simulation(dyke()).sample()
    case = dyke()
    case["porous"][0]["polygon"] = [[2.4 - x, z] for x, z in case["porous"][0]["polygon"]]
    case["bank"][0]["x"] = [0.6, 1.6]
    mirrored = simulation(case).sample()
    deep = dyke(y=0.06)
    deep["domain"] = {"size": [2.4, 0.12, 0.8], "spacing": 0.04}
    solid = simulation(deep).sample()
    for key in ("bank_pressure_face", "bank_pressure_inside", "bank_speed"):
        assert mirrored[key][::-1] == pytest.approx(flat[key], abs=0.01)
        assert solid[key] == pytest.approx(flat[key], abs=0.01)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"x": [0.3, 1.8]}, r"bank.bank-1.x = \[0.3, 1.8\] reaches beside porous.gravel, 0.5 <= x <= 2.4 m"),
        ({"depth": 0.9}, r"bank.bank-1.depth = 0.9 m: at x = .* no longer in porous.gravel"),
        ({"grain_density": 800.0}, r"bank.bank-1.grain_density = 800 kg/m3 floats in water of 1000 kg/m3"),
        ({"depth": 0.05}, r"bank.bank-1.depth = 0.05 m is 1.2 spacings: .* depth = 0.08 or domain.spacing = 0.025"),
    ],
)  # fmt: skip
def test_check_says_where_a_bank_is_none(changes, said):
    found = [str(f) for f in check(load(dyke(**changes))) if f.key.startswith("bank")]
    assert len(found) == 1
    with pytest.raises(AssertionError, match=said):
        raise AssertionError(found[0])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"body": "sand"}, r'bank.bank-1.body = "sand" is the name of no porous body'),
        ({"x": [1.8, 0.8]}, r"bank.bank-1.x = \[1.8, 0.8\]: the smaller x first"),
        ({"y": 0.1}, r"bank.bank-1.y is given in 2D"),
        ({"friction_angle": 95.0}, r"friction_angle"),
        ({"points": 1}, r"points"),
    ],
)
def test_a_table_that_is_no_bank_is_refused(changes, said):
    with pytest.raises(CaseError, match=said):
        load(dyke(**changes))


# ---- a ship ----------------------------------------------------------------------------------------------------------

BARGE = {
    "kind": "motor ship", "length": 16.0, "beam": 2.5, "draught": 0.6, "speed": 1.5, "distance": 5.0, "width": 18.0,
    "area": 18.0, "toe": 8.0,
}  # fmt: skip


def channel(**changes: Any) -> dict[str, Any]:
    """Half a channel 1 m deep with a wall for a bank, 8 m from its axis."""
    return {
        "case": {"name": "channel"},
        "domain": {"size": [8.0, 1.5], "spacing": 0.125},
        "water": [{"below": 1.0}],
        "waves": {"kind": "ship", "depth": 1.0, "zone": {"x": [0.0, 3.0]}},
        "ship": {**BARGE, **changes},
        "open": [{"side": "left", "level": 1.0, "velocity": 0.0}],
        "gauge": [{"name": "bank", "x": 7.9}],
        "time": {"end": 40.0},
    }


def test_the_drawdown_of_the_formulas_comes_to_the_bank():
    """A wall doubles what comes to it. The level while it is low, and the rise after it, within 5 % of the drawdown."""
    case = channel(toe=7.99)
    wave = load(case).wave
    assert isinstance(wave, ShipWave)
    ship, sim = wave.passage, simulation(case)
    time, level = [], []
    while sim.time < ship.end:
        sim.advance(ship.end)
        time.append(sim.time)
        level.append(float(sim.sample()["eta"][0]) - 1.0)
    t, eta = np.array(time), np.array(level)
    (start, end), drawdown = ship.trough, ship.drawdown
    low = eta[(t > start + 1.0) & (t < end)]
    assert low.mean() == pytest.approx(-drawdown, rel=0.05)
    assert abs(t[np.argmax(eta < -drawdown / 2)] - ship.time) < 0.5  # the bow passes: half of the fall
    assert eta[t > ship.end - 1.0].mean() == pytest.approx(0.0, abs=0.1 * drawdown)
    assert abs(sim.sample()["volume_drift"]) < 1e-12


def test_check_says_what_is_doubtful_about_a_ship():
    sound = load(channel(toe=7.9))
    assert [str(f) for f in check(sound) if f.level != "info" and f.key.startswith("ship")] == []
    fast = [str(f) for f in check(load(channel(toe=7.9, speed=1.88)))]
    assert any("ship.speed = 1.88 m/s is 9" in text and "of the limit speed" in text for text in fast)
    early = [str(f) for f in check(load(channel(toe=7.9, time=1.0)))]
    assert any("ship.time = 1 s" in text and "before the run begins" in text for text in early)
    outside = [str(f) for f in check(load(channel(toe=9.0)))]
    assert any(text.startswith("ship.toe = 9 lies outside the domain") for text in outside)
    coarse = [str(f) for f in check(load({**channel(toe=7.9), "domain": {"size": [8.0, 1.5], "spacing": 0.1}}))]
    assert any("cells in a secondary wave of L = 0.963 m" in text for text in coarse)
    short = [str(f) for f in check(load({**channel(toe=7.9), "time": {"end": 15.0}}))]
    assert any("time.end = 15 s: the bow passes at" in text for text in short)


def test_a_ship_and_its_waves_come_together():
    case = channel()
    with pytest.raises(CaseError, match=r'waves.kind = "ship" needs the table \[ship\]'):
        load({k: v for k, v in case.items() if k != "ship"})
    with pytest.raises(CaseError, match=r'ship: \[waves\] with kind = "ship"'):
        load({k: v for k, v in case.items() if k != "waves"})
    with pytest.raises(
        CaseError, match=r'height does not belong to kind = "ship": remove it, it follows from \[ship\]'
    ):
        load({**case, "waves": {**case["waves"], "height": 0.1}})
    with pytest.raises(CaseError, match=r"waves.current = 0.5: a ship's waves come straight at the bank"):
        load({**case, "waves": {**case["waves"], "current": 0.5}})
    assert load(load(case).to_dict()) == load(case)
