"""The variants of the compiled core: which of them is taken, that it is told, and that all compute the same bits."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec

import pytest

from houle import _core

BUILT = [variant for variant in ("own", "v3", "portable") if find_spec(f"houle._core_{variant}")]
BITS = """
import hashlib
from houle import _core
from houle.case.build import build
from houle.case.model import load
from houle.flow.simulation import Simulation

case = load("{case}", {overrides})
simulation = Simulation(build(case), 1)
for _ in range({steps}):
    simulation.advance(case.time.end)
found = hashlib.sha256()
for values in (simulation.particles.position, simulation.particles.velocity, simulation.particles.volume):
    found.update(values.tobytes())
print(_core.build_info()["variant"], found.hexdigest())
"""
RUNS = {
    "houle, 2D": ("dam-break-rock-35", {"domain.spacing": 0.01}, 40),
    "jh2020, 2D": ("dam-break-rock-35", {"domain.spacing": 0.02, "numerics.scheme": "jh2020"}, 40),
    "houle, 3D": ("spheric-2", {"domain.spacing": 0.1}, 15),
}


def python(code: str, variant: str) -> subprocess.CompletedProcess[str]:
    """What a Python of its own answers to `code` with that variant of the core."""
    environment = {**os.environ, "HOULE_CORE": variant}
    return subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=300)


def runs_here(variant: str) -> bool:
    return "this processor has no" not in python("from houle import _core", variant).stderr


def test_the_build_tells_its_variant():
    assert _core.build_info()["variant"] in BUILT


def test_a_variant_that_is_not_there_is_named():
    done = python("from houle import _core", "v9")
    assert done.returncode != 0
    assert "no module houle._core_v9" in done.stderr


@pytest.mark.parametrize("variant", BUILT)
def test_a_variant_can_be_asked_for(variant):
    if not runs_here(variant):
        pytest.skip(f"this processor does not run {variant}")
    done = python("from houle import _core; print(_core.build_info()['variant'])", variant)
    assert done.stdout.strip() == variant


@pytest.mark.parametrize("run", RUNS)
def test_all_variants_compute_the_same_bits(run):
    variants = [variant for variant in BUILT if runs_here(variant)]
    if len(variants) < 2:
        pytest.skip("a build for one machine holds one variant; a wheel holds two")
    case, overrides, steps = RUNS[run]
    code = BITS.format(case=case, overrides=overrides, steps=steps)
    found = [python(code, variant) for variant in variants]
    assert all(done.returncode == 0 for done in found), found[0].stderr + found[-1].stderr
    told = [done.stdout.split() for done in found]
    assert [variant for variant, _ in told] == variants
    assert len({bits for _, bits in told}) == 1
