"""Water that falls through porous bodies, is thrown into them and leaves them: no energy is made at a face."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from situations import simulation

from houle.errors import SimulationError

FREE = {"a": 0.0, "b": 0.0}


def falling(porosity: float, edge: float, drag: dict[str, Any] | None = None) -> dict[str, Any]:
    """A block of water 0.09 m above the floor, half of it in a body whose right face is at `edge`."""
    resistance = drag or {"resistance": FREE}
    return {
        "case": {"name": "falling-through"},
        "domain": {"size": [1.5, 0.5], "spacing": 0.025},
        "water": [{"box": [[0.7, 0.09], [1.36, 0.25]]}],
        "porous": [{"box": [[0.55, 0.0], [edge, 0.37]], "porosity": porosity, **resistance}],
        "time": {"end": 0.4},
    }


def energies(sim, until=None, most=3000):
    """Kinetic and total energy after every step, over what there was at the start above the lowest state."""
    rows, end = [], until or sim.setup.time.end
    there = sim.budget.available(sim.flow, sim.ledger)
    lowest = sim.ledger.start - there
    while sim.time < end and sim.steps < most:
        sim.advance(end)
        rows.append([sim.ledger.kinetic, sim.ledger.kinetic + sim.ledger.potential - lowest])
    assert sim.time == end
    return np.array(rows).T / there


@pytest.mark.parametrize("edge", [0.9, 0.9217], ids=["aligned", "off-the-grid"])
@pytest.mark.parametrize("porosity", [0.05, 0.1, 0.2, 0.35])
def test_water_that_falls_through_a_body_gains_no_energy(porosity, edge):
    """Without drag: kinetic energies 2000 to 1e7 times what there was at n = 0.05, 1e6 at 0.1, on the old force."""
    kinetic, total = energies(simulation(falling(porosity, edge)))
    assert kinetic.max() < 1.0 and total.max() < 1.01


@pytest.mark.parametrize(
    "keys", [{"transfer": "flip"}, {"transfer": "apic"}, {"transfer": "pic"}, {"scheme": "jh2020"}]
)
@pytest.mark.parametrize("porosity", [0.05, 0.15, 0.4])
def test_so_with_any_transfer_and_scheme(porosity, keys):
    sim = simulation(falling(porosity, 0.9217), **{f"numerics__{key}": value for key, value in keys.items()})
    kinetic, _ = energies(sim)
    assert kinetic.max() < 1.0


@pytest.mark.parametrize("keys", [{"remesh": "none"}, {"correction": 0.0}, {"kernel": "quadratic"}], ids=str)
def test_so_without_remeshing_and_correction(keys):
    sim = simulation(falling(0.1, 0.9217), **{f"numerics__{key}": value for key, value in keys.items()})
    assert energies(sim)[0].max() < 1.0


def test_so_with_drag():
    """A body of n = 0.25 and ordinary grains: 1.5 times what gravity could give on the old force."""
    gravel = {"grain_diameter": 0.05, "resistance": {"law": "van-gent-1995"}}
    assert energies(simulation(falling(0.25, 0.9217, gravel)))[0].max() < 1.0


def test_a_film_that_falls_down_the_flank_of_a_body_gains_no_energy():
    sim = simulation(
        {
            "case": {"name": "film"},
            "domain": {"size": [0.45, 0.3], "spacing": 0.015},
            "water": [{"box": [[0.0, 0.138], [0.314, 0.17]]}],
            "porous": [{"box": [[0.2554, 0.0], [0.398, 0.15]], "porosity": 0.2, "resistance": FREE}],
            "fluid": {"viscosity": 1e-4},
            "time": {"end": 0.5},
        }
    )
    assert energies(sim)[0].max() < 1.0


UPPER = [[0.457, 0.274], [0.368, 0.269], [0.229, 0.241], [0.175, 0.097], [0.277, 0.097], [0.356, 0.071]]
LOWER = [[0.375, 0.344], [0.321, 0.434], [0.253, 0.411], [0.208, 0.305], [0.346, 0.273], [0.391, 0.263], [0.397, 0.293]]
FILM = {
    "case": {"name": "film"},
    "domain": {"size": [1.1508, 0.4344], "spacing": 0.0362},
    "water": [{"box": [[0.3009, 0.0869], [0.3259, 0.4344]]}],
    "porous": [{"polygon": p, "porosity": 0.195, "resistance": FREE, "added_mass": 2.0} for p in (UPPER, LOWER)],
    "time": {"end": 0.744, "courant": 0.1},
}
TONGUE = {
    "case": {"name": "tongue"},
    "domain": {"size": [0.7161, 0.3606], "spacing": 0.0361, "walls": {"x": "periodic"}},
    "water": [{"box": [[0.2732, 0.0721], [0.3154, 0.3606]]}],
    "porous": [
        {
            "box": [[0.3467, 0.1302], [0.4152, 0.2352]],
            "porosity": 0.18,
            "resistance": {"a": 0.5, "b": 0.0},
            "added_mass": 0.0,
        }
    ],
    "numerics": {"transfer": "flip"},
    "fluid": {"viscosity": 0.0},
    "time": {"end": 0.678},
}
THROWN = {
    "case": {"name": "thrown"},
    "domain": {"size": [1.0205, 0.4988], "spacing": 0.0499},
    "water": [{"box": [[0.2421, 0.2592], [0.3628, 0.3589]], "velocity": [-1.56, 0.79]}],
    "porous": [
        {
            "polygon": [[0.408, 0.2998], [0.2806, 0.4988], [0.3092, 0.3086], [0.2476, 0.1448]],
            "porosity": 0.182,
            "resistance": FREE,
        }
    ],
    "time": {"end": 0.1},
}


@pytest.mark.parametrize("case", [FILM, TONGUE, THROWN], ids=lambda case: case["case"]["name"])
def test_what_is_carried_outwards_from_the_water_makes_no_energy(case):
    """A film within pores, whose velocity grew by 5 % a step; FLIP in a tongue on the floor, 5 m/s after 0.36 m; water
    thrown at fine pores, which had 13 % more after two steps.
    """
    kinetic, total = energies(simulation(case))
    assert kinetic.max() < 1.0 and total.max() < 1.01


def thrown(porosity: float, angle: float, length: float, spacing: float) -> dict[str, Any]:
    """A slug in a duct without gravity that meets a body whose face leans by an angle [degrees]."""
    lean = 0.1 * np.tan(np.radians(angle))
    return {
        "case": {"name": "slug"},
        "domain": {"size": [1.6, 0.2], "spacing": spacing},
        "fluid": {"gravity": 0.0, "viscosity": 0.0},
        "water": [{"box": [[0.1, 0.0], [0.1 + length, 0.2]], "velocity": [1.0, 0.0]}],
        "porous": [
            {
                "polygon": [[0.5 - lean, 0.0], [1.6, 0.0], [1.6, 0.2], [0.5 + lean, 0.2]],
                "porosity": porosity,
                "resistance": FREE,
            }
        ],
        "time": {"end": 0.8},
    }


@pytest.mark.parametrize("angle", [0.0, 30.0])
@pytest.mark.parametrize(("porosity", "length"), [(0.2, 0.12), (0.4, 0.2), (0.5, 0.24)])
def test_a_slug_thrown_into_a_body_gains_no_energy(porosity, length, angle):
    """On the old force it gained 111, 83 and 54 %."""
    kinetic, _ = energies(simulation(thrown(porosity, angle, length, 0.02)))
    assert kinetic.max() < 1.01


def test_a_slug_keeps_its_energy_the_better_the_finer_it_is_resolved():
    """In the end all of it is in the body, at the speed of the pores that C_r u^2 / 2 gives."""
    left = [energies(simulation(thrown(0.5, 0.0, 0.2, spacing)))[0][-1] for spacing in (0.04, 0.02, 0.01)]
    assert left[0] < left[1] < left[2] < 1.0 and left[2] > 0.8


# ---- no run gains energy in silence ----------------------------------------------------------------------------------


def test_a_run_whose_water_gains_energy_is_stopped_and_says_where_when_and_how_much():
    sim = simulation(falling(0.4, 0.9))
    while sim.time < 0.1:
        sim.advance(0.1)
    steps, p = sim.steps, sim.particles
    p.velocity *= 4.0
    with pytest.raises(SimulationError, match=r"the water has gained energy: [\d.e+]+ J per metre") as caught:
        sim.advance(1.0)
    assert caught.value.time == pytest.approx(0.1, abs=0.01) and caught.value.step == steps + 1
    assert all(0.0 <= x <= size for x, size in zip(caught.value.place, (1.5, 0.5), strict=True))
    assert "series.nc" in caught.value.diagnosis


def test_what_can_be_in_motion_is_what_can_fall():
    """A column of 0.2 m over a dry floor twice as long may lose half of its height, and no more."""
    sim = simulation(
        {
            "case": {"name": "column"},
            "domain": {"size": [0.4, 0.4], "spacing": 0.02},
            "water": [{"box": [[0.0, 0.0], [0.2, 0.2]]}],
            "time": {"end": 1.0},
        }
    )
    assert sim.budget.available(sim.flow, sim.ledger) == pytest.approx(9.81 * 0.04 * (0.1 - 0.05), rel=1e-12)


@pytest.mark.parametrize("level", [0.2, 0.208, 0.213])
def test_of_a_level_pool_nothing_can_fall_wherever_in_a_cell_its_level_is(level):
    case = {"case": {"name": "pool"}, "domain": {"size": [0.4, 0.4], "spacing": 0.02}, "time": {"end": 1.0}}
    sim = simulation({**case, "water": [{"below": level}]})
    assert sim.budget.available(sim.flow, sim.ledger) == pytest.approx(0.0, abs=1e-12)


def test_water_at_rest_has_nothing_to_give():
    """In pores, on a slope and beside a solid: less than to fall by a hundredth of a cell, which is of no account."""
    sim = simulation(
        {
            "case": {"name": "rest"},
            "domain": {"size": [0.4, 0.4], "spacing": 0.02},
            "water": [{"below": 0.2}],
            "porous": [{"polygon": [[0.1, 0.0], [0.3, 0.0], [0.3, 0.3]], "porosity": 0.4, "resistance": FREE}],
            "solid": [{"box": [[0.3, 0.0], [0.4, 0.1]]}],
            "time": {"end": 1.0},
        }
    )
    assert sim.budget.available(sim.flow, sim.ledger) < 0.01 * 9.81 * sim.particles.total_volume * 0.02


TRIANGLE = {"polygon": [[0.4, 0.0], [0.8, 0.0], [0.8, 0.2]], "porosity": 0.3, "resistance": FREE}
WAVES_THROUGH = {
    "case": {"name": "waves-through"},
    "domain": {"size": [0.8, 0.4], "spacing": 0.02, "walls": {"x": "periodic"}},
    "fluid": {"viscosity": 0.0},
    "water": [{"box": [[0.1, 0.0], [0.353, 0.268]]}, {"below": 0.063}],
    "porous": [TRIANGLE],
    "time": {"end": 0.6},
}
LENGTHWISE = {
    "case": {"name": "past-an-end"},
    "domain": {"size": [0.6, 0.3, 0.3], "spacing": 0.03},
    "fluid": {"viscosity": 0.0},
    "water": [{"box": [[0.0, 0.0, 0.0], [0.2, 0.3, 0.22]]}, {"below": 0.05}],
    "porous": [{"box": [[0.24, 0.0, 0.0], [0.42, 0.15, 0.2]], "porosity": 0.3, "resistance": FREE}],
    "time": {"end": 0.45},
}


@pytest.mark.parametrize(
    "keys", [{"transfer": "fmpm"}, {"transfer": "flip"}, {"transfer": "apic", "remesh": "none"}], ids=str
)
@pytest.mark.parametrize("case", [WAVES_THROUGH, LENGTHWISE], ids=["oblique", "end in y"])
def test_waves_through_oblique_faces_and_past_ends_gain_no_energy(case, keys):
    """Well under water, where the pressure holds it: up to 75 % more than there was at the start, and runs stopped."""
    sim = simulation(case, **{f"numerics__{key}": value for key, value in keys.items()})
    kinetic, total = energies(sim)
    assert kinetic.max() < 1.0 and total.max() < 1.01


def seiche(porosity: float, amplitude: float) -> dict:
    """A tank of 1.2 m in which the water of 0.3 m swings over a mound of pores without drag, well under its surface."""
    x = np.linspace(1.2, 0.0, 25)
    level = np.column_stack([x, 0.3 + amplitude * np.cos(np.pi * x / 1.2)])
    return {
        "case": {"name": "seiche"},
        "domain": {"size": [1.2, 0.45], "spacing": 0.02},
        "fluid": {"viscosity": 0.0},
        "water": [{"polygon": [[0.0, 0.0], [1.2, 0.0], *level.tolist()]}],
        "porous": [
            {
                "polygon": [[0.2, 0.0], [0.55, 0.17], [0.65, 0.17], [1.0, 0.0]],
                "porosity": porosity,
                "resistance": FREE,
            }
        ],
        "time": {"end": 5.6},
    }


@pytest.mark.parametrize(("porosity", "least"), [(0.45, 0.75), (0.35, 0.64)])
def test_water_that_swings_over_slopes_of_pores_keeps_its_energy(porosity, least):
    """After four periods: .79 and .69 of the energy are left. With no more terms of FMPM at the slopes it was .71 and
    .59, and .58 and .48 where remeshing took off cell by cell what it made; taking nothing off, it made .45 and .43.
    """
    sim = simulation(seiche(porosity, 0.06))
    total = energies(sim)[1]
    assert total.max() < 1.0 and total[-1] > least
