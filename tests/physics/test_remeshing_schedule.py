"""When particles are made anew, and that low waves leave the surface smooth at a porous face."""

from __future__ import annotations

import numpy as np
from situations import run, simulation


def sloshing(amplitude, porosity):
    """A tank of 2 m, half of it porous, its water released from a slope."""
    x = np.linspace(2.0, 0.0, 101)
    surface = np.stack([x, 0.25 + amplitude * np.cos(np.pi * x / 2.0)], axis=1).tolist()
    body = {"name": "half", "box": [[1.0, 0.0], [2.0, 0.35]], "resistance": {"a": 0.0, "b": 0.0}, "added_mass": 0.0}
    return {
        "case": {"name": "sloshing"},
        "domain": {"size": [2.0, 0.35], "spacing": 0.02},
        "water": [{"polygon": [[0.0, 0.0], [2.0, 0.0], *surface]}],
        "porous": [{**body, "porosity": porosity}],
        "time": {"end": 3.0},
    }


def counted(sim):
    """Steps [s] at which the particles were made anew."""
    times, remesher = [], sim.step.remeshing.remesher

    def count(particles, porosity, *between):
        times.append(sim.time)
        return remesher(particles, porosity, *between)

    sim.step.remeshing.remesher = count
    return times


def test_to_and_fro_is_not_away():
    """Orbits of 0.2 cells go a long way in 3 s and leave nothing to do; those of 3 cells do not."""
    low, high = simulation(sloshing(0.0015, 0.9)), simulation(sloshing(0.025, 0.9))
    never, often = counted(low), counted(high)
    run(low, 10_000, until=3.0)
    run(high, 10_000, until=1.0)
    assert not never and often


def test_low_waves_leave_the_surface_smooth_at_a_porous_face():
    """A face that is hardly one, where horizontal orbits are largest: columns there differ from a line by little."""
    sim = simulation(sloshing(0.0025, 1.0 - 1e-6))
    near, rough = slice(40, 60), []
    while sim.time < 3.0:
        sim.advance(3.0)
        eta = sim.flow.eta[near]
        x = np.arange(len(eta))
        rough.append(np.abs(eta - np.polyval(np.polyfit(x, eta, 3), x)).max())
    assert max(rough) < 0.2e-3  # was 3e-3 when every remeshing stirred them
