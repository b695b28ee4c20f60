"""Words of pictures find a free place: never on each other, and not on the outlines of structures."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Annotation

from houle import load
from houle.output import drawing
from houle.output.labels import apart, near_points
from houle.output.section import SectionPicture, case_sheet

WALL = [[10.9, 0.5], [11.2, 0.5], [11.2, 0.56], [11.0, 0.56], [11.0, 0.7], [10.9, 0.7]]
CROWN = {
    "case": {"name": "crown"},
    "domain": {"size": [16.0, 1.0], "spacing": 0.025},
    "water": [{"below": 0.5}],
    "porous": [
        {
            "name": name,
            "porosity": n,
            "resistance": {"a": 1.0, "b": 10.0},
            "polygon": [[9.5 + i, 0.0], [12.5 - i, 0.0], [11.3 - 0.3 * i, top], [10.7 + 0.3 * i, top]],
        }
        for i, (name, n, top) in enumerate([("armour", 0.47, 0.66), ("core", 0.4, 0.46)])
    ],
    "solid": [{"name": "wall", "polygon": WALL}],
    "gauge": [{"x": 4.0}, {"x": 4.1}, {"x": 9.9, "name": "toe"}],
    "sensor": [{"at": [10.89, z]} for z in (0.52, 0.58, 0.64)] + [{"at": [x, 0.3]} for x in (10.6, 11.0, 11.4)],
    "time": {"end": 1.0},
}  # fmt: skip


@given(st.lists(st.tuples(st.floats(0, 500), st.floats(5, 60)), min_size=1, max_size=9))
def test_words_of_any_length_stand_side_by_side_in_their_order(words):
    at, wide = (np.array(column) for column in zip(*words, strict=True))
    placed = at + apart(at.tolist(), wide.tolist(), 0.0, 500.0)
    order = np.argsort(at, kind="stable")
    gaps = 0.5 * (wide[order][1:] + wide[order][:-1])
    assert (np.diff(placed[order]) >= gaps - 1e-6).all()


@given(st.lists(st.tuples(st.floats(20, 480), st.floats(20, 180)), min_size=1, max_size=12, unique=True))
def test_words_near_points_never_stand_on_each_other(points):
    at = np.array(points)
    sizes = np.tile([18.0, 8.0], (len(at), 1))
    found = near_points(at, sizes, (500.0, 200.0), shapely.box(200, 0, 300, 150), [100.0])
    for one, other in itertools.combinations(found, 2):
        assert (np.abs(one - other) >= sizes[0] - 1e-6).any()
    assert ((found >= 0.5 * sizes - 1e-6) & (found <= [500.0, 200.0] - 0.5 * sizes + 1e-6)).all()


@pytest.mark.parametrize("case", [CROWN, "breakwater"], ids=["crown", "breakwater"])
@pytest.mark.parametrize("run", [False, True])
def test_no_word_stands_on_the_outline_of_a_structure(case, run):
    case = load(case)
    with drawing.style():
        if run:
            picture = SectionPicture(case, [0.5])
            page = picture.sheet(1, "words")
            picture.draw(page.panels[0], 0.0)
            picture.name(page)
        else:
            picture, page = SectionPicture(case), case_sheet(case)
        panel = page.panels[0]
        page.figure.draw(renderer := FigureCanvasAgg(page.figure).get_renderer())
    bodies = [shapely.transform(area, panel.transData.transform) for area in (*picture.porous, picture.solid)]
    frame = panel.get_window_extent(renderer)
    words = [text for text in panel.texts if isinstance(text, Annotation) and len(text.get_text()) > 1]
    boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in words]
    shown = [(words, b) for words, b in boxes if frame.y0 < b.y0 < b.y1 < frame.y1 + 1 and b.x0 > frame.x0]
    assert {sensor.name for sensor in case.sensor} <= {words for words, _ in shown}
    for text, box in shown:
        on = [body for body in bodies if shapely.box(*box.extents).intersects(shapely.boundary(body))]
        assert not on, f"{text!r} stands on the outline of a structure"


def test_the_section_of_a_run_is_that_of_its_check():
    """The key of the case is the same, and so is what is drawn of bodies: one painter."""
    case = load(CROWN)
    keys = [[handle.get_label() for handle in SectionPicture(case, levels).key()] for levels in (None, [0.55])]
    assert keys[0] == keys[1] == [
        "armour, n = 0.47", "core, n = 0.4", "solid", "still water level", "gauge", "sensor",
    ]  # fmt: skip
