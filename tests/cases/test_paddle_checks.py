"""What `houle check` says of pistons and absorbing walls."""

from __future__ import annotations

import copy
import re
from typing import Any

import numpy as np
import pytest

from houle import load
from houle.case.reading import override
from houle.check.gauges import steady
from houle.check.report import absorber_rows, wave_rows
from houle.check.rules import check, require
from houle.errors import CaseError

FLUME: dict[str, Any] = {
    "case": {"name": "flume"},
    "domain": {"size": [8.0, 0.4], "spacing": 0.02},
    "water": [{"below": 0.25}],
    "waves": {"kind": "regular", "height": 0.04, "period": 1.2, "depth": 0.25, "piston": {"x": 0.4, "absorb": True}},
    "absorber": [{"x": 7.6}],
    "gauge": [{"x": 2.0}, {"x": 2.3}, {"x": 2.8}],
    "time": {"end": 20.0},
}


def flume(**changes):
    data = copy.deepcopy(FLUME)
    for key, value in changes.items():
        override(data, key.replace("__", "."), value)
    return data


def errors(data):
    return [str(f) for f in check(load(data)) if f.level == "error"]


def test_a_sound_flume_is_sound():
    assert errors(FLUME) == []
    told = dict(wave_rows(load(FLUME)))["made by"]
    assert "piston at x = 0.4 m, stroke 0.0436 m, H/stroke = 0.918" in told and "second order; absorbs" in told
    ((name, words),) = absorber_rows(load(FLUME))
    assert name == "absorber.absorber-1" and "right end, at rest at x = 7.6 m; sends back" in words
    assert "see steady waves" in str(steady(load(FLUME)))


def test_a_solitary_wave_follows_the_water():
    data = {**FLUME, "waves": {"kind": "solitary", "height": 0.05, "depth": 0.25, "piston": {"x": 0.4}}}
    data["absorber"] = [{"x": 7.0}]
    assert errors(data) == []
    assert "goes with the water (Goring)" in dict(wave_rows(load(data)))["made by"]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"waves__piston__x": 0.06}, r"waves\.piston\.x = 0.06 m: it goes 0.\d+ m to the left and needs 3 cells"),
        ({"waves__piston__x": 9.0}, r"waves\.piston\.x = 9 lies outside the domain, 0 < x < 8 m"),
        ({"absorber": [{"x": 7.97}]}, r"it goes 0.\d+ m to the right and needs 3 cells.*or longer"),
        ({"absorber": [{"x": 1.0, "side": "left"}]}, r"close the water at its left end: remove one; .*absorb = true"),
        ({"absorber": [{"x": 7.0, "period": 0.03}]}, r"period = 0.03 s: waves of 0.0014 m, less than two cells of"),
        (
            {"waves__piston": None, "waves__source": {"x": 7.0, "width": 1.0}},
            r"waves\.source makes waves from x = 6\.25 to 7\.75 m, but absorber.* no water is behind it",
        ),
        ({"gate": [{"x": 0.2, "speed": 1.0}]}, r"gate\[0\]\.x = 0.2 m is behind waves\.piston, where no water is"),
        ({"gate": [{"x": 7.54, "speed": 1.0}]}, r"gate\[0\]\.x = 7.54 m: absorber.* needs 3 cells, 0.06 m, before it"),
        ({"numerics": {"scheme": "jh2020"}}, r'needs numerics.scheme = "houle"'),
        ({"domain__walls": {"x": "periodic"}}, r"is a wall across the tank"),
        ({"solid": [{"box": [[0.5, 0.0], [1.0, 0.1]]}]}, r"solid.*stands in the way of waves\.piston"),
        ({"sponge": [{"box": [[0.0, 0.0], [1.0, 0.4]]}]}, r"lies where waves\.piston moves"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_with_its_cure(changes, words):
    with pytest.raises(CaseError, match=words):
        require(load(flume(**changes)))


def test_gauges_behind_a_wall_and_forces_on_a_dry_one_are_warned_of():
    data = flume(gauge=[{"x": 0.2}, {"x": 7.9}, {"x": 3.0}], force=[{"name": "F1", "side": "right"}])
    told = [str(f) for f in check(load(data)) if f.level == "warning"]
    assert any("gauge.G1.x = 0.2 m is behind waves.piston" in t for t in told)
    assert any("gauge.G2.x = 7.9 m is behind absorber.absorber-1" in t for t in told)
    assert any('force.F1.side = "right" is a dry wall behind absorber.absorber-1' in t for t in told)


def test_one_maker_is_given():
    with pytest.raises(CaseError, match=r"source and piston are given together; give exactly one of .*piston = \{x"):
        load(flume(waves__source={"x": 2.0}))


# ---- a paddle moved from a file --------------------------------------------------------------------------------------

T = np.arange(0.0, 12.001, 0.05)
PUSH = 0.1 * (1 + np.tanh(2.0 * (T - 4.0)))  # 0.2 m to the right


def recorded(folder, values, time=T, column="displacement_m", changes=None, **waves):
    """The flume with a paddle that moves by a file."""
    text = "\n".join(f"{t:.9g},{v:.12g}" for t, v in zip(time, values, strict=True))
    (folder / "paddle.csv").write_text(f"t_s,{column}\n{text}\n")
    data = flume(**(changes or {}))
    data["waves"] = {"kind": "paddle", "file": "paddle.csv", "depth": 0.25, "piston": {"x": 0.4}, **waves}
    data["time"] = {"end": 10.0}
    (folder / "a.toml").write_text(load(data).to_toml())
    return load(folder / "a.toml")


def told(case, *levels):
    return [str(f) for f in check(case) if f.level in levels]


def test_a_sound_record_is_sound_and_says_what_the_wall_does(tmp_path):
    case = recorded(tmp_path, PUSH - 0.15, changes={"absorber": [], "gauge": []})
    assert told(case, "error", "warning") == []
    assert any("has -0.15 m at the start of the run: its 0 is at x = 0.55 m" in t for t in told(case, "info"))
    words = dict(wave_rows(case))["made by"]
    assert "piston at x = 0.4 m, stroke 0.2 m" in words and "moves from 0.4 to 0.6 m" in words
    assert "moves as the file says, 241 samples, one every 0.05 s, at most 0.2 m/s and 0.308 m/s2" in words


@pytest.mark.parametrize(
    ("values", "keys", "level", "words"),
    [
        (-PUSH, {"piston": {"x": 0.2}}, "error", r"waves\.piston\.x = 0.2 m: it goes 0.2 m to the left and needs 3"),
        (50 * PUSH, {}, "error", r"waves\.file: the paddle moves at up to 10 m/s, above 2 sqrt\(g d\) = 3.13 m/s"),
        (PUSH, {"start": 100.0}, "error", r"the paddle does not move after the start of the run"),
        (0.02 * np.sin(4 * T), {}, "warning", r"waves\.start .*the wall starts at 0.08 m/s at once; .* or give ramp"),
        (0.1 * np.sin(2 * np.pi * T / 0.31) * (T < 1e9), {"ramp": 2.0}, "warning", r"lies .*% of its range off"),
        (PUSH + 4e-3 * (-1.0) ** np.arange(len(T)), {}, "warning", r"accelerated by up to .* g: noise in the samples"),
    ],
)  # fmt: skip
def test_records_that_are_doubtful_are_told(tmp_path, values, keys, level, words):
    case = recorded(tmp_path, values, changes={"absorber": [], "gauge": []}, **keys)
    said = told(case, level)
    assert any(re.search(words, text) for text in said), said


def test_a_record_that_ends_in_motion_or_has_a_hole_is_told(tmp_path):
    case = recorded(tmp_path, (0.02 * np.sin(T))[:100], T[:100])
    assert any("after 4.95 s the wall stands still" in t for t in told(case, "warning"))
    kept = np.abs(T - 4.0) > 0.3
    (error,) = [t for t in told(recorded(tmp_path, PUSH[kept], T[kept]), "error") if "no sample" in t]
    assert "a curve of 0.7 s would stand for it" in error
    assert not [t for t in told(recorded(tmp_path, PUSH[kept], T[kept], gap=1.0), "error") if "no sample" in t]


def test_structures_stay_out_of_its_way(tmp_path):
    case = recorded(tmp_path, PUSH, changes={"solid": [{"box": [[0.6, 0.0], [1.0, 0.1]]}]})
    assert any("stands in the way of waves.piston" in t and "between 0.4 and 0.6 m" in t for t in told(case, "error"))


def test_a_drifting_velocity_is_seen_in_the_stroke(tmp_path):
    case = recorded(tmp_path, np.full(len(T), 0.05), column="velocity_m_s", ramp=1.0)
    assert "stroke 0.6" in dict(wave_rows(case))["made by"]
