"""The cost of a case: particles, steps, minutes, memory and disk."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from houle.case.build import first_rows, viscous_step
from houle.case.model import Case
from houle.case.section import CrossSection
from houle.flow.rows import memory
from houle.flow.setup import WAVE_SHARE

MICROSECONDS = 0.55  # time of one core per particle and step in a whole run [us]; `houle bench` measures yours


@dataclass(frozen=True)
class Price:
    """The cost of a run: a guess, good to a factor of two or three."""

    cells: int
    particles: int
    step: float  # [s]
    steps: int
    minutes: float  # duration on the given number of threads
    memory: float  # [bytes] at the start
    most_memory: float  # [bytes] when water has been everywhere
    frames: float  # size of fields.vtkhdf [bytes]
    rows: float  # size of series.nc [bytes]

    @property
    def disk(self) -> float:
        """Size of the results [bytes]."""
        return self.frames + self.rows


def price(case: Case, threads: int = 1) -> Price:
    """The cost of a case on this number of threads."""
    s = CrossSection(case)
    d, h, g = case.dimension, case.domain.spacing, s.grid
    particles, cells = round(s.particles()), int(np.prod(g.shape))
    slow = min([1.0, *(b.row.porosity for b in s.porous)])  # water is faster in the pores, up to 1/n
    fastest = s.expected_speed() / (1.0 if s.drop() > h else slow)
    crossed = min(h / fastest, WAVE_SHARE * sqrt(h / max(case.fluid.gravity, 1e-12)))  # time to cross a cell
    step = case.time.step or min(case.time.courant * crossed, viscous_step(case))
    steps = int(np.ceil(case.time.end / step))
    frames = 1 + case.time.end / case.output.every
    per_frame = 4 * ((2 * d + 3) * particles + (d + 3) * cells)  # float32
    rows = 8 * (20 + len(case.gauge) + (d + 1) * len(case.sensor)) * case.time.end / case.output.series_every
    return Price(
        cells=cells,
        particles=particles,
        step=step,
        steps=steps,
        minutes=particles * steps * MICROSECONDS * 1e-6 / 60 / threads**0.75,
        memory=memory(g, particles, first_rows(case)),
        most_memory=memory(g, particles, g.shape[-1]),
        frames=0.6 * frames * per_frame,
        rows=rows,
    )
