"""Words, panels and PNG files, which we make ourselves, are those that matplotlib makes."""

import io

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread
from PIL import Image

from houle.output.drawing import Panel, scale
from houle.output.lettering import Canvas
from houle.output.png import png


def ink(canvas, words, **look):
    """How dark the pixels are (0 to 1) with these words in the middle."""
    figure = Figure(figsize=(2.0, 2.0), dpi=150)
    figure.text(0.5, 0.5, words, **look)
    made = canvas(figure)
    made.draw()
    return 1.0 - np.asarray(made.buffer_rgba())[..., :3].mean(axis=-1) / 255.0


@pytest.mark.parametrize("rotation", [0, 90, 30])
@pytest.mark.parametrize("ha, va", [("left", "baseline"), ("center", "center"), ("right", "top")])
@pytest.mark.parametrize("words", ["Energy, −0.25 [10⁻³ J/m]", r"$x^2$"])
def test_words_stand_where_matplotlib_sets_them(rotation, ha, va, words):
    look = {"rotation": rotation, "ha": ha, "va": va, "fontsize": 8.5, "color": "#1f5f8b"}
    ours, theirs = ink(Canvas, words, **look), ink(FigureCanvasAgg, words, **look)
    assert ours.sum() == pytest.approx(theirs.sum(), rel=0.1) and theirs.sum() > 20
    for axis in (0, 1):
        at = np.arange(ours.shape[axis])
        middles = [float((image.sum(axis=1 - axis) * at).sum() / image.sum()) for image in (ours, theirs)]
        assert middles[0] == pytest.approx(middles[1], abs=1.0)
        ends = [np.flatnonzero(image.sum(axis=1 - axis) > 0.2)[[0, -1]] for image in (ours, theirs)]
        np.testing.assert_allclose(*ends, atol=3)


def test_words_are_as_pale_as_they_are_said_to_be():
    full, half = (ink(Canvas, "water", alpha=alpha).sum() for alpha in (None, 0.5))
    assert half == pytest.approx(0.5 * full, rel=0.02)


def test_a_panel_is_axes_without_ticks():
    drawn = []
    for kind in (Panel, Axes):
        figure = Figure(figsize=(2.0, 2.0), dpi=150)
        panel = figure.add_axes((0.2, 0.2, 0.6, 0.6), axes_class=kind)
        panel.set(xlim=(1, 2), ylim=(1, 2), **({"xticks": [], "yticks": []} if kind is Axes else {}))
        panel.plot([0, 3], [0, 3])
        drawn.append(Canvas(figure).pixels())
    np.testing.assert_array_equal(*drawn)
    assert not panel_has_ticks(Panel) and panel_has_ticks(Axes)


def panel_has_ticks(kind):
    panel = Figure().add_axes((0, 0, 1, 1), axes_class=kind)
    return any("majorTicks" in vars(axis) for axis in (panel.xaxis, panel.yaxis))


def test_numbers_stand_in_the_middle_of_their_ticks():
    drawn = []
    for numbers in (False, True):
        figure = Figure(figsize=(2.0, 2.0), dpi=150)
        panel = figure.add_axes((0.3, 0.3, 0.6, 0.6), axes_class=Panel)
        panel.set(xlim=(1, 3), ylim=(1, 3))
        scale(panel, sideways=False, numbers=numbers, most=2)
        scale(panel, sideways=True, numbers=numbers, most=2)
        drawn.append(255 - Canvas(figure).pixels().astype(int).mean(axis=-1))
    ink = drawn[1] - drawn[0]
    assert ink.sum() > 1000 and (ink[:220, 85:] == 0).all()  # below and at the left
    for image, ticks in ((ink[220:].sum(axis=0), (90, 180, 270)), (ink[:220].sum(axis=1), (30, 120, 210))):
        for tick in ticks:
            piece = image[tick - 10 : tick + 10]
            assert (piece * np.arange(-9.5, 10)).sum() / piece.sum() == pytest.approx(
                0.0, abs=2.0
            )  # digits are lopsided


def test_a_png_file_holds_the_pixels_the_resolution_and_the_words():
    pixels = np.random.default_rng(1).integers(0, 256, (7, 5, 3), np.uint8)
    data = png(pixels, 150, {"Software": "houle"})
    np.testing.assert_array_equal(np.round(255 * imread(io.BytesIO(data))).astype(np.uint8), pixels)
    with Image.open(io.BytesIO(data)) as image:
        assert image.info["Software"] == "houle" and image.info["dpi"] == pytest.approx((150, 150), abs=0.02)
