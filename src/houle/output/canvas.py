"""A picture in pixels, painted back to front with NumPy: areas, lines, discs; words on top with Pillow.

Only what our pictures need. A plotting library would do it too, in ten times the time: half a second to be imported
and two more for four sheets, as long as a short run takes (docs/decisions/0009-pictures.md).

Points are (k, 2) pixels, x to the right and y down, (0, 0) the upper left corner of the picture. Edges are smoothed:
a pixel takes the share of a colour that covers it.
"""

from __future__ import annotations

import functools
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageColor, ImageDraw, ImageFont

from houle.grid import FloatArray
from houle.output.atomic import replacing

DPI = 150
FINER = 4  # times finer is a polygon drawn than its pixels
BLOCK = 200_000  # pixels looked at together
FAR = 1e4  # pixels: no line goes further
STRIDE = 0.6  # pixels between the dots that make a line

Box = tuple[int, int, int, int]  # left, upper, right, lower edge; the last two not included
Dashes = tuple[float, float]  # drawn, left out [pixels]


def pixels(points: float) -> float:
    """Of a length in typographic points."""
    return points * DPI / 72.0


@dataclass(frozen=True)
class Words:
    """Text with what is between dollar signs in italics; anchor as in Pillow: l, m, r and then t, m, s (base line)."""

    at: tuple[float, float]
    text: str
    size: float  # points
    colour: str
    anchor: str = "ls"
    bold: bool = False
    upward: bool = False  # read from below, centred
    halo: bool = False  # white around the letters


class Canvas:
    """`colours` (height, width, 3) from 0 to 255."""

    def __init__(self, width: int, height: int) -> None:
        self.colours = np.full((height, width, 3), 255, np.uint8)
        self.words: list[Words] = []

    @property
    def box(self) -> Box:
        return (0, 0, self.colours.shape[1], self.colours.shape[0])

    # ---- areas ---------------------------------------------------------------------------------------------------

    def blend(self, cover: NDArray, left: int, top: int, colour: ArrayLike, clip: Box | None = None) -> None:
        """A colour, or one per pixel (h, w, 3), over the picture as far as `cover` (h, w) from 0 to 1 says."""
        x0, y0, x1, y1 = clip or self.box
        x0, y0 = max(x0, left, 0), max(y0, top, 0)
        x1, y1 = min(x1, left + cover.shape[1], self.box[2]), min(y1, top + cover.shape[0], self.box[3])
        if x0 < x1 and y0 < y1:
            share = cover[y0 - top : y1 - top, x0 - left : x1 - left]
            rows, columns = np.nonzero(share)  # most of the box of a line is not covered
            paint = np.asarray(colour, np.float32)
            paint = paint[rows + y0 - top, columns + x0 - left] if paint.ndim == 3 else paint
            under = self.colours[rows + y0, columns + x0].astype(np.float32)
            mixed = under + share[rows, columns, None].astype(np.float32) * (paint - under)
            self.colours[rows + y0, columns + x0] = mixed + 0.5

    def rectangle(self, box: Box, colour: str) -> None:
        self.colours[box[1] : box[3], box[0] : box[2]] = rgb(colour)

    def polygon(self, points: FloatArray, colour: str, clip: Box, hatch: float = 0.0) -> None:
        """The inside of a polygon; hatch: only lines at 45 degrees, so many pixels apart."""
        corners = np.asarray(points, float)
        x0, y0 = (int(max(c, low)) for c, low in zip(np.floor(corners.min(axis=0)), clip[:2], strict=True))
        x1, y1 = (int(min(c, high)) for c, high in zip(np.ceil(corners.max(axis=0)), clip[2:], strict=True))
        if x0 >= x1 or y0 >= y1:
            return
        mask = Image.new("L", ((x1 - x0) * FINER, (y1 - y0) * FINER))
        fine = (corners - (x0, y0)) * FINER - 0.5
        ImageDraw.Draw(mask).polygon([tuple(corner) for corner in fine.tolist()], fill=255)
        cover = np.asarray(mask.reduce(FINER), np.float32) / 255.0
        if hatch:
            x, y = np.arange(x0, x0 + cover.shape[1]), np.arange(y0, y0 + cover.shape[0])[:, None]
            away = np.abs((x + y + 1.0) / np.sqrt(2.0) % hatch - 0.5 * hatch)
            cover = cover * np.clip(0.5 * pixels(0.5) + 0.5 - away, 0.0, 1.0)
        self.blend(cover, x0, y0, rgb(colour), clip)

    def under(self, points: FloatArray, colour: str, clip: Box) -> None:
        """The area below a curve whose x rises, to the lower edge of the clip; no area where it is NaN."""
        x0, y0, x1, y1 = clip
        top = np.interp(np.arange(x0, x1) + 0.5, points[:, 0], points[:, 1])
        cover = np.clip(np.arange(y0, y1)[:, None] + 1.0 - top, 0.0, 1.0)
        self.blend(np.nan_to_num(cover), x0, y0, rgb(colour), clip)

    # ---- lines and discs -----------------------------------------------------------------------------------------

    def line(self, points: FloatArray, colour: str, width: float, clip: Box, dashes: Dashes | None = None) -> None:
        """Through the points, with round ends; a gap where they are NaN. width in typographic points."""
        near = np.clip(np.asarray(points, float), -FAR, FAR)
        dots = [_dots(stretch, dashes) for stretch in _stretches(near)]
        self._dab(np.concatenate(dots), 0.0, pixels(width), colour, clip) if dots else None

    def rings(self, centres: FloatArray, radius: float, colour: str, width: float, clip: Box) -> None:
        """Open circles, white inside; lengths in typographic points."""
        self._dab(centres, 0.0, 2.0 * pixels(radius), "white", clip)
        self._dab(centres, pixels(radius), pixels(width), colour, clip)

    def _dab(self, centres: FloatArray, radius: float, width: float, colour: str, clip: Box) -> None:
        """Circles of a radius drawn with a pen of a width (radius 0: dots), together as opaque as one."""
        reach = int(np.ceil(radius + 0.5 * width + 0.5))
        x0, y0, x1, y1 = clip[0] - reach, clip[1] - reach, clip[2] + reach, clip[3] + reach
        where = centres[(centres >= (x0, y0)).all(axis=1) & (centres < (x1, y1)).all(axis=1)]
        if not len(where):
            return
        left, top = np.floor(where.min(axis=0)).astype(int) - reach
        right, bottom = np.floor(where.max(axis=0)).astype(int) + reach + 1
        cover = np.zeros((bottom - top) * (right - left))
        for _, place, distance in _around(where - (left, top), reach, right - left):
            ink = np.clip(0.5 * width + 0.5 - np.abs(distance - radius), 0.0, 1.0)
            np.maximum.at(cover, place.ravel(), ink.ravel())
        self.blend(cover.reshape(bottom - top, right - left), int(left), int(top), rgb(colour), clip)

    def discs(self, centres: FloatArray, radius: FloatArray, values: FloatArray, table: FloatArray, clip: Box) -> None:
        """Discs of a radius [pixels] each, coloured by their values from 0 to 1 in a table (k, 3) of colours.

        Where they overlap their values are averaged: the water between particles has no edges.
        """
        reach = int(np.ceil(radius.max(initial=0.0) + 0.5))
        x0, y0 = clip[0] - 2 * reach, clip[1] - 2 * reach
        shape = (clip[3] + 2 * reach - y0, clip[2] + 2 * reach - x0)
        low, high = (x0 + reach, y0 + reach), (x0 + shape[1] - reach, y0 + shape[0] - reach)
        keep = ((centres >= low) & (centres < high)).all(axis=1)
        radius, values = radius[keep, None], values[keep, None]
        cover, total = np.zeros(shape[0] * shape[1]), np.zeros(shape[0] * shape[1])
        for block, place, distance in _around(centres[keep] - (x0, y0), reach, shape[1]):
            share = np.clip(radius[block] + 0.5 - distance, 0.0, 1.0)
            cover += np.bincount(place.ravel(), share.ravel(), len(cover))
            total += np.bincount(place.ravel(), (share * values[block]).ravel(), len(cover))
        mean = np.clip(total / np.maximum(cover, 1e-9), 0.0, 1.0)
        colours = table[np.rint(mean * (len(table) - 1)).astype(int)].reshape(*shape, 3)
        self.blend(np.minimum(cover, 1.0).reshape(shape), x0, y0, colours, clip)

    # ---- words, and the file -------------------------------------------------------------------------------------

    def write(self, *at: float, text: str, size: float, colour: str, **look: Any) -> None:
        """Words on top of everything."""
        self.words.append(Words((at[0], at[1]), text, size, colour, **look))

    def image(self) -> Image.Image:
        picture = Image.fromarray(self.colours)
        for words in self.words:
            _set(picture, words)
        return picture

    def save(self, path: Path) -> Path:
        """PNG, whole or not at all."""
        with replacing(path) as temporary:
            temporary.write_bytes(_png(np.asarray(self.image())))
        return path


def _png(colours: NDArray[np.uint8]) -> bytes:
    """The file, without the filters that help photographs: three times as fast as Pillow's, and no larger."""
    import houle

    height, width, _ = colours.shape
    rows = np.zeros((height, 1 + 3 * width), np.uint8)  # a row begins with the number of its filter, 0: none
    rows[:, 1:] = colours.reshape(height, -1)
    per_metre = round(DPI / 0.0254)
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),  # 8 bits each of red, green, blue
        (b"pHYs", struct.pack(">IIB", per_metre, per_metre, 1)),
        (b"tEXt", b"Software\0houle " + houle.__version__.encode("latin-1")),
        (b"IDAT", zlib.compress(rows.tobytes(), 3)),
        (b"IEND", b""),
    )
    framed = (struct.pack(">I", len(d)) + kind + d + struct.pack(">I", zlib.crc32(kind + d)) for kind, d in chunks)
    return b"\x89PNG\r\n\x1a\n" + b"".join(framed)


def rgb(colour: str) -> NDArray[np.float32]:
    """(3,) from 0 to 255."""
    return np.array(ImageColor.getrgb(colour), np.float32)


def width_of(text: str, size: float, bold: bool = False) -> float:
    """Pixels that the words take."""
    return sum(font(size, bold, italic).getlength(part) for part, italic in _parts(text))


@functools.cache
def font(size: float, bold: bool = False, italic: bool = False) -> Any:
    """DejaVu Sans, which comes with matplotlib, found without importing it; size in typographic points."""
    name = "DejaVuSans" + {0: "", 1: "-Bold", 2: "-Oblique", 3: "-BoldOblique"}[bold + 2 * italic] + ".ttf"
    found = find_spec("matplotlib")
    for place in found.submodule_search_locations or () if found else ():
        file = Path(place) / "mpl-data" / "fonts" / "ttf" / name
        if file.exists():
            return ImageFont.truetype(str(file), pixels(size), layout_engine=ImageFont.Layout.BASIC)
    return ImageFont.load_default(pixels(size))


def _parts(text: str) -> list[tuple[str, bool]]:
    """Pieces of a text and whether they are in italics."""
    return [(part, bool(i % 2)) for i, part in enumerate(text.split("$")) if part]


def _set(picture: Image.Image, words: Words) -> None:
    width = width_of(words.text, words.size, words.bold)
    if words.upward:
        height = round(2.0 * pixels(words.size))
        small = Image.new("L", (round(width) + 2, height))
        draw = ImageDraw.Draw(small)
        draw.text((1.0, height / 2), words.text, 255, font(words.size, words.bold), "lm")
        x, y = (round(c - n / 2) for c, n in zip(words.at, (height, small.width), strict=True))
        picture.paste(words.colour, (x, y), small.transpose(Image.Transpose.ROTATE_90))
        return
    draw = ImageDraw.Draw(picture)
    left = words.at[0] - {"l": 0.0, "m": 0.5, "r": 1.0}[words.anchor[0]] * width
    for part, italic in _parts(words.text):
        kind = font(words.size, words.bold, italic)
        stroke: Any = {"stroke_width": 3, "stroke_fill": "white"} if words.halo else {}
        if words.halo:
            draw.text((left, words.at[1]), part, "white", kind, "l" + words.anchor[1], **stroke)
        draw.text((left, words.at[1]), part, words.colour, kind, "l" + words.anchor[1])
        left += kind.getlength(part)


def _stretches(points: FloatArray) -> list[FloatArray]:
    """The points between gaps."""
    known = np.isfinite(points).all(axis=1)
    return [s for s in np.split(points, np.flatnonzero(np.diff(known)) + 1) if len(s) and np.isfinite(s[0]).all()]


def _dots(points: FloatArray, dashes: Dashes | None) -> FloatArray:
    """Points (k, 2) along a polyline, STRIDE apart."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    where = np.linspace(0.0, along[-1], 2 + int(along[-1] / STRIDE))
    if dashes:
        where = where[where % sum(dashes) <= dashes[0]]
    return np.stack([np.interp(where, along, points[:, a]) for a in range(2)], axis=-1)


def _around(points: FloatArray, reach: int, width: int) -> Iterator[tuple[slice, NDArray[np.int64], FloatArray]]:
    """A block of points (k), their neighbour pixels (k, m), and the distances (k, m) from the centres of these."""
    i, j = (offset.ravel() for offset in np.mgrid[-reach : reach + 1, -reach : reach + 1])
    near = np.hypot(np.abs(i) - 0.5, np.abs(j) - 0.5) < reach  # not the corners of the square
    i, j = i[near], j[near]
    size = max(1, BLOCK // len(i))
    for block in (slice(start, start + size) for start in range(0, len(points), size)):
        corner = np.floor(points[block])
        dx, dy = (points[block] - corner - 0.5).T[..., None]
        x, y = corner.astype(np.int64).T[..., None]
        yield block, (y + i) * width + x + j, np.sqrt((dx - j) ** 2 + (dy - i) ** 2)
