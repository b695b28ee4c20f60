"""A slice of the campaign of random geometries: nothing gains energy, blows up or turns non-finite."""

from __future__ import annotations

import pytest

from campaigns.geometries import campaign


@pytest.mark.parametrize("first", [200, 300, 400])
def test_random_geometries_make_no_energy(first):
    """Four of each hundred of seed 1; `python tests/campaigns/geometries.py` runs more."""
    failed = [o for o in campaign(1, 4, first=first) if o.failure]
    assert not failed, failed[0]
