"""A run whose water gains energy ends with exit status 3 and a bundle that says what, when, where and what to do."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys

import numpy as np
import pytest

import houle

CASE = """
case = {name = "column"}
domain = {size = [0.4, 0.24], spacing = 0.02}
water = [{box = [[0.0, 0.0], [0.14, 0.16]]}]
time = {end = 0.2}
output = {every = 0.05}
numerics = {transfer = "TRANSFER"}
[[porous]]
box = [[0.2, 0.0], [0.3, 0.14]]
porosity = 0.49
grain_diameter = 0.0159
resistance = {law = "van-gent-1995"}
"""
# From 0.1 s on every projection, of the core, leaves the faces faster than it found them.
SCRIPT = """
from houle import _core
from houle.flow import motion
from houle.running import runner
from houle.cli import main

extrapolate, move = _core.extrapolate, motion.move

def faster(grid, layers, near, mass, least, velocity, known):
    extrapolate(grid, layers, near, mass, least, velocity, known)
    for u in velocity if faster.on else []:
        u *= 1.3

def timed(flow, dt, linear):
    faster.on = flow.time > 0.1
    move(flow, dt, linear)

faster.on = False
_core.extrapolate, motion.move = faster, timed
import houle.flow.step
houle.flow.step.move = timed
runner.draw = lambda run, session: None
main()
"""


def houle_run(folder, script, transfer="fmpm"):
    (folder / "case.toml").write_text(CASE.replace("TRANSFER", transfer))
    command = [sys.executable, "-c", script, "run", "case.toml", "--out", "out", "--threads", "1"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "COLUMNS": "200"}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.parametrize("transfer", ["fmpm", "flip", "apic", "pic"])
def test_a_gain_of_energy_ends_the_run_with_status_3_and_a_bundle(tmp_path, transfer):
    done = houle_run(tmp_path, SCRIPT, transfer)
    assert done.returncode == 3, done.stderr
    assert "the water has gained energy" in done.stderr and "Traceback" not in done.stderr
    folder = tmp_path / "out" / "failure"
    text = " ".join((folder / "diagnosis.txt").read_text(encoding="utf-8").split())
    found = re.match(
        r"Step (\d+), t = ([\d.]+) s at \(([\d.]+), ([\d.]+)\) m: the water has gained energy: ([\d.]+) J per metre "
        r"of width in motion, where at most ([\d.]+) were to be had; the fastest water moves at ([\d.]+) m/s\.",
        text,
    )
    assert found, text
    step, time, x, z, moving, available, speed = map(float, found.groups())
    volume, width = 0.14 * 0.16, 0.3 + 0.1 * 0.49  # of the column, which can fall to a flat pool
    assert available == pytest.approx(9810.0 * (volume * 0.08 - 0.5 * volume**2 / width), rel=0.005)
    assert moving > 1.05 * available and 0.1 < time < 0.2 and step > 1
    record = json.loads((folder / "worst.json").read_text())
    assert (x, z) == pytest.approx(record["place"], abs=1e-3) and 0.0 < x < 0.4 and 0.0 < z < 0.24
    fastest = max(np.hypot(*p["velocity"]) for p in record["worst"])  # Darcy velocities
    assert len(record["worst"]) == 20 and speed >= 0.99 * fastest
    assert "no physical cause" in text and "series.nc" in text and "finer grid" in text
    assert any(folder.glob("checkpoint-*.h5")) and not houle.open_run(tmp_path / "out").summary["finished"]


def test_without_the_gain_the_same_run_is_done(tmp_path):
    done = houle_run(tmp_path, SCRIPT.replace("flow.time > 0.1", "False"))
    assert done.returncode == 0, done.stderr
    assert not (tmp_path / "out" / "failure").exists()
