"""Two waves in a flume: to second order a piston sends their set-down out bound, to first with a free long wave."""

from __future__ import annotations

from functools import cache
from unittest.mock import patch

import numpy as np
import pytest
from situations import simulation

from houle.waves.dispersion import wave_number
from houle.waves.linear import Linear
from houle.waves.second_order import Kernel, SecondOrder
from houle.waves.wave import Components

DEPTH, GRAVITY, SPACING = 0.25, 9.81, 0.03125
OMEGA, AMPLITUDE = 2 * np.pi * np.array([2 / 3, 1.0]), np.array([0.008, 0.006])  # a period of 3 s together
BEGIN, END = 13.0, 16.0  # s


def pair(order):
    k = wave_number(OMEGA, DEPTH, GRAVITY)
    parts = Components(AMPLITUDE, OMEGA, k, np.zeros(2), np.zeros(2))
    wave = Linear.of("jonswap", 0.02, 1.2, DEPTH, GRAVITY, parts, 0.02, 0.0)
    return SecondOrder.of_linear(wave, True) if order == 2 else wave


@cache
def levels(order):
    """Times, places and elevations of the last 3 s."""
    case = {
        "case": {"name": "flume"},
        "domain": {"size": [10.0, 0.34375], "spacing": SPACING},
        "water": [{"below": DEPTH}],
        "waves": {
            "kind": "jonswap",
            "height": 0.02,
            "period": 1.2,
            "depth": DEPTH,
            "order": order,
            "piston": {"x": 0.5},
        },
        "sponge": [{"box": [[6.5, 0.0], [10.0, 0.34375]]}],
        "time": {"end": 100.0},
    }
    with patch("houle.case.model.make", lambda *_: pair(order)):
        sim = simulation(case)
    times, rows = [], []
    while sim.time < END:
        sim.advance(min(END, sim.time + 0.04))
        if sim.time > BEGIN:
            times.append(sim.time)
            rows.append(sim.flow.eta - DEPTH)
    return np.array(times), sim.grid.axis_points(0), np.array(rows)


def bound_and_free(order, sign):
    """Amplitudes [m] of the bound wave in theory and in the flume, and of the free wave of the same frequency."""
    time, x, eta = levels(order)
    line = Kernel.of(OMEGA[[1]], OMEGA[[0]], DEPTH, GRAVITY, sign)
    seen, steps = (x > 1.5) & (x < 6.0), np.gradient(time)
    found = 2 * (steps[:, None] * eta[:, seen] * np.exp(1j * line.omega * time[:, None])).sum(0) / steps.sum()
    free = wave_number(line.omega, DEPTH, GRAVITY)[0]
    waves = np.exp(1j * np.outer(x[seen], [line.wave[0], free, -free]))
    sizes = np.abs(np.linalg.lstsq(waves, found, rcond=None)[0])
    return 2 * AMPLITUDE[0] * AMPLITUDE[1] * abs(line.level[0]), sizes[0], sizes[1]


@pytest.mark.parametrize("sign", [-1, 1])
def test_bound_waves_leave_the_piston_without_free_ones(sign):
    """Their size to a tenth, of 0.4 and 0.6 mm, a hundredth of a cell; free ones a fifth of what first order sends."""
    known, bound, free = bound_and_free(2, sign)
    assert bound == pytest.approx(known, rel=0.1)
    assert free < 0.1 * bound
    if sign < 0:
        _, _, linear = bound_and_free(1, sign)
        assert free < linear / 5
