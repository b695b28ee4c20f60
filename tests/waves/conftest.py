"""What all tests of waves share."""

import pytest
from places import DEPTH, GRAVITY, PLACES

from houle.waves.cnoidal import solitary
from houle.waves.theories import regular


@pytest.fixture(params=[*PLACES, "solitary-3", "solitary-5"])
def wave(request):
    """One wave of every regular theory, and the solitary ones."""
    if request.param.startswith("solitary"):
        return solitary(0.05, DEPTH, GRAVITY, order=int(request.param[-1]))
    return regular(request.param, *PLACES[request.param], DEPTH, GRAVITY)
