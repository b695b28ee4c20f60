"""The limits of this machine for the run of a case: its memory, and numbers for all cells and particles."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator

from houle.case.section import CrossSection
from houle.check.finding import Finding
from houle.flow.rows import memory
from houle.grid import MOST_NUMBERS


def memory_suffices(s: CrossSection, rows: int) -> Iterator[Finding]:
    """The run fits into the memory of this machine, and every cell and particle can be numbered.

    rows  number of rows of cells with which the run starts
    """
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
    yield from can_be_numbered(s, rows)


def can_be_numbered(s: CrossSection, rows: int) -> Iterator[Finding]:
    """Cells, particles and the half cells of remeshing can be numbered with 32 bits."""
    d, h = s.case.dimension, s.case.domain.spacing
    cells = math.prod(s.grid.shape)
    most, what = max(
        (cells, "cells"),
        (s.particles(), "particles"),
        (2**d * cells * (rows / s.grid.shape[-1]), "half cells to remesh on"),
    )
    if most > MOST_NUMBERS:
        better = h * (1.01 * most / MOST_NUMBERS) ** (1 / d)
        text = f"= {h:g} m makes {most:.3g} {what}: at most {MOST_NUMBERS:.3g} can be numbered, from {better:.2g} m on"
        yield Finding("error", "domain.spacing", text)


def machine_memory() -> float | None:
    """Memory of this machine [bytes]; None where the operating system does not tell it."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None
