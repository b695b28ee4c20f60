"""Small cases that the physics tests share, as the tables of a case file."""

from __future__ import annotations

from typing import Any

import numpy as np

from houle import load
from houle.case.build import build
from houle.flow.simulation import Simulation

ROCK = {"porosity": 0.49, "grain_diameter": 0.0159, "resistance": {"law": "van-gent-1995"}}

DAM_BREAK: dict[str, Any] = {
    "case": {"name": "coarse-dam-break"},
    "domain": {"size": [0.4, 0.24], "spacing": 0.02},
    "water": [{"box": [[0.0, 0.0], [0.14, 0.16]]}, {"below": 0.033}],
    "porous": [{"name": "rock", "box": [[0.2, 0.0], [0.3, 0.14]], **ROCK}],
    "time": {"end": 1.0},
}


def simulation(case: dict[str, Any], **overrides: Any) -> Simulation:
    """numerics__order=2 overrides numerics.order."""
    return Simulation(build(load(case, {key.replace("__", "."): value for key, value in overrides.items()})))


def run(sim: Simulation, steps: int, until: float = 1e3) -> Simulation:
    """So many steps, or to this time."""
    while steps > 0 and sim.time < until:
        sim.advance(until)
        steps -= 1
    return sim


def copy_state(sim: Simulation) -> dict[str, np.ndarray]:
    return {key: np.array(value) for key, value in sim.state().items()}


def differing(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> list[str]:
    """The names of what is not the same to the last bit."""
    assert set(one) == set(other)
    return sorted(k for k in one if one[k].astype(float).tobytes() != other[k].astype(float).tobytes())
