"""A shut gate holds water: what stands or sloshes on one side of it never comes to the other."""

from __future__ import annotations

from math import fsum
from typing import Any

import numpy as np
import pytest
from situations import ROCK, simulation

LEFT = [[0.0, 0.0], [0.48, 0.0], [0.48, 0.24], [0.0, 0.12]]
RIGHT = [[0.48, 0.0], [0.96, 0.0], [0.96, 0.08], [0.48, 0.16]]


def pools(d: int = 2, x: tuple[float, ...] = (0.48,), **more: Any) -> dict[str, Any]:
    """Two that slosh on both sides of gates that stay shut."""
    size, spacing = ([0.96, 0.36], 0.03) if d == 2 else ([0.96, 0.18, 0.36], 0.06)
    walls = {"y": "periodic"} if d == 3 else {}
    return {
        "case": {"name": "pools"},
        "domain": {"size": size, "spacing": spacing, "walls": walls},
        "water": [{"polygon": LEFT}, {"polygon": RIGHT}],
        "gate": [{"x": at, "speed": 1.0, "start": 10.0} for at in x],
        "time": {"end": 0.6},
        **more,
    }


def held(sim: Any) -> list[float]:
    """Water in each room between the gates [m^d]; around a periodic axis the last is the first."""
    p, gates, joined = sim.particles, sim.flow.gates[:, 0], sim.grid.periodic[0]
    rooms = len(gates) + (0 if joined else 1)
    room = np.searchsorted(gates, p.position[:, 0]) % rooms
    return [fsum(p.volume[room == k]) for k in range(rooms)]


BODY = {"name": "body", "box": [[0.48, 0.0], [0.7, 0.3]], **ROCK}
RING = {"size": [0.96, 0.18, 0.36], "spacing": 0.06, "walls": {"x": "periodic"}}
SLOPE = {"polygon": [[0.3, 0.0], [0.96, 0.0], [0.96, 0.2]]}
POOLS = {
    "plain": pools(),
    "3D, periodic in y": pools(3),
    "off the grid lines": pools(x=(0.472,)),
    "two gates": pools(x=(0.48, 0.63)),
    "two gates a cell apart": pools(x=(0.48, 0.51)),
    "a body in front of it": pools(porous=[BODY]),
    "a body off the grid lines": pools(porous=[{**BODY, "box": [[0.45, 0.0], [0.7, 0.3]]}], x=(0.48,)),
    "on a slope": pools(solid=[SLOPE]),
    "around a ring": pools(3, x=(0.24, 0.48), domain=RING),
}


@pytest.mark.parametrize("name", POOLS)
def test_a_shut_gate_holds_the_water_on_both_sides(name):
    """To round-off, though the particles are made anew in every step; 1.6 % crossed in a second."""
    sim = simulation(POOLS[name], numerics__remesh_every=1)
    sim.step.remeshing.travel = 0.0
    before = held(sim)
    while sim.time < sim.case.time.end:
        sim.advance(sim.case.time.end)
    assert held(sim) == pytest.approx(before, rel=1e-12)


@pytest.mark.parametrize("transfer", ["pic", "fmpm", "flip", "apic"])
def test_it_does_with_every_transfer(transfer):
    sim = simulation(pools(), numerics__transfer=transfer)
    before = held(sim)
    while sim.time < 0.6:
        sim.advance(0.6)
    assert held(sim) == pytest.approx(before, rel=1e-12)
