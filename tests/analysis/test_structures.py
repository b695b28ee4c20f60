"""Run-up, overtopping, erosion: statistics by hand, and formulas at values worked out on paper."""

import re

import numpy as np
import pytest

from houle import analysis
from houle.analysis.errors import AnalysisError


def climbs(peaks, per=100):
    s = np.sin(2 * np.pi * np.arange(per) / per)
    return np.arange(len(peaks) * per + 20) * 0.01, np.concatenate(
        [np.full(10, -0.5), *[p * s for p in peaks], np.full(10, -0.5)]
    )


def test_run_up_of_a_hundred_waves():
    peaks = np.random.default_rng(0).permutation(np.arange(1, 101) / 100)
    time, level = climbs(peaks)
    found = analysis.run_up(time, level)
    assert len(found.peaks) == 100
    assert found.R_max == pytest.approx(1.0, rel=1e-3)
    assert pytest.approx(0.99, rel=1e-3) == found.R_2, "the second of a hundred"
    assert pytest.approx(np.mean(np.arange(68, 101)) / 100, rel=1e-3) == found.R_13
    more = analysis.run_up(time, level, waves=200)
    assert pytest.approx(0.97, rel=1e-3) == more.R_2, "of 200 incident waves, the fourth"
    assert found.exceeded(0.001) != found.exceeded(0.001), "beyond the data: NaN"


def test_few_run_ups_give_no_two_per_cent():
    found = analysis.run_up(*climbs([0.1, 0.3, 0.2]))
    assert np.isnan(found.R_2) and "50 waves are needed" in str(found)
    with pytest.raises(AnalysisError, match="3 run-ups from 2 incident waves"):
        analysis.run_up(*climbs([0.1, 0.3, 0.2]), waves=2, threshold=0.05)
    with pytest.raises(AnalysisError, match="no whole run-up"):
        analysis.run_up(np.arange(9.0), np.zeros(9))


def test_overtopping_is_cut_into_events_and_noise_left_out():
    time = np.arange(0.0, 101.0)
    flow = np.zeros(100)
    flow[10:12], flow[30:35], flow[36], flow[70] = 0.01, 0.02, 0.005, 1e-5
    volume = np.append(0.0, np.cumsum(flow))
    found = analysis.overtopping_events(time, volume, waves=50, threshold=1e-4)
    assert np.allclose(found.volumes, [0.02, 0.1, 0.005])
    assert np.allclose(found.times[:2], [[10, 12], [30, 35]])
    assert found.q == pytest.approx(0.12501 / 100)
    assert found.V_max == pytest.approx(0.1)
    assert found.ignored == pytest.approx(1e-5)
    assert found.probability == pytest.approx(3 / 50)
    joined = analysis.overtopping_events(time, volume, threshold=1e-4, pause=1.0)
    assert np.allclose(joined.volumes, [0.02, 0.105])


def test_water_that_flows_back_and_none_at_all():
    time, volume = np.arange(6.0), np.array([0.0, 1.0, 2.0, 1.5, 1.5, 1.5])
    assert np.allclose(analysis.overtopping_events(time, volume).volumes, [1.5])
    dry = analysis.overtopping_events(time, np.zeros(6))
    assert dry.q == 0 and dry.V_max == 0 and len(dry.volumes) == 0
    with pytest.raises(AnalysisError, match="time must rise"):
        analysis.overtopping_events(time[::-1], volume)


# ---- overtopping from the gauge of a tank ----------------------------------------------------------------------------

STEPS = np.array([1.46, 0.90, 0.56, 0.52, 1.72, 1.10]) * 1e-3  # m3/m, each in half a second, every 10 s from 5 s on


def tank(noise=0.0, drift=0.0, unit=0.0, offset=0.0, swing=0.0, emptied=None, every=0.01, steps=STEPS):
    """Time and volume of a tank: what came over, and what its gauge makes of it. emptied: from, to [s], share."""
    time = np.arange(0.0, 10.0 * len(steps) + 5.0, every)
    volume = np.full_like(time, 0.0)
    for i, step in enumerate(steps):
        since = time - 5.0 - 10.0 * i
        volume += step * np.clip(since / 0.5, 0.0, 1.0)
        free = np.maximum(since - 0.5, 0.0)
        volume += swing * step * np.exp(-free / 2.5) * np.sin(2 * np.pi * free / 0.9)
    if emptied:
        start, end, share = emptied
        volume -= share * np.interp(start, time, volume) * np.clip((time - start) / (end - start), 0.0, 1.0)
    volume += offset + drift * time + noise * np.random.default_rng(7).standard_normal(len(time))
    return time, np.round(volume / unit) * unit if unit else volume


GAUGES = {
    "noise of 1 % of a step": {"noise": 1e-5},
    "of 5 %": {"noise": 5e-5},
    "of 20 %": {"noise": 2e-4},
    "drift up": {"noise": 2e-5, "drift": 1e-5},
    "drift down": {"noise": 2e-5, "drift": -4e-5},
    "counted in units": {"unit": 5e-5},
    "in units, with noise": {"unit": 5e-5, "noise": 3e-5},
    "offset": {"noise": 2e-5, "offset": -0.3},
    "swings": {"swing": 0.25},
    "swings and noise": {"swing": 0.25, "noise": 2e-5},
    "a slow recorder": {"noise": 2e-5, "every": 0.1},
}


@pytest.mark.parametrize("gauge", GAUGES)
@pytest.mark.parametrize("pause", [0.0, 2.0])
def test_the_gauge_of_a_tank_is_not_taken_for_water(gauge, pause):
    """Six steps within four of their standard errors, at their times; none of the noise bridges a pause."""
    time, volume = tank(**GAUGES[gauge])
    found = analysis.overtopping_events(time, volume, waves=30, pause=pause)
    assert len(found.volumes) == len(STEPS)
    assert np.all(np.abs(found.volumes - STEPS) < 4 * found.errors)
    assert np.all(found.errors < 0.15 * STEPS)
    assert found.times == pytest.approx(5.0 + 10.0 * np.arange(6)[:, None] + [0.0, 0.5], abs=1.0)
    assert abs(found.q - STEPS.sum() / np.ptp(time)) < 4 * found.q_error < 0.1 * found.q
    if "swing" not in GAUGES[gauge]:
        assert found.noise == pytest.approx(GAUGES[gauge].get("noise", found.noise), rel=0.3)
    assert ("drift" in str(found)) == ("drift" in GAUGES[gauge])


@pytest.mark.parametrize("noise", [0.0, 2e-5])
@pytest.mark.parametrize("emptied", [(39.0, 42.0, 0.95), (39.0, 39.01, 1.0), (28.0, 31.0, 0.7)])
def test_a_tank_that_is_emptied_goes_on(noise, emptied):
    """The record is bridged and says where; q is over the time in which the tank was filled."""
    time, volume = tank(noise=noise, emptied=emptied)
    found = analysis.overtopping_events(time, volume)
    assert len(found.volumes) == len(STEPS)
    assert found.volumes == pytest.approx(STEPS, rel=0.03)
    filling = np.ptp(time) - (emptied[1] - emptied[0])
    assert found.q == pytest.approx(STEPS.sum() / filling, rel=5e-3)
    said = r"emptied at (27\.9|28|38\.9|39)(\.?\d*) s"
    assert re.search(said, found.notes[0])
    with pytest.raises(AnalysisError, match=said):
        analysis.overtopping_events(time, volume, emptied="refuse")
    lost = analysis.overtopping_events(time, volume, emptied="ignore")
    assert lost.total < 0.7 * found.total


def test_swings_of_the_tank_are_no_emptyings():
    for noise in (0.0, 1e-5, 3e-5):
        found = analysis.overtopping_events(*tank(noise=noise, swing=0.4), pause=1.0)
        assert not any("emptied" in note for note in found.notes)
        assert found.total == pytest.approx(STEPS.sum(), rel=0.01)


def test_noise_and_drift_alone_are_no_events():
    for drift in (0.0, 1e-5, -1e-5):
        found = analysis.overtopping_events(*tank(noise=2e-5, drift=drift, steps=np.zeros(6)))
        assert len(found.volumes) == 0
        assert abs(found.total) < 1e-5


def test_a_gap_in_the_record_is_named():
    time, volume = tank()
    volume[[500, 501]] = np.nan
    with pytest.raises(AnalysisError, match=r"no volume at 5, 5\.01 s"):
        analysis.overtopping_events(time, volume)
    with pytest.raises(AnalysisError, match="none of"):
        analysis.overtopping_events(*tank(), emptied="maybe")


def test_exit_gradient_of_a_drawdown():
    """0.5 m of head over 0.5 m for two of ten seconds: i = 1 against 1.65 x 0.6 = 0.99."""
    time = np.arange(0.0, 10.0, 0.01)
    head = np.where((time >= 4) & (time < 6), 0.5, 0.1)
    found = analysis.exit_gradient(
        time, 9810 * (1.0 + head), np.full_like(time, 9810 * 1.3), [2.0, 0.5], [1.6, 0.2], porosity=0.4
    )
    assert found.largest == pytest.approx((1.5 + 0.5 - 1.5) / 0.5)
    assert found.critical == pytest.approx(0.99)
    assert found.time_above == pytest.approx(2.0, abs=0.02)
    assert found.safety == pytest.approx(0.99, rel=1e-6)
    still = analysis.exit_gradient(time, 9810 * (3 - 0 * time), 9810 * (3.3 - 0 * time), [2, 0.5], [1.6, 0.2], 0.4)
    assert abs(still.largest) < 1e-12, "hydrostatic: no gradient"
    with pytest.raises(AnalysisError, match="0 < porosity < 1"):
        analysis.critical_gradient(40)


def test_the_shields_number_is_the_one_computed_by_hand():
    """d = 1 mm, U = 0.5 m/s at 0.1 m: u* = 0.4 x 0.5 / ln(1200) = 28.2 mm/s, theta = 0.0492; critical (D* = 25.3)
    0.0314.
    """
    found = analysis.shields([0.5, -0.25], 0.1, 1e-3)
    assert found.friction_velocity[0] == pytest.approx(0.02821, rel=1e-3)
    assert found.number == pytest.approx([0.04916, 0.01229], rel=1e-3)
    star = 1e-3 * (1.65 * 9.81 / 1e-12) ** (1 / 3)
    assert star == pytest.approx(25.3, rel=1e-2)
    assert found.critical == pytest.approx(0.0314, rel=1e-2)
    assert found.moving == 0.5
    slope = analysis.shields([0.5], 0.1, 1e-3, slope=np.radians(16), repose=np.radians(32))
    assert slope.critical / found.critical == pytest.approx(np.sin(np.radians(16)) / np.sin(np.radians(32)))
    for wrong in ({"height": 1e-4}, {"slope": 0.7}):
        with pytest.raises(AnalysisError):
            analysis.shields([0.5], **{"height": 0.1, "grain_diameter": 1e-3, **wrong})


def test_lag_of_the_phreatic_line():
    time = np.arange(0.0, 60.0, 0.05)
    outside = np.exp(-(((time - 25) / 4) ** 2)) * -0.3
    inside = np.exp(-(((time - 27.33) / 4) ** 2)) * -0.1 + 0.02
    assert analysis.lag(time, outside, inside) == pytest.approx(2.33, abs=0.01)
    assert analysis.lag(time, inside, outside) == pytest.approx(-2.33, abs=0.01)
    a, b = np.cos(2 * np.pi * time / 7.0), 0.2 * np.cos(2 * np.pi * (time - 1.234) / 7.0)
    assert analysis.lag(time, a, b, period=7.0) == pytest.approx(1.234, abs=1e-10)
    assert analysis.lag(time, a, b) == pytest.approx(1.234, abs=0.01)  # not one or two periods later
    with pytest.raises(AnalysisError, match="no common signal"):
        analysis.lag(time, outside, 0 * inside)
