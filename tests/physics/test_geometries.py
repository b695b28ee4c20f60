"""A slice of the campaign of random geometries: nothing gains energy, blows up or turns non-finite."""

from __future__ import annotations

import pytest

from campaigns.geometries import campaign, random_case, run


@pytest.mark.parametrize("first", [200, 300, 400])
def test_random_geometries_make_no_energy(first):
    """Four of each hundred of seed 1; `python tests/campaigns/geometries.py` runs more."""
    failed = [o for o in campaign(1, 4, first=first) if o.failure]
    assert not failed, failed[0]


@pytest.mark.parametrize(("seed", "number"), [(1, 34), (1, 87), (1, 127), (1, 187), (2, 79)])
def test_geometries_that_once_made_energy_make_none(seed, number):
    """APIC and FLIP beside interfaces (34, 127, 187), FLIP at a slit (87), large particles in Taylor's Gaussian."""
    outcome = run(random_case(seed, number))
    assert not outcome.failure, outcome
