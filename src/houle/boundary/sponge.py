"""Sponges: a linear resistance that grows towards a side of the tank and takes up the waves that go there.

It enters the implicit drag with the pressure, and limits no time step.
"""

from __future__ import annotations

from math import exp, log, sqrt

import numpy as np

from houle.flow.boundaries import BOUNDARIES, Boundary, BoundaryKind, Surroundings
from houle.flow.particles import Particles
from houle.grid import Faces, FloatArray, Grid
from houle.medium.medium import Medium

LEFT_OVER = 0.003  # of the amplitude of a wave that went through a sponge and back

Box = tuple[tuple[float, ...], tuple[float, ...]]


def sides(box: Box, size: tuple[float, ...], near: float) -> list[tuple[int, bool]]:
    """(horizontal axis, at its far end) of the sides of the tank that a box touches, `near` [m] being touched.

    An axis along which the box goes from side to side does not count: nothing goes that way.
    """
    low, high = box
    found = []
    for a in range(len(size) - 1):
        touches = (low[a] <= near, high[a] >= size[a] - near)
        if touches[0] != touches[1]:
            found.append((a, touches[1]))
    return found


def way_in(box: Box, points: FloatArray, grid: Grid) -> FloatArray:
    """Share of the way from the edge of the sponge to the side of the tank at points (..., d); 0 outside the box."""
    low, high = (np.asarray(corner) for corner in box)
    margin = 1e-9 * min(grid.spacing)
    inside = np.all((points >= low - margin) & (points <= high + margin), axis=-1)
    way = np.zeros(points.shape[:-1])
    for a, far in sides(box, grid.size, min(grid.spacing) / 2):
        along = (points[..., a] - low[a]) / (high[a] - low[a])
        way = np.maximum(way, along if far else 1 - along)
    return np.where(inside, np.clip(way, 0, 1), 0.0)


def way_length(box: Box, grid: Grid) -> float:
    """How far it is through the sponge to the side of the tank [m], the shortest way."""
    low, high = box
    return min(high[a] - low[a] for a, _ in sides(box, grid.size, min(grid.spacing) / 2))


def damping(group_velocity: float, length: float) -> float:
    """The largest rate sigma [1/s] of a sponge of this length [m] that grows with the square of the way into it.

    A wave that goes in and comes back keeps exp(-sigma length / (3 c_g)) of its amplitude: LEFT_OVER. Uniform over
    the depth, it slows water down at the rate sigma and takes half of that from the amplitude, both ways.
    """
    return -3 * log(LEFT_OVER) * group_velocity / length


def left_over(strength: float, group_velocity: float, length: float) -> float:
    """Share of the amplitude of a wave that a sponge of this strength [1/s] lets come back: `damping` backwards."""
    return exp(-strength * length / (3 * group_velocity))


class Sponge(Boundary):
    """Slows the water of a box down at `strength` [1/s] times the square of the way into it."""

    def __init__(self, grid: Grid, box: Box, strength: float, name: str = "sponge") -> None:
        self.grid, self.box, self.strength, self.name = grid, box, strength, name

    def resist(self, rate: Faces) -> None:
        for axis, r in enumerate(rate):
            r += self.strength * way_in(self.box, self.grid.points(axis), self.grid) ** 2


def _make(
    case: Surroundings, grid: Grid, medium: Medium, water: Particles, *, name: str, box: Box, strength: float | None
) -> Sponge:
    """As strong as asked for, or as takes up the waves that are made, or long waves."""
    highest = float(water.position[:, -1].max())
    speed = sqrt(case.gravity * highest) if case.wave is None else case.wave.group_velocity
    return Sponge(grid, box, strength or damping(speed, way_length(box, grid)), name)


BOUNDARIES.add(
    BoundaryKind(
        "sponge",
        "A linear resistance that grows towards a side of the tank.",
        "docs/theory.md, section 14",
        _make,
        place=5,
        full_height=False,
    )
)
