"""Velocities are asked for every step: 1e5 points in well under 50 ms. The limits leave room for a busy machine."""

import time

import numpy as np
import pytest
from places import DEPTH, GRAVITY

from houle.waves.spectra import irregular
from houle.waves.theories import regular


def best(call, times=5):
    spans = []
    for _ in range(times):
        start = time.perf_counter()
        call()
        spans.append(time.perf_counter() - start)
    return min(spans)


@pytest.mark.parametrize("theory", ["airy", "stokes-5", "fenton", "cnoidal"])
def test_scattered_points(theory):
    wave = regular(theory, 0.04, 1.2 if theory != "cnoidal" else 4.0, DEPTH)
    draw = np.random.default_rng(1)
    x, z = draw.random(100_000) * 7, draw.random(100_000) * DEPTH
    assert best(lambda: wave.velocity(x, z, 0.3)) < 0.15


def test_random_sea_on_a_grid():
    """200 components on 200 x 50: a tenth of the points one by one takes longer."""
    wave = irregular("jonswap", 0.04, 1.2, DEPTH, GRAVITY)
    x, z = np.linspace(0, 2, 200), np.linspace(0, 0.5, 50)
    on_grid = best(lambda: wave.velocity_on(x, z, 0.3))
    assert on_grid < best(lambda: wave.velocity(x[::10, None], z, 0.3))
