"""Sponges: a linear resistance that grows towards a side of the tank and absorbs the waves that travel there.

The rate of a sponge is sigma = sigma_m xi^2 [1/s]; xi is the share of the way from its inner edge to the side of the
tank, (27) in docs/theory.md. The resistance enters the implicit drag, solved together with the pressure, and so limits
no time step.
"""

from __future__ import annotations

from math import exp, log, sqrt

import numpy as np

from houle.flow.boundaries import BOUNDARIES, Boundary, BoundaryKind, Surroundings
from houle.flow.particles import Particles
from houle.grid import Faces, FloatArray, Grid
from houle.medium.medium import Medium

LEFT_OVER = 0.003  # share of the amplitude of a wave that comes back through the sponge, by default
SLICES = 400  # pieces of a sponge in `sent_back`; four times as many change 0.003 by 1e-7

Corners = tuple[tuple[float, ...], tuple[float, ...]]  # lower and upper corner [m]


def sides(box: Corners, size: tuple[float, ...], near: float) -> list[tuple[int, bool]]:
    """Sides of the tank that a box touches: pairs (horizontal axis, True for the side at the far end of it).

    A side that is no farther than `near` [m] counts as touched. An axis along which the box reaches from side to side
    does not count: the sponge does not grow that way. size: of the tank [m].
    """
    low, high = box
    found = []
    for a in range(len(size) - 1):
        touches = (low[a] <= near, high[a] >= size[a] - near)
        if touches[0] != touches[1]:
            found.append((a, touches[1]))
    return found


def way_in(box: Corners, points: FloatArray, grid: Grid) -> FloatArray:
    """xi at points (..., d) [m]: share of the way from the edge of the sponge to the side of the tank; 0 outside it."""
    low, high = (np.asarray(corner) for corner in box)
    margin = 1e-9 * min(grid.spacing)
    inside = np.all((points >= low - margin) & (points <= high + margin), axis=-1)
    way = np.zeros(points.shape[:-1])
    for a, far in sides(box, grid.size, min(grid.spacing) / 2):
        along = (points[..., a] - low[a]) / (high[a] - low[a])
        way = np.maximum(way, along if far else 1 - along)
    return np.where(inside, np.clip(way, 0, 1), 0.0)


def way_length(box: Corners, grid: Grid) -> float:
    """Length of the sponge towards the side of the tank [m]; the shortest if it touches several sides."""
    low, high = box
    return min(high[a] - low[a] for a, _ in sides(box, grid.size, min(grid.spacing) / 2))


def damping(group_velocity: float, length: float) -> float:
    """Largest rate sigma_m [1/s] of a sponge of this length [m], such that `LEFT_OVER` of a wave comes back: (27).

    A wave that goes in and comes back keeps exp(-sigma_m length / (3 c_g)) of its amplitude, c_g its group velocity
    [m/s]: a resistance that is uniform over the depth slows the water down at the rate sigma, which takes half of that
    from the amplitude, and the mean of xi^2 is 1/3.
    """
    return -3 * log(LEFT_OVER) * group_velocity / length


def left_over(strength: float, group_velocity: float, length: float) -> float:
    """Share of the amplitude of a wave that a sponge of this strength [1/s] lets come back; inverse of `damping`."""
    return exp(-strength * length / (3 * group_velocity))


def sent_back(strength: float, length: float, wave_number: float, group_velocity: float) -> float:
    """Share of the amplitude of a wave that a sponge with a wall behind it sends back [-].

    It is what is left after the way in and out (`left_over`) together with what the growth of sigma itself sends back,
    which is much in a sponge that is short beside the wave. The velocity u of long waves obeys
    u'' + k^2 (1 + i sigma / omega) u = 0 with u = 0 at the wall; with k c_g in the place of omega the decay along x is
    that of a wave of any length, sigma / (2 c_g). It is solved from the wall to the edge in `SLICES` of one sigma each.
    Shorter waves come back less than it says, as they run on below what holds them (docs/theory.md, section 14).

    strength: sigma_m [1/s]; length [m]; wave_number: k [rad/m]; group_velocity: c_g [m/s]
    """
    step, xi = length / SLICES, (np.arange(SLICES) + 0.5) / SLICES
    k = wave_number * np.sqrt(1 + 1j * strength * xi**2 / (wave_number * group_velocity))
    u, slope = 0.0j, 1.0 + 0.0j  # at the wall
    for turn, kj in zip(k[::-1] * step, k[::-1], strict=True):
        cos, sin = np.cos(turn), np.sin(turn)
        u, slope = u * cos - slope * sin / kj, u * kj * sin + slope * cos
    onwards = 1j * wave_number * u
    return float(abs((onwards - slope) / (onwards + slope)))


class Sponge(Boundary):
    """Slows the water in a box down at the rate strength xi^2 [1/s]. strength: sigma_m [1/s]."""

    def __init__(self, grid: Grid, box: Corners, strength: float, name: str = "sponge") -> None:
        self.grid, self.box, self.strength, self.name = grid, box, strength, name

    def resist(self, rate: Faces) -> None:
        for axis, r in enumerate(rate):
            r += self.strength * way_in(self.box, self.grid.points(axis), self.grid) ** 2


def _make(
    case: Surroundings, grid: Grid, medium: Medium, water: Particles, *, name: str, box: Corners, strength: float | None
) -> Sponge:
    """The sponge of a case: as strong as given, else to absorb the waves that are made, or long waves without any."""
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
