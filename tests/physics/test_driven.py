"""Faces of prescribed velocity: what goes in comes out, and none of it is lost between."""

from __future__ import annotations

import numpy as np
import pytest
from situations import simulation

from houle.flow.forces import apply_forces, drive
from houle.flow.projection import project


@pytest.mark.parametrize("out", [0.1, 0.04])
def test_the_flux_through_driven_sides_is_in_the_water(out):
    """In at the left, some out at the right, the rest lifts the surface: div u = 0 in every cell of the water."""
    dt, speed = 0.01, 0.1
    sim = simulation({
        "case": {"name": "channel"},
        "domain": {"size": [0.6, 0.2], "spacing": 0.02},
        "water": [{"below": 0.14}],
        "open": [{"side": "left", "velocity": speed}, {"side": "right", "velocity": -out}],
        "time": {"end": 1.0},
        "numerics": {"tolerance": 1e-10},
    })  # fmt: skip
    flow = sim.flow
    drive(flow, dt)
    apply_forces(flow, dt, [])
    project(flow, dt, sim.ledger)
    u, w = flow.velocity
    flux = np.diff(u, axis=0) / 0.02 + np.diff(w, axis=1) / 0.02
    assert np.abs(flux[flow.active == 1]).max() * dt < 1e-8
    assert (u[0] == speed).all() and (u[-1] == out).all()
    columns = np.arange(flow.grid.shape[0])
    lifted = w[columns, flow.active.sum(axis=1)].sum() * 0.02  # through the tops of the pressure cells
    assert lifted == pytest.approx((speed - out) * 0.14, rel=1e-6, abs=1e-9)
    pushed = sum(boundary.power(flow) for boundary in flow.boundaries)
    assert pushed > 0.0 and sim.ledger.open_work == pytest.approx(dt * pushed)
