"""Water that closes a void stops in one step: the impulse is the momentum that was stopped, whatever the step."""

from __future__ import annotations

import numpy as np
import pytest
from situations import simulation

A, B, GAP = 0.2, 0.2, 0.3  # m: a slug of height A falls through GAP on water of depth B


def falling_slug(courant):
    return {
        "case": {"name": "slug"},
        "domain": {"size": [0.08, 0.8], "spacing": 0.02},
        "water": [{"box": [[0.0, 0.0], [0.08, B]]}, {"box": [[0.0, B + GAP], [0.08, A + B + GAP]]}],
        "sensor": [{"name": "floor", "at": [0.04, 0.001]}],
        "time": {"end": 0.4, "courant": courant},
    }


def pressed(courant):
    """Over the steps until the slug lies still: their length [s], and the pressure on the floor [Pa]."""
    sim, steps, pressure = simulation(falling_slug(courant)), [], []
    while sim.time < 0.4:
        sim.advance(0.4)
        steps.append(sim.flow.kick)
        pressure.append(float(sim.sample()["pressure"][0]))
    return np.array(steps), np.array(pressure)


def test_the_impulse_is_the_momentum_that_was_stopped():
    """rho A sqrt(2 g GAP) = 485 Pa s in one step, of 4, 2 and 1 ms; the pressure is that over the step."""
    stopped = 1000.0 * A * np.sqrt(2 * 9.81 * GAP)
    largest, length = [], []
    for courant in (0.5, 0.25, 0.125):
        step, pressure = pressed(courant)
        top = int(np.argmax(pressure))
        assert pressure[top] * step[top] == pytest.approx(stopped, rel=0.03)
        assert np.delete(pressure, top).max() < 0.1 * pressure[top]
        assert step @ pressure == pytest.approx(1000.0 * 9.81 * (A + B) * step.sum(), rel=0.02)  # all weight is carried
        largest.append(pressure[top])
        length.append(step[top])
    assert largest[2] / largest[0] == pytest.approx(length[0] / length[2], rel=0.05)
