"""movie.mp4: the pressure picture in motion. Needs imageio and imageio-ffmpeg, which bring their own encoder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Normalize
from numpy.typing import NDArray

from houle.case.model import Case
from houle.flow.snapshot import Snapshot
from houle.output import drawing
from houle.output.atomic import OutputError, replacing
from houle.output.drawing import colour_bar
from houle.output.fields import FieldsReader
from houle.output.pressure import BAR, pressure_scale
from houle.output.section import SectionPicture

NAME = "movie.mp4"
BLOCK = 16  # pixels: encoders want sizes that are multiples of it


def write_movie(path: Path | str, case: Case, fields: FieldsReader, rate: float = 25.0) -> Path:
    """Writes a film of all frames, `rate` of them a second. OutputError when the encoder is not installed."""
    path = Path(path)
    try:
        import imageio.v2 as imageio
        import imageio_ffmpeg  # noqa: F401
    except ImportError as error:
        cure = 'install the encoder: pip install "houle[movie]"'
        raise OutputError(path, f"the package {error.name} is not installed", cure) from None
    frames = [fields.frame(i) for i in range(0, len(fields), max(1, len(fields) // 20))]  # some, for the scales
    section = SectionPicture(case, [np.max(frame.position[:, -1], initial=0.0) for frame in frames])
    options: Any = {"format": "FFMPEG", "mode": "I", "fps": rate, "quality": 8}
    get_writer: Any = imageio.get_writer
    with drawing.style(), replacing(path) as temporary, get_writer(temporary, **options) as writer:
        film = _Film(section, frames[0], pressure_scale(frames))
        for i in range(len(fields)):
            writer.append_data(film.image(fields.frame(i)))
    return path


class _Film:
    """The figure of a film, drawn once: from frame to frame only pressures, gates and the time change."""

    def __init__(self, section: SectionPicture, first: Snapshot, scale: Normalize) -> None:
        self.section, page = section, section.sheet(1, "pressure of the particles", below=BAR)
        self.panel, self.canvas = page.panels[0], FigureCanvasAgg(page.figure)
        page.figure.set_dpi(drawing.DPI)
        self.gates = section.draw(self.panel, first.time, over=True)
        self.marks = section.draw_particles(self.panel, first, scale)
        self.time = drawing.headings(self.panel, "", raised=section.raised(page, 0))
        page.label_outside("x [m]", "z [m]")
        colour_bar(page, self.marks, "pressure [kPa]", above=section.key_top)
        section.name(page)

    def image(self, frame: Snapshot) -> NDArray[np.uint8]:
        """Picture of a frame, (height, width, 3) in whole multiples of BLOCK pixels."""
        self.marks.set_data(self.section.pressures(frame, (self.marks.get_size()[1], self.marks.get_size()[0])))
        self.time.set_text(f"t = {frame.time:.3f} s")
        for gate in self.gates:
            gate.remove()
        self.gates = self.section.draw_gates(self.panel, frame.time)
        self.canvas.draw()
        pixels = np.asarray(self.canvas.buffer_rgba())[..., :3]
        more = [(0, -n % BLOCK) for n in pixels.shape[:2]]
        return np.pad(pixels, (*more, (0, 0)), constant_values=255)
