"""Small pictures for a repository."""

from __future__ import annotations

from pathlib import Path

from PIL import Image

from houle.output.atomic import replacing

LIMIT = 190_000  # bytes, above which colours are given up


def pack(path: Path) -> Path:
    """The PNG in place of itself, packed as far as it goes; with 256 colours, dithered, if it is still too large."""
    with Image.open(path) as picture:
        whole = picture.convert("RGB")
    _save(whole, path)
    if path.stat().st_size > LIMIT:
        dither = Image.Dither.FLOYDSTEINBERG
        palette = whole.quantize(256, method=Image.Quantize.MEDIANCUT)
        _save(whole.quantize(palette=palette, dither=dither), path)
    return path


def _save(picture: Image.Image, path: Path) -> None:
    with replacing(path) as temporary:
        picture.save(temporary, format="PNG", optimize=True)
