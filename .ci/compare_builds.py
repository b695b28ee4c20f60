"""Compares builds of houle for .ci/wheel: the numbers in their runs bit by bit, and how fast they step.

    python .ci/compare_builds.py --runs DIR DIR ... --python NAME=PYTHON NAME=PYTHON ... [--repeats 5]

Each PYTHON has houle installed. They step in turn, and the fastest of every step counts, as in `houle bench`. The first
of the runs, and of the interpreters, is what the others are compared with: exit status 1 if one of them has less than
LEAST of its speed, or a run has other bits.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

LEAST = 0.97
ORDER = {"case": "dam-break-rock-35", "overrides": {"domain.spacing": 0.005}, "threads": 1, "warm": 40, "steps": 200}
FILES = ("series.nc", "surface.nc", "fields.vtkhdf")


def bits(run: Path) -> str:
    """A hash of all numbers in the files of a run."""
    found = hashlib.sha256()

    def add(name: str, item: h5py.Dataset | h5py.Group) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu":
            found.update(name.encode() + np.asarray(item[...]).tobytes())

    for name in FILES:
        with h5py.File(run / name) as file:
            file.visititems(add)
    return found.hexdigest()[:16]


def seconds(pythons: dict[str, str], repeats: int) -> dict[str, float]:
    """Least time of all steps of each build [s]."""
    walls: dict[str, list[list[float]]] = {name: [] for name in pythons}
    for _ in range(repeats):
        for name, python in pythons.items():
            command = [python, "-m", "houle.bench", json.dumps(ORDER)]
            done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
            walls[name].append(json.loads(done.stdout.splitlines()[-1])["walls"])
    return {name: float(np.min(those, axis=0).sum()) for name, those in walls.items()}


def main() -> int:
    """The command line above."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", nargs="+", type=Path, default=[])
    parser.add_argument("--python", nargs="+", default=[], metavar="NAME=PYTHON")
    parser.add_argument("--repeats", type=int, default=5)
    given = parser.parse_args()
    worst = 0
    hashes = {run: bits(run) for run in given.runs}
    for run, found in hashes.items():
        build = json.loads((run / "run.json").read_text())["houle"]["build"]
        same = found == hashes[given.runs[0]]
        worst |= not same
        print(f"{run}: variant {build['variant']}, bits {found}{'' if same else ', NOT THE SAME'}; {build['flags']}")
    times = seconds(dict(one.split("=", 1) for one in given.python), given.repeats)
    for name, time in times.items():
        speed = next(iter(times.values())) / time
        worst |= speed < LEAST
        print(f"{name}: {1e3 * time / ORDER['steps']:.3f} ms a step, {speed:.3f} of the speed of the first")
    return int(worst)


if __name__ == "__main__":
    sys.exit(main())
