"""Added mass before du/dt at a place alone (Jensen, Jacobsen & Christensen 2014): C_r du/dt + (u . grad) u."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from situations import copy_state, differing, run, simulation
from test_porous_energy import energies, falling, thrown

from houle import _core, load
from houle.case.build import build
from houle.errors import SimulationError
from houle.flow.simulation import Simulation
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box
from houle.observe.force import BodyLoad
from houle.validation.exact import bernoulli_jump, column_infiltration, duct_flow
from houle.validation.media import medium

FREE = {"a": 0.0, "b": 0.0}
GRAVEL = {"grain_diameter": 0.02, "resistance": {"law": "van-gent-1995"}}
OTHERS = [{"transfer": "flip"}, {"transfer": "apic"}, {"scheme": "jh2020"}]


def numerics(keys: dict[str, Any]) -> dict[str, Any]:
    return {f"numerics__{key}": value for key, value in keys.items()}


def history(sim: Simulation, end: float, of) -> np.ndarray:
    """A row of numbers after every step."""
    rows = []
    while sim.time < end:
        sim.advance(end)
        rows.append(of(sim))
    return np.array(rows).T


# ---- the pressure at the faces of a body -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("porosity", "drag", "on"), [(0.49, 50.0, "rate"), (0.6, 40.0, "rate"), (0.49, 50.0, "motion")]
)
def test_the_jump_at_a_plug_knows_no_added_mass(porosity, drag, on):
    """q^2/2 (1/n^2 - 1) in and out, within 1 %, at the flux that added mass does not change; on the motion C_r/n^2."""
    keys = {"porosity": porosity, "resistance": {"a": 0.0, "b": drag}, "added_mass": 0.34, "added_mass_on": on}
    case = load("porous-plug", {f"porous.plug.{k}": v for k, v in keys.items()})
    body, h = medium(case.porous[0], case.fluid), case.domain.spacing

    def look(sim):
        return [sim.time, *sim.flow.velocity[0][:-1].mean(axis=1), *sim.flow.pressure.mean(axis=1)]

    rows = history(Simulation(build(case)), 0.8, look)
    cells = (len(rows) - 1) // 2
    time, flux, pressure = rows[0], rows[1 : cells + 1].mean(axis=0), rows[cells + 1 :]
    exact = duct_flow(time - 0.5 * case.time.step, body, 4.905, 0.5, 0.1)
    assert flux == pytest.approx(exact, abs=2e-3 * exact[-1])
    x, late = (np.arange(cells) + 0.5) * h, time > 0.5
    mean = pressure[:, late].mean(axis=1)

    def at(place, low, high):
        part = (x > low) & (x < high)
        return np.polyval(np.polyfit(x[part], mean[part], 1), place)

    inside = [at(place, 0.265, 0.335) for place in (0.25, 0.35)]
    jump = bernoulli_jump(flux[late].mean(), porosity, 1.0 if on == "rate" else body.inertia)
    assert at(0.25, 0.03, 0.235) - inside[0] == pytest.approx(jump, rel=0.01)
    assert at(0.35, 0.365, 0.47) - inside[1] == pytest.approx(jump, rel=0.01)


def test_water_falls_into_a_dry_bed_as_the_equation_says():
    """(h + C_r s/n) dq/dt = g (h + s) - q^2/2 (1/n^2 - 1) - s (a q + b q^2) with C_r = 2.04, within a fifth of a cell;
    the form with C_r/n^2 is twenty times as far away."""
    keys = {"added_mass": 1.0, "added_mass_on": "rate", "resistance": {"a": 2.0, "b": 20.0}}
    case = load("porous-column", {f"porous.bed.{k}": v for k, v in keys.items()})
    body, n, width = case.porous[0], case.porous[0].porosity, case.domain.size[0]
    assert body.box is not None
    sim = Simulation(build(case))
    layer = sim.particles.total_volume / width
    time, level = history(sim, 0.3, lambda sim: (sim.time, float(sim.sample()["eta"][0])))
    wetted = (layer - (level - body.box[1][-1])) / n
    errors = []
    for on in ("rate", "motion"):
        other = medium(body.model_copy(update={"added_mass_on": on}), case.fluid)
        exact, _, _ = column_infiltration(np.concatenate([[0.0], time]), other, layer)
        errors.append(np.sqrt(np.mean((wetted - exact[1:]) ** 2)))
    assert errors[0] < 1e-3 and errors[1] > 1e-2


# ---- what is uniform in space feels all of the inertia ---------------------------------------------------------------


def test_flow_starts_up_with_the_inertia_of_the_added_mass():
    case = load("porous-startup", {"porous.rock.added_mass": 1.0, "porous.rock.added_mass_on": "rate", "time.end": 0.1})
    time, flux = history(Simulation(build(case)), 0.1, lambda sim: (sim.time, sim.flow.velocity[0][:, :8].mean()))
    exact = duct_flow(time - 0.5 * case.time.step, medium(case.porous[0], case.fluid), 4.905)
    assert flux == pytest.approx(exact, abs=5e-3 * exact[-1])


@pytest.mark.parametrize("keys", [{}, *OTHERS], ids=str)
def test_what_is_uniform_has_nothing_to_fall_behind(keys):
    """As on the motion, with any transfer."""

    def state(on):
        body = {"box": [[0.0, 0.0], [0.2, 0.1]], "porosity": 0.4, "resistance": FREE, "added_mass_on": on}
        sim = simulation(
            {
                "case": {"name": "duct"},
                "domain": {"size": [0.2, 0.1], "spacing": 0.02, "walls": {"x": "periodic"}},
                "fluid": {"acceleration": [2.0, 0.0], "gravity": 0.0},
                "water": [{"below": 0.1}],
                "porous": [body],
                "time": {"end": 1.0, "step": 0.005},
            },
            **numerics(keys),
        )
        for _ in range(6):
            sim.advance(1.0)
        return sim.particles.velocity[:, 0]

    inertia = (1.0 + 0.34 * 0.6 / 0.4) / 0.4
    assert state("rate") == pytest.approx(state("motion"), rel=1e-12)
    assert state("rate") == pytest.approx(2.0 / inertia * 0.03, rel=0.1), "half a step is the lag of the leapfrog"


# ---- what is not uniform is carried with K/C_r of the velocity of the water ------------------------------------------


def travelled(on: str, cells: int, **keys: Any) -> complex:
    """u = 0.2/n across, v = sin kx along: what is left of v once the water has gone around, and where it is."""
    h, n = 1.0 / cells, 0.35
    room = [[0.0, 0.0, 0.0], [1.0, 2 * h, 2 * h]]
    sim = simulation(
        {
            "case": {"name": "shear"},
            "domain": {"size": room[1], "spacing": h, "walls": {"x": "periodic", "y": "periodic"}},
            "fluid": {"gravity": 0.0, "viscosity": 0.0},
            "water": [{"box": room, "velocity": [0.2, 0.0, 0.0]}],
            "porous": [{"box": room, "porosity": n, "resistance": FREE, "added_mass_on": on}],
            "time": {"end": n / 0.2},
        },
        **numerics(keys),
    )
    p = sim.particles
    p.velocity[:, 1] = 0.02 * np.sin(2.0 * np.pi * p.position[:, 0])
    while sim.time < n / 0.2:
        sim.advance(n / 0.2)
    p = sim.particles
    assert p.velocity[:, 0] == pytest.approx(0.2, rel=1e-9)
    return 1j * complex(np.mean(p.velocity[:, 1] * np.exp(-2j * np.pi * p.position[:, 0]))) / 0.01


def test_a_wave_of_velocity_moves_with_the_velocity_over_the_inertia():
    """To the second order in space; and never grows."""
    inertia = 1.0 + 0.34 * 0.65 / 0.35
    assert travelled("motion", 16) == pytest.approx(1.0, abs=2e-3)
    exact = np.exp(-2j * np.pi / inertia)
    errors = [abs(travelled("rate", cells) - exact) for cells in (16, 32)]
    assert errors[0] < 0.04 and np.log2(errors[0] / errors[1]) > 1.8
    assert 0.98 < abs(travelled("rate", 16)) < 1.0


@pytest.mark.parametrize("keys", OTHERS[:2], ids=str)
def test_so_with_other_transfers(keys):
    inertia = 1.0 + 0.34 * 0.65 / 0.35
    left = travelled("rate", 32, **keys)
    assert 0.98 < abs(left) < 1.0
    assert left / abs(left) == pytest.approx(np.exp(-2j * np.pi / inertia), abs=0.03)


def slope_of_bernoulli(on: str, porosity: float, added_mass: float, **keys: Any) -> float:
    """Ratio of p/rho to u^2/2 between the wide and the narrow part of a duct in which flow starts from rest."""
    x = np.linspace(0.02, 0.98, 33)
    bump = 0.05 * (1.0 - np.cos(2.0 * np.pi * x))
    ends = ([0.02, 0.0], [0.98, 0.0])
    floor = [ends[0], *([float(a), float(b)] for a, b in zip(x[1:-1], bump[1:-1], strict=True)), ends[1]]
    roof = [[a, 0.4 - b] for a, b in floor]
    sim = simulation(
        {
            "case": {"name": "nozzle"},
            "domain": {"size": [1.0, 0.4], "spacing": 0.02, "walls": {"x": "periodic"}},
            "fluid": {"gravity": 0.0, "viscosity": 0.0, "acceleration": [1.0, 0.0]},
            "water": [{"below": 0.4}],
            "solid": [{"polygon": floor}, {"polygon": roof}],
            "porous": [
                {
                    "box": [[0.0, 0.0], [1.0, 0.4]],
                    "porosity": porosity,
                    "resistance": FREE,
                    "added_mass": added_mass,
                    "added_mass_on": on,
                }
            ],
            "time": {"end": 1.2},
        },
        **numerics(keys),
    )

    def look(sim):
        f = sim.flow
        u = 0.5 * (f.velocity[0] + f.old_velocity[0])[:, 9:11].mean(axis=1) / porosity
        p = f.pressure[:, 9:11].mean(axis=1)
        return 0.5 * (u[25] ** 2 - u[0] ** 2), 0.5 * (p[24] + p[25] - p[0] - p[-1])

    energy, pressure = history(sim, 1.2, look)[:, 5:]
    return float(np.polyfit(energy, pressure, 1)[0])


@pytest.mark.parametrize(
    ("porosity", "added_mass", "keys"), [(0.35, 0.34, {}), *((0.5, 1.0, keys) for keys in [{}, *OTHERS])], ids=str
)
def test_in_a_converging_duct_the_pressure_falls_by_the_square_of_the_pore_velocity(porosity, added_mass, keys):
    """Potential flow: C_r dphi/dt + K u^2/2 + p/rho = const. K = 1; on the motion C_r = 2 and 1.63."""
    assert slope_of_bernoulli("rate", porosity, added_mass, **keys) == pytest.approx(-1.0, abs=0.03)


def test_so_with_all_of_the_inertia_where_the_added_mass_is_on_the_motion():
    assert slope_of_bernoulli("motion", 0.5, 1.0) == pytest.approx(-2.0, abs=0.06)


def test_along_an_interface_the_pore_velocity_is_kept():
    """A stream crosses a slab and slides along it as well: v/n is the same on both sides, on the motion C_r v/n. To a
    few per cent: the force on the faces along an interface acts on both of its sides."""
    n, inertia = 0.8, 1.0 + 1.0 * 0.2 / 0.8
    for on, ratio in (("rate", n), ("motion", n / inertia)):
        slab = {"box": [[0.4, 0.0, 0.0], [0.8, 0.05, 0.05]], "porosity": n, "resistance": FREE}
        sim = simulation(
            {
                "case": {"name": "slab"},
                "domain": {"size": [1.0, 0.05, 0.05], "spacing": 0.025, "walls": {"x": "periodic", "y": "periodic"}},
                "fluid": {"gravity": 0.0, "viscosity": 0.0},
                "water": [{"box": [[0.0, 0.0, 0.0], [1.0, 0.05, 0.05]], "velocity": [0.2, 0.0, 0.0]}],
                "porous": [{**slab, "added_mass": 1.0, "added_mass_on": on}],
                "time": {"end": 10.0},
            }
        )
        x = sim.particles.position[:, 0]
        sim.particles.velocity[:, 1] = np.where((x > 0.4) & (x < 0.8), 0.1 * ratio, 0.1)
        while sim.time < 2.0:  # the slab is 1.6 s long
            sim.advance(2.0)
        v, x = sim.flow.velocity[1].mean(axis=(1, 2)), (np.arange(40) + 0.5) * 0.025
        inside, outside = (x > 0.45) & (x < 0.75), (x < 0.35) | (x > 0.85)
        assert v[inside].mean() / v[outside].mean() == pytest.approx(ratio, rel=0.04)


# ---- the force on the grains -----------------------------------------------------------------------------------------


def test_what_the_water_has_from_convection_alone_does_not_push_the_grains():
    """u_x = q + s x in a body of inertia C_r: rho (1 - 1/C_r)/n (u . grad) u less than on the motion, for the water has
    this acceleration besides that which the forces of the step give."""
    forces, q, s, n, inertia = [], 0.3, 0.7, 0.4, 1.0 + 0.34 * 0.6 / 0.4
    for on in ("rate", "motion"):
        room = [[0.0, 0.0], [0.4, 0.2]]
        sim = simulation(
            {
                "case": {"name": "block"},
                "domain": {"size": room[1], "spacing": 0.02},
                "water": [{"below": 0.2}],
                "porous": [{"box": room, "porosity": n, "resistance": FREE, "added_mass_on": on}],
                "time": {"end": 1.0},
            }
        )
        for u in (sim.flow.velocity, sim.flow.old_velocity):
            u[0][...] = q + s * np.linspace(0.0, 0.4, 21)[:, None]
        forces.append(BodyLoad(sim.flow, 0, np.zeros(2)).load(sim.flow)[0][0])
    mean = np.mean(s * (q + s * 0.02 * (np.arange(20) + 0.5)))
    assert forces[1][0] == pytest.approx(0.0, abs=1e-12)
    assert forces[0][0] == pytest.approx(-(1.0 - 1.0 / inertia) / n * mean * 0.4 * 0.2, rel=1e-9)
    assert forces[0][1] == pytest.approx(forces[1][1])


# ---- energy ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("edge", [0.9, 0.9217], ids=["aligned", "off-the-grid"])
@pytest.mark.parametrize("porosity", [0.1, 0.35, 0.5])
def test_water_that_falls_through_ordinary_rubble_stays_bounded(porosity, edge):
    case = falling(porosity, edge, GRAVEL)
    case["porous"][0]["added_mass_on"] = "rate"
    kinetic, total = energies(simulation(case))
    assert kinetic.max() < 0.7 and total.max() < 1.01


@pytest.mark.parametrize("keys", [*OTHERS, {"transfer": "pic"}, {"remesh": "none"}, {"kernel": "quadratic"}], ids=str)
def test_so_with_any_transfer_and_scheme(keys):
    case = falling(0.4, 0.9217, GRAVEL)
    case["porous"][0]["added_mass_on"] = "rate"
    assert energies(simulation(case, **numerics(keys)))[0].max() < 0.7


def test_water_that_enters_without_friction_gains_energy_and_the_run_says_so():
    """C_r = 1.34 in the body: no form without energy can do else."""
    case = thrown(0.5, 0.0, 0.24, 0.02)
    case["porous"][0]["added_mass_on"] = "rate"
    with pytest.raises(SimulationError, match="the water has gained energy"):
        energies(simulation(case))


# ---- the choice ------------------------------------------------------------------------------------------------------


def test_without_the_choice_and_without_added_mass_there_is_nothing_to_do():
    grid = Grid((8, 4), (0.1, 0.1), (False, False))
    box = Box((0.2, 0.0), (0.6, 0.4))
    for body in (
        PorousBody("rock", box, 0.5, inertia=1.4),
        PorousBody("rock", box, 0.5, inertia=1.0, on_rate=True),
    ):
        assert "lag" not in Medium.build(grid, [body]).kinds
    medium = Medium.build(grid, [PorousBody("rock", box, 0.5, inertia=1.4, on_rate=True)])
    kinds = {name: values[medium.kind] for name, values in medium.kinds.items()}
    assert kinds["lag"][3, 2] == pytest.approx(1.0 - 1.0 / 1.4) and kinds["lag"][0, 2] == 0.0
    assert kinds["energy"][3, 2] == pytest.approx(4.0) and np.all(kinds["coefficient"] == 1.0)
    assert kinds["contrast"].max() == pytest.approx(1.4 * 4.0), "that of the energy there is"


def test_bodies_of_both_kinds_side_by_side_and_one_that_differs_only_in_this():
    """The default of one body is not touched by the other: there nothing falls behind."""
    grid = Grid((12, 4), (0.1, 0.1), (False, False))
    bodies = [
        PorousBody("left", Box((0.2, 0.0), (0.6, 0.4)), 0.5, 1.0, 2.0, inertia=1.4),
        PorousBody("right", Box((0.6, 0.0), (1.0, 0.4)), 0.5, 1.0, 2.0, inertia=1.4, on_rate=True),
    ]
    medium = Medium.build(grid, bodies)
    lag = medium.kinds["lag"][medium.kind][:, 0]
    assert (
        lag[:6] == pytest.approx(0.0) and lag[6:10] == pytest.approx(1.0 - 1.0 / 1.4) and lag[10:] == pytest.approx(0.0)
    )
    assert medium.interfaces is not None
    assert {float(m) for m in np.unique(medium.interfaces.planes[:, -2:])} == {0.0, 1.0, 2.0}


@pytest.mark.parametrize("keys", [{}, {"scheme": "jh2020"}], ids=str)
def test_a_run_goes_on_from_its_state_to_the_last_bit_with_any_number_of_threads(keys):
    case = falling(0.4, 0.9217, GRAVEL)
    case["porous"][0]["added_mass_on"] = "rate"
    one, other = (simulation(case, **numerics(keys)) for _ in range(2))
    run(one, 40)
    other.restore(copy_state(one))
    run(one, 10)
    _core.set_threads(2)
    run(other, 10)
    _core.set_threads(1)
    assert differing(copy_state(one), copy_state(other)) == []
