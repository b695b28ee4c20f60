"""Amplitudes are averaged with their phase: a period that is a little off is followed, one that is far off refused."""

import numpy as np
import pytest

from analysis import flumes
from houle import analysis
from houle.analysis import phase
from houle.analysis.errors import AnalysisError

DEPTH, PERIOD = 0.25, 4 / 3
GAUGES = np.array([0.0, 0.31, 0.55, 0.9])
TIME = np.arange(0.0, 200.0, 0.02)
PARTS = [(1, "bound", 0.0125, 0.00125j), (2, "bound", 0.001, 0.0002)]


def found(eta, period=PERIOD, window=(60, 180), x=GAUGES, time=TIME, **more):
    return analysis.reflection((time, x, eta), depth=DEPTH, period=period, window=window, **more)


def turned(note):
    return "the phase turns" in note


@pytest.mark.parametrize("count", [2, 3, 4])
@pytest.mark.parametrize("period", [1.333, 1.33, 1.34, 4 / 3])
def test_a_rounded_period_is_followed(count, period):
    """A record of T = 1.3333 s, 90 periods: 8 % and 30 % of the height were lost without a word."""
    x = GAUGES[:count]
    r = found(flumes.regular(x, TIME, PERIOD, PARTS), period, x=x)
    assert pytest.approx(0.025, rel=1.5e-3) == r.H_I
    assert pytest.approx(0.1, abs=1e-3) == r.C_R
    said = [note for note in r.notes if turned(note)]
    assert len(said) == (abs(period - PERIOD) > 1e-3)
    if said:
        assert r.period == pytest.approx(PERIOD, abs=1e-7) and "1.33333 s" in said[0]
        assert pytest.approx(0.025, rel=1e-6) == r.H_I


@pytest.mark.parametrize("period", [1.30, 1.25, 1.4, 1.5, 2 * PERIOD, PERIOD / 2, 0.9, 3 * PERIOD, PERIOD / 3])
def test_a_wrong_period_is_refused_with_the_one_that_fits(period):
    with pytest.raises(AnalysisError, match=r"the period that fits is 1\.3[34]"):
        found(flumes.regular(GAUGES, TIME, PERIOD, PARTS), period)


@pytest.mark.parametrize("periods", [3, 4, 5, 12])
@pytest.mark.parametrize("noise", [0.0, 0.03])
def test_short_windows_keep_the_period_that_is_right(periods, noise):
    """With noise of 3 % of the height a period that is exact is not changed, and the interval holds."""
    inside = 0
    for seed in range(20):
        time = np.arange(0.0, (periods + 0.5) * PERIOD, PERIOD / 40)
        eta = flumes.regular(GAUGES, time, PERIOD, PARTS)
        eta = eta + noise * 0.025 * np.random.default_rng(seed).standard_normal(eta.shape)
        r = found(eta, window=(0.0, (periods + 0.2) * PERIOD), time=time)
        assert r.period == pytest.approx(PERIOD, rel=1e-12) and not any(map(turned, r.notes))
        assert r.window.periods == periods
        inside += r.interval_R[0] <= 0.1 + 1e-9 and r.interval_R[1] >= 0.1 - 1e-9
    assert inside >= 17


def test_waves_that_turn_slowly_are_followed():
    """The phase drifts by 1 rad over 40 periods, as in a flume whose sea changes: all the height is found, and said."""
    omega, time = 2 * np.pi / PERIOD, np.arange(0.0, 60.0, 0.02)
    k = float(analysis.wave_number(omega, DEPTH))
    drift = time / 53.3
    eta = np.array([0.0125 * np.cos(k * x - omega * time + drift) + 0.005 * np.cos(-k * x - omega * time + drift)
                    for x in GAUGES])  # fmt: skip
    r = found(eta, window=(0, 60), time=time)
    assert pytest.approx(0.025, rel=2e-3) == r.H_I and pytest.approx(0.4, abs=2e-3) == r.C_R
    assert any(map(turned, r.notes))


def test_a_phase_that_goes_to_and_fro_is_told():
    """No period follows it: the mean loses height, the note says how much."""
    omega, time = 2 * np.pi / PERIOD, np.arange(0.0, 60.0, 0.02)
    k = float(analysis.wave_number(omega, DEPTH))
    wander = 0.8 * np.sin(2 * np.pi * time / 30.0)
    eta = np.array([0.0125 * np.cos(k * x - omega * time + wander) for x in GAUGES])
    r = found(eta, window=(0, 60), time=time)
    assert r.H_I < 0.024 and any("of the amplitude of single ones" in note for note in r.notes)


def test_waves_from_the_other_side_and_a_standing_wave():
    for incident, reflected, ratio in ((0.00125, 0.0125, 10.0), (0.0125, 0.0125, 1.0)):
        eta = flumes.regular(GAUGES, TIME, PERIOD, [(1, "bound", incident, reflected)])
        r = found(eta, 1.33)
        assert pytest.approx(ratio, rel=1e-3) == r.C_R
        assert any("have changed places" in note for note in r.notes) == (ratio > 1.001)


def test_positions_that_are_reversed_are_told():
    eta = flumes.regular(GAUGES, TIME, PERIOD, [(1, "bound", 0.0125, 0.005)])
    r = found(eta, x=-GAUGES)
    assert pytest.approx(2.5, rel=1e-6) == r.C_R
    assert sum("changed places" in note for note in r.notes) == 1 and "towards" in str(r)
    assert not any("changed places" in note for note in found(eta).notes)


def test_more_behind_than_came_is_told():
    x = np.append(GAUGES, 7.0)
    eta = np.vstack([flumes.regular(GAUGES, TIME, PERIOD, PARTS), 1.2 * flumes.regular([7.0], TIME, PERIOD, PARTS[:1])])
    assert any("C_D = " in note for note in found(eta, x=x, behind=[4]).notes)


def test_the_turn_and_its_error():
    """Against the least possible error of a line's frequency, 6 s / (A^2 n (n^2 - 1))."""
    n, rng = 30, np.random.default_rng(2)
    rates, errors = [], []
    for _ in range(300):
        F = np.exp(0.2j * np.arange(n))[:, None] * np.array([1.0, 0.5j])
        F = F + 0.05 * (rng.standard_normal((n, 2)) + 1j * rng.standard_normal((n, 2)))
        t = phase.turn(F)
        rates.append(t.rate)
        errors.append(t.error)
    assert np.mean(rates) == pytest.approx(0.2, abs=3 * np.std(rates) / np.sqrt(300))
    assert np.std(rates) == pytest.approx(np.mean(errors), rel=0.15)
    exact = phase.turn(np.exp(-1.3j * np.arange(7))[:, None])
    assert exact.rate == pytest.approx(-1.3, abs=1e-10) and exact.coherence == pytest.approx(1.0)


def test_the_card_of_an_empty_flume_follows_too():
    x, time = np.arange(0.0, 4.0, 0.3), np.arange(0.0, 130.0, 0.04)
    eta = flumes.regular(x, time, PERIOD, [(1, "bound", 0.02, 0.0002)]) + 0.102
    given = {"depth": DEPTH, "height": 0.04, "window": (5.0, 125.0)}
    card = analysis.quality_card((time, x, eta), period=1.33, **given)
    assert card.height == pytest.approx(0.04, rel=1e-4) and any(map(turned, card.notes))
    with pytest.raises(AnalysisError, match=r"the period that fits is 1\.333"):
        analysis.quality_card((time, x, eta), period=1.25, **given)
    assert np.isnan(card.set_down) and "0.102 m: neither 0 nor the depth" in str(card), "another zero is no surge"
    card = analysis.quality_card((time, x, eta), period=PERIOD, still_water=0.1, **given)
    assert card.set_down == pytest.approx(0.002, abs=1e-6)


def test_still_water_above_the_bed_holds_no_wave():
    """What is left of a level of 0.25 m after its mean is rounding: it gave a C_R of 2.6."""
    with pytest.raises(AnalysisError, match="no incident wave"):
        found(np.full((4, len(TIME)), DEPTH))


def test_gauges_at_rest_hold_no_wave():
    """An empty flume before the maker starts: one sentence, no division by what is not there."""
    time, x = np.arange(1200) * 0.05, np.array([0.0, 0.3, 0.7, 1.1, 1.8, 2.5, 3.0])
    still = (time, x, np.zeros((7, 1200)))
    with pytest.raises(analysis.AnalysisError, match="they are at rest"):
        analysis.quality_card(still, depth=0.3, period=1.5, height=0.02, window=(0.0, 60.0))
    with pytest.raises(analysis.AnalysisError, match="they are at rest"):
        analysis.reflection(still, depth=0.3, period=1.5, kind="irregular", window=(0.0, 60.0))
