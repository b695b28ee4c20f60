"""What columns of cells hold up to any level: exact, for the columns where porosity changes or solids stand.

The water of a column is W = sum_p V_p T(x_p - x_c), with the tent T across (linear, two cells wide, folded at walls).
Particles at the centroids of the water of their half cells give it exactly, as T is linear over each half cell. What
the column holds up to the level z is the integral of A(z) = integral of n T over the section at z, n the porosity, 0 in
solids. Between the heights where a corner of a shape lies, or where an edge crosses a kink of T, A is a parabola: so
the inverse, level from water, is exact too, and water at rest has one level, whatever slopes cross it. In 3D the term
in x y is left where an upright edge stands inside a half cell: a few thousandths of a cell.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid, fixed
from houle.moments import edges
from houle.porous import Medium, partition

NEAR = 1e-10  # [cells] heights nearer to each other are one
NOTHING = 1e-12  # of a column's section: less is closed
REACH = 2  # columns: the spline of column_heights sees one and a half, its sum is divided by the porosity of one
SAMPLES = np.array([1.0, 3.0, 5.0]) / 6.0  # of a piece: three points that give its parabola, inside of any steps

Region = tuple[float, FloatArray]  # what it adds to the porosity, its edges (E, 2, 2) [cells]


@dataclass(frozen=True)
class Capacity:
    """Pieces of the capacity of columns, one column after the other, from the bottom to the top of the tank.

    column (M,): flat numbers of the columns; start (M + 1,): piece start[i] is the first of column[i].
    pieces (P, 5): z and capacity below it [cells], and a, b, c of A = a + b s + c s^2 with s from 0 to 1 over the
    piece, as a share of the plan area of a cell. The last piece of a column only tells where it ends.
    """

    column: NDArray[np.int64]
    start: NDArray[np.int64]
    pieces: FloatArray

    @classmethod
    def of(cls, grid: Grid, medium: Medium) -> Capacity:
        """Of all columns that are not uniform."""
        mixed = ~uniform_columns(grid, medium)
        column, pieces = [], []
        layers = _layers(grid, medium)
        across = _layer_weights(grid, [span for span, _ in layers])
        for i in np.flatnonzero(mixed.any(axis=tuple(range(1, mixed.ndim)))):
            tent = _Tent.of(int(i), grid.shape[0], grid.periodic[0])
            z = _heights([edge for _, regions in layers for _, edge in regions], tent, grid.shape[-1])
            sections = np.stack([_sections(regions, tent, z) for _, regions in layers])
            for number in np.flatnonzero(mixed[i]):
                column.append(int(i) * mixed[i].size + int(number))
                pieces.append(_pieces(z, np.tensordot(across[number], sections, 1)))
        lengths = [len(p) for p in pieces]
        return cls(
            fixed(np.array(column, np.int64)),
            fixed(np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)),
            np.concatenate([np.empty((0, 5)), *pieces]),
        )


@dataclass(frozen=True)
class _Tent:
    """The tent of one column along an axis, with its images behind walls or periodic sides: centres [cells]."""

    centres: FloatArray

    @classmethod
    def of(cls, number: int, count: int, periodic: bool) -> _Tent:
        c = number + 0.5
        return cls(np.array([c, c - count, c + count] if periodic else [c, -c, 2 * count - c]))

    def below(self, x: FloatArray) -> FloatArray:
        """Its integral from far below up to x [cells]."""
        s = np.clip(np.asarray(x)[..., None] - self.centres, -1.0, 1.0)
        return np.where(s < 0, 0.5 * (1.0 + s) ** 2, 1.0 - 0.5 * (1.0 - s) ** 2).sum(axis=-1)

    @property
    def kinks(self) -> FloatArray:
        return np.unique(self.centres[:, None] + [-1.0, 0.0, 1.0])

    def touches(self, edge: FloatArray) -> NDArray[np.bool_]:
        """Which of the edges (E, 2, 2) reach into it."""
        low, high = edge[:, :, 0].min(axis=1), edge[:, :, 0].max(axis=1)
        return np.any((low[:, None] <= self.centres + 1) & (high[:, None] >= self.centres - 1), axis=1)


def uniform_columns(grid: Grid, medium: Medium) -> NDArray[np.bool_]:
    """Whether a column and those within REACH of it hold one porosity throughout and no solid, grid.shape[:-1]."""
    low, high = medium.porosity.min(axis=-1), medium.porosity.max(axis=-1)
    low = np.where(medium.open_cells.min(axis=-1) < 1.0, -1.0, low)
    for a in range(grid.dimension - 1):
        mode: Literal["wrap", "symmetric"] = "wrap" if grid.periodic[a] else "symmetric"
        around = [(REACH, REACH) if b == a else (0, 0) for b in range(grid.dimension - 1)]
        window = 2 * REACH + 1
        low = np.lib.stride_tricks.sliding_window_view(np.pad(low, around, mode), window, a).min(axis=-1)
        high = np.lib.stride_tricks.sliding_window_view(np.pad(high, around, mode), window, a).max(axis=-1)
    return high - low <= 1e-12


def _layers(grid: Grid, medium: Medium) -> list[tuple[tuple[float, float], list[Region]]]:
    """Spans of y [m], and what stands in their sections."""
    half = (grid.spacing[0] / 2, grid.spacing[-1] / 2)  # the lattice of the seeds, to round as they do
    gains = [-1.0, *(body.porosity - 1.0 for body in medium.bodies)]
    return [
        (span, [(gain, edges(area, half) / 2) for gain, area in zip(gains, (solid, *areas), strict=True)])
        for span, solid, areas in partition(grid, medium.bodies, medium.solids)
    ]


def _layer_weights(grid: Grid, spans: list[tuple[float, float]]) -> FloatArray:
    """Share (columns in y, layers) of each layer in the tents along y; 1 in 2D."""
    if grid.dimension == 2:
        return np.ones((1, 1))
    ends = np.array(spans) / grid.spacing[1]
    tents = [_Tent.of(j, grid.shape[1], grid.periodic[1]) for j in range(grid.shape[1])]
    return np.array([tent.below(ends[:, 1]) - tent.below(ends[:, 0]) for tent in tents])


def _heights(outlines: list[FloatArray], tent: _Tent, top: int) -> FloatArray:
    """Sorted heights [cells] between which the section of the column is a parabola, from 0 to top."""
    found = [np.array([0.0, float(top)])]
    for outline in outlines:
        edge = outline[tent.touches(outline)]
        found.append(edge[:, :, 1].ravel())
        start, step = edge[:, None, 0], edge[:, None, 1] - edge[:, None, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            s = (tent.kinks - start[..., 0]) / step[..., 0]
            z = start[..., 1] + s * step[..., 1]
        found.append(z[(s > 0) & (s < 1)])
    z = np.unique(np.clip(np.concatenate(found), 0.0, top))
    z = z[np.concatenate([[True], np.diff(z) > NEAR])]
    z[-1] = top
    return z


def _sections(regions: list[Region], tent: _Tent, z: FloatArray) -> FloatArray:
    """Mean porosity (P, 3) over the tent at the `SAMPLES` of each piece between the heights z (P + 1,)."""
    at = z[:-1, None] + np.diff(z)[:, None] * SAMPLES
    total = np.ones_like(at)
    for gain, edge in regions:
        for (x0, z0), (x1, z1) in edge:
            crossed = (at >= min(z0, z1)) & (at < max(z0, z1))
            if crossed.any():  # the area lies to the left of an edge that runs upwards
                x = x0 + (at[crossed] - z0) / (z1 - z0) * (x1 - x0)
                total[crossed] += gain * np.copysign(1.0, z1 - z0) * tent.below(x)
    return total


def _pieces(z: FloatArray, section: FloatArray) -> FloatArray:
    """The pieces (P + 1, 5) of one column from the sections (P, 3) at their samples."""
    low, middle, high = np.where(section < NOTHING, 0.0, section).T
    c = 4.5 * (low - 2 * middle + high)
    slope = 1.5 * (high - low)  # at the middle
    a, b = middle - slope / 2 + c / 4, slope - c
    held = np.maximum(np.diff(z) * (a + b / 2 + c / 3), 0.0)
    pieces = np.zeros((len(z), 5))
    pieces[:, 0], pieces[1:, 1] = z, np.cumsum(held)
    pieces[:-1, 2:] = np.stack([a, b, c], axis=-1)
    return pieces
