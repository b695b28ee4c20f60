"""Viscosity on the faces: the twin, exact Laplacians, walls that hold or slip, and that it only takes energy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

import reference
from clouds import grids, linear_faces, numbered, random_faces, randoms
from houle import _core
from houle.grid import Grid


def acceleration(grid, u, nu, porosity=None, mass=None, no_slip=None, least=0.1, molecular=0.0):
    """nu: cells, or None: molecular."""
    out = grid.faces(7.0)  # overwritten
    no_slip = no_slip or [(False, False)] * grid.dimension
    flags = [side for pair in no_slip for side in pair]
    mass, porosity = mass or grid.faces(1.0), numbered(porosity)
    _core.viscous_acceleration(grid.core, u, mass, least, molecular, nu, porosity, flags, out)
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
    molecular = random.choice([0.0, 1e-4, 0.1])
    no_slip = [tuple(map(bool, random.integers(0, 2, 2))) for _ in range(grid.dimension)]
    for n in (None, porosity):
        found = acceleration(grid, u, nu, n, mass, no_slip, 0.3, molecular)
        expected = reference.viscous_acceleration(grid, u, mass, 0.3, molecular, nu, n, no_slip)
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


def test_walls_hold_or_slip():
    """Slow plug flow along a floor: a slip wall leaves it alone, a no-slip wall acts as u(-z) = -u(z)."""
    grid = Grid((4, 6), (1.0, 0.1), (True, False))
    u = [np.ones(grid.face_shape(0)), grid.faces()[1]]
    assert not acceleration(grid, u, grid.cells(0.01))[0].any()
    held = acceleration(grid, u, None, no_slip=[(False, False), (True, False)], molecular=0.01)[0]
    np.testing.assert_allclose(held[:, 0], -0.01 * 2.0 / 0.1**2)
    assert not held[:, 1:].any()


@pytest.mark.parametrize("speed", [0.02, 0.3, -2.0, 20.0])
def test_the_law_of_the_wall(speed):
    """Over a smooth floor, in the middle of the first cell, above the sublayer: v / v_* = ln(9.8 y v_*/nu) / 0.41."""
    grid, nu = Grid((4, 6), (0.04, 0.01), (True, False)), 1e-6
    u = [np.full(grid.face_shape(0), speed), grid.faces()[1]]
    floor = [(False, False), (True, False)]
    held = acceleration(grid, u, None, no_slip=floor, molecular=nu)[0]
    assert not held[:, 1:].any() and np.ptp(held[:, 0]) == 0.0
    taken = -held[0, 0] * 0.01 * np.sign(speed)  # v_*^2
    scale, y = np.sqrt(taken), 0.005
    assert taken > 0.0
    if abs(speed) * y / nu > 133:
        assert abs(speed) / scale == pytest.approx(np.log(9.8 * y * scale / nu) / 0.41, rel=1e-9)
    else:
        assert taken == pytest.approx(nu * abs(speed) / y, rel=1e-12)


def test_a_thin_sheet_is_held_more():
    """The shear of the floor stops the water that there is, not a cell of it."""
    grid, nu = Grid((4, 6), (0.04, 0.01), (True, False)), 1e-3
    u = [np.full(grid.face_shape(0), 0.1), grid.faces()[1]]
    floor = [(False, False), (True, False)]

    def rate(*depths):  # of the cells above the floor, shares of a cell
        mass = [np.zeros(grid.face_shape(0)), grid.faces()[1]]
        mass[0][:, : len(depths)] = np.array(depths) * grid.cell_volume
        return -acceleration(grid, u, None, mass=mass, no_slip=floor, molecular=nu, least=1e-9)[0][0, 0] / 0.1

    full = 2.0 * nu / 0.01**2
    assert rate(1.0, 1.0) == pytest.approx(full)
    assert rate(0.5) == pytest.approx(4.0 * full)
    assert rate(0.4, 0.1) == pytest.approx(4.0 * full)
    assert rate(0.1) == pytest.approx(16.0 * full)  # a quarter of a cell counts at least


def test_poiseuille_flow_is_steady():
    """Between two no-slip plates a drive G is balanced by nu u'' for the parabola, from the second row on exactly."""
    grid = Grid((3, 20), (1.0, 0.05), (True, False))
    z, nu, drive = grid.points(0)[..., 1], 0.02, 0.3
    u = [drive / (2 * nu) * z * (1.0 - z), grid.faces()[1]]
    a = acceleration(grid, u, None, no_slip=[(False, False), (True, True)], molecular=nu)[0]
    np.testing.assert_allclose(a[:, 1:-1], -drive, rtol=1e-10)
    np.testing.assert_allclose(a[:, [0, -1]], -drive, rtol=0.3)  # the wall lies half a cell from the first face


@settings(max_examples=40)
@given(grids(), randoms)
def test_viscosity_only_takes_energy(grid, random):
    """sum u . lap u <= 0 for any velocity that stands still at the walls, any water, held or slipping along them."""
    u, mass = random_faces(grid, random), random_faces(grid, random, 0.0, 1.0)
    for a, v in enumerate(u):
        if not grid.periodic[a]:
            v = np.moveaxis(v, a, 0)
            v[0] = v[-1] = 0.0
    no_slip = [tuple(map(bool, random.integers(0, 2, 2))) for _ in range(grid.dimension)]
    found = acceleration(grid, u, None, mass=mass, no_slip=no_slip, least=0.3, molecular=random.choice([0.1, 1e-5]))
    for a, (v, f) in enumerate(zip(u, found, strict=True)):
        work = np.delete(v * f, -1, axis=a) if grid.periodic[a] else v * f
        assert work.sum() <= 1e-12
