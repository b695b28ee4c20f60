"""Files against time of [waves] and [[open]]: on the clock of the run, all the way through it, without holes."""

import numpy as np
import pytest

from houle.case.model import load
from houle.case.tables.boundaries import records
from houle.check import rules
from houle.errors import CaseError
from houle.waves.piston import law_of, reading_of

T = np.arange(0.0, 20.001, 0.05)
WAVES = 0.01 * np.sin(2 * np.pi * T / 1.5)  # cut at its ends as a record is
EVENT = WAVES * np.exp(-(((T - 10) / 3) ** 2))  # at rest at both ends
MAKERS = {
    "zone": {"zone": {"x": [0.0, 3.5]}},
    "source": {"source": {"x": 4.0, "side": "right"}},
    "piston": {"piston": {"x": 1.0}},
}


def write(folder, time, *values, columns="eta_m"):
    rows = np.column_stack([time, *values])
    text = "\n".join(",".join(f"{value:.6f}" for value in row) for row in rows)
    (folder / "a.csv").write_text(f"t_s,{columns}\n{text}\n")


def flume(folder, maker="zone", end=20.0, **waves):
    tables = {
        "case": {"name": "a"},
        "domain": {"size": [12.0, 0.5], "spacing": 0.02},
        "water": [{"below": 0.3}],
        "waves": {"kind": "series", "depth": 0.3, "file": "a.csv", **MAKERS[maker], **waves},
        "time": {"end": end},
    }
    (folder / "a.toml").write_text(load(tables).to_toml())
    return load(folder / "a.toml")


def river(folder, end=20.0, **side):
    tables = {
        "case": {"name": "a"},
        "domain": {"size": [4.0, 0.5], "spacing": 0.02},
        "water": [{"below": 0.3}],
        "open": [{"side": "left", "file": "a.csv", **side}],
        "time": {"end": end},
    }
    (folder / "a.toml").write_text(load(tables).to_toml())
    return load(folder / "a.toml")


def told(case, level=None):
    """Findings about the file."""
    return [f.text for f in rules.check(case) if f.key.endswith(".file") and level in (None, f.level)]


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("cut", [slice(None), slice(3, 397), slice(0, 200)])
def test_any_record_can_be_made_by_any_maker(tmp_path, maker, cut):
    """However a record is cut: what leads it to still water leaves a mean, of a thousandth of the height and more."""
    write(tmp_path, T[cut] - T[cut][0], WAVES[cut])
    case = flume(tmp_path, maker, end=float(T[cut][-1] - T[cut][0]))
    rules.require(case)
    assert case.wave.components().mean != 0.0
    said = told(case)
    assert all("leaves out its mean" in text for text in said) and bool(said) == (maker == "source")


def test_a_mean_that_a_source_would_leave_out_is_refused(tmp_path):
    write(tmp_path, T, WAVES + 0.02)
    with pytest.raises(CaseError, match=r"mean of the record, nor waves that are not 0.18 to 9.6 m long"):
        rules.require(flume(tmp_path, "source", source={"x": 4.0, "side": "right", "width": 0.6}))
    rules.require(flume(tmp_path, "zone"))
    with pytest.raises(CaseError, match=r"waves.piston.x = 11 m: it goes 2.7.* m to the right"):  # with the water
        rules.require(flume(tmp_path, "piston", piston={"x": 11.0}))


def test_a_piston_goes_with_a_drawdown_and_rests_before_and_after_it(tmp_path):
    """dX/dt = sqrt(g/d) eta of long waves, 2 % for their curvature, kd < 0.3; at rest where the water is."""
    t = np.arange(0.0, 60.0, 0.05)
    eta = -0.02 * np.exp(-(((t - 30) / 5) ** 2))
    write(tmp_path, t, eta)
    case = flume(tmp_path, "piston", end=60.0)
    law = law_of(case.wave, 1.0, reading_of(case.wave, 0.3, 9.81), 0.0, regular=False)
    way = np.array([law.displacement(x) for x in t])
    whole = np.trapezoid(eta, t) * np.sqrt(9.81 / 0.3)
    assert way[-1] - way[0] == pytest.approx(whole, rel=2e-3)
    np.testing.assert_allclose(np.diff(way) / 0.05, eta[1:] * np.sqrt(9.81 / 0.3), atol=0.02 * 0.02 * 5.72)
    assert law.reach[0] == pytest.approx(whole, rel=0.01) and abs(law.reach[1]) < 0.01 * abs(whole)
    read = [law.expected(x, 0.0, reading_of(case.wave, 0.3, 9.81)) for x in t]
    np.testing.assert_allclose(read, eta, atol=0.02 * 0.02)


@pytest.mark.parametrize("shift", [265.0, -1000.0, 1700000000.0])
def test_a_clock_that_does_not_meet_the_run_is_refused_with_the_start_that_does(tmp_path, shift):
    write(tmp_path, T + shift, WAVES)
    with pytest.raises(CaseError, match=f"start = {shift:.12g} makes its first time t = 0") as error:
        rules.require(flume(tmp_path))
    assert "nothing in common" in str(error.value) and f"{shift:.12g} to {shift + 20:.12g} s" in str(error.value)
    moved = flume(tmp_path, start=shift)
    assert told(moved) == []
    np.testing.assert_allclose(moved.wave.elevation(0.0, T), WAVES, atol=2e-4)


def test_a_record_that_ends_in_its_waves_before_the_run_does_is_told(tmp_path):
    write(tmp_path, T, WAVES)
    assert "after 20 s 3 s of half a cosine lead to still water" in told(flume(tmp_path, end=30.0), "warning")[0]
    write(tmp_path, T + 5.0, WAVES)
    assert "before 5 s 3 s of half a cosine" in told(flume(tmp_path), "warning")[0]
    write(tmp_path, T, EVENT)
    assert told(flume(tmp_path, end=30.0), "warning") == [], "it is over"


def test_a_hole_is_refused_with_its_place_unless_it_is_allowed(tmp_path):
    hole = (T < 5.975) | (T > 12.025)
    write(tmp_path, T[hole], WAVES[hole])
    with pytest.raises(CaseError, match=r"no sample between 5.95 and 12.05 s, elsewhere one every 0.05 s"):
        rules.require(flume(tmp_path))
    assert told(flume(tmp_path, gap=6.1)) == []
    assert told(flume(tmp_path, end=5.0)) == [], "the run does not come to it"
    write(tmp_path, T[hole] + 100.0, WAVES[hole])
    with pytest.raises(CaseError, match=r"between 105.95 and 112.05 s"):
        rules.require(flume(tmp_path, start=100.0))


def test_rows_of_nan_are_a_hole(tmp_path):
    write(tmp_path, T, np.where((T > 8) & (T < 9), np.nan, WAVES))
    with pytest.raises(CaseError, match=r"no sample between 8 and 9 s"):
        rules.require(flume(tmp_path))
    lost = np.arange(len(T)) % 7 == 3
    write(tmp_path, T, np.where(lost, np.nan, WAVES))
    assert told(flume(tmp_path)) == [], "single ones are not"


def test_a_file_without_a_single_value_is_refused(tmp_path):
    write(tmp_path, T, np.full(len(T), np.nan))
    assert "needs at least 4 rows of finite numbers" in " ".join(told(flume(tmp_path), "error"))
    write(tmp_path, T, np.full(len(T), np.nan), columns="level_m")
    found = [str(f) for f in rules.check(river(tmp_path)) if f.level == "error"]
    assert "needs at least 2 rows of finite numbers" in " ".join(found)


def test_uneven_steps_are_no_holes(tmp_path):
    t = T + 0.02 * np.random.default_rng(1).uniform(-1.0, 1.0, len(T))
    write(tmp_path, t, 0.01 * np.sin(2 * np.pi * t / 1.5))
    assert told(flume(tmp_path)) == []
    rest = np.append(np.arange(0.0, 10.0), np.arange(10.0, 20.0, 0.05))  # a logger that writes seldom in still water
    write(tmp_path, rest, np.where(rest < 10, 0.0, 0.01 * np.sin(2 * np.pi * rest / 1.5)))
    assert "no sample between 0 and 1 s" in told(flume(tmp_path))[0]
    assert told(flume(tmp_path, gap=1.0)) == []


def test_the_file_of_an_open_side_is_looked_at_in_the_same_way(tmp_path):
    level = 0.3 + 0.02 * np.sin(2 * np.pi * T / 20)
    write(tmp_path, T, level, columns="level_m")
    assert told(river(tmp_path)) == []
    assert "after 12.5 s the last value is held" in told_of_cut(tmp_path, level)[0]
    write(tmp_path, T + 265, level, columns="level_m")
    assert "start = 265" in told(river(tmp_path), "error")[0]
    assert told(river(tmp_path, start=265.0)) == []
    hole = (T < 5.975) | (T > 12.025)
    write(tmp_path, T[hole], level[hole], columns="level_m")
    assert "between 5.95 and 12.05 s" in told(river(tmp_path), "error")[0]
    assert told(river(tmp_path, gap=6.2)) == []


def told_of_cut(folder, level):
    held = T < 12.51
    write(folder, T[held], level[held], columns="level_m")
    return told(river(folder), "warning")


def test_a_schedule_of_a_few_rows_has_no_holes(tmp_path):
    write(tmp_path, [0, 10, 12, 100], [0.3, 0.3, 0.28, 0.28], columns="level_m")
    assert told(river(tmp_path)) == []


def test_start_and_gap_belong_to_a_file():
    with pytest.raises(CaseError, match=r"start belongs to file"):
        load({"case": {"name": "a"}, "domain": {"size": [4.0, 0.5], "spacing": 0.02}, "water": [{"below": 0.3}],
              "open": [{"side": "left", "level": 0.3, "start": 3.0}], "time": {"end": 1.0}})  # fmt: skip


def test_open_sides_read_their_columns_in_other_units(tmp_path):
    """Levels in mm and velocities in cm/s are those in m and m/s."""
    found = []
    for columns, level, speed in (("level_m,velocity_m_s", 1.0, 1.0), ("Level [mm],velocity_cm_s", 1000.0, 100.0)):
        write(tmp_path, T, level * (0.3 + EVENT), speed * EVENT, columns=columns)
        found.append(records(river(tmp_path).open[0], tmp_path))
    for key in ("level", "velocity"):
        np.testing.assert_allclose(found[1][key].value, found[0][key].value, atol=2e-6)  # six decimals are written
