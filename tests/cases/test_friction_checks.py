"""Friction in the case file and in `houle check`: rough sides and solids, what slip leaves out, grains too large."""

from __future__ import annotations

from math import pi, sqrt

import pytest

from houle import load
from houle.case.build import build
from houle.check.friction import lost_per_wavelength, wave_friction
from houle.check.rules import check
from houle.errors import CaseError

CASE = {
    "case": {"name": "friction"},
    "domain": {"size": [1.0, 0.5], "spacing": 0.01},
    "water": [{"box": [[0.0, 0.0], [0.3, 0.2]]}],
    "solid": [{"name": "step", "box": [[0.5, 0.0], [0.7, 0.1]]}],
    "time": {"end": 1.0},
}
WAVES = {
    "case": {"name": "waves"},
    "domain": {"size": [7.0, 0.5], "spacing": 0.02},
    "water": [{"below": 0.3}],
    "waves": {"kind": "regular", "height": 0.04, "period": 1.4, "depth": 0.3, "zone": {"x": [0.0, 3.0]}},
    "time": {"end": 20.0},
}


def of(case=CASE, **overrides):
    return load(case, {key.replace("__", "."): value for key, value in overrides.items()})


def told(case):
    return [f for f in check(case) if f.key.startswith(("domain.walls", "step", "solid"))]


def test_sides_and_solids_rub_as_the_case_says():
    assert build(of()).rough == (None,) and build(of()).rough_sides == {}
    setup = build(of(domain__walls={"bottom": {"roughness": 2e-3}, "left": "no-slip"}, solid__step__roughness=0.0))
    assert setup.rough == (0.0,) and setup.rough_sides == {"left": 0.0, "bottom": 2e-3}
    assert build(of(domain__walls={"roughness": 1e-3})).rough_sides == dict.fromkeys(
        ("left", "right", "bottom", "top"), 1e-3
    )
    paper = build(of(domain__walls="no-slip", numerics__scheme="jh2020"))
    assert paper.rough_sides == {} and all(map(all, paper.no_slip))  # there images of the particles hold the water


def test_a_joined_side_has_no_wall_that_rubs():
    assert build(of(domain__walls={"x": "periodic", "bottom": "no-slip"})).rough_sides == {"bottom": 0.0}


@pytest.mark.parametrize(
    ("side", "message"),
    [
        ({"roughness": -1e-3}, r"^domain.walls.bottom.roughness = -0.001 is outside 0 <= roughness <= 1 \[m\].$"),
        (
            {"roughnes": 1e-3},
            r"domain.walls.bottom.roughnes is not a key of the case file. Did you mean .roughness.\?",
        ),
        ("rough", r'^domain.walls.bottom = "rough" is not one of "slip", "no-slip".$'),
        (3, r'^domain.walls.bottom = 3 is not one of "slip", "no-slip".$'),
    ],
)
def test_wrong_walls_are_named(side, message):
    """About the form in which the side was given."""
    with pytest.raises(CaseError, match=message):
        of(domain__walls={"bottom": side})


def test_wrong_roughness_of_a_solid_is_named():
    with pytest.raises(CaseError, match="roughness"):
        of(solid__step__roughness=-0.1)


def test_slip_is_told_with_what_it_leaves_out():
    (found,) = told(of())
    assert found.level == "info" and "roughness = 0" in found.text and "boundary layer" in found.text
    (found,) = told(of(solid__step__roughness=0.0))
    assert found.key == "domain.walls" and "walls = {bottom = {roughness = 0}}" in found.text
    assert not told(of(solid__step__roughness=0.0, domain__walls="no-slip"))
    assert not told(of(fluid__viscosity=0.0))
    assert not told(of(CASE | {"water": [{"below": 0.2}]}))  # at rest
    (found,) = told(of(CASE | {"water": [{"below": 0.2, "velocity": [1.0, 0.0]}]}))
    assert "at 1 m/s" in found.text and "a stream 0.2 m deep" in found.text


def test_waves_are_told_what_a_smooth_bed_takes():
    (found,) = told(of(WAVES))
    wave = of(WAVES).wave
    share, layer = lost_per_wavelength(0.04, 1.4, 0.3, wave.length, 9.81, 1e-6)
    assert f"about {100.0 * share:.2g} % of the energy of the waves per wavelength" in found.text
    assert f"in a layer of {1e3 * layer:.2g} mm (spacing 20 mm)" in found.text
    assert 0.004 < share < 0.01  # 1.2 times the laminar 0.54 %


def test_grains_larger_than_a_cell_are_warned_of():
    found = [f for f in told(of(solid__step__roughness=0.03)) if f.level == "warning"]
    assert len(found) == 1 and "0.03 m is more than the spacing of 0.01 m" in found[0].text


def test_laminar_waves_lose_what_the_boundary_layer_takes():
    """Exact: rho u_b^2 sqrt(nu omega / 8) per area; Jonsson's mean of |u|^3 with f_w = 2 Re^-1/2 is 1.2 of it."""
    speed, omega, nu = 0.05, 2.0 * pi / 1.5, 1e-6
    exact = speed**2 * sqrt(nu * omega / 8.0)
    assert 2.0 / (3.0 * pi) * wave_friction(speed, omega, nu) * speed**3 / exact == pytest.approx(1.2, abs=0.01)


def test_friction_factors_grow_with_roughness():
    speed, omega, nu = 0.5, 1.0, 1e-6
    smooth = wave_friction(speed, omega, nu)
    assert smooth < wave_friction(speed, omega, nu, 1e-3) < wave_friction(speed, omega, nu, 1e-2) <= 0.3
    assert wave_friction(speed, omega, nu, 1e3) == 0.3
