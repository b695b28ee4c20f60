"""A run as the user meets it: where it goes, when it writes what, how it fails. On a stand-in for the simulation."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest

import houle
from houle.data import laboratory
from houle.errors import CaseError, SimulationError
from houle.running import progress, runner
from houle.running.cores import granted, usable
from houle.running.recorder import Observed, Recorder, interpolate, multiple

sys.path.insert(0, str(Path(__file__).parents[1] / "cases"))
import fake_simulation


@pytest.fixture
def tank(monkeypatch, tmp_path):
    """The case of the stand-in; runs go to a folder of their own."""
    monkeypatch.setitem(sys.modules, "houle.flow.simulation", fake_simulation)
    monkeypatch.setattr(runner, "draw", lambda run, session: None)
    monkeypatch.chdir(tmp_path)
    return houle.load(fake_simulation.CASE)


def test_importing_houle_loads_nothing_heavy():
    code = "import sys, houle; print([m for m in ('numpy', 'pydantic', 'xarray', 'matplotlib') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"


def test_a_run_with_its_pictures_loads_neither_xarray_nor_pandas_nor_pyplot(tmp_path):
    code = f"""
import sys
sys.path.insert(0, {str(Path(fake_simulation.__file__).parent)!r})
import fake_simulation
sys.modules["houle.flow.simulation"] = fake_simulation
import houle
run = houle.run(houle.load(fake_simulation.CASE), out={str(tmp_path / "out")!r}, progress=True)
print([p.stem for p in run.pictures], [m for m in ("xarray", "pandas", "matplotlib.pyplot") if m in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "['gauges', 'ledger', 'pressure', 'surface'] []", done.stderr


def test_every_public_name_is_there_and_the_function_run_stays_a_function():
    assert all(getattr(houle, name) is not None for name in dir(houle))
    assert callable(houle.run) and houle.run is runner.run
    with pytest.raises(AttributeError, match="nothing_of_that_name"):
        houle.nothing_of_that_name  # noqa: B018


# ---- what is written when


def test_multiples_are_those_of_the_decimal_number():
    assert multiple(3, 0.1) == 0.3 != 3 * 0.1
    assert multiple(60, 0.005) == multiple(6, 0.05) == multiple(3, 0.1)


def test_interpolation_is_exact_at_the_step_and_keeps_dry_gauges_dry():
    before = Observed(1.0, 0.0, {"eta": np.array([2.0, np.nan])})
    after = Observed(3.0, 2.0, {"eta": np.array([4.0, 7.0])})
    np.testing.assert_array_equal(interpolate(1.5, [before, after], {})["eta"], [2.5, np.nan])
    np.testing.assert_array_equal(interpolate(3.0, [before, after], {})["eta"], [4.0, 7.0])


def test_what_lags_is_interpolated_at_its_own_instants():
    """A quantity that is its time, sampled half a step late or a whole one, is still its time in the rows."""
    lag, ends = {"middle": 0.5, "start": 1.0}, [0.0, 0.2, 0.5]
    observed = []
    for before, end in zip([0.0, *ends], ends, strict=False):
        middle, step = 0.5 * (before + end), end - before
        observed.append(
            Observed(end, step, {"end": np.array(end), "middle": np.array(middle), "start": np.array(before)})
        )
    for time in (0.05, 0.1, 0.19, 0.2):
        row = interpolate(time, observed, lag)
        assert row["end"] == row["middle"] == pytest.approx(time) and row["start"] == pytest.approx(time)
    assert interpolate(0.45, observed, lag)["start"] == pytest.approx(0.45)  # beyond 0.2: the line goes on


class Collected:
    """Stands for the writers."""

    def __init__(self):
        self.rows, self.frames = [], []

    def append_series(self, time, sample):
        self.rows.append((time, float(sample["eta"])))

    def append_frame(self, frame):
        self.frames.append(frame)


class Ramp:
    """Its level is twice the time; steps of an uneven length that do not know the recorder."""

    time = step_size = 0.0
    lag: ClassVar[dict[str, float]] = {}

    def sample(self):
        return {"eta": 2.0 * self.time}

    def frame(self):
        return self.time


def test_rows_lie_on_multiples_whatever_the_steps_and_frames_on_stops():
    out, ramp = Collected(), Ramp()
    recorder = Recorder(out, end=1.05, every=0.25, series_every=0.15)
    recorder.start(ramp)
    while ramp.time < 1.05:
        before, ramp.time = ramp.time, min(recorder.stop, ramp.time + 0.13)
        ramp.step_size = ramp.time - before
        recorder.step(ramp, {"eta": np.float64(2.0 * ramp.time)})
    assert out.rows[-1][0] == 0.9  # waits for what lags
    recorder.finish(ramp)
    times = [t for t, _ in out.rows]
    assert times == [0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.05]
    np.testing.assert_allclose([eta for _, eta in out.rows], 2.0 * np.array(times), atol=1e-14)
    assert out.frames == [0.0, 0.25, 0.5, 0.75, 1.0, 1.05]


def test_instants_of_a_comparison_are_frames_whatever_the_interval():
    out, ramp = Collected(), Ramp()
    recorder = Recorder(out, 1.0, 0.4, 0.25, [0.0, 0.3, 0.4 + 1e-9, 0.8, 0.95, 1.0, 7.0])
    recorder.start(ramp)
    while ramp.time < 1.0:
        before, ramp.time = ramp.time, min(recorder.stop, ramp.time + 0.13)
        ramp.step_size = ramp.time - before
        recorder.step(ramp, {"eta": np.float64(2.0 * ramp.time)})
    assert out.frames == [0.0, 0.3, 0.4, 0.8, 0.95, 1.0]
    assert recorder.written == [0.0, 0.3, 0.4, 0.8, 0.95, 1.0]


def test_a_run_leaves_rows_frames_and_a_summary(tank):
    run = houle.run(tank)
    assert run.directory == Path("runs/tank")
    assert run.summary["finished"] and run.summary["time"] == 0.5
    assert run.series.time.values.tolist() == [multiple(k, 0.007) for k in range(72)]
    assert run.surface.time.values.tolist() == [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]
    assert list(run.fields.times) == run.surface.time.values.tolist()
    assert run.summary["volume_drift"] == 0.0
    assert run.summary["energy"]["energy_forces"] == pytest.approx(float(run.series.energy_forces[-1]), rel=0.1)
    assert "finished" in repr(run) and "66 steps" in repr(run)
    assert "<table>" in run._repr_html_()


# ---- where it goes


def test_an_end_that_is_a_multiple_but_for_round_off_is_one_frame_and_no_step(tank):
    end = 3 * 0.1
    assert end > 0.3
    run = houle.run(tank, overrides={"time.end": end})
    assert list(run.fields.times) == pytest.approx([0.0, 0.1, 0.2, 0.3])
    assert (
        run.summary["finished"]
        and run.summary["steps"] == houle.run(tank, overrides={"time.end": 0.3}).summary["steps"]
    )


def test_a_second_run_of_a_case_does_not_touch_the_first(tank):
    first, second = houle.run(tank), houle.run(tank)
    assert [str(first.directory), str(second.directory)] == [str(Path("runs/tank")), str(Path("runs/tank-2"))]


def test_a_folder_that_holds_a_run_is_refused_with_a_cure(tank):
    houle.run(tank, out="here")
    with pytest.raises(CaseError, match=r"here already holds a run.*houle resume here"):
        houle.run(tank, out="here")


def test_a_run_does_not_write_over_the_case_file_it_is_made_from(tank):
    Path("mine").mkdir()
    file = Path("mine", "case.toml")
    file.write_text("# my notes\n" + tank.to_toml())
    with pytest.raises(CaseError, match=r"out = mine holds .*case.toml, which the run would write anew"):
        houle.run(file, out="mine")
    assert file.read_text().startswith("# my notes") and len(list(Path("mine").iterdir())) == 1


def test_data_beside_the_case_may_lie_in_the_result_folder(tank):
    Path("lab.csv").write_text("t_s,x_m,eta_m\n0.2,0.05,0.1\n")
    Path("tank.toml").write_text(tank.to_toml() + '\n[reference]\nsurface = "lab.csv"\n')
    assert houle.run("tank.toml", out=".").summary["reference"]["times"] == [0.2]


def test_one_process_at_a_time_writes_a_folder(tank):
    from houle.output.lock import exclusive

    houle.run(tank, out="mine", until=0.1)
    words = rf"mine is being written by another houle \(process {os.getpid()}\)"
    with exclusive(Path("mine")), pytest.raises(CaseError, match=words):
        houle.resume("mine")
    with exclusive(Path("other")), pytest.raises(CaseError, match="other is being written by another houle"):
        houle.run(tank, out="other")
    assert not list(Path("other").iterdir())
    assert houle.resume("mine").summary["finished"]
    assert not Path("mine", ".lock").exists()


def test_ctrl_c_while_pictures_are_made_says_how_to_make_them(tank, monkeypatch):
    def stopped(run, session):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt, match="missing with: houle resume mine"):
        patch.setattr(runner, "draw", stopped)
        houle.run(tank, out="mine")
    assert houle.resume("mine").summary["finished"]


@pytest.mark.parametrize(
    "wrong", [{"threads": 0}, {"threads": 1.5}, {"threads": "two"}, {"threads": 10**30}, {"until": "2"}]
)
def test_threads_and_until_of_the_wrong_kind_are_bad_input(tank, wrong):
    with pytest.raises(CaseError, match=f"{next(iter(wrong))} = .*: give a"):
        houle.run(tank, **wrong)
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize("wrong", [{"out": ""}, {"out": 5}, {"overrides": 5}, {"overrides": "domain.spacing"}])
def test_folder_and_overrides_of_the_wrong_kind_are_bad_input(tank, wrong):
    with pytest.raises(CaseError, match=f"^{next(iter(wrong))} .*: give a"):
        houle.run(tank, **wrong)
    with pytest.raises(CaseError, match="directory is empty"):
        houle.resume("")
    assert list(Path().iterdir()) == []


def test_more_threads_than_cores_are_not_taken_and_that_is_said(tank, capsys):
    run = houle.run(tank, threads=1000, progress=True)
    said = capsys.readouterr().err
    assert "warning: threads = 1000 on a machine of" in said and f"{usable()} are taken" in said
    assert run.manifest["machine"]["threads"] == usable()


def test_the_cores_of_a_process_are_those_it_is_bound_to_and_its_container_grants(tmp_path):
    groups, membership = tmp_path / "cgroup", tmp_path / "membership"
    (groups / "box/run").mkdir(parents=True)
    membership.write_text("0::/box/run\n")
    assert granted(membership, groups) == float("inf") and granted(tmp_path / "none", groups) == float("inf")
    (groups / "box/run/cpu.max").write_text("max 100000\n")
    (groups / "box/cpu.max").write_text("150000 100000\n")
    assert granted(membership, groups) == 1.5
    (groups / "cpu/old").mkdir(parents=True)
    (groups / "cpu/old/cpu.cfs_quota_us").write_text("50000\n")
    (groups / "cpu/old/cpu.cfs_period_us").write_text("100000\n")
    membership.write_text("7:pids:/old\n3:cpu,cpuacct:/old\n")
    assert granted(membership, groups) == 0.5
    assert 1 <= usable() <= (os.cpu_count() or 1)


def test_a_file_in_the_way_is_refused_before_anything_is_computed(tank, monkeypatch):
    monkeypatch.setattr(fake_simulation, "Simulation", None)
    Path("taken").write_text("")
    with pytest.raises(CaseError, match="is a file"):
        houle.run(tank, out="taken/inside")


def test_bad_input_leaves_nothing_behind(tank):
    with pytest.raises(CaseError, match="until = -1"):
        houle.run(tank, until=-1.0)
    with pytest.raises(CaseError, match="spacing"):
        houle.run(tank, overrides={"domain.spacing": -0.1})
    with pytest.raises(CaseError, match="reference"):
        houle.run(tank, overrides={"reference": {"surface": "nowhere.csv"}})
    assert list(Path().iterdir()) == []


def test_a_disk_that_is_too_small_and_a_missing_encoder_are_said_before_the_run(tank, monkeypatch):
    with monkeypatch.context() as patch, pytest.raises(CaseError, match=r"output\.every = 0\.1 s writes at least"):
        patch.setattr(runner.shutil, "disk_usage", lambda path: SimpleNamespace(free=1000))
        houle.run(tank)
    with pytest.raises(CaseError, match=r"output\.series_every = 1e-15 s writes .* a longer output\.series_every"):
        houle.run(tank, overrides={"output.series_every": 1e-15})
    monkeypatch.setattr(runner, "find_spec", lambda name: None)
    with pytest.raises(CaseError, match=r"output\.movie = true needs an encoder"):
        houle.run(tank, overrides={"output.movie": True})


def test_a_folder_without_a_run_cannot_be_opened_or_resumed(tank, tmp_path):
    for use in (houle.open_run, houle.resume):
        with pytest.raises(CaseError, match="holds no run"):
            use(tmp_path)


# ---- the laboratory


def test_the_run_is_scored_against_the_laboratory_and_carries_its_data(tank):
    level = float(houle.run(tank).surface.eta.sel(time=0.2)[0])
    rows = [f"0.2,{x},{level - 0.002}" for x in (0.05, 0.15)]
    Path("lab.csv").write_text("\n".join(["# 2 mm below the run", "t_s,x_m,eta_m", *rows]))
    Path("case.toml").write_text(tank.to_toml() + '\n[reference]\nsurface = "lab.csv"\nerror = 0.004\n')
    run = houle.run("case.toml")
    assert run.summary["reference"]["rms"] == [pytest.approx(0.002)]
    assert run.summary["reference"]["overall"] == pytest.approx(0.002)
    assert (run.directory / "lab.csv").exists()


def test_the_score_does_not_depend_on_the_interval_of_the_frames(tank):
    """The instants of the laboratory are frames by themselves; where they are frames anyway nothing changes."""
    Path("lab.csv").write_text("t_s,x_m,eta_m\n0.1,0.05,0.1\n0.2,0.05,0.1\n0.3,0.05,0.09\n0.4,0.05,0.1\n")
    Path("case.toml").write_text(tank.to_toml() + '\n[reference]\nsurface = "lab.csv"\n')
    fine, coarse = (houle.run("case.toml", overrides={"output.every": every}) for every in (0.1, 7.0))
    assert fine.summary["reference"] == coarse.summary["reference"]
    assert list(coarse.fields.times) == coarse.surface.time.values.tolist() == [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]
    assert list(fine.fields.times) == list(coarse.fields.times)


def test_levels_between_profiles_and_columns_are_linear():
    import xarray

    eta = [[0.0, 1.0, np.nan], [2.0, 3.0, np.nan]]
    surface = xarray.Dataset({"eta": (("time", "x"), eta)}, {"time": [0.0, 1.0], "x": [0.5, 1.5, 2.5]})
    np.testing.assert_allclose(laboratory.level(surface, 0.25, np.array([0.0, 1.0, 2.2])), [0.5, 1.0, 1.5])
    np.testing.assert_allclose(laboratory.level(surface, 1.0, np.array([1.0])), [2.5])


def test_times_after_the_end_and_at_zero_do_not_count(tank):
    import xarray

    surface = xarray.Dataset({"eta": (("time", "x"), [[0.0], [1.0]])}, {"time": [0.0, 1.0], "x": [0.5]})
    points = laboratory.Points(np.array([0.0, 1.0, 2.0]), np.full(3, 0.5), np.array([9.0, 0.5, 0.0]))
    assert laboratory.score(points, surface) == laboratory.Score([0.0, 1.0], [9.0, 0.5], 0.5, 2)
    assert laboratory.score(laboratory.Points(*np.array([[2.0], [0.5], [0.0]])), surface) is None


def test_a_laboratory_file_may_come_from_windows(tmp_path):
    file = tmp_path / "lab.csv"
    file.write_bytes(b"\xef\xbb\xbf# by hand\r\nt_s,x_m,eta_m\r\n1,0.5,0.2\r\n")
    assert laboratory.read(file).eta == [0.2]


def test_a_laboratory_file_that_is_not_text_or_has_no_level_says_so(tmp_path):
    file = tmp_path / "lab.csv"
    file.write_bytes(b"# d\xe9bit\nt_s,x_m,eta_m\n1,0.5,0.2\n")
    assert laboratory.read(file).eta == [0.2]
    file.write_bytes(b"t_s,x_m,eta_m\n1,0.5,0.2\n\0")
    with pytest.raises(CaseError, match=r"reference\.surface = .* is not text"):
        laboratory.read(file)
    file.write_text("t_s,x_m,eta_m\n1,0.5,0.2\n1,0.6,nan\n")
    with pytest.raises(CaseError, match="row 2: leave out points without level"):
        laboratory.read(file)


@pytest.mark.parametrize("text", ["", "t_s,x_m\n1,2\n", "t_s,x_m,eta_m\n1,2\n", "t_s,x_m,eta_m\n1,2,wet\n"])
def test_a_bad_laboratory_file_says_what_it_should_be(tmp_path, text):
    file = tmp_path / "lab.csv"
    file.write_text(text)
    with pytest.raises(CaseError, match="t_s,x_m,eta_m"):
        laboratory.read(file)


# ---- failures


@pytest.mark.parametrize("how", ["5", "5!"])
def test_a_failure_leaves_a_bundle(tank, monkeypatch, how):
    monkeypatch.setenv("FAKE_FAIL", how)
    with pytest.raises(SimulationError, match="failure") as caught:
        houle.run(tank)
    folder = Path("runs/tank/failure")
    names = {path.name for path in folder.iterdir()}
    assert names == {"case.toml", "checkpoint-0.h5", "diagnosis.txt", "versions.json", "worst.json"}
    assert caught.value.step == 5
    worst = json.loads((folder / "worst.json").read_text())
    assert worst["step"] == 5 and len(worst["worst"]) == 20
    text = (folder / "diagnosis.txt").read_text()
    assert "Step 5" in text and "checkpoint-0.h5" in text
    assert ("pushed over" in text) if how == "5" else ("ZeroDivisionError: nobody foresaw this" in text)
    assert json.loads((folder / "versions.json").read_text())["python"]["packages"]["numpy"] == np.__version__
    run = houle.open_run("runs/tank")
    assert not run.summary["finished"] and run.surface.time.size == 1


def test_the_worst_particles_are_those_that_are_not_finite_then_the_fastest():
    from houle.flow.particles import Particles
    from houle.running.failure import worst_particles

    velocity = np.array([[0.0, 0.0], [3.0, 4.0], [np.nan, 0.0], [1.0, 0.0]])
    worst = worst_particles(Particles(np.zeros((4, 2)), velocity, np.ones(4)))
    assert [w["particle"] for w in worst] == [2, 1, 3, 0]


# ---- progress


def test_lines_say_time_speed_and_drift(tank, monkeypatch):
    monkeypatch.setattr(progress.Lines, "every", 0.0)
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    houle.run(tank, progress=True)
    lines = stream.getvalue().splitlines()
    assert lines[0] == "houle: reading tank"
    last = next(line for line in reversed(lines) if line.startswith("t ="))
    assert last.startswith("t = 0.500 of 0.5 s, 100 %, 0.0 s left, ")
    assert all(word in last for word in ("steps/s", "us/particle/step", "200 particles", "volume drift +0e+00"))


def test_a_bar_is_drawn_where_it_can_be(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setenv("TERM", "xterm")
    assert type(progress.reporter(True, Terminal())) is progress.Bar
    assert type(progress.reporter(True, io.StringIO())) is progress.Lines
    monkeypatch.setenv("TERM", "dumb")
    assert type(progress.reporter(True, Terminal())) is progress.Lines


def test_durations_read_well():
    assert [progress.duration(s) for s in (0.04, 9.96, 75, 7261)] == ["0.0 s", "10 s", "1 min 15 s", "2 h 01 min"]


# ---- throughput


def test_the_triad_moves_its_bytes_and_the_traffic_counts_particles_and_cells():
    from houle.bench import least_traffic, triad

    assert 1e8 < triad(1, length=1 << 16, repeats=2) < 1e13
    without = least_traffic(2, 1000, 0, (10.0, 5.0))
    assert without == 8 * 1000 * (7 * 5 + 8)
    assert least_traffic(2, 1000, 100, (20.0, 5.0)) > least_traffic(2, 1000, 100, (10.0, 5.0)) > without


def test_of_every_step_the_bench_takes_the_run_that_was_not_disturbed():
    from houle.bench import Measured, least

    def run(walls):
        operations = {"forces": walls, "ledger": [1.0, 1.0]}
        return Measured(1, 2, 10, 20, walls, walls, operations, (5.0, 2.0), None, None, 1e9)

    found = least([run([1.0, 9.0]), run([4.0, 2.0])])
    assert found.walls == found.cpus == found.operations["forces"] == [1.0, 2.0]
    assert found.microseconds(found.walls) == pytest.approx(1e6 * 3.0 / (2 * 10)) and found.steps_per_second == 2 / 3
