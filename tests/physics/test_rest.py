"""Water at rest stays at rest, wherever porous bodies and the level lie, and presses with its depth."""

from __future__ import annotations

import numpy as np
import pytest
from situations import run, simulation

LEVEL = 0.2034  # between the grid lines of 0.01 m
BLOCKS = {
    "aligned": {"box": [[0.2, 0.0], [0.4, 0.3]]},
    "off-the-lattice": {"box": [[0.2037, 0.0], [0.4061, 0.3]]},
    "submerged": {"box": [[0.2, 0.0], [0.4, 0.11]]},
    "45-degrees": {"polygon": [[0.07, 0.0], [0.55, 0.0], [0.31, 0.24]]},
    "45-degrees-submerged": {"polygon": [[0.13, 0.0], [0.47, 0.0], [0.3, 0.17]]},
}


def tank(block, **numerics):
    return {
        "case": {"name": "rest"},
        "domain": {"size": [0.6, 0.3], "spacing": 0.01},
        "water": [{"below": LEVEL}],
        "porous": [{"porosity": 0.49, "grain_diameter": 0.0159, "resistance": {"law": "jensen-2014"}, **block}],
        "sensor": [{"at": [0.1, 0.05]}, {"at": [0.3, 0.05]}, {"at": [0.3, 0.152]}],
        "time": {"end": 1.0},
        "numerics": {"tolerance": 1e-12, **numerics},
    }


@pytest.mark.parametrize("block", BLOCKS)
def test_water_round_a_porous_block_does_not_move(block):
    """Half a second at solver tolerance 1e-12: what is left is the scheme."""
    sim = run(simulation(tank(BLOCKS[block])), 1000, until=0.5)
    fastest, error = max(sim.flow.max_pore_speed()), np.abs(sim.flow.eta - LEVEL).max()
    print(f"{block}: max speed {fastest:.1e} m/s, level {error:.1e} m")
    assert fastest < 1e-9
    assert error < 1e-3 * 0.01
    exact = 1000.0 * 9.81 * (LEVEL - np.array([0.05, 0.05, 0.152]))
    np.testing.assert_allclose(sim.sample()["pressure"], exact, rtol=1e-6)


def test_water_rests_with_its_level_at_the_centres_of_cells():
    """Half of the columns have a pressure cell more than their neighbours, by round-off: nothing may come of it."""
    sim = simulation(
        {
            "case": {"name": "level-at-centres"},
            "domain": {"size": [1.0, 0.34], "spacing": 0.02},
            "water": [{"below": 0.25}],
            "time": {"end": 10.0},
        }
    )
    while sim.time < 1.0:
        sim.advance(1.0)
    assert np.abs(sim.particles.velocity).max() < 1e-6
    assert np.abs(sim.flow.eta - 0.25).max() < 1e-6 * 0.02


@pytest.mark.parametrize("scheme", ["houle", "jh2020"])
@pytest.mark.parametrize("transfer", ["fmpm", "flip", "pic", "apic"])
def test_at_rest_with_every_scheme_and_transfer(scheme, transfer):
    """Without the paper's remeshing, which raises the surface."""
    case = tank(BLOCKS["aligned"], scheme=scheme, transfer=transfer, remesh="conservative", remesh_every=5)
    sim = run(simulation(case), 12)
    assert max(sim.flow.max_pore_speed()) < 1e-9


def test_hydrostatic_pressure_in_a_coarse_tank_in_three_dimensions():
    """Level, pressure to half a per cent, no motion: a porous block and a solid box under water, cells of 5 cm."""
    level = 0.43
    sim = simulation(
        {
            "case": {"name": "rest-3d"},
            "domain": {"size": [0.6, 0.4, 0.6], "spacing": 0.05},
            "water": [{"below": level}],
            "porous": [
                {"box": [[0.2, 0.1, 0.0], [0.4, 0.3, 0.6]], "porosity": 0.4, "resistance": {"a": 1.0, "b": 10.0}}
            ],
            "solid": [{"box": [[0.45, 0.0, 0.0], [0.55, 0.2, 0.2]]}],
            "sensor": [{"at": [0.1, 0.2, z]} for z in (0.05, 0.2, 0.36)] + [{"at": [0.3, 0.2, 0.1]}],
            "time": {"end": 1.0},
            "numerics": {"tolerance": 1e-11},
        }
    )
    run(sim, 15)
    depth = level - np.array([0.05, 0.2, 0.36, 0.1])
    np.testing.assert_allclose(sim.sample()["pressure"], 1000.0 * 9.81 * depth, rtol=5e-3)
    assert max(sim.flow.max_pore_speed()) < 1e-8
    np.testing.assert_allclose(sim.flow.eta, level, atol=1e-6)
