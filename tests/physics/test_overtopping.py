"""Overtopping: what crosses a crest is counted, particle by particle, and nothing else is."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from situations import copy_state, differing, run, simulation

from houle.flow.crest import Crest
from houle.flow.particles import Particles
from houle.flow.remeshers import Conservative
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.shapes import Box

ROCK: dict[str, Any] = {"porosity": 0.45, "grain_diameter": 0.04, "resistance": {"law": "van-gent-1995"}}
EXACT = 1e-14  # m2: round-off of the volumes of some thousand particles
CREST = 0.42  # m


def flume(**tables: Any):
    """A tank of 2.4 x 0.72 m, cells of 0.03 m; what is in it comes with `tables`."""
    case: dict[str, Any] = {
        "case": {"name": "flume"},
        "domain": {"size": [2.4, 0.72], "spacing": 0.03},
        "time": {"end": 100.0},
    }
    return simulation({**case, **tables})


def breakwater(slope: list[list[float]], **tables: Any):
    """A rubble mound with an L-shaped crown wall, whose base stands on its pores: to 0.33 m, crest at 0.42 m.

    The water lies on a slope [[x, z], ...] and sloshes.
    """
    crown = [[1.2, 0.33], [1.44, 0.33], [1.44, 0.36], [1.275, 0.36], [1.275, CREST], [1.2, CREST]]
    mound = [[0.75, 0.0], [1.155, 0.39], [1.2, 0.39], [1.2, 0.33], [1.44, 0.33], [1.77, 0.0]]
    sections = [(1.2375, CREST), (1.35, 0.36), (1.35, CREST), (1.155, CREST), (1.5, 0.36), (1.8, 0.36)]
    return flume(
        solid=[{"name": "crown", "polygon": crown}],
        porous=[{"name": "mound", "polygon": mound, **ROCK}],
        water=[{"polygon": [[0.0, 0.0], *slope, [2.4, 0.0]]}],
        overtopping=[{"x": x, "level": level} for x, level in sections] + [{"x": x} for x, _ in sections],
        **tables,
    )


def behind(sim: Any, x: float) -> float:
    """Water beyond x [m^d]."""
    return float(sim.particles.volume[sim.particles.position[:, 0] > x].sum())


def test_a_section_that_nothing_overtops_counts_exactly_nothing():
    """Waves slosh below the crest, under the base of the wall and through the pores, which are partly filled there:
    what seeps through each section is the change of the water behind it to round-off."""
    sim = breakwater([[0.0, 0.345], [2.4, 0.235]])
    sections = [crest.x for crest in sim.flow.crests[:6]]
    before, highest = np.array([behind(sim, x) for x in sections]), 0.0
    while sim.time < 5.0:
        run(sim, 20)
        highest = max(highest, sim.particles.position[:, 1].max())
    above, everything = np.split(sim.sample()["overtopping_volume"], 2)
    seeped = np.array([behind(sim, x) for x in sections]) - before
    assert 0.33 < highest < 0.36
    assert above.tolist() == [0.0] * 6
    assert np.abs(seeped).min() > 1e-3
    assert everything == pytest.approx(seeped, abs=EXACT)


def wall(mirrored: bool = False, **tables: Any):
    """A wall, two cells thick, off the lines of the grid, in front of a tank; a column of water falls over it."""
    box = [[1.387, 0.0], [1.447, CREST]]
    water = [
        {"box": [[0.0, 0.0], [0.6, 0.6]]},
        {"box": [[0.0, 0.0], [1.387, 0.3]]},
        {"box": [[1.447, 0.0], [2.4, 0.1]]},
    ]
    if mirrored:
        box = [[2.4 - box[1][0], 0.0], [2.4 - box[0][0], CREST]]
        water = [{"box": [[2.4 - b["box"][1][0], 0.0], [2.4 - b["box"][0][0], b["box"][1][1]]]} for b in water]
    x, to = (1.0, "left") if mirrored else (1.4, "right")
    crests = [{"x": x, "level": CREST, "to": to}, {"x": x, "to": to}, {"x": x, "level": 0.5, "to": to}]
    return flume(solid=[{"name": "wall", "box": box}], water=water, overtopping=crests, **tables)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    "numerics", [{}, {"transfer": "flip"}, {"scheme": "jh2020", "remesh": "conservative"}], ids=["houle", "flip", "jh"]
)
def test_the_tank_behind_a_wall_holds_what_was_counted(numerics, mirrored):
    """To round-off at every instant, back and forth, through remeshings and corrections."""
    sim = wall(mirrored, numerics=numerics)
    tank = (lambda: sim.particles.total_volume - behind(sim, 1.0)) if mirrored else (lambda: behind(sim, 1.4))
    first, rates, steps = tank(), [], []
    while sim.time < 1.3:
        run(sim, 1)
        sample = sim.sample()
        rates.append(sample["overtopping_discharge"])
        steps.append(sim.step_size)
        assert sample["overtopping_volume"][:2] == pytest.approx(tank() - first, abs=EXACT)
    over = sample["overtopping_volume"]
    assert over[0] > 0.01
    assert 0.0 < over[2] < over[0]
    assert np.array(steps) @ np.array(rates) == pytest.approx(over, abs=EXACT)


def test_what_a_paper_remeshing_makes_up_is_not_counted():
    """It adds water on both sides of a wall; none of it comes over."""
    sim = flume(
        solid=[{"name": "wall", "box": [[1.387, 0.0], [1.447, CREST]]}],
        water=[
            {"polygon": [[0.0, 0.0], [0.0, 0.3], [1.387, 0.2], [1.387, 0.0]]},
            {"polygon": [[1.447, 0.0], [1.447, 0.15], [2.4, 0.25], [2.4, 0.0]]},
        ],
        overtopping=[{"x": 1.4, "level": CREST}, {"x": 1.4}],
        numerics={"scheme": "jh2020", "remesh": "paper", "remesh_every": 5},
    )
    first = behind(sim, 1.4)
    run(sim, 10**6, until=0.6)
    assert abs(behind(sim, 1.4) - first) > 1e-3
    assert sim.sample()["overtopping_volume"].tolist() == [0.0, 0.0]


def test_the_tank_in_3d():
    """A wall with a lower half: each counts from its own crest up."""
    sim = simulation(
        {
            "case": {"name": "weir"},
            "domain": {"size": [0.8, 0.2, 0.4], "spacing": 0.04},
            "solid": [
                {"name": "low", "box": [[0.43, 0.0, 0.0], [0.53, 0.2, 0.11]]},
                {"name": "high", "box": [[0.43, 0.09, 0.0], [0.53, 0.2, 0.25]]},
            ],
            "water": [{"box": [[0.0, 0.0, 0.0], [0.3, 0.2, 0.33]]}],
            "overtopping": [{"x": 0.48}, {"x": 0.48, "level": 0.11}, {"x": 0.48, "level": 0.25}],
            "time": {"end": 10.0},
        }
    )
    run(sim, 10**6, until=0.8)
    over = sim.sample()["overtopping_volume"]
    assert over[0] == pytest.approx(behind(sim, 0.48), abs=EXACT)
    assert over[1] == pytest.approx(over[0], abs=EXACT)
    assert over[0] > 0.002
    assert 0.0 <= over[2] < over[0]


def test_a_tank_with_an_open_end_counts_what_came_over():
    """The water behind a weir and what has left through the side."""
    sim = flume(
        solid=[{"name": "weir", "box": [[1.2, 0.0], [1.29, 0.21]]}],
        water=[{"box": [[0.0, 0.0], [1.2, 0.24]]}, {"box": [[1.29, 0.0], [2.4, 0.1]]}],
        open=[{"side": "left", "discharge": 0.05}, {"side": "right", "level": 0.1}],
        overtopping=[{"x": 1.245, "level": 0.21}],
    )
    first = behind(sim, 1.245)
    run(sim, 10**6, until=2.0)
    left = sim.flow.boundaries[1].went - sim.flow.boundaries[1].came
    assert left > 1e-3
    assert sim.sample()["overtopping_volume"][0] == pytest.approx(behind(sim, 1.245) + left - first, abs=EXACT)


def test_counting_goes_on_after_a_restart_to_the_last_bit():
    water = [[0.0, 0.55], [0.9, 0.2], [2.4, 0.24]]
    one, other = breakwater(water), breakwater(water)
    run(one, 60)
    again = breakwater(water)
    again.restore(copy_state(run(other, 30)))
    run(again, 30)
    assert one.sample()["overtopping_volume"].any()
    assert differing(copy_state(one), copy_state(again)) == []


# ---- one section, particle by particle -------------------------------------------------------------------------------


def section(level: float | None, *solids: Box, right: bool = True) -> Crest:
    """At x = 0.5 in a tank of 1 x 1 m with cells of 0.1 m."""
    grid = Grid(shape=(10, 10), spacing=(0.1, 0.1), periodic=(False, False))
    return Crest(grid, Medium.build(grid, [], list(solids)), 0.5, level, right)


WAYS = {  # from, to, what a crest at 0.5 m counts of a volume of 1, in the open and over a wall from 0.45 to 0.55 m
    "over it": ([0.4, 0.7], [0.6, 0.6], 1.0, 1.0),
    "back": ([0.6, 0.7], [0.4, 0.7], -1.0, -1.0),
    "below it": ([0.44, 0.3], [0.56, 0.3], 0.0, 1.0),
    "up through it": ([0.49, 0.4], [0.51, 0.7], 1.0, 1.0),
    "past a corner": ([0.44, 0.52], [0.56, 0.4], 0.0, 1.0),
    "not across": ([0.4, 0.7], [0.49, 0.2], 0.0, 0.0),
}


@pytest.mark.parametrize("way", WAYS)
def test_a_way_counts_by_the_height_at_which_it_crosses(way):
    """In the open; where a wall stands on the floor it can only have gone over it."""
    start, end, free, over_wall = WAYS[way]
    wall_ = Box((0.45, 0.0), (0.55, 0.5))
    for crest, expected in ((section(0.5), free), (section(0.5, wall_), over_wall)):
        crest.moved(np.array([start]), np.array([end]), np.array([1.0]))
        assert crest.passed == expected
    other = section(0.5, right=False)
    other.moved(np.array([start]), np.array([end]), np.array([1.0]))
    assert other.passed == -free


def test_under_a_slab_and_over_it():
    """A way through a slab that hangs between 0.4 and 0.5 m went around its nearer end."""
    for height, expected in ((0.3, 0.0), (0.41, 0.0), (0.49, 1.0), (0.6, 1.0)):
        crest = section(0.5, Box((0.45, 0.4), (0.55, 0.5)))
        crest.moved(np.array([[0.44, height]]), np.array([[0.56, height]]), np.array([1.0]))
        assert crest.passed == expected, height


def test_remeshing_is_booked_as_it_moves_water():
    """The change of the water of a random cloud behind the section is booked to round-off, above and below the level
    together; nothing where there is no water above it."""
    rng = np.random.default_rng(3)
    grid = Grid(shape=(10, 10), spacing=(0.1, 0.1), periodic=(False, False))
    medium = Medium.build(grid)
    x = rng.uniform(0.0, 1.0, (1500, 2)) * [1.0, 0.7]
    cloud = Particles(x, np.zeros_like(x), rng.uniform(0.5, 1.5, 1500) * 0.7 / 1500)
    remesh = Conservative.of(grid, medium)
    new = remesh(cloud, None)
    change = new.volume[new.position[:, 0] > 0.53].sum() - cloud.volume[x[:, 0] > 0.53].sum()
    assert abs(change) > 1e-4
    booked = {}
    for level in (None, 0.0, 0.4, 0.69, 0.7):
        crest = Crest(grid, medium, 0.53, level, True)
        marks = crest.marks(cloud.position)
        if marks is not None:
            crest.handed(new.position, new.volume, remesh(Particles(x, marks, cloud.volume), None).velocity)
        booked[level] = crest.passed
    assert booked[None] == booked[0.0] == pytest.approx(change, abs=1e-15)
    assert abs(booked[0.4]) > 0.0 and booked[0.4] != booked[None]
    assert booked[0.7] == 0.0
