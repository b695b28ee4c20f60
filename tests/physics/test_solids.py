"""Water about solids whose corners lie anywhere on the grid: none of it inside, at rest and when it strikes them."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from situations import simulation

from houle.medium.shapes import Union

SPIKE = [[0.33, 0.0], [0.47, 0.0], [0.39, 0.11]]
STEPS = {"2D": {"box": [[0.313, 0.0], [0.487, 0.067]]}, "spike": {"polygon": SPIKE}}
BLOCK = {"box": [[0.313, 0.057, 0.0], [0.437, 0.143, 0.067]]}
DEEP = {"domain": {"size": [0.6, 0.2, 0.3], "spacing": 0.02}, "solid": [BLOCK]}
FLAT = {"domain": {"size": [0.6, 0.3], "spacing": 0.02}}
CASES = {**{k: {**FLAT, "solid": [s]} for k, s in STEPS.items()}, "3D": DEEP}


def case(name, water):
    corners = [[0.0] * len(CASES[name]["domain"]["size"]), [water[0], 0.2, water[1]]]
    if name != "3D":
        corners[1] = list(water)
    return {"case": {"name": "solids"}, "time": {"end": 1.0}, "water": [{"box": corners}], **CASES[name]}


def depth_inside(sim):
    solid = Union(sim.setup.solids)
    return -solid.distance(sim.particles.position).min()


@pytest.mark.parametrize("name", sorted(CASES))
def test_no_water_enters_a_solid_that_it_strikes(name):
    """Through motion, position correction and remeshing, to 1e-9 of a cell."""
    sim = simulation(case(name, (0.2, 0.2)), numerics__remesh_every=5)
    remeshed = 0
    while sim.time < 0.45:
        sim.advance(0.45)
        remeshed += sim.step.remeshing.count == 0
        assert depth_inside(sim) < 1e-9 * 0.02
    assert remeshed > 5
    assert (sim.particles.position[:, 0] > 0.5).any(), "some went over it"


@pytest.mark.parametrize(("name", "speed"), [("2D", 1e-8), ("spike", 1e-3), ("3D", 1e-3)])
def test_water_over_a_solid_starts_outside_it_and_rests(name, speed):
    """The water of a half cell round a corner has its centre in the solid; volume and centre are kept all the same.

    It rests to round-off where the exact levels of the columns do (theory: not on slopes, nor round corners in 3D).
    """
    sim = simulation(case(name, (0.6, 0.16)), numerics__tolerance=1e-10)
    p = sim.particles
    assert depth_inside(sim) < 0.0
    water, solid = shapely.box(0.0, 0.0, 0.6, 0.16), sim.flow.medium.solids[0]  # the tip of the spike is thickened
    width, taken = (0.2, 0.143 - 0.057) if name == "3D" else (1.0, 1.0)
    stands = solid.section((0.0, 0.0, 0.6, 0.3))
    volume = width * water.area - taken * stands.area
    assert p.total_volume == pytest.approx(volume, rel=1e-12)
    for axis, part in ((0, "x"), (-1, "y")):
        moments = [
            share * getattr(shape.centroid, part) * shape.area for share, shape in ((width, water), (taken, stands))
        ]
        assert p.volume @ p.position[:, axis] == pytest.approx(moments[0] - moments[1], rel=1e-12)
    for _ in range(20):
        sim.advance(1.0)
        assert np.abs(sim.particles.velocity).max() < speed


def test_shorter_steps_do_not_push_more():
    """Dam break on a block, in the section of SPHERIC benchmark 2: pressure times time near its foot over 0.1 s.

    While the velocities of closed faces carried water into the block it was 20 % more with steps a quarter as long.
    """
    impact = {
        "case": {"name": "impact"},
        "domain": {"size": [3.22, 1.0], "spacing": 0.04},
        "water": [{"box": [[1.992, 0.0], [3.22, 0.55]]}],
        "solid": [{"box": [[0.6635, 0.0], [0.8245, 0.161]]}],
        "sensor": [{"at": [0.825, 0.021]}],
        "time": {"end": 0.6},
    }
    push = []
    for courant in (0.5, 0.125):
        sim, start, total = simulation(impact, time__courant=courant), None, 0.0
        while start is None or sim.time < start + 0.1:
            sim.advance(0.6)
            pressure = sim.sample()["pressure"][0]
            start = sim.time if start is None and pressure > 500.0 else start
            total += pressure * sim.step_size
        push.append(total)
    assert push[1] < 1.05 * push[0]
