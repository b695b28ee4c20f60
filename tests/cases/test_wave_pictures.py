"""Pictures of waves: low ones are looked at from close by, and the sheet keeps its length."""

from __future__ import annotations

import numpy as np
import pytest

from houle import load
from houle.output.pictures import _times
from houle.output.section import SectionPicture

FLUME = {
    "case": {"name": "flume"},
    "domain": {"size": [10.0, 0.35], "spacing": 0.05},
    "water": [{"below": 0.25}],
    "waves": {"kind": "regular", "height": 0.01, "period": 1.2, "depth": 0.25, "zone": {"x": [0.0, 2.5]}},
    "time": {"end": 1.0},
}


@pytest.mark.parametrize(
    ("case", "amplitude", "close"),
    [(FLUME, 0.005, True), (FLUME, 0.04, False), ({**FLUME, "waves": None}, 0.005, False), (FLUME, 0.0, False)],
)
def test_low_waves_are_looked_at_from_close_by(case, amplitude, close):
    case = load({key: value for key, value in case.items() if value is not None})
    section = SectionPicture(case, [0.25 + amplitude])
    eta = 0.25 + amplitude * np.sin(np.linspace(0, 20, 200))
    section.look_close(eta)
    assert (section.floor > 0) is close
    assert section.floor < eta.min() and section.height > eta.max()
    if close:
        assert section.height - section.floor < 10 * amplitude


def test_the_last_two_panels_are_not_nearly_the_same():
    assert _times(np.array([0.0, 10.0, 20.0, 20.3]), None) == [0.0, 10.0, 20.3]
    assert _times(np.array([0.0, 10.0, 20.0, 30.0]), None) == [0.0, 10.0, 20.0, 30.0]
