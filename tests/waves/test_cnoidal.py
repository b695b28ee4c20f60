"""Elliptic functions, cnoidal and solitary waves."""

import numpy as np
import pytest
from places import DEPTH, GRAVITY, surface_errors
from scipy.special import ellipj, ellipk

from houle.waves.cnoidal import cnoidal, elliptic, parameter, scale, solitary, surface, velocity_terms
from houle.waves.fenton import fenton
from houle.waves.wave import WaveError


@pytest.mark.parametrize("ratio", [0.9, 1.0, 1.7, 2.5, 4.0])
def test_elliptic_functions_against_scipy(ratio):
    m, k, kc = parameter(ratio)
    assert k == pytest.approx(ellipk(m), rel=1e-10 if ratio > 2 else 1e-14)  # 1 - m costs scipy its last digits
    assert k / kc == pytest.approx(ratio, rel=1e-15)
    v = np.linspace(-3 * k, 5 * k, 301)
    sn, cn, dn, _ = ellipj(v, m)
    c2, slope = elliptic(v, ratio)
    np.testing.assert_allclose(c2, cn**2, atol=1e-11)
    np.testing.assert_allclose(slope, sn * cn * dn, atol=1e-11)


def test_long_wave_ends_in_the_solitary_one():
    v = np.linspace(-5, 5, 101)
    for a, b in zip(elliptic(v, 40.0), elliptic(v, np.inf), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-14)


@pytest.mark.parametrize("m", [0.5, 0.9, 1.0])
def test_series_have_their_properties(m):
    """Crest minus trough is H exactly; Laplace's equation links the powers of z: each is the one below, twice derived.

    u = sum (-1)^j (z d/dx)^(2j)/(2j)! of the velocity at the bed. To the order of the theory: delta^2 and delta^3.
    """
    assert sum(surface(0.2, m)) == pytest.approx(0.2, rel=1e-13)
    delta = 1e-4
    p = velocity_terms(delta, m) / delta
    p[0, 0] += 1 / delta
    alpha2 = 0.75 * delta
    # (cn^2)'' = 2 (1-m) + (8m - 4) cn^2 - 6 m cn^4, times the bed velocity's slope m delta, over -2
    wanted = -m * alpha2 / 2 * np.array([2 * (1 - m), 8 * m - 4, -6 * m])
    np.testing.assert_allclose(p[:3, 1], wanted, rtol=1e-3, atol=1e-3 * delta)


@pytest.mark.parametrize("period", [3.0, 6.0])
def test_order_of_cnoidal_theory(period):
    """Errors at the surface go with the fourth power of H/d once the shape (m) is kept: T grows as the height falls."""
    errors = [
        np.array(surface_errors(cnoidal(h, period * s, DEPTH, GRAVITY, 0, 0))) for h, s in ((0.02, 1), (0.01, 2**0.5))
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx([4.5, 4.0], abs=0.35)


@pytest.mark.parametrize(("height", "period", "share"), [(0.02, 4.0, 1e-4), (0.04, 4.0, 2e-3), (0.02, 10.0, 3e-4)])
def test_cnoidal_against_the_stream_function(height, period, share):
    near, exact = cnoidal(height, period, DEPTH, GRAVITY, 0, 0), fenton(height, period, DEPTH, GRAVITY, 0, 0)
    x = np.linspace(0, exact.length, 400)
    assert np.abs(near.elevation(x, 0.0) - exact.elevation(x, 0.0)).max() < share * height
    assert near.celerity == pytest.approx(exact.celerity, rel=share)
    for a, b in zip(near.velocity(x, 0.2, 0.0), exact.velocity(x, 0.2, 0.0), strict=True):
        assert np.abs(a - b).max() < 20 * share * np.abs(b).max()


def test_too_short_for_cnoidal():
    with pytest.raises(WaveError, match=r'period of 0\.8 s is outside .* use theory = "fenton"'):
        cnoidal(0.02, 0.8, DEPTH, GRAVITY, 0, 0)


@pytest.mark.parametrize("order", [3, 5])
def test_order_of_the_solitary_wave(order):
    errors = [np.array(surface_errors(solitary(e * DEPTH, DEPTH, GRAVITY, order=order))) for e in (0.08, 0.04)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx([order + 1.5, order + 1], abs=0.3)


def test_fifth_order_is_better_as_long_as_it_is_used():
    for e in (0.1, 0.2, 0.4, 0.6):
        third, fifth = (np.array(surface_errors(solitary(e * DEPTH, DEPTH, GRAVITY, order=o))) for o in (3, 5))
        assert np.all(fifth < third / 2)
    assert surface_errors(solitary(0.05, DEPTH, GRAVITY))[1] < 1.3e-4


def test_fifth_order_beside_a_long_stream_function_wave():
    """H/d = 0.3, 40 depths long: the crests differ by the tail of the neighbours and the level of the trough.

    Compared in the frame of the crest, over the depth of the trough: that is where the solitary wave lives.
    """
    long = fenton(0.3, 35.0, 1.0, 1.0, 0, 0)
    trough = 1 + long.elevation(long.length / 2, 0.0)
    speed = long.celerity - long.velocity(long.length / 2, 0.0, 0.0)[0]
    wave = solitary(0.3, float(trough), 1.0)
    assert wave.celerity == pytest.approx(float(speed), rel=2e-4)
    x = np.linspace(-6, 6, 121)
    np.testing.assert_allclose(trough + wave.elevation(x, 0.0), 1 + long.elevation(x, 0.0), atol=1e-3 * 0.3)
    third = solitary(0.3, float(trough), 1.0, order=3)
    assert np.abs(third.elevation(x, 0.0) + trough - 1 - long.elevation(x, 0.0)).max() > 1e-3 * 0.3


def test_solitary_wave_as_published():
    """Profile of Grimshaw (1971): e s2 - 3/4 e2 s2 t2 + e3 (5/8 s2 t2 - 101/80 s4 t2); celerity beside fifth order.

    Fifth order: c = 1 + e/2 - 3/20 e2 + 3/56 e3 - 309/5600 e4 + 12237/616000 e5 (Fenton 1999, eq. A.6 with m = 1).
    """
    e = 0.2
    wave = solitary(e, 1.0, 1.0, order=3)
    x = np.linspace(-8, 8, 101)
    alpha = np.sqrt(0.75 * e) * (1 - 5 / 8 * e + 71 / 128 * e**2)
    assert scale(e, 1.0) == pytest.approx(alpha, rel=1e-14)
    s2, t2 = np.cosh(alpha * x) ** -2, np.tanh(alpha * x) ** 2
    profile = e * s2 - 0.75 * e**2 * s2 * t2 + e**3 * (5 / 8 * s2 * t2 - 101 / 80 * s2**2 * t2)
    np.testing.assert_allclose(wave.elevation(x, 0.0), profile, atol=1e-14)
    fifth = 1 + e / 2 - 3 / 20 * e**2 + 3 / 56 * e**3 - 309 / 5600 * e**4 + 12237 / 616000 * e**5
    assert wave.celerity == pytest.approx(fifth, abs=e**4 / 30)


def test_water_is_at_rest_before_and_after_a_solitary_wave():
    wave = solitary(0.05, DEPTH, GRAVITY, crest=2.0)
    assert wave.elevation(2.0, 0.0) == pytest.approx(0.05)
    far = np.array([2.0 - 8.0, 2.0 + 8.0])
    for part in (wave.elevation(far, 0.0), *wave.velocity(far, 0.1, 0.0)):
        assert np.abs(part).max() < 1e-9
    edges = wave.elevation(2.0 + np.array([-0.5, 0.5]) * wave.length, 0.0)
    assert edges == pytest.approx(0.01 * 0.05, rel=0.15)  # sech^2 is 1 % there, the third-order tail 1 - 3/4 H/d of it
