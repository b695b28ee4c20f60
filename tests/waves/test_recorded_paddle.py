"""A recorded motion: the wall is where the file says, its acceleration has no jumps, and its wave is that of theory."""

import numpy as np
import pytest
from pydantic import ValidationError

from houle.case.tables.waves import Waves
from houle.case.wave import make, read_motion
from houle.waves.dispersion import wave_number
from houle.waves.paddle import RecordedMotion, elevation
from houle.waves.piston import biesel
from houle.waves.wave import WaveError

DEPTH, GRAVITY = 0.32, 9.81
UNEVEN = np.cumsum(np.random.default_rng(5).uniform(0.02, 0.07, 160))


def bump(t):
    """From 0 to 0.2 m around 4 s, as a paddle goes for a solitary wave."""
    return 0.1 * (1 + np.tanh(2.0 * (t - 4.0)))


def speed(t):
    return 0.2 / np.cosh(2.0 * (t - 4.0)) ** 2


def table(file, **keys):
    return Waves(kind="paddle", file=str(file), depth=DEPTH, piston={"x": 0.5}, **keys)


def recorded(time, values, quantity="displacement", rests=True, duration=0.0):
    return RecordedMotion.of(np.asarray(time), np.asarray(values), quantity, rests, duration)


def csv(folder, text, name="paddle.csv"):
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def rows(time, values, mark=","):
    return "\n".join(f"{t:.12g}{mark}{v:.15g}" for t, v in zip(time, values, strict=True)) + "\n"


# ---- the curve -------------------------------------------------------------------------------------------------------


def test_the_wall_is_where_the_file_says_at_every_sample_however_uneven():
    motion = recorded(UNEVEN, bump(UNEVEN) - 0.15)
    np.testing.assert_allclose(motion.displacement(UNEVEN), bump(UNEVEN) - bump(UNEVEN[0]), atol=1e-15)
    assert motion.zero == pytest.approx(bump(UNEVEN[0]) - 0.15, abs=1e-15)


def test_acceleration_has_no_jump_at_a_sample():
    rough = bump(UNEVEN) + 1e-4 * np.random.default_rng(1).standard_normal(len(UNEVEN))
    for motion in (recorded(UNEVEN, rough), recorded(UNEVEN, rough, "velocity")):
        inside = UNEVEN[1:-1]
        before, after = motion.curve(inside - 1e-9, 2), motion.curve(inside + 1e-9, 2)
        assert np.abs(after - before).max() < 1e-5 * np.abs(after).max()


@pytest.mark.parametrize("quantity", ["displacement", "velocity"])
def test_between_samples_the_error_is_of_fourth_order(quantity):
    fine, errors = np.linspace(1.0, 7.0, 6001), []
    for step in (0.2, 0.1, 0.05):
        t = np.arange(0.0, 8.01, step)
        motion = recorded(t, bump(t) if quantity == "displacement" else speed(t), quantity)
        errors.append(np.abs(motion.displacement(fine) - bump(fine)).max())
    assert errors[0] / errors[1] > 12 and errors[1] / errors[2] > 12
    assert errors[1] < 5e-5  # m, of a stroke of 0.2 m


def test_the_least_acceleration_of_all_curves_through_the_samples():
    """Holladay's theorem: what else goes through the samples has a larger mean square acceleration."""
    t, fine = np.arange(0.0, 8.01, 0.25), np.linspace(0.0, 8.0, 8001)
    mean_square = np.mean(recorded(t, bump(t)).curve(fine, 2) ** 2)
    with_ripple = recorded(t, bump(t)).curve(fine, 2) + 1e-3 * (2 * np.pi / 0.25) ** 2 * np.sin(2 * np.pi * fine / 0.25)
    assert mean_square < np.mean(with_ripple**2)
    assert mean_square < 1.001 * np.mean(np.gradient(np.gradient(bump(fine), fine), fine) ** 2)


def test_it_rests_before_the_first_sample_and_after_the_last():
    motion = recorded(UNEVEN + 2.0, bump(UNEVEN))
    outside = np.array([0.0, 1.0, UNEVEN[0] + 1.99, UNEVEN[-1] + 2.01, 50.0])
    np.testing.assert_allclose(motion.velocity(outside), 0.0, atol=0)
    np.testing.assert_allclose(motion.displacement(outside), [0, 0, 0, *[bump(UNEVEN)[-1] - bump(UNEVEN)[0]] * 2])


def test_a_run_that_starts_within_the_file_starts_where_the_wall_is_then():
    motion = recorded(np.arange(-4.0, 6.0, 0.05), bump(np.arange(-4.0, 6.0, 0.05) + 4.0) - 0.3)
    assert motion.displacement(0.0) == 0.0 and motion.zero == pytest.approx(-0.2)
    assert motion.displacement(1.0) == pytest.approx(bump(5.0) - bump(4.0), abs=1e-15)


def test_a_ramp_grows_from_nothing_and_what_still_moves_stops_as_softly():
    t = np.arange(0.0, 6.001, 0.05)
    sine = 0.05 * np.sin(2 * np.pi * t / 1.6)
    motion = recorded(t, sine, rests=False, duration=1.0)
    assert motion.displacement(0.0) == 0.0 and motion.velocity(0.0) == 0.0
    np.testing.assert_allclose(motion.displacement(t[20:]), sine[20:], atol=1e-15)
    fine = np.linspace(0.0, 8.0, 80001)
    way, velocity = motion.displacement(fine), motion.velocity(fine)
    np.testing.assert_allclose(np.gradient(way, fine)[1:-1], velocity[1:-1], atol=2e-5)
    assert np.abs(np.diff(velocity)).max() < 2e-4  # no jump, of 0.2 m/s
    assert np.abs(velocity[fine > 7.0]).max() == 0.0
    assert way[-1] - sine[-1] == pytest.approx(motion.leaves / 2, rel=1e-9)  # half the ramp at the last speed
    at_once = recorded(t, sine, rests=False)
    np.testing.assert_allclose(at_once.displacement(fine[fine > 6.0]), sine[-1], atol=1e-15)


def test_steps_of_any_length_end_where_the_file_says():
    """A run adds up its steps: after 5000 of them it has lost nothing to rounding."""
    motion, x, t = recorded(UNEVEN, bump(UNEVEN)), 0.4, 0.0
    for dt in np.random.default_rng(3).uniform(1e-4, 3e-3, 5000):
        x += motion.way(t, float(dt), x - 0.4)
        t += float(dt)
    assert x - 0.4 == pytest.approx(float(motion.displacement(t)), abs=2e-16)


# ---- what it sends out -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("period", [0.8, 1.6, 4.0])
def test_a_sine_makes_the_wave_of_linear_theory(tmp_path, period):
    t = np.arange(0.0, 30 * period, period / 25)
    motion = recorded(t, 0.01 * np.sin(2 * np.pi * t / period))
    k = float(wave_number(2 * np.pi / period, DEPTH, GRAVITY))
    time, eta = elevation(motion, DEPTH, GRAVITY)
    middle = (time > 10 * period) & (time < 20 * period)
    assert np.ptp(eta[middle]) == pytest.approx(0.02 * float(biesel(k * DEPTH)), rel=5e-3)
    wave = make(table(csv(tmp_path, "t_s,displacement_m\n" + rows(t, motion.recorded(t)))))
    assert np.std(wave.elevation(0.5, time) - eta) < 1.5e-3 * np.std(eta)  # what a series leaves out
    assert wave.period == pytest.approx(period, rel=0.02) and wave.name == "paddle"


def test_a_push_moves_its_own_volume():
    time, eta = elevation(recorded(UNEVEN, bump(UNEVEN)), DEPTH, GRAVITY)
    assert np.trapezoid(eta, time) * np.sqrt(GRAVITY * DEPTH) == pytest.approx(0.2 * DEPTH, rel=1e-3)


# ---- files -----------------------------------------------------------------------------------------------------------

SAMPLES = np.arange(0.0, 8.01, 0.25)
LAST = rows(SAMPLES, bump(SAMPLES)).splitlines()[-1]
FORMS = {
    "m": "t_s,displacement_m\n" + rows(SAMPLES, bump(SAMPLES)),
    "cm": "t_s,displacement_cm\n" + rows(SAMPLES, 100 * bump(SAMPLES)),
    "brackets": "Time [ms],Displacement [mm]\n" + rows(1e3 * SAMPLES, 1e3 * bump(SAMPLES)),
    "a line of units": "time\tdisplacement\ns\tcm\n" + rows(SAMPLES, 100 * bump(SAMPLES), "\t"),
    "decimal commas": "t_s;displacement_m\n" + rows(SAMPLES, bump(SAMPLES), ";").replace(".", ","),
    "other columns": "t_s,force_n,displacement_m\n" + rows(SAMPLES, bump(SAMPLES), ",7,"),
    "gaps and twice": "t_s,displacement_m\n-1,nan\n" + rows(SAMPLES, bump(SAMPLES)) + LAST + "\n8.1,\n",
}


@pytest.mark.parametrize("form", FORMS)
def test_files_are_read_as_laboratories_write_them(tmp_path, form):
    quantity, known = read_motion(table(csv(tmp_path, FORMS[form])))
    assert quantity == "displacement"
    np.testing.assert_allclose(known.time, SAMPLES, atol=1e-9)
    np.testing.assert_allclose(known.values[0], bump(SAMPLES), atol=1e-12)


@pytest.mark.parametrize(
    ("head", "factor"),
    [
        ("t_s,velocity_m_s", 1.0),
        ("t_s,velocity_cm_s", 100.0),
        ("t_s,Velocity [cm/s]", 100.0),
        ("t_s,velocity / mm/s", 1000.0),
        ("t_s,velocity\ns,m/s", 1.0),
    ],
)
def test_velocities_are_read_with_their_units(tmp_path, head, factor):
    quantity, known = read_motion(table(csv(tmp_path, head + "\n" + rows(SAMPLES, factor * speed(SAMPLES)))))
    assert quantity == "velocity"
    np.testing.assert_allclose(known.values[0], speed(SAMPLES), atol=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t_s,displacement_m\n0,0\n1,0.1\n", r"waves\.file = .*paddle.csv needs at least 4 rows .* it has 2"),
        ("t_s,displacement_m\n0,0\n2,0.1\n1,0.1\n3,0.1\n", r"needs rising times: 1 s follows 2 s \(row 3\)"),
        ("t_s,displacement_m\n0,0\n1,0\n1,0.1\n2,0\n", r"1 s stands twice with other values"),
        ("t_s,x_m\n0,0\n1,0\n2,0\n3,0\n", r"needs a column t_s and one of displacement_m or velocity_m_s; neither"),
        ("t_s,displacement_m,velocity_m_s\n0,0,0\n1,0,0\n", r"both are there: keep one of them"),
        ("t_s,displacement_v\n0,0\n1,0\n2,0\n3,0\n", r"neither is there"),
        ("t_s,displacement_m\n0,0.3\n1,0.3\n2,0.3\n3,0.3\n", r"the paddle does not move after the start of the run"),
        ("t_s,displacement_m\n0,0\n1,15\n2,30\n3,30\n", r"moves at up to .* the fastest that water follows: are its"),
        ("t_s,displacement_m\n0,a\n1,15\n2,30\n3,30\n", r"line 2"),
    ],
)
def test_a_file_that_is_no_motion_is_refused(tmp_path, text, words):
    with pytest.raises(WaveError, match=words):
        make(table(csv(tmp_path, text)))


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(WaveError, match=r"waves\.file = .*gone\.csv"):
        make(table(tmp_path / "gone.csv"))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"piston": {"x": 0.5, "absorb": True}}, r"piston\.absorb = true .* does not tell: remove it, and let"),
        ({"piston": None, "zone": {"x": (0.0, 2.0)}}, r'zone does not make kind = "paddle"'),
        ({"height": 0.1}, r'height does not belong to kind = "paddle": remove it, they are in the file'),
        ({"direction": 10.0}, r"direction = 10: a paddle sends waves along x only"),
        ({"file": None}, r"file is missing"),
    ],
)
def test_what_does_not_go_with_a_paddle_is_refused_with_its_cure(keys, words):
    with pytest.raises(ValidationError, match=words):
        Waves(**{"kind": "paddle", "file": "a.csv", "depth": DEPTH, "piston": {"x": 0.5}, **keys})
