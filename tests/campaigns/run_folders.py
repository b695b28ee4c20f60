"""Spoils run folders and resumes them: never a traceback, never more than 2 s of CPU until an answer.

    python tests/campaigns/run_folders.py --inputs 5000 --seed 1

A run that stopped half-way is spoiled anew for every input: bytes turned over, files cut, emptied, removed, put in each
other's place or taken from another run, numbers and names in HDF5 and JSON changed, checkpoints made absurd and sealed
again. `houle.resume` may refuse it (exit status 2), fail as a run does (3), or go on to the end.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

import houle
import houle.output.atomic
import houle.running.runner
from houle.errors import HouleError, SimulationError
from houle.output.checkpoint import checkpoints, load, save_checkpoint

LIMIT = 2.0  # s of CPU until a run is refused or goes on
CASE = {
    "case": {"name": "tank"},
    "domain": {"size": [0.4, 0.2], "spacing": 0.04},
    "water": [{"box": [[0.0, 0.0], [0.2, 0.12]]}],
    "gauge": [{"x": 0.1}],
    "sensor": [{"at": [0.1, 0.05]}],
    "time": {"end": 0.06},
    "output": {"every": 0.02, "series_every": 0.005},
}
NUMBERS = (0, -1, 1e9, 1e300, -1e300, float("nan"), float("inf"), 2**31, 2**63 - 1)


def files(folder: Path) -> list[Path]:
    return sorted(p for p in folder.rglob("*") if p.is_file())


def flip(folder: Path, rng: random.Random) -> None:
    """One to twenty bytes of a file become others."""
    path = rng.choice(files(folder))
    data = bytearray(path.read_bytes() or b"x")
    for _ in range(rng.randint(1, 20)):
        data[rng.randrange(len(data))] = rng.randrange(256)
    path.write_bytes(data)


def flip_head(folder: Path, rng: random.Random) -> None:
    """Bytes of the first 4 kB, where HDF5 keeps what the rest is."""
    path = rng.choice(files(folder))
    data = bytearray(path.read_bytes() or b"x")
    for _ in range(rng.randint(1, 8)):
        data[rng.randrange(min(4096, len(data)))] ^= 1 << rng.randrange(8)
    path.write_bytes(data)


def cut(folder: Path, rng: random.Random) -> None:
    path = rng.choice(files(folder))
    path.write_bytes(path.read_bytes()[: rng.randrange(max(1, path.stat().st_size))])


def remove(folder: Path, rng: random.Random) -> None:
    for path in rng.sample(files(folder), rng.randint(1, 3)):
        path.unlink()


def swap(folder: Path, rng: random.Random) -> None:
    one, other = rng.sample(files(folder), 2)
    data = one.read_bytes()
    one.write_bytes(other.read_bytes())
    other.write_bytes(data)


def lengthen(folder: Path, rng: random.Random) -> None:
    with open(rng.choice(files(folder)), "ab") as file:
        file.write(rng.randbytes(rng.randint(1, 5000)))


def to_folder(folder: Path, rng: random.Random) -> None:
    """A folder stands where a file was."""
    path = rng.choice(files(folder))
    path.unlink()
    path.mkdir()


def change_json(folder: Path, rng: random.Random) -> None:
    path = folder / "run.json"
    found = json.loads(path.read_text())
    table = rng.choice([found, found["summary"], found["case"]])
    key = rng.choice(list(table))
    if rng.random() < 0.3:
        del table[key]
    else:
        table[key] = rng.choice([None, [], {}, "x", *NUMBERS])
    path.write_text(json.dumps(found))


def change_hdf5(folder: Path, rng: random.Random) -> None:
    """A dataset or an attribute of a result or a checkpoint becomes another."""
    path = rng.choice([p for p in files(folder) if p.suffix in (".nc", ".h5", ".vtkhdf")])
    with h5py.File(path, "r+") as file:
        names: list[str] = []
        file.visit(names.append)
        name = rng.choice(names)
        node = file[name]
        if node.attrs and rng.random() < 0.4:
            node.attrs[rng.choice(list(node.attrs))] = rng.choice([*NUMBERS, "x"])
        elif isinstance(node, h5py.Dataset) and rng.random() < 0.5 and node.size and node.dtype.kind in "fi":
            with np.errstate(all="ignore"):
                values = np.array(node[...], dtype=float)
                values.ravel()[rng.randrange(values.size)] = rng.choice(NUMBERS)
                node[...] = values.astype(node.dtype) if node.dtype.kind == "f" else np.nan_to_num(values, posinf=9)
        elif rng.random() < 0.5:
            del file[name]
        else:
            del file[name]
            file.create_dataset(name, (rng.choice([0, 1, 10**6, 10**15]), 2), "f8", chunks=(16, 2), maxshape=(None, 2))


def change_state(folder: Path, rng: random.Random) -> None:
    """A checkpoint that is whole and sealed, and absurd."""
    newest = load(checkpoints(folder)[0])
    if newest is None:
        return
    state, meta = dict(newest.state), dict(newest.meta)
    name = rng.choice(list(state))
    kind, array = rng.randrange(5), np.array(state[name])
    if kind == 0:
        del state[name]
    elif kind == 1 and array.size:
        array = array.astype(float)
        array.ravel()[rng.randrange(array.size)] = rng.choice(NUMBERS)
        state[name] = array
    elif kind == 2:
        state[name] = np.zeros(rng.choice([(), (0,), (1,), (7, 3), (10, 10, 10)]))
    elif kind == 3:
        state[name] = array.astype(float) * 1e9
    else:
        meta[rng.choice(list(meta))] = rng.choice([None, "x", {}, [], *NUMBERS])
    save_checkpoint(folder, newest.step + rng.randint(0, 1), state, meta)


HARMS: tuple[Callable[[Path, random.Random], None], ...] = (
    flip, flip_head, cut, remove, swap, lengthen, to_folder, change_json, change_hdf5, change_state,
)  # fmt: skip


def outcome(folder: Path) -> str:
    """What resuming it comes to, in a process of its own; a traceback or a signal is told whole."""
    read, write = os.pipe()
    if child := os.fork():
        os.close(write)
        with os.fdopen(read, errors="replace") as pipe:
            words = pipe.read()
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        return words if status == 0 else f"FAULT: ended by signal or status {status} {words}"
    os.close(read)
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        os.dup2(1, 2)
        used = resource.getrusage(resource.RUSAGE_SELF)
        signal.signal(signal.SIGXCPU, signal.SIG_DFL)
        now = int(used.ru_utime + used.ru_stime) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (now + int(LIMIT) + 3, now + int(LIMIT) + 5))
        text = resumed(folder)
    except BaseException:
        text = "FAULT: " + traceback.format_exc()
    with os.fdopen(write, "w", errors="replace") as pipe:
        pipe.write(text)
    os._exit(0)


def resumed(folder: Path) -> str:
    """The kind of end."""
    try:
        run = houle.resume(folder, threads=1)
    except SimulationError:
        return "status 3"
    except HouleError:
        return "status 2"
    except OSError:
        return "status 2 (the command says what the system says)"
    return "resumed, something lost" if run.manifest.get("lost") else "resumed"


def campaign(inputs: int, seed: int, tell: Callable[[str], Any] = print) -> list[str]:
    """Runs it; the faults found."""
    rng, ends, faults = random.Random(seed), Counter[str](), []
    houle.output.atomic._sync = lambda path: None
    houle.running.runner.draw = lambda run, session: None
    with tempfile.TemporaryDirectory(prefix="folders-") as base:
        good = houle.run(CASE, out=Path(base, "good"), threads=1, until=0.03).directory
        houle.resume(shutil.copytree(good, Path(base, "resumed")), threads=1)  # all modules are loaded, for the forks
        for number in range(inputs):
            folder = Path(base, "spoiled")
            shutil.copytree(good, folder)
            harms = rng.choices(HARMS, k=rng.choice((1, 1, 1, 2)))
            for harm in harms:
                with contextlib.suppress(OSError, ValueError, TypeError, RuntimeError, LookupError):
                    harm(folder, rng)  # or not: what one has spoiled the next may not be able to read
            end = outcome(folder)
            ends[end.split("\n")[0][:60]] += 1
            if end.startswith("FAULT"):
                faults.append(f"seed {seed}, input {number}, {[h.__name__ for h in harms]}: {end}")
                tell(faults[-1])
            shutil.rmtree(folder)
    for end, count in ends.most_common():
        tell(f"{count:6d}  {end}")
    return faults


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--inputs", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    faults = campaign(given.inputs, given.seed)
    print(f"{given.inputs} folders, {len(faults)} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
