"""Flow through porous media against closed forms: start-up, steady Darcy-Forchheimer flow at any step, infiltration."""

from __future__ import annotations

import numpy as np
import pytest
from situations import run, simulation

from houle.validation.exact import PorousMedium, duct_flow

ROCK = PorousMedium(0.49, a=0.9, b=130.0, inertia=1.0 + 0.34 * 0.51 / 0.49)
BEADS = PorousMedium(0.39, a=140.0, b=2300.0, inertia=1.0 + 0.34 * 0.61 / 0.39)
DRIVE = 4.905  # m/s2


def duct(medium, step):
    """A full periodic duct of the medium, driven along x."""
    return simulation(
        {
            "case": {"name": "duct"},
            "domain": {"size": [0.1, 0.04], "spacing": 0.01, "walls": {"x": "periodic"}},
            "fluid": {"acceleration": [DRIVE, 0.0], "viscosity": 0.0},
            "water": [{"box": [[0.0, 0.0], [0.1, 0.04]]}],
            "porous": [
                {
                    "box": [[0.0, 0.0], [0.1, 0.04]],
                    "porosity": medium.porosity,
                    "resistance": {"a": medium.a, "b": medium.b},
                }
            ],
            "sensor": [{"at": [0.033, 0.021]}],
            "time": {"end": 1.0, "step": step},
            "numerics": {"tolerance": 1e-12},
        }
    )


def flux(sim):
    return float(sim.sample()["velocity"][0, 0])


@pytest.mark.parametrize("medium", [ROCK, BEADS], ids=["rock", "beads"])
def test_forced_start_up_follows_the_closed_form(medium):
    """(C_r/n) dq/dt = G - a q - b q^2 from rest, to 0.1 % of the last flux in the middle of every step of 0.5 ms."""
    sim = duct(medium, 5e-4)
    times, q = [0.0], [0.0]
    for _ in range(80):
        run(sim, 1)
        times.append(sim.time - sim.lag["velocity"] * sim.step_size)
        q.append(flux(sim))
    exact = duct_flow(np.array(times), medium, DRIVE)
    assert np.abs(np.array(q) - exact).max() < 1e-3 * exact[-1]
    assert np.ptp(sim.particles.velocity[:, 0]) < 1e-10  # uniform, and along the duct
    assert np.abs(sim.particles.velocity[:, 1]).max() < 1e-10


@pytest.mark.parametrize("medium", [ROCK, BEADS], ids=["rock", "beads"])
@pytest.mark.parametrize("step", [0.0002, 0.002, 0.02])
def test_steady_flux_is_exact_at_any_step(medium, step):
    """Steps a hundred times apart, up to 10 relaxation times of the beads, keep G = a q + b q^2 to round-off."""
    sim = duct(medium, step)
    steady = (-medium.a + np.sqrt(medium.a**2 + 4.0 * medium.b * DRIVE)) / (2.0 * medium.b)
    sim.particles.velocity[:, 0] = steady
    run(sim, 20)
    assert flux(sim) == pytest.approx(steady, rel=1e-9)


@pytest.mark.parametrize("medium", [ROCK, BEADS], ids=["rock", "beads"])
def test_the_steady_flux_is_reached_from_rest_with_long_steps(medium):
    assert flux(run(duct(medium, 0.02), 60)) == pytest.approx(duct_flow(np.inf, medium, DRIVE), rel=1e-6)
