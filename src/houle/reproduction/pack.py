"""Packing of pictures, so that they are small enough for a repository."""

from __future__ import annotations

from pathlib import Path

from PIL import Image

from houle.output.atomic import replacing

LIMIT = 190_000  # bytes from which on a picture gets 256 colours


def pack(path: Path) -> Path:
    """Packs a PNG as far as it goes, in its place; with 256 colours, dithered, if it is still too large."""
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
