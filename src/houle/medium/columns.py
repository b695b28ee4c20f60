"""Columns of cells: the water that they can hold up to any level, and the level of the water that they hold.

`Capacity` is exact. It is for columns in which the porosity changes or solids stand, and gives the level from the
water. `Storage` has all columns, cell by cell, and gives mean level and potential energy from the levels; in columns of
one porosity it is exact too.

The water of a column is W = sum_p V_p T(x_p - x_c), where T is the tent in the horizontal (linear, two cells wide,
folded at walls): section 4 of docs/theory.md. Particles at the centroids of the water of their half cells give it
exactly, as T is linear over each half cell. Up to the level z the column can hold the integral of A(z), where A is the
integral of n T over the horizontal section at z, and n the porosity, 0 in solids. A is a parabola between any two of
the heights at which a corner of a shape lies or an edge crosses a kink of T. So the inverse, level from water, is exact
too, and water at rest has one level, whatever slopes cross it. In 3D an error of the term in x y is left where an
upright edge stands inside a half cell: a few thousandths of a cell.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid, fixed
from houle.medium.integrals import edges
from houle.medium.medium import Medium
from houle.medium.sections import partition

NEAR = 1e-10  # [cells] heights nearer to each other are one
NOTHING = 1e-12  # share of the section of a column: less open area is closed
REACH = 2  # columns around a uniform one that are alike: `column_heights` sums over one and a half on each side
SAMPLES = np.array([1.0, 3.0, 5.0]) / 6.0  # places in a piece, from 0 to 1, at which A gives the parabola

Region = tuple[float, FloatArray]  # change of the porosity in it, its edges (E, 2, 2) [cells]
Tents = list[tuple[float, "_Tent"]]  # pairs (height from which on it holds [cells], tent)


@dataclass(frozen=True)
class Capacity:
    """Water that columns can hold up to any level, in pieces from the bottom to the top, one column after the other.

    column  (M,) flat numbers of the columns
    start   (M + 1,) number of the first piece of each column
    pieces  (P, 5) lower end z of the piece and capacity of the column below it [cells]; then a, b, c of
            A = a + b s + c s^2, as a share of the plan area of a cell, with s from 0 to 1 over the piece. The last
            piece of a column only tells where it ends.
    """

    column: NDArray[np.int64]
    start: NDArray[np.int64]
    pieces: FloatArray

    @classmethod
    def of(cls, grid: Grid, medium: Medium) -> Capacity:
        """The capacity of all columns of a tank that are not uniform (`uniform_columns`)."""
        return cls._joined(_columns(grid, medium, range(grid.shape[0]), ()))

    @classmethod
    def _joined(cls, pieces: dict[int, FloatArray]) -> Capacity:
        """The capacity with these pieces (P, 5) for each column."""
        lengths = [len(p) for p in pieces.values()]
        return cls(
            fixed(np.array(list(pieces), np.int64)),
            fixed(np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)),
            np.concatenate([np.empty((0, 5)), *pieces.values()]),
        )

    def between_gates(self, grid: Grid, medium: Medium, gates: FloatArray) -> Capacity:
        """This capacity with gates (K, 2), x and lower edge [m]: the tents of the columns beside them are folded."""
        faces = {round(x / grid.spacing[0]) for x, _ in gates}
        pieces = _columns(grid, medium, sorted(faces | {face - 1 for face in faces}), gates)
        if not pieces:
            return self
        own = zip(self.column.tolist(), np.split(self.pieces, self.start[1:-1]), strict=True)
        return self._joined({**dict(own), **pieces})


@dataclass(frozen=True)
class Storage:
    """Water in all columns up to a level, and its first moment in z, by the mean open porosity of their cells.

    Both are exact up to the faces of cells, and between faces where the cell has one porosity. Inside a cell that an
    interface crosses they take the water as evenly spread over z; there only `Capacity` is exact.

    spacing  height of the cells [m]
    plan     plan area of a column [m^(d-1)]
    share    (columns, nz) porosity times open share of each cell [-]
    below    (columns, nz + 1) integral of share over z from the floor to the faces between cells [m]
    moment   (columns, nz + 1) integral of z times share [m2]
    """

    spacing: float
    plan: float
    share: FloatArray
    below: FloatArray
    moment: FloatArray

    @classmethod
    def of(cls, grid: Grid, medium: Medium) -> Storage:
        h = grid.spacing[-1]
        share = (medium.porosity * medium.open_cells).reshape(-1, grid.shape[-1])
        middle = h * (np.arange(grid.shape[-1]) + 0.5)
        below, moment = (np.pad(np.cumsum(part, axis=1), ((0, 0), (1, 0))) * h for part in (share, share * middle))
        return cls(h, grid.cell_volume / h, share, below, moment)

    def mean_level(
        self,
        eta: FloatArray,
        along: FloatArray | None = None,
        known: tuple[NDArray[np.bool_], FloatArray] | None = None,
    ) -> float:
        """Volume of the water below the levels eta (columns) [m], over the plan area of the tank [m].

        eta    NaN where dry
        along  share of each column that counts, between moving walls; None: all of each
        known  mask of columns whose water is known already, and the water of these over their area [m], which
               replaces that below their level
        """
        water = np.zeros(eta.size)
        wet, cell, z = self._top(eta)
        water[wet] = self.below[wet, cell] + self.share[wet, cell] * (z - cell * self.spacing)
        if known is not None:
            water[known[0].ravel()] = known[1]
        return float(np.mean(water) if along is None else np.sum(water * along.ravel()) / np.sum(along))

    def height_moment(self, eta: FloatArray, along: FloatArray | None = None) -> float:
        """Integral of z over the water below the levels eta [m^(d+1)]: potential energy over density and gravity."""
        wet, cell, z = self._top(eta)
        moment = self.moment[wet, cell] + 0.5 * self.share[wet, cell] * (z**2 - (cell * self.spacing) ** 2)
        return self.plan * float(np.sum(moment if along is None else moment * along.ravel()[wet]))

    def _top(self, eta: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.intp], FloatArray]:
        """The wet columns, the cell in which the level of each lies, and the level, at most that of the lid [m]."""
        eta = eta.ravel()
        wet = np.flatnonzero(eta > 0.0)
        count = self.share.shape[1]
        z = np.minimum(eta[wet], count * self.spacing)
        return wet, np.minimum((z / self.spacing).astype(np.intp), count - 1), z


@dataclass(frozen=True)
class _Tent:
    """The tent of one column along an axis: 1 - |x - c| around its centre c, with its images.

    centres    c, then the centres of the images behind walls, periodic sides and gates [cells]
    low, high  gates between which the tent lies [cells]
    """

    centres: FloatArray
    low: float = -math.inf
    high: float = math.inf

    @classmethod
    def of(cls, number: int, count: int, periodic: bool) -> _Tent:
        """The tent of a column by its number among `count` columns, without gates."""
        c = number + 0.5
        return cls(np.array([c, c - count, c + count] if periodic else [c, -c, 2 * count - c]))

    def between(self, faces: Sequence[int]) -> _Tent:
        """The tent cut and folded at gates, which stand on these faces."""
        c = self.centres[0]
        low = max((float(f) for f in faces if f < c), default=-math.inf)
        high = min((float(f) for f in faces if f > c), default=math.inf)
        images = [2.0 * f - c for f in (low, high) if math.isfinite(f)]
        return _Tent(np.concatenate([self.centres, images]), low, high)

    def below(self, x: FloatArray) -> FloatArray:
        """Integral of the tent from far below up to x [cells]."""
        whole = self._whole(np.clip(x, self.low, self.high))
        return whole - self._whole(np.array(self.low)) if math.isfinite(self.low) else whole

    def _whole(self, x: FloatArray) -> FloatArray:
        s = np.clip(np.asarray(x)[..., None] - self.centres, -1.0, 1.0)
        return np.where(s < 0, 0.5 * (1.0 + s) ** 2, 1.0 - 0.5 * (1.0 - s) ** 2).sum(axis=-1)

    @property
    def kinks(self) -> FloatArray:
        """Places at which the slope of the tent changes [cells]."""
        gates = [face for face in (self.low, self.high) if math.isfinite(face)]
        return np.unique(np.append(self.centres[:, None] + [-1.0, 0.0, 1.0], gates))

    def touches(self, edge: FloatArray) -> NDArray[np.bool_]:
        """True for the edges (E, 2, 2) that reach into the tent."""
        low, high = edge[:, :, 0].min(axis=1), edge[:, :, 0].max(axis=1)
        return np.any((low[:, None] <= self.centres + 1) & (high[:, None] >= self.centres - 1), axis=1)


def _columns(grid: Grid, medium: Medium, among: Iterable[int], gates: Iterable[FloatArray]) -> dict[int, FloatArray]:
    """The pieces (P, 5) of the columns that are not uniform, by their flat numbers. among: their numbers along x."""
    mixed = ~uniform_columns(grid, medium)
    layers = _layers(grid, medium)
    across = _layer_weights(grid, [span for span, _ in layers])
    outlines = [edge for _, regions in layers for _, edge in regions]
    found = {}
    for i in among:
        if not mixed[i].any():
            continue
        tents = _tents(grid, i, gates)
        z = _heights(outlines, tents, grid.shape[-1])
        sections = np.stack([_sections(regions, tents, z) for _, regions in layers])
        for number in np.flatnonzero(mixed[i]):
            found[i * mixed[i].size + int(number)] = _pieces(z, np.tensordot(across[number], sections, 1))
    return found


def _tents(grid: Grid, i: int, gates: Iterable[FloatArray]) -> Tents:
    """Tents along x of column i, one for each height from which on another gate folds it, above its lower edge."""
    plain, up = _Tent.of(i, grid.shape[0], grid.periodic[0]), grid.spacing[-1]
    beside = sorted((max(0.0, bottom / up - 0.5), round(x / grid.spacing[0])) for x, bottom in gates)
    beside = [(bottom, face) for bottom, face in beside if face in (i, i + 1)]
    folded = [(low, plain.between([face for _, face in beside[: k + 1]])) for k, (low, _) in enumerate(beside)]
    return [(0.0, plain), *folded]


def uniform_columns(grid: Grid, medium: Medium) -> NDArray[np.bool_]:
    """True (grid.shape[:-1]) for columns of one porosity throughout and no solid, if all within REACH are like them."""
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
    """Layers in y as spans [m], each with the regions in its section that differ from clear water."""
    half = (grid.spacing[0] / 2, grid.spacing[-1] / 2)  # lattice of the seeding, to round as that does
    gains = [-1.0, *(body.porosity - 1.0 for body in medium.bodies)]
    return [
        (span, [(gain, edges(area, half) / 2) for gain, area in zip(gains, (solid, *areas), strict=True)])
        for span, solid, areas in partition(grid, medium.bodies, medium.solids)
    ]


def _layer_weights(grid: Grid, spans: list[tuple[float, float]]) -> FloatArray:
    """Integral of the tents along y over each layer, (columns in y, layers); 1 in 2D."""
    if grid.dimension == 2:
        return np.ones((1, 1))
    ends = np.array(spans) / grid.spacing[1]
    tents = [_Tent.of(j, grid.shape[1], grid.periodic[1]) for j in range(grid.shape[1])]
    return np.array([tent.below(ends[:, 1]) - tent.below(ends[:, 0]) for tent in tents])


def _heights(outlines: list[FloatArray], tents: Tents, top: int) -> FloatArray:
    """Sorted heights [cells], from 0 to top, between which A of the column is a parabola."""
    found = [np.array([0.0, float(top), *(low for low, _ in tents)])]
    for (_, tent), outline in product(tents, outlines):
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


def _sections(regions: list[Region], tents: Tents, z: FloatArray) -> FloatArray:
    """A (P, 3), mean porosity over the tent, at the `SAMPLES` of each piece between the heights z (P + 1,) [cells]."""
    at = z[:-1, None] + np.diff(z)[:, None] * SAMPLES
    total = np.empty_like(at)
    for low, tent in tents:
        above = at[:, 0] > low
        total[above] = _mean(regions, tent, at[above])
    return total


def _mean(regions: list[Region], tent: _Tent, at: FloatArray) -> FloatArray:
    """Mean porosity over a tent at the heights `at` [cells], in the shape of these."""
    total = np.ones_like(at)
    for gain, edge in regions:
        for (x0, z0), (x1, z1) in edge:
            crossed = (at >= min(z0, z1)) & (at < max(z0, z1))
            if crossed.any():  # the area lies to the left of an edge that runs upwards
                x = x0 + (at[crossed] - z0) / (z1 - z0) * (x1 - x0)
                total[crossed] += gain * np.copysign(1.0, z1 - z0) * tent.below(x)
    return total


def _pieces(z: FloatArray, section: FloatArray) -> FloatArray:
    """The pieces (P + 1, 5) of one column between the heights z (P + 1,), from A at their samples (P, 3)."""
    low, middle, high = np.where(section < NOTHING, 0.0, section).T
    c = 4.5 * (low - 2 * middle + high)
    slope = 1.5 * (high - low)  # slope at the middle of the piece
    a, b = middle - slope / 2 + c / 4, slope - c
    water = np.maximum(np.diff(z) * (a + b / 2 + c / 3), 0.0)
    pieces = np.zeros((len(z), 5))
    pieces[:, 0], pieces[1:, 1] = z, np.cumsum(water)
    pieces[:-1, 2:] = np.stack([a, b, c], axis=-1)
    return pieces
