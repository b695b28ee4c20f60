"""Draws the section with which the tutorial begins: python docs/pictures/tutorial_section.py"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

LENGTH, DEPTH = 7.0, 0.30  # of the flume and its still water [m]
PADDLE, FRONT, BACK, END = 0.4, 4.5, 5.3, 6.6  # along the flume [m]
TOP = 0.45  # of the crib [m]
GAUGES = {"W1": 2.4, "W2": 2.7, "W3": 3.2, "W4": 3.5, "T1": 5.8, "T2": 6.1}


def draw(path: Path) -> None:
    """Writes the drawing as PNG."""
    figure, axes = plt.subplots(figsize=(10, 3.4), dpi=110)
    axes.add_patch(Rectangle((PADDLE, 0), END - PADDLE, DEPTH, color="#cfe6f5"))
    rock = Rectangle((FRONT, 0), BACK - FRONT, TOP, facecolor="#e4ddd0", edgecolor="#5b5140", hatch="oo", linewidth=1.2)
    axes.add_patch(rock)
    axes.plot([0, LENGTH], [0, 0], color="black", linewidth=2)
    axes.plot([PADDLE, FRONT], [DEPTH, DEPTH], color="#1f6fa8", linewidth=1)
    axes.plot([BACK, END], [DEPTH, DEPTH], color="#1f6fa8", linewidth=1)
    for x, text in ((PADDLE, "paddle"), (END, "absorber")):
        axes.plot([x, x], [0, 0.48], color="black", linewidth=4)
        axes.text(x, 0.51, text, ha="center")
    for name, x in GAUGES.items():
        axes.plot([x, x], [0.2, 0.42], color="#b03020", linewidth=1)
        axes.text(x, 0.44, name, ha="center", color="#b03020", fontsize=9)
    axes.annotate("", (1.6, 0.36), (0.8, 0.36), arrowprops={"arrowstyle": "->", "color": "#1f6fa8"})
    axes.text(1.2, 0.39, "H = 40 mm, T = 1.3 s", ha="center", color="#1f6fa8", fontsize=9)
    note = "crushed rock\n$d_{50}$ = 40 mm\n$n$ = 0.45"
    axes.text(
        (FRONT + BACK) / 2, 0.2, note, ha="center", va="center", fontsize=7.5, bbox={"color": "white", "pad": 1.5}
    )
    _along(axes, -0.09, (0, PADDLE, FRONT, BACK, END, LENGTH))
    _up(axes, 1.0, DEPTH, "0.30")
    _up(axes, BACK + 0.12, TOP, "0.45")
    axes.set(xlim=(-0.15, LENGTH + 0.15), ylim=(-0.2, 0.6), aspect=3)
    axes.axis("off")
    axes.set_title("Crib in a wave flume; lengths in metres, heights drawn three times as large", fontsize=10)
    figure.savefig(path, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)


def _along(axes: Axes, z: float, places: tuple[float, ...]) -> None:
    """A line of dimensions below the floor."""
    for left, right in pairwise(places):
        axes.annotate("", (left, z), (right, z), arrowprops={"arrowstyle": "<->", "linewidth": 0.8})
        axes.text((left + right) / 2, z - 0.05, f"{right - left:.2f}", ha="center", va="top", fontsize=9)
    for x in places:
        axes.plot([x, x], [0, z - 0.02], color="gray", linewidth=0.6)


def _up(axes: Axes, x: float, top: float, text: str) -> None:
    """A dimension from the floor upwards."""
    axes.annotate("", (x, 0), (x, top), arrowprops={"arrowstyle": "<->", "linewidth": 0.8})
    axes.text(x + 0.04, top / 2, text, va="center", fontsize=9)


if __name__ == "__main__":
    draw(Path(__file__).with_name("tutorial-section.png"))
