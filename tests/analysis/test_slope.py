"""Stability of a slope against the infinite slope by hand, and what rubs over its grains."""

import numpy as np
import pytest

from houle.analysis import AnalysisError, Layer, along_layer, excess_pore_pressure, shields

SLOPE = np.arctan(1 / 2.5)
RHO_G = 1000.0 * 9.81


def layer(**changes):
    """0.4 m of gravel, n = 0.4, 35 degrees, on a slope of 1:2.5; weighs 0.6 2650 + 0.4 1000 = 1990 kg/m3 when full."""
    keys = {"thickness": 0.4, "slope": SLOPE, "porosity": 0.4, "friction_angle": np.radians(35.0)}
    return Layer(**{**keys, **changes})


STILL = 0.70021 / 0.4  # tan 35 degrees over the slope


def test_in_still_water_of_any_depth_and_in_a_dry_bank_safety_is_that_of_dry_grains():
    gravel = layer()
    assert gravel.still == pytest.approx(STILL, rel=1e-5)
    depth = np.array([0.01, 0.5, 3.0])
    face = RHO_G * depth
    inside = face + RHO_G * 0.4 * np.cos(SLOPE)
    assert gravel.safety(face, inside, RHO_G * np.sin(SLOPE)) == pytest.approx(STILL, rel=1e-5)
    assert gravel.safety(0.0, 0.0, 0.0) == pytest.approx(STILL, rel=1e-5)


def test_with_flow_along_the_face_safety_is_halved():
    """Pressure 0 at the face, that of water along it on the plane, none along the layer: (1990 - 1000) / 1990."""
    found = layer().safety(0.0, RHO_G * 0.4 * np.cos(SLOPE), 0.0)
    assert found == pytest.approx(990 / 1990 * STILL, rel=1e-5)


def test_a_worked_number_with_water_that_comes_out_under_water():
    """i = 0.3 through the face: sigma' = 0.4 (990 g cos - 0.3 1000 g) = 2429.7 Pa, tau = 0.4 990 g sin = 1442.7 Pa."""
    cos, sin = np.cos(SLOPE), np.sin(SLOPE)
    face = RHO_G * 1.0
    inside = face + RHO_G * 0.4 * (cos + 0.3)
    found = layer().safety(face, inside, RHO_G * sin)
    assert 0.4 * 9.81 * (990 * cos - 300) == pytest.approx(2429.7, abs=0.1)
    assert 0.4 * 9.81 * 990 * sin == pytest.approx(1442.7, abs=0.1)
    assert found == pytest.approx(2429.7 * 0.70021 / 1442.7, rel=1e-4)


def test_the_critical_gradient_lifts_the_grains():
    """(s - 1) (1 - n) cos(beta) = 1.65 0.6 0.9285 = 0.919: nothing is left; a little less leaves a little."""
    cos = np.cos(SLOPE)
    critical = 1.65 * 0.6 * cos
    assert critical == pytest.approx(0.919, abs=5e-4)
    for gradient, most in ((1.001 * critical, 0.0), (0.99 * critical, 0.02)):
        inside = RHO_G * (1.0 + 0.4 * (cos + gradient))
        assert 0.0 <= layer().safety(RHO_G, inside, RHO_G * np.sin(SLOPE)) <= most


def test_nothing_slides_from_a_level_bed():
    bed = layer(slope=0.0)
    assert bed.safety(RHO_G, RHO_G * 1.4, 0.0) == np.inf and bed.still == np.inf


def test_pores_fill_from_the_plane_up():
    full = RHO_G * 0.4 * np.cos(SLOPE)
    assert layer().wet([0.0, 0.0, 0.0, 1.0], [0.0, full / 4, 2 * full, 0.0]) == pytest.approx([0.0, 0.25, 1.0, 1.0])
    assert layer().weight([0.0, 1.0]) == pytest.approx([9.81 * 1590, 9.81 * 1990])


def test_the_gradient_of_a_linear_pressure_along_a_layer_is_exact():
    s = np.array([0.0, 0.3, 1.0, 1.1])
    face, inside = 200 * s + np.array([[3.0], [9.0]]), 400 * s + 1.0
    assert along_layer(s, face, np.stack([inside, inside])) == pytest.approx(np.full((2, 4), 300.0))
    with pytest.raises(AnalysisError, match="two places or more"):
        along_layer([0.0], [[1.0]], [[1.0]])


def test_excess_pore_pressure_is_that_above_water_at_rest():
    """At z = 1.2 m, 0.8 m under the level: 9000 - 7848 = 1152 Pa; above the level all of it is."""
    assert excess_pore_pressure(9000.0, 2.0, 1.2) == pytest.approx(1152.0)
    assert excess_pore_pressure([500.0, 0.0], 1.0, 1.2) == pytest.approx([500.0, 0.0])


@pytest.mark.parametrize("wrong", [{"thickness": 0.0}, {"porosity": 1.0}, {"grain_density": 900.0}, {"slope": 1.6}])
def test_what_is_no_layer_is_refused(wrong):
    with pytest.raises(AnalysisError):
        layer(**wrong)


def test_a_current_across_adds_to_the_shields_number():
    """0.6 m/s over 1 m of water on grains of 5 mm: u* = 0.24 / (ln 2400 - 1) = 0.03538 m/s, theta = 0.01547."""
    alone = shields([0.0], 0.15, 0.005, across=0.6, depth=[1.0])
    assert alone.friction_velocity == pytest.approx([0.03538], abs=1e-5)
    assert alone.number == pytest.approx([0.03538**2 / (1.65 * 9.81 * 0.005)], rel=1e-3)
    along, both = shields([0.5], 0.15, 0.005), shields([0.5], 0.15, 0.005, across=0.6, depth=[1.0])
    assert both.number == pytest.approx(along.number + alone.number)
    assert shields([0.5], 0.15, 0.005, across=0.6, depth=[0.04]).number == pytest.approx(along.number)  # too shallow
