"""The first particles: the water of the case, at rest, one particle for each half cell that holds some of it.

A particle carries exactly the water of its half cell (area of the water shapes, without solids, times porosity) and
lies at the centroid of that water. So volume, mean level and centre of gravity are those of the case, wherever its
levels and interfaces lie. The tent function is linear along each axis of a half cell: the fill fraction of a submerged
cell is 1 to round-off beside porous interfaces along the axes. Beside sloping ones and at corners the term in x z is
left: up to 0.5 % for a porosity of 0.39, and 1 % beside a sloping solid. Water round the corner of a solid may have its
centroid in the solid: it gets two particles with that centre of volume, one on each side of the corner.

Some columns of half cells at a time, so that the half cells need no more memory than the particles.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
import shapely
from numpy.typing import NDArray

from houle import _core
from houle.geometry import Shape, Span, section
from houle.grid import FloatArray, Grid
from houle.moments import Measure
from houle.particles import Particles
from houle.porous import Medium, partition
from houle.solids import Outline

SLIVER = 0.25  # of the pore volume of a half cell: less water joins the particle beside it
NARROW = 0.1  # of a half cell: less pore volume than this counts as this much
SLAB = 1 << 17  # half cells at a time, about
LEVERS = (1.0, 1.5, 2.0, 3.0, 4.0)  # ratios of the distances of two particles from their common centre
BESIDE = 2  # columns beside a slab that decide what slivers give to it: a neighbour's neighbour

Region = tuple[float, list[tuple[Span, shapely.Geometry]]]  # water per volume of these areas


def seed(grid: Grid, medium: Medium, water: Sequence[Shape]) -> Particles:
    """Particles at rest that hold all water inside the union of the shapes and outside the solids, 2 per axis and cell.

    A half cell with less water than `SLIVER` of its pores gives it to the one below, or else to the fullest one beside
    it or at its corners, with its first moment; where there is none (a film thinner than that) it keeps it.
    Ordered as a raster, z fastest.
    """
    found = list(seed_slabs(grid, medium, water))
    return Particles(*(np.concatenate([getattr(p, n) for p in found]) for n in ("position", "velocity", "volume")))


def seed_slabs(grid: Grid, medium: Medium, water: Sequence[Shape]) -> Iterator[Particles]:
    """The particles of `seed`, slab by slab along x."""
    regions, half = _regions(grid, medium, water), np.array(grid.spacing) / 2
    count = 2 * grid.shape[0]
    columns = max(8, SLAB // math.prod(2 * n for n in grid.shape[1:]))
    for first in range(0, count, columns):
        end = min(first + columns, count)
        low, high = max(first - BESIDE, 0), min(end + BESIDE, count)
        volume, moment = _water(grid, regions, (low, high))
        _merge_slivers(volume, moment, _pores(medium, slice(low, high)))
        own = slice(first - low, end - low)
        held = volume[own] > 0
        volume = volume[own][held]
        position = np.stack([m[own][held] / volume for m in moment], axis=-1) * half
        position, volume = _beside_corners(grid, medium.outline, position, volume)
        yield Particles(position, np.zeros_like(position), volume * (grid.cell_volume / 2**grid.dimension))


def _beside_corners(
    grid: Grid, outline: Outline | None, position: FloatArray, volume: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Positions [m] and volumes with two particles for each one that lies in a solid: their centre is where it lay.

    Both lie in its half cell, over which the tents are linear, at the ends of the shortest of some lines through it.
    Where there is no such line the particle takes the nearest way out.
    """
    outside = position.copy()
    _core.leave_solids(grid.core, outline, outside)
    inside = np.flatnonzero((outside != position).any(axis=1))
    if len(inside) == 0:
        return position, volume
    half, d = np.array(grid.spacing) / 2, grid.dimension
    ways = [np.array(w) * half * k / 16 for k in range(1, 17) for w in product((-1, 0, 1), repeat=d) if any(w)]
    pairs = np.array([(way, -lever * way) for lever in LEVERS for way in ways])
    pairs = pairs[np.argsort(np.linalg.norm(pairs[:, 0] - pairs[:, 1], axis=-1), kind="stable")]
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


def _regions(grid: Grid, medium: Medium, water: Sequence[Shape]) -> list[Region]:
    """All the water as if in clear space, and what the porous bodies take from it."""
    parts = partition(grid, medium.bodies, medium.solids, also=water)
    wet = [section(grid, water, span) for span, _, _ in parts]
    regions = [(1.0, [(s, w.difference(solid)) for (s, solid, _), w in zip(parts, wet, strict=True)])]
    for k, body in enumerate(medium.bodies):
        inside = [(s, w.intersection(areas[k])) for (s, _, areas), w in zip(parts, wet, strict=True)]
        regions.append((body.porosity - 1.0, inside))
    return regions


def _water(grid: Grid, regions: Sequence[Region], columns: tuple[int, int]) -> tuple[FloatArray, list[FloatArray]]:
    """Water of each half cell of these columns and its first moments about the origin, in units of half cells."""
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
    """Pore volume of each half cell of these columns, in units of half cells."""
    everywhere = np.full(len(medium.bodies) + 2, 1.0)
    everywhere[1:-1] = [body.porosity for body in medium.bodies]
    everywhere[-1] = 0.0
    return everywhere[medium.body[columns]]


def _merge_slivers(volume: FloatArray, moment: list[FloatArray], pores: FloatArray) -> None:
    """Moves the water of nearly empty half cells to a neighbour, with its moments, in place."""
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
    """For each half cell (S, d) the neighbour (S, d) that takes its water, and whether there is one.

    The one below if it holds any amount, else the fullest of those beside it, else the fullest of those at its corners.
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
