"""The price of a case: particles, steps, minutes, memory and disk, and whether this machine has the memory."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt

import numpy as np

from houle.case.build import first_rows, viscous_step
from houle.case.model import Case
from houle.case.section import CrossSection
from houle.check.finding import Finding
from houle.flow.rows import memory
from houle.flow.setup import WAVE_SHARE
from houle.grid import MOST_NUMBERS

MICROSECONDS = 0.55  # of one core per particle and step of a whole run; `houle bench` measures yours


@dataclass(frozen=True)
class Price:
    """Cost of a run: a guess, good to a factor of two or three."""

    cells: int
    particles: int
    step: float  # [s]
    steps: int
    minutes: float  # on the threads asked for
    memory: float  # [bytes] at the start
    most_memory: float  # [bytes] when water has been everywhere
    frames: float  # [bytes] of fields
    rows: float  # [bytes] of gauges, sensors and ledger

    @property
    def disk(self) -> float:
        """Size of the results [bytes]."""
        return self.frames + self.rows


def price(case: Case, threads: int = 1) -> Price:
    """The price of a case on so many threads."""
    s = CrossSection(case)
    d, h, g = case.dimension, case.domain.spacing, s.grid
    particles, cells = round(s.particles()), int(np.prod(g.shape))
    slow = min([1.0, *(b.row.porosity for b in s.porous)])  # water is faster in the pores, up to 1/n
    fastest = s.expected_speed() / (1.0 if s.drop() > h else slow)
    crossed = min(h / fastest, WAVE_SHARE * sqrt(h / max(case.fluid.gravity, 1e-12)))  # of a cell, by water; by waves
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


def memory_suffices(s: CrossSection) -> Iterator[Finding]:
    """The run fits into the memory of this machine, and every cell and particle can be numbered."""
    needed, there = memory(s.grid, s.particles(), s.grid.shape[-1]), machine_memory()
    if there is not None and needed > 0.8 * there:
        h = s.case.domain.spacing
        better = h * (needed / (0.5 * there)) ** (1 / s.case.dimension)
        yield Finding(
            "error" if needed > 2 * there else "warning",
            "domain.spacing",
            f"= {h:g} m makes {s.particles():.3g} particles, about {needed / 1e9:.3g} GB; this machine has "
            f"{there / 1e9:.3g} GB: domain.spacing = {better:.2g}",
        )
        if needed > 2 * there:
            return
    yield from can_be_numbered(s)


def can_be_numbered(s: CrossSection) -> Iterator[Finding]:
    """Cells, particles and the half cells of remeshing can be numbered with 32 bits."""
    d, h = s.case.dimension, s.case.domain.spacing
    cells = math.prod(s.grid.shape)
    rows = first_rows(s.case) / s.grid.shape[-1]
    most, what = max((cells, "cells"), (s.particles(), "particles"), (2**d * cells * rows, "half cells to remesh on"))
    if most > MOST_NUMBERS:
        better = h * (1.01 * most / MOST_NUMBERS) ** (1 / d)
        text = f"= {h:g} m makes {most:.3g} {what}: at most {MOST_NUMBERS:.3g} can be numbered, from {better:.2g} m on"
        yield Finding("error", "domain.spacing", text)


def machine_memory() -> float | None:
    """Memory of this machine [bytes]; None where the system does not tell."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None
