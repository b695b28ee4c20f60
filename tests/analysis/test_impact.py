"""Largest pressure of a record: how long it lasts, its impulse, what lasts."""

import numpy as np
import pytest

from houle import analysis
from houle.results.summary import pressures


def triangle(time, top, width, at=1.0, base=0.0):
    """A rise and fall of `width` from foot to foot on a steady pressure."""
    return base + top * np.clip(1.0 - np.abs(np.asarray(time) - at) / (width / 2), 0.0, None)


def test_a_triangle():
    time = np.arange(0.0, 2.0005, 0.001)
    found = analysis.largest_pressure(time, triangle(time, 2000.0, 0.04), window=0.01)
    assert (found.largest, found.time) == pytest.approx((2000.0, 1.0))
    assert found.duration == pytest.approx(0.02)
    assert found.impulse == pytest.approx(40.0)
    assert found.lasting == pytest.approx(2000.0 * (1 - 0.0025 / 0.02))


@pytest.mark.parametrize("samples", [1, 2, 4])
def test_the_impulse_does_not_depend_on_how_long_the_step_was(samples):
    """The same momentum stopped in one step of 4, 2 or 1 ms: the pressure differs by four, impulse and mean do not."""
    step = 0.004 / samples
    time = np.arange(0.0, 1.0 + step / 2, step)
    pressure = np.zeros_like(time)
    pressure[len(time) // 2] = 50.0 / step
    found = analysis.largest_pressure(time, pressure, window=0.02)
    assert found.largest == pytest.approx(50.0 / step)
    assert found.impulse == pytest.approx(50.0)
    assert found.duration == pytest.approx(step)
    assert found.lasting == pytest.approx(50.0 / 0.02)


def test_uneven_times_and_the_default_window():
    time = np.array([0.0, 1.0, 1.5, 2.0, 4.0])
    found = analysis.largest_pressure(time, [0.0, 0.0, 4.0, 0.0, 0.0])
    assert found.window == 4.0  # five of the widest samples are longer than the record
    assert found.impulse == pytest.approx(2.0) and found.lasting == pytest.approx(0.5)


def test_a_dry_sensor_has_no_impact():
    found = analysis.largest_pressure([0.0, 1.0, 2.0], [0.0, 0.0, 0.0])
    assert (found.largest, found.duration, found.impulse) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("time", "pressure", "window"),
    [
        ([0.0, 1.0], [0.0, np.nan], None),
        ([0.0, 0.0], [0.0, 1.0], None),
        ([0.0], [1.0], None),
        ([0.0, 1.0], [0.0, 1.0], 0.0),
    ],
)
def test_what_is_no_record_is_refused(time, pressure, window):
    with pytest.raises(analysis.AnalysisError, match="largest pressure"):
        analysis.largest_pressure(time, pressure, window=window)


def test_one_step_is_called_an_impulse():
    entry = {"sensor": "P", "largest": 28e3, "time": 1.0, "duration": 1e-3, "impulse": 28.0, "lasting": 4e3}
    entry |= {"window": 5e-3, "steps": 1.0}
    ((name, line),) = pressures([entry])
    assert name == "P" and line == "28.0 kPa at 1 s for 1 ms (28 Pa s, one step: an impulse); over 5 ms 4000 Pa"
    ((_, line),) = pressures([entry | {"steps": 20.0}])
    assert "one step" not in line
