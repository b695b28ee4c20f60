"""Random seas: the right energy at the right frequencies, the same for the same seed, no repetition. Focused groups."""

import numpy as np
import pytest

from houle.waves.dispersion import wave_number
from houle.waves.linear import profiles
from houle.waves.spectra import focused, irregular, jonswap, pierson_moskowitz, tma
from houle.waves.theories import regular

DEPTH, GRAVITY = 0.5, 9.81
KINDS = ("jonswap", "pierson-moskowitz", "tma")


def spectrum(wave, duration=3600.0, step=0.05):
    """Frequencies [Hz] and energy of a long record at x = 0, and the record."""
    eta = wave.elevation(0.0, np.arange(0, duration, step))
    energy = 2 * np.abs(np.fft.rfft(eta) / len(eta)) ** 2
    return np.fft.rfftfreq(len(eta), step), energy, eta


@pytest.mark.parametrize("kind", KINDS)
def test_energy_is_exact(kind):
    """Hm0 = 4 sqrt(sum a^2/2) to rounding, for any seed; of a long record within the chance of beats."""
    for seed in (1, 2, 77):
        a = irregular(kind, 0.1, 2.0, DEPTH, GRAVITY, seed=seed).components().amplitude
        assert 4 * np.sqrt((a**2).sum() / 2) == pytest.approx(0.1, rel=1e-14)
    _, _, eta = spectrum(irregular(kind, 0.1, 2.0, DEPTH, GRAVITY))
    assert 4 * eta.std() == pytest.approx(0.1, rel=0.01)


@pytest.mark.parametrize("kind", ["jonswap", "tma"])
def test_peak_period_of_a_record(kind):
    """Centre of the spectrum's top, smoothed over 0.06 fp."""
    f, energy, _ = spectrum(irregular(kind, 0.1, 2.0, DEPTH, GRAVITY))
    width = round(0.03 / (f[1] - f[0]))
    smooth = np.convolve(energy, np.ones(width), "same")
    assert f[np.argmax(smooth)] == pytest.approx(0.5, rel=0.04)


def test_the_same_seed_gives_the_same_sea():
    a, b, c = (irregular("jonswap", 0.1, 2.0, DEPTH, GRAVITY, seed=s).components() for s in (5, 5, 6))
    assert a.phase.tobytes() == b.phase.tobytes() and a.omega.tobytes() == b.omega.tobytes()
    assert not np.any(a.phase == c.phase)
    numbers = np.random.Generator(np.random.PCG64(5)).random(400)  # frequencies, then phases: part of the contract
    np.testing.assert_array_equal(a.phase, numbers[200:] * 2 * np.pi)
    edges = np.linspace(0.5, 3.5, 201)[:-1] / 2.0
    np.testing.assert_allclose(a.omega / (2 * np.pi), edges + numbers[:200] * 3 / 200 / 2, rtol=1e-14)


def test_the_sea_does_not_repeat():
    """Equal spacing would repeat after 1/df = 133 s exactly; here nothing in 2 hours looks like the start."""
    wave = irregular("jonswap", 0.1, 2.0, DEPTH, GRAVITY)
    step = 0.1
    eta = wave.elevation(0.0, np.arange(0, 7200, step))
    first = eta[:600]  # one minute
    likeness = np.correlate(eta[200:], first, "valid")
    power = np.convolve(eta[200:] ** 2, np.ones(600), "valid") * (first**2).sum()
    assert np.max(likeness / np.sqrt(power)) < 0.9


def test_published_properties_of_jonswap():
    """m0 with gamma over m0 without is 1/(1 - 0.287 ln gamma); Tz/Tp = 0.6673 + 0.05037 g - 0.006230 g2 + 0.0003341 g3.

    DNV-RP-C205 (2010), sections 3.5.5.2-3.5.5.4; whole spectrum.
    """
    f = np.linspace(0.02, 40, 800_000)
    for g in (1.0, 2.0, 3.3, 5.0):
        s, pm = jonswap(f, 1.0, g), pierson_moskowitz(f, 1.0)
        assert s.sum() / pm.sum() == pytest.approx(1 / (1 - 0.287 * np.log(g)), rel=0.01)
        mean = np.sqrt(s.sum() / (s * f**2).sum())
        assert mean == pytest.approx(0.6673 + 0.05037 * g - 0.006230 * g**2 + 0.0003341 * g**3, rel=0.005)


def test_tma_depth_function():
    """Beside the approximation of Thompson & Vincent (1983), 4 % (RECALLED); JONSWAP in deep water."""
    f = np.linspace(0.15, 3, 300)
    factor = tma(f, 0.5, 3.3, DEPTH, GRAVITY) / jonswap(f, 0.5, 3.3)
    x = 2 * np.pi * f * np.sqrt(DEPTH / GRAVITY)
    near = np.where(x <= 1, 0.5 * x**2, np.where(x < 2, 1 - 0.5 * (2 - x) ** 2, 1.0))
    np.testing.assert_allclose(factor, near, atol=0.04)
    np.testing.assert_allclose(tma(f, 0.5, 3.3, 500.0, GRAVITY)[50:], jonswap(f, 0.5, 3.3)[50:], rtol=1e-10)


def test_components_of_tma_are_less_peaked_up_high():
    deep, shallow = (
        (p.amplitude**2)[p.omega > 2 * np.pi].sum() / (p.amplitude**2).sum()
        for p in (irregular(k, 0.1, 2.0, DEPTH, GRAVITY).components() for k in ("jonswap", "tma"))
    )
    assert shallow > 1.2 * deep  # the same Hm0, the depth function takes the long waves away


def test_grid_and_points_agree():
    wave = irregular("jonswap", 0.1, 2.0, DEPTH, GRAVITY)
    x, z = np.linspace(0, 3, 7), np.linspace(0, 0.8, 9)
    for a, b in zip(wave.velocity_on(x, z, 3.3), wave.velocity(x[:, None], z, 3.3), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-14)


def test_one_component_is_the_airy_wave_of_the_books():
    """a g k/omega cosh(kz)/cosh(kd) cos, the same with sinh; linear above still water up to the crest."""
    wave = regular("airy", 0.02, 1.5, DEPTH)
    x, z, t, k = 0.37, np.linspace(0, DEPTH, 6), 0.21, wave.k
    size = 0.01 * GRAVITY * k / wave.omega / np.cosh(k * DEPTH)
    u, w = wave.velocity(x, z, t)
    np.testing.assert_allclose(u, size * np.cosh(k * z) * np.cos(k * x - wave.omega * t), rtol=1e-12)
    np.testing.assert_allclose(w, size * np.sinh(k * z) * np.sin(k * x - wave.omega * t), rtol=1e-12, atol=1e-18)
    above = wave.velocity(0.0, DEPTH + np.array([0.004, 0.008]), 0.0)[0] - wave.velocity(0.0, DEPTH, 0.0)[0]
    assert above[1] == pytest.approx(2 * above[0], rel=1e-10)
    assert above[0] == pytest.approx(0.004 * size * k * np.sinh(k * DEPTH), rel=1e-10)


def test_profiles_of_very_long_and_very_short_waves():
    """k = 0: 1/d at every z, and no w. Short: nothing overflows, all at the surface."""
    z = np.array([0.0, 0.2, DEPTH])
    cosh, sinh = profiles(np.array([0.0, 1e-9, 5e4]), z, DEPTH)
    np.testing.assert_allclose(cosh[:, :2], 1 / DEPTH, rtol=1e-12)
    np.testing.assert_allclose(sinh[:, 0], 0)
    np.testing.assert_allclose(sinh[:, 1], 1e-9 * z / DEPTH, atol=1e-15)
    assert cosh[2, 2] == sinh[2, 2] == 5e4 and cosh[1, 2] == 0


def test_random_sea_is_not_compressed():
    wave, h = irregular("jonswap", 0.02, 2.0, DEPTH, GRAVITY), 1e-4
    x, z = np.linspace(0, 3, 31)[:, None], np.linspace(0.01, 0.48, 9)
    du = wave.velocity(x + h, z, 1.0)[0] - wave.velocity(x - h, z, 1.0)[0]
    dw = wave.velocity(x, z + h, 1.0)[1] - wave.velocity(x, z - h, 1.0)[1]
    assert np.abs(du + dw).max() < 1e-6 * np.abs(du).max()


def test_surface_moves_with_the_water():
    """Linear kinematic condition: d eta/dt = w at still water."""
    wave, h = irregular("tma", 0.02, 2.0, DEPTH, GRAVITY), 1e-4
    x = np.linspace(0, 3, 31)
    rate = (wave.elevation(x, 1.0 + h) - wave.elevation(x, 1.0 - h)) / (2 * h)
    np.testing.assert_allclose(wave.velocity(x, DEPTH, 1.0)[1], rate, atol=1e-6 * np.abs(rate).max())


def test_focused_crest_is_where_and_when():
    wave = focused(0.06, 1.6, DEPTH, GRAVITY, 5.0, 12.0)
    assert wave.elevation(5.0, 12.0) == pytest.approx(0.06, rel=1e-13)
    x, t = np.linspace(0, 10, 401), np.arange(0, 40, 0.02)
    assert wave.elevation(x, 12.0).max() == pytest.approx(0.06) and x[np.argmax(wave.elevation(x, 12.0))] == 5.0
    assert t[np.argmax(wave.elevation(5.0, t))] == pytest.approx(12.0)
    assert np.abs(wave.elevation(5.0, np.array([0.0, 24.0, 40.0]))).max() < 0.006  # quiet before and after


def test_newwave_is_the_autocorrelation():
    """Tromans et al. (1991): the shape in time is the sea's autocorrelation, here integrated directly."""
    f = np.linspace(0.5, 3.5, 20001) / 1.6
    s = jonswap(f, 1 / 1.6, 3.3)
    lag = np.array([0.0, 0.3, 0.8, 1.5, 2.4])
    wanted = (s * np.cos(2 * np.pi * f * lag[:, None])).sum(-1) / s.sum()
    wave = focused(1.0, 1.6, DEPTH, GRAVITY, 0.0, 0.0)
    np.testing.assert_allclose(wave.elevation(0.0, lag), wanted, atol=0.01)


def test_wave_numbers_of_the_components():
    p = irregular("jonswap", 0.1, 2.0, DEPTH, GRAVITY, direction=0.3).components()
    np.testing.assert_array_equal(p.k, wave_number(p.omega, DEPTH, GRAVITY))
    assert set(p.direction) == {0.3}
