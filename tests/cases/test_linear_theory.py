"""[reflection]: a rectangle is a block however it is drawn; all else is solved, or the reason is told."""

import pytest

from houle.case.model import load
from houle.results import reflection

BOX = {"box": [[5.0, 0.0], [6.0, 0.4]]}
FLUME = {
    "case": {"name": "flume"},
    "domain": {"size": [10.0, 0.4], "spacing": 0.02},
    "water": [{"below": 0.25}],
    "waves": {"kind": "regular", "height": 0.02, "period": 1.2, "depth": 0.25, "zone": {"x": [0.0, 2.5]}},
    "porous": [{**BOX, "porosity": 0.45, "resistance": {"a": 3.0, "b": 50.0}}],
    "sponge": [{"box": [[7.5, 0.0], [10.0, 0.4]]}],
    "gauge": [{"name": "A", "x": 3.0}, {"name": "B", "x": 3.3}],
    "reflection": {"structure": [5.0, 6.0], "gauges": ["A", "B"]},
    "time": {"end": 20.0},
}


def block(shape=BOX, **tables):
    return load(
        {**FLUME, "porous": [{**{k: v for k, v in FLUME["porous"][0].items() if k != "box"}, **shape}], **tables}
    )


@pytest.mark.parametrize(
    "corners",
    [
        [[5, 0], [6, 0], [6, 0.4], [5, 0.4]],
        [[6, 0.4], [6, 0], [5, 0], [5, 0.4]],
        [[5, 0], [5.5, 0], [6, 0], [6, 0.4], [5, 0.4], [5, 0]],
    ],
)
def test_a_rectangle_given_as_a_polygon_has_the_theory_of_the_box(corners):
    assert reflection.theory(block({"polygon": corners}), 0.02) == reflection.theory(block(), 0.02)


BEHIND_A_WALL = {"sponge": [], "domain": {"size": [6.0, 0.4], "spacing": 0.02}}


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (block({"polygon": [[5, 0], [6, 0], [6, 0.4], [5.2, 0.4]]}), "porous.porous-1 is no upright rectangle"),
        (block({"box": [[5.0, 0.0], [6.0, 0.2]]}), "not from the bed through the surface at 0.25 m"),
        (block({"box": [[5.5, 0.0], [6.0, 0.4]]}), "its face is at x = 5.5 m, reflection.structure begins at 5 m"),
        (block(solid=[{"box": [[6.2, 0.0], [6.5, 0.1]]}]), "solid.solid-1 stands in the flume"),
        (block(sponge=[]), "nothing absorbs the waves that pass"),
        (block(porous=[]), "0 porous bodies"),
        (block(waves={**FLUME["waves"], "kind": "jonswap"}), 'waves.kind = "jonswap"'),
    ],
)
def test_why_it_is_no_block_is_told(case, words):
    assert reflection.theory(case, 0.02) is None and words in reflection.no_block(case)


def test_a_wall_right_behind_it_is_as_good_as_a_sponge():
    assert reflection.theory(block(**BEHIND_A_WALL), 0.02).transmitted == 0


def test_what_is_no_block_is_solved_and_a_block_nearly_the_same():
    """A box that ends in a slope of half a centimetre reflects and transmits as the box does."""
    nearly = block({"polygon": [[5, 0], [6.005, 0], [6, 0.4], [5, 0.4]]})
    found, known = reflection.beside(nearly, 0.02)["theory"], reflection.beside(block(), 0.02)["theory"]
    assert "friction" in known and "friction" not in found
    assert found["C_R"] == pytest.approx(known["C_R"], abs=0.01)
    assert found["C_T"] == pytest.approx(known["C_T"], abs=0.01)


def test_a_sea_and_a_solid_bar_have_a_theory():
    sea = block(waves={**FLUME["waves"], "kind": "jonswap", "seed": 1})
    assert 0.2 < reflection.beside(sea, 0.02)["theory"]["C_R"] < 0.9
    bar = block(porous=[], solid=[{"polygon": [[5, 0], [5.5, 0.15], [6, 0]]}])
    found = reflection.beside(bar, 0.02)["theory"]
    assert 0.01 < found["C_R"] < 0.3 and found["C_D"] == pytest.approx(0.0, abs=0.01)


def test_where_there_is_no_theory_the_reason_is_told():
    leans = {"polygon": [[5, 0], [6, 0], [6, 0.4], [5.2, 0.4]]}
    two = block(leans, water=[{"below": 0.25}, {"box": [[9.0, 0.0], [10.0, 0.2]]}])
    assert "not one level" in reflection.beside(two, 0.02)["no_theory"]
    slope = block(porous=[], solid=[{"polygon": [[5, 0], [6, 0.4], [10, 0.4], [10, 0]]}])
    assert "all of it comes back" in reflection.beside(slope, 0.02)["no_theory"]
    near = block(
        {"polygon": [[0.45, 0], [1, 0], [1, 0.4], [0.5, 0.4]]},
        waves={**FLUME["waves"], "zone": {"x": [0.0, 0.1]}},
        gauge=[{"name": "A", "x": 0.2}, {"name": "B", "x": 0.3}],
        reflection={"structure": [0.45, 1.0], "gauges": ["A", "B"]},
    )
    assert "less than 2 depths" in reflection.beside(near, 0.02)["no_theory"]
