"""Records taken apart: harmonics, crossings, spectra; the window; the quality of the waves of an empty flume."""

import numpy as np
import pytest

from analysis import flumes
from houle import analysis
from houle.analysis.errors import AnalysisError
from houle.waves.dispersion import group_velocity, wave_number

DEPTH = 0.25


def front(omega):
    """Group velocity [m/s]."""
    return float(group_velocity(wave_number(omega, DEPTH), DEPTH))


def test_harmonics_whatever_the_sampling():
    time = np.arange(0.0, 7.77, 0.0137)
    F = np.array([[0.1, 0.02 + 0.01j, 0.003j], [0.0, -0.02, 0.001]])
    eta = np.array([sum((f * np.exp(-1j * m * 3.3 * time)).real for m, f in enumerate(row)) for row in F])
    assert np.allclose(analysis.harmonics(time, eta, 3.3, 2), F, atol=1e-13)
    assert analysis.find_omega(time, eta) == pytest.approx(3.3, rel=1e-11)
    with pytest.raises(AnalysisError, match="samples over"):
        analysis.harmonics(time[:100], eta[:, :100], 3.3)
    with pytest.raises(AnalysisError, match="flat"):
        analysis.find_omega(time, 0 * time + 1)


def test_crossings_of_a_regular_wave():
    time = np.arange(0.0, 20.0, 0.002)
    for direction in ("down", "up"):
        waves = analysis.zero_crossing(time, 0.3 + 0.02 * np.cos(2 * np.pi * time / 1.7 + 0.4), direction)
        assert waves.N == 10 or waves.N == 11
        assert pytest.approx(0.04, rel=1e-4) == waves.H_m
        assert waves.T_z == pytest.approx(1.7, rel=1e-3)
    with pytest.raises(AnalysisError, match="no whole wave"):
        analysis.zero_crossing(time[:500], np.cos(time[:500]))


def test_crossing_statistics_by_hand():
    """Six waves of heights 1..6, each a period of a sine about zero."""
    s = np.sin(2 * np.pi * np.arange(200) / 200)
    heights = [3, 1, 6, 2, 5, 4]
    eta = np.concatenate([[-0.01], *[0.5 * h * s for h in heights], [0.0, 0.01]])
    waves = analysis.zero_crossing(np.arange(len(eta)) * 0.01, eta - eta.mean(), "up")
    assert np.allclose(waves.heights, heights, rtol=1e-3)
    assert pytest.approx(5.5, rel=1e-3) == waves.H_13
    assert pytest.approx(6, rel=1e-3) == waves.H_max
    assert np.isnan(waves.H_110)
    assert pytest.approx(2.0, rel=1e-2) == waves.T_13
    assert analysis.zero_crossing(np.arange(len(eta)) * 0.01, eta - eta.mean(), "up", threshold=2.5).N == 4


def test_a_narrow_sea_is_rayleigh():
    """Longuet-Higgins: H_rms = H_m0 / sqrt 2 and H_1/3 = 1.416 H_rms in a narrow band."""
    rng, time = np.random.default_rng(4), np.arange(0.0, 4000.0, 0.1)
    f = rng.uniform(0.48, 0.52, 200)
    eta = sum(0.01 * np.cos(2 * np.pi * (q * time + p)) for q, p in zip(f, rng.random(200), strict=True))
    waves, sea = analysis.zero_crossing(time, eta), analysis.spectrum(time, eta, 200.0)
    assert pytest.approx(4 * np.std(eta), rel=0.02) == sea.H_m0
    assert waves.H_rms == pytest.approx(sea.H_m0 / np.sqrt(2), rel=0.03)
    assert pytest.approx(1.416, rel=0.03) == waves.H_13 / waves.H_rms
    assert waves.T_z == pytest.approx(sea.T_m02, rel=0.01)
    assert "H_m0" in str(sea) and "H_1/3" in str(waves)


def test_moments_and_peak_of_a_known_spectrum():
    f = np.linspace(0, 5, 5001)
    S = np.where((f > 0.5) & (f < 1.5), 1.0 - np.abs(f - 1.0) / 0.5, 0.0)  # a triangle about 1 Hz, area 0.5
    sea = analysis.Spectrum(f, S)
    assert sea.moment(0) == pytest.approx(0.5, rel=1e-3)
    assert sea.moment(1) == pytest.approx(0.5, rel=1e-3)
    low, high = (np.log(1 / 0.5) * -0.5 + 0.5), (1.5 * np.log(1.5) - 0.5)  # integrals of S / f below and above 1 Hz
    assert sea.T_m10 == pytest.approx((low + high) / 0.5 / 0.5, rel=2e-3)
    assert pytest.approx(1.0, rel=1e-3) == sea.T_p
    assert sea.band(0.9, 1.1).moment(0) == pytest.approx(0.18, rel=2e-2)
    time = np.arange(0, 400, 0.1)
    assert analysis.spectrum(time, np.cos(2 * np.pi * time / 3.1), 100.0).T_p == pytest.approx(3.1, rel=5e-3)


def test_water_at_rest_has_no_mean_period():
    found = analysis.spectrum(np.arange(400) * 0.1, np.zeros(400))
    assert found.H_m0 == 0.0
    assert np.isnan([found.T_m10, found.T_m01, found.T_m02]).all()
    assert "H_m0 0 m" in str(found)


# the window


def test_the_window_by_hand():
    """T = 1.5 s: front to the structure and back to the first gauge, four periods more, until the wave comes again."""
    omega, c = 2 * np.pi / 1.5, front(2 * np.pi / 1.5)
    window = analysis.choose_window(omega, DEPTH, maker=1.0, structure=21.0, gauges=[15.0, 16.0], until=99.0)
    assert window.start == pytest.approx((20 + 6) / c + 4 * 1.5)
    assert window.periods == int(((40 + 14) / c - window.start) / 1.5)
    assert window.end == pytest.approx(window.start + 1.5 * window.periods)
    assert "re-reflected from the maker" in window.reason
    mirrored = analysis.choose_window(omega, DEPTH, maker=-1.0, structure=-21.0, gauges=[-15.0, -16.0], until=99.0)
    assert mirrored == window


def test_what_limits_the_window():
    omega = 2 * np.pi / 1.5
    c, places = front(omega), {"maker": 0.0, "structure": 20.0, "gauges": [14.0, 15.0]}
    long = analysis.choose_window(omega, DEPTH, **places, until=200.0, absorbing=True)
    assert long.end == pytest.approx(200.0, abs=1.5) and "record ends" in long.reason
    behind = analysis.choose_window(omega, DEPTH, **places, until=200.0, reflector=-5.0)
    assert behind.end == pytest.approx((40 + 10 + 14) / c, abs=1.5)
    far = {**places, "gauges": [14.0, 15.0, 24.0]}
    back = analysis.choose_window(omega, DEPTH, **far, until=200.0, absorbing=True, far_end=40.0)
    assert back.end == pytest.approx((80 - 24) / c, abs=1.5) and "far end" in back.reason
    wall = analysis.choose_window(omega, DEPTH, **places, until=200.0, absorbing=True, rear=23.0)
    assert wall.start == pytest.approx(long.start + 6 / c)


def test_a_long_record_waits_for_what_an_absorber_sends_back():
    omega = 2 * np.pi / 1.5
    c, places = front(omega), {"maker": 0.0, "structure": 20.0, "gauges": [14.0, 15.0], "absorbing": True}
    first = (20 + 6) / c + 4 * 1.5
    for until, start in ((first + 40 / c + 4.9 * 1.5, first), (first + 40 / c + 5.1 * 1.5, first + 40 / c)):
        assert analysis.choose_window(omega, DEPTH, **places, until=until).start == pytest.approx(start)


def test_a_flume_that_is_too_short_says_by_how_much():
    omega, gauges = 2 * np.pi / 1.5, np.array([3.0, 3.4])
    with pytest.raises(AnalysisError, match=r"the flume is too short: .* Put ([0-9.]+) m more") as caught:
        analysis.choose_window(omega, DEPTH, maker=0.0, structure=5.0, gauges=gauges, until=99.0)
    metres = float(str(caught.value).split("Put ")[1].split(" m")[0])
    for extra, good in ((0.97 * metres, False), (1.01 * metres, True)):
        given = {"maker": -extra, "structure": 5.0, "gauges": gauges, "until": 99.0}
        if good:
            assert analysis.choose_window(omega, DEPTH, **given).periods == 3
        else:
            with pytest.raises(AnalysisError, match="too short"):
                analysis.choose_window(omega, DEPTH, **given)
    with pytest.raises(AnalysisError, match=r"the record is too short: .* longer"):
        analysis.choose_window(omega, DEPTH, maker=0.0, structure=50.0, gauges=[40.0], until=30.0)
    with pytest.raises(AnalysisError, match="on the side of the structure"):
        analysis.choose_window(omega, DEPTH, maker=0.0, structure=5.0, gauges=[-1.0], until=99.0)


# the quality card


def empty_flume(decay=0.004, slower=0.99, reflect=0.02, drift=1e-5, lost=0.0, noise=0.0):
    """Gauges every 0.35 m over 12 m; `decay` per wavelength, celerity `slower` times linear theory's."""
    x, time, period = np.arange(2.0, 14.0, 0.35), np.arange(20.0, 41.0, 0.02), 1.5
    omega = 2 * np.pi / period
    k = float(wave_number(omega, DEPTH)) / slower
    kappa = k + 1j * -np.log(1 - decay) * k / (2 * np.pi)
    F = 0.0196 * np.exp(1j * kappa * (x - x[0])) + reflect * 0.0196 * np.exp(1j * kappa * (2 * x[-1] - x - x[0]))
    eta = (F[:, None] * np.exp(-1j * omega * time)).real + DEPTH - lost + drift * (time - 20.0)
    return time, x, eta + noise * np.random.default_rng(0).standard_normal(eta.shape)


def test_the_card_of_a_known_flume():
    card = analysis.quality_card(empty_flume(), depth=DEPTH, period=1.5, height=0.04, window=(20.0, 41.0))
    assert card.decay == pytest.approx(0.004, abs=1e-6)
    assert card.celerity == pytest.approx(-0.01, abs=1e-6)
    assert card.phase == pytest.approx(2 * np.pi * 0.01 / 0.99, rel=1e-3)
    assert card.reflection == pytest.approx(0.02, abs=1e-5)
    assert card.height == pytest.approx(0.0392, rel=1e-5)
    assert card.drift == pytest.approx(1e-5 * 19.5, rel=1e-3)
    assert card.set_down == pytest.approx(1e-5 * 10.5, rel=0.02)
    assert card.periods == 14
    lines = str(card).splitlines()
    assert len(lines) == 8
    assert "-2.00 % of the target" in lines[1] and "0.40 % per wavelength" in lines[2] and "0.0200" in lines[4]


def test_the_card_with_noise_and_from_the_right():
    time, x, eta = empty_flume(noise=0.001, lost=0.0005, drift=0.0)
    given = {"depth": DEPTH, "period": 1.5, "height": 0.04, "window": (20.0, 41.0)}
    card = analysis.quality_card((time, x, eta), **given)
    assert card.decay == pytest.approx(0.004, abs=5e-4)
    assert card.reflection == pytest.approx(0.02, abs=2e-3)
    assert card.set_down == pytest.approx(-0.0005, abs=2e-5)
    mirrored = analysis.quality_card((time, -x, eta), towards=-1.0, **given)
    assert str(mirrored) == str(card)
    reference = 2 * np.pi / (2 * np.pi / float(wave_number(2 * np.pi / 1.5, DEPTH)) * 0.99)
    assert abs(analysis.quality_card((time, x, eta), reference=reference, **given).celerity) < 2e-4


def test_gauges_that_cannot_carry_a_card():
    time, x, eta = empty_flume()
    given = {"depth": DEPTH, "period": 1.5, "height": 0.04, "window": (20.0, 41.0)}
    with pytest.raises(AnalysisError, match="5 or more over a wavelength"):
        analysis.quality_card((time, x[:4], eta[:4]), **given)
    with pytest.raises(AnalysisError, match="check period, depth"):
        analysis.quality_card((time, x, eta), **{**given, "depth": 0.15})


def test_a_short_flume_through_reflection():
    """The window is chosen, the ramp and what comes back later stay outside, and the answer is right."""
    time, period, c = np.arange(0.0, 60.0, 0.02), 1.5, front(2 * np.pi / 1.5)
    x, maker, face = np.array([14.0, 14.3, 14.75]), 0.0, 20.0
    eta = np.zeros((3, len(time)))
    for sign, size, path in ((1, 1.0, x - maker), (-1, 0.3, 2 * face - x - maker), (1, -0.3, 2 * face + x - maker)):
        ramp = np.clip((time - path[:, None] / c) / (2 * period), 0, 1)
        shape = [(1, "bound", 0.01, 0)] if sign > 0 else [(1, "bound", 0, 0.01)]
        eta += size * ramp * flumes.regular(x, time, period, shape)
    found = analysis.reflection((time, x, eta), depth=DEPTH, period=period, maker=maker, structure=face)
    assert pytest.approx(0.3, abs=1e-8) == found.C_R
    assert "re-reflected" in str(found)
    late = analysis.reflection((time, x, eta), depth=DEPTH, period=period, window=(48.0, 60.0))
    assert abs(late.C_R - 0.3) > 0.05
