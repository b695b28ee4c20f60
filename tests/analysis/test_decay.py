"""Decay of pressure along the inside of a structure: exact where it is exponential, its interval where it is not."""

from __future__ import annotations

import numpy as np
import pytest

from houle.analysis import AnalysisError, pressure_decay

TIME = np.arange(0.0, 120.0, 0.02)
PLACES = np.array([0.1, 0.3, 0.45])


def sea(rate: float, seed: int = 1) -> np.ndarray:
    """Pressures (3, T) of a sea of 1 to 2 s that goes in with 0.5 m/s and decays, above a level that creeps up."""
    random = np.random.default_rng(seed)
    omega, phase = 2 * np.pi / random.uniform(1.0, 2.0, 40), random.uniform(0.0, 2 * np.pi, 40)
    waves = [np.cos(omega * (TIME[:, None] - x / 0.5) + phase).sum(axis=1) * np.exp(-rate * x) for x in PLACES]
    return np.stack(waves) * 30.0 + 500.0 + 2.0 * TIME


def test_an_exponential_decay_is_found_whatever_the_phases_and_the_level_at_rest():
    found = pressure_decay(TIME, sea(3.0), PLACES, waves=80, window=15.0)
    assert found.rate == pytest.approx(3.0, rel=0.03) and found.low < 3.0 < found.high
    assert found.p_0 == pytest.approx(30.0 * np.sqrt(20.0), rel=0.1) and found.misfit < 0.02


def test_waves_in_phase_have_the_rate_to_round_off():
    record = np.exp(-4.0 * PLACES)[:, None] * np.sin(2 * np.pi * TIME / 1.5)
    found = pressure_decay(TIME, record, PLACES, waves=80, window=15.0)
    assert [found.rate, found.low, found.high] == pytest.approx([4.0] * 3, rel=1e-9)
    assert found.misfit == pytest.approx(0.0, abs=1e-9)
    assert found.rms[0] == pytest.approx(np.exp(-0.4) / np.sqrt(2), rel=1e-3)


def test_intervals_hold_the_rate_nine_times_in_ten():
    """Waves of random heights that differ from sensor to sensor: 80 to 97 of 100 intervals hold it (90 +- 3 sigma)."""
    random, held = np.random.default_rng(4), 0
    for _ in range(100):
        height = np.repeat(random.rayleigh(1.0, (2, 80)) + random.rayleigh(1.0, 80), 20, axis=1)
        record = np.exp(-2.0 * PLACES[:2])[:, None] * height * np.tile(np.sin(2 * np.pi * np.arange(20) / 20), 80)
        found = pressure_decay(np.arange(1600) * 0.075, record, PLACES[:2], waves=80, window=15.0)
        held += found.low <= 2.0 <= found.high
    assert 80 <= held <= 97


@pytest.mark.parametrize(
    ("record", "places", "waves", "said"),
    [
        (sea(3.0), [0.1, 0.1, 0.1], 80, "2 places"),
        (sea(3.0), PLACES, 2, "3 waves"),
        (sea(3.0)[:2], PLACES, 80, "sensors"),
        (np.ones((3, len(TIME))), PLACES, 80, "stands still"),
    ],
)
def test_what_is_no_decay_is_told(record, places, waves, said):
    with pytest.raises(AnalysisError, match=said):
        pressure_decay(TIME, record, places, waves=waves, window=15.0)
