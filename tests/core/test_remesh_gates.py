"""Remeshing beside gates: nothing goes through a shut one, and through a raised one only what lies below its edge."""

from __future__ import annotations

from math import fsum

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference_remesh as reference
from clouds import numbered, porosity_at
from houle.flow.particles import Particles
from houle.flow.remeshers import Conservative, Paper
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box

SHUT = 0.0


class Tank:
    """A tank with one or two gates in it and perhaps bodies beside them, drawn from a seed."""

    def __init__(self, seed: int, d: int, raised: bool = False, bare: bool = False) -> None:
        self.random = r = np.random.default_rng(seed)
        shape = (int(r.integers(4, 16 if d == 2 else 8)), *(int(r.integers(2, 7)) for _ in range(d - 1)))
        spacing = tuple(r.uniform(0.5, 2.0, d)) if r.random() < 0.5 else (0.02,) * d
        self.grid = Grid(shape, spacing, (*(bool(r.random() < 0.3) for _ in range(d - 1)), False))
        self.size, h = np.array(self.grid.size), spacing
        faces = np.sort(r.choice(np.arange(1, shape[0]), int(r.integers(1, 3)), replace=False))
        rows = r.integers(0, shape[-1], len(faces)) * h[-1] if raised else np.full(len(faces), SHUT)
        self.gates = np.stack([faces * h[0], rows], axis=1)
        bodies, solids = [], []
        if not bare and r.random() < 0.5:
            bodies.append(PorousBody("body", self._box(), float(r.uniform(0.1, 0.9)), a=float(r.uniform(0.0, 50.0))))
        if not bare and r.random() < 0.3:
            solids.append(self._box())
        self.medium = Medium.build(self.grid, bodies, solids)

    def _box(self) -> Box:
        """On the floor, its front at a gate or anywhere."""
        r, d = self.random, self.grid.dimension
        lower, upper = np.zeros(d), self.size * r.uniform(0.3, 0.9, d)
        lower[0] = r.choice([self.gates[0, 0], r.uniform(0.0, 0.6) * self.size[0]])
        upper[0] = lower[0] + r.uniform(0.1, 0.5) * self.size[0]
        return Box(tuple(lower), tuple(upper))

    def water(self, form: str) -> Particles:
        """Full rooms of unlike particles, films, or drops at the gates; never in a solid."""
        r, d, h = self.random, self.grid.dimension, np.array(self.grid.spacing)
        x = r.random((int(r.integers(1, 500)), d)) * self.size
        if form == "film":
            x[:, -1] = r.random(len(x)) * r.uniform(0.05, 2.0) * h[-1]
        elif form == "drops":
            x = x[:40]
            x[:, 0] = r.choice(self.gates[:, 0], len(x)) + r.normal(0.0, 0.5, len(x)) * h[0]
        x = np.ascontiguousarray(np.clip(x, 1e-9 * h, self.size - 1e-9 * h))
        body = self.medium.body[tuple(np.minimum((2 * x / h).astype(int), np.array(self.grid.shape) * 2 - 1).T)]
        x = np.ascontiguousarray(x[body >= 0])
        volume = self.grid.cell_volume / 2**d * 10 ** r.uniform(-3.0, 0.2, len(x))
        return Particles(x, r.normal(size=x.shape), volume)

    def remesh(self, p: Particles, along: bool = True) -> Particles:
        scheme = Conservative.of(self.grid, self.medium)
        return (scheme if along else scheme.with_water)(p, porosity_at(self.grid, self.medium, p), gates=self.gates)

    def room(self, p: Particles) -> np.ndarray:
        """The number of the room between the gates in which each particle is; around a periodic axis the last is the
        first.
        """
        number = np.searchsorted(self.gates[:, 0], p.position[:, 0], side="right")
        return number % len(self.gates) if self.grid.periodic[0] else number


FORMS = st.sampled_from(["full", "film", "drops"])


@settings(max_examples=250, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([2, 2, 3]), FORMS)
def test_each_side_of_a_shut_gate_keeps_its_water_its_momentum_and_its_centre(seed, d, form):
    tank = Tank(seed, d)
    old = tank.water(form)
    new = tank.remesh(old)
    before, after = tank.room(old), tank.room(new)
    assert np.all(new.volume > 0)
    for room in range(len(tank.gates) + 1):
        a, b = before == room, after == room
        volume = fsum(old.volume[a])
        assert fsum(new.volume[b]) == pytest.approx(volume, rel=2e-15 * len(old), abs=0)
        for axis in range(d):
            carried = old.volume * old.velocity[:, axis]
            assert fsum(new.volume[b] * new.velocity[b, axis]) == pytest.approx(
                fsum(carried[a]), abs=1e-13 * fsum(np.abs(carried[a])), rel=0
            )
            if not tank.grid.periodic[axis]:
                lever = fsum(new.volume[b] * new.position[b, axis]) - fsum(old.volume[a] * old.position[a, axis])
                assert abs(lever) <= 1e-13 * volume * tank.size[axis]


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([2, 3]), FORMS)
def test_marks_stay_on_their_side(seed, d, form):
    """What goes with the water is that of its own side: here the number of the room."""
    tank = Tank(seed, d)
    old = tank.water(form)
    marks = np.broadcast_to(1.0 + tank.room(old)[:, None], old.position.shape).copy()
    new = tank.remesh(Particles(old.position, marks, old.volume), along=False)
    expected = 1.0 + tank.room(new)
    sound = new.volume > 1e-6 * tank.grid.cell_volume  # the mark of next to no water is that of a difference
    np.testing.assert_allclose(new.velocity[sound], np.repeat(expected[sound, None], d, axis=1), rtol=0, atol=1e-6)


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([2, 2, 3]), FORMS)
def test_nothing_gets_round_the_edge_of_a_raised_gate(seed, d, form):
    """Water on one side of it: of that, beyond it, no more than the next cell gets, and nothing above the edge."""
    tank = Tank(seed, d, raised=True, bare=True)
    tank.gates = tank.gates[:1]
    gate, bottom = tank.gates[0]
    if tank.grid.periodic[0]:
        return
    old = tank.water(form)
    here = old.position[:, 0] < gate
    old = Particles(*(np.ascontiguousarray(v[here]) for v in (old.position, old.velocity, old.volume)))
    new = tank.remesh(old)
    assert fsum(new.volume) == pytest.approx(fsum(old.volume), rel=2e-15 * len(old) + 1e-15)
    for axis in np.flatnonzero(~np.array(tank.grid.periodic)):
        assert fsum(new.volume * new.position[:, axis]) == pytest.approx(
            fsum(old.volume * old.position[:, axis]), abs=1e-13 * fsum(old.volume) * tank.size[axis]
        )
    beyond = new.position[:, 0] >= gate
    assert np.all(new.position[beyond, -1] <= bottom)
    assert np.all(new.position[beyond, 0] <= gate + 1.5 * tank.grid.spacing[0])
    below = old.position[:, -1] < bottom
    if form != "drops":  # a debt may be paid from far away
        assert fsum(new.volume[beyond]) <= fsum(old.volume[below]) * (1 + 1e-12)


@pytest.mark.parametrize("d", [2, 3])
def test_a_gate_is_the_wall_of_a_shorter_tank(d):
    """Two tanks side by side, and one with a gate where they meet: the same particles."""
    h = (0.5, 0.25, 0.75)[:d]
    shape = (6, 4, 5)[:d]
    short = Grid(shape, h, (False,) * d)
    whole = Grid((12, *shape[1:]), h, (False,) * d)
    random = np.random.default_rng(d)
    x = random.random((400, d)) * short.size * np.append(np.ones(d - 1), 0.7)
    old = Particles(x, random.normal(size=x.shape), short.cell_volume / 2**d * random.uniform(0.5, 1.5, len(x)))
    alone = Conservative.of(short, Medium.build(short))(old, None)
    beside = Conservative.of(whole, Medium.build(whole))(old, None, gates=np.array([[short.size[0], SHUT]]))
    assert len(alone) == len(beside)
    np.testing.assert_allclose(beside.position, alone.position, rtol=0, atol=1e-13)
    np.testing.assert_allclose(beside.volume, alone.volume, rtol=1e-13)
    np.testing.assert_allclose(beside.velocity, alone.velocity, rtol=0, atol=1e-10)


@pytest.mark.parametrize("bottom", [0.0, 0.4])
@pytest.mark.parametrize("d", [2, 3])
def test_agrees_with_the_numpy_twin(d, bottom):
    grid = Grid((7, 4, 5)[:d] if d == 3 else (8, 5), (0.1, 0.15, 0.2)[:d] if d == 3 else (0.1, 0.2), (False,) * d)
    random = np.random.default_rng(3)
    x = random.random((150, d)) * grid.size * np.append(np.ones(d - 1), 0.7)
    old = Particles(x, random.normal(size=x.shape), grid.cell_volume / 2**d * random.uniform(0.8, 1.2, len(x)))
    cells, body = np.ones(grid.shape), np.zeros([2 * n for n in grid.shape], np.int8)
    cells[5:], body[-1] = 0.5, -1
    pores = reference.half_cells(grid, cells, body)
    porosity = np.where(x[:, 0] > 0.5, 0.5, 1.0)
    gates = np.array([[0.2, bottom], [0.5, SHUT]])
    new = Conservative(grid, numbered(cells), body)(old, porosity, gates=gates)
    twin = reference.conservative(grid, pores, old.position, old.velocity, old.volume, porosity, gates)
    for found, wanted, atol in zip((new.position, new.velocity, new.volume), twin, (1e-8, 1e-8, 1e-13), strict=True):
        np.testing.assert_allclose(found, wanted, rtol=0, atol=atol)


def test_the_papers_scheme_puts_no_water_behind_a_gate():
    grid = Grid((10, 6), (1.0, 1.0), (False, False))
    random = np.random.default_rng(1)
    x = random.random((200, 2)) * [5.0, 4.0]
    old = Particles(x, np.zeros_like(x), np.full(200, 0.1))
    new = Paper(grid)(old, None, gates=np.array([[5.0, SHUT]]))
    assert len(new) and new.position[:, 0].max() < 5.0


@pytest.mark.parametrize("gate", [[-0.1, 0.0], [10.1, 0.0], [np.nan, 0.0], [5.0, -1.0], [5.0, np.nan]])
def test_gates_outside_the_tank_are_refused(gate):
    grid = Grid((10, 6), (1.0, 1.0), (False, False))
    old = Particles(np.array([[5.0, 2.0]]), np.zeros((1, 2)), np.ones(1))
    with pytest.raises(ValueError, match="gates: one stands outside the tank"):
        Paper(grid)(old, None, gates=np.array([gate]))
