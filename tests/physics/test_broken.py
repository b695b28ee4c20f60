"""A flow that stops being one inside a step ends in a SimulationError there, whatever broke and wherever: never in
a killed process, nor in a run that goes on.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from situations import DAM_BREAK, run, simulation

import houle.flow.step
from houle.errors import SimulationError

OPERATIONS = ("move", "correct_positions", "exchange", "arrange")
NAMES = ("position", "velocity", "volume")
NOT_NUMBERS = (np.nan, np.inf, -np.inf)
SETTINGS = (
    {},
    {"numerics__transfer": "flip", "numerics__kernel": "gaussian"},
    {"numerics__transfer": "apic", "numerics__kernel": "quadratic"},
    {"numerics__transfer": "pic", "numerics__kernel": "m4prime", "numerics__remesh": "paper"},
    {"numerics__remesh": "none", "numerics__order": 1},
    {"numerics__scheme": "jh2020"},
)
IN_3D = {
    **DAM_BREAK,
    "domain": {"size": [0.2, 0.06, 0.16], "spacing": 0.02, "walls": {"y": "periodic"}},
    "water": [{"box": [[0.0, 0.0, 0.0], [0.08, 0.06, 0.1]]}],
    "porous": [],
    "gauge": [],
}


def broken(monkeypatch, case, operation, name, value, settings):
    """Runs five steps, then three in which `name` of some particles becomes `value` after that operation."""
    sim = run(simulation(case, numerics__remesh_every=2, **settings), 5)
    if operation == "move" and "numerics__scheme" in settings:
        operation = "drift"  # the paper's
    real = getattr(houle.flow.step, operation)

    def then_spoil(flow, *arguments):
        result = real(flow, *arguments)
        getattr(flow.particles, name)[len(flow.particles) // 2 :: 7, ...] = value
        return result

    monkeypatch.setattr(houle.flow.step, operation, then_spoil)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # NumPy's, on the way to the end
        run(sim, 3)


@pytest.mark.parametrize("settings", SETTINGS, ids=str)
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("operation", OPERATIONS)
def test_what_is_no_number_ends_the_run(monkeypatch, operation, name, settings):
    for value in NOT_NUMBERS if operation == "move" else (np.nan,):
        with pytest.raises(SimulationError):
            broken(monkeypatch, DAM_BREAK, operation, name, value, settings)
        monkeypatch.undo()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("operation", ["move", "correct_positions"])
def test_in_3d_as_well(monkeypatch, operation, name):
    with pytest.raises(SimulationError):
        broken(monkeypatch, IN_3D, operation, name, np.nan, {})


@pytest.mark.parametrize("value", [1e300, -1e300, 1e9, -1e9])
@pytest.mark.parametrize("name", NAMES)
def test_huge_numbers_end_the_run(monkeypatch, name, value):
    """Also those that are numbers: no water is a thousand million metres away, or as fast, or as much, or lacking."""
    with pytest.raises(SimulationError):
        broken(monkeypatch, DAM_BREAK, "correct_positions", name, value, {})
