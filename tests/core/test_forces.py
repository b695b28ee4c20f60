"""Forces, drag and projection on the faces: against the twin, exact solutions, and no divergence at the end."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference
import reference_transfer
from clouds import grids, numbered, random_faces, randoms
from houle import _core
from houle.grid import Grid
from houle.medium.resistance import inertia_coefficient
from houle.validation.exact import PorousMedium, bernoulli_jump, duct_flow

LEAST = 0.05
CLEAR = None


def listed(inertia, darcy, forchheimer):
    """Numbers and table of the materials: as many rows as there are faces."""
    table = [np.stack([f.ravel() for f in fields], axis=1) for fields in zip(inertia, darcy, forchheimer, strict=True)]
    every = np.split(np.arange(sum(map(len, table)), dtype=np.int32), np.cumsum([len(rows) for rows in table])[:-1])
    return [number.reshape(f.shape) for number, f in zip(every, inertia, strict=True)], np.concatenate(table)


def forces(grid, u, medium, gravity, dt, extra=(), rate=(), held=()):
    """(star, drag, mobility) of the core; medium: inertia, darcy, forchheimer (faces), energy = C_r/n^2 (cells)."""
    out = [grid.faces() for _ in range(3)]
    number, table = listed(*medium[:3]) if medium else ([], None)
    energy = numbered(medium[3]) if medium else None
    _core.apply_forces(grid.core, u, number, table, list(rate), energy, list(held), gravity, list(extra), dt, *out)
    return out


def drag_work(grid, medium, u, after, mobility, rate=()):
    """Work that drag takes on faces that carry a mass of 1 / inertia."""
    number, table = listed(*medium[:3])
    mass = [1.0 / f for f in medium[0]]
    return _core.drag_work(grid.core, number, table, list(rate), mass, mobility, u, after)


def uniform(grid, n=1.0, a=0.0, b=0.0, inertia=1.0):
    return grid.faces(inertia / n), grid.faces(a), grid.faces(b), grid.cells(n**-2)


def speed_after(dt, steps, medium, drive, start=0.0):
    """Darcy velocity of a uniform flow along x under a constant drive: no pressure acts, all faces do the same."""
    grid = Grid((3, 2), (1.0, 1.0), (True, True))
    u = [grid.faces(start)[0], grid.faces()[1]]
    for _ in range(steps):
        u = forces(grid, u, uniform(grid, **medium), (drive, 0.0), dt)[0]
    assert np.ptp(u[0]) == 0.0 and not u[1].any()
    return u[0][0, 0]


# ---- against the twin ------------------------------------------------------------------------------------------------


@settings(max_examples=40)
@given(grids(most=6), randoms, st.sampled_from([1e-4, 0.03, 1.0]), st.booleans())
def test_forces_against_the_twin(grid, random, dt, pushed):
    u = random_faces(grid, random)
    medium = [random_faces(grid, random, *range_) for range_ in ((1.0, 4.0), (0.0, 20.0), (0.0, 50.0))]
    medium.append(random.uniform(1.0, 6.0, grid.shape))
    extra = random_faces(grid, random) if pushed else []
    gravity = tuple(random.normal(size=grid.dimension))
    *expected, resisted = reference.apply_forces(grid, u, *medium, gravity, extra, dt)
    found = forces(grid, u, medium, gravity, dt, extra)
    for fields, twin in zip(found, expected, strict=True):
        for a, b in zip(fields, twin, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-10, atol=1e-10)
    work = sum(float(np.sum(r * u0 * (u0 + u1))) for r, u0, u1 in zip(resisted, u, found[0], strict=True)) / 2
    assert drag_work(grid, medium, u, found[0], found[2]) == pytest.approx(work, rel=1e-9, abs=1e-12)


@given(grids(most=5), randoms)
def test_the_bernoulli_force_acts_on_held_faces_only(grid, random):
    u, held = random_faces(grid, random), [(f < 0.5).astype(np.uint8) for f in random_faces(grid, random, 0.0, 1.0)]
    medium = [random_faces(grid, random, *range_) for range_ in ((1.0, 4.0), (0.0, 20.0), (0.0, 50.0))]
    jumps, gravity = random.uniform(1.0, 6.0, grid.shape), (0.0,) * grid.dimension
    whole, none, found = (
        forces(grid, u, (*medium, energy), gravity, 0.03, held=some)
        for energy, some in ((jumps, ()), (grid.cells(1.0), ()), (jumps, held))
    )
    for fields in zip(whole, none, found, strict=True):
        for on, off, got, where in zip(*fields, held, strict=True):
            np.testing.assert_array_equal(got, np.where(where, on, off))


@given(grids(most=5), randoms)
def test_a_further_rate_resists_like_the_linear_part_of_a_material(grid, random):
    u, rate = random_faces(grid, random), random_faces(grid, random, 0.0, 20.0)
    inertia, darcy, forchheimer = (random_faces(grid, random, 1.0, 4.0) for _ in range(3))
    n2, gravity = random.uniform(1.0, 6.0, grid.shape), (0.0,) * grid.dimension
    apart = (inertia, darcy, forchheimer, n2)
    together = (inertia, [a + s for a, s in zip(darcy, rate, strict=True)], forchheimer, n2)
    one, other = forces(grid, u, apart, gravity, 0.03, rate=rate), forces(grid, u, together, gravity, 0.03)
    for fields, twin in zip(one, other, strict=True):
        for a, b in zip(fields, twin, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12)
    work = drag_work(grid, apart, u, one[0], one[2], rate)
    assert work == pytest.approx(drag_work(grid, together, u, other[0], other[2]), rel=1e-12, abs=1e-12)


@given(randoms, st.floats(1e-4, 0.1))
def test_clear_water_only_falls(random, dt):
    grid = Grid((4, 3), (1.0, 1.0), (False, False))
    u, extra = random_faces(grid, random), random_faces(grid, random)
    star, drag, mobility = forces(grid, u, CLEAR, (0.3, -9.81), dt, extra)
    for a, g in enumerate((0.3, -9.81)):
        np.testing.assert_allclose(star[a], u[a] + dt * (g + extra[a]), rtol=0, atol=1e-15)
        assert np.all(drag[a] == 1.0) and np.all(mobility[a] == dt)


def test_clear_water_falls_alike_for_any_number_of_threads():
    """Wherever a loop is cut, and what of it is a vector or the rest of one: u + dt g is rounded the same."""
    random = np.random.default_rng(1)
    grid, found = Grid((61, 67), (1.0, 1.0), (False, False)), []
    u = random_faces(grid, random)
    for threads in range(1, 9):
        _core.set_threads(threads)
        found.append(forces(grid, u, CLEAR, (0.3, -9.81), 0.0053191489361702135)[0])
    for faces in found:
        assert all(np.array_equal(a, b) for a, b in zip(faces, found[0], strict=True))


# ---- the drag --------------------------------------------------------------------------------------------------------


@given(
    st.floats(1e-4, 10.0), st.floats(0.1, 2000.0), st.floats(0.2, 1.0), st.floats(1.0, 1.5), st.floats(-1.0, 1.0),
    st.floats(-5.0, 5.0),
)  # fmt: skip
def test_linear_drag_is_exact_for_any_step(dt, a, n, inertia, start, drive):
    """(C_r/n) du/dt = G - a u: the exponential, whether a step resolves it or not, and so is half the step twice."""
    exact = drive / a + (start - drive / a) * np.exp(-a * n / inertia * dt)
    medium = {"n": n, "a": a, "inertia": inertia}
    assert speed_after(dt, 1, medium, drive, start) == pytest.approx(exact, rel=1e-12, abs=1e-14)
    assert speed_after(dt / 2, 2, medium, drive, start) == pytest.approx(exact, rel=1e-12, abs=1e-14)


@given(st.floats(1e-4, 10.0), st.floats(0.0, 500.0), st.floats(0.1, 500.0), st.floats(0.2, 1.0), st.floats(0.01, 10.0))
def test_steady_flow_stays_steady_for_any_step(dt, a, b, n, drive):
    """G = a u + b u^2 is kept to round-off by a step of any length, and approached by it: long ones are Newton's."""
    steady = 2.0 * drive / (a + np.sqrt(a**2 + 4.0 * b * drive))
    medium = {"n": n, "a": a, "b": b, "inertia": 1.3}
    assert speed_after(dt, 1, medium, drive, steady) == pytest.approx(steady, rel=1e-13)
    assert abs(speed_after(dt, 1, medium, drive, 0.9 * steady) - steady) < 0.1 * steady
    assert speed_after(1e3, 30, medium, drive, 0.0) == pytest.approx(steady, rel=1e-9)


def test_quadratic_drag_is_of_second_order():
    medium = PorousMedium(0.49, a=0.8, b=60.0, inertia=1.35)
    end, drive = 0.02, 4.905
    exact = duct_flow(np.array([end]), medium, drive)[0]
    keys = {"n": medium.porosity, "a": medium.a, "b": medium.b, "inertia": medium.inertia}
    error = [abs(speed_after(end / steps, steps, keys, drive) - exact) for steps in (10, 20, 40)]
    assert error[0] > 3.7 * error[1] > 3.7**2 * error[2]
    assert error[2] < 1e-3 * exact


def test_drag_acts_along_the_velocity():
    """A uniform oblique flow without drive keeps its direction where the drag is linear."""
    grid = Grid((3, 3), (1.0, 1.0), (True, True))
    u = [grid.faces(0.3)[0], grid.faces(-0.4)[1]]
    linear = forces(grid, u, uniform(grid, a=20.0), (0.0, 0.0), 0.05)[0]
    np.testing.assert_allclose(linear[0] / linear[1][0, 0], -0.75)
    star = forces(grid, u, uniform(grid, b=20.0), (0.0, 0.0), 1e-6)[0]
    assert (u[0] - star[0])[0, 0] / 1e-6 == pytest.approx(20.0 * 0.5 * 0.3, rel=1e-4)  # b |u| u_x
    assert (star[1] - u[1])[0, 0] / 1e-6 == pytest.approx(20.0 * 0.5 * 0.4, rel=1e-4)


def test_all_that_changes_the_velocity_is_accounted_for():
    """star = drag * old + mobility * force on every face: what the FLIP increment and the projection rely on."""
    grid, random = Grid((5, 4), (1.0, 1.0), (False, False)), np.random.default_rng(0)
    u = random_faces(grid, random)
    medium = (random_faces(grid, random, 1, 3), random_faces(grid, random, 0, 30), random_faces(grid, random, 0, 30))
    star, drag, mobility = forces(grid, u, (*medium, random.uniform(1, 5, grid.shape)), (1.0, -9.81), 0.02)
    for a, g in enumerate((1.0, -9.81)):
        np.testing.assert_allclose(star[a], drag[a] * u[a] + mobility[a] * g, atol=1e-13)


# ---- projection ------------------------------------------------------------------------------------------------------


def all_open(grid):
    return [np.ones(grid.face_shape(a), np.float32) for a in range(grid.dimension)]


class Domain:
    """A random body of water with air, shut and cut faces, and a mobility that jumps."""

    def __init__(self, grid, random, water=0.7):
        self.grid = grid
        self.depth = random.uniform(-1.0, 1.0, grid.shape) + 2 * (water - 0.5)
        self.active = (self.depth >= 0).astype(np.uint8)
        self.open = [o.astype(np.float32) for o in random_faces(grid, random, 0.01, 1.0)]
        self.mobility, self.step = random_faces(grid, random, 0.001, 0.01), 0.0
        self.star = random_faces(grid, random)
        for a, o in enumerate(self.open):
            o[random.random(o.shape) < 0.15] = 0.0
            if grid.periodic[a]:
                reference_transfer.close_periodic(grid, a, o)

    def system(self):
        k, e, rhs = self.grid.faces(), self.grid.cells(), self.grid.cells()
        _core.pressure_system(
            self.grid.core, self.active, self.depth, self.open, self.mobility, self.step, self.star, LEAST, k, e, rhs
        )
        return k, e, rhs

    def project(self, p):
        u = [s.copy() for s in self.star]
        known = [np.zeros(s.shape, np.uint8) for s in self.star]
        _core.project(self.grid.core, self.active, self.depth, self.open, self.mobility, self.step, p, LEAST, u, known)
        return u, known


@given(grids(most=5), randoms)
def test_one_mobility_everywhere_is_the_same_as_a_number(grid, random):
    domain, p = Domain(grid, random), random.normal(size=grid.shape)
    found = []
    for mobility, step in ((grid.faces(0.3), 0.0), ([], 0.3)):
        domain.mobility, domain.step = mobility, step
        k, e, rhs = domain.system()
        found.append([*k, e, rhs, *domain.project(p)[0]])
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)


@settings(max_examples=40)
@given(grids(most=7), randoms)
def test_pressure_system_and_projection_against_the_twin(grid, random):
    domain = Domain(grid, random)
    k, e, rhs = domain.system()
    tk, te, trhs = reference.pressure_system(
        grid, domain.active, domain.depth, domain.open, domain.mobility, domain.star, LEAST
    )
    for a, b in zip((*k, e, rhs), (*tk, te, trhs), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12)
    p = random.normal(size=grid.shape)
    u, known = domain.project(p)
    expected = reference.project(grid, domain.active, domain.depth, domain.open, domain.mobility, p, LEAST, domain.star)
    for a in range(grid.dimension):
        np.testing.assert_allclose(u[a], expected[0][a], rtol=1e-12, atol=1e-12)
        assert np.array_equal(known[a], expected[1][a])


@settings(max_examples=40)
@given(grids(most=9), randoms, st.sampled_from([0.4, 0.7, 1.0]))
def test_no_water_is_made_or_lost_after_the_projection(grid, random, water):
    """div u = 0 in every cell that holds water, to the solver's tolerance, on any porous, cut and broken-up domain."""
    domain = Domain(grid, random, water)
    k, e, rhs = domain.system()
    solver = (_core.PressureSolver2, _core.PressureSolver3)[grid.dimension - 2](grid.core)
    p = grid.cells()
    solver.setup(domain.active, k, e)
    tolerance = 1e-10 * max(1.0, np.abs(rhs).max())
    iterations, residual = solver.solve(rhs, p, tolerance, 300)[:2]
    assert iterations >= 0 and residual <= tolerance
    u, _ = domain.project(p)
    scale = max(np.abs(v).max() for v in u)
    divergence = reference.divergence(grid, domain.open, u)[domain.active > 0]
    assert np.abs(divergence).max(initial=0.0) <= tolerance + 1e-13 * scale


@given(st.floats(0.06, 0.999), st.floats(0.5, 20.0))
def test_still_water_feels_its_depth(theta, gravity):
    """The pressure of a column is g times the true depth, wherever the surface cuts the cell; nothing moves after."""
    grid = Grid((2, 8), (0.1, 0.1), (True, False))
    depth = np.broadcast_to(4 + theta - np.arange(8), grid.shape).copy()
    active = (depth >= 0).astype(np.uint8)
    dt = 0.01
    star, _, mobility = forces(grid, grid.faces(), CLEAR, (0.0, -gravity), dt)
    k, e, rhs, p = grid.faces(), grid.cells(), grid.cells(), grid.cells()
    open_faces = all_open(grid)
    _core.pressure_system(grid.core, active, depth, open_faces, mobility, 0.0, star, LEAST, k, e, rhs)
    solver = _core.PressureSolver2(grid.core)
    solver.setup(active, k, e)
    solver.solve(rhs, p, 1e-12 * gravity, 100)
    np.testing.assert_allclose(p, np.where(active, gravity * 0.1 * depth, 0.0), atol=1e-9)
    known = [np.zeros(s.shape, np.uint8) for s in star]
    _core.project(grid.core, active, depth, open_faces, mobility, 0.0, p, LEAST, star, known)
    assert np.abs(star[1][:, :6]).max() < 1e-11 * gravity


@pytest.mark.parametrize("n", [0.05, 0.1, 0.3, 0.49, 0.8])
@pytest.mark.parametrize("q", [0.4, -0.4])
@pytest.mark.parametrize("added_mass", [0.0, 0.34])
def test_bernoulli_jump_of_the_pressure_at_porous_faces(n, q, added_mass):
    """Flow round a duct through a plug without drag: p drops by q^2/2 (C_r/n^2 - 1) where it enters, and recovers."""
    grid = Grid((16, 1), (0.1, 0.1), (True, False))
    energy = grid.cells(1.0)
    coefficient = inertia_coefficient(n, added_mass)
    energy[5:11] = coefficient / n**2
    inertia = grid.faces(1.0)
    inertia[0][[5, 11]], inertia[0][6:11] = 0.5 * (1.0 + coefficient / n), coefficient / n
    u = [grid.faces(q)[0], grid.faces()[1]]
    dt = 1e-7  # the force at the instant
    medium = (inertia, grid.faces(), grid.faces(), energy)
    star, _, mobility = forces(grid, u, medium, (0.0, 0.0), dt)
    active, open_faces = np.ones(grid.shape, np.uint8), all_open(grid)
    k, e, rhs, p = grid.faces(), grid.cells(), grid.cells(), grid.cells()
    _core.pressure_system(grid.core, active, grid.cells(1.0), open_faces, mobility, 0.0, star, LEAST, k, e, rhs)
    solver = _core.PressureSolver2(grid.core)
    solver.setup(active, k, e)
    solver.solve(rhs, p, 1e-10 * np.abs(rhs).max(), 200)
    jump = bernoulli_jump(q, n, coefficient)
    assert p[2, 0] - p[8, 0] == pytest.approx(jump, rel=1e-4)
    assert p[14, 0] - p[8, 0] == pytest.approx(jump, rel=1e-4)
    assert np.ptp(p[:5]) < 1e-4 * jump and np.ptp(p[5:11]) < 1e-4 * jump


# ---- velocity carried into the air -----------------------------------------------------------------------------------


@settings(max_examples=40)
@given(grids(most=8), randoms, st.integers(1, 4), st.integers(1, 3), st.booleans())
def test_extrapolation_against_the_twin(grid, random, layers, near, with_mass):
    u, mass = random_faces(grid, random), random_faces(grid, random, 0.0, 1.0)
    known = [(f < 0.1).astype(np.uint8) for f in random_faces(grid, random, 0.0, 1.0)]
    mass = mass if with_mass else []
    expected = reference.extrapolate(grid, layers, near, mass, 0.8, u, known)
    _core.extrapolate(grid.core, layers, near, mass, 0.8, u, known)
    for a in range(grid.dimension):
        np.testing.assert_allclose(u[a], expected[0][a], rtol=0, atol=1e-14)
        assert np.array_equal(known[a], expected[1][a])


@settings(max_examples=40)
@given(grids(most=8), randoms, st.integers(1, 3))
def test_water_above_the_last_pressure_cell_is_not_squeezed(grid, random, layers):
    """div u = 0 in the `layers` cells above single-valued columns; nothing else is touched."""
    u = random_faces(grid, random)
    levels = random.integers(0, grid.shape[-1] + 1, grid.shape[:-1])
    active = (np.arange(grid.shape[-1]) < levels[..., None]).astype(np.uint8)
    column = np.where(random.random(grid.shape[:-1]) < 0.7, levels + 0.2, np.nan)
    before = [f.copy() for f in u]
    expected = reference.continue_upwards(grid, layers, active, column, u)
    _core.continue_upwards(grid.core, layers, active, column, u)
    for found, twin in zip(u, expected, strict=True):
        np.testing.assert_allclose(found, twin, rtol=0, atol=1e-13)
    assert all(np.array_equal(a, b) for a, b in zip(u[:-1], before[:-1], strict=True))
    net = reference.divergence(grid, grid.faces(1.0), u)
    for c in np.ndindex(*grid.shape[:-1]):
        if not np.isnan(column[c]) and levels[c] > 0:
            above = net[c][levels[c] : min(levels[c] + layers, grid.shape[-1] - 1)]
            assert np.abs(above[_interior(grid, c)]).max(initial=0.0) < 1e-12


def _interior(grid, column):
    """Everything, or nothing beside a wall: these random velocities go through it."""
    inside = all(p or 0 < i < n - 1 for i, n, p in zip(column, grid.shape[:-1], grid.periodic, strict=False))
    return slice(None) if inside else slice(0, 0)
