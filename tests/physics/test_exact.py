"""The exact solutions of houle.validation against independent ones, each other, and what they must conserve."""

from pathlib import Path

import numpy as np
import pytest

from houle.medium.resistance import inertia_coefficient, van_gent_1995
from houle.validation import exact
from houle.validation.exact import PorousMedium

DATA = Path(__file__).parent / "data"
NU = 1e-6
MEDIA = {
    "rock": PorousMedium(0.49, *van_gent_1995(0.49, 0.0159, NU, 500.0, 2.0, kc=128.0), inertia_coefficient(0.49)),
    "beads": PorousMedium(0.39, *van_gent_1995(0.39, 0.003, NU, 200.0, 1.1), inertia_coefficient(0.39)),
}
DEPTH, LENGTH = 0.25, 1.0


def oracle(name):
    return np.loadtxt(DATA / f"{name}.csv", delimiter=",", skiprows=3 if name.startswith("column") else 2).T


@pytest.mark.parametrize("name", MEDIA)
def test_start_up_of_a_duct_agrees_with_an_independent_solution(name):
    time, flux = oracle(f"startup_{name}")
    assert exact.duct_flow(time, MEDIA[name], 4.905) == pytest.approx(flux, abs=1e-8)


@pytest.mark.parametrize("name", MEDIA)
def test_column_agrees_with_an_independent_solution(name):
    time, depth, layer, flux = oracle(f"column_{name}")
    for found, known in zip(exact.column_infiltration(time, MEDIA[name], 0.2), (depth, layer, flux), strict=True):
        assert found == pytest.approx(known, abs=6e-7)  # six digits of the file


def test_column_keeps_its_volume_and_says_when_the_layer_is_used_up():
    time = np.linspace(0.0, 2.0, 201)
    depth, layer, _ = exact.column_infiltration(time, MEDIA["rock"], 0.2)
    full = np.isfinite(depth)
    assert full[100] and not full[-1]
    assert layer[full] + 0.49 * depth[full] == pytest.approx(0.2, abs=1e-15)


def test_column_without_a_medium_falls_freely():
    """n = 1, no drag: every particle falls with g, s = g t^2 / 2."""
    time = np.linspace(0.0, 0.15, 16)
    depth, _, _ = exact.column_infiltration(time, PorousMedium(1.0, 0.0, 0.0), 0.2)
    assert depth == pytest.approx(9.81 * time**2 / 2, abs=1e-12)


def test_column_converges_at_fourth_order():
    end = np.array([0.0, 0.1])
    best = exact.column_infiltration(end, MEDIA["beads"], 0.2, step=1e-4)[0][-1]
    coarse, fine = (
        abs(exact.column_infiltration(end, MEDIA["beads"], 0.2, step=s)[0][-1] - best) for s in (4e-3, 2e-3)
    )
    assert np.log2(coarse / fine) > 3.5


@pytest.mark.parametrize("medium", [MEDIA["rock"], MEDIA["beads"], PorousMedium(0.49, 0.0, 50.0)])
def test_plug_flow_solves_its_equation_of_motion(medium):
    """(L - B + B C_r/n) dq/dt = G L - B (a q + b q^2), L = 0.5 m, B = 0.1 m, by Runge-Kutta."""
    time = np.linspace(0.0, 0.4, 2001)
    mass = 0.4 + 0.1 * medium.inertia / medium.porosity

    def slope(_, q):
        return (4.905 * 0.5 - 0.1 * (medium.a * q + medium.b * q * q)) / mass

    known = exact.runge_kutta(slope, np.array(0.0), time)
    assert exact.duct_flow(time, medium, 4.905, 0.5, 0.1) == pytest.approx(known, rel=1e-9, abs=1e-12)


def test_duct_limits_without_quadratic_or_any_drag():
    time = np.linspace(0.0, 1.0, 11)
    assert exact.duct_flow(time, PorousMedium(0.4, 0.0, 0.0), 3.0) == pytest.approx(3.0 * 0.4 * time)
    linear, nearly = (exact.duct_flow(time, PorousMedium(0.4, 20.0, b), 3.0) for b in (0.0, 1e-6))
    assert linear == pytest.approx(nearly, rel=1e-6)


def test_bernoulli_jump_vanishes_in_clear_water_and_keeps_the_head():
    q, n = 0.3, 0.4
    assert exact.bernoulli_jump(q, 1.0) == 0.0
    assert exact.bernoulli_jump(q, n) + q**2 / 2 == pytest.approx((q / n) ** 2 / 2)


@pytest.mark.parametrize("k", [0.1, 3.0, 40.0])
def test_wave_number_inverts_dispersion(k):
    assert exact.wave_number(exact.dispersion(k, DEPTH), DEPTH) == pytest.approx(k, rel=1e-12)


def test_long_and_deep_waves_have_the_frequencies_of_the_books():
    assert exact.dispersion(1e-3, DEPTH) == pytest.approx(1e-3 * np.sqrt(9.81 * DEPTH), rel=1e-6)
    assert exact.dispersion(100.0, DEPTH) == pytest.approx(np.sqrt(981.0), rel=1e-6)


def test_finite_amplitude_slows_deep_standing_waves_and_hurries_shallow_ones():
    """1 - (ka)^2/8 in deep water; no change at kd = 1.058 (Tadjbakhsh & Keller 1960)."""
    k, a = 2.0, 0.05
    deep = exact.standing_wave_frequency(a, k, 10.0) / exact.dispersion(k, 10.0)
    assert deep == pytest.approx(1 - (k * a) ** 2 / 8, rel=1e-7)
    change = [exact.standing_wave_frequency(a, k, kd / k) / exact.dispersion(k, kd / k) - 1 for kd in (1.04, 1.08)]
    assert change[0] > 0 > change[1]


def test_small_released_wave_is_linear():
    time = np.linspace(0.0, 2.0, 101)
    modes = exact.released_wave(time, 1e-5, LENGTH, DEPTH)
    omega = exact.dispersion(np.pi, DEPTH)
    assert modes[:, 0] == pytest.approx(1e-5 * np.cos(omega * time), abs=1e-9)
    assert np.abs(modes[:, 1:]).max() < 1e-8


def test_released_wave_has_the_period_of_third_order_theory():
    """Two theories that share nothing but the equations: the high-order spectral method and the expansion."""
    from houle.validation.measure import mean_period

    time = np.arange(0.0, 7.0, 0.01)
    wave = exact.released_wave(time, 0.02, LENGTH, DEPTH)[:, 0]
    expected = 2 * np.pi / exact.standing_wave_frequency(0.02, np.pi, DEPTH)
    assert mean_period(time, wave) == pytest.approx(expected, rel=3e-4)
