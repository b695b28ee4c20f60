"""Water that crosses an upright section, above a level: booked where particles move, as much as each of them carries.

Nothing is subtracted. A motion (advection, position correction) takes a particle straight from one place to another:
where the line crosses the section, the water of the particle is counted or not by the height there. Remeshing hands the
water of particles to new ones: what one gets from the other side of the section is counted by the height it came from.
So the changes of the water behind the section add up to what crosses it, above the level and below, to round-off; and
where nothing crosses above the level nothing is added up. A solid in the section cannot be crossed: a line through
one stands for a way around its nearer end, so behind a wall that is closed up to the level all of the water counts.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid
from houle.medium.medium import Medium
from houle.medium.sections import partition
from houle.medium.shapes import spans_inside

NEAR = 1e-6  # [cells] from the section on either side, what is solid there closes it; and of its ends in height
REACH = 4  # cells from the section: a particle that crosses it was sorted not farther away
HANDED = 20  # cells, farther than remeshing hands water on


class Crest:
    """The section at x and what has crossed it above `level` since the start.

    sign: +1 where behind the section is towards larger x, else -1. passed: volume that went behind it, less what came
    back [m^d].
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
        """The particles that may cross it, of those sorted by cells that begin at `start`."""
        return slice(int(start[self.cells[0]]), int(start[self.cells[1]]))

    def behind(self, position: FloatArray) -> NDArray[np.bool_]:
        """Which of the places (N, d) lie behind it."""
        return self.sign * (position[:, 0] - self.x) > 0.0

    def counts(self, place: FloatArray) -> NDArray[np.bool_]:
        """Whether what crosses the section at the height of these places (N, d) does so above the level."""
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
        """Books the motion of particles (N, d) of some volumes (N,) [m^d]."""
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
        """Marks (N, d) of particles (N, d) whose water counts where remeshing hands it across: 1 for those in front in
        the first column, for those behind in the second. None if none of them is near.
        """
        marked = np.zeros(position.shape)
        near = np.flatnonzero(np.abs(position[:, 0] - self.x) < HANDED * self.spacing)
        near = near[self.counts(position[near])]
        behind = self.behind(position[near])
        marked[near, behind.astype(int)] = 1.0
        return marked if len(near) else None

    def handed(self, position: FloatArray, volume: FloatArray, marks: FloatArray) -> None:
        """Books a remeshing: new particles (N, d), and in their volumes (N,) the shares (N, d) of marked water."""
        behind = self.behind(position)
        came, went = marks[:, 0] * behind, marks[:, 1] * ~behind
        some = np.flatnonzero((came != 0.0) | (went != 0.0))
        self.passed += float((volume[some] * (came[some] - went[some])).sum())


def _openings(solid: shapely.Geometry, x: float, grid: Grid) -> FloatArray:
    """Heights (K, 2) [m] between which the section at x is open; without end at the floor and at the lid.

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
    """The height (N,) at which what crosses at z (N,) really passes: in the nearest of the openings (K, 2)."""
    away = np.maximum(openings[:, 0] - z[:, None], z[:, None] - openings[:, 1])
    low, high = openings[np.argmin(away, axis=1)].T
    return np.clip(z, low, high)
