"""The border between Python and the core: nothing is converted in silence, nothing read or written elsewhere."""

from __future__ import annotations

import os

import numpy as np
import pytest

from clouds import in_order, numbered
from houle import _core
from houle.grid import Grid, fixed

GRID = Grid((4, 3), (0.5, 1.0), (False, True))
KERNELS = ("linear", "quadratic", "m4prime", "gaussian", "gaussian-taylor2", "gaussian-cell")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="each call runs in a forked child")
def test_spoiled_calls_are_refused_by_name_or_do_their_work():
    """A slice of the campaign: python tests/campaigns/bindings.py --calls 5000."""
    from campaigns.bindings import campaign

    findings: list[str] = []
    found = campaign(300, seed=7, say=findings.append)
    assert not findings
    assert set(found) == {"refused", "done"} and min(found.values()) > 30


def gather(position=None, field=None, out=None):
    position = np.full((5, 2), 0.7) if position is None else position
    field = GRID.cells(1.0) if field is None else field
    out = np.zeros(len(position)) if out is None else out
    _core.gather_cells(GRID.core, position, field, out)
    return out


@pytest.mark.parametrize(
    ("spoiled", "error", "words"),
    [
        (
            {"out": np.zeros(5, np.float32)},
            TypeError,
            "out must be a C-contiguous array of float64, writable, not float32",
        ),
        ({"out": np.zeros(10)[::2]}, TypeError, r"shape \(5,\), not C-contiguous"),
        ({"out": fixed(np.zeros(5))}, TypeError, "out .* not read-only float64"),
        ({"out": np.zeros(5, ">f8")}, TypeError, "out must be"),
        ({"out": [0.0] * 5}, TypeError, "out .* not list"),
        ({"out": np.zeros(4)}, ValueError, "out has 4 entries"),
        ({"field": np.ones((3, 4))}, ValueError, r"field has 12 entries, shape \(3, 4\), wanted .* \(4, 3\)"),
        ({"field": np.asfortranarray(GRID.cells())}, TypeError, "field .* not C-contiguous"),
        ({"position": np.zeros((5, 3))}, ValueError, r"position must have shape \(N, 2\), not \(5, 3\)"),
    ],
)
def test_an_array_that_does_not_fit_is_named(spoiled, error, words):
    with pytest.raises(error, match=rf"gather_cells\(\): .*{words}"):
        gather(**spoiled)


def test_what_is_only_read_may_be_read_only():
    assert gather(field=fixed(GRID.cells(2.0))) == pytest.approx(2.0)


def test_a_number_that_is_none_is_named():
    u = GRID.faces()
    known = [np.zeros(f.shape, np.uint8) for f in u]
    with pytest.raises(TypeError, match=r"extrapolate\(\): near must be a whole number of 32 bits, not str"):
        _core.extrapolate(GRID.core, 6, "two", [], 0.0, u, known)
    with pytest.raises(TypeError, match=r"extrapolate\(\): grid must be a Grid2 or a Grid3, not None"):
        _core.extrapolate(None, 6, 2, [], 0.0, u, known)
    for layers in (-1, 251):
        with pytest.raises(ValueError, match="layers"):
            _core.extrapolate(GRID.core, layers, 2, [], 0.0, u, known)


@pytest.mark.parametrize("read_only", [False, True])
def test_tables_that_point_elsewhere_are_refused(read_only):
    """Whether they are checked in every call or, read-only, once: what comes after a good table is looked at too."""
    made = fixed if read_only else np.array
    x, volume, bulk = np.full((1, 2), 0.6), np.ones(1), np.zeros(1)
    number, value = numbered(GRID.cells(1.0))

    def sample(number, value):
        faces = [np.zeros(GRID.face_shape(a), np.int32) for a in range(2)]
        medium = (
            faces,
            np.array([[1.0, 0.0, 0.0]]),
            numbered(GRID.cells()),
            numbered(GRID.cells()),
            (number, value),
        )
        _core.sample_medium(GRID.core, *medium, x, volume, bulk, np.zeros((1, 2), np.float32))

    for _ in range(2):
        sample(made(number), value)
        for wrong in (-1, len(value), 2**31 - 1):
            spoiled = number.copy()
            spoiled[-1] = wrong
            with pytest.raises(ValueError, match="porosity has numbers outside 0 to 11"):
                sample(made(spoiled), value)
        with pytest.raises(ValueError, match="porosity has numbers outside 0 to 10"):
            sample(made(number), value[:-1])


def test_a_table_without_entries_has_no_number_0_but_may_have_none():
    """What a cell has no value for cannot be read; a cell that is near no interface needs none in the list."""
    held, cells = [np.zeros(GRID.face_shape(a), np.uint8) for a in range(2)], numbered(GRID.cells(1.0))
    with pytest.raises(ValueError, match="open has numbers outside 0 to -1"):
        empty = np.zeros(GRID.shape, np.int32), np.zeros(0)
        _core.hold_faces(GRID.core, np.ones(GRID.shape, np.uint8), empty, cells, 30.0, held)
    nowhere = np.full(GRID.shape, -1, np.int32)
    media = nowhere, nowhere, np.zeros((0, 5)), [np.zeros(GRID.face_shape(a), np.int8) for a in range(2)]
    x, u = np.full((1, 2), 0.6), np.zeros((1, 2))
    start = np.zeros(np.prod(GRID.shape) + 1, np.int32)
    _core.to_particles(GRID.core, "linear", x, None, np.ones(1), start, GRID.faces(2.0), [], [], 0.0, u, media)
    np.testing.assert_allclose(u, 2.0, rtol=1e-12)


def test_starts_that_fall_are_refused():
    x, start = in_order(GRID, np.random.default_rng(1).random((20, 2)) * GRID.size)
    for k in (0, 3, 12):
        spoiled = start.copy()
        spoiled[k] = 10**6 if k else -1
        with pytest.raises(ValueError, match="start does not fit the particles"):
            _core.scatter_cells(GRID.core, spoiled, x, np.ones(20), GRID.cells())


def test_work_space_of_sorting_must_lie_apart():
    x = np.full((4, 2), 0.2)
    same = np.zeros(4, np.int32)
    with pytest.raises(ValueError, match="cell and order share memory"):
        _core.cell_sort(GRID.core, x, same, same, np.zeros(13, np.int32))


@pytest.mark.parametrize("shape", [(50_000, 50_000), (2**31 - 1, 1), (2**62, 2**62), (1300, 1300, 1300)])
def test_a_grid_whose_cells_cannot_be_numbered_is_refused(shape):
    d = len(shape)
    kind = _core.Grid2 if d == 2 else _core.Grid3
    with pytest.raises(ValueError, match=r"more than 2\^31 - 2 cells"):
        kind(shape, (1.0,) * d, (False,) * d)
    with pytest.raises(ValueError, match=r"more than 2\^31 - 2 cells"):
        _ = Grid(shape, (1.0,) * d, (False,) * d).core
    kind((46_000, 46_000) if d == 2 else (1290, 1290, 1290), (1.0,) * d, (False,) * d)


# ---- positions that are none ----------------------------------------------------------------------------------------

NOWHERE = (np.nan, np.inf, -np.inf, 1e300, -1e300, 1e9, -1e9)


@pytest.mark.parametrize("value", NOWHERE)
@pytest.mark.parametrize("dimension", [2, 3])
def test_sorting_tells_of_a_particle_outside_the_tank(value, dimension):
    grid = Grid((3,) * dimension, (0.5,) * dimension, (False,) * (dimension - 1) + (True,))
    for axis in range(dimension):
        x = np.full((6, dimension), 0.4)
        x[4, axis] = value
        before, work = x.copy(), np.zeros((6, dimension))
        order, start = np.zeros(6, np.int32), np.zeros(3**dimension + 1, np.int32)
        with pytest.raises(FloatingPointError, match=r"particle 4 is at .* outside the tank"):
            _core.sort_particles(grid.core, x, x.copy(), np.ones(6), work, order, start)
        assert np.array_equal(x, before, equal_nan=True) and sorted(order) == list(range(6))


def guarded(shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """An array in the middle of a larger one."""
    size = int(np.prod(shape))
    whole = np.full(size + 4096, 7.0)
    return whole, whole[2048 : 2048 + size].reshape(shape)


@pytest.mark.parametrize("value", NOWHERE)
@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("periodic", [False, True])
def test_no_transfer_writes_elsewhere(kernel, value, periodic):
    """Whatever the positions of the particles: what lies beside the face fields stays."""
    grid = Grid((5, 4), (0.5, 0.25), (periodic, False))
    for axis in range(2):
        x, start = in_order(grid, np.random.default_rng(2).random((12, 2)) * grid.size)
        x[7, axis] = value
        side = np.full(12, 0.1)
        fields = [guarded(grid.face_shape(a)) for a in range(2)]
        masses = [guarded(grid.face_shape(a)) for a in range(2)]
        u, mass = np.ones((12, 2)), np.ones(12)
        faces, face_mass = [f for _, f in fields], [m for _, m in masses]
        _core.to_faces(grid.core, kernel, x, side, mass, start, u, None, faces, face_mass)
        _core.add_residual(grid.core, kernel, x, side, mass, start, u, face_mass, faces, grid.faces())
        _core.to_particles(grid.core, kernel, x, side, mass, start, faces, [], [], 0.0, u)
        cells, c = guarded(grid.shape)
        _core.scatter_cells(grid.core, start, x, mass, c)
        matrix = _core.MassMatrix2(grid.core)
        matrix.transfer(x, mass, start, np.ones((12, 2)), 4, faces, face_mass, grid.faces(), np.zeros(0))
        for whole in (cells, *(w for w, _ in fields), *(w for w, _ in masses)):
            assert np.all(whole[:2048] == 7.0) and np.all(whole[-2048:] == 7.0)


@pytest.mark.parametrize("name", ["position", "velocity", "volume"])
def test_remeshing_refuses_what_is_no_number(name):
    p = {"position": np.full((4, 2), 0.3), "velocity": np.ones((4, 2)), "volume": np.full(4, 0.1)}
    p[name].flat[1] = np.nan
    with pytest.raises(FloatingPointError, match="outside the tank" if name == "position" else name):
        _core.remesh_conservative(GRID.core, None, np.zeros((8, 6), np.int8), None, *p.values(), None)
    with pytest.raises(FloatingPointError, match="outside the tank" if name == "position" else name):
        _core.remesh_paper(GRID.core, *p.values(), None, 0.01)
