"""Wave maker theory against its limits and against itself."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from houle.case.tables.waves import Waves
from houle.case.wave import make
from houle.waves.dispersion import wave_number
from houle.waves.piston import Follower, Reading, biesel, double_harmonic, law_of, modes, reading_of, response
from houle.waves.wave import WaveError

DEPTH, GRAVITY = 0.25, 9.81


def number(period: float) -> float:
    return float(wave_number(2 * pi / period, DEPTH, GRAVITY))


def test_a_long_wave_is_as_high_as_a_piston_sweeps_and_a_short_one_twice_its_stroke():
    assert biesel(1e-3) == pytest.approx(1e-3, rel=1e-5)
    assert biesel(20.0) == pytest.approx(2.0, rel=1e-6)
    assert biesel(np.array([400.0])) == pytest.approx(2.0)


@pytest.mark.parametrize("period", [0.6, 1.2, 3.0])
def test_modes_obey_dispersion_and_make_up_the_velocity_of_the_piston(period):
    """A uniform velocity over the depth is the sum of all modes: to a per cent away from the surface."""
    omega = 2 * pi / period
    k = modes(omega, DEPTH, GRAVITY, 400)
    np.testing.assert_allclose(GRAVITY * k * np.tanh(k * DEPTH), omega**2, rtol=1e-6)
    z = np.linspace(0.0, 0.9 * DEPTH, 7)
    shape = np.cosh(np.outer(z, k)) / np.cosh(k * DEPTH)
    velocity = (shape * (GRAVITY * k / omega**2) * response(k, DEPTH)).sum(-1)
    np.testing.assert_allclose(velocity, 1.0, atol=0.01)


def test_the_reading_sees_the_travelling_mode_alone():
    k = modes(2 * pi / 1.2, DEPTH, GRAVITY)
    read = Reading(k[0].real, DEPTH, GRAVITY)
    seen = read.of_modes(k)
    assert seen[0] == pytest.approx(1.0, abs=1e-5)
    assert np.abs(seen[1:]).max() < 1e-12
    z = (np.arange(500) + 0.5) * 1e-3  # layers up to twice the depth
    profile = np.cosh(k[0].real * z) / np.cosh(k[0].real * DEPTH)
    assert np.sum(read.weights(z, 1e-3) * profile) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("period", [1.0, 1.5, 2.0])
def test_an_absorbing_wall_sends_nothing_back_at_its_period_but_what_its_return_costs(period):
    read = Reading(number(period), DEPTH, GRAVITY)
    assert read.comes_back(2 * pi / period) == pytest.approx(1 / (2 * 2 * pi * 10), rel=0.02)
    assert read.comes_back(2 * pi / (2 * period)) < 0.08
    assert read.comes_back(2 * pi / 40.0) < 0.3  # a long wave


def test_in_shallow_water_the_double_harmonic_is_that_of_madsen():
    """Madsen (1971): H^2/(32 d) (3 cosh kd / sinh^3 kd - 2/m) sin 2 omega t beside S/2 sin omega t, m = H/S."""
    for kd, allowed in ((0.15, 0.005), (0.3, 0.03)):
        k = kd / DEPTH
        omega = float(np.sqrt(GRAVITY * k * np.tanh(kd)))
        height, m = 0.001, float(biesel(kd))
        read = Reading(k, DEPTH, GRAVITY)
        second, _ = double_harmonic(omega, -0.5j * height / m, DEPTH, GRAVITY, read)
        madsen = height**2 / (32 * DEPTH) * (3 * np.cosh(kd) / np.sinh(kd) ** 3 - 2 / m)
        assert second.imag == pytest.approx(-madsen, rel=allowed)
        assert abs(second.real) < 0.01 * madsen


def test_the_piston_displaces_the_volume_of_a_solitary_wave():
    """Goring: all in all it sweeps the volume above still water, 4 d sqrt(H d / 3) to first order."""
    table = Waves(kind="solitary", height=0.02, depth=DEPTH, piston={"x": 0.5})
    wave = make(table)
    law = law_of(wave, 0.5, reading_of(wave, DEPTH, GRAVITY), 0.0, regular=False)
    assert isinstance(law, Follower)
    x = np.linspace(-10.0, 10.0, 4001)
    volume = float(np.sum(wave.elevation(x, 0.0))) * (x[1] - x[0])
    low, high = law.reach
    assert low == 0.0
    assert high * DEPTH == pytest.approx(volume, rel=0.01)


def test_long_regular_waves_are_followed_and_others_made_to_second_order():
    for height, period, words in ((0.02, 1.2, "second order"), (0.06, 4.0, "goes with the water (Goring)")):
        table = Waves(kind="regular", height=height, period=period, depth=DEPTH, piston={"x": 0.5})
        wave = make(table)
        law = law_of(wave, 0.5, reading_of(wave, DEPTH, GRAVITY), 2 * period, regular=True)
        assert law.theory == words
    sea = Waves(kind="jonswap", height=0.02, period=1.2, depth=DEPTH, piston={"x": 0.5})
    assert law_of(make(sea), 0.5, reading_of(make(sea), DEPTH, GRAVITY), 0.0, regular=False).theory == "first order"
    oblique = Waves(kind="regular", height=0.02, period=1.2, depth=DEPTH, direction=20.0, piston={"x": 0.5})
    with pytest.raises(WaveError, match=r"a piston makes waves along x only; take waves\.source"):
        law_of(make(oblique), 0.5, reading_of(None, DEPTH, GRAVITY), 0.0, regular=True)
