"""movie.mp4: the pressure picture in motion. Needs imageio and imageio-ffmpeg, which bring their own encoder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle.frame import Frame
from houle.grid import Grid
from houle.output.atomic import OutputError, replacing
from houle.output.section import Section, colour_bar, highest_pressure

NAME = "movie.mp4"
BLOCK = 16  # pixels: encoders want sizes that are multiples of it


def write_movie(path: Path | str, case: Any, grid: Grid, fields: Any, rate: float = 25.0) -> Path:
    """One picture per frame of the run, `rate` of them in a second. OutputError when the encoder is not installed."""
    path = Path(path)
    try:
        import imageio.v2 as imageio
        import imageio_ffmpeg  # noqa: F401
    except ImportError as error:
        cure = 'install the encoder: pip install "houle[movie]"'
        raise OutputError(path, f"the package {error.name} is not installed", cure) from None
    frames = [fields.frame(i) for i in range(0, len(fields), max(1, len(fields) // 20))]  # some, for the scales
    section = Section(case, grid, [np.max(frame.position[:, -1], initial=0.0) for frame in frames])
    top = highest_pressure(frames)
    options: Any = {"format": "FFMPEG", "mode": "I", "fps": rate, "quality": 8}
    get_writer: Any = imageio.get_writer
    with replacing(path) as temporary, get_writer(temporary, **options) as writer:
        for i in range(len(fields)):
            writer.append_data(_image(section, fields.frame(i), top))
    return path


def _image(section: Section, frame: Frame, top: float) -> NDArray[np.uint8]:
    """One picture (height, width, 3)."""
    page = section.sheet(1, f"pressure of the particles  ·  t = {frame.time:.3f} s", below=0.45)
    section.draw_particles(page.panels[0], frame, top)
    section.draw_outlines(page.panels[0], frame.time, dashed=True)
    page.frames("x [m]", "z [m]")
    colour_bar(page, 0.0, top / 1e3, "pressure [kPa]")
    pixels = np.asarray(page.canvas.image())
    more = [(0, -n % BLOCK) for n in pixels.shape[:2]]
    return np.pad(pixels, (*more, (0, 0)), constant_values=255)
