"""Seeding: makes the first particles of a run, at rest, one for each half cell that holds water.

A particle carries exactly the water of its half cell (area of the water shapes, without solids, times porosity) and
lies at the centroid of that water. So volume, mean level and centre of gravity are those of the water in the case,
wherever levels and interfaces lie.

The fill of a cell (7) weighs particles with the tent function, which is linear along each axis of a half cell. Beside
porous interfaces along the axes the fill of a submerged cell is therefore 1 to round-off. Beside sloping interfaces and
at corners an error of the term in x z is left: up to 0.5 % for a porosity of 0.39, and 1 % beside a sloping solid.
Water around the corner of a solid may have its centroid in the solid: it gets two particles with that centre of volume,
one on each side of the corner.

Beside upright interfaces that run through the whole height of the tank, water is placed as flow leaves it, with the
porosity of particles (`Settled`): a little of it, the same in all half cells of a row, lies across the interface.

The tank is done in slabs, some columns of half cells at a time, so that the half cells need no more memory than the
particles.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import shapely
from numpy.typing import NDArray

from houle import _core
from houle.flow.particles import Particles
from houle.grid import FloatArray, Grid, widened
from houle.medium.integrals import Measure
from houle.medium.medium import LEAST, Medium
from houle.medium.sections import partition, section
from houle.medium.shapes import Box, Shape, Span
from houle.medium.solids import Outline

SLIVER = 0.25  # share of the pores of a half cell: less water than this joins the particle beside it
NARROW = 0.1  # share of a half cell: less pore volume than this counts as this much
SLAB = 1 << 17  # half cells in a slab, about
LEVERS = (1.0, 1.5, 2.0, 3.0, 4.0)  # ratios of the distances of two particles from their common centre
BESIDE = 3  # columns of half cells on each side that a slab depends on: through slivers, theirs, and `Settled`
FITS = 100  # iterations of `_same_tents`: each leaves two thirds of the error
NEARLY = 1e-12  # porosities that differ by less are the same
ROUND_OFF = 1e-15  # share of a half cell: differences of water below this are round-off

Region = tuple[float, list[tuple[Span, shapely.Geometry]]]  # water per volume [-], and its areas per span of y


def seed(grid: Grid, medium: Medium, water: Sequence[Shape]) -> Particles:
    """Particles at rest that hold all water inside the union of the shapes and outside the solids, 2 per axis and cell.

    They are ordered as a raster, z fastest. A half cell with less water than `SLIVER` of its pores gives it, with its
    first moment, to the half cell below, or else to the fullest one beside it or at its corners. Where none of them
    holds enough water, as in a thin film, it keeps its own.
    """
    return Particles.together(list(seed_slabs(grid, medium, water)))


def seed_slabs(grid: Grid, medium: Medium, water: Sequence[Shape]) -> Iterator[Particles]:
    """The particles of `seed`, slab by slab along x."""
    regions, half = _regions(grid, medium, water), np.array(grid.spacing) / 2
    settled = Settled.of(grid, medium)
    count = 2 * grid.shape[0]
    columns = max(8, SLAB // math.prod(2 * n for n in grid.shape[1:]))
    for first in range(0, count, columns):
        end = min(first + columns, count)
        low, high = max(first - BESIDE, 0), min(end + BESIDE, count)
        volume, moment = _water(grid, regions, (low, high))
        if settled is not None:
            settled.apply(volume, moment, *_water(grid, regions[:1], (low, high)), low)
        _merge_slivers(volume, moment, _pores(medium, slice(low, high)))
        own = slice(first - low, end - low)
        held = volume[own] > 0
        volume = volume[own][held]
        position = np.stack([m[own][held] / volume for m in moment], axis=-1) * half
        position, volume = _beside_corners(grid, medium.outline, position, volume)
        yield Particles(position, np.zeros_like(position), volume * (grid.cell_volume / 2**grid.dimension))


@dataclass(frozen=True)
class Settled:
    """Places water beside upright interfaces, through the whole height of a tank, as flow would leave it.

    Water moves with u_d / n, where n is the continuous porosity of particles (section 3 of docs/theory.md), and so it
    comes to lie with that n: the tents of the cells hold as much of it as the structure does, but within some cells of
    an interface it is distributed in another way (decision 0010). Water that was seeded as the structure holds it
    carried up to a fifth too much or too little when it moved: the level beside the face of a block, n = 0.45, changed
    by a third of the way that the water went, and rose by 2.9 mm where 3.4 were due.

    n is the number of cells along the axis. Amounts are in half cells of clear water.

    axis   axis along which the porosity varies
    flux   (2 n + 1,) water that has to cross the ends of the half cells, towards larger x, to settle
    stir   (2 n,) further change of the first moment of the water in each half cell, in half cells times half spacings
    pores  (n,) porosity of the columns of cells, as `column_heights` sums the water in them
    """

    axis: int
    flux: FloatArray
    stir: FloatArray
    pores: FloatArray

    @classmethod
    def of(cls, grid: Grid, medium: Medium) -> Settled | None:
        """The settling of water in a tank; None for a tank where water is placed as the structure holds it.

        That is one with an oblique interface, a solid or a gate, or one in which the porosity of particles had to be
        kept away from 0.
        """
        axis = _only_axis(grid, medium)
        if axis is None:
            return None
        low = grid.lowest(1)
        whole = Box((0.0,) * grid.dimension, low.size)
        volume, moment = _water(low, _regions(low, medium, [whole]), (0, 2 * grid.shape[0]))
        line = [np.moveaxis(field, axis, 0).reshape(2 * grid.shape[axis], -1)[:, 0] for field in (volume, moment[axis])]
        return cls._fit(axis, *line)

    @classmethod
    def _fit(cls, axis: int, held: FloatArray, moment: FloatArray) -> Settled | None:
        """The settling along a line of half cells. held, moment (2 n,): water in the structure, its first moments.

        The porosity of particles is linear between the centres of the cells; its values there are such that the tents
        hold as much water as in the structure.
        """
        centre = np.arange(len(held)) + 0.5
        offset, cells = moment - held * centre, 0.5 * (held[::2] + held[1::2])
        n = _same_tents(_tents(held, offset), cells)
        around, beside = widened(n, 0, False), widened(cells, 0, False)
        if np.any(n < LEAST * np.minimum(np.minimum(beside[:-2], beside[1:-1]), beside[2:])):
            return None
        halves = np.stack([0.75 * n + 0.25 * around[:-2], 0.75 * n + 0.25 * around[2:]], axis=1).ravel()
        lean = np.stack([n - around[:-2], around[2:] - n], axis=1).ravel() / 24.0
        change = np.where(np.abs(halves - held) > ROUND_OFF, halves - held, 0.0)
        flux = np.concatenate([[0.0], -np.cumsum(change)])
        flux[np.abs(flux) < ROUND_OFF] = 0.0
        ends = np.arange(len(flux)) * flux
        stir = np.where(change != 0.0, change * centre + lean - offset - (ends[:-1] - ends[1:]), 0.0)
        return cls(axis, flux, stir, _spline_pores(halves, lean))

    def apply(
        self, volume: FloatArray, moment: list[FloatArray], wet: FloatArray, centre: list[FloatArray], first: int
    ) -> None:
        """Settles the water of a slab that begins at half cell `first` along x, in place.

        volume, moment  water of the half cells and its first moments about the origin, in half cells
        wet, centre     the space that it fills, and its first moments, in the same units
        """
        a, count = self.axis, wet.shape[self.axis]
        begin = first if a == 0 else 0
        along = [-1 if b == a else 1 for b in range(wet.ndim)]
        inner = np.arange(begin + 1, begin + count)  # the ends between two half cells of the slab
        left, right = (np.delete(wet, end, axis=a) for end in (-1, 0))
        amount = self.flux[inner].reshape(along) * np.minimum(left, right)
        self._carry(amount, volume)
        for b, field in enumerate(moment):
            if b == a:
                self._carry(amount * inner.reshape(along), field)
            else:
                at = np.divide(centre[b], wet, out=np.zeros_like(wet), where=wet > 0.0)
                self._carry(amount * np.where(amount > 0.0, np.delete(at, -1, axis=a), np.delete(at, 0, axis=a)), field)
        ends = [np.take(wet, at, axis=a) for at in (0, count - 1)]  # behind a wall, too, as much of it is water
        low, high = (np.insert(f, at, end, axis=a) for f, at, end in ((left, 0, ends[0]), (right, count - 1, ends[1])))
        moment[a] += self.stir[begin : begin + count].reshape(along) * np.minimum(np.minimum(low, high), wet)

    def _carry(self, amount: FloatArray, field: FloatArray) -> None:
        """Moves these amounts across the inner ends of the half cells, towards larger x, in place."""
        outer = [(1, 1) if b == self.axis else (0, 0) for b in range(field.ndim)]
        field -= np.diff(np.pad(amount, outer), axis=self.axis)


def column_pores(grid: Grid, medium: Medium) -> FloatArray:
    """Porosity of each column of cells (nx, [ny]) [-] by which its water is divided to get its level, as in (9).

    It has a meaning in columns of one porosity only, others have a `Capacity`. Where water is `Settled` it is the
    porosity that the spline of `column_heights` sees.
    """
    pores, settled = medium.porosity.min(axis=-1), Settled.of(grid, medium)
    if settled is None:
        return pores
    own = settled.pores.reshape([-1 if a == settled.axis else 1 for a in range(pores.ndim)])
    return np.where(np.abs(own - pores) > ROUND_OFF, own, pores)


def _only_axis(grid: Grid, medium: Medium) -> int | None:
    """The one horizontal axis along which the porosity varies, all interfaces across it; None without such an axis."""
    if medium.solids or medium.interfaces is None or not medium.settles:
        return None
    n, d = medium.porosity, grid.dimension
    varies = [a for a in range(d) if np.ptp(n, axis=a).max() > NEARLY]
    if len(varies) != 1 or varies[0] == d - 1 or grid.periodic[varies[0]]:
        return None
    across = np.abs(medium.interfaces.planes[:, varies[0]]) > 1.0 - NEARLY
    return varies[0] if across.all() else None


def _tents(held: FloatArray, offset: FloatArray) -> FloatArray:
    """Water (n,) in the tents of the cells of a line; its half cells have volumes and first moments (2 n,)."""
    wide, apart = np.pad(held, 1, "edge"), np.concatenate([[-offset[0]], offset, [-offset[-1]]])
    tent, count = np.zeros(len(held) // 2), len(held) // 2
    for k, r in enumerate((-1.5, -0.5, 0.5, 1.5)):  # middles of the half cells in a tent, from its centre
        tent += 0.5 * (1.0 - 0.5 * abs(r)) * wide[k::2][:count] - 0.25 * np.sign(r) * apart[k::2][:count]
    return tent


def _same_tents(tent: FloatArray, n: FloatArray) -> FloatArray:
    """Values (n,) at cell centres of the piecewise linear function with these means over the tents (n,).

    n: first guess. The mean over a tent is 1/6, 4/6, 1/6 of the values there and on both sides.
    """
    for _ in range(FITS):
        around = widened(n, 0, False)
        n = n + tent - (around[:-2] + 4.0 * around[1:-1] + around[2:]) / 6.0
    return n


def _spline_pores(held: FloatArray, lean: FloatArray) -> FloatArray:
    """Water (n,) of the columns of a line, summed over its particles with quadratic B-splines, as in (9).

    held, lean: volumes of the half cells and their first moments about their middles (2 n,), in half cells.
    """
    place = lean / held
    wide = np.pad(held, 2, "symmetric")
    away = np.concatenate([-place[1::-1], place, -place[:-3:-1]])
    total = np.zeros(len(held) // 2)
    for k, r in enumerate((-2.5, -1.5, -0.5, 0.5, 1.5, 2.5)):
        at = np.abs(r + away[k::2][: len(total)]) / 2.0
        weight = np.where(at < 0.5, 0.75 - at**2, 0.5 * np.maximum(1.5 - at, 0.0) ** 2)
        total += 0.5 * weight * wide[k::2][: len(total)]
    return total


def _beside_corners(
    grid: Grid, outline: Outline | None, position: FloatArray, volume: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Positions [m] and volumes [half cells] with two particles in the place of each one that lies in a solid.

    The two have the volume and the centre of that one. They lie in the same half cell, over which the tents are linear,
    at the ends of the shortest of some lines through it (`_pairs_of_ways`). Where no such line has both ends in the
    water, the particle takes the nearest way out of the solid.
    """
    outside = position.copy()
    _core.leave_solids(grid.core, outline, outside)
    inside = np.flatnonzero((outside != position).any(axis=1))
    if len(inside) == 0:
        return position, volume
    half, d = np.array(grid.spacing) / 2, grid.dimension
    pairs = _pairs_of_ways(half)
    beside, shares = [np.empty((0, d))], [np.empty(0)]
    for p in inside:
        ends = (position[p] + pairs).reshape(-1, d)
        free = ends.copy()
        _core.leave_solids(grid.core, outline, free)
        good = np.all((free == ends) & (np.floor(ends / half) == np.floor(position[p] / half)), axis=-1)
        good = good.reshape(-1, 2).all(axis=1)
        if good.any():
            first, second = pairs[np.argmax(good)]
            share = np.linalg.norm(second) / np.linalg.norm(first - second)
            outside[p] = position[p] + first
            beside.append(position[p : p + 1] + second)
            shares.append(volume[p : p + 1] * (1.0 - share))
            volume[p] *= share
    return np.concatenate([outside, *beside]), np.concatenate([volume, *shares])


def _pairs_of_ways(half: FloatArray) -> FloatArray:
    """Displacements (K, 2, d) [m] from a place to two others in line with it, the nearest pairs first.

    half: size of a half cell (d,) [m].
    """
    d = len(half)
    ways = [np.array(w) * half * k / 16 for k in range(1, 17) for w in product((-1, 0, 1), repeat=d) if any(w)]
    pairs = np.array([(way, -lever * way) for lever in LEVERS for way in ways])
    return pairs[np.argsort(np.linalg.norm(pairs[:, 0] - pairs[:, 1], axis=-1), kind="stable")]


def _regions(grid: Grid, medium: Medium, water: Sequence[Shape]) -> list[Region]:
    """The regions that make up the water: its shapes in clear space, and with negative weight the grains in them."""
    parts = partition(grid, medium.bodies, medium.solids, also=water)
    wet = [section(grid, water, span) for span, _, _ in parts]
    regions = [(1.0, [(s, w.difference(solid)) for (s, solid, _), w in zip(parts, wet, strict=True)])]
    for k, body in enumerate(medium.bodies):
        inside = [(s, w.intersection(areas[k])) for (s, _, areas), w in zip(parts, wet, strict=True)]
        regions.append((body.porosity - 1.0, inside))
    return regions


def _water(grid: Grid, regions: Sequence[Region], columns: tuple[int, int]) -> tuple[FloatArray, list[FloatArray]]:
    """Water of each half cell of the columns [first, end), and its first moments about the origin, one per axis.

    Both are in half cells, and half spacings.
    """
    share = [(weight, Measure.of(grid, areas, columns)) for weight, areas in regions]

    def total(powers: tuple[int, ...]) -> FloatArray:
        return sum(weight * measure.half_cells(powers) for weight, measure in share)  # type: ignore[return-value]

    volume = total((0,) * grid.dimension)
    volume[volume < 1e-12] = 0.0
    moments = []
    for axis, n in enumerate(volume.shape):
        lattice = np.arange(n) + (columns[0] if axis == 0 else 0)
        centre = (lattice + 0.5).reshape([-1 if a == axis else 1 for a in range(grid.dimension)])
        moments.append(total(tuple(int(a == axis) for a in range(grid.dimension))) + volume * centre)
    return volume, moments


def _pores(medium: Medium, columns: slice) -> FloatArray:
    """Pore volume of each half cell of some columns, in units of half cells."""
    everywhere = np.full(len(medium.bodies) + 2, 1.0)
    everywhere[1:-1] = [body.porosity for body in medium.bodies]
    everywhere[-1] = 0.0
    return everywhere[medium.body[columns]]


def _merge_slivers(volume: FloatArray, moment: list[FloatArray], pores: FloatArray) -> None:
    """Moves the water of nearly empty half cells to a neighbour, with its first moments, in place."""
    sliver = (volume > 0) & (volume < SLIVER * np.maximum(pores, NARROW))
    source = np.argwhere(sliver)
    if len(source) == 0:
        return
    target, found = _receivers(source, np.where(sliver, 0.0, volume))
    source, target = source[found], target[found]
    to, at = tuple(target.T), tuple(source.T)
    for field in (volume, *moment):
        np.add.at(field, to, field[at])
        field[at] = 0.0


def _receivers(source: NDArray[np.intp], amount: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """The neighbour (S, d) that takes the water of each half cell source (S, d), and whether there is one (S,).

    It is the half cell below if that holds any water, else the fullest of those beside it, else the fullest of those at
    its corners. amount: water of all half cells.
    """
    steps = np.array(sorted(product((-1, 0, 1), repeat=amount.ndim), key=lambda s: (np.abs(s).sum(), *s[::-1]))[1:])
    beside = source[:, None] + steps  # the first step is down, then come the other sides, then the corners
    inside = np.all((beside >= 0) & (beside < amount.shape), axis=-1)
    held = np.where(inside, amount[tuple(np.moveaxis(np.where(inside[..., None], beside, 0), -1, 0))], 0.0)
    preference = np.full(len(steps), 2.0)
    preference[0], preference[2 * amount.ndim :] = 4.0, 0.0
    best = np.where(held > 0, held + preference, 0.0).argmax(axis=1)
    each = np.arange(len(source))
    return beside[each, best], held[each, best] > 0
