"""The same bits for any number of threads, and after a run was taken up again from its state."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from situations import DAM_BREAK, copy_state, differing, run, simulation

from houle import _core

CHOICES = [
    {"numerics__transfer": transfer, "numerics__scheme": scheme, "numerics__remesh_every": 7}
    for scheme, transfer in itertools.product(("houle", "jh2020"), ("fmpm", "flip", "pic", "apic"))
]
# 2600 particles in 700 cells: enough for the loops to be shared out
WIDE = {**DAM_BREAK, "domain": {"size": [0.4, 0.24], "spacing": 0.01}, "fluid": {"smagorinsky": 0.15}}
DEEP = {
    "case": {"name": "deep"},
    "domain": {"size": [0.4, 0.12, 0.24], "spacing": 0.02, "walls": {"y": "periodic"}},
    "water": [{"box": [[0.0, 0.0, 0.0], [0.14, 0.12, 0.16]]}, {"below": 0.033}],
    "porous": [{"box": [[0.2, 0.0, 0.0], [0.3, 0.08, 0.14]], "porosity": 0.5, "resistance": {"a": 5.0, "b": 60.0}}],
    "time": {"end": 1.0},
}


def name(choice):
    return "-".join(str(v) for v in choice.values())


def assert_same_for_threads(case, choice, steps):
    states = []
    for threads in (1, 2, 3):
        _core.set_threads(threads)
        states.append(copy_state(run(simulation(case, **choice), steps)))
    assert differing(states[0], states[1]) == []
    assert differing(states[0], states[2]) == []


@pytest.mark.parametrize("choice", CHOICES, ids=name)
def test_same_bits_for_any_number_of_threads(choice):
    assert_same_for_threads(WIDE, choice, 9)


@pytest.mark.parametrize("choice", CHOICES[:1] + CHOICES[4:5], ids=name)
def test_same_bits_for_any_number_of_threads_in_three_dimensions(choice):
    assert_same_for_threads(DEEP, choice, 8)


@pytest.mark.parametrize("choice", CHOICES, ids=name)
@pytest.mark.parametrize("looked_at", [False, True], ids=["", "after-a-frame"])
def test_taken_up_from_its_state_bit_for_bit(choice, looked_at):
    """At several places, before and after a remeshing; whether or not somebody asked for a frame and a sample."""
    whole = simulation(DAM_BREAK, **choice)
    states = {}
    for step in range(18):
        if step in (3, 7, 12):
            if looked_at:
                whole.frame()
                whole.sample()
            states[step] = copy_state(whole)
        whole.advance(1e3)
    end = copy_state(whole)
    for step, state in states.items():
        again = run(simulation(DAM_BREAK, **choice), 2)  # whatever it did before is forgotten
        again.restore(state)
        assert differing(copy_state(again), state) == []
        assert differing(copy_state(run(again, 18 - step)), end) == []


@pytest.mark.parametrize("scheme", ["houle", "jh2020"])
def test_looking_changes_nothing(scheme):
    one, other = (simulation(DAM_BREAK, numerics__scheme=scheme) for _ in range(2))
    for _ in range(6):
        run(one, 1)
        run(other, 1)
        one.frame()
        one.sample()
    assert differing(copy_state(one), copy_state(other)) == []


def test_a_gate_opens_at_the_same_time_after_a_restart():
    gated = {**DAM_BREAK, "gate": [{"x": 0.14, "speed": 1.5}]}
    whole = run(simulation(gated), 4)
    again = simulation(gated)
    again.restore(copy_state(whole))
    assert differing(copy_state(run(whole, 5)), copy_state(run(again, 5))) == []
    assert np.any(whole.flow.boundaries.open_faces[0] == 0.0)


FORK = """
    import os, sys, threading, time
    sys.path[:0] = [{here!r}, {above!r}]
    from situations import DAM_BREAK, run, simulation
    from houle import _core

    WIDE = {{**DAM_BREAK, "domain": {{"size": [0.4, 0.24], "spacing": 0.01}}}}
    _core.set_threads(2)
    other, busy = simulation(WIDE), threading.Event()

    def compute():
        while True:
            other.advance(other.time + 1e-3)
            busy.set()

    threading.Thread(target=compute, daemon=True).start()
    busy.wait()
    for k in range(12):
        child = os.fork()
        if child == 0:
            assert _core.get_threads() == 1
            _core.set_threads(1 + k % 3)
            run(simulation(WIDE), 3)
            os._exit(0)
        for _ in range(1500):
            done, status = os.waitpid(child, os.WNOHANG)
            if done:
                break
            time.sleep(0.01)
        else:
            os.kill(child, 9)
            os.waitpid(child, 0)
            print("child", k, "hangs")
            continue
        print("child", k, "ends with", status)
    os._exit(0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_child_forked_while_another_thread_computes_does_not_hang():
    """It has none of the threads of its parent, and computes on its own."""
    here = Path(__file__).parent
    script = textwrap.dedent(FORK).format(here=str(here), above=str(here.parent))
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", script], capture_output=True, text=True)
    assert done.stdout.splitlines() == [f"child {k} ends with 0" for k in range(12)], done.stderr
