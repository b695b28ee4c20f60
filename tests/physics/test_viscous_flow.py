"""Fluids that are much more viscous than water: the step follows."""

import numpy as np
import pytest
from situations import DAM_BREAK, run, simulation


@pytest.mark.parametrize("scheme", ["houle", "jh2020"])
@pytest.mark.parametrize("walls", ["slip", "no-slip"])
def test_syrup_flows_slowly_and_stays_stable(scheme, walls):
    """With steps as long as for water it would end as spray: viscosity is explicit."""
    common = {"numerics__scheme": scheme, "domain__walls": walls, "domain__spacing": 0.01}
    water, syrup = simulation(DAM_BREAK, **common), simulation(DAM_BREAK, fluid__viscosity=0.05, **common)
    for each in (water, syrup):
        run(each, 10000, until=0.05)
    assert syrup.steps > 5 * water.steps
    assert np.abs(syrup.particles.velocity).max() < 0.7 * np.abs(water.particles.velocity).max()
