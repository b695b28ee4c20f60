"""Remeshing beside plates thinner than a cell: each side keeps what it has, and nothing gets past the corner of one."""

from __future__ import annotations

from math import fsum

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import reference_remesh as reference
from clouds import lattice, numbered
from houle.flow.particles import Particles
from houle.flow.remeshers import Conservative
from houle.grid import FloatArray, Grid
from houle.medium.interfaces import Interfaces
from houle.medium.sections import PorousBody, partition
from houle.medium.shapes import Box


class Plated:
    """A tank of cells of size 1 with a plate .6 thick across an axis, perhaps in a porous body."""

    def __init__(self, seed: int, d: int) -> None:
        self.random = r = np.random.default_rng(seed)
        shape = tuple(int(r.integers(3, 12 if d == 2 else 7)) for _ in range(d))
        periodic = (*(bool(r.random() < 0.3) for _ in range(d - 1)), False)
        self.axis = int(r.choice([a for a in range(d) if not periodic[a]]))
        self.grid = Grid(shape, (1.0,) * d, periodic)
        self.low = r.uniform(0.6, shape[self.axis] - 1.2)
        lower, upper = np.zeros(d), np.array(shape, float)
        lower[self.axis], upper[self.axis] = self.low, self.low + 0.6
        self.plate = Box(tuple(lower), tuple(upper))
        self.bodies: list[PorousBody] = []
        if r.random() < 0.5:
            lower[self.axis] = max(0.0, self.low - r.uniform(0.0, 2.5))
            upper[self.axis] = min(shape[self.axis], self.low + 0.6 + r.uniform(0.0, 2.5))
            self.bodies = [PorousBody("body", Box(tuple(lower), tuple(upper)), float(r.uniform(0.2, 0.9)), a=10.0)]

    def remesh(self, p: Particles) -> Particles:
        """With the plate as it is drawn: the medium would thicken it where it divides a cell."""
        half = (np.stack(np.meshgrid(*(np.arange(2 * n) for n in self.grid.shape), indexing="ij"), axis=-1) + 0.5) / 2
        body = np.zeros(half.shape[:-1], np.int8)
        for shape, number in [(b.shape, 1) for b in self.bodies] + [(self.plate, -1)]:
            body[shape.contains(half)] = number
        interfaces = Interfaces.of(self.grid, partition(self.grid, self.bodies, [self.plate]), self.bodies, body)
        porosity = np.ones(self.grid.shape)
        for b in self.bodies:
            porosity[b.shape.contains(self.grid.points())] = b.porosity
        n = reference.half_cells(self.grid, porosity, body)[tuple((2 * p.position).astype(int).T)]
        scheme = Conservative(self.grid, numbered(porosity), body, None, interfaces)
        return scheme(p, np.where(n > 0.0, n, 1.0))

    def water(self) -> Particles:
        r, d = self.random, self.grid.dimension
        x = r.random((int(r.integers(1, 80 * d)), d)) * self.grid.shape
        x = np.ascontiguousarray(x[~self.plate.contains(x)])
        return Particles(x, r.normal(size=x.shape), 0.5**d * 10 ** r.uniform(-2.0, 0.2, len(x)))

    def above(self, p: Particles) -> np.ndarray:
        return p.position[:, self.axis] > self.low + 0.3


def sums(p: Particles, some: np.ndarray) -> FloatArray:
    """Volume, momentum and first moment of some of the particles."""
    columns = [p.volume, *(p.volume * p.velocity.T), *(p.volume * p.position.T)]
    return np.array([fsum(column[some]) for column in columns])


@settings(max_examples=300, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([2, 2, 3]))
def test_each_side_of_a_plate_keeps_its_water_its_momentum_and_its_centre(seed, d):
    tank = Plated(seed, d)
    old = tank.water()
    new = tank.remesh(old)
    for side in (False, True):
        before, after = (sums(p, tank.above(p) == side) for p in (old, new))
        volume = before[0]
        momentum = fsum(old.volume * np.abs(old.velocity).sum(axis=1))
        scale = [volume, *(momentum,) * d, *(volume * n for n in tank.grid.shape)]
        known = [True] * (1 + d) + [not wraps for wraps in tank.grid.periodic]
        assert np.all(np.abs(after - before)[known] <= 1e-13 * np.array(scale)[known])


@pytest.mark.parametrize("dimension", [2, 3])
def test_nothing_is_given_past_the_corners_of_steps(dimension):
    """Closed half cells that touch by their corners alone: the steps of an oblique plate."""
    grid = Grid((8, 8, 3)[:dimension], (1.0,) * dimension, (False,) * dimension)
    body = np.zeros([2 * n for n in grid.shape], np.int8)
    body[np.arange(16), np.arange(16)] = -1
    random = np.random.default_rng(1)
    x = lattice(grid)
    x = np.clip(x + random.normal(0.0, 0.1, x.shape), 1e-9, np.array(grid.shape) - 1e-9)
    half = (2 * x).astype(int)
    x = np.ascontiguousarray(x[half[:, 0] != half[:, 1]])
    old = Particles(x, random.normal(size=x.shape), 0.5**dimension * random.uniform(0.9, 1.1, len(x)))
    new = Conservative(grid, None, body)(old, np.ones(len(old)))
    before, after = (sums(p, p.position[:, 0] > p.position[:, 1]) for p in (old, new))
    scale = sums(Particles(old.position, np.abs(old.velocity), old.volume), np.ones(len(old), bool))
    assert np.all(np.abs(after - before) <= 1e-13 * scale)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([2, 2, 3]))
def test_agrees_with_the_numpy_twin_among_closed_half_cells(seed, d):
    """A third of the half cells closed, anywhere: a particle gives to those it is joined with, in both."""
    random = np.random.default_rng(seed)
    shape = tuple(int(n) for n in random.integers(1, 6 if d == 2 else 4, d))
    grid = Grid(shape, (1.0, 0.8, 0.9)[:d], (*(bool(random.random() < 0.3) for _ in range(d - 1)), False))
    body = np.where(random.random([2 * n for n in shape]) < 0.3, -1, 0).astype(np.int8)
    x = np.clip(lattice(grid) + random.normal(0.0, 0.1, (body.size, d)), 1e-9, np.array(grid.size) - 1e-9)
    pores = reference.half_cells(grid, np.ones(shape), body)
    x = np.ascontiguousarray(x[pores[tuple((2 * x / grid.spacing).astype(int).T)] > 0.0])
    old = Particles(x, random.normal(size=x.shape), grid.cell_volume * 0.5**d * random.uniform(0.9, 1.1, len(x)))
    new = Conservative(grid, None, body)(old, None)
    assume(len(x) > 0)
    expected = reference.conservative(grid, pores, old.position, old.velocity, old.volume, np.ones(len(x)))
    for found, twin in zip((new.position, new.velocity, new.volume), expected, strict=True):
        np.testing.assert_allclose(found, twin, atol=1e-8)
