"""What columns hold below a level: in water, in a porous body, over a solid bed, in two and in three dimensions."""

from __future__ import annotations

import numpy as np
import pytest
from situations import simulation

from houle.medium.columns import Storage

CASE = {
    "case": {"name": "storage"},
    "domain": {"size": [0.4, 0.3], "spacing": 0.05},
    "water": [{"below": 0.23}],
    "porous": [{"name": "rock", "box": [[0.2, 0.0], [0.4, 0.15]], "porosity": 0.4, "resistance": {"a": 1.0, "b": 0.0}}],
    "solid": [{"box": [[0.0, 0.0], [0.1, 0.1]]}],
    "time": {"end": 1.0},
}


def test_amount_and_moment_of_the_water_below_a_level():
    sim = simulation(CASE)
    storage, level = Storage.of(sim.grid, sim.medium), np.full(8, 0.23)
    held = 0.1 * 0.13 + 0.1 * 0.23 + 0.2 * (0.4 * 0.15 + 0.08)
    moment = 0.1 * (0.23**2 - 0.1**2) / 2 + 0.1 * 0.23**2 / 2 + 0.2 * (0.4 * 0.15**2 + 0.23**2 - 0.15**2) / 2
    assert storage.mean_level(level) == pytest.approx(held / 0.4, rel=1e-12)
    assert storage.height_moment(level) == pytest.approx(moment, rel=1e-12)
    level[[0, 5]] = np.nan  # dry
    assert storage.mean_level(level) == pytest.approx((held - 0.05 * 0.13 - 0.05 * 0.14) / 0.4, rel=1e-12)


def test_no_water_is_counted_above_the_lid():
    deep = {**CASE, "domain": {"size": [0.4, 0.1, 0.3], "spacing": 0.05}, "porous": [], "solid": []}
    sim = simulation(deep)
    storage = Storage.of(sim.grid, sim.medium)
    assert storage.height_moment(np.full((8, 2), 0.23)) == pytest.approx(0.4 * 0.1 * 0.23**2 / 2, rel=1e-12)
    assert storage.height_moment(np.full((8, 2), 0.31)) == pytest.approx(0.4 * 0.1 * 0.3**2 / 2, rel=1e-12)
