"""Overtopping: the water that crosses an upright section above a level, as much as each particle carries across.

A motion (advection, position correction) takes a particle straight from one place to another: where the line crosses
the section, the water of the particle counts if the height there is above the level. Remeshing hands the water of
particles to new ones: what one gets from the other side of the section counts by the height that it came from. No
volumes are subtracted from each other: the changes of the water behind the section add up to what crosses it, above the
level and below, to round-off, and where nothing crosses above the level the sum stays 0. Nothing crosses a solid in the
section: a line through one stands for a way around its nearer end, so behind a wall that is closed up to the level all
of the water counts.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid
from houle.medium.medium import Medium
from houle.medium.sections import partition
from houle.medium.shapes import spans_inside

NEAR = 1e-6  # cells on either side of the section: what is solid there closes it; and in height, of its ends
REACH = 4  # cells from the section: a particle that crosses it was not farther away when particles were sorted
HANDED = 20  # cells: farther than remeshing hands water on


class Crest:
    """An upright section across the tank, and what has crossed it above a level since the start.

    x       where it stands [m]
    sign    +1 if the space behind it is that at larger x, else -1
    level   height above which what crosses counts [m]; -inf: all that crosses counts
    passed  volume that went behind it, less what came back [m^d]
    """

    def __init__(self, grid: Grid, medium: Medium, x: float, level: float | None, to_the_right: bool) -> None:
        self.x, self.sign, self.passed = x, 1.0 if to_the_right else -1.0, 0.0
        self.spacing = grid.spacing[0]
        self.level = -np.inf if level is None else level - NEAR * grid.spacing[-1]
        parts = partition(grid, medium.bodies, medium.solids)
        self.layers = np.array([span[1] for span, _, _ in parts])  # largest y of each
        self.openings = [_openings(solid, x, grid) for _, solid, _ in parts]
        per_column = int(np.prod(grid.shape[1:]))
        cell = int(x / grid.spacing[0])
        low, high = (min(max(i, 0), grid.shape[0]) for i in (cell - REACH, cell + REACH + 1))
        self.cells = low * per_column, high * per_column

    def near(self, start: NDArray[np.int32]) -> slice:
        """Numbers of the particles that may cross it in a motion. start (cells + 1,): first particle of each cell."""
        return slice(int(start[self.cells[0]]), int(start[self.cells[1]]))

    def behind(self, position: FloatArray) -> NDArray[np.bool_]:
        """Whether places (N, d) [m] lie behind the section, (N,)."""
        return self.sign * (position[:, 0] - self.x) > 0.0

    def counts(self, place: FloatArray) -> NDArray[np.bool_]:
        """Whether what crosses the section at the height of places (N, d) [m] does so above the level, (N,)."""
        if self.level == -np.inf:
            return np.ones(len(place), bool)
        if place.shape[1] == 2:
            return _passes(place[:, 1], self.openings[0]) >= self.level
        found, layer = np.zeros(len(place), bool), np.searchsorted(self.layers[:-1], place[:, 1])
        for i in np.unique(layer):
            here = layer == i
            found[here] = _passes(place[here, -1], self.openings[i]) >= self.level
        return found

    def moved(self, before: FloatArray, after: FloatArray, volume: FloatArray) -> None:
        """Books a motion: particles with volumes (N,) [m^d] went straight from places (N, d) [m] to others."""
        ends = self.behind(after)
        crossed = np.flatnonzero(self.behind(before) != ends)
        if len(crossed) == 0:
            return
        a, b = before[crossed], after[crossed]
        place = a + ((self.x - a[:, 0]) / (b[:, 0] - a[:, 0]))[:, None] * (b - a)
        place[:, 1:-1] = b[:, 1:-1]  # in y they may have gone round a periodic axis
        signed = np.where(ends[crossed], volume[crossed], -volume[crossed])
        self.passed += float(signed[self.counts(place)].sum())

    def marks(self, position: FloatArray) -> FloatArray | None:
        """Marks (N, d) of the particles whose water counts where remeshing hands it across; None if none is near.

        The first number is 1 for those in front of the section, the second is 1 for those behind it. Remeshing hands
        the marks on with the water: what a new particle has of a mark is the share of marked water in it.
        """
        marked = np.zeros(position.shape)
        near = np.flatnonzero(np.abs(position[:, 0] - self.x) < HANDED * self.spacing)
        near = near[self.counts(position[near])]
        behind = self.behind(position[near])
        marked[near, behind.astype(int)] = 1.0
        return marked if len(near) else None

    def handed(self, position: FloatArray, volume: FloatArray, marks: FloatArray) -> None:
        """Books a remeshing. marks (N, d): shares of marked water in the volumes (N,) [m^d] of the new particles."""
        behind = self.behind(position)
        came, went = marks[:, 0] * behind, marks[:, 1] * ~behind
        some = np.flatnonzero((came != 0.0) | (went != 0.0))
        self.passed += float((volume[some] * (came[some] - went[some])).sum())


def _openings(solid: shapely.Geometry, x: float, grid: Grid) -> FloatArray:
    """Heights (K, 2) [m] between which the section at x is open; floor and lid do not end an opening.

    Where it is closed from floor to lid there is one opening, infinitely high: over the top.
    """
    margin = NEAR * grid.spacing[0]
    ends = [-np.inf]
    for low, high in sorted(span for side in (-1, 1) for span in spans_inside(solid, x + side * margin)):
        if len(ends) > 1 and low <= ends[-1]:
            ends[-1] = max(ends[-1], high)
        else:
            ends += [low, high]
    found = np.array([*ends, np.inf]).reshape(-1, 2)
    found = found[(found[:, 1] > 0.0) & (found[:, 0] < grid.size[-1])]
    return found if len(found) else np.array([[np.inf, np.inf]])


def _passes(z: FloatArray, openings: FloatArray) -> FloatArray:
    """Heights (N,) [m] at which what crosses at the heights z (N,) passes: in the nearest of the openings (K, 2)."""
    away = np.maximum(openings[:, 0] - z[:, None], z[:, None] - openings[:, 1])
    low, high = openings[np.argmin(away, axis=1)].T
    return np.clip(z, low, high)
