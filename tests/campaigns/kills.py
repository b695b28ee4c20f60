"""Kills runs at random moments and resumes them: every number must be that of the run that nobody touched.

    python tests/campaigns/kills.py --kills 50 --seed 1

Six kinds of case take turns; each is computed once whole. A run is killed (SIGKILL) once to three times, anywhere from
its first line to its pictures, with checkpoints and commits so close together that most kills hit one. Then it is
resumed to the end. Status 1 if one array differs.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import sys
import tempfile
import time
import traceback
from pathlib import Path
from typing import Any

import numpy as np

import houle
import houle.flow.simulation
import houle.output.atomic
import houle.running.runner
import houle.running.session
from houle.output import load_newest

ROCK = {"box": [[0.2, 0.0], [0.3, 0.14]], "porosity": 0.5, "grain_diameter": 0.01,
        "resistance": {"law": "van-gent-1995"}}  # fmt: skip
DAM = {
    "case": {"name": "dam"},
    "domain": {"size": [0.4, 0.2], "spacing": 0.02},
    "water": [{"box": [[0.0, 0.0], [0.14, 0.16]]}, {"below": 0.03}],
    "porous": [ROCK],
    "gauge": [{"x": 0.1}, {"x": 0.35}],
    "sensor": [{"at": [0.1, 0.05]}],
    "time": {"end": 0.2},
    "output": {"every": 0.02, "series_every": 0.003},
    "numerics": {"remesh_every": 5},
}
FLUME = {
    "domain": {"size": [3.0, 0.45], "spacing": 0.03},
    "water": [{"below": 0.3}],
    "gauge": [{"x": 1.0}, {"x": 1.5}],
    "runup": [{"name": "wall", "x": [2.6, 3.0]}],
    "time": {"end": 0.4},
    "output": {"every": 0.05, "series_every": 0.005},
}
CASES: dict[str, dict[str, Any]] = {
    "dam break": DAM,
    "3D": {
        **DAM,
        "domain": {"size": [0.4, 0.08, 0.2], "spacing": 0.02},
        "water": [{"box": [[0.0, 0.0, 0.0], [0.14, 0.08, 0.16]]}, {"below": 0.03}],
        "porous": [{**ROCK, "box": [[0.2, 0.0, 0.0], [0.3, 0.04, 0.14]]}],
        "gauge": [{"x": 0.1, "y": 0.04}],
        "sensor": [{"at": [0.1, 0.04, 0.05]}],
    },
    "piston": {
        **FLUME,
        "case": {"name": "piston"},
        "waves": {"kind": "regular", "piston": {"x": 0.15}, "depth": 0.3, "height": 0.04, "period": 1.0},
        "absorber": [{"x": 2.7, "side": "right"}],
    },
    "source and sponges": {
        **FLUME,
        "case": {"name": "source"},
        "waves": {"kind": "regular", "source": {"x": 1.0}, "depth": 0.3, "height": 0.04, "period": 0.8},
        "sponge": [{"box": [[0.0, 0.0], [0.6, 0.45]]}, {"box": [[2.2, 0.0], [3.0, 0.45]]}],
    },
    "open sides": {
        **FLUME,
        "case": {"name": "channel"},
        "open": [{"side": "left", "velocity": 0.1}, {"side": "right", "level": 0.3}],
        "porous": [{**ROCK, "box": [[1.2, 0.0], [1.6, 0.45]], "resistance": {"a": 5.0, "b": 20.0}}],
    },
    "gate": {
        **DAM,
        "case": {"name": "gate"},
        "water": [{"box": [[0.0, 0.0], [0.14, 0.16]]}],
        "gate": [{"x": 0.14, "speed": 0.5, "start": 0.02}],
        "overtopping": [{"name": "crest", "x": 0.3, "level": 0.05}],
    },
    "jh2020": {**DAM, "case": {"name": "paper"}, "numerics": {"scheme": "jh2020", "remesh_every": 7}},
}


def run_or_resume(case: Path, folder: Path, pictures: bool) -> None:
    """The case computed in the folder, or gone on with, whatever lies there."""
    houle.output.atomic._sync = lambda path: None  # the system lives on, and has what was written
    if not pictures:
        houle.running.runner.draw = lambda run, session: None
    houle.running.session.CHECKPOINT_EVERY, houle.running.session.COMMIT_EVERY = 0.5, 0.1
    there = (folder / "run.json").exists() or any(folder.glob("checkpoint-*.h5"))
    houle.resume(folder, threads=1, progress=True) if there else houle.run(case, folder, threads=1, progress=True)


def start(case: Path, folder: Path, pictures: bool = False) -> int:
    """Number of a process that does it: a fork, so that it works at once."""
    sys.stdout.flush()
    if child := os.fork():
        return child
    status = 1
    try:
        log = os.open(folder.with_suffix(".log"), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(log, 1)
        os.dup2(log, 2)
        run_or_resume(case, folder, pictures)
        status = 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(status)


def wait(child: int) -> int:
    """The exit status of the process, or minus the signal that ended it."""
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def differences(one: houle.Run, other: houle.Run) -> list[str]:
    """Names of the arrays of two runs that are not the same to the last bit."""
    found = []
    for kind in ("series", "surface"):
        a, b = getattr(one, kind), getattr(other, kind)
        names = set(a.variables) ^ set(b.variables)
        names |= {n for n in set(a.variables) & set(b.variables) if a[n].values.tobytes() != b[n].values.tobytes()}
        found += [f"{kind} {name}" for name in sorted(map(str, names))]
    if list(one.fields.times) != list(other.fields.times):
        return [*found, "times of the frames"]
    for i in range(len(one.fields)):
        a, b = vars(one.fields.frame(i)), vars(other.fields.frame(i))
        found += [f"frame {i} {n}" for n in a if np.asarray(a[n]).tobytes() != np.asarray(b[n]).tobytes()]
    x, y = load_newest(one.directory), load_newest(other.directory)
    if x is None or y is None or x.step != y.step or set(x.state) != set(y.state):
        return [*found, "last checkpoint"]
    return found + [f"state {n}" for n in x.state if x.state[n].tobytes() != y.state[n].tobytes()]


def computed(name: str, folder: Path) -> tuple[Path, houle.Run, float]:
    """Case file, the run of it that nobody kills, and how long that takes [s]."""
    folder.mkdir(parents=True)
    case = folder / "one.toml"
    case.write_text(houle.load(CASES[name]).to_toml())
    begin = time.monotonic()
    if wait(start(case, folder / "whole")) != 0:
        raise SystemExit(f"{name} does not run:\n{(folder / 'whole.log').read_text()}")
    return case, houle.open_run(folder / "whole"), time.monotonic() - begin


def killed(case: Path, folder: Path, moments: list[float], pictures: bool) -> list[str]:
    """Kills the run after so many seconds each, resumes it to its end; what went wrong, in words."""
    for moment in moments:
        child, end = start(case, folder, pictures), time.monotonic() + moment
        while time.monotonic() < end and not os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT):
            time.sleep(0.005)
        os.kill(child, signal.SIGKILL)
        wait(child)
    if status := wait(start(case, folder)):
        return [f"resume ends with status {status}:\n{folder.with_suffix('.log').read_text()[-3000:]}"]
    if leftovers := [p.name for p in folder.rglob(".*")]:
        return [f"left over: {', '.join(sorted(leftovers))}"]
    return []


def campaign(kills: int, seed: int, names: list[str] | None = None, tell: Any = print) -> list[str]:
    """Runs it; what went wrong, one line each."""
    rng, failures = random.Random(seed), []
    with tempfile.TemporaryDirectory(prefix="kills-") as folder:
        whole: dict[str, tuple[Path, houle.Run, float]] = {}
        for number in range(kills):
            name = (names or list(CASES))[number % len(names or CASES)]
            if name not in whole:
                whole[name] = computed(name, Path(folder, name.replace(" ", "-")))
            case, run, seconds = whole[name]
            pictures = number % 5 == 4  # they take longer than the water
            longest = seconds * (3.0 if pictures else 1.0)
            moments = [rng.uniform(0.0, longest) for _ in range(rng.choice((1, 1, 2, 3)))]
            there = case.parent / f"killed-{number}"
            problems = killed(case, there, moments, pictures)
            problems = problems or differences(run, houle.open_run(there))
            words = ", ".join(f"{m:.2f}" for m in moments)
            outcome = "; ".join(problems) or "the same"
            tell(f"{number + 1:3d} {name}: killed after {words} of {seconds:.1f} s: {outcome}")
            failures += [f"{name}, seed {seed}, kill {number + 1}: {p}" for p in problems]
    return failures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=50, help="runs that are killed")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--case", action="append", choices=list(CASES), help="only this kind; repeatable")
    given = parser.parse_args()
    failures = campaign(given.kills, given.seed, given.case)
    print(f"{given.kills} runs killed, {given.kills - len({f.split(':')[0] for f in failures})} resumed bitwise")
    raise SystemExit(1 if failures else 0)


if __name__ == "__main__":
    main()
