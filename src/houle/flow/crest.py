"""Overtopping: the volume of water that particles carry across an upright section, the crest, above a level.

A motion (advection or position correction) takes a particle straight from one place to another. Where this line crosses
the section above the level, the water of the particle counts. Remeshing hands the water of particles to new ones: what
a new particle gets from the other side of the section counts by the height from which it came. See (29) in
docs/theory.md.

No volumes are subtracted from each other. So the crossings above the level and below it add up to the change of the
water behind the section, to round-off, and where nothing crosses above the level the sum stays exactly 0. Nothing
crosses a solid in the section: a line through one stands for a way around its nearer end. Behind a wall that is closed
up to the level all water that arrives therefore counts.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid
from houle.medium.medium import Medium
from houle.medium.sections import partition
from houle.medium.shapes import spans_inside

NEAR = 1e-6  # cells: a solid so near to either side of the section closes it; tolerance in height as well
REACH = 4  # cells from the section within which a particle was sorted that crosses it in a motion
HANDED = 20  # cells: no remeshing hands water on farther than this


class Crest:
    """An upright section across the tank, and the water that has crossed it above a level since the start.

    x         position of the section [m]
    sign      +1 if behind it is where x is larger, else -1
    level     height above which a crossing counts [m]; -inf: every crossing counts
    passed    volume that went behind it, less the volume that came back [m^d]
    layers    largest y of each layer of the tank in which the section is the same [m]
    openings  heights (K, 2) between which the section is open [m], for each layer
    cells     first cell and end of the flat numbers of the cells within `REACH`
    """

    def __init__(self, grid: Grid, medium: Medium, x: float, level: float | None, to_the_right: bool) -> None:
        self.x, self.sign, self.passed = x, 1.0 if to_the_right else -1.0, 0.0
        self.spacing = grid.spacing[0]
        self.level = -np.inf if level is None else level - NEAR * grid.spacing[-1]
        parts = partition(grid, medium.bodies, medium.solids)
        self.layers = np.array([span[1] for span, _, _ in parts])
        self.openings = [_openings(solid, x, grid) for _, solid, _ in parts]
        per_column = int(np.prod(grid.shape[1:]))
        cell = int(x / grid.spacing[0])
        low, high = (min(max(i, 0), grid.shape[0]) for i in (cell - REACH, cell + REACH + 1))
        self.cells = low * per_column, high * per_column

    def near(self, start: NDArray[np.int32]) -> slice:
        """Range of the numbers of the particles that may cross it in a motion. start: `Flow.start`."""
        return slice(int(start[self.cells[0]]), int(start[self.cells[1]]))

    def behind(self, position: FloatArray) -> NDArray[np.bool_]:
        """True (N,) for the places (N, d) [m] that lie behind the section."""
        return self.sign * (position[:, 0] - self.x) > 0.0

    def counts(self, place: FloatArray) -> NDArray[np.bool_]:
        """True (N,) where a crossing at these places (N, d) [m] of the section passes above the level."""
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
        place[:, 1:-1] = b[:, 1:-1]  # a particle may have gone round a periodic axis y
        signed = np.where(ends[crossed], volume[crossed], -volume[crossed])
        self.passed += float(signed[self.counts(place)].sum())

    def marks(self, position: FloatArray) -> FloatArray | None:
        """Marks (N, d) of the particles whose water counts if remeshing hands it across; None if none is near.

        The first number is 1 for those in front of the section, the second is 1 for those behind it. Remeshing hands
        the marks on with the water, so that the mark of a new particle is the share of marked water in it.
        """
        marked = np.zeros(position.shape)
        near = np.flatnonzero(np.abs(position[:, 0] - self.x) < HANDED * self.spacing)
        near = near[self.counts(position[near])]
        behind = self.behind(position[near])
        marked[near, behind.astype(int)] = 1.0
        return marked if len(near) else None

    def handed(self, position: FloatArray, volume: FloatArray, marks: FloatArray) -> None:
        """Books a remeshing: positions (N, d) [m], volumes (N,) [m^d] and marks (N, d) of the new particles."""
        behind = self.behind(position)
        came, went = marks[:, 0] * behind, marks[:, 1] * ~behind
        some = np.flatnonzero((came != 0.0) | (went != 0.0))
        self.passed += float((volume[some] * (came[some] - went[some])).sum())


def _openings(solid: shapely.Geometry, x: float, grid: Grid) -> FloatArray:
    """Lower and upper ends (K, 2) [m] of the openings of the section at x; floor and lid of the tank end none.

    A section that is closed from floor to lid has one opening, over the top, at infinite height.
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
    """Heights (N,) [m] at which water that crosses at z (N,) really passes: in the nearest of the openings (K, 2)."""
    away = np.maximum(openings[:, 0] - z[:, None], z[:, None] - openings[:, 1])
    low, high = openings[np.argmin(away, axis=1)].T
    return np.clip(z, low, high)
