"""Sums over the faces of all axes, for the ledger."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from clouds import grids, randoms
from houle import _core
from houle.grid import Grid


def faces_of(grid, random):
    return [random.normal(size=grid.face_shape(a)) for a in range(grid.dimension)]


def energy(mass, inertia, velocity):
    return sum(0.5 * np.sum(m * i * u**2) for m, i, u in zip(mass, inertia, velocity, strict=True))


@given(grids(), randoms)
def test_energy_and_power_of_the_faces_against_the_twin(grid, random):
    mass, velocity, force = (faces_of(grid, random) for _ in range(3))
    materials = random.random((4, 3))
    number = [random.integers(0, 4, m.shape).astype(np.int32) for m in mass]
    inertia = [materials[n, 0] for n in number]
    one = [np.ones_like(m) for m in mass]
    found = _core.face_kinetic_energy(grid.core, mass, number, materials, velocity)
    assert found == pytest.approx(energy(mass, inertia, velocity), rel=0, abs=1e-10)
    found = _core.face_kinetic_energy(grid.core, mass, [], materials, velocity)
    assert found == pytest.approx(energy(mass, one, velocity), rel=0, abs=1e-10)
    power = sum(np.sum(m * u * f) for m, u, f in zip(mass, velocity, force, strict=True))
    assert _core.face_power(grid.core, mass, velocity, force) == pytest.approx(power, rel=0, abs=1e-10)


def test_sums_of_many_blocks_have_the_same_bits_for_any_number_of_threads():
    grid, random = Grid((150, 101), (1.0, 1.0), (False, False)), np.random.default_rng(3)
    mass, velocity, force = (faces_of(grid, random) for _ in range(3))
    found = set()
    for threads in (1, 2, 5):
        _core.set_threads(threads)
        found.add(_core.face_power(grid.core, mass, velocity, force))
    assert len(found) == 1
    power = sum(np.sum(m * u * f) for m, u, f in zip(mass, velocity, force, strict=True))
    assert found.pop() == pytest.approx(power, rel=0, abs=1e-10)
