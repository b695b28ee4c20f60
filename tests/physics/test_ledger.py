"""The ledger: what the operations did to the energy adds up to what happened, and drag and viscosity only take."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from situations import DAM_BREAK, run, simulation

from houle.flow.ledger import OPERATIONS
from houle.flow.surface import arrange

CHOICES = list(itertools.product(("houle", "jh2020"), ("fmpm", "flip", "pic", "apic")))


def energy(sim):
    return sim.flow.kinetic_energy() + sim.flow.potential_energy()


@pytest.mark.parametrize(("scheme", "transfer"), CHOICES)
@pytest.mark.parametrize("looked_at", [False, True], ids=["", "after-frames"])
def test_the_operations_add_up(scheme, transfer, looked_at):
    """Kinetic + potential energy at the end less that at the start, to round-off, frames being written or not."""
    sim = simulation(
        DAM_BREAK, numerics__scheme=scheme, numerics__transfer=transfer, numerics__remesh_every=6,
        numerics__remesh="conservative",
    )  # fmt: skip
    start = energy(sim)
    for _ in range(20):
        run(sim, 1)
        if looked_at:
            sim.frame()
    change = energy(sim) - start
    assert sum(sim.ledger.energy.values()) == pytest.approx(change, abs=1e-13 * abs(start) * 20)
    assert set(sim.ledger.energy) == set(OPERATIONS) and sim.ledger.energy["exchange"] == 0.0  # no side is open
    assert abs(change) > 1e-3 * abs(start)


def test_a_dam_break_turns_potential_into_kinetic_energy_and_drag():
    """Nothing makes energy: what is left, and what the drag has taken, is no more than there was."""
    sim = simulation(DAM_BREAK)
    start = energy(sim)
    run(sim, 60)
    assert sim.ledger.drag_work > 0.0 and sim.ledger.viscous_work >= 0.0
    assert energy(sim) + sim.ledger.drag_work <= start * (1 + 1e-3)
    row = sim.sample()
    assert row["drag_work"] == pytest.approx(1000.0 * sim.ledger.drag_work)
    assert row["kinetic_energy"] + row["potential_energy"] == pytest.approx(1000.0 * energy(sim), rel=1e-12)


def test_gravity_alone_does_its_work():
    """A block of water in free fall: forces book m v^2/2 of the middle of the step, advection m g h of its end."""
    sim = simulation(
        {
            "case": {"name": "fall"},
            "domain": {"size": [0.2, 0.6], "spacing": 0.02},
            "water": [{"box": [[0.06, 0.4], [0.14, 0.5]]}],
            "time": {"end": 1.0, "step": 0.002},
            "numerics": {"remesh": "none", "correction": 0.0},
        }
    )
    run(sim, 50)
    volume, middle = sim.particles.total_volume, sim.time - 0.5 * sim.step_size
    work, fall = (0.5 * volume * (9.81 * t) ** 2 for t in (middle, sim.time))
    assert sim.flow.kinetic_energy() == pytest.approx(work, rel=1e-3)
    assert sim.ledger.energy["advection"] == pytest.approx(-fall, rel=1e-3)
    assert sim.ledger.energy["forces"] + sim.ledger.energy["projection"] == pytest.approx(work, rel=1e-3)
    assert abs(sim.ledger.energy["transfer"]) < 1e-6 * work


def test_the_mean_level_counts_no_air_under_overhanging_water():
    """A slab of water 0.16 m above the pool, over rock and beside it: the air between is no water."""
    slab = {"box": [[0.1, 0.2], [0.3, 0.26]]}
    rock = {"name": "rock", "box": [[0.2, 0.0], [0.4, 0.3]], "porosity": 0.5}
    case = {
        "case": {"name": "overhang"},
        "domain": {"size": [0.4, 0.32], "spacing": 0.02},
        "water": [{"below": 0.04}, slab],
        "porous": [{**rock, "resistance": {"a": 1.0, "b": 1.0}}],
        "time": {"end": 1.0},
    }
    sim = simulation(case)
    row = sim.sample()
    assert float(row["mean_level"]) == pytest.approx(float(row["volume"]) / 0.4, abs=0.1 * 0.02)


@pytest.mark.parametrize("front", [0.16, 0.1672, 0.17, 0.1749])
def test_the_mean_level_of_a_column_does_not_depend_on_where_in_a_cell_its_front_stands(front):
    """Water 0.3 m high and one cell in thirty too wide would raise the level by 15 mm x 0.3 / 0.6."""
    case = {
        "case": {"name": "front"},
        "domain": {"size": [0.6, 0.4], "spacing": 0.02},
        "water": [{"box": [[0.0, 0.0], [front, 0.3]]}, {"below": 0.03}],
        "time": {"end": 1.0},
    }
    row = simulation(case).sample()
    assert float(row["mean_level"]) == pytest.approx(float(row["volume"]) / 0.6, abs=0.01 * 0.02)


POOL = {"case": {"name": "pool"}, "domain": {"size": [0.4, 0.4], "spacing": 0.02}, "time": {"end": 1.0}}
HOLED = [[[0.0, 0.0], [0.4, 0.1]], [[0.0, 0.1], [0.2, 0.12]], [[0.22, 0.1], [0.4, 0.12]], [[0.0, 0.12], [0.4, 0.2]]]
SHEET = [[[0.0, 0.0], [0.4, 0.1]], [[0.1, 0.24], [0.3, 0.25]], [[0.1, 0.3], [0.11, 0.31]]]


@pytest.mark.parametrize("boxes", [HOLED, SHEET], ids=["bubble", "sheet and drop"])
def test_the_mean_level_counts_water_and_no_air_where_they_are_too_thin_for_a_surface(boxes):
    """A bubble of a cell; a sheet and a drop of half a cell."""
    row = simulation({**POOL, "water": [{"box": box} for box in boxes]}).sample()
    assert float(row["mean_level"]) == pytest.approx(float(row["volume"]) / 0.4, abs=0.01 * 0.02)


@pytest.mark.parametrize("density", [0.96, 1.04])
def test_the_mean_level_shows_water_that_is_too_wide_or_too_dense(density):
    """Under a surface three times as steep as wide: each particle with a little less or more than its place holds."""
    sim = simulation({**POOL, "water": [{"polygon": [[0.0, 0.0], [0.12, 0.0], [0.0, 0.36]]}]})
    right = float(sim.sample()["mean_level"])
    assert right == pytest.approx(sim.particles.total_volume / 0.4, abs=0.01 * 0.02)
    sim.particles.volume *= density
    arrange(sim.flow)
    wrong = float(sim.sample()["mean_level"])
    assert wrong - sim.particles.total_volume / 0.4 == pytest.approx((1.0 - density) * right, rel=0.5)


STEEP = {
    "case": {"name": "steep"},
    "domain": {"size": [0.3, 0.2, 0.4], "spacing": 0.02},
    "water": [{"polygon": [[0.0, 0.0], [0.18, 0.0], [0.0, 0.36]]}],
    "solid": [{"box": [[-1.0, -1.0, -1.0], [0.053, 0.107, 0.109]]}],
    "time": {"end": 1.0},
}


def stirred(sim):
    """In one cell of 27 half of the water goes to the next one: as struck water is, and the volume where it was."""
    p = sim.particles
    cell = np.floor(p.position / 0.02).astype(int) % 3
    lacking, crowded = (np.all(cell == where, axis=1) for where in ([1, 1, 1], [2, 1, 1]))
    deep = p.position[:, 2] + 2.0 * p.position[:, 0] < 0.24
    p.volume[lacking & deep] *= 0.5
    p.volume[crowded & deep] *= 1.5
    arrange(sim.flow)
    return sim


def test_the_mean_level_counts_disorder_under_the_surface_as_neither_air_nor_water_in_three_dimensions():
    """About a solid too, whose faces lie between the cells. A bubble of a cell is air."""
    sim = simulation(STEEP)
    plan = float(np.prod(STEEP["domain"]["size"][:2]))
    assert float(sim.sample()["mean_level"]) == pytest.approx(sim.particles.total_volume / plan, abs=0.005 * 0.02)
    stirred(sim)
    assert (sim.flow.fill[sim.flow.active > 0] < 1.0 - 0.5**3).sum() > 10
    assert float(sim.sample()["mean_level"]) == pytest.approx(sim.particles.total_volume / plan, abs=0.005 * 0.02)
    sim.particles.volume[np.all(np.floor(sim.particles.position / 0.02) == [4, 4, 2], axis=1)] *= 1e-9
    arrange(sim.flow)
    assert float(sim.sample()["mean_level"]) == pytest.approx(sim.particles.total_volume / plan, abs=0.005 * 0.02)


@pytest.mark.parametrize("density", [0.96, 1.04])
def test_the_mean_level_shows_stirred_water_that_is_too_wide_or_too_dense(density):
    """By a third at least of what is wrong: two cells in three of this wedge have air around, or a bubble."""
    sim = stirred(simulation(STEEP))
    plan = float(np.prod(STEEP["domain"]["size"][:2]))
    right = float(sim.sample()["mean_level"])
    sim.particles.volume *= density
    arrange(sim.flow)
    wrong = float(sim.sample()["mean_level"])
    assert 0.33 < (wrong - sim.particles.total_volume / plan) / ((1.0 - density) * right) < 1.0
