"""C_R and C_T of many runs beside theory: a table and a picture."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from houle.analysis import porous_block
from houle.output.drawing import INK, LINES, headings, sheet, style
from houle.results import reflection
from houle.validation import tables

if TYPE_CHECKING:
    from houle.analysis import Reflection, Scatter
    from houle.results.run import Run

FRICTION = np.linspace(0.05, 1.2, 24)  # friction factors of the curves
HEAD = ("variant", "T s", "n", "f", "behind", "H_I mm", "C_R", "95 %", "theory", "C_T", "95 %", "theory")
PERIODS = {1.0: LINES[0], 1.5: LINES[1], 2.0: LINES[2]}  # s -> colour
MARGINS = (0.62, 0.25, 0.8, 0.95)  # inches: left, right, bottom with the key, top


@dataclass(frozen=True)
class Row:
    """One block under one wave: the measurement, and linear theory for the incident wave that was measured."""

    variant: str
    wall: bool
    porosity: float
    width: float  # width of the block [m]
    forchheimer: bool
    found: Reflection
    known: Scatter

    @classmethod
    @cache
    def of(cls, variant: str, run: Run) -> Row:
        found, body = reflection.measure(run), run.case.porous[0]
        known = reflection.theory(run.case, found.H_I)
        assert known is not None and body.box is not None
        width = body.box[1][0] - body.box[0][0]
        linear = body.resistance.b == 0.0
        return cls(variant, not run.case.sponge, body.porosity, width, not linear, found, known)

    @property
    def off(self) -> dict[str, float]:
        """Distance from theory of C_R and, where something gets through, C_T."""
        reflected = {"C_R": abs(self.found.C_R - self.known.C_R)}
        return reflected if self.wall else {**reflected, "C_T": abs(self.found.C_T - self.known.C_T)}

    @property
    def words(self) -> tuple[str, ...]:
        r, known = self.found, self.known
        span = [f"{low:.3f} to {high:.3f}" for low, high in (r.interval_R, r.interval_T)]
        through = ("", "", "") if self.wall else (f"{r.C_T:.3f}", span[1], f"{known.C_T:.3f}")
        behind = "wall" if self.wall else "open"
        head = (self.variant, f"{r.period:g}", f"{self.porosity:g}", f"{known.friction:.3g}", behind)
        return (*head, f"{1e3 * r.H_I:.2f}", f"{r.C_R:.3f}", span[0], f"{known.C_R:.3f}", *through)


def write(path: Path, title: str, rows: Sequence[Row]) -> None:
    """Writes path.csv, path.md and, for the rows with linear drag, path.png."""
    tables.save(path, title, HEAD, [row.words for row in rows])
    if linear := [row for row in rows if not row.forchheimer]:
        draw(path.with_name(path.name + ".png"), title, linear)


def draw(path: Path, title: str, rows: Sequence[Row]) -> None:
    """Draws measured coefficients with their intervals over the friction f, on curves of theory; a row per porosity."""
    porosities = sorted({row.porosity for row in rows}, reverse=True)
    kinds = [(name, wall) for name, wall in (("C_R", False), ("C_T", False), ("C_R", True)) if _any(rows, name, wall)]
    words = "lines: linear theory  ·  bars: 95 % intervals"
    with style():
        page = sheet(len(porosities) * len(kinds), len(kinds), (2.9, 2.2), title, words, margins=MARGINS)
        chosen = itertools.product(porosities, kinds)
        for panel, (porosity, (name, wall)) in zip(page.panels, chosen, strict=True):
            _panel(panel, name, wall, [row for row in rows if row.porosity == porosity and row.wall == wall])
            what = f"${name}$, {'wall' if wall else 'open'} behind, n = {porosity:g}"
            headings(panel, what, mathematics=True)
        page.label_outside("friction f", "")
        page.legend([Line2D([], [], color=c, marker="o", ms=4, label=f"T = {t:g} s") for t, c in PERIODS.items()])
        page.save(path)


@cache
def _theory(period: float, depth: float, width: float, porosity: float, wall: bool) -> list[Scatter]:
    """Linear theory of a block for each of the factors FRICTION."""
    return [porous_block(2 * np.pi / period, depth, width, porosity, f, wall=wall, modes=12) for f in FRICTION]


def _any(rows: Sequence[Row], name: str, wall: bool) -> bool:
    return any(row.wall == wall for row in rows) and not (wall and name == "C_T")


def _panel(axes: Any, name: str, wall: bool, rows: Sequence[Row]) -> None:
    for row in rows:
        period, colour = row.found.period, PERIODS.get(round(row.found.period, 3), INK)
        value, (low, high) = getattr(row.found, name), getattr(row.found, f"interval_{name[-1]}")
        axes.errorbar(
            row.known.friction, value, [[value - low], [high - value]], fmt="o", ms=4, color=colour, elinewidth=0.8,
            capsize=2,
        )  # fmt: skip
        curve = _theory(period, row.found.depth, row.width, row.porosity, wall)
        axes.plot(FRICTION, [getattr(known, name) for known in curve], color=colour, lw=0.9)
    axes.set(xlim=(0.0, 1.2), ylim=(0.0, 1.05))
