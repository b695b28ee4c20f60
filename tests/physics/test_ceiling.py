"""A run keeps the rows of cells that the water is in: more when it rises, and nobody can tell from the results."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import houle.case.build
from physics.situations import copy_state, differing, run, simulation

# a block of water thrown up beside a porous block: it rises by 26 cells
THROWN: dict[str, Any] = {
    "case": {"name": "thrown"},
    "domain": {"size": [0.4, 1.2], "spacing": 0.02},
    "water": [
        {"below": 0.06},
        {"box": [[0.1, 0.06], [0.2, 0.2]], "velocity": [0.0, 3.2]},
    ],
    "porous": [{"name": "rock", "box": [[0.2, 0.0], [0.3, 0.1]], "porosity": 0.5, "resistance": {"a": 1.0, "b": 20.0}}],
    "sensor": [{"name": "P", "at": [0.35, 0.03]}],
    "gauge": [{"name": "G", "x": 0.15}],
    "time": {"end": 1.0},
}


def test_rows_follow_the_water_and_results_have_the_whole_domain():
    sim = simulation(THROWN)
    rows = sim.flow.grid.shape[-1]
    assert rows < 25 < 60 == sim.grid.shape[-1]
    seen = {rows}
    for _ in range(120):
        run(sim, 1)
        seen.add(sim.flow.grid.shape[-1])
        top = sim.particles.position[:, -1].max() / sim.grid.spacing[-1]
        assert top < sim.flow.grid.shape[-1] - 7
        frame = sim.frame()
        assert frame.cell_fill.shape == frame.cell_porosity.shape == sim.grid.shape
    assert len(seen) > 2 and max(seen) <= 60
    assert frame.cell_porosity[12, 2] == 0.5 and np.all(frame.cell_porosity[:, 6:] == 1.0)


def test_the_same_flow_as_on_the_whole_grid(monkeypatch: pytest.MonkeyPatch):
    """Up to the tolerance of the solver, whose multigrid has other levels."""
    tight = {"numerics__tolerance": 1e-11}
    low = run(simulation(THROWN, **tight), 25)
    monkeypatch.setattr(houle.case.build, "first_rows", lambda case: 60)
    whole = run(simulation(THROWN, **tight), 25)
    assert low.flow.grid.shape[-1] < whole.flow.grid.shape[-1] == 60
    for name in ("position", "velocity"):
        np.testing.assert_allclose(getattr(low.particles, name), getattr(whole.particles, name), rtol=0, atol=1e-7)
    one, other = low.sample(), whole.sample()
    for name in one:
        if "iterations" not in name and name != "divergence":
            np.testing.assert_allclose(one[name], other[name], rtol=1e-6, atol=1e-6, err_msg=name)


def test_a_run_that_stops_before_a_rise_goes_on_bitwise():
    sim = simulation(THROWN)
    rows, states = [], []
    for _ in range(40):
        states.append(copy_state(sim))
        rows.append(sim.flow.grid.shape[-1])
        run(sim, 1)
    rise = next(i for i in range(1, 40) if rows[i] != rows[i - 1])
    for start in (rise - 1, rise, rise + 1):
        other = simulation(THROWN)
        other.restore(states[start])
        assert differing(copy_state(run(other, 40 - start)), copy_state(sim)) == []
