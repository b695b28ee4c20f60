"""A recorded series comes out as it went in, moves by linear dispersion, and is still water outside the event."""

import numpy as np
import pytest

from houle.case.tables.waves import Waves
from houle.case.wave import read_record
from houle.waves.record import series
from houle.waves.wave import WaveError

DEPTH, GRAVITY = 4.0, 9.81
T = np.arange(0.0, 180.0, 0.25)


def read(file, start=0.0):
    """What the case file makes of a record."""
    return read_record(Waves(kind="series", file=str(file), start=start, depth=1.0, zone={"x": (0.0, 1.0)}))


def ship(t):
    """A drawdown of 0.35 m over a minute, secondary waves of 0.1 m and 2.4 s behind it."""
    secondary = 0.05 * np.sin(2 * np.pi * t / 2.4) * np.exp(-(((t - 120) / 15) ** 2))
    return -0.35 * np.exp(-(((t - 70) / 16) ** 2)) + secondary


def test_the_components_give_the_record_back_at_its_place():
    eta = ship(T)
    exact = series(T, eta, DEPTH, GRAVITY, tolerance=0.0)
    np.testing.assert_allclose(exact.elevation(0.0, T), eta, atol=1e-12)
    short = series(T, eta, DEPTH, GRAVITY)
    error = np.std(short.elevation(0.0, T) - eta)
    assert error < 1.2e-3 * eta.std()  # the tolerance, which is a mean over the record and its ends
    assert len(short.components().k) < len(exact.components().k) / 3
    assert short.height == pytest.approx(np.ptp(eta))


def test_round_trip_elsewhere_odd_and_not_at_rest():
    """An odd number of samples, starting and ending off zero, at x = 30, from t = 500."""
    t = 500 + T[:481]
    eta = 0.2 * np.sin(0.4 * t) + 0.1
    wave = series(t, eta, DEPTH, GRAVITY, place=30.0, tolerance=0.0)
    np.testing.assert_allclose(wave.elevation(30.0, t), eta, atol=1e-12)
    assert np.abs(wave.elevation(0.0, t) - eta).max() > 0.05


def test_ends_are_led_back_by_half_cosines():
    """A step of 0.2 m held for 120 s: half of it 9 s before and after, nothing 18 s away, never beyond it."""
    t = np.arange(0, 120.01, 0.5)
    wave = series(t, np.where(t < 1e9, 0.2, 0.0) + 1e-6 * np.sin(t), DEPTH, GRAVITY, tolerance=0.0)
    around = np.array([-18.0, -9.0, 0.0, 120.0, 129.0, 138.0])
    np.testing.assert_allclose(wave.elevation(0.0, around), [0, 0.1, 0.2, 0.2, 0.1, 0], atol=5e-3)
    before = wave.elevation(0.0, np.linspace(-18, 0, 37))
    assert np.all(np.diff(before) > -1e-6)


def test_uneven_times_are_interpolated():
    t = np.sort(np.concatenate([T, T[:-1:3] + 0.1]))
    wave = series(t, ship(t), DEPTH, GRAVITY, tolerance=0.0)
    np.testing.assert_allclose(wave.elevation(0.0, T), ship(T), atol=2e-3)


def test_long_waves_move_the_whole_depth_and_rest_outside():
    """u = sqrt(g/d) eta at every z under the drawdown (1 % from its curvature), and no current before it."""
    wave = series(T, ship(T), DEPTH, GRAVITY)
    u, w = wave.velocity(0.0, np.array([0.0, 2.0, 3.5]), 70.0)
    np.testing.assert_allclose(u, -0.35 * np.sqrt(GRAVITY / DEPTH), rtol=0.01)
    assert np.abs(w).max() < 0.01 * np.abs(u).max()
    before = wave.velocity(0.0, np.array([0.0, 3.5]), 2.0)[0]
    assert np.abs(before).max() < 3e-3 * np.abs(u).max()


def test_the_drawdown_travels_with_the_long_wave_speed():
    wave = series(T, ship(T) * (T < 110), DEPTH, GRAVITY)
    t = np.arange(50.0, 110.0, 0.05)
    later = t[np.argmin(wave.elevation(60.0, t))] - t[np.argmin(wave.elevation(0.0, t))]
    assert later == pytest.approx(60.0 / np.sqrt(GRAVITY * DEPTH), rel=0.02)


def test_a_sine_is_one_wave():
    """Thirty periods of a sine between its two leads: the peak is at its period."""
    period = 3.0
    t = np.arange(0, 90.0, 0.1)
    wave = series(t, 0.05 * np.cos(2 * np.pi * t / period), DEPTH, GRAVITY)
    assert wave.period == pytest.approx(period, rel=0.02)


def test_a_record_is_read_by_the_names_of_its_columns(tmp_path):
    file = tmp_path / "ship.csv"
    file.write_text("# measured\nt_s, eta_m, other\n0, 0, 1\n0.5, 0.1, 2\n1.0, 0, 2\n1.5, -0.1, 3\n")
    known = read(file)
    assert known.time.tolist() == [0, 0.5, 1.0, 1.5] and known.values[0].tolist() == [0, 0.1, 0, -0.1]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (None, "cannot be read"),
        ("", "header t_s,eta_m"),
        ("time,eta_m\n0,1\n", "header t_s,eta_m"),
        ("t_s,eta_m\n0,x\n", "header t_s,eta_m"),
        ("t_s,eta_m\n0,1\n1\n", "header t_s,eta_m"),
        ("t_s,eta_m\n0,0\n1,0.1\n", "at least 4 rows"),
        ("t_s,eta_m\n0,0\n1,0.1\n0.5,0\n2,0\n", "rising times"),
        ("t_s,eta_m\n0,0\n1,nan\n2,0\n3,0\n", "finite"),
    ],
)
def test_a_file_that_is_no_record_is_refused_with_what_it_should_be(tmp_path, text, said):
    file = tmp_path / "a.csv"
    if text is not None:
        file.write_text(text)
    with pytest.raises(WaveError, match=said) as error:
        read(file)
    assert str(file) in str(error.value)


def test_records_that_are_no_waves():
    with pytest.raises(WaveError, match="metres"):
        series(T, 100 * ship(T), DEPTH, GRAVITY)
    with pytest.raises(WaveError, match="has to move"):
        series(T, 0 * T + 0.1, DEPTH, GRAVITY)


def test_the_clock_of_the_file_is_shifted(tmp_path):
    file = tmp_path / "ship.csv"
    file.write_text("t_s,eta_m\n265,0\n265.5,0.1\n266.0,0\n266.5,-0.1\n")
    assert read(file, 265.5).time.tolist() == [-0.5, 0, 0.5, 1.0]


@pytest.mark.parametrize(
    ("rows", "kept"),
    [
        ("0,0\n1,0.1\n2,nan\n3,0\n4,0.1\n", [0, 1, 3, 4]),
        ("nan,0\n0,0\n1,0.1\n3,0\n4,inf\n5,0\n", [0, 1, 3, 5]),
        ("0,0\n1,0.1\n1,0.1\n3,0\n4,0.1\n", [0, 1, 3, 4]),
        ("0,0\n1,0.1\n1.3,0\n4,0.1\n", [0, 1, 1.3, 4]),
    ],
)
def test_rows_without_a_number_and_rows_that_stand_twice_are_left_out(tmp_path, rows, kept):
    (tmp_path / "a.csv").write_text("t_s,eta_m\n" + rows)
    assert read(tmp_path / "a.csv").time.tolist() == kept


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("3,0\n2,0.1\n1,0\n0,0.1\n", r"2 s follows 3 s \(row 2\)"),
        ("0,0\n1,0.1\nnan,5\n0.5,0\n2,0\n", r"0.5 s follows 1 s \(row 4\)"),
        ("0,0\n1,0.1\n1,0.2\n2,0\n", r"1 s stands twice with other values \(row 3\)"),
    ],
)
def test_times_that_do_not_rise_are_refused_with_their_row(tmp_path, rows, said):
    (tmp_path / "a.csv").write_text("t_s,eta_m\n" + rows)
    with pytest.raises(WaveError, match=said):
        read(tmp_path / "a.csv")


def test_one_tiny_step_does_not_make_millions_of_samples():
    t = np.sort(np.append(T, 50.0 + 1e-7))
    assert len(series(t, ship(t), DEPTH, GRAVITY, tolerance=0.0).components().k) < 3 * len(T)
