"""Transfer kernels: partition of unity, moments, and how near the paper's Taylor Gaussian comes to the exact cell."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference_transfer as reference
from clouds import start_of
from houle import _core
from houle.grid import Grid

KERNELS = list(reference.KERNELS)
POLYNOMIAL = KERNELS[:3]
REPRODUCES = {"linear": 1, "quadratic": 1, "m4prime": 2}  # degree of the polynomials a kernel interpolates exactly


def weights(grid, kernel, axis, x, side):
    """Weights of one particle on the faces of an axis, from the core: the face masses of a unit mass."""
    x = np.array([x])
    velocity, mass = grid.faces(), grid.faces()
    _core.to_faces(
        grid.core, kernel, x, np.array([side]), np.ones(1), start_of(grid, x), np.zeros_like(x), None, velocity, mass
    )
    return mass[axis]


@pytest.mark.parametrize("kernel", KERNELS)
@settings(max_examples=60)
@given(
    d=st.sampled_from([2, 3]),
    share=st.lists(st.floats(0, 1, exclude_max=True), min_size=3, max_size=3),
    periodic=st.booleans(),
    side=st.floats(0.2, 1.5),
    axis=st.integers(0, 1),
)
def test_weights_add_up_to_one_anywhere(kernel, d, share, periodic, side, axis):
    """Also beside walls, where what falls behind is folded back, and round a periodic side."""
    grid = Grid((5, 4, 6)[:d], (1.0, 0.7, 1.3)[:d], (periodic,) * d)
    x = np.array(share[:d]) * grid.size
    mass = weights(grid, kernel, axis, x, side)
    if periodic:
        mass = np.delete(mass, -1, axis=axis)
    assert mass.sum() == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("kernel", POLYNOMIAL)
@settings(max_examples=60)
@given(s=st.floats(4.0, 5.0), degree=st.integers(0, 2))
def test_polynomials_are_interpolated_exactly(kernel, s, degree):
    """sum_i w(s - i) i^k = s^k, without normalising, up to the degree of the kernel; and no further."""
    grid = Grid((9, 9), (1.0, 1.0), (False, False))
    w = weights(grid, kernel, 0, [s, 4.5], 0.5).sum(axis=1)
    error = abs(w @ (np.arange(10) - 4.5) ** degree - (s - 4.5) ** degree)
    if degree <= REPRODUCES[kernel]:
        assert error < 1e-13
    elif abs(s - round(s)) > 0.1:
        assert error > 0.05


@pytest.mark.parametrize("kernel", KERNELS)
@settings(max_examples=40)
@given(s=st.floats(4.0, 5.0), t=st.floats(4.0, 5.0), side=st.floats(0.3, 1.2))
def test_against_the_formula(kernel, s, t, side):
    """The product of the one-dimensional functions of the twin, divided by their sum; mirror images of each other."""
    grid = Grid((9, 9), (1.0, 1.0), (False, False))
    w = weights(grid, kernel, 1, [s, t], side)
    expected = np.zeros_like(w)
    node, value, _, _ = reference.stencil(grid, kernel, 1, [s, t], side)
    np.add.at(expected, node, value)
    np.testing.assert_allclose(w, expected, rtol=0, atol=1e-14)
    if abs(s - 4.5) > 1e-6:  # on a node, half a cell along axis 0, the Gaussians reach one node further to one side
        np.testing.assert_allclose(weights(grid, kernel, 1, [9.0 - s, t], side), w[::-1], rtol=0, atol=1e-13)


# per ratio of the Gaussian's width eps (W = exp(-r^2/eps^2)) to the particle's edge: largest error of the Taylor
# Gaussian and of the plain one in % of the peak, from the integral, to the digits printed
ERRORS = [(0.8, 1.6, 13), (1.0, 0.64, 8.4), (1.2, 0.31, 5.8), (1.5, 0.12, 3.7), (2.0, 0.04, 2.1)]


@pytest.mark.parametrize(("ratio", "taylor", "plain"), ERRORS)
def test_taylor_gaussian_is_near_the_exact_integral_over_the_particle(ratio, taylor, plain):
    side = np.sqrt(2.0) * reference.SIGMA / ratio
    r = np.linspace(-2.9, 2.9, 1161)
    exact = np.array([reference.gaussian_cell(s, side)[0] for s in r])
    exact *= np.sqrt(np.pi / 2) * reference.SIGMA / side  # the mean over the edge
    second_order = np.array([w * (1.0 + q) for w, q in (reference.gaussian_taylor2(s, side) for s in r)])
    point = np.array([reference.gaussian(s, side)[0] for s in r])
    for approximation, error in ((second_order, taylor), (point, plain)):
        found = 100.0 * np.abs(approximation - exact).max() / exact.max()
        assert found == pytest.approx(error, abs=0.5 if error >= 10 else 0.05 if error >= 1 else 0.005)


@settings(max_examples=30)
@given(s=st.floats(4.0, 5.0), t=st.floats(4.0, 5.0))
def test_the_gaussians_converge_to_each_other_for_small_particles(s, t):
    """Taylor - exact is of fourth order in the particle's edge, point - exact of second: in the core itself."""
    grid = Grid((9, 9), (1.0, 1.0), (False, False))

    def distance(kernel, side):
        return np.abs(weights(grid, kernel, 0, [s, t], side) - weights(grid, "gaussian-cell", 0, [s, t], side)).max()

    assert distance("gaussian-taylor2", 0.2) < distance("gaussian-taylor2", 0.4) / 12
    assert distance("gaussian", 0.2) < distance("gaussian", 0.4) / 3.5
    assert distance("gaussian-taylor2", 0.5) < 0.1 * distance("gaussian", 0.5)


@settings(max_examples=60)
@given(s=st.floats(4.0, 5.0), t=st.floats(4.0, 5.0), r=st.floats(4.0, 5.0), side=st.floats(0.1, 20.0))
def test_no_taylor_gaussian_has_negative_weights_however_large_the_particle(s, t, r, side):
    """In pores of n = 0.07 some are wider than two cells. A face that one was taken from had 4e-4 of its mass."""
    for grid, x in (
        (Grid((9, 9), (1.0, 1.0), (False, False)), [s, t]),
        (Grid((9,) * 3, (1.0,) * 3, (False,) * 3), [s, t, r]),
    ):
        assert weights(grid, "gaussian-taylor2", 1, x, side).min() >= 0.0


def test_unknown_kernel_is_refused():
    with pytest.raises(ValueError, match="unknown transfer kernel"):
        weights(Grid((4, 4), (1.0, 1.0), (False, False)), "cubic", 0, [1.0, 1.0], 0.5)
