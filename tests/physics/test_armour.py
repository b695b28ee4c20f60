"""The outer stones of an armour: still water, imposed gradients, water that comes up through a bed; the answers."""

from __future__ import annotations

import csv
from typing import Any

import numpy as np
import pytest
from situations import simulation

import houle
from houle import design
from houle.analysis import critical_gradient
from houle.case.model import load
from houle.check.rules import check
from houle.errors import CaseError
from houle.output.netcdf import Table, Variable, times
from houle.results.answers import armour, table
from houle.results.answers.given import Given
from houle.results.answers.outline import outline_of
from houle.results.answers.sea import sea_of
from houle.results.armour import TABLE, Stones

LEVEL, STONE = 0.5, 0.12
ROCK = {"name": "rock", "porosity": 0.4, "grain_diameter": 0.1, "resistance": {"law": "van-gent-1995"}}
SUBMERGED = 1.65 * 0.6  # weight of the stones in water over that of water as large as the layer


def dyke(spacing: float = 0.04, **changes: Any) -> dict[str, Any]:
    """Still water before and in a slope of 1:2 that comes out of the water at x = 1.5 m."""
    return {
        "case": {"name": "dyke"},
        "domain": {"size": [2.4, 0.8], "spacing": spacing},
        "water": [{"below": LEVEL}],
        "porous": [{**ROCK, "polygon": [[0.5, 0.0], [2.4, 0.0], [2.4, 0.7], [1.9, 0.7]]}],
        "armour": [{"body": "rock", "stone": STONE, **changes}],
        "time": {"end": 1.0},
        "numerics": {"tolerance": 1e-12},
    }


def seen(case: dict[str, Any], head: Any = None) -> dict[str, np.ndarray]:
    """What is seen of a case at its start; head(points) [m] takes the place of that of the water in its wet cells."""
    sim = simulation(case)
    if head is not None:
        flow, points = sim.flow, sim.flow.grid.points()
        pressure = -flow.gravity[-1] * (head(points) - points[..., -1])
        flow.pressure[...] = np.where(flow.pressure != 0.0, pressure.reshape(flow.pressure.shape), 0.0)
    return {key: np.asarray(value) for key, value in sim.sample().items() if key.startswith("armour")}


@pytest.mark.parametrize("stone", [STONE, None])
def test_still_water_pushes_no_stone(stone):
    """Under water, above it, and where its level lies within a stone."""
    case = dyke()
    case["armour"] = [{"body": "rock"} if stone is None else {"body": "rock", "stone": stone}]
    found = seen(case)
    length = np.hypot(1.4, 0.7) + 0.5
    fits = length / (stone or 0.084) - 2  # at the toe a stone lies whole in the body from two of them on
    assert abs(len(found["armour_gradient"]) - fits) <= 1
    for name, value in found.items():
        assert value == pytest.approx(np.zeros(value.shape), abs=1e-6), name


@pytest.mark.parametrize("spacing", [0.04, 0.02])
@pytest.mark.parametrize(("out", "down"), [(0.3, 0.0), (0.0, 0.2), (0.3, 0.2)])
def test_gradients_of_a_uniform_seepage_are_exact(spacing, out, down):
    """A head that falls towards the face, and down along it in and over the slope, at all stones well under water."""
    normal, along = np.array([-1, 2]) / np.sqrt(5), np.array([-2, -1]) / np.sqrt(5)

    def head(points: np.ndarray) -> np.ndarray:
        away = (points - [0.5, 0.0]) @ normal
        return LEVEL - out * np.minimum(away, 0.0) - down * ((points - [0.5, 0.0]) @ along)

    found = seen(dyke(spacing), head)
    assert found["armour_gradient"][:5] == pytest.approx(out, abs=1e-6)
    assert found["armour_gradient_down"][:5] == pytest.approx(down, abs=1e-6)


def upflow(spacing: float = 0.02) -> dict[str, Any]:
    """Water goes down on the left of a wall and comes up through a level bed with linear drag, at 2 mm/s."""
    rise = 0.16 * 1000.0 * 0.002 / 9.81
    return {
        "case": {"name": "upflow"},
        "domain": {"size": [1.1, 0.5], "spacing": spacing},
        "water": [{"below": 0.44}, {"box": [[0.0, 0.2], [0.36, 0.44 + rise]]}],
        "solid": [{"box": [[0.36, 0.16], [0.44, 0.5]]}, {"box": [[0.8, 0.0], [0.88, 0.36]]}],
        "porous": [
            {"name": "bed", "box": [[0.44, 0.2], [0.8, 0.36]], "porosity": 0.4, "resistance": {"a": 1000.0, "b": 0.0}}
        ],
        "armour": [{"body": "bed", "stone": 0.08}],
        "open": [{"side": "left", "discharge": 0.002 * 0.36}, {"side": "right", "level": 0.44}],
        "time": {"end": 2.0},
        "output": {"every": 1.0, "series_every": 0.02},
    }


def test_water_that_comes_up_pushes_stones_as_the_infinite_slope_has_it(tmp_path):
    """Each stone has Darcy's gradient of the water in it, the force that with (s - 1)(1 - n) is the critical one."""
    found = houle.run(upflow(), tmp_path / "run", progress=False)
    series = found.series.isel(time=slice(50, None))  # the second second
    gradient = series["armour_gradient"].mean("time").values
    velocity = series["armour_velocity"].transpose("armour", "time", ...).values[:, :, -1].mean(axis=1)
    assert len(gradient) == 4  # of 80 mm on 360 mm
    assert gradient == pytest.approx(1000.0 * velocity / 9.81, rel=2e-3)
    assert gradient == pytest.approx(1000.0 * 0.002 / 9.81, rel=0.02)  # the levels swing a little
    rows = {row["name"]: row for row in found.summary["answers"]["rows"]}
    row = rows["armour armour-1, force out over submerged weight"]
    assert row["value"] == pytest.approx(gradient.mean() / SUBMERGED, rel=0.05)  # the largest of all rows
    assert row["formula_value"] == 1.0 and "no stone moves" in row["note"]
    assert critical_gradient(0.4, 2.65) == pytest.approx(SUBMERGED)  # where that row would be 1
    with (tmp_path / "run" / TABLE).open() as file:
        stones = list(csv.DictReader(file))
    assert [float(stone["x"]) for stone in stones] == pytest.approx([0.485, 0.575, 0.665, 0.755])
    assert max(float(stone["force_over_weight"]) for stone in stones) == row["value"]


def test_the_change_of_the_velocity_takes_a_part_of_the_gradient():
    """A gradient that does nothing but move the water in the pores, sin(w t), pushes no stone."""
    case, time = load(dyke(x=[0.5, 1.8])), np.arange(0.0, 4.0, 0.01)
    omega, count = 2 * np.pi / 1.0, 10
    normal = np.array([-1, 2]) / np.sqrt(5)
    speed = 0.1 * (1 - np.cos(omega * time))

    def given(gradient: np.ndarray) -> Given:
        stations = {
            "armour": Variable(("armour",), np.array(["armour-1"] * count), {}),
            "armour_gradient": Variable(("armour", "time"), np.tile(gradient, (count, 1)), {}),
            "armour_gradient_down": Variable(("armour", "time"), np.zeros((count, len(time))), {}),
            "armour_speed": Variable(("armour", "time"), np.ones((count, len(time))), {}),
            "armour_velocity": Variable(
                ("armour", "axis", "time"), np.tile(normal[:, None] * speed, (count, 1, 1)), {}
            ),
        }
        return Given(case, Table(stations, {"time": times(time)}, {}), None)

    accelerating = 0.1 * omega * np.sin(omega * time) / 9.81
    found = Stones(given(accelerating), case.armour[0])
    assert found.force == pytest.approx(np.zeros(found.force.shape), abs=0.002 * accelerating.max())
    assert found.largest(found.pores).value == pytest.approx(0.2 / 0.4, rel=1e-3)
    found = Stones(given(accelerating + 0.2), case.armour[0])
    assert found.largest(found.force).value == pytest.approx(0.2 / SUBMERGED, rel=0.005)


FLUME: dict[str, Any] = {
    "case": {"name": "flume"},
    "domain": {"size": [9.6, 0.8], "spacing": 0.02},
    "water": [{"below": 0.4}],
    "waves": {"kind": "jonswap", "height": 0.1, "period": 1.6, "depth": 0.4, "zone": {"x": [0.0, 3.5]}},
    "porous": [
        {**ROCK, "name": "armour", "polygon": [[6.0, 0.0], [6.75, 0.5], [6.95, 0.5], [7.7, 0.0]]},
        {**ROCK, "name": "core", "grain_diameter": 0.02, "polygon": [[6.2, 0.0], [6.7, 0.3], [7.0, 0.3], [7.5, 0.0]]},
    ],
    "armour": [{"name": "front", "body": "armour", "x": [6.0, 6.9]}],
    "time": {"end": 200.0},
}


@pytest.mark.parametrize(("changes", "P"), [({}, 0.5), ({"permeability": 0.4}, 0.4)])
def test_damage_stands_beside_by_formula_alone(changes, P):
    case = load(FLUME | {"armour": [{**FLUME["armour"][0], **changes}]})
    sea = sea_of(case)
    time = np.arange(0.0, 200.0, 0.1)
    given = Given(case, Table({"armour": Variable(("armour",), np.array([]), {})}, {"time": times(time)}, {}), sea)
    points = Stones(given, case.armour[0]).face.points
    crest = float(points[np.argmax(points[:, 1]), 0])
    entry = {"armour": "front", "size": 0.084, "buoyant": 1.65, "place": float(points[0, 0]), "crest": crest}
    (_, ask) = list(armour.questions(given, [[entry]]))[-1]
    (row,) = ask()
    cot = outline_of(case, sea, crest).cot_slope
    assert cot == pytest.approx(1.5, rel=0.02)
    waves = (199.9 - sea.start(points[0, 0])) / sea.mean
    assert 6.0 < points[0, 0] < 6.3
    keys = {"wave_height": 0.1, "cot_slope": cot, "D_n50": 0.084, "waves": waves, "buoyant_density": 1.65}
    meer = design.armour_damage_van_der_meer(mean_period=sea.mean, permeability=P, **keys)
    gent = design.armour_damage_van_gent(core_to_armour=0.2, **keys)
    assert not row.answered and [one.value for one in row.formulas] == pytest.approx([meer.S, gent.S], rel=1e-3)
    assert f"P {P:g}" in row.formulas[0].name and "no stone moves" in row.note
    told = table.lines(table.entry([row]))
    assert [name for name, _ in told] == [row.name, *(f"  by {one.name}" for one in row.formulas)]


@pytest.mark.parametrize(
    ("changes", "level", "said"),
    [
        ({"stone": 0.9}, "error", r"armour.armour-1: no stone of 0.9 m lies under a face"),
        ({"x": [0.2, 1.0]}, "error", r"armour.armour-1.x = \[0.2, 1.0\] reaches beside porous.rock, 0.5 <= x <= 2.4"),
        ({"stone_density": 900.0}, "error", r"stone_density = 900 kg/m3 floats in water of 1000"),
        ({"stone": 0.05}, "warning", r"a stone of 0.05 m is 1.2 spacings: .* needs 2, domain.spacing = 0.025"),
    ],
)  # fmt: skip
def test_check_says_where_an_armour_is_none(changes, level, said):
    (found,) = (f for f in check(load(dyke(**changes))) if f.key.startswith("armour"))
    assert found.level == level
    with pytest.raises(AssertionError, match=said):
        raise AssertionError(str(found))


def test_a_body_without_grains_needs_a_stone():
    case = dyke()
    case["porous"][0] |= {"resistance": {"a": 10.0, "b": 50.0}, "grain_diameter": None}
    case["armour"] = [{"body": "rock"}]
    (found,) = (str(f) for f in check(load(case)) if f.key.startswith("armour"))
    assert "armour.armour-1.stone is missing, and porous.rock has no grain_diameter" in found


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"body": "sand"}, r'armour.armour-1.body = "sand" is the name of no porous body'),
        ({"x": [1.8, 0.8]}, r"armour.armour-1.x = \[1.8, 0.8\]: the smaller x first"),
        ({"y": 0.1}, r"armour.armour-1.y is given in 2D"),
        ({"permeability": 0.7}, r"permeability"),
    ],
)
def test_a_table_that_is_no_armour_is_refused(changes, said):
    with pytest.raises(CaseError, match=said):
        load(dyke(**changes))


def test_an_armour_that_faces_right_and_one_in_3d_are_seen_alike():
    def head(points: np.ndarray) -> np.ndarray:
        return LEVEL + 0.1 * points[..., 0]

    def mirrored(points: np.ndarray) -> np.ndarray:
        return LEVEL + 0.1 * (2.4 - points[..., 0])

    flat, case = seen(dyke(), head), dyke()
    case["porous"][0]["polygon"] = [[2.4 - x, z] for x, z in case["porous"][0]["polygon"]]
    turned, deep = seen(case, mirrored), dyke(y=0.06)
    deep["domain"] = {"size": [2.4, 0.12, 0.8], "spacing": 0.04}
    solid = seen(deep, head)
    for key in ("armour_gradient", "armour_gradient_down"):
        assert np.abs(flat[key][:6]).min() > 0.01
        assert turned[key][::-1][:6] == pytest.approx(flat[key][:6], abs=1e-5)
        assert solid[key][:6] == pytest.approx(flat[key][:6], abs=1e-5)
