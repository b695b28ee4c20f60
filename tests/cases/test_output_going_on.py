"""A run goes on after a stop, a kill or a full disk as if there had been none; checkpoints and manifest."""

import dataclasses
import json
import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from made_run import assert_same_frame, made_case, made_frame, made_grid, made_outputs, write

from houle.flow.snapshot import Snapshot
from houle.output import (
    OutputError,
    checkpoints,
    collect,
    fields,
    growing,
    load_newest,
    read_fields,
    read_manifest,
    read_series,
    read_surface,
    save_checkpoint,
    summarise,
    write_manifest,
)
from houle.output.child import in_child


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("stop", [0, 2, 5])
def test_a_resumed_run_leaves_the_files_of_an_uninterrupted_one(tmp_path, packed, stop):
    grid, case = made_grid(), made_case()
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    outputs = made_outputs(whole, case, grid)
    write(outputs, grid, range(7), range(25))
    outputs.close()

    outputs = made_outputs(parts, case, grid)
    write(outputs, grid, range(6), range(21))
    outputs.close() if packed else outputs.commit()
    outputs = made_outputs(parts, case, grid)
    outputs.truncate_after(0.1 * stop, 0.1 * stop)
    assert len(read_fields(parts)) == stop + 1
    write(outputs, grid, range(stop + 1, 7), range(4 * stop + 1, 25))
    outputs.close()

    xr.testing.assert_identical(read_series(parts), read_series(whole))
    xr.testing.assert_identical(read_surface(parts), read_surface(whole))
    got, wanted = read_fields(parts), read_fields(whole)
    np.testing.assert_array_equal(got.times, wanted.times)
    for index in range(7):
        one, other = got.frame(index), wanted.frame(index)
        for field in dataclasses.fields(Snapshot):
            np.testing.assert_array_equal(getattr(one, field.name), getattr(other, field.name))


def test_a_run_cut_back_twice_forgets_its_future_twice(tmp_path):
    grid, case = made_grid(), made_case()
    outputs = made_outputs(tmp_path, case, grid)
    write(outputs, grid, range(9), [0])
    outputs.close()
    for last, more in ((5, 7), (2, 4)):  # goes on by one frame or two, then is killed
        outputs = made_outputs(tmp_path, case, grid)
        outputs.truncate_after(0.1 * last, 0.0)
        write(outputs, grid, range(last + 1, more), [])
        outputs.commit()
        assert len(read_fields(tmp_path)) == more
    for index in range(4):
        assert_same_frame(read_fields(tmp_path).frame(index), made_frame(grid, index))


WRITE_FOREVER = """
    import sys
    sys.path.insert(0, {here!r})
    from made_run import made_case, made_frame, made_grid, made_outputs, made_sample
    from houle.output import save_checkpoint
    grid = made_grid()
    outputs = made_outputs({folder!r}, made_case(), grid)
    for index in range(1000000):
        outputs.append_frame(made_frame(grid, index))
        outputs.append_series(0.025 * index, made_sample(2, index))
        outputs.commit()
        save_checkpoint({folder!r}, index, {{"index": index, "field": [float(index)] * 10000}}, {{"time": 0.1 * index}})
        print(index, flush=True)
"""


@pytest.mark.parametrize("wait", [0.0, 0.011, 0.023, 0.037])
def test_kill_9_at_any_moment_leaves_readable_files(tmp_path, wait):
    script = textwrap.dedent(WRITE_FOREVER).format(here=str(Path(__file__).parent), folder=str(tmp_path))
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            if int(line) == 3:
                break
        time.sleep(wait)
        process.kill()
    saved = load_newest(tmp_path)
    assert saved.step >= 3 and saved.meta["time"] == 0.1 * saved.step
    np.testing.assert_array_equal(saved.state["field"], np.full(10000, float(saved.step)))
    grid, got = made_grid(), read_fields(tmp_path)
    assert len(got) > saved.step and read_series(tmp_path).sizes["time"] > saved.step
    for index in range(len(got)):
        assert_same_frame(got.frame(index), made_frame(grid, index))
    outputs = made_outputs(tmp_path, made_case(), grid)
    outputs.truncate_after(saved.meta["time"], saved.meta["time"])
    outputs.close()
    assert len(read_fields(tmp_path)) == saved.step + 1 == read_surface(tmp_path).sizes["time"]


FILL_THE_DISK = """
    import resource, sys
    sys.path.insert(0, {here!r})
    from made_run import made_case, made_frame, made_grid, made_outputs, made_sample
    from houle.output import OutputError, save_checkpoint
    grid = made_grid()
    outputs = made_outputs({folder!r}, made_case(), grid)
    outputs.append_frame(made_frame(grid, 0))
    outputs.append_series(0.0, made_sample(2, 0))
    outputs.commit()
    save_checkpoint({folder!r}, 1, {{"a": [1.0] * 100}}, {{}})
    outputs.append_frame(made_frame(grid, 1))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
    for action in (outputs.fields.commit, outputs.surface.commit, outputs.close, outputs.fields.commit,
                   lambda: save_checkpoint({folder!r}, 2, {{"a": [1.0] * 10000}}, {{}})):
        try:
            action()
        except OutputError as error:
            print(error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no resource limits")
def test_a_full_disk_is_one_message_and_spoils_nothing(tmp_path):
    script = textwrap.dedent(FILL_THE_DISK).format(here=str(Path(__file__).parent), folder=str(tmp_path))
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == ""
    messages = done.stdout.splitlines()
    assert sum(line.startswith(f"cannot write {tmp_path}") for line in messages) == 5
    assert all("write elsewhere" in line for line in messages if not line.startswith("cannot write"))
    assert_same_frame(read_fields(tmp_path).frame(0), made_frame(made_grid(), 0))
    assert load_newest(tmp_path).step == 1 and read_surface(tmp_path).sizes["time"] == 1
    assert not list(tmp_path.rglob(".*tmp*"))


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="file/run") as raised:
        write_manifest(tmp_path / "file", {})
    assert "a file stands where a folder is needed" in str(raised.value)


def test_reading_a_folder_without_a_run_says_so(tmp_path):
    for read in (read_series, read_surface, read_fields, read_manifest):
        with pytest.raises(OutputError, match="is this the folder of a run"):
            read(tmp_path)


def test_a_checkpoint_gives_back_every_bit(tmp_path):
    strange = np.array([np.nan, -0.0, np.inf, 5e-324]).view(np.uint64) + np.array([7, 0, 0, 0], np.uint64)
    state = {
        "nan_with_a_message": strange.view(np.float64),
        "single": np.float32([1 / 3]),
        "number": np.int32(-5),
        "flag": True,
        "turned": np.arange(12.0).reshape(3, 4).T,
        "nothing": np.zeros((0, 2)),
    }
    save_checkpoint(tmp_path, 12, state, {"time": 0.1, "rng": 2**127 + 1})
    got = load_newest(tmp_path)
    assert (got.step, got.meta, set(got.state)) == (12, {"time": 0.1, "rng": 2**127 + 1}, set(state))
    for name, value in state.items():
        wanted = np.asarray(value)
        assert got.state[name].dtype == wanted.dtype and got.state[name].shape == wanted.shape
        assert got.state[name].tobytes() == wanted.tobytes()


@pytest.mark.parametrize("harm", ["one bit", "cut", "empty"])
def test_a_damaged_checkpoint_is_passed_over(tmp_path, harm):
    for step in (100, 200):
        path = save_checkpoint(tmp_path, step, {"a": np.full(5000, float(step))}, {})
    data = bytearray(path.read_bytes())
    data[data.index(np.float64(200).tobytes() * 3) + 8] ^= 1
    path.write_bytes({"one bit": data, "cut": data[: len(data) // 2], "empty": b""}[harm])
    assert load_newest(tmp_path).step == 100


def test_the_newest_two_are_kept_and_a_run_cut_back_forgets_its_future(tmp_path):
    for step in (1, 20, 3000):
        save_checkpoint(tmp_path, step, {}, {})
    assert [path.name for path in checkpoints(tmp_path)] == ["checkpoint-3000.h5", "checkpoint-20.h5"]
    save_checkpoint(tmp_path, 40, {}, {})
    assert [path.name for path in checkpoints(tmp_path)] == ["checkpoint-40.h5", "checkpoint-20.h5"]


def test_the_manifest_says_what_ran_where_and_how_it_went(tmp_path):
    case = made_case()
    start = collect(case.identity, threads=2)
    outcome = {"time": 2.0, "steps": np.int64(10), "particles": 5, "wall_seconds": 1.0, "cpu_seconds": 1.0}
    outcome["operations"] = {"transfer": 0.5}
    write_manifest(tmp_path, summarise(start, finished=True, volume_drift=np.nan, energy={"kinetic": 1.0}, **outcome))
    got = json.loads((tmp_path / "run.json").read_text(), parse_constant=pytest.fail)
    assert got["finished"] is True and got["case"]["hash"] == case.hash and got["case"]["text"] == case.to_toml()
    assert (
        got["machine"]["threads"] == 2
        and got["machine"]["cpu"]
        and got["python"]["packages"]["numpy"] == np.__version__
    )
    build = got["houle"]["build"]
    assert build["compiler"] and "O" in build["flags"] and build["threads"] >= 1
    assert got["summary"]["steps"] == 10 and got["summary"]["volume_drift"] is None
    assert got["ended"] >= got["started"] and read_manifest(tmp_path) == got


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere HDF5 is trusted")
def test_a_file_that_hdf5_does_not_come_through_is_damaged(tmp_path):
    """It may take HDF5 for ever, or the process with it."""

    def for_ever():
        while True:
            pass

    file = tmp_path / "series.nc"
    file.write_bytes(b"")
    assert in_child(lambda: "grüße", file) == "grüße"
    for look in (for_ever, lambda: os.kill(os.getpid(), signal.SIGSEGV), lambda: 1 / 0):
        begin = time.process_time()
        assert in_child(look, file) is None
        assert time.process_time() - begin < 1.0  # of this process


def test_resume_goes_on_without_a_file_that_hdf5_does_not_come_through(tmp_path, monkeypatch):
    grid, case = made_grid(), made_case()
    outputs = made_outputs(tmp_path, case, grid)
    write(outputs, grid, range(3), range(9))
    outputs.close()
    for module in (growing, fields):
        monkeypatch.setattr(module, "in_child", lambda look, path: None)
    lost = made_outputs(tmp_path, case, grid).truncate_after(0.2, 0.2, [0.0, 0.1, 0.2])
    assert len(lost) == 3 and all("HDF5 does not come through it" in text and "are lost" in text for text in lost)
    assert sorted(p.name for p in tmp_path.glob("*.damaged")) == [
        "fields.vtkhdf.damaged",
        "series.nc.damaged",
        "surface.nc.damaged",
    ]
