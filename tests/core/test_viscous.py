"""Viscosity on the faces: the twin, exact Laplacians, and that it only takes energy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

import reference
from clouds import grids, linear_faces, numbered, random_faces, randoms
from houle import _core
from houle.grid import Grid


def acceleration(grid, u, nu, porosity=None, mass=None, least=0.1, molecular=0.0):
    """nu: cells, or None: molecular."""
    out = grid.faces(7.0)  # overwritten
    mass, porosity = mass or grid.faces(1.0), numbered(porosity)
    _core.viscous_acceleration(grid.core, u, mass, least, molecular, nu, porosity, out)
    return out


def strained(grid, u, molecular=0.0, constant=0.15):
    nu = grid.cells(7.0)
    _core.eddy_viscosity(grid.core, u, molecular, constant, nu)
    return nu


@settings(max_examples=40)
@given(grids(most=7), randoms)
def test_against_the_twin(grid, random):
    u, mass = random_faces(grid, random), random_faces(grid, random, 0.0, 1.0)
    nu, porosity = random.uniform(0.1, 1.0, grid.shape), random.choice([0.3, 0.7, 1.0], grid.shape)
    for n in (None, porosity):
        found = acceleration(grid, u, nu, n, mass, 0.3)
        expected = reference.viscous_acceleration(grid, u, mass, 0.3, nu, n)
        for a, b in zip(found, expected, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(strained(grid, u, 0.01), reference.eddy_viscosity(grid, u, 0.01, 0.15), rtol=1e-12)


@settings(max_examples=20)
@given(grids(least=5), randoms)
def test_a_linear_velocity_feels_nothing_inside_and_strains_evenly(grid, random):
    """lap u = 0; nu_t = (C_s Delta)^2 sqrt(2 S:S), at the walls too."""
    d = grid.dimension
    grid = Grid(grid.shape, grid.spacing, (False,) * d)
    gradient = random.normal(size=(d, d))
    u = linear_faces(grid, random.normal(size=d), gradient)
    for a in acceleration(grid, u, grid.cells(0.3)):
        assert np.abs(a[(slice(1, -1),) * d]).max() < 1e-11
    strain = 0.5 * (gradient + gradient.T)
    expected = (0.15 * grid.cell_volume ** (1 / d)) ** 2 * np.sqrt(2.0 * np.sum(strain**2))
    np.testing.assert_allclose(strained(grid, u), expected, rtol=1e-11)
    rotation = linear_faces(grid, np.zeros(d), gradient - gradient.T)
    assert np.abs(strained(grid, rotation)).max() < 1e-14


def test_a_shear_wave_decays_at_its_rate():
    """u = sin(k z): acceleration -nu k^2 u times the symbol of the second difference; divided by n in a porous body."""
    grid = Grid((4, 32), (0.5, 1.0 / 32), (True, True))
    k, h = 2.0 * np.pi, 1.0 / 32
    u = [np.sin(k * grid.points(0)[..., 1]), grid.faces()[1]]
    rate = 0.02 * (2.0 * np.sin(k * h / 2) / h) ** 2
    np.testing.assert_allclose(acceleration(grid, u, grid.cells(0.02))[0], -rate * u[0], atol=1e-13)
    in_pores = acceleration(grid, u, grid.cells(0.02), grid.cells(0.4))[0]
    np.testing.assert_allclose(in_pores, -rate / 0.4 * u[0], atol=1e-12)
    assert rate == pytest.approx(0.02 * k**2, rel=0.005)


def test_a_parabola_slows_evenly_and_walls_slip():
    """nu u'' of u = z (1 - z) is -2 nu, but in the rows at the walls, along which the water slips here."""
    grid = Grid((3, 20), (1.0, 0.05), (True, False))
    z, nu = grid.points(0)[..., 1], 0.02
    a = acceleration(grid, [z * (1.0 - z), grid.faces()[1]], None, molecular=nu)[0]
    np.testing.assert_allclose(a[:, 1:-1], -2.0 * nu, rtol=1e-10)
    plug = acceleration(grid, [np.ones(grid.face_shape(0)), grid.faces()[1]], None, molecular=nu)
    assert not plug[0].any()


@settings(max_examples=40)
@given(grids(), randoms)
def test_viscosity_only_takes_energy(grid, random):
    """sum u . lap u <= 0 for any velocity that stands still at the walls, any water."""
    u, mass = random_faces(grid, random), random_faces(grid, random, 0.0, 1.0)
    for a, v in enumerate(u):
        if not grid.periodic[a]:
            v = np.moveaxis(v, a, 0)
            v[0] = v[-1] = 0.0
    found = acceleration(grid, u, None, mass=mass, least=0.3, molecular=0.1)
    for a, (v, f) in enumerate(zip(u, found, strict=True)):
        work = np.delete(v * f, -1, axis=a) if grid.periodic[a] else v * f
        assert work.sum() <= 1e-12
