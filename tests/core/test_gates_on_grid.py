"""Gates as the grid sees them: a shut one is the wall of a shorter tank, for fill, columns, velocities and capacity."""

from __future__ import annotations

import numpy as np
import pytest

from clouds import start_of
from houle import _core
from houle.boundary.gate import Gate
from houle.flow.seeding import seed
from houle.flow.state import Flow
from houle.flow.surface import find_surface, sort
from houle.grid import FloatArray, Grid
from houle.medium.columns import Capacity
from houle.medium.interfaces import Interfaces
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box

FACE = 6  # of the gate, in cells
ROUND_OFF = 1e-12


class Tanks:
    """A tank with a gate in the middle, and one that ends there, with the same particles on the left."""

    def __init__(self, d: int, bottom: int = 0) -> None:
        shape, h = ((FACE, 4, 5), (0.1, 0.2, 0.15)) if d == 3 else ((FACE, 5), (0.1, 0.15))
        self.short = Grid(shape, h, (False,) * d)
        self.whole = Grid((2 * FACE, *shape[1:]), h, (False,) * d)
        self.gates = np.array([[self.short.size[0], bottom * h[-1]]])
        self.random = np.random.default_rng(d)
        n = 30 * int(np.prod(shape))
        x = self.random.random((n, d)) * self.short.size
        order = np.argsort(self._cell(self.short, x), kind="stable")
        self.x = np.ascontiguousarray(x[order])
        self.u, self.volume = self.random.normal(size=(n, d)), self.random.uniform(0.5, 1.5, n)
        self.media = Interfaces.with_gates(self.whole, self.gates, None)

    @staticmethod
    def _cell(grid: Grid, x: FloatArray) -> np.ndarray:
        return np.ravel_multi_index(tuple((x / grid.spacing).astype(int).T), grid.shape)

    def cloud(self, grid: Grid, kernel: str = "linear") -> tuple:
        side = np.full(len(self.x), 0.05)
        return grid.core, kernel, self.x, side, self.volume, start_of(grid, self.x)


@pytest.mark.parametrize("d", [2, 3])
def test_the_fill_and_the_columns_before_a_gate_are_those_of_a_shorter_tank(d):
    t = Tanks(d)
    for scatter, of in ((_core.scatter_cells, Grid.cells), (_core.column_heights, lambda g: np.zeros(g.shape[:-1]))):
        alone, beside = of(t.short), of(t.whole)
        scatter(t.short.core, start_of(t.short, t.x), t.x, t.volume, alone)
        scatter(t.whole.core, start_of(t.whole, t.x), t.x, t.volume, beside, gates=t.gates)
        np.testing.assert_allclose(beside[:FACE], alone, rtol=0, atol=ROUND_OFF * alone.max())
        assert not beside[FACE:].any()


@pytest.mark.parametrize("d", [2, 3])
def test_under_a_raised_gate_water_counts_on_both_sides(d):
    """All of it, once; above the edge nothing behind it, and what lies well below it as without a gate."""
    t = Tanks(d, bottom=3)
    with_gate, without = t.whole.cells(), t.whole.cells()
    start = start_of(t.whole, t.x)
    _core.scatter_cells(t.whole.core, start, t.x, t.volume, with_gate, gates=t.gates)
    _core.scatter_cells(t.whole.core, start, t.x, t.volume, without)
    assert with_gate.sum() == pytest.approx(t.volume.sum(), rel=1e-13)
    assert not with_gate[FACE:, ..., 3:].any() and without[FACE, ..., 3:].all()
    np.testing.assert_array_equal(with_gate[..., :2], without[..., :2])


@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.parametrize("d", [2, 3])
def test_velocities_before_a_gate_are_those_of_a_shorter_tank(d, order):
    """FMPM over the particles and by the mass matrix, and APIC: what runs along the gate is that of its own side."""
    t = Tanks(d)
    found = []
    for grid, media in ((t.short, None), (t.whole, t.media)):
        velocity, mass, work = grid.faces(), grid.faces(), grid.faces()
        _core.to_faces(*t.cloud(grid), t.u, None, velocity, mass, media)
        for _ in range(1, order):
            _core.add_residual(*t.cloud(grid), t.u, mass, velocity, work, media)
        u, affine = np.zeros_like(t.u), np.zeros((len(t.u), d, d))
        _core.to_particles(*t.cloud(grid), velocity, [], [], 0.0, u, media)
        _core.affine_from(*t.cloud(grid), velocity, affine, media)
        matrix = (_core.MassMatrix2 if d == 2 else _core.MassMatrix3)(grid.core)
        spaces = (grid.faces(), grid.faces(), grid.faces(), np.zeros(0), media)
        matrix.transfer(t.x, t.volume, start_of(grid, t.x), t.u, order, *spaces)
        found.append((velocity, mass, spaces[0], u, affine))
    (v0, m0, w0, u0, c0), (v1, m1, w1, u1, c1) = found
    for a in range(d):
        here = slice(0, v0[a].shape[0])
        for one, other in ((v0[a], v1[a]), (m0[a], m1[a]), (w0[a], w1[a])):
            np.testing.assert_allclose(other[here], one, rtol=0, atol=1e-9)
        assert not m1[a][v0[a].shape[0] :].any()
    np.testing.assert_allclose(u1, u0, rtol=0, atol=1e-9)
    along = np.arange(d) != 0
    np.testing.assert_allclose(c1[:, along][:, :, along], c0[:, along][:, :, along], rtol=0, atol=1e-6)


def test_columns_beside_a_gate_hold_what_they_hold_in_a_shorter_tank():
    """A body flush with the gate and one that the gate cuts off: capacity of the tents, and level of the columns."""
    h = 0.1
    bodies = [
        PorousBody("rock", Box((0.35, 0.0), (0.83, 0.52)), 0.45),
        PorousBody("sand", Box((0.6, 0.0), (1.2, 0.3)), 0.3),
    ]
    whole, short = Grid((12, 8), (h, h), (False, False)), Grid((FACE, 8), (h, h), (False, False))
    tank, alone = Medium.build(whole, bodies), Medium.build(short, bodies)
    gates = np.array([[FACE * h, 0.0]])
    beside, expected = Capacity.of(whole, tank).between_gates(whole, tank, gates), Capacity.of(short, alone)
    for column in expected.column[expected.column >= FACE - 2]:
        i, k = (int(np.flatnonzero(c.column == column)[0]) for c in (beside, expected))
        z = np.linspace(0.0, 7.9, 40)
        held = [_held(c.pieces[c.start[n] : c.start[n + 1]], z) for c, n in ((beside, i), (expected, k))]
        np.testing.assert_allclose(*held, rtol=0, atol=1e-12)
    flow = Flow(whole, tank, seed(whole, tank, [Box((0.0, 0.0), (1.2, 0.8))]), gravity=(0.0, 0.0))
    other = Flow(short, alone, seed(short, alone, [Box((0.0, 0.0), (0.6, 0.8))]), gravity=(0.0, 0.0))
    before = flow.inverse_capacity.copy()
    gate = Gate(whole, FACE * h, 1.0)
    flow.enclose([gate])
    np.testing.assert_allclose(flow.inverse_capacity[:FACE], other.inverse_capacity, rtol=1e-12)
    gate.row = 8  # lifted out of the tank
    assert flow.stand()
    np.testing.assert_allclose(flow.inverse_capacity, before, rtol=1e-12)


def _held(pieces: FloatArray, z: FloatArray) -> FloatArray:
    """Water up to heights [cells], from the pieces of a column."""
    n = np.clip(np.searchsorted(pieces[:, 0], z, side="right") - 1, 0, len(pieces) - 2)
    low, below, a, b, c = pieces[n].T
    length = pieces[n + 1, 0] - low
    s = (z - low) / length
    return below + length * s * (a + s * (b / 2 + s * c / 3))


@pytest.mark.parametrize("levels", [(0.55, 0.23), (0.4, 0.0), (0.31, 0.31)])
def test_both_levels_beside_a_gate_are_right(levels):
    """To round-off, whatever the step: each from the water on its side."""
    grid = Grid((10, 8), (0.1, 0.1), (False, False))
    left, right = levels
    medium = Medium.build(grid)
    pools = [Box((0.0, 0.0), (0.5, left)), Box((0.5, 0.0), (1.0, right))]
    water = seed(grid, medium, pools if right else pools[:1])
    flow = Flow(grid, medium, water, gravity=(0.0, 0.0))
    flow.enclose([Gate(grid, 0.5, 1.0)])
    flow.sample_medium()
    sort(flow)
    find_surface(flow)
    np.testing.assert_allclose(flow.eta[:5], left, rtol=1e-12)
    if right:
        np.testing.assert_allclose(flow.eta[5:], right, rtol=1e-12)
    else:
        assert np.isnan(flow.eta[5:]).all()
