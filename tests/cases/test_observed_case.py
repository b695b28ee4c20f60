"""Observables in the case file: what is accepted, what is said about mistakes, and how they stand in series.nc."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import houle
from houle.check.rules import check, require
from houle.errors import CaseError

CASE: dict[str, Any] = {
    "case": {"name": "tank"},
    "domain": {"size": [0.4, 0.2], "spacing": 0.02},
    "water": [{"box": [[0.0, 0.0], [0.2, 0.15]]}],
    "porous": [
        {"name": "core", "box": [[0.24, 0.0], [0.32, 0.1]], "porosity": 0.4, "resistance": {"a": 5.0, "b": 5.0}}
    ],
    "solid": [{"name": "caisson", "box": [[0.34, 0.0], [0.4, 0.12]]}],
    "time": {"end": 0.1},
    "output": {"every": 0.05, "series_every": 0.01},
}
EVERYTHING: dict[str, Any] = {
    "runup": [{"name": "face", "x": [0.1, 0.4]}],
    "overtopping": [{"x": 0.37, "level": 0.12}],
    "flux": [{"x": 0.28}, {"x": 0.28, "between": [0.0, 0.05]}],
    "phreatic": [{"body": "core", "x": [0.25, 0.28]}, {"name": "line", "body": "core"}],
    "force": [{"body": "caisson"}, {"body": "core", "about": [0.3, 0.0]}, {"name": "wall", "side": "right"}],
}


@pytest.mark.parametrize(
    ("table", "rows", "words"),
    [
        ("force", [{"body": "caison"}], ['"caison" is the name of no', 'Did you mean "caisson"?']),
        ("force", [{"body": "core", "side": "left"}], ["both body and side"]),
        ("force", [{}], ["neither body nor side"]),
        ("force", [{"side": "front"}], ["3D only"]),
        ("force", [{"side": "left", "about": [0.0, 0.0, 0.0]}], ["3 numbers", "give 2"]),
        ("phreatic", [{"body": "caisson"}], ["no porous body", "There are: core"]),
        ("phreatic", [{"body": "core", "y": 0.1}], ["given in 2D"]),
        ("phreatic", [{"body": "core", "x": [0.28, 0.5]}], ["= 0.5 lies beside porous.core, 0.24 <= x <= 0.32"]),
        ("runup", [{"x": [0.1, 0.5]}], ["= 0.5 lies outside the domain"]),
        ("runup", [{"x": [0.1, 0.11]}], ["shorter than 2 spacings"]),
        ("overtopping", [{"x": 30.0}], ["overtopping.O1.x = 30 lies outside", "Were cm given?"]),
        ("overtopping", [{"x": 0.3, "level": 0.3}], ["0.3 lies outside the domain, 0 <= z <= 0.2"]),
        ("flux", [{"x": 0.3, "between": [0.1, 0.05]}], ["the lower level stands first"]),
        ("flux", [{"x": 0.3, "name": "Q"}, {"x": 0.2, "name": "Q"}], ["given twice"]),
    ],
)
def test_mistakes_are_explained(table, rows, words):
    with pytest.raises(CaseError) as caught:
        require(houle.load({**CASE, table: rows}))
    for word in words:
        assert word in str(caught.value)


def test_overtopping_needs_a_side_behind_the_crest():
    joined = {"size": [0.4, 0.2], "spacing": 0.02, "walls": {"x": "periodic"}}
    with pytest.raises(CaseError, match="periodic"):
        require(houle.load({**CASE, "domain": joined, "overtopping": [{"x": 0.1}]}))


def test_overtopping_keeps_clear_of_open_sides():
    """Where particles come and go their water does not move past a section."""
    case = {**CASE, "open": [{"side": "left", "level": 0.15}]}
    require(houle.load({**case, "overtopping": [{"x": 0.03}]}))
    with pytest.raises(CaseError, match=r"overtopping\.O1\.x = 0\.01 lies within a spacing"):
        require(houle.load({**case, "overtopping": [{"x": 0.01}]}))


def test_a_gauge_in_a_wall_is_warned_of():
    walls = [{"name": "wall", "box": [[0.34, 0.0], [0.4, 0.2]]}, {"name": "sill", "box": [[0.0, 0.0], [0.06, 0.1]]}]
    case = {**CASE, "solid": walls, "water": [{"below": 0.15}], "gauge": [{"x": x} for x in (0.2, 0.37, 0.03)]}
    found = check(houle.load(case))
    said = [f for f in found if f.key.startswith("gauge")]
    assert [(f.level, f.key) for f in said] == [("warning", "gauge.G2.x")]
    assert "solid.wall" in said[0].text


def test_a_case_with_everything_comes_back_from_its_file():
    case = houle.load({**CASE, **EVERYTHING})
    require(case)
    assert houle.load(case.to_dict()).hash == case.hash
    assert [row.name for row in case.force] == ["F1", "F2", "wall"]


def test_the_series_of_a_run_have_names_units_and_places(tmp_path):
    series = houle.run(houle.load({**CASE, **EVERYTHING}), out=tmp_path / "run").series
    expected = {
        "runup_x": (("runup", "time"), "m"),
        "runup_level": (("runup", "time"), "m"),
        "overtopping_volume": (("overtopping", "time"), "m2"),
        "overtopping_discharge": (("overtopping", "time"), "m2 s-1"),
        "discharge": (("flux", "time"), "m2 s-1"),
        "phreatic_level": (("phreatic", "time"), "m"),
        "force": (("structure", "time", "axis"), "N m-1"),
        "drag_force": (("structure", "time", "axis"), "N m-1"),
        "moment": (("structure", "time"), "N"),
    }
    for name, (dimensions, unit) in expected.items():
        assert series[name].dims == dimensions, name
        assert series[name].attrs["units"] == unit, name
        assert series[name].shape[1] == 11, name
    assert list(series.structure.values) == ["F1", "F2", "wall"]
    assert series.structure_about_x.values == pytest.approx([0.37, 0.3, 0.4])  # middle of the base, given, the foot
    assert series.force.sel(structure="wall", axis="x").values[0] == 0.0
    assert list(series.phreatic.values) == ["L1"] * 2 + ["line"] * 4
    assert series.phreatic_x.values == pytest.approx([0.25, 0.28, 0.25, 0.27, 0.29, 0.31])
    assert series.flux_to.values == pytest.approx([0.2, 0.05])
    assert np.isfinite(series.runup_level.values).all()


def test_a_resumed_run_writes_the_same_series(tmp_path):
    case = houle.load({**CASE, **EVERYTHING})
    whole = houle.run(case, out=tmp_path / "whole").series
    houle.run(case, out=tmp_path / "parts", until=0.04)
    parts = houle.resume(tmp_path / "parts").series
    for name in whole.data_vars:
        assert np.array_equal(whole[name].values, parts[name].values, equal_nan=True), name


def test_a_run_in_3d_has_moments_about_three_axes(tmp_path):
    case = {
        **CASE,
        "domain": {"size": [0.4, 0.12, 0.2], "spacing": 0.04},
        "water": [{"box": [[0.0, 0.0, 0.0], [0.2, 0.12, 0.15]]}],
        "porous": [],
        "solid": [{"name": "pier", "box": [[0.22, 0.04, 0.0], [0.32, 0.08, 0.2]]}],
        "force": [{"body": "pier"}],
        "overtopping": [{"x": 0.2}],
    }
    series = houle.run(houle.load(case), out=tmp_path / "run").series
    assert series.moment.dims == ("structure", "time", "axis")
    assert series.moment.attrs["units"] == "N m"
    assert series.overtopping_volume.attrs["units"] == "m3"
    last = series.force.values[0, -1]
    assert last[0] > 0.1  # pushed by the front of the wave
    assert abs(last[1]) < 1e-3 * last[0]  # symmetric
