"""Parallel loops under preemption: every iteration runs once, with the body of its own loop.

The program is compiled from the core's own sources; its iterations lose their core now and then.
"""

import pytest

from stress import loops


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    if loops.compiler() is None or loops.onetbb() is None:
        pytest.skip("needs a C++ compiler and the package tbb-devel")
    return loops.build(tmp_path_factory.mktemp("stress"))


@pytest.mark.parametrize(("threads", "number"), [(2, 20_000), (3, 5_000), (8, 200)])
def test_every_iteration_runs_once(program, threads, number):
    done = loops.run(program, threads, number, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"loops {number + 20}: wrong 0" in done.stdout
