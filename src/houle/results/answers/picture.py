"""The picture of the answers of a run: each number with its interval, over the formula's band and the nearest tests."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import floor, isfinite, log10
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from houle.output import drawing
from houle.output.drawing import FAINT, GREY, INK, LABORATORY, SHADE, STONE, STONE_LINE, WATER, headings, sheet
from houle.results.answers.table import Answer, Beside

GROUPS = {
    "discharge": "Mean overtopping discharge", "share": "Share of the waves that overtop",
    "volume": "Volumes of overtopping waves", "run-up": "Run-up above still water",
    "force": "Force of the waves", "moment": "Overturning moment", "coefficient": "Reflection",
    "safety": "Factors of safety", "gradient": "Bank: exit gradient", "Shields": "Bank: Shields number",
    "decay": "Decay of the pressure inside, delta",
    "armour force": "Armour: force out over weight, an indicator",
    "armour gradient": "Armour: run-down gradient, an indicator", "damage": "Armour: damage level S, by formula alone",
}  # fmt: skip  # panels in their order
LOGARITHMIC = "discharge"
NAMES, LETTER, MOST = 2.75, 0.0625, 5.0  # width of the names at the left, of a letter, of the longest names [inches]
WIDE = 4.6  # width of a panel [inches]
LANE = 0.17  # height of a lane of a row: the run, each formula, the tests [inches]
TESTS: dict[str, Any] = {"marker": "o", "ls": "none", "ms": 4.0, "mfc": "white", "mew": 0.9, "color": LABORATORY}
LEAST = 1e-12  # smallest number that a logarithmic axis shows


def write(path: Path, title: str, rows: Sequence[Answer]) -> Path | None:
    """Draws the answers that have an interval, a formula or tests beside them; None where there is none."""
    shown = [row for row in rows if row.formulas or row.tests or isfinite(row.low)]
    groups = [(words, [row for row in shown if row.group == name]) for name, words in GROUPS.items()]
    groups = [(words, own) for words, own in groups if any(row.formulas or row.tests for row in own)]
    if not groups:
        return None
    lanes = max(sum(_lanes(row) for row in own) for _, own in groups)
    key = _key(shown)
    words = "computed, with its interval of 90 %, beside published formulas and laboratory tests"
    names = _room(row for _, own in groups for row in own)
    with drawing.style():
        below = 0.55 + drawing.key_height(key, names + WIDE)
        margins = (names, 0.35, below, 0.95)
        page = sheet(len(groups), 1, (WIDE, LANE * (lanes + 1)), title, words, gap=(0, 0.62), margins=margins)
        for panel, (heading, own) in zip(page.panels, groups, strict=True):
            _draw(panel, own, names)
            headings(panel, f"{heading} [{own[0].unit}]".replace(" [-]", ""))
        page.key(key)
        return page.save(path)


def _lanes(row: Answer) -> int:
    return 1 + len(row.formulas) + (row.tests is not None) + 1  # and air


def _room(rows: Iterable[Answer]) -> float:
    """Width of the names [inches]: the longest is written out, as far as it may."""
    longest = max(len(words) for row in rows for words in (row.name, *(one.name for one in row.formulas)))
    return float(min(max(NAMES, 0.45 + LETTER * longest), MOST))


def _draw(panel: Axes, rows: Sequence[Answer], names: float) -> None:
    """Draws rows from the top down, in lanes of one height."""
    log = rows[0].group == LOGARITHMIC
    at, count = 0.5, sum(_lanes(row) for row in rows)
    panel.set(xlim=_limits(rows, log), ylim=(max(count, 3), -0.5))
    for row in rows:
        _row(panel, row, at, log, names)
        at += _lanes(row)
    _ticks(panel, log)


def _row(panel: Axes, row: Answer, at: float, log: bool, names: float) -> None:
    """Draws one answer: a lane for the run, one for each formula, one for the tests, each with its name."""
    place = _log if log else float
    _name(panel, row.name, at, INK, names)
    if isfinite(row.low):
        panel.plot([place(row.low), place(row.high)], [at, at], color=WATER, lw=2.0, solid_capstyle="butt")
    none = log and row.value <= 0.0  # a logarithmic axis has no 0: an arrow at its end points there
    panel.plot(
        [panel.get_xlim()[0] if none else place(row.value)],
        [at],
        "<" if none else "o",
        color=WATER,
        ms=4.5,
        clip_on=False,
    )
    for n, one in enumerate(row.formulas, start=1):
        _name(panel, one.name, at + n, GREY, names)
        _band(panel, one, at + n, n, place)
    if row.tests is not None:
        lane = at + len(row.formulas) + 1
        points = [place(p) for p in (row.tests.points or (row.tests.value,))]
        _name(panel, "nearest laboratory tests", lane, GREY, names)
        panel.plot(points, [lane] * len(points), clip_on=False, **TESTS)


def _name(panel: Axes, words: str, at: float, colour: str, room: float) -> None:
    """Writes what a lane shows at the left of the panel, in this room [inches]."""
    name = panel.annotate(
        words, (0, at), (-8, 0), xycoords=panel.get_yaxis_transform(), textcoords="offset points", ha="right",
        va="center", annotation_clip=False, fontsize=drawing.SMALL, color=colour,
    )  # fmt: skip
    drawing.fitted(name, room - 0.45)


def _band(panel: Axes, one: Beside, at: float, number: int, place: Any) -> None:
    """Draws the band of a formula as a bar, its value as a stroke across."""
    face, edge = (SHADE, GREY) if number == 1 else (STONE, STONE_LINE)
    if isfinite(one.low) and isfinite(one.high):
        low, high = place(one.low), place(one.high)
        panel.barh(at, high - low, 0.7, low, color=face, lw=0)
    panel.plot([place(one.value)] * 2, [at - 0.35, at + 0.35], color=edge, lw=1.6, solid_capstyle="butt")


def _limits(rows: Sequence[Answer], log: bool) -> tuple[float, float]:
    """Limits that hold every number of the rows: whole decades, or from 0 on."""
    numbers = [v for row in rows for one in (row, *row.formulas, row.tests) if one is not None for v in _numbers(one)]
    finite = [v for v in numbers if isfinite(v)]
    if log:
        decades = [_log(v) for v in finite if v > 0.0] or [-6.0, -3.0]
        return float(floor(min(decades))), float(max(floor(min(decades)) + 1, np.ceil(max(decades))))
    low, high = min(0.0, *finite), max(0.0, *finite)
    return low, high + 0.05 * (high - low or 1.0)


def _numbers(one: Answer | Beside) -> tuple[float, ...]:
    points = one.points if isinstance(one, Beside) else ()
    return (one.value, one.low, one.high, *points)


def _log(value: float) -> float:
    return log10(max(value, LEAST))


def _ticks(panel: Axes, log: bool) -> None:
    """Numbers under the panel, and faint lines at them; powers of ten where the axis is logarithmic."""
    panel.spines["left"].set_visible(False)
    low, high = panel.get_xlim()
    if log:
        decades = range(round(low), round(high) + 1)
        raised = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
        at, words = [float(d) for d in decades], [f"10{str(d).translate(raised)}" for d in decades]
    else:
        every = MaxNLocator(nbins=5, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        at = [float(tick) for tick in np.asarray(every) if low <= tick <= high]
        words = drawing.as_numbers(at)
    for tick, number in zip(at, words, strict=True):
        panel.axvline(tick, color=FAINT, lw=0.8, zorder=0)
        panel.annotate(
            number, (tick, 0), (0, -5), xycoords=panel.get_xaxis_transform(), textcoords="offset points",
            ha="center", va="top", annotation_clip=False,
        )  # fmt: skip


def _key(rows: Sequence[Answer]) -> list[Any]:
    """Marks of the run, the formulas and the tests, as far as they are in the picture."""
    found: list[Any] = [Line2D([], [], color=WATER, marker="o", ms=4.5, lw=2.0, label="computed, interval of 90 %")]
    if any(row.formulas for row in rows):
        found.append(Patch(facecolor=SHADE, edgecolor=GREY, lw=0.8, label="formula, its own band"))
    if any(row.tests is not None for row in rows):
        found.append(Line2D([], [], label="single tests", **TESTS))
    return found
