"""Volume and momentum, and what must come out the same in three dimensions as in two."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from situations import DAM_BREAK, run, simulation

TRANSFERS = ("fmpm", "flip", "pic", "apic")
KERNELS = ("linear", "quadratic", "m4prime", "gaussian", "gaussian-taylor2", "gaussian-cell")


def inside(sim):
    x = sim.particles.position
    return np.all((x >= 0) & (x <= sim.grid.size))


@pytest.mark.parametrize("transfer", TRANSFERS)
def test_the_volume_of_the_water_is_constant(transfer):
    """Through a dam break on rock with remeshing every fifth step: to round-off, and every particle in the tank."""
    sim = simulation(DAM_BREAK, numerics__transfer=transfer, numerics__remesh_every=5)
    volume = sim.particles.total_volume
    assert volume == pytest.approx(0.14 * 0.16 + 0.16 * 0.033 + 0.1 * 0.033 * 0.49, rel=1e-12)
    for _ in range(40):
        run(sim, 1)
        assert abs(sim.particles.total_volume / volume - 1.0) < 1e-13
    assert inside(sim)
    assert max(sim.flow.max_pore_speed()) < 2.0 * np.sqrt(9.81 * 0.16) * 1.5 / 0.49


@pytest.mark.parametrize(("transfer", "kernel"), [c for c in product(TRANSFERS, KERNELS) if c != ("fmpm", "m4prime")])
@pytest.mark.parametrize("scheme", ["houle", "jh2020"])
def test_every_combination_runs(scheme, transfer, kernel):
    """Ten steps of the dam break on rock: stays a flow, at a speed that its height can give to a jet."""
    choice = {"numerics__scheme": scheme, "numerics__transfer": transfer, "numerics__kernel": kernel}
    sim = simulation(DAM_BREAK, numerics__remesh_every=4, **choice)
    run(sim, 10)
    assert sim.steps == 10 and inside(sim)
    assert np.abs(sim.particles.velocity).max() < 4.0 * np.sqrt(9.81 * 0.16)
    assert np.isfinite(sim.frame().pressure).all()


@pytest.mark.parametrize("scheme", ["houle", "jh2020"])
def test_momentum_round_a_periodic_duct_grows_with_the_push(scheme):
    """Clear water between slip walls: sum V u = V G t, whatever eddies are in it.

    To round-off while the water is uniform; then to a per cent, since the pressure acts on full faces and the particles
    carry them unevenly.
    """
    sim = simulation(
        {
            "case": {"name": "duct"},
            "domain": {"size": [0.2, 0.1], "spacing": 0.02, "walls": {"x": "periodic"}},
            "fluid": {"acceleration": [0.7, 0.0], "viscosity": 1e-3},
            "water": [{"below": 0.1}],
            "time": {"end": 1.0, "step": 0.004},
            "numerics": {"scheme": scheme, "remesh": "conservative", "remesh_every": 6, "tolerance": 1e-11},
        }
    )
    k = 2 * np.pi / 0.2
    run(sim, 5)
    instant = sim.time - sim.step.velocity_lag * sim.step_size
    assert sim.particles.velocity[:, 0] == pytest.approx(0.7 * instant, rel=1e-9)
    x = sim.particles.position
    sim.particles.velocity[:, 0] += 0.5 * np.sin(k * x[:, 0]) * np.cos(np.pi * x[:, 1] / 0.1)
    sim.particles.velocity[:, 1] -= 0.5 * np.cos(k * x[:, 0]) * np.sin(np.pi * x[:, 1] / 0.1)
    start, volume, momentum = sim.time, sim.particles.volume, sim.particles.volume @ sim.particles.velocity[:, 0]
    for _ in range(20):
        run(sim, 1)
    gained = sim.particles.volume @ sim.particles.velocity[:, 0] - momentum
    assert gained == pytest.approx(volume.sum() * 0.7 * (sim.time - start), rel=0.01)
    assert np.ptp(sim.particles.velocity[:, 0]) > 0.1  # the eddies are still there


def test_no_slip_walls_and_viscosity_only_slow_the_water_down():
    case = {
        "case": {"name": "duct"},
        "domain": {"size": [0.2, 0.1], "spacing": 0.02, "walls": {"x": "periodic", "bottom": "no-slip"}},
        "fluid": {"viscosity": 5e-3},
        "water": [{"below": 0.1}],
        "time": {"end": 1.0, "step": 0.004},
    }
    held, free = simulation(case), simulation({**case, "domain": {**case["domain"], "walls": {"x": "periodic"}}})
    for sim in (held, free):
        sim.particles.velocity[:, 0] = 0.5
        run(sim, 10)
    assert free.particles.velocity[:, 0] == pytest.approx(0.5, abs=1e-6)
    low = held.particles.position[:, 1] < 0.02
    assert held.particles.velocity[low, 0].mean() < 0.9 * held.particles.velocity[~low, 0].mean() < 0.45


# ---- two and three dimensions ----------------------------------------------------------------------------------------


def dam(width=None, **more):
    """The coarse dam break, in 3D uniform across a width."""

    def box(low, high):
        return [low, high] if width is None else [[low[0], 0.0, low[1]], [high[0], width, high[1]]]

    size = [0.4, 0.24] if width is None else [0.4, width, 0.24]
    return {
        "case": {"name": "dam"},
        "domain": {"size": size, "spacing": 0.02},
        "water": [{"box": box([0.0, 0.0], [0.14, 0.16])}, {"below": 0.033}],
        "porous": [{"box": box([0.2, 0.0], [0.3, 0.14]), "porosity": 0.49, "resistance": {"a": 0.9, "b": 130.0}}],
        "time": {"end": 1.0, "step": 0.003},
        "numerics": {"tolerance": 1e-12, **more},
    }


@pytest.mark.parametrize("transfer", ["fmpm", "apic"])
def test_a_flow_uniform_across_the_tank_is_the_two_dimensional_one(transfer):
    """Slip walls in front and behind: the same surface as in 2D, nothing across, for 20 steps with remeshing.

    Without the position correction, which solves to a per cent and lets round-off grow.
    """
    numerics = {"transfer": transfer, "remesh_every": 4, "correction": 0.0}
    flat, deep = run(simulation(dam(**numerics)), 20), run(simulation(dam(width=0.06, **numerics)), 20)
    assert np.abs(deep.particles.velocity[:, 1]).max() < 1e-10
    assert np.nanmax(np.ptp(deep.flow.eta, axis=1)) < 1e-10
    assert np.ptp(deep.flow.velocity[2], axis=1).max() < 1e-10
    np.testing.assert_allclose(deep.flow.eta[:, 1], flat.flow.eta, rtol=0, atol=1e-8)
    np.testing.assert_allclose(deep.flow.pressure[:, 1], flat.flow.pressure, rtol=0, atol=1e-7)
    assert len(deep.particles) == 6 * len(flat.particles)
