"""Water that crosses between porosities: nothing makes energy, whatever the medium, the water and the way."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference
from clouds import grids, in_order, numbered, random_faces, randoms, scattered
from houle import _core
from houle.grid import Grid

FLOAT = 2.0**-22  # a few units of the last place in single precision, in which inertias of particles are kept


class Pores:
    """A random medium from clear water to n = 0.05 and C_r = 8, faces held or not, and particles in it."""

    def __init__(self, grid, random, held=None):
        self.grid = grid
        self.inertia = random_faces(grid, random, 0.0, 5.0)
        for f in self.inertia:
            f[...] = np.exp(f)
        rows = np.cumsum([0, *[f.size for f in self.inertia]])
        self.number = [
            np.arange(a, b, dtype=np.int32).reshape(f.shape)
            for a, b, f in zip(rows[:-1], rows[1:], self.inertia, strict=True)
        ]
        self.table = np.zeros((rows[-1], 3))
        self.table[:, 0] = np.concatenate([f.ravel() for f in self.inertia])
        self.porosity = random.uniform(0.05, 1.0, grid.shape)
        self.coefficient = random.uniform(1.0, 8.0, grid.shape)
        share = random.random() if held is None else held
        self.held = [(f < share).astype(np.uint8) for f in random_faces(grid, random, 0.0, 1.0)]
        self.x, self.start = in_order(grid, scattered(grid, random, 25))
        self.volume = random.uniform(0.5, 2.0, len(self.x))
        self.u = random.normal(size=self.x.shape)

    @property
    def medium(self):
        several = numbered(np.zeros(self.grid.shape))
        return self.number, self.table, several, several

    def sample(self, x):
        bulk, inertia = np.zeros(len(x)), np.zeros(x.shape, np.float32)
        pores = numbered(self.porosity)
        _core.sample_medium(self.grid.core, *self.medium, pores, x, self.volume, bulk, inertia)
        return bulk, inertia

    def carry(self, to, dt, lag=None):
        """Velocities after particles have gone from x to there."""
        (bulk, inertia), u = self.sample(self.x), self.u.copy()
        ago = None if lag is None else 1.0 - self.at(lag, self.x)
        medium = (*self.medium, self.held, numbered(self.porosity), numbered(self.coefficient))
        _core.carry(self.grid.core, *medium, dt, to, self.volume, bulk, inertia, u, numbered(lag), ago)
        for now, there in zip((bulk, inertia), self.sample(to), strict=True):
            np.testing.assert_array_equal(now, there)
        return u

    def at(self, cells, x):
        values = np.empty(len(x))
        _core.gather_cells(self.grid.core, np.ascontiguousarray(x), cells, values)
        return values

    def energy(self, x, u):
        return _core.kinetic_energy(*self.sample(x), u)

    def weights(self, axis, p):
        """Faces of an axis around particle p and their weights in the linear kernel."""
        g, s = self.grid, []
        for b in range(g.dimension):
            at = self.x[p, b] / g.spacing[b] - (0.0 if b == axis else 0.5)
            last = g.shape[b] if b == axis and not g.periodic[b] else g.shape[b] - 1
            low = int(np.floor(at))
            nodes = [low, low + 1]
            nodes = [n % g.shape[b] for n in nodes] if g.periodic[b] else [min(max(n, 0), last) for n in nodes]
            s.append(list(zip(nodes, (1.0 - (at - low), at - low), strict=True)))
        for pairs in np.ndindex(*[2] * g.dimension):
            chosen = [s[b][k] for b, k in enumerate(pairs)]
            yield tuple(n for n, _ in chosen), float(np.prod([w for _, w in chosen]))


@settings(max_examples=40)
@given(grids(most=6), randoms, st.floats(0.0, 10.0))
def test_a_particle_that_nothing_holds_keeps_its_energy_wherever_it_goes(grid, random, dt):
    """And turns, however long the step is."""
    pores = Pores(grid, random, held=0.0)
    to = random.random(pores.x.shape) * grid.size
    u = pores.carry(to, dt)
    before, after = pores.energy(pores.x, pores.u), pores.energy(to, u)
    assert after == pytest.approx(before, rel=FLOAT)


@settings(max_examples=40)
@given(grids(most=6), randoms, st.floats(0.0, 10.0))
def test_where_added_mass_is_on_the_rate_the_pore_velocity_is_kept_and_not_the_energy(grid, random, dt):
    """K s^2 / C_r of all components together: 1 - lag = K/C_r."""
    pores, lag = Pores(grid, random, held=0.0), random.uniform(0.0, 0.9, grid.shape)
    to = random.random(pores.x.shape) * grid.size
    u = pores.carry(to, dt, lag)
    energy = []
    for x, v in ((pores.x, pores.u), (to, u)):
        bulk, inertia = pores.sample(x)
        energy.append(np.sum(bulk[:, None] * inertia * v**2, axis=1) * (1.0 - pores.at(lag, x)))
    np.testing.assert_allclose(energy[1], energy[0], rtol=4 * FLOAT)


@settings(max_examples=40)
@given(grids(most=6), randoms)
def test_held_water_keeps_its_flux(grid, random):
    pores = Pores(grid, random, held=1.1)
    to = random.random(pores.x.shape) * grid.size
    np.testing.assert_allclose(pores.carry(to, 0.0), pores.u, rtol=1e-12)


@settings(max_examples=40)
@given(grids(most=6), randoms)
def test_inertia_of_particles_is_that_of_the_faces_around(grid, random):
    pores = Pores(grid, random)
    _, inertia = pores.sample(pores.x)
    for a in range(grid.dimension):
        expected = [sum(w * pores.inertia[a][f] for f, w in pores.weights(a, p)) for p in range(len(pores.x))]
        np.testing.assert_allclose(inertia[:, a], expected, rtol=FLOAT)


@settings(max_examples=40)
@given(grids(most=6), randoms)
def test_to_gather_momentum_makes_no_energy(grid, random):
    """PIC, with inertias that differ from face to face as much as they can."""
    pores = Pores(grid, random)
    bulk, inertia = pores.sample(pores.x)
    velocity, mass = grid.faces(), grid.faces()
    _core.to_faces(grid.core, "linear", pores.x, None, bulk, pores.start, pores.u, None, velocity, mass)
    for a, m in enumerate(mass):
        if grid.periodic[a]:
            np.moveaxis(m, a, 0)[-1] = 0.0  # the same as the first
    on_faces = _core.face_kinetic_energy(grid.core, mass, pores.number, pores.table, velocity)
    assert on_faces <= _core.kinetic_energy(bulk, inertia, pores.u) * (1.0 + FLOAT)


@settings(max_examples=40)
@given(grids(most=6), randoms)
def test_water_that_nothing_holds_takes_no_more_energy_than_the_faces_have(grid, random):
    """Linear where that makes none, and to the share that is held."""
    pores = Pores(grid, random)
    face = random_faces(grid, random)
    u = pores.u.copy()
    affine = random.normal(size=(len(u), grid.dimension, grid.dimension))
    given = affine.copy()
    _core.settle(grid.core, *pores.medium, pores.held, face, pores.x, u, affine)
    for p in range(len(u)):
        for a in range(grid.dimension):
            around = list(pores.weights(a, p))
            inertia, mean, energy, share = (
                sum(w * value(f) for f, w in around)
                for value in (
                    lambda f, a=a: pores.inertia[a][f],
                    lambda f, a=a: face[a][f],
                    lambda f, a=a: pores.inertia[a][f] * face[a][f] ** 2,
                    lambda f, a=a: pores.held[a][f],
                )
            )
            own = mean * min(1.0, np.sqrt(energy / (inertia * mean**2)))
            if len({f for f, w in around}) > 1:
                assert u[p, a] == pytest.approx(share * mean + (1.0 - share) * own, rel=1e-9, abs=1e-12)
                np.testing.assert_allclose(affine[p, a], share * given[p, a], rtol=1e-12, atol=1e-15)


def test_along_an_interface_the_momentum_with_added_mass_is_kept():
    """C_r u_x, where C_r grows from 1 to 4 with z, n = 1; in small steps, over eight cells. And the energy."""
    grid = Grid((4, 14), (1.0, 1.0), (True, False))
    pores = Pores(grid, np.random.default_rng(0), held=0.0)
    grown = [np.clip(1.0 + 3.0 * (z - 3.0) / 8.0, 1.0, 4.0) for z in (np.arange(14) + 0.5, np.arange(15.0))]
    pores.porosity[...], pores.coefficient[...] = 1.0, grown[0]
    for a, f in enumerate(pores.inertia):
        f[...] = grown[a]
    pores.table[:, 0] = np.concatenate([f.ravel() for f in pores.inertia])
    pores.x, pores.volume, pores.u = np.array([[1.7, 0.7]]), np.ones(1), np.array([[0.5, 1.0]])
    while pores.x[0, 1] < 12.0:
        to = pores.x + 0.01 * pores.u
        to[:, 0] %= 4.0
        pores.u, pores.x = pores.carry(to, 0.01), to
    assert pores.u[0, 0] == pytest.approx(0.5 / 4.0, rel=0.01)
    assert 4.0 * np.sum(pores.u**2) == pytest.approx(1.25, rel=1e-4)


@settings(max_examples=30)
@given(grids(most=6), randoms)
def test_at_the_centre_of_a_cell_the_velocity_turns_as_beside_it(grid, random):
    """There one of the two weights along an axis is 0, and the slope of C_r is that on the one side."""
    pores, axis = Pores(grid, random, held=0.0), int(random.integers(grid.dimension))
    to = pores.x.copy()
    to[:, axis] = (np.floor(to[:, axis] / grid.spacing[axis]) + 0.5) * grid.spacing[axis]
    beside = to.copy()
    beside[:, axis] += 1e-9 * grid.spacing[axis]
    np.testing.assert_allclose(pores.carry(to, 0.1), pores.carry(beside, 0.1), rtol=0.0, atol=1e-6)


@settings(max_examples=40)
@given(grids(most=6), randoms)
def test_faces_are_held_between_full_cells_of_moderate_contrast(grid, random):
    active = (random.random(grid.shape) < 0.9).astype(np.uint8)
    open_cells = np.where(random.random(grid.shape) < 0.9, 1.0, 0.0)
    contrast = random.choice([1.0, 3.0, 200.0], grid.shape)
    held = [np.full(f.shape, 7, np.uint8) for f in grid.faces()]
    _core.hold_faces(grid.core, active, numbered(open_cells), numbered(contrast), 100.0, held)
    wet = (active > 0) | (open_cells == 0.0)
    full = np.ones(grid.shape, bool)
    for step in np.ndindex(*[3] * grid.dimension):
        shifted = wet
        for a, s in enumerate(step):
            pad = [(1, 1) if b == a else (0, 0) for b in range(grid.dimension)]
            wide = np.pad(shifted, pad, mode="wrap") if grid.periodic[a] else np.pad(shifted, pad, constant_values=True)
            shifted = np.take(wide, range(s, s + grid.shape[a]), axis=a)
        full &= shifted
    deep = full & (active > 0) & (contrast == 3.0)
    for a, found in enumerate(held):
        pad = [(1, 1) if b == a else (0, 0) for b in range(grid.dimension)]
        wide = np.pad(deep, pad, mode="wrap" if grid.periodic[a] else "edge")
        n = wide.shape[a]
        expected = np.take(wide, range(n - 1), axis=a) & np.take(wide, range(1, n), axis=a)
        np.testing.assert_array_equal(found, expected)


# ---- added mass on the rate alone: momentum falls behind the water ---------------------------------------------------


def fall_behind(grid, u, inertia, held, lag, porosity, dt):
    """The core's, with one row of the table for each inertia."""
    rows = np.unique(np.concatenate([f.ravel() for f in inertia]))
    number = [np.searchsorted(rows, f).astype(np.int32) for f in inertia]
    table = np.stack([rows, 0.0 * rows, 0.0 * rows], axis=1)
    change = grid.faces()
    several = numbered(grid.cells())
    medium = (number, table, several, several, held, numbered(lag), numbered(porosity))
    _core.fall_behind(grid.core, *medium, u, dt, change)
    return change


@settings(max_examples=40)
@given(grids(most=7), randoms, st.sampled_from([1.0, 0.9, 0.5]))
def test_falling_behind_against_the_twin(grid, random, one):
    """In one medium, in few, in two that are mixed; with ways of up to three cells."""
    inertia = [np.where(f < one, 2.0, 3.5) for f in random_faces(grid, random, 0.0, 1.0)]
    held = [(f < 0.7).astype(np.uint8) for f in random_faces(grid, random, 0.0, 1.0)]
    lag = np.where(random.random(grid.shape) < 0.2, 0.0, random.uniform(0.0, 0.9, grid.shape))
    u, porosity = random_faces(grid, random), random.uniform(0.3, 1.0, grid.shape)
    state = (u, inertia, held, lag, porosity, random.uniform(0.0, 1.0))
    expected = reference.fall_behind(grid, *state)
    for a, found in enumerate(fall_behind(grid, *state)):
        ends = slice(None, -1) if grid.periodic[a] else slice(None)  # the last face is the first, to round-off
        np.testing.assert_allclose(
            np.moveaxis(found, a, 0)[ends], np.moveaxis(expected[a], a, 0)[ends], rtol=0, atol=1e-12
        )


@pytest.mark.parametrize("d", [2, 3])
def test_a_wave_along_is_shifted_and_never_larger(d):
    """u = q, v = sin kx: falls behind by lag q dt / n, to third order, and no wave grows, whatever its length."""
    n, lag, q, dt = 0.4, 0.45, 0.31, 0.7
    for cells in (4, 5, 8, 16, 32):
        grid = Grid((cells, *[2] * (d - 1)), (1.0,) * d, (True,) * d)
        phase = 2.0 * np.pi * (np.arange(cells) + 0.5) / cells
        u = grid.faces()
        u[0][...] = q
        u[1][...] = np.sin(phase).reshape(-1, *[1] * (d - 1))
        held = [np.ones(f.shape, np.uint8) for f in u]
        fields = grid.faces(2.0), held, grid.cells(lag), grid.cells(n), dt
        change = fall_behind(grid, u, *fields)
        np.testing.assert_allclose(change[0], 0.0, atol=1e-15)
        wave = (u[1] + change[1]).reshape(cells, -1)[:, 0]
        amplitude = 2.0 * np.mean(wave * np.exp(-1j * phase)) * 1j
        k = 2.0 * np.pi / cells
        assert abs(amplitude) <= 1.0 + 1e-14
        assert abs(amplitude - np.exp(1j * k * lag * q * dt / n)) < 0.05 * k**3
