"""Marks cover the area they should, whatever they lie on; axes have round numbers; the file holds the pixels."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from houle.output.canvas import DPI, Canvas, pixels, rgb
from houle.output.drawing import Panel, pressures, ticks

BOX = (0, 0, 200, 100)


def ink(canvas):
    """Area [pixels] that black covers on white."""
    return float((1.0 - canvas.colours[..., 0] / 255.0).sum())


@given(st.floats(0, np.pi), st.floats(1, 3), st.floats(0, 1))
def test_a_line_covers_its_length_times_its_width_at_any_angle(angle, width, shift):
    canvas, half = Canvas(200, 100), 40.0 * np.array([np.cos(angle), np.sin(angle)])
    middle = np.array([100.0, 50.0]) + shift
    canvas.line(np.stack([middle - half, middle + half]), "black", width, BOX)
    thick = pixels(width)
    assert ink(canvas) == pytest.approx(80.0 * thick + np.pi / 4 * thick**2, rel=0.06)  # with round ends


def test_a_line_has_gaps_where_it_is_not_known_and_ends_at_the_clip():
    canvas = Canvas(200, 100)
    x = np.arange(-50.0, 250.0)
    y = np.where((x > 50) & (x < 150), np.nan, 50.0)
    canvas.line(np.stack([x, y], axis=-1), "black", 2.0, (20, 0, 180, 100))
    drawn = np.flatnonzero((canvas.colours[..., 0] < 255).any(axis=0))
    assert drawn.min() == 20 and drawn.max() == 179 and not ((drawn > 54) & (drawn < 146)).any()


@given(st.floats(3, 40), st.floats(0, 1))
def test_a_polygon_covers_its_area(size, shift):
    canvas, corner = Canvas(200, 100), np.array([50.0, 30.0]) + shift
    canvas.polygon(corner + size * np.array([[0, 0], [2, 0], [2, 1], [0, 1.0]]), "black", BOX)
    assert ink(canvas) == pytest.approx(2 * size**2, abs=6 * size * 0.26 + 1)  # to a quarter of a pixel at the edges


def test_a_slope_goes_on_beyond_the_clip():
    canvas = Canvas(200, 100)
    canvas.polygon(np.array([[-100, 100], [300, 100], [100, -100.0]]), "black", BOX)
    assert ink(canvas) == pytest.approx(200 * 100, rel=0.01)


@given(st.floats(1, 6), st.floats(0, 1))
def test_a_disc_covers_its_area_and_discs_on_top_of_each_other_are_one(radius, shift):
    one, same = Canvas(200, 100), Canvas(200, 100)
    table = np.zeros((2, 3))
    for canvas, count in ((one, 1), (same, 3)):
        where = np.full((count, 2), 50.0 + shift)
        canvas.discs(where, np.full(count, radius), np.zeros(count), table, BOX)
    assert ink(one) == pytest.approx(np.pi * radius**2, rel=0.12)
    assert ink(one) <= ink(same) <= np.pi * (radius + 0.75) ** 2


def test_overlapping_discs_have_the_colour_of_the_mean():
    canvas, table = Canvas(200, 100), pressures()
    canvas.discs(np.full((2, 2), 50.0), np.full(2, 5.0), np.array([0.2, 0.6]), table, BOX)
    np.testing.assert_allclose(canvas.colours[50, 50], table[round(0.4 * 255)], atol=1)


def test_the_area_under_a_curve_ends_where_the_curve_is_not_known():
    canvas = Canvas(200, 100)
    canvas.under(np.array([[0.0, 40.0], [100.0, 40.0], [101.0, np.nan], [200.0, np.nan]]), "black", BOX)
    assert ink(canvas) == pytest.approx(60 * 100, rel=0.02)


def test_the_file_holds_the_pixels_and_their_size(tmp_path):
    canvas = Canvas(200, 100)
    canvas.rectangle((10, 20, 30, 40), "#1f5f8b")
    canvas.write(50.0, 50.0, text="$n$ = 0.4 ±2", size=8, colour="black")
    with Image.open(canvas.save(tmp_path / "a.png")) as image:
        image.load()
        assert image.mode == "RGB" and image.size == (200, 100) and round(image.info["dpi"][0]) == DPI
        assert image.text["Software"].startswith("houle ")
        got = np.asarray(image)
    np.testing.assert_array_equal(got, np.asarray(canvas.image()))
    assert (got[20:40, 10:30] == rgb("#1f5f8b")).all() and (got[40:55, 50:150] < 128).any()


@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6))
def test_ticks_are_few_round_and_inside(low, span):
    high = low + max(span, 1e-9 * abs(low))
    numbers, words = ticks(low, high)
    assert len(numbers) == len(words) <= 7 and len(set(words)) == len(words)
    slack = 1e-6 * (high - low) + 1e-12 * abs(low)
    assert (numbers >= low - slack).all() and (numbers <= high + slack).all()
    for number, word in zip(numbers, words, strict=True):
        assert float(word.replace("−", "-")) == pytest.approx(number, rel=1e-9, abs=1e-6 * (high - low))


def test_a_panel_places_its_corners():
    panel = Panel(Canvas(200, 100), (20, 10, 180, 90))
    panel.limits((0.0, 2.0), (1.0, 3.0))
    np.testing.assert_allclose(panel.place([0.0, 2.0], [1.0, 3.0]), [[20, 90], [180, 10]])
