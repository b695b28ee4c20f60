"""Placing of words in a picture: beside each other, above a panel, or near a point, never on each other.

Everything here is in points of 1/72 inch.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.grid import FloatArray

Sizes = FloatArray  # (N, 2) widths and heights of words

AIR = 3.0  # gap between words, and between words and the point that they name
DISTANCES = (5.0, 9.0, 15.0, 23.0, 33.0, 46.0, 62.0, 82.0, 106.0, 135.0)  # tried distances of words from their point
DIRECTIONS = 16  # tried directions
ON_WORDS, ON_POINT, OUTSIDE = 2000.0, 600.0, 5000.0  # costs of a place; a point of distance costs 1
ON_OUTLINE, ON_BODY, ACROSS = 120.0, 90.0, 12.0  # on the outline of a body, inside it, over an upright line


def apart(places: Sequence[float], sizes: float | Sequence[float], low: float, high: float) -> list[float]:
    """Shifts that bring neighbours of these sizes side by side, in their order; a crowd stays about its middle.

    All stay between low and high, if they fit there.
    """
    size = np.broadcast_to(np.asarray(sizes, float), len(places))

    def spread(crowd: Sequence[int]) -> NDArray[np.float64]:
        wide = size[list(crowd)]
        centre = np.cumsum(wide) - 0.5 * wide  # from the beginning of the crowd
        first = float(np.mean(np.asarray(places)[list(crowd)] - centre))
        ends = low - 0.5 * wide[0], high - wide.sum() + 0.5 * wide[-1]
        return np.clip(first, min(ends), max(ends)) + centre

    order = np.argsort(places, kind="stable")
    crowds = [[int(i)] for i in order]
    k = 0
    while k + 1 < len(crowds):
        left, right = crowds[k][-1], crowds[k + 1][0]
        gap = 0.5 * (size[left] + size[right])
        if spread(crowds[k])[-1] + gap > spread(crowds[k + 1])[0] + 1e-9:
            crowds[k : k + 2] = [crowds[k] + crowds[k + 1]]
            k = max(0, k - 1)
        else:
            k += 1
    shifts = np.zeros(len(places))
    for crowd in crowds:
        shifts[crowd] = spread(crowd) - np.asarray(places)[crowd]
    return shifts.tolist()


def near_points(
    points: FloatArray, sizes: Sizes, panel: tuple[float, float], bodies: shapely.Geometry, lines: Sequence[float]
) -> FloatArray:
    """Middles (N, 2) of the words that name points (N, 2), each where it covers least of what matters.

    panel: width and height, inside which all words stay. bodies: areas that words should not cover, their outlines
    least of all. lines: places of upright lines across the panel.
    """
    outline = shapely.boundary(bodies)
    found = np.empty_like(points)
    taken: list[tuple[shapely.Geometry, shapely.Geometry]] = []  # words and their lines, so far
    angle = 2.0 * np.pi * (0.5 + np.arange(DIRECTIONS)) / DIRECTIONS
    way = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    others = shapely.multipoints(points)
    for n, (point, size) in enumerate(zip(points, sizes, strict=True)):
        away = np.repeat(DISTANCES, DIRECTIONS)
        turned = np.tile(way, (len(DISTANCES), 1))
        middle = point + away[:, None] * turned + 0.5 * size * np.clip(1.6 * turned, -1.0, 1.0)
        low, high = middle - 0.5 * size - 0.5 * AIR, middle + 0.5 * size + 0.5 * AIR
        box = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
        whole = shapely.area(box)
        cost = away + OUTSIDE * ((low < 0.0) | (high > np.array(panel))).any(axis=1)
        cost += ON_POINT * shapely.intersects(box, others)
        cost += ON_OUTLINE * shapely.intersects(box, outline)
        cost += ON_BODY * shapely.area(shapely.intersection(box, bodies)) / whole
        for x in lines:
            cost += ACROSS * ((low[:, 0] < x) & (x < high[:, 0]))
        leader = shapely.linestrings(np.stack([np.broadcast_to(point, middle.shape), middle], axis=1))
        for words, line in taken:
            cost += ON_WORDS * (shapely.intersects(box, words) | shapely.intersects(leader, words))
            cost += ON_WORDS * shapely.intersects(box, line)
        best = int(np.argmin(cost))
        found[n] = middle[best]
        taken.append((box[best], leader[best]))
    return found


def in_rows(widths: Sequence[float], room: float) -> list[list[int]]:
    """Numbers of the entries of a key, row by row, each row no longer than `room`."""
    rows: list[list[int]] = []
    used = 0.0
    for n, width in enumerate(widths):
        if not rows or used + width > room:
            rows.append([])
            used = 0.0
        rows[-1].append(n)
        used += width
    return rows


def leader(point: FloatArray, middle: FloatArray, size: FloatArray) -> FloatArray | None:
    """Ends (2, 2) of a line from a point to the words that name it; None where they stand beside it."""
    end: Any = np.clip(point, middle - 0.5 * size, middle + 0.5 * size)
    return None if np.hypot(*(end - point)) < 8.0 else np.stack([point, end])
