"""What of a random sea is in a window: theory at the gauges, taken apart like the run."""

import numpy as np
import pytest

from houle import analysis
from houle.analysis import energies
from houle.case.model import load
from houle.results import reflection


def measured(case, end, scale=1.0):
    """The incident height at the gauges of a case, of waves of theory times `scale`."""
    x = np.array([gauge.x for gauge in case.gauge if gauge.name in case.reflection.gauges])
    time, wave = np.arange(0.0, end, 0.05), reflection.wave_of(case)
    eta = scale * np.array([wave.elevation(place, time) for place in x])
    period = case.waves.period
    return analysis.reflection(
        (time, x, eta), depth=case.waves.depth, period=period, kind="irregular", window=(13.0, end), towards=1.0
    )


def test_a_window_of_a_random_sea_is_measured_against_that_sea():
    """In 22 periods the height is 6 to 12 % off; against the sea as made nothing is left, and a loss of 3 % is seen."""
    case = load("breakwater")
    found = measured(case, 13.0 + 22 * case.waves.period)
    assert abs(found.H_I / case.waves.height - 1) > 0.05
    assert reflection.as_made(case, found) == pytest.approx(found.H_I, rel=1e-12)
    lower = measured(case, 13.0 + 22 * case.waves.period, 0.97)
    assert lower.H_I / reflection.as_made(case, lower) == pytest.approx(0.97, rel=1e-9)


def test_the_height_is_not_lowered_by_weighing_its_lines():
    """The trust in a line says how much it counts in C_R; the height is that of all the lines in the band."""
    shares = []
    for seed in (1, 2, 3, 4):
        case = load("breakwater", {"waves.seed": seed})
        found = measured(case, 13.0 + 22 * case.waves.period)
        record = found.record.between(found.window.start, found.window.end)
        f_p = 1.0 / case.waves.period
        f, F, unit = energies.fourier(record, (0.5 * f_p, 2 * f_p), 0.1)
        shares.append(found.H_I / (4 * np.sqrt(unit * np.mean(np.sum(np.abs(F) ** 2, axis=0)) * (f[1] - f[0]))))
    assert np.mean(shares) == pytest.approx(1.0, abs=0.005)


def test_there_is_none_for_regular_waves():
    case = load("wave-block")
    time, x = np.arange(0.0, 15.0, 0.05), np.array([4.0, 4.3, 4.7])
    eta = np.array([reflection.wave_of(case).elevation(place, time) for place in x])
    found = analysis.reflection((time, x, eta), depth=0.25, period=1.5, window=(0.0, 15.0), towards=1.0)
    assert np.isnan(reflection.as_made(case, found))
