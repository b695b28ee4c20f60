"""Every part of a run owns its state: nothing that the next step depends on is left out of a checkpoint.

Two simulations, one that ran through and one that was restored, are compared in all that can be reached from them.
"""

from __future__ import annotations

import types
from collections.abc import Mapping
from functools import partial
from typing import Any
from weakref import ReferenceType

import numpy as np
import pytest

from houle import load
from houle.case.build import build
from houle.flow.boundaries import Boundary
from houle.flow.component import Component
from houle.flow.simulation import Simulation
from houle.flow.workspace import Workspace

PASSED = (Workspace, types.FunctionType, types.MethodType, types.ModuleType, type, partial, ReferenceType)
SECONDS = "seconds"  # of the ledger: what operations took in this process
FLUME: dict[str, Any] = {
    "case": {"name": "flume"},
    "domain": {"size": [3.2, 0.6], "spacing": 0.04},
    "water": [{"below": 0.4}],
    "porous": [{"name": "rock", "box": [[1.6, 0.0], [2.0, 0.3]], "porosity": 0.5, "resistance": {"a": 1.0, "b": 20.0}}],
    "gate": [{"x": 1.2, "speed": 0.5, "start": 0.05}],
    "waves": {"kind": "regular", "height": 0.06, "period": 1.6, "depth": 0.4, "piston": {"x": 0.4, "absorb": True}},
    "absorber": [{"x": 2.8}],
    "sponge": [{"box": [[2.4, 0.0], [3.2, 0.6]], "strength": 3.0}],
    "overtopping": [{"x": 1.8, "level": 0.3}],
    "gauge": [{"x": 1.0}],
    "numerics": {"remesh_every": 3},
    "time": {"end": 100.0},
}
CHANNEL = {
    **{key: FLUME[key] for key in ("case", "domain", "water", "porous", "gate", "overtopping", "gauge", "time")},
    "open": [{"side": "left", "velocity": 0.2, "ramp": 0.1}, {"side": "right", "level": 0.38}],
    "numerics": {"transfer": "apic", "remesh_every": 3},
}
ZONE = {
    **{key: FLUME[key] for key in ("case", "domain", "water", "porous", "gate", "sponge", "time")},
    "waves": {"kind": "solitary", "height": 0.05, "depth": 0.4, "zone": {"x": [0.0, 1.0]}},
    "open": [{"side": "left", "level": 0.4}],
    "numerics": {"transfer": "flip", "kernel": "quadratic", "remesh_every": 3},
    "fluid": {"smagorinsky": 0.15},
}
SOURCE = {
    **{key: FLUME[key] for key in ("case", "domain", "water", "gate", "absorber", "time")},
    "waves": {**{k: FLUME["waves"][k] for k in ("kind", "height", "period", "depth")},
              "source": {"x": 0.8, "width": 0.8, "form": "linear"}},
}  # fmt: skip
RISING = {
    "case": {"name": "rising"},
    "domain": {"size": [0.4, 2.0], "spacing": 0.04},
    "water": [{"below": 0.2}, {"box": [[0.08, 0.2], [0.2, 0.4]], "velocity": [0.0, 5.0]}],
    "gate": [{"x": 0.2, "speed": 0.5}],
    "numerics": {"remesh_every": 3},
    "time": {"end": 100.0},
}
TANKS = {"walls": FLUME, "sides": CHANNEL, "zone": ZONE, "source": SOURCE, "rising": RISING}


def differences(one: Any, other: Any, place: str = "simulation", seen: set[int] | None = None) -> list[str]:
    """Where two objects, and all that can be reached from them, are not the same to the last bit."""
    seen = set() if seen is None else seen
    if isinstance(one, PASSED) or id(one) in seen:
        return []
    if type(one) is not type(other):
        return [f"{place}: {type(one).__name__}, {type(other).__name__}"]
    if isinstance(one, np.ndarray | np.generic | float | int | str | bytes | bool | None):
        same = np.asarray(one).tobytes() == np.asarray(other).tobytes() and np.shape(one) == np.shape(other)
        return [] if same else [place]
    seen.add(id(one))
    if isinstance(one, Mapping):
        pairs = {f"{place}[{key}]": (one[key], other[key]) for key in one.keys() & other.keys()}
        missing = [f"{place}[{key}]" for key in one.keys() ^ other.keys()]
    elif isinstance(one, list | tuple | set | frozenset):
        pairs = {f"{place}[{i}]": pair for i, pair in enumerate(zip(one, other, strict=False))}
        missing = [place] if len(one) != len(other) else []
    elif type(one).__module__.startswith(("houle", "physics", "test_")) and hasattr(one, "__dict__"):
        both = vars(one).keys() & vars(other).keys() - {SECONDS}  # what is only in one has been computed when asked for
        pairs, missing = {f"{place}.{name}": (vars(one)[name], vars(other)[name]) for name in sorted(both)}, []
    else:
        return []
    return missing + [text for at, (a, b) in pairs.items() for text in differences(a, b, at, seen)]


def after_a_stop(setup: Any, before: int, after: int) -> list[str]:
    """Where a run that was restored after so many steps differs from one that went on, so many steps later."""
    whole = Simulation(setup, 1)
    for _ in range(before):
        whole.advance(100.0)
    state = {key: np.array(value) for key, value in whole.state().items()}
    again = Simulation(setup, 1)
    again.restore(state)
    for _ in range(after):
        whole.advance(100.0)
        again.advance(100.0)
    return sorted(differences(whole, again))


@pytest.mark.parametrize("after", [1, 7])
@pytest.mark.parametrize("tank", TANKS)
def test_a_run_that_goes_on_has_everything_that_it_had(tank, after):
    """One step later and seven, in tanks with every kind of boundary and observer that has a memory."""
    assert after_a_stop(build(load(TANKS[tank])), 14, after) == []


def test_the_rising_water_has_got_more_rows_by_then():
    sim = Simulation(build(load(RISING)), 1)
    rows = sim.flow.grid.shape[-1]
    for _ in range(14):
        sim.advance(100.0)
    assert sim.flow.grid.shape[-1] > rows


class Forgetful(Boundary):
    """Counts its steps, and says nothing of it."""

    def __init__(self) -> None:
        self.steps = 0

    def begin(self, tank, dt):
        self.steps += 1


class Mindful(Forgetful):
    def state(self):
        return {"steps": np.array(self.steps)}

    def restore(self, state):
        self.steps = int(state["steps"])


def test_a_boundary_that_forgets_its_state_is_found():
    """A new kind in a tank: what it does not answer is what two simulations differ in."""
    setup = build(load(RISING))
    for kind, expected in ((Forgetful, ["simulation.flow.boundaries.entries[1].steps"]), (Mindful, [])):
        with_it = type(setup)(**{**vars(setup), "boundaries": (*setup.boundaries, lambda *_, kind=kind: kind())})
        assert after_a_stop(with_it, 4, 2) == expected


def test_the_parts_of_a_simulation_answer_in_its_tree():
    """Each part by its name; what does not answer is no part."""
    sim = Simulation(build(load({**FLUME, "overtopping": [{"x": 0.5}]})), 1)
    sim.advance(100.0)
    names = {key.rpartition("/")[0] for key in sim.state()}
    assert names >= {"flow", "flow/particles", "flow/boundaries/0", "flow/boundaries/1", "flow/boundaries/1/command",
                     "ledger", "step/remeshing", "observers/overtopping"}  # fmt: skip

    class Silent(Component):
        def parts(self):
            return {"mute": object()}

    with pytest.raises(AttributeError, match="state"):
        Silent().state()
