"""Waves on a current: seen from the moving water they are those of water at rest."""

import numpy as np
import pytest

from houle.case.tables.waves import Waves
from houle.case.wave import make
from houle.waves import dispersion
from houle.waves.current import carried
from houle.waves.theories import regular
from houle.waves.wave import WaveError

DEPTH, PERIOD = 0.25, 1.2
ZONE = {"zone": {"x": (0.0, 3.0)}}


def test_dispersion_holds_on_the_current():
    omega = np.linspace(0.5, 12.0, 40)
    for current in (0.4, 0.1, -0.05):
        k = dispersion.wave_number(omega, DEPTH, current=current)
        going = np.isfinite(k)
        left = omega - k * current - np.sqrt(9.81 * k * np.tanh(k * DEPTH))
        assert np.abs(left[going]).max() < 1e-12
        assert np.all(going) if current > 0 else going[0]
        assert np.all(dispersion.group_velocity(k[going], DEPTH) + current > 0)


def test_deep_water_is_stopped_at_a_quarter_of_its_speed():
    """k = omega / U (2 - ...) ends where U = -g / (4 omega): Longuet-Higgins & Stewart (1961)."""
    omega = 2 * np.pi
    limit = 9.81 / (4 * omega)
    assert np.isfinite(dispersion.wave_number(omega, 100.0, current=-0.999 * limit))
    assert np.isnan(dispersion.wave_number(omega, 100.0, current=-1.001 * limit))
    k = dispersion.wave_number(omega, 100.0, current=-0.999999 * limit)
    assert k == pytest.approx(4 * omega**2 / 9.81, rel=0.01)


@pytest.mark.parametrize("theory", ["airy", "stokes-2", "fenton", "cnoidal"])
@pytest.mark.parametrize("current", [0.3, -0.2])
def test_the_wave_is_that_of_still_water_carried_along(theory, current):
    period = 3.0 if theory == "cnoidal" else PERIOD
    wave = carried(lambda t: regular(theory, 0.03, t, DEPTH), period, DEPTH, 9.81, current)
    relative = 1 / (1 / period - current / wave.length)
    still = regular(theory, 0.03, relative, DEPTH)
    assert wave.period == period and wave.length == pytest.approx(still.length, rel=1e-10)
    assert (wave.length > regular(theory, 0.03, period, DEPTH).length) == (current > 0)
    x, t, z = np.linspace(0.0, 4.0, 37), 0.7, np.linspace(0.0, DEPTH, 37)
    assert wave.elevation(x, t) == pytest.approx(still.elevation(x - current * t, t), abs=1e-11)
    assert np.allclose(wave.velocity(x, z, t), still.velocity(x - current * t, z, t), atol=1e-10)
    parts = wave.components()
    assert parts is not None
    assert parts.elevation(x, t) == pytest.approx(wave.elevation(x, t), abs=1e-9)


@pytest.mark.parametrize("kind", ["regular", "jonswap", "focused", "solitary"])
def test_the_case_file_brings_the_current(kind):
    keys = {"height": 0.02, "depth": DEPTH, "current": 0.2, **ZONE}
    if kind != "solitary":
        keys["period"] = PERIOD
    if kind == "focused":
        keys["focus"] = {"x": 5.0, "time": 4.0}
    wave, still = (make(Waves(kind=kind, **{**keys, "current": u})) for u in (0.2, 0.0))
    parts = wave.components()
    if parts is None:
        assert wave.celerity == pytest.approx(still.celerity + 0.2)
        return
    first = 0
    residual = parts.omega - parts.k * 0.2 - dispersion.frequency(parts.k, DEPTH)
    assert abs(residual[first]) < (1e-9 if kind != "regular" else 0.05)
    assert wave.length > still.length
    assert wave.celerity * wave.period == pytest.approx(wave.length)


def test_a_current_that_stops_the_waves_is_refused():
    with pytest.raises(WaveError, match="stops those of"):
        make(Waves(kind="regular", height=0.01, period=0.6, depth=DEPTH, current=-0.5, **ZONE))
