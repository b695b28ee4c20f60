"""Records with holes, codes, rounded and uneven times: the times are used, and what became of the holes is said."""

import numpy as np
import pytest

from houle import analysis
from houle.analysis.errors import AnalysisError

T = np.arange(0.0, 15600.0, 0.5)  # 4 h 20 min
CODES = (-9999.0, 99.99, -999.25)


def storm(seed=0, peak=10.5, time=T):
    """A narrow sea of H_m0 = 3 m about T_p."""
    rng = np.random.default_rng(seed)
    f = np.linspace(0.6, 2.2, 400) / peak
    density = (f * peak) ** -5 * np.exp(-1.25 * (f * peak) ** -4)
    a = np.sqrt(density / density.sum()) * np.sqrt(2) * 3.0 / 4
    z, phases = np.zeros(len(time)), rng.random(400)
    for amplitude, frequency, phase in zip(a, f, phases, strict=True):
        z += amplitude * np.cos(2 * np.pi * (frequency * time + phase))
    return z


@pytest.fixture(scope="module")
def sea():
    return storm()


@pytest.mark.parametrize("hole", ["nan", "left out", "code"])
def test_twenty_minutes_without_levels(sea, hole):
    """T_p was 1950 s with NaN, and late by the dropped share when the samples were left out; now as of the whole."""
    whole, waves = analysis.spectrum(T, sea, 300.0), analysis.zero_crossing(T, sea)
    gone = (T > 6000) & (T < 7200)
    t, z = T.copy(), sea.copy()
    if hole == "left out":
        t, z = t[~gone], z[~gone]
    else:
        z[gone] = np.nan if hole == "nan" else -9999.0
    found, rest = analysis.spectrum(t, z, 300.0), analysis.zero_crossing(t, z)
    assert found.T_p == pytest.approx(whole.T_p, rel=0.03) and found.T_m10 == pytest.approx(whole.T_m10, rel=0.02)
    assert found.H_m0 == pytest.approx(whole.H_m0, rel=0.03)
    assert rest.T_z == pytest.approx(waves.T_z, rel=0.02) and pytest.approx(waves.H_13, rel=0.02) == rest.H_13
    assert pytest.approx(1200 / waves.T_z, abs=0.1 * 1200 / waves.T_z) == waves.N - rest.N
    assert rest.periods.max() < 60 and any("holes" in note or "missing" in note for note in rest.notes)
    assert "6000" in " ".join(found.notes) and "note: " in str(found)
    assert whole.notes == waves.notes == ()


def test_scattered_samples_are_bridged(sea):
    """One sample in 40 is missing: no wave is lost for it."""
    z = sea.copy()
    z[5::40] = np.nan
    assert analysis.spectrum(T, z).T_p == pytest.approx(analysis.spectrum(T, sea).T_p, rel=0.01)
    assert analysis.spectrum(T, z).H_m0 == pytest.approx(analysis.spectrum(T, sea).H_m0, rel=0.01)
    assert pytest.approx(analysis.zero_crossing(T, sea).N, rel=0.005) == analysis.zero_crossing(T, z).N
    assert "bridged" in " ".join(analysis.spectrum(T, z).notes)


def test_rounded_and_uneven_times():
    time = np.arange(3000) / 30.0  # 30 Hz, written with two decimals
    z = np.sin(2 * np.pi * time / 2.5)
    for t in (np.round(time, 2), time + 0.3 / 30 * np.random.default_rng(1).random(3000)):
        level = np.sin(2 * np.pi * t / 2.5) if t[1] != np.round(time, 2)[1] else z
        assert analysis.spectrum(t, level, 50.0).T_p == pytest.approx(2.5, rel=0.02)
        assert analysis.zero_crossing(t, level).T_z == pytest.approx(2.5, rel=1e-3)
        assert 2 * np.pi / analysis.find_omega(t, level) == pytest.approx(2.5, rel=1e-4)
    g = analysis.gauges(np.round(time, 2), [0.0], [z])
    assert g.step == pytest.approx(1 / 30, rel=1e-4) and np.ptp(np.diff(g.time)) < 1e-12
    uneven = np.cumsum(np.random.default_rng(2).uniform(0.02, 0.2, 2000))
    level = np.sin(2 * np.pi * uneven / 2.5)
    assert analysis.spectrum(uneven, level, 50.0).T_p == pytest.approx(2.5, rel=0.03)
    assert "uneven" in analysis.spectrum(uneven, level, 50.0).notes[0]
    assert analysis.zero_crossing(uneven, level).T_z == pytest.approx(2.5, rel=2e-3)
    with pytest.raises(AnalysisError, match=r"not evenly spaced and rising: samples \d+ and \d+ are"):
        analysis.gauges(uneven, [0.0], [level])


def test_the_frequency_of_a_record_with_holes():
    """Exact whatever is missing, and a warning says what."""
    t = np.arange(0.0, 60.0, 0.05)
    z = 0.02 * np.cos(4.1 * t + 0.3) + 0.004 * np.cos(8.2 * t)
    holed = z.copy()
    holed[300:420], holed[700] = np.nan, -9999.0
    with pytest.warns(UserWarning, match="121 of 1200 samples without level"):
        assert analysis.find_omega(t, holed) == pytest.approx(4.1, rel=1e-9)
    keep = np.isfinite(holed) & (holed > -1)
    assert analysis.find_omega(t[keep], z[keep]) == pytest.approx(4.1, rel=1e-9)


@pytest.mark.parametrize("function", ["spectrum", "zero_crossing", "find_omega", "run_up", "gauges"])
def test_a_time_that_is_none_is_refused_with_its_sample(function):
    t = np.arange(0.0, 20.0, 0.1)
    z = np.sin(4 * t)
    for place, value, said in ((57, np.nan, "sample 57 has t = nan"), (58, 1.0, "sample 58 has t = 1 s after 5.7 s"),
                               (60, np.inf, "sample 60"), (61, 6.0, "sample 61 has t = 6 s after 6 s")):  # fmt: skip
        spoiled = t.copy()
        spoiled[place] = value
        with pytest.raises(AnalysisError, match=said):
            if function == "gauges":
                analysis.gauges(spoiled, [0.0], [z])
            else:
                getattr(analysis, function)(spoiled, z)
    for none in (t[::-1], 0 * t, np.random.default_rng(0).random(len(t))):
        with pytest.raises(AnalysisError, match="sample"):
            analysis.zero_crossing(none, z)


def test_gauges_and_run_up_name_the_sample():
    t = np.arange(0.0, 20.0, 0.1)
    for code in CODES:
        z = 0.25 + 0.02 * np.sin(4 * t)
        z[50] = code
        with pytest.raises(
            AnalysisError, match=rf"gauge x=0 holds {code:g}, a code for a missing value, at t = 5 s.*5.1 to 19.9"
        ):
            analysis.gauges(t, [0.0], [z])
        with pytest.raises(AnalysisError, match=r"there is none at t = 5 s.*taken for a missing value"):
            analysis.run_up(t, z)


def test_levels_that_no_water_has():
    t, x = np.arange(0.0, 40.0, 0.05), np.array([0.0, 0.35])
    eta = np.array([20.0 * np.cos(4.1888 * t), 19.0 * np.cos(4.1888 * t - 1)])
    with pytest.raises(AnalysisError, match=r"gauge x=0 goes from -20 m .* in 0.25 m of water: check its unit"):
        analysis.reflection((t, x, eta), depth=0.25, period=1.5, window=(0, 40))


def test_dates_and_units_of_datasets():
    import xarray

    t, x = np.arange(0.0, 40.0, 0.05), [0.0, 0.35]
    eta = np.array([0.01 * np.cos(4.18879 * t), 0.01 * np.cos(4.18879 * t - 1)])
    stamps = np.datetime64("2024-03-01T12:00:00") + (t * 1e9).round().astype("timedelta64[ns]")
    data = xarray.Dataset(
        {"eta": (("gauge", "time"), 1e3 * eta, {"units": "mm"})},
        {"time": stamps, "gauge": ["a", "b"], "gauge_x": ("gauge", x)},
    )
    given = {"depth": 0.25, "period": 1.5, "window": (0, 40)}
    assert (
        pytest.approx(analysis.reflection((t, x, eta), **given).H_I, rel=1e-6) == analysis.reflection(data, **given).H_I
    )
    data.eta.attrs["units"] = "V"
    with pytest.raises(AnalysisError, match="eta in 'V'"):
        analysis.reflection(data, **given)
