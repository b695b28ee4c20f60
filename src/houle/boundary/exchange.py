"""Water that comes in and goes out through open sides, particle by particle, exactly as much as the faces let through.

Behind each half face of a side lies a row of particles. What comes in through the half face in a step is a thin slice
of water: it joins the first particle of the row until that is full, a half cell of water, then the next one begins.
What goes out is a slice too, taken from the first particles of the row; a particle that has nothing left is gone. So
the particles next to the side grow or shrink with the flow: volumes, and levels, do not jump when one passes. Each
stands for the water between its ends, and its place follows their middle.

What is to go out and is not within a cell of the side is owed, and taken in the steps that follow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from houle.boundary.open_side import THIN, OpenSide
from houle.flow.state import Flow
from houle.flow.surface import sort
from houle.grid import FloatArray

SPARE = 1e-3  # by which a particle may be overfull: water that hardly moves makes no specks
EDGE = 1e-6  # cells from the side: a particle that the side has stopped


def exchange(flow: Flow, dt: float) -> None:
    """Lets water in and takes water out for a step of dt [s], after the particles have moved."""
    if not flow.sides:
        return
    for side in flow.sides:
        slices = _Slices.of(side, dt)
        _take(flow, side, slices)
        _let_in(flow, side, slices, dt)
    sort(flow)


@dataclass
class _Slices:
    """What passes each half face in a step, flat over the half faces.

    volume (R,) [m^d], positive in; wet (R,) share of the half face that it fills, up to 1 + THIN; bottom (R,) of the
    half face [m].
    """

    volume: FloatArray
    wet: FloatArray
    bottom: FloatArray

    @classmethod
    def of(cls, side: OpenSide, dt: float) -> _Slices:
        wet = side.wet * side.halves(np.where(side.open > 0.0, 1.0, 0.0))
        volume = dt * side.area * wet * side.halves(side.open * side.speed)
        thin = (wet[..., 1:] > 0.0) & (wet[..., 1:] < THIN) & (wet[..., :-1] > 0.0)
        for values in (volume, wet):
            values[..., :-1] += np.where(thin, values[..., 1:], 0.0)
            values[..., 1:][thin] = 0.0
        bottom = np.broadcast_to(np.arange(wet.shape[-1]) * side.grid.spacing[-1] / 2, wet.shape)
        return cls(volume.ravel(), wet.ravel(), bottom.ravel())


def _near(flow: Flow, side: OpenSide, reach: float) -> tuple[NDArray[np.intp], FloatArray, NDArray[np.intp]]:
    """Particles within `reach` cells of the side: numbers, distances from it [m], flat numbers of their half faces."""
    p, h = flow.particles, side.grid.spacing
    distance = np.abs(p.position[:, 0] - side.x)
    chosen = np.flatnonzero(distance < reach * h[0])
    row = np.zeros(len(chosen), np.intp)
    for a, n in enumerate(side.grid.shape[1:], start=1):
        half = np.clip((p.position[chosen, a] / (h[a] / 2)).astype(np.intp), 0, 2 * n - 1)
        row = row * (2 * n) + half
    return chosen, distance[chosen], row


def _take(flow: Flow, side: OpenSide, slices: _Slices) -> None:
    """Takes out what goes out, first from each row what passes its half face, the rest from any particle nearby."""
    demand = np.maximum(-slices.volume, 0.0)
    total = float(demand.sum()) + side.owed
    if total <= 0.0:
        return
    p = flow.particles
    chosen, distance, row = _near(flow, side, 1.0)
    order = np.lexsort((distance, row))
    chosen, distance, row = chosen[order], distance[order], row[order]
    volume = p.volume[chosen]
    taken = _first(volume, row, demand[row])
    rest, left = total - float(taken.sum()), volume - taken
    if rest > 0.0:
        nearest = np.argsort(distance, kind="stable")
        more = np.zeros_like(taken)
        more[nearest] = _first(left[nearest], np.zeros(len(row), np.intp), np.full(len(row), rest))
        taken, left = taken + more, left - more
    gone = left <= 0.0
    went = float(taken.sum())
    side.went, side.owed = side.went + went, max(0.0, total - went)
    strip = side.area * np.maximum(slices.wet[row], THIN)  # its section
    stopped = distance < EDGE * side.grid.spacing[0]
    distance = np.where(stopped, left / (2 * strip), distance + taken / (2 * strip))
    changed = taken > 0.0
    p.position[chosen[changed], 0] = side.x + side.sign * np.minimum(distance, side.grid.spacing[0])[changed]
    p.volume[chosen] = np.where(gone, p.volume[chosen], left)
    keep = np.ones(len(p), bool)
    keep[chosen[gone]] = False
    if not keep.all():
        flow.particles = p.select(keep)


def _first(volume: FloatArray, group: NDArray[np.intp], demand: FloatArray) -> FloatArray:
    """What each gives when those of a group are asked in turn for the demand of the group; groups stand together."""
    if len(volume) == 0:
        return volume
    before = np.cumsum(volume) - volume
    start = np.flatnonzero(np.concatenate([[True], np.diff(group) != 0]))
    before = before - np.repeat(before[start], np.diff(np.append(start, len(group))))
    return np.clip(demand - before, 0.0, volume)


def _let_in(flow: Flow, side: OpenSide, slices: _Slices, dt: float) -> None:
    """Lets in what comes in: to the first particle of each row while that is not full, else as a new one."""
    rows = np.flatnonzero(slices.volume > 0.0)
    if len(rows) == 0:
        return
    came = slices.volume[rows]
    h, p = side.grid.spacing, flow.particles
    position = _middles(side, slices, rows)
    speed = side.halves(side.speed).ravel()[rows]
    position[:, 0] = side.x + side.sign * np.maximum(0.5 * speed * dt, 2 * EDGE * h[0])
    velocity = _velocity(flow, side, position)
    velocity[:, 0] = side.sign * speed

    chosen, distance, row = _near(flow, side, 0.5)
    order = np.lexsort((distance, row))
    first = order[np.concatenate([[True], np.diff(row[order]) != 0])] if len(order) else order
    there = np.full(len(slices.volume), -1)
    there[row[first]] = chosen[first]
    host = there[rows]
    full = (1.0 + SPARE) * slices.wet[rows] * side.area * h[0] / 2
    joins = (host >= 0) & (p.volume[host] + came <= full)

    p.join(host[joins], position[joins], velocity[joins], came[joins])
    flow.particles = p.append(position[~joins], velocity[~joins], came[~joins])
    side.came += float(came.sum())


def _middles(side: OpenSide, slices: _Slices, rows: NDArray[np.intp]) -> FloatArray:
    """Middles (R, d) of the wet parts of half faces [m]; x is that of the side."""
    h = side.grid.spacing
    at = np.full((len(rows), len(h)), side.x)
    at[:, -1] = slices.bottom[rows] + slices.wet[rows] * h[-1] / 4
    if len(h) == 3:
        at[:, 1] = (rows // side.wet.shape[-1] + 0.5) * h[1] / 2
    return at


def _velocity(flow: Flow, side: OpenSide, position: FloatArray) -> FloatArray:
    """Velocity of the water in the cells at the side, along it, linear between faces; across the side it is left 0."""
    h, shape = side.grid.spacing, side.grid.shape
    cell = [np.clip((position[:, a] / h[a]).astype(np.intp), 0, shape[a] - 1) for a in range(1, len(h))]
    velocity = np.zeros_like(position)
    for a in range(1, len(h)):
        u, low = flow.velocity[a][side.cell], tuple(cell)
        high = tuple(c + 1 if b == a else c for b, c in enumerate(cell, start=1))
        s = position[:, a] / h[a] - cell[a - 1]
        velocity[:, a] = (1 - s) * u[low] + s * u[high]
    return velocity
