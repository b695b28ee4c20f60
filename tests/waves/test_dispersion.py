"""omega^2 = g k tanh(k d), to the last digits, from tides to ripples."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from houle.waves.dispersion import celerity, frequency, group_velocity, wave_number

X = np.logspace(-8, 3, 2001)  # k d


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="no long double here")
def test_wave_number_against_long_double():
    d, g = 0.25, 9.81
    k = X.astype(np.longdouble) / d
    omega = np.sqrt(g * k * np.tanh(k * d)).astype(float)
    exact = k.copy()  # of the rounded omega: one Newton step in long double
    w2 = omega.astype(np.longdouble) ** 2
    tanh = np.tanh(exact * d)
    exact -= (g * exact * tanh - w2) / (g * (tanh + exact * d * (1 - tanh**2)))
    assert np.max(np.abs(wave_number(omega, d, g) / exact - 1)) < 1e-14


@given(st.floats(1e-6, 1e3), st.floats(1e-3, 1e3), st.floats(0.1, 30))
def test_dispersion_relation(omega, depth, gravity):
    k = wave_number(omega, depth, gravity)
    assert gravity * k * np.tanh(k * depth) == pytest.approx(omega**2, rel=1e-14)


def test_it_takes_arrays_and_nothing():
    assert wave_number(np.zeros((2, 3)), 0.5).tolist() == [[0.0] * 3] * 2
    omega = np.array([[0.0, 1.0], [2.0, 30.0]])
    np.testing.assert_allclose(frequency(wave_number(omega, 0.4), 0.4), omega, rtol=1e-14)


def test_group_velocity_is_the_slope_of_the_frequency():
    k, d = X[400:1800] / 0.25, 0.25
    h = 1e-5 * k
    slope = (frequency(k + h, d) - frequency(k - h, d)) / (2 * h)
    np.testing.assert_allclose(group_velocity(k, d), slope, rtol=1e-8)


def test_long_and_short_waves():
    """sqrt(g d) for both speeds at k = 0; c_g = c/2 in deep water."""
    assert celerity(0.0, 0.25) == group_velocity(0.0, 0.25) == np.sqrt(9.81 * 0.25)
    assert group_velocity(4000.0, 0.25) == pytest.approx(celerity(4000.0, 0.25) / 2, rel=1e-14)


def test_published_wavelengths():
    """L/L0 beside d/L0 of Wiegel's table (Shore Protection Manual 1984, appendix C, table C-1)."""
    for relative_depth, tanh in ((0.01, 0.2480), (0.05, 0.5310), (0.10, 0.7093), (0.20, 0.8884), (0.50, 0.9964)):
        period = 5.0
        deep = 9.81 * period**2 / (2 * np.pi)
        k = wave_number(2 * np.pi / period, relative_depth * deep)
        assert 2 * np.pi / k / deep == pytest.approx(tanh, abs=1.2e-4)
