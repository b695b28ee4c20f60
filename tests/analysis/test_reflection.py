"""Separation of waves whose every amplitude is known, and what is said when the gauges cannot tell."""

import numpy as np
import pytest
import xarray

from analysis import flumes
from analysis.flumes import DEPTH
from houle import analysis
from houle.analysis import energies, separation
from houle.analysis.errors import AnalysisError
from houle.waves.dispersion import wave_number

PERIOD = 1.37
GAUGES = np.array([0.0, 0.31, 0.55, 0.9])
TIME = np.arange(0.0, 20.0, 0.013)
Z_I, Z_R = 0.02 * np.exp(0.3j), 0.005 * np.exp(-1.1j)
EXACT = 1e-8


def signal(x=GAUGES, time=TIME, parts=((1, "bound", Z_I, Z_R),)):
    return flumes.regular(x, time, PERIOD, parts)


def amplitudes(x):
    k = float(wave_number(2 * np.pi / PERIOD, DEPTH))
    return Z_I * np.exp(1j * k * x) + Z_R * np.exp(-1j * k * x), k


@pytest.mark.parametrize("name", ["goda-suzuki", "mansard-funke", "zelt-skjelbreia"])
def test_each_method_returns_the_two_waves(name):
    x = GAUGES[: {"goda-suzuki": 2, "mansard-funke": 3, "zelt-skjelbreia": 4}[name]]
    F, k = amplitudes(x)
    incident, reflected = getattr(separation, name.replace("-", "_"))(F, x, k)
    assert abs(incident - Z_I) < 1e-13
    assert abs(reflected - Z_R) < 1e-13


def test_two_gauges_give_the_printed_formula():
    """Goda & Suzuki's own form with A, B the cosine and sine parts."""
    x = GAUGES[:2] + 7.0
    F, k = amplitudes(x)
    (A1, A2), (B1, B2), kd = F.real, F.imag, k * (x[1] - x[0])
    s, c = np.sin(kd), np.cos(kd)
    a_I = np.hypot(A2 - A1 * c - B1 * s, B2 + A1 * s - B1 * c) / (2 * abs(s))
    a_R = np.hypot(A2 - A1 * c + B1 * s, B2 - A1 * s - B1 * c) / (2 * abs(s))
    incident, reflected = separation.goda_suzuki(F, x, k)
    assert abs(incident) == pytest.approx(a_I, rel=1e-12)
    assert abs(reflected) == pytest.approx(a_R, rel=1e-12)


@pytest.mark.parametrize(("gauges", "method"), [
    ([0, 1], "goda-suzuki"), ([0, 1, 2], "mansard-funke"), (None, "zelt-skjelbreia")
])  # fmt: skip
def test_regular_waves_to_rounding(gauges, method):
    eta = signal(parts=[(1, "bound", Z_I, Z_R), (2, "bound", 0.003, 0.001j), (3, "free", 0.0005, 0.0002)])
    found = analysis.reflection((TIME, GAUGES, eta + 0.3), depth=DEPTH, period=PERIOD, gauges=gauges, method=method,
                                window=(3, 17))  # fmt: skip
    assert pytest.approx(0.25, abs=EXACT) == found.C_R
    assert pytest.approx(0.04, abs=EXACT) == found.H_I
    assert pytest.approx(0.01, abs=EXACT) == found.H_R
    assert found.window.periods == 10
    assert np.isnan(found.C_T) and np.isnan(found.C_D)


def test_a_level_that_drifts_is_not_a_wave():
    eta = signal() + 1e-3 * TIME + np.array([[0.1], [0.2], [0.0], [-0.1]])
    found = analysis.reflection((TIME, GAUGES, eta), depth=DEPTH, period=PERIOD, window=(3, 17))
    assert pytest.approx(0.25, abs=EXACT) == found.C_R


def test_the_period_is_found():
    eta = signal(parts=[(1, "bound", Z_I, Z_R), (2, "bound", 0.003, 0.001j)])
    found = analysis.reflection((TIME, GAUGES, eta), depth=DEPTH, window=(2, 18))
    assert found.period == pytest.approx(PERIOD, abs=1e-10)
    assert pytest.approx(0.25, abs=EXACT) == found.C_R


def test_waves_that_come_from_the_right():
    eta = signal(-GAUGES)
    given = {"depth": DEPTH, "period": PERIOD, "window": (2.0, 18.0)}
    found = analysis.reflection((TIME, GAUGES, eta), towards=-1, **given)
    assert pytest.approx(0.25, abs=EXACT) == found.C_R
    told = analysis.reflection((TIME, GAUGES, eta), maker=9.0, structure=-2.0, **given)
    assert told.C_R == found.C_R
    wrong = analysis.reflection((TIME, GAUGES, eta), **given)
    assert pytest.approx(4.0, abs=1e-6) == wrong.C_R


def test_harmonics_bound_and_free_both_ways():
    x = np.array([0.0, 0.3, 0.7, 1.2, 1.8])
    parts = [
        (1, "bound", Z_I, Z_R),
        (2, "bound", 0.003, 0.001j),
        (2, "free", 0.001, -0.0005),
        (3, "bound", 0.0004, 1e-4),
    ]
    F = analysis.harmonics(TIME, signal(x, parts=parts), 2 * np.pi / PERIOD, 3)
    first, second, third = analysis.separate_xt(x, F, 2 * np.pi / PERIOD, DEPTH)
    assert abs(first.incident - Z_I) + abs(first.reflected - Z_R) < EXACT
    assert abs(second.incident - 0.003) + abs(second.reflected - 0.001j) < EXACT
    assert abs(second.free_incident - 0.001) + abs(second.free_reflected + 0.0005) < EXACT
    assert abs(third.incident - 0.0004) + abs(third.free_incident) < EXACT
    assert second.resolved and second.residual < EXACT


def test_gauges_that_cannot_tell_free_from_bound_are_named():
    """0, 0.31, 0.55, 0.90 m: one combination of the four second harmonics is seen 370 times less than another."""
    eta = signal(parts=[(1, "bound", Z_I, Z_R), (2, "bound", 0.003, 0.001j)])
    found = analysis.reflection((TIME, GAUGES, eta), depth=DEPTH, period=PERIOD, window=(2, 18))
    assert not found.harmonics[1].resolved
    assert any(note.startswith("harmonics 2:") for note in found.notes)
    F = np.array([abs(p.incident) + abs(p.free_incident) for p in found.harmonics])
    assert F[1] < 0.02, "the least amplitudes, not hundreds of times the signal"


def test_two_gauges_behind_take_off_what_the_far_end_sends_back():
    x = np.append(GAUGES, [6.0, 6.4])
    behind = flumes.regular(x[4:], TIME, PERIOD, [(1, "bound", 0.6 * Z_I, 0.01 * Z_I)])
    eta = np.vstack([signal(), behind])
    given = {"depth": DEPTH, "period": PERIOD, "window": (2, 18)}
    found = analysis.reflection((TIME, x, eta), behind=[4, 5], **given)
    assert pytest.approx(0.6, abs=EXACT) == found.C_T
    assert pytest.approx(1 - 0.25**2 - 0.36, abs=EXACT) == found.C_D
    assert pytest.approx(0.024, abs=EXACT) == found.H_T
    alone = analysis.reflection((TIME, x, eta), behind=[4], gauges=[0, 1, 2, 3], **given)
    assert pytest.approx(abs(0.6 + 0.01 * np.exp(-2j * found.wave_number * 6.0)), abs=EXACT) == alone.C_T


def test_no_bias_with_noise_and_an_interval_that_holds():
    """Noise of 5 % of the height on each gauge; 120 records of ten periods; C_R = 0.25 and a C_R of 0.02.

    1600 samples of noise s leave an error of s sqrt(2 / 1600) in each amplitude at best: 0.0035 of the incident one.
    """
    time = np.arange(0.0, 10 * PERIOD, PERIOD / 40)
    for small in (Z_R, 0.0004):
        eta, truth = signal(time=time, parts=[(1, "bound", Z_I, small)]), abs(small) / 0.02
        values, inside = [], 0
        for seed in range(120):
            noise = 0.05 * 0.04 * np.random.default_rng(seed).standard_normal(eta.shape)
            found = analysis.reflection((time, GAUGES, eta + noise), depth=DEPTH, period=PERIOD, window=(0, 99))
            values.append(found.C_R)
            inside += found.interval_R[0] <= truth <= found.interval_R[1]
        error = np.std(values) / np.sqrt(len(values))
        assert abs(np.mean(values) - truth) < 3 * error + 1e-3 * (truth < 0.1), "biased"
        assert np.std(values) < 1.3 * 0.0035
        assert inside >= 0.93 * 120


def test_the_energy_of_noise_is_taken_off_a_small_regular_wave():
    """Five periods of a wave of 0.05, each off by 0.03: without the correction |mean|^2 is 7 % too large."""
    x, k, rng = GAUGES[:2], amplitudes(GAUGES)[1], np.random.default_rng(5)
    pieces = energies.regular(np.ones((5, 2), complex), x, k, "goda-suzuki")
    off = 0.03 * (rng.standard_normal((20000, 5, 1)) + 1j * rng.standard_normal((20000, 5, 1))) / np.sqrt(2)
    energy = pieces.energy(0.05 + off)
    assert energy.mean() == pytest.approx(0.05**2, rel=0.01)
    assert np.mean(np.abs((0.05 + off).mean(axis=1)) ** 2) > 1.06 * 0.05**2


def test_the_energy_of_noise_is_taken_off_a_small_irregular_wave():
    """Noise of 30 % and C_R = 0.1: C_R^2 is 0.01; the noise alone would add half of that."""
    time, found = np.arange(0.0, 300.0, 0.05), []
    for seed in range(6):
        eta = flumes.irregular(GAUGES, time, 1.5, 0.1, np.random.default_rng(seed), on_lines=True)
        eta = eta + 0.3 * eta.std() * np.random.default_rng(50 + seed).standard_normal(eta.shape)
        records = analysis.gauges(time, GAUGES, eta)
        sea = energies.lines(records, DEPTH, (0.54 / 1.5, 1.9 / 1.5), "zelt-skjelbreia", 9.81, 0.0)
        found.append(sea.reflected.sum() / sea.incident.sum())
    assert np.mean(found) == pytest.approx(0.01, abs=0.0015)


def test_the_interval_grows_when_the_wave_number_is_wrong():
    eta = signal()
    given = {"depth": DEPTH, "period": PERIOD, "window": (2, 18)}
    right = analysis.reflection((TIME, GAUGES, eta), **given)
    wrong = analysis.reflection((TIME, GAUGES, eta), wave_number=1.05 * right.wave_number, **given)
    assert right.interval_R[1] - right.interval_R[0] < 1e-8
    assert wrong.interval_R[0] < 0.25 < wrong.interval_R[1]
    assert wrong.residual > 1e-3


def test_the_wave_number_of_a_high_wave_is_fitted():
    omega, true = 2 * np.pi / PERIOD, 0.96 * float(wave_number(2 * np.pi / PERIOD, DEPTH))
    F = Z_I * np.exp(1j * true * GAUGES) + Z_R * np.exp(-1j * true * GAUGES)
    eta = (F[:, None] * np.exp(-1j * omega * TIME)).real
    found = analysis.reflection((TIME, GAUGES, eta), depth=DEPTH, period=PERIOD, window=(2, 18), wave_number="fit")
    assert found.wave_number == pytest.approx(true, rel=1e-6)
    assert pytest.approx(0.25, abs=1e-6) == found.C_R


def test_singular_spacings_are_refused_with_the_cure():
    _, k = amplitudes(GAUGES)
    half = np.pi / k
    x = np.array([0.0, half, 2 * half])
    with pytest.raises(AnalysisError, match=r"0\.500, 0\.500 wavelengths apart.*0\.05 to 0\.45 L"):
        analysis.reflection((TIME, x, signal(x)), depth=DEPTH, period=PERIOD, window=(2, 18))
    assert separation.spread(k, x) < 1e-7
    assert separation.spread(k, [0.0, 0.5 * half]) == pytest.approx(1.0)
    good = separation.weights(k, np.append(x, 0.4 * half))
    assert good[3] > 2 * good[0], "three gauges of one phase count less than the one that differs"


def test_errors_say_what_to_do():
    source = (TIME, GAUGES, signal())
    given = {"depth": DEPTH, "period": PERIOD}
    for words, options in (
        ("there is no gauge 'W9'; there are: x=0", {"gauges": ["W9"], "window": (2, 18)}),
        ("goda-suzuki does not go with 4 gauges", {"method": "goda-suzuki", "window": (2, 18)}),
        ("is not one of: goda-suzuki", {"method": "magic", "window": (2, 18)}),
        ("give window=", {}),
        ("holds 1 periods", {"window": (2, 4)}),
        ("no gauge in front", {"window": (2, 18), "structure": -1.0}),
        ("depth = -0.25 must be above 0", {"window": (2, 18), "depth": -0.25}),
        ("ramp: not used", {"window": (2, 18), "ramp": 3}),
        ("the record is too short", {"maker": -3.0, "structure": 3.0, "absorbing": True, "ramp": 9}),
    ):
        with pytest.raises(AnalysisError, match=words):
            analysis.reflection(source, **(given | options))
    dry = signal()
    dry[2, 700] = np.nan
    with pytest.raises(AnalysisError, match=r"gauge x=0\.55 has no level at t = 9\.1 s"):
        analysis.reflection((TIME, GAUGES, dry), **given, window=(2, 18))
    wet = analysis.reflection((TIME, GAUGES, dry), **given, window=(2, 18), gauges=[0, 1, 3])
    assert pytest.approx(0.25, abs=EXACT) == wet.C_R


def test_irregular_waves_on_fourier_lines_to_rounding():
    time = np.arange(0.0, 300.0, 0.05)
    eta = flumes.irregular(GAUGES, time, 1.5, 0.4, np.random.default_rng(2), on_lines=True)
    found = energies.lines(
        analysis.gauges(time, GAUGES, eta), DEPTH, (0.54 / 1.5, 1.9 / 1.5), "zelt-skjelbreia", 9.81, 0.0
    )
    used = found.trust > 0
    assert used.all()
    assert np.sqrt(found.reflected.sum() / found.incident.sum()) == pytest.approx(0.4, abs=EXACT)
    df = found.frequency[1] - found.frequency[0]
    assert 4 * np.sqrt(found.incident.sum() * df) == pytest.approx(0.05, rel=1e-6)


def test_irregular_waves_without_bias():
    """12 seas of 120 peak periods with 5 % noise, C_R = 0.4, C_T = 0.6: mean within 0.003, intervals hold."""
    time, x = np.arange(0.0, 180.0, 0.06), np.append(GAUGES, 7.0)
    values, inside = [], 0
    for seed in range(12):
        front = flumes.irregular(GAUGES, time, 1.5, 0.4, np.random.default_rng(seed))
        behind = flumes.irregular([7.0], time, 1.5, 0.0, np.random.default_rng(seed), transmit=0.6)
        eta = np.vstack([front, behind])
        eta = eta + 0.05 * front.std() * np.random.default_rng(100 + seed).standard_normal(eta.shape)
        found = analysis.reflection(
            (time, x, eta), depth=DEPTH, period=1.5, kind="irregular", behind=[4], window=(0, 180)
        )
        values.append([found.C_R, found.C_T])
        inside += found.interval_R[0] < 0.4 < found.interval_R[1]
        assert pytest.approx(0.05, rel=0.12) == found.H_I
    mean, error = np.mean(values, axis=0), np.std(values, axis=0) / np.sqrt(12)
    assert abs(mean[0] - 0.4) < 0.003
    assert abs(mean[1] - 0.6) < max(0.01, 3 * error[1])
    assert inside >= 10


def test_irregular_lines_that_cannot_be_told_apart_are_left_out():
    time = np.arange(0.0, 300.0, 0.05)
    k = float(wave_number(2 * np.pi / 1.0, DEPTH))
    x = np.array([0.0, np.pi / k])  # half a wavelength of 1 Hz
    eta = flumes.irregular(x, time, 1.5, 0.4, np.random.default_rng(3))
    found = analysis.reflection((time, x, eta), depth=DEPTH, period=1.5, kind="irregular", window=(0, 300))
    assert any("left out" in note for note in found.notes)
    left_out = found.lines.frequency[found.lines.trust == 0]
    assert left_out.min() < 1.0 < left_out.max()
    assert pytest.approx(0.4, abs=0.03) == found.C_R


@pytest.mark.parametrize("confidence", [0.0, 1.0, 2.0, float("nan")])
def test_a_confidence_that_is_no_share_is_refused(confidence):
    with pytest.raises(AnalysisError, match=r"confidence = .*between 0 and 1"):
        analysis.reflection((TIME, GAUGES, signal()), depth=DEPTH, period=PERIOD, confidence=confidence)


def test_every_kind_of_source_gives_the_same_answer(tmp_path):
    """A dataset like series.nc, a run, eta(time, x) like surface.nc, and a laboratory's table in millimetres."""
    eta = signal() + 0.25
    names = ["W1", "W2", "W3", "W4"]
    series = xarray.Dataset(
        {"eta": (("gauge", "time"), eta)}, {"time": TIME, "gauge": names, "gauge_x": ("gauge", GAUGES)}
    )
    surface = xarray.Dataset({"eta": (("time", "x"), eta.T)}, {"time": TIME, "x": GAUGES})
    run = type("Run", (), {"series": series})()
    table = tmp_path / "lab.csv"
    rows = np.column_stack([TIME, 1e3 * eta.T])
    text = "# flume 3\n# x [m]: 0, 0.31, 0.55, 0.9\nt [s];W1 [mm];W2 [mm];W3 [mm];W4 [mm]\n"
    table.write_text(text + "\n".join(";".join(repr(float(v)).replace(".", ",") for v in row) for row in rows))
    given = {"depth": DEPTH, "period": PERIOD, "window": (2, 18)}
    series.to_netcdf(tmp_path / "series.nc", engine="h5netcdf")
    for source in (series, surface, run, table, analysis.read_csv(table), tmp_path, tmp_path / "series.nc"):
        found = analysis.reflection(source, **given)
        assert pytest.approx(0.25, abs=EXACT) == found.C_R
    assert pytest.approx(0.25, abs=EXACT) == analysis.reflection(series, gauges=["W1", "W3"], **given).C_R


def test_files_that_are_not_there(tmp_path):
    for name, words in (("lab.csv", "cannot be read"), ("series.nc", "series.nc"), ("", "series.nc")):
        with pytest.raises(AnalysisError, match=words):
            analysis.reflection(tmp_path / name, depth=DEPTH, period=PERIOD, window=(2, 18))


def test_tables_without_places_or_numbers(tmp_path):
    table = tmp_path / "lab.csv"
    table.write_text("t,a,b\n0,1,2\n1,1,2\n2,1,2\n")
    with pytest.raises(AnalysisError, match="does not say where its gauges stand"):
        analysis.read_csv(table)
    assert analysis.read_csv(table, positions=[0.5, 1.5]).gauge_x.values.tolist() == [0.5, 1.5]
    table.write_text("t,x=0.5,x=1.5\n0,1,2\n1,1,\n2,1,2\n")
    assert np.isnan(analysis.read_csv(table).eta.values[1, 1])
    table.write_text("t,a (furlong)\n0,1\n1,1\n2,1\n")
    with pytest.raises(AnalysisError, match="furlong"):
        analysis.read_csv(table)


def test_the_answer_in_words_and_in_a_picture(tmp_path):
    found = analysis.reflection((TIME, GAUGES, signal()), depth=DEPTH, period=PERIOD, window=(2, 18))
    words = str(found)
    assert "C_R  0.250   (0.250 to 0.250)" in words
    assert "interval (95 %): change between 11 periods" in words
    assert found.plot(tmp_path / "r.png").stat().st_size > 10_000
    time = np.arange(0.0, 120.0, 0.05)
    eta = flumes.irregular(GAUGES, time, 1.5, 0.4, np.random.default_rng(0))
    sea = analysis.reflection((time, GAUGES, eta), depth=DEPTH, kind="irregular", window=(0, 120))
    assert sea.plot(tmp_path / "i.png").stat().st_size > 10_000


def test_the_formula_of_the_paper():
    """Table 1 of the paper, to its rounding; and the warning of what it is."""
    for highest, lowest, printed in (
        (0.283, 0.215, 0.138),
        (0.328, 0.251, 0.134),
        (0.237, 0.193, 0.102),
        (0.320, 0.270, 0.085),
    ):
        found = analysis.jh2020(highest, lowest)
        assert pytest.approx(printed, abs=1.6e-3) == found.C_R
        assert "not a reflection coefficient" in str(found)
    assert pytest.approx(1 - 0.2 - 0.2) == analysis.jh2020(0.3, 0.2, 0.1).C_D
    with pytest.raises(AnalysisError, match="0 < lowest"):
        analysis.jh2020(0.03, -0.03)


def test_the_formula_of_the_paper_changes_with_the_datum():
    eta = signal() + DEPTH
    given = {"depth": DEPTH, "period": PERIOD, "window": (2, 18)}
    printed = analysis.reflection((TIME, GAUGES, eta), method="jh2020", **given)
    level = eta[:, (TIME >= 2) & (TIME < 2 + 11 * PERIOD)]
    assert pytest.approx(np.ptp(level) / (level.max() + level.min())) == printed.C_R
    assert np.isnan(printed.interval_R[0]) and "not a reflection coefficient" in printed.notes[0]
    lower = analysis.reflection((TIME, GAUGES, eta), method="jh2020", bed=-1.0, **given)
    assert lower.C_R < 0.3 * printed.C_R
