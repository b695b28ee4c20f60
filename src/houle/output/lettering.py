"""Words of a picture, each set whole by Pillow: glyph by glyph, as matplotlib does it, takes ten times as long."""

from __future__ import annotations

from functools import cache
from math import ceil, floor
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from matplotlib.colors import to_rgba
from matplotlib.font_manager import FontProperties, findfont
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont


class Canvas(FigureCanvasAgg):
    """Draws a figure with `Lettering`."""

    def get_renderer(self) -> RendererAgg:
        return Lettering(*self.get_width_height(physical=True), self.figure.dpi)

    def pixels(self) -> NDArray[np.uint8]:
        """The figure drawn, (height, width, 3): red, green, blue."""
        self.draw()
        return np.asarray(self.buffer_rgba())[..., :3]


class Lettering(RendererAgg):
    """Words that lie flat or stand upright; mathematics and other angles are left to matplotlib."""

    def draw_text(
        self,
        gc: Any,
        x: float,
        y: float,
        s: str,
        prop: FontProperties,
        angle: float,
        ismath: Any = False,
        mtext: Any = None,
    ) -> None:
        if ismath or angle not in (0.0, 90.0):
            super().draw_text(gc, x, y, s, prop, angle, ismath, mtext)
            return
        along = y if angle else x
        start, part = floor(along), float(along % 1.0)
        ink, left, top = _ink(s, self._font(prop), -part % 1.0 if angle else part)
        if angle:  # the bottom of the words lies at the right, and they run upwards
            start += part > 0.0
            ink, left, top = np.rot90(ink), top, -left - ink.shape[1]
            column, row = round(x) + left, start + top
        else:
            column, row = start + left, round(y) + top
        image = np.empty((*ink.shape, 4), np.uint8)
        *colour, alpha = to_rgba(gc.get_rgb(), gc.get_alpha() if gc.get_forced_alpha() else None)
        image[..., :3] = np.round(255 * np.array(colour))
        image[..., 3] = np.round(ink * alpha)
        self.draw_image(gc, column, self.height - row - len(image), image[::-1].copy())

    def get_text_width_height_descent(self, s: str, prop: FontProperties, ismath: Any) -> tuple[float, float, float]:
        if ismath:
            return super().get_text_width_height_descent(s, prop, ismath)
        left, top, right, bottom = _box(s, self._font(prop))
        return right - left, bottom - top, bottom

    def _font(self, prop: FontProperties) -> ImageFont.FreeTypeFont:
        return _font(findfont(prop), self.points_to_pixels(prop.get_size_in_points()))


@cache
def _font(path: str, pixels: float) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(path, pixels, layout_engine=ImageFont.Layout.BASIC)


@cache
def _box(words: str, font: ImageFont.FreeTypeFont) -> tuple[float, float, float, float]:
    """Left, top, right and bottom of the ink about the start of the base line [pixels], y downwards."""
    return font.getbbox(words, anchor="ls")


def _ink(words: str, font: ImageFont.FreeTypeFont, part: float) -> tuple[NDArray[np.uint8], int, int]:
    """How much the words cover the pixels (0 to 255), and where the image begins beside the start of the base line,
    which lies `part` of a pixel to the right of a border between two."""
    left, top, right, bottom = _box(words, font)
    left, top, right, bottom = floor(left) - 1, floor(top), ceil(right) + 2, ceil(bottom)
    image = Image.new("L", (right - left, bottom - top))
    ImageDraw.Draw(image).text((part - left, -top), words, fill=255, font=font, anchor="ls")
    return np.asarray(image), left, top
