"""A run folder that was damaged, half-written or meddled with: the run goes on with what is whole, or is refused."""

from __future__ import annotations

import json
import os
import shutil
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from test_resume import assert_same

import houle
from houle.errors import CaseError, HouleError
from houle.output import checkpoints, load_newest, save_checkpoint
from houle.output.checkpoint import load
from houle.output.fields import read_fields
from houle.output.manifest import read_manifest
from houle.running import runner

sys.path.insert(0, str(Path(__file__).parents[1] / "cases"))
import fake_simulation


@pytest.fixture
def fake(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "houle.flow.simulation", fake_simulation)
    monkeypatch.setattr(runner, "draw", lambda run, session: None)
    monkeypatch.setattr("houle.output.atomic._sync", lambda path: None)  # no power cuts here
    monkeypatch.chdir(tmp_path)
    return houle.load(fake_simulation.CASE)


@pytest.fixture
def half(fake):
    """A run that stopped half-way, and the whole one."""
    return houle.run(fake, until=0.25).directory, houle.run(fake)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes of POSIX")
def test_a_pipe_in_a_run_folder_is_not_waited_for(tmp_path):
    """It was read until somebody wrote into it."""
    for name in ("checkpoint-3.h5", "run.json", "fields.vtkhdf"):
        os.mkfifo(tmp_path / name)
    assert load(tmp_path / "checkpoint-3.h5") is None
    for read in (read_manifest, read_fields):
        with pytest.raises(HouleError, match="a device or a pipe"):
            read(tmp_path)


HARMS = {
    "gone": lambda path: path.unlink(),
    "empty": lambda path: path.write_bytes(b""),
    "cut": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "no HDF5": lambda path: path.write_bytes(b"once upon a time " * 1000),
}


@pytest.mark.parametrize("harm", HARMS)
@pytest.mark.parametrize("name", ["series.nc", "surface.nc", "fields.vtkhdf"])
def test_a_damaged_result_is_told_and_the_run_goes_on_without_it(half, capsys, name, harm):
    folder, whole = half
    HARMS[harm](folder / name)
    run = houle.resume(folder, progress=True)
    said = next(line for line in capsys.readouterr().err.splitlines() if line.startswith(f"warning: {name} is "))
    assert "are lost" in said and run.summary["finished"] and run.manifest["lost"] == [said.removeprefix("warning: ")]
    assert (folder / f"{name}.damaged").exists() == (harm != "gone")
    kept = {"series.nc": run.series.time, "surface.nc": run.surface.time, "fields.vtkhdf": run.fields.times}
    full = {"series.nc": whole.series.time, "surface.nc": whole.surface.time, "fields.vtkhdf": whole.fields.times}
    for file, times in kept.items():
        wanted = np.asarray(full[file])
        np.testing.assert_array_equal(times, wanted[wanted > 0.25] if file == name else wanted)
    assert load_newest(folder).state[X].tobytes() == load_newest(whole.directory).state[X].tobytes()


def test_of_damaged_fields_the_frames_that_are_whole_stay(half):
    folder, whole = half
    with h5py.File(folder / "fields.vtkhdf", "r+") as file:
        spoiled = file["VTKHDF/particles/PointData/pressure"]
        place = int(file["VTKHDF/particles/Steps/PointOffsets"][1])
        spoiled.id.write_direct_chunk((place,), b"no deflated numbers")
    run = houle.resume(folder)
    assert list(run.fields.times) == [t for t in whole.fields.times if t != 0.1]
    assert "1 of its frames up to" in run.manifest["lost"][0]


def test_the_files_of_another_run_are_not_gone_on_with(half, fake):
    folder, _ = half
    other = houle.run(fake, out="other", overrides={"gauge": [{"x": 0.2}]})
    for name in ("series.nc", "surface.nc", "fields.vtkhdf"):
        shutil.copy(other.directory / name, folder / name)
    lost = houle.resume(folder).manifest["lost"]
    assert len(lost) == 3 and all("another case" in text for text in lost)


def spoil(folder: Path, change) -> None:
    """A checkpoint that is whole, but not what a run leaves."""
    newest = load_newest(folder)
    state, meta = dict(newest.state), dict(newest.meta)
    change(state, meta)
    save_checkpoint(folder, newest.step + 1, state, meta)


X, U, VOLUME = (f"flow/particles/{name}" for name in ("position", "velocity", "volume"))
ABSURD = {
    "particles far away": lambda state, meta: state.update({X: 1e9 * state[X]}),
    "no number": lambda state, meta: state.update({U: np.full_like(state[U], np.nan)}),
    "an array too short": lambda state, meta: state.update({VOLUME: state[VOLUME][:-1]}),
    "a missing array": lambda state, meta: state.pop(U),
    "no time": lambda state, meta: state.pop("flow/time"),
    "another array": lambda state, meta: state.update(more=np.zeros(3)),
    "letters": lambda state, meta: state.update({X: np.full(state[X].shape, b"x")}),
    "more water than room": lambda state, meta: state.update({VOLUME: 1e3 * state[VOLUME]}),
    "a clock without wall time": lambda state, meta: meta.pop("wall_seconds"),
    "a clock that never ends": lambda state, meta: meta.update(wall_seconds=float("inf")),
    "an operation that takes no number of seconds": lambda state, meta: meta["operations"].update(forces=float("nan")),
    "a stage with letters for seconds": lambda state, meta: meta["stages"].update(writing="3"),
    "another case": lambda state, meta: meta.update(case_hash="0"),
    "a sample without a gauge": lambda state, meta: state.pop("recorder.0.sample.eta"),
    "an earlier sample": lambda state, meta: state.update({"recorder.0.time": np.float64(9.0)}),
    "other rows": lambda state, meta: state.update({"recorder.rows": np.int64(10**12)}),
    "no hash": lambda state, meta: meta.update(case_hash=[]),
}


@pytest.mark.parametrize("what", ABSURD)
def test_an_absurd_checkpoint_is_passed_over(half, capsys, what):
    folder, whole = half
    spoil(folder, ABSURD[what])
    run = houle.resume(folder, progress=True)
    assert "passed over" in capsys.readouterr().err
    assert_same(whole, run)


def test_a_folder_by_the_name_of_a_checkpoint_is_left_alone(half):
    folder, whole = half
    (folder / "checkpoint-1.h5").mkdir()
    assert_same(whole, houle.resume(folder))
    assert (folder / "checkpoint-1.h5").is_dir()


def test_a_frame_whose_numbers_are_not_in_the_file_is_lost(half, capsys):
    """HDF5 reads zeros where a chunk is missing, and cannot copy it."""
    folder, whole = half
    with h5py.File(folder / "fields.vtkhdf", "r+") as file:
        name = "VTKHDF/grid/CellData/pressure"
        there = file[name].id
        chunks = [there.get_chunk_info(i).chunk_offset for i in range(there.get_num_chunks())]
        kept = [(offset, there.read_direct_chunk(offset)[1]) for offset in chunks[1:]]
        same = {key: getattr(file[name], key) for key in ("shape", "dtype", "chunks", "compression", "shuffle")}
        del file[name]
        anew = file.create_dataset(name, **same)
        for offset, data in kept:
            anew.id.write_direct_chunk(offset, data)
    run = houle.resume(folder, progress=True)
    assert "1 of its frames up to" in capsys.readouterr().err
    np.testing.assert_array_equal(run.fields.times, whole.fields.times[1:])


def test_a_checkpoint_that_asks_for_more_memory_than_it_fills_is_damaged(half):
    folder, whole = half
    newest = checkpoints(folder)[0]
    greedy = newest.with_name("checkpoint-9999.h5")
    with h5py.File(newest) as source, h5py.File(greedy, "w") as file:
        for name in ("meta", "state"):
            source.copy(name, file)
        file.attrs.update(source.attrs)
        file.attrs["step"] = 9999
        del file[f"state/{X}"]
        file.create_dataset(f"state/{X}", shape=(10**14, 2), chunks=(1024, 2))
    assert load(greedy) is None
    assert_same(whole, houle.resume(folder))


@pytest.mark.parametrize("text", ["", "null", "[1, 2]", "{}", '{"finished": true}', "[" * 3000, "\x00"])
@pytest.mark.parametrize("use", [houle.open_run, houle.resume])
def test_a_manifest_that_is_none_is_refused(half, text, use):
    folder, _ = half
    (folder / "run.json").write_text(text)
    with pytest.raises(HouleError, match=r"cannot read .*run\.json"):
        use(folder)


def test_a_run_killed_between_its_first_checkpoint_and_run_json_goes_on(half):
    folder, whole = half
    (folder / "run.json").unlink()
    assert_same(whole, houle.resume(folder))


def test_what_killed_runs_left_half_written_goes(half):
    folder, whole = half
    left = [".series.tmp.nc", ".series.next.nc", ".surface.former.nc", ".checkpoint-7.tmp.h5", ".run.tmp.json"]
    for name in left:
        (folder / name).write_text("half")
    (folder / ".mine.txt").write_text("not of houle")
    (folder / "failure.tmp").mkdir()
    run = houle.resume(folder)
    assert [p.name for p in folder.glob(".*")] == [".mine.txt"] and not (folder / "failure.tmp").exists()
    assert_same(whole, run)


# ---- prolonging


def test_a_finished_run_goes_on_past_its_end_and_records_both(fake):
    short = houle.run(fake, overrides={"time.end": 0.3})
    run = houle.resume(short.directory, until=0.5)
    assert_same(houle.run(fake), run)
    assert run.case.time.end == 0.5 and run.summary["finished"] and run.case.hash == run.manifest["case"]["hash"]
    (entry,) = run.manifest["prolonged"]
    assert (entry["from"], entry["to"]) == (0.3, 0.5)
    assert json.loads((run.directory / "run.json").read_text())["prolonged"] == [entry]
    assert run.series.attrs["case_hash"] == run.case.hash


def test_an_end_between_frames_stays_a_frame_and_the_others_keep_their_times(fake):
    run = houle.resume(houle.run(fake, overrides={"time.end": 0.25}).directory, until=0.5)
    assert list(run.fields.times) == [0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5]
    assert run.series.time.values.tolist() == houle.run(fake).series.time.values.tolist()


def test_a_prolonged_run_that_was_killed_goes_on_to_its_later_end(fake, monkeypatch):
    short = houle.run(fake, overrides={"time.end": 0.3})
    old = (short.directory / "case.toml").read_text()
    monkeypatch.setenv("FAKE_FAIL", "55!")
    with pytest.raises(houle.SimulationError):
        houle.resume(short.directory, until=0.5)
    monkeypatch.delenv("FAKE_FAIL")
    (short.directory / "case.toml").write_text(old)  # killed between run.json and case.toml
    run = houle.resume(short.directory)
    assert_same(houle.run(fake), run)
    assert run.case.time.end == 0.5


def test_an_end_that_is_not_later_leaves_a_finished_run_as_it_is(fake):
    run = houle.run(fake)
    before = (run.directory / "run.json").read_bytes()
    assert houle.resume(run.directory, until=0.4).summary == run.summary
    for wrong in (float("nan"), "2", True):
        with pytest.raises(CaseError, match="until = "):
            houle.resume(run.directory, until=wrong)
    with pytest.raises(CaseError, match=r"time\.end = inf"):
        houle.resume(run.directory, until=float("inf"))
    assert (run.directory / "run.json").read_bytes() == before


# ---- arguments


@pytest.mark.parametrize("wrong", [5, None, ["x"], "a\0b", "x" * 5000])
def test_a_folder_that_is_none_is_named(fake, wrong):
    for use in (houle.open_run, houle.resume):
        with pytest.raises(CaseError, match="directory = "):
            use(wrong)
    if wrong is not None:
        with pytest.raises(CaseError, match="out = "):
            houle.run(fake, out=wrong)


def test_a_dict_of_tables_is_run_as_it_is_loaded(fake):
    assert houle.run(fake_simulation.CASE).case.hash == fake.hash
    with pytest.raises(CaseError, match="case = 5"):
        houle.run(5)


def test_a_frame_that_is_not_there_is_told(fake):
    fields = houle.run(fake).fields
    for wrong in (99, -7, "last", 1.0, None):
        with pytest.raises(CaseError, match=r"holds frames 0 to 5.*nearest"):
            fields.frame(wrong)
    with pytest.raises(IndexError):
        fields.frame(99)
    assert fields.frame(-1).time == 0.5 and fields.frame(np.int64(2)).time == 0.2


# ---- names that are no text


def test_a_folder_and_a_case_whose_names_are_not_text_are_names_like_others(fake):
    import os

    folder = Path(os.fsdecode(b"r\xe9sultats"))
    file = Path(os.fsdecode(b"jet\xe9e.toml"))
    try:
        file.write_text(fake.to_toml())
    except OSError:
        pytest.skip("this file system takes no such names")
    houle.run(file, out=folder, until=0.2)
    assert_same(houle.run(fake), houle.resume(folder))
