"""What all tests of waves share."""

import pytest
from places import DEPTH, GRAVITY, PLACES

from houle.waves.cnoidal import solitary
from houle.waves.theories import regular


@pytest.fixture(params=[*PLACES, "solitary"])
def wave(request):
    """One wave of every regular theory, and the solitary one."""
    if request.param == "solitary":
        return solitary(0.05, DEPTH, GRAVITY)
    return regular(request.param, *PLACES[request.param], DEPTH, GRAVITY)
