"""A run that was stopped, interrupted or killed, and resumed, is the uninterrupted one bit for bit."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import houle
from houle.case.build import build
from houle.errors import CaseError
from houle.flow.simulation import Simulation
from houle.output import checkpoints, load_newest
from houle.running import runner
from houle.running.recorder import multiple

CASES = Path(__file__).parents[1] / "cases"
sys.path.insert(0, str(CASES))
import fake_simulation  # noqa: E402

TINY = {
    "case": {"name": "tiny"},
    "domain": {"size": [0.4, 0.2], "spacing": 0.02},
    "water": [{"box": [[0.0, 0.0], [0.14, 0.16]]}, {"below": 0.03}],
    "porous": [
        {"name": "rock", "box": [[0.2, 0.0], [0.3, 0.14]], "porosity": 0.5, "grain_diameter": 0.01,
         "resistance": {"law": "van-gent-1995"}}
    ],
    "gauge": [{"x": 0.1}, {"x": 0.35}],
    "sensor": [{"at": [0.1, 0.05]}],
    "time": {"end": 0.3},
    "output": {"every": 0.1, "series_every": 0.007},
}  # fmt: skip
SCRIPT = """
import os, sys
if "FAKE_PAUSE" in os.environ:
    import fake_simulation
    sys.modules["houle.flow.simulation"] = fake_simulation
import houle, houle.running.session
houle.running.session.CHECKPOINT_EVERY = 0.1
houle.running.session.COMMIT_EVERY = 0.0  # files are ahead of the checkpoint
try:
    houle.run("case.toml", out="run", threads=1)
except KeyboardInterrupt as reason:
    print(reason)
    sys.exit(130)
"""


def assert_same(one: houle.Run, other: houle.Run) -> None:
    """Series, surface, fields and the final state, to the last bit."""
    for a, b in ((one.series, other.series), (one.surface, other.surface)):
        assert set(a.variables) == set(b.variables)
        for name in a.variables:
            assert a[name].values.tobytes() == b[name].values.tobytes(), name
    assert list(one.fields.times) == list(other.fields.times)
    for i in range(len(one.fields.times)):
        a, b = one.fields.frame(i), other.fields.frame(i)
        for name in vars(a):
            assert np.asarray(getattr(a, name)).tobytes() == np.asarray(getattr(b, name)).tobytes(), name
    a, b = load_newest(one.directory), load_newest(other.directory)
    assert a.step == b.step and set(a.state) == set(b.state)
    for name in a.state:
        assert a.state[name].tobytes() == b.state[name].tobytes(), name


@pytest.fixture(autouse=True)
def without_pictures(monkeypatch):
    monkeypatch.setattr(runner, "draw", lambda run, session: None)


@pytest.fixture
def fake(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "houle.flow.simulation", fake_simulation)
    monkeypatch.chdir(tmp_path)
    return houle.load(fake_simulation.CASE)


# ---- on the stand-in: every way to stop


def test_stopping_anywhere_and_resuming_changes_nothing(fake):
    whole = houle.run(fake)
    for until in (0.001, 0.1, 0.1049, 0.43, 0.49):
        part = houle.run(fake, until=until)
        assert part.summary["time"] >= until and not part.summary["finished"]
        assert_same(whole, houle.resume(part.directory))


def test_resuming_again_and_again_changes_nothing(fake):
    whole = houle.run(fake)
    run = houle.run(fake, until=0.05)
    for until in (0.11, 0.2, 0.33, None):
        run = houle.resume(run.directory, until=until)
    assert_same(whole, run)
    assert len(run.manifest["resumed"]) == 4
    assert run.manifest["case"] == houle.run(fake).manifest["case"]


def test_the_clock_goes_on(fake, monkeypatch):
    monkeypatch.setenv("FAKE_PAUSE", "0.005")
    part = houle.run(fake, until=0.25).summary
    run = houle.resume("runs/tank").summary
    assert run["operations"]["sloshing"] > part["operations"]["sloshing"] + 0.15
    assert run["wall_seconds"] > part["wall_seconds"] + 0.15


def test_a_finished_run_is_returned_as_it_is(fake):
    run = houle.run(fake)
    before = {path: path.stat().st_mtime_ns for path in run.directory.iterdir()}
    assert houle.resume(run.directory).summary == run.summary
    assert {path: path.stat().st_mtime_ns for path in run.directory.iterdir()} == before


def test_a_moved_folder_and_a_damaged_checkpoint_are_no_obstacle(fake, monkeypatch):
    whole = houle.run(fake)
    with monkeypatch.context() as patch:
        patch.setattr("houle.running.session.CHECKPOINT_EVERY", 0.0)
        part = houle.run(fake, until=0.05)
    moved = part.directory.rename("elsewhere")
    newest = checkpoints(moved)[0]
    newest.write_bytes(newest.read_bytes()[:-200])
    assert_same(whole, houle.resume(moved))


def test_a_changed_case_is_refused(fake):
    part = houle.run(fake, until=0.1)
    text = (part.directory / "case.toml").read_text()
    (part.directory / "case.toml").write_text(text.replace("end = 0.5", "end = 0.6"))
    with pytest.raises(CaseError, match="is not the case that was run"):
        houle.resume(part.directory)


def test_without_a_checkpoint_the_cure_is_to_start_again(fake):
    part = houle.run(fake, until=0.1)
    for path in checkpoints(part.directory):
        path.unlink()
    with pytest.raises(CaseError, match="no good checkpoint"):
        houle.resume(part.directory)


def test_until_must_lie_ahead(fake):
    part = houle.run(fake, until=0.2)
    with pytest.raises(CaseError, match=r"until = 0\.1 s is not after"):
        houle.resume(part.directory, until=0.1)


def test_a_failed_run_goes_on_from_before_the_failure(fake, monkeypatch):
    whole = houle.run(fake)
    monkeypatch.setenv("FAKE_FAIL", "40!")
    with pytest.raises(houle.SimulationError):
        houle.run(fake)
    monkeypatch.delenv("FAKE_FAIL")
    assert_same(whole, houle.resume("runs/tank-2"))


# ---- in a process of its own: signals


def _hears_hang_ups() -> None:
    """Also where the tests run under nohup, which a run of houle would heed."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def start(directory: Path, case: houle.Case, **environment: str) -> subprocess.Popen[str]:
    """A run of the case in directory/run; returns when its first checkpoint is there."""
    (directory / "case.toml").write_text(case.to_toml())
    path = os.pathsep.join([str(CASES), *sys.path])
    process = subprocess.Popen(
        [sys.executable, "-c", SCRIPT], cwd=directory, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        env={**os.environ, "PYTHONPATH": path, **environment}, preexec_fn=None if os.name == "nt" else _hears_hang_ups,
    )  # fmt: skip
    deadline = time.monotonic() + 30
    while not (directory / "run" / "run.json").exists():
        assert process.poll() is None and time.monotonic() < deadline, process.communicate(timeout=1)[0]
        time.sleep(0.01)
    return process


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("delay", [0.0, 0.17, 0.4, 0.7])
def test_kill_9_leaves_readable_files_and_the_resumed_run_is_the_same(fake, tmp_path, delay):
    whole = houle.run(fake)
    process = start(tmp_path, fake, FAKE_PAUSE="0.01")
    time.sleep(delay)
    process.kill()
    assert process.wait() == -signal.SIGKILL
    killed = houle.open_run(tmp_path / "run")
    assert not killed.summary["finished"]
    assert killed.series.time.size >= 1 and killed.surface.time.size >= 1 and len(killed.fields.times) >= 1
    assert_same(whole, houle.resume(killed.directory))


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_polite_stop_finishes_the_step_and_says_how_to_go_on(fake, tmp_path, number):
    whole = houle.run(fake)
    process = start(tmp_path, fake, FAKE_PAUSE="0.1")  # far from done, however busy the machine is
    time.sleep(0.25)
    process.send_signal(number)
    said = process.communicate(timeout=20)[0]
    assert process.returncode == 130
    assert "a checkpoint is written" in said and "houle resume run" in said
    stopped = houle.open_run(tmp_path / "run")
    newest = load_newest(stopped.directory)
    assert newest.step == stopped.summary["steps"] > 0
    assert_same(whole, houle.resume(stopped.directory))


# ---- the real simulation


CHOICES = [
    {"numerics.transfer": "fmpm"},
    {"numerics.transfer": "flip"},
    {"numerics.transfer": "pic"},
    {"numerics.transfer": "apic"},
    {"numerics.kernel": "quadratic"},
    {"numerics.kernel": "m4prime", "numerics.transfer": "flip"},
    {"numerics.kernel": "gaussian"},
    {"numerics.remesh": "none"},
    {"numerics.remesh": "paper"},
    {"numerics.correction": 0.0},
    {"numerics.scheme": "jh2020"},
    {"gate": [{"x": 0.14, "speed": 1.0, "start": 0.02}]},
    {"domain.walls": "no-slip", "fluid.smagorinsky": 0.15},
    {"domain.walls": {"x": "periodic"}},
    {"time": {"end": 0.3, "step": 0.004}},
]


def steps(simulation: Simulation, end: float) -> Iterator[dict[str, np.ndarray]]:
    """Marches as a run does, looking at everything; after each step a copy of the state."""
    stops = [multiple(k, 0.025) for k in range(1, 1 + round(end / 0.025))]
    while simulation.time < end:
        stop = next(s for s in stops if s > simulation.time)
        simulation.advance(stop)
        seen = simulation.sample()
        if simulation.time >= stop:
            simulation.frame()
        yield {k: np.array(v) for k, v in {**simulation.state(), **{f"seen {k}": v for k, v in seen.items()}}.items()}


@pytest.mark.parametrize("choice", CHOICES, ids=lambda choice: "-".join(map(str, choice.values()))[:30])
def test_every_choice_can_be_restored_at_every_step(choice):
    case, end = houle.load(TINY, {"time": {"end": 1.0, "courant": 0.2}, "numerics.remesh_every": 4, **choice}), 0.05
    whole = list(steps(Simulation(build(case), 1), end))
    for k in range(len(whole) - 1):
        resumed = Simulation(build(case), 1)
        resumed.restore({name: value for name, value in whole[k].items() if not name.startswith("seen")})
        last = list(steps(resumed, end))[-1]
        assert set(last) == set(whole[-1])
        different = [name for name in last if last[name].tobytes() != whole[-1][name].tobytes()]
        assert not different, f"restored after step {k + 1}"


@pytest.mark.parametrize("scheme", ["houle", "jh2020"])
def test_a_run_of_the_real_simulation_resumes_bit_for_bit(tmp_path, scheme):
    case = houle.load(TINY, {"numerics.scheme": scheme, "numerics.remesh_every": 7})
    whole = houle.run(case, out=tmp_path / "whole")
    for until in (0.004, 0.1, 0.123):
        part = houle.run(case, out=tmp_path / str(until), until=until)
        assert_same(whole, houle.resume(part.directory))


def test_a_run_carries_the_files_that_its_case_names(tmp_path):
    """So it can be resumed where they are not: here the record of an open side."""
    record = tmp_path / "inflow.csv"
    record.write_text("t_s,velocity_m_s\n0,0.0\n0.1,0.1\n")
    case = houle.load({**TINY, "open": [{"side": "left", "file": str(record)}]}, {"time.end": 0.1})
    whole = houle.run(case, out=tmp_path / "whole")
    part = houle.run(case, out=tmp_path / "part", until=0.05)
    record.unlink()
    assert_same(whole, houle.resume(part.directory))


def test_the_same_in_3d(tmp_path):
    box = {"size": [0.4, 0.08, 0.2], "spacing": 0.02}
    water = [{"box": [[0.0, 0.0, 0.0], [0.14, 0.08, 0.16]]}, {"below": 0.03}]
    rock = {**TINY["porous"][0], "box": [[0.2, 0.0, 0.0], [0.3, 0.04, 0.14]]}
    case = {**TINY, "domain": box, "water": water, "porous": [rock], "gauge": [{"x": 0.1, "y": 0.04}]}
    case = houle.load({**case, "sensor": [{"at": [0.1, 0.04, 0.05]}]}, {"time.end": 0.15})
    whole = houle.run(case, out=tmp_path / "whole")
    part = houle.run(case, out=tmp_path / "part", until=0.07)
    assert_same(whole, houle.resume(part.directory))


def test_threads_and_resuming_on_other_threads_change_no_bit(tmp_path):
    changes = {"domain.spacing": 0.005, "output.every": 0.02, "numerics.remesh_every": 3}
    case = houle.load(TINY, {**changes, "time": {"end": 0.03, "courant": 0.2}})
    whole = houle.run(case, out=tmp_path / "whole", threads=1)
    assert whole.summary["particles"] > 2 * 1024  # enough for the loops to be shared
    assert_same(whole, houle.run(case, out=tmp_path / "two", threads=2))
    for threads in (1, 2):
        part = houle.run(case, out=tmp_path / str(threads), threads=threads, until=0.013)
        assert_same(whole, houle.resume(part.directory, threads=3 - threads))
