"""Friction of beds, walls and solids in runs: exact laminar flows, books, forces, and what a side and a solid share."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely
from situations import copy_state, differing, run, simulation

from houle.flow.simulation import Simulation

NU = 0.02  # [m2/s] of the laminar flows
DRIVE = 0.04  # [m/s2] that pushes them


def channel(cells: int, floor: int, **more: Any) -> Simulation:
    """A channel of 0.5 m, endless along x, between solids `floor` cells thick; 0: sides of the tank."""
    h = 0.5 / cells
    height, length = (cells + 2 * floor) * h, 4 * h
    side = "slip" if floor else "no-slip"
    solids = [{"box": [[0.0, z], [length, z + floor * h]], "roughness": 0.0} for z in (0.0, height - floor * h)]
    case = {
        "case": {"name": "channel"},
        "domain": {"size": [length, height], "spacing": h, "walls": {"x": "periodic", "bottom": side, "top": side}},
        "fluid": {"viscosity": NU, "gravity": 0.0, "acceleration": [DRIVE, 0.0]},
        "water": [{"box": [[0.0, floor * h], [length, height - floor * h]]}],
        "solid": solids if floor else [],
        "time": {"end": 100.0},
    }
    return simulation(case, **more)


def mean_velocity(sim: Simulation, axis: int = 0) -> float:
    p = sim.particles
    return float(p.volume @ p.velocity[:, axis] / p.volume.sum())


@pytest.mark.parametrize("floor", [0, 3])
def test_poiseuille_flow_between_sides_and_between_solids(floor):
    """Mean velocity G a^2/(12 nu) from a plug of that, of second order: 5 % with ten cells, 1.1 % with twenty."""
    exact, errors = DRIVE * 0.25 / (12.0 * NU), []
    for cells in (10, 20):
        sim = channel(cells, floor)
        sim.particles.velocity[:, 0] = exact
        run(sim, 10000, until=0.4 * 0.25 / NU)
        errors.append(abs(mean_velocity(sim) / exact - 1.0))
    assert errors[0] < 0.06 and errors[1] < 0.015
    assert errors[0] > 3.0 * errors[1]


def test_a_side_and_a_solid_hold_a_viscous_flow_alike():
    """The same channel between sides and between solids, ten cells wide, while the flow develops: 1 %."""
    sides, solids = (mean_velocity(run(channel(10, floor), 10000, until=1.0)) for floor in (0, 3))
    assert solids == pytest.approx(sides, rel=0.01)
    assert 0.0 < sides < 0.9 * DRIVE


def duct(angle: float, cells: int) -> Simulation:
    """A duct 0.6 m square, endless along y, turned by an angle [degrees] about it, between four solids."""
    turn = np.radians(angle)
    solids = []
    for quarter in range(4):
        c, s = np.cos(turn + 0.5 * np.pi * quarter), np.sin(turn + 0.5 * np.pi * quarter)
        corners = np.array([[-3.0, -3.0], [3.0, -3.0], [3.0, -0.3], [-3.0, -0.3]]) @ np.array([[c, s], [-s, c]]) + 0.5
        part = shapely.Polygon(corners).intersection(shapely.box(0.0, 0.0, 1.0, 1.0))
        solids.append({"polygon": shapely.get_coordinates(part)[:-1].tolist(), "roughness": 0.0})
    width = 3.0 / cells
    case = {
        "case": {"name": "duct"},
        "domain": {"size": [1.0, width, 1.0], "spacing": 1.0 / cells, "walls": {"y": "periodic"}},
        "fluid": {"viscosity": NU, "gravity": 0.0, "acceleration": [0.0, DRIVE, 0.0]},
        "water": [{"box": [[0.0, 0.0, 0.0], [1.0, width, 1.0]]}],
        "solid": solids,
        "time": {"end": 100.0},
    }
    return simulation(case)


@pytest.mark.parametrize("angle", [0.0, 20.0, 45.0])
def test_laminar_flow_in_a_duct_at_any_angle(angle):
    """Mean velocity 0.03514 G a^2/nu, from a plug of that, nine cells wide, plates that cut the cells: 10 %."""
    sim, exact = duct(angle, 15), 0.035144 * DRIVE * 0.36 / NU
    sim.particles.velocity[:, 1] = exact
    run(sim, 10000, until=3.0)
    assert mean_velocity(sim, 1) == pytest.approx(exact, rel=0.1)


def plug(roughness: float | None, floor: int = 3, **more: Any) -> Simulation:
    """A stream of 1 m/s, 10 cells deep, along a rough solid of `floor` cells, which nothing drives: inviscid.

    floor = 0: along a rough side of the tank.
    """
    case = {
        "case": {"name": "plug"},
        "domain": {"size": [0.2, 0.2], "spacing": 0.01, "walls": {"x": "periodic"}},
        "fluid": {"viscosity": 0.0},
        "water": [{"box": [[0.0, 0.01 * floor], [0.2, 0.01 * floor + 0.1]], "velocity": [1.0, 0.0]}],
        "time": {"end": 100.0},
    }
    given = {} if roughness is None else {"roughness": roughness}
    if floor:
        case["solid"] = [{"name": "bed", "box": [[0.0, 0.0], [0.2, 0.01 * floor]], **given}]
        case["force"] = [{"name": "F", "body": "bed"}]
    else:
        case["domain"]["walls"]["bottom"] = given
        case["force"] = [{"name": "F", "side": "bottom"}]
    return simulation(case, **more)


def momentum(sim: Simulation) -> float:
    p = sim.particles
    return float(p.volume @ p.velocity[:, 0])


@pytest.mark.parametrize("floor", [0, 3])
def test_the_bed_gets_the_momentum_that_the_stream_loses(floor):
    """In each step, and the shear of the law of the wall on its length; the faces in a solid keep none of it."""
    sim = plug(2e-3, floor)
    places = ((0.005, 0.5), (0.0075, 0.375), (0.0125, 0.125))  # rows of particles, and their shares of the shear
    shear = sum(share * (0.41 / np.log(30.0 * y / 2e-3)) ** 2 for y, share in places)
    for step in range(12):
        before = momentum(sim)
        run(sim, 1)
        sample = sim.sample()
        lost, force = 1000.0 * (before - momentum(sim)), sample["friction_force"][0, 0]
        assert lost == pytest.approx(force * sim.flow.kick, rel=2e-3)
        assert sample["force"][0, 0] == pytest.approx(force, abs=1e-3)
        if step == 0:
            assert force == pytest.approx(1000.0 * 0.2 * shear, rel=5e-3)


def test_a_side_and_a_solid_hold_a_stream_alike():
    """To two thousandths of what they take in twelve steps."""
    side, solid = (0.02 - momentum(run(plug(2e-3, floor), 12)) for floor in (0, 3))
    assert solid == pytest.approx(side, rel=2e-3)


def test_friction_is_booked_under_its_own_name_and_is_all_that_a_plug_loses_to_forces():
    sim = plug(2e-3)
    run(sim, 10)
    assert sim.ledger.friction_work > 0.0
    assert sim.sample()["friction_work"] == pytest.approx(1000.0 * sim.ledger.friction_work)
    assert sim.flow.kinetic_energy() < 0.01 - 0.99 * sim.ledger.friction_work  # transfers take some more
    slipping = plug(None)
    run(slipping, 10)
    assert slipping.ledger.friction_work == 0.0
    assert momentum(slipping) == pytest.approx(0.02, rel=1e-9)


def test_a_run_with_friction_that_is_resumed_is_the_same_run():
    straight = plug(2e-3)
    run(straight, 8)
    state = copy_state(straight)
    run(straight, 6)
    resumed = plug(2e-3)
    resumed.restore(state)
    run(resumed, 6)
    assert not differing(copy_state(straight), copy_state(resumed))


@pytest.mark.parametrize("scheme", ["houle", "jh2020"])
def test_a_rough_bed_holds_more_in_both_schemes(scheme):
    left = [momentum(run(plug(k, numerics__scheme=scheme), 12)) for k in (None, 1e-4, 2e-3)]
    assert left[2] < left[1] < left[0] * (1.0 - 1e-5)


@pytest.mark.parametrize("floor", [0.0, 0.04])
def test_a_wave_decays_by_its_bed_as_the_laminar_boundary_layer_says(floor):
    """Standing wave, layer sqrt(2 nu/omega) as thick as a cell: energy rate u_b^2 sqrt(nu omega/8) / E and 4 nu k^2.

    From the first to the third period, as the layer has to grow; 10 % with one cell in it.
    """
    amplitude, depth, nu, k = 0.01, 0.25, 1e-3, np.pi
    x = np.linspace(1.0, 0.0, 51)
    surface = np.column_stack([x, floor + depth + amplitude * np.cos(k * x)])
    case: dict[str, Any] = {
        "case": {"name": "wave"},
        "domain": {"size": [1.0, 0.32 + floor], "spacing": 0.02, "walls": "slip" if floor else {"bottom": "no-slip"}},
        "fluid": {"viscosity": nu},
        "water": [{"polygon": [[0.0, floor], [1.0, floor], *surface.tolist()]}],
        "time": {"end": 10.0},
    }
    if floor:
        case["solid"] = [{"box": [[0.0, 0.0], [1.0, floor]], "roughness": 0.0}]
    sim, omega = simulation(case), np.sqrt(9.81 * k * np.tanh(k * depth))
    period, energy = 2.0 * np.pi / omega, 9.81 * amplitude**2 / 4.0
    speed = amplitude * omega / np.sinh(k * depth)
    exact = speed**2 * np.sqrt(nu * omega / 8.0) / 2.0 / energy + 4.0 * nu * k**2
    left = []
    for periods in (1, 3):
        run(sim, 10000, until=periods * period)
        left.append(energy - sim.ledger.friction_work - sim.ledger.viscous_work)
    assert np.log(left[0] / left[1]) / (2.0 * period) == pytest.approx(exact, rel=0.1)
