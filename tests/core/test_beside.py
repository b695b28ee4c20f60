"""What particles beside an interface see of the faces, and what they give to them: core/houle/water/interfaces.hpp."""

import itertools

import numpy as np
import pytest
import shapely

from houle import _core
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box, Polygon

ROUND_OFF = 1e-12
PLANE, SPACE = Grid((9, 7), (0.1, 0.12), (False, False)), Grid((9, 5, 8), (0.1, 0.1, 0.12), (False, True, False))
ROCK = {"porosity": 0.45, "a": 300.0}
SLOPE = Polygon(shapely.Polygon([(0.31, 0.0), (0.9, 0.0), (0.9, 0.84), (0.71, 0.84)]), 2)
SHAPES = {
    "on the lines": (PLANE, Box((0.4, 0.0), (0.9, 0.84))),
    "off the lines": (PLANE, Box((0.43, 0.0), (0.9, 0.53))),
    "slope": (PLANE, SLOPE),
    "corner in 3D": (SPACE, Box((0.44, 0.13, 0.0), (0.9, 0.41, 0.45))),
}
KERNELS = ["linear", "quadratic", "gaussian"]


class Cloud:
    """Particles everywhere but near the walls, sorted by cell, and the interfaces of a body."""

    def __init__(self, name, kernel, seed=0):
        self.grid, shape = SHAPES[name]
        grid, random = self.grid, np.random.default_rng(seed)
        self.media = Medium.build(grid, [PorousBody("rock", shape, **ROCK)]).interfaces
        assert self.media is not None
        self.shape, n, d = shape, 40 * np.prod(grid.shape), grid.dimension
        margin = np.array([0.0 if p else 3.0 for p in grid.periodic]) * grid.spacing
        margin = margin if kernel != "linear" else margin / 3.0
        margin = np.minimum(margin, 0.4 * np.array(grid.size))
        self.x = margin + random.uniform(size=(n, d)) * (np.array(grid.size) - 2 * margin)
        order, cell, start = np.zeros(n, np.int32), np.zeros(n, np.int32), np.zeros(np.prod(grid.shape) + 1, np.int32)
        _core.cell_sort(grid.core, self.x, cell, order, start)
        self.x = self.x[order]
        self.u, self.mass = random.normal(size=(n, d)), random.uniform(0.5, 1.5, n)
        self.core = (grid.core, kernel, self.x, np.full(n, 0.05), self.mass, start)

    def to_faces(self, u, order=1):
        velocity, mass, work = self.grid.faces(), self.grid.faces(), self.grid.faces()
        _core.to_faces(*self.core, u, None, velocity, mass, self.media)
        for _ in range(1, order):
            _core.add_residual(*self.core, u, mass, velocity, work, self.media)
        return velocity, mass

    def to_particles(self, velocity):
        u = np.zeros_like(self.u)
        _core.to_particles(*self.core, velocity, [], [], 0.0, u, self.media)
        return u

    def inertia_differs(self, inertia):
        """True where the faces of an axis at the corners of the box around a particle differ in inertia, (N, d)."""
        found = np.zeros(self.x.shape, bool)
        for axis, J in enumerate(inertia):
            shift = 0.5 * (np.arange(self.grid.dimension) != axis)
            low = np.floor(self.x / self.grid.spacing - shift).astype(int)
            corners = [low + step for step in itertools.product((0, 1), repeat=self.grid.dimension)]
            size = np.where(self.grid.periodic, self.grid.shape, J.shape)
            values = np.array([J[tuple(np.mod(c, size).T)] for c in corners])
            found[:, axis] = values.min(axis=0) != values.max(axis=0)
        return found


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("name", SHAPES)
def test_uniform_flow_is_kept_and_momentum_conserved(name, kernel):
    """To round-off, whatever the slope of the interface."""
    cloud = Cloud(name, kernel)
    d = cloud.grid.dimension
    uniform = np.broadcast_to(np.arange(1.0, d + 1), cloud.u.shape).copy()
    seen = cloud.to_particles([np.full_like(u, 1.0 + a) for a, u in enumerate(cloud.grid.faces())])
    assert seen == pytest.approx(uniform, rel=ROUND_OFF)
    for axis, (u, m) in enumerate(zip(*cloud.to_faces(uniform), strict=True)):
        assert u[m > 1e-9] == pytest.approx(axis + 1.0, rel=1e-9)
    for order in (1, 3):
        velocity, mass = cloud.to_faces(cloud.u, order)
        for axis, (u, m) in enumerate(zip(velocity, mass, strict=True)):
            u, m = (np.delete(f, -1, axis) if cloud.grid.periodic[axis] else f for f in (u, m))
            assert np.sum(m) == pytest.approx(cloud.mass.sum(), rel=1e-9)
            assert np.sum(m * u) == pytest.approx(cloud.mass @ cloud.u[:, axis], rel=1e-9, abs=1e-7)


@pytest.mark.parametrize("shift", [0.0, 0.03, 0.07])
def test_the_velocity_along_a_face_stays_on_its_side(shift, monkeypatch):
    """A field that is linear on one side and uniform on the other; each face has that of the side of its centre."""
    grid = PLANE
    monkeypatch.setitem(SHAPES, "shifted", (grid, Box((0.4 + shift, 0.0), (0.9, 0.84))))
    cloud = Cloud("shifted", "linear")
    line = 0.4 + shift
    z = cloud.x[:, 1]
    right = cloud.x[:, 0] > line
    u = np.stack([1.0 + cloud.x[:, 0], np.where(right, 2.0 + 3.0 * z, -7.0)], axis=1)
    velocity, mass = cloud.to_faces(u, 60)
    x, _ = np.moveaxis(grid.points(1), -1, 0)
    there = mass[1] > 0.0
    assert velocity[1][there & (x < line)] == pytest.approx(-7.0, rel=1e-9)
    inner = there & (x > line) & (np.indices(x.shape)[1] > 1) & (np.indices(x.shape)[1] < 6)
    assert velocity[1][inner] == pytest.approx((2.0 + 3.0 * grid.points(1)[..., 1])[inner], rel=2e-3)
    exact = [1.0 + grid.points(0)[..., 0], np.where(x > line, 2.0 + 3.0 * grid.points(1)[..., 1], -7.0)]
    assert cloud.to_particles(exact) == pytest.approx(u, rel=ROUND_OFF)


def test_transfers_are_transposes():
    """<A v, B u> = <v, A^T B u>: what is given to the faces are the very weights with which they are seen."""
    cloud = Cloud("slope", "linear")
    random = np.random.default_rng(3)
    v = [random.normal(size=u.shape) for u in cloud.grid.faces()]
    velocity, mass = cloud.to_faces(cloud.u)
    given = sum(np.sum(a * m * b) for a, m, b in zip(v, mass, velocity, strict=True))
    assert given == pytest.approx(np.sum(cloud.mass[:, None] * cloud.u * cloud.to_particles(v)), rel=1e-10)


@pytest.mark.parametrize("name", ["slope", "corner in 3D", "off the lines"])
def test_the_gradient_of_a_particle_has_no_more_energy_than_the_faces_it_sees(name):
    """APIC: by least squares, where they are not all corners of a box. One by one they had up to 2.25 times it."""
    cloud = Cloud(name, "linear")
    random = np.random.default_rng(5)
    v = [random.normal(size=u.shape) for u in cloud.grid.faces()]
    n, d = cloud.x.shape
    affine, u = np.zeros((n, d, d)), cloud.to_particles(v)
    _core.affine_from(*cloud.core, v, affine, cloud.media)
    cut = 0
    for p in range(0, n, 5):
        start = np.zeros(np.prod(cloud.grid.shape) + 1, np.int32)
        _core.cell_sort(cloud.grid.core, cloud.x[p : p + 1], np.zeros(1, np.int32), np.zeros(1, np.int32), start)
        one = (cloud.x[p : p + 1], np.full(1, 0.05), np.ones(1), start, u[p : p + 1], affine[p : p + 1])
        velocity, mass = cloud.grid.faces(), cloud.grid.faces()
        _core.to_faces(cloud.grid.core, "linear", *one, velocity, mass, cloud.media)
        for axis, periodic in enumerate(cloud.grid.periodic):
            fields = (mass[axis], velocity[axis], v[axis])
            m, given, seen = (np.delete(f, -1, axis) if periodic else f for f in fields)
            cut += 0 < np.count_nonzero(m) < 2**d
            assert np.sum(m * given**2) <= np.sum(m * seen**2) * (1.0 + 1e-9)
    assert cut > 20


@pytest.mark.parametrize("name", SHAPES)
def test_the_mass_matrix_gives_what_passes_over_the_particles_give(name):
    """FMPM(4) beside interfaces, where particles see the faces of their own side."""
    cloud = Cloud(name, "linear")
    velocity, mass = cloud.to_faces(cloud.u, 4)
    found, found_mass, work = (cloud.grid.faces(7.0) for _ in range(3))
    matrix = (_core.MassMatrix2 if cloud.grid.dimension == 2 else _core.MassMatrix3)(cloud.grid.core)
    _, _, x, _, weight, start = cloud.core
    matrix.transfer(x, weight, start, cloud.u, 4, found, found_mass, work, np.zeros(10), cloud.media)
    for a, (m, u) in enumerate(zip(mass, velocity, strict=True)):
        assert found_mass[a] == pytest.approx(m, rel=1e-11, abs=1e-12)
        there = m > 1e-3
        assert found[a][there] == pytest.approx(u[there], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("name", SHAPES)
def test_beside_an_interface_particles_settle_as_far_as_inertia_differs_around_them(name):
    """Whatever they see of it: none carries across what FLIP or a gradient kept. Nothing holds them here."""
    cloud, random = Cloud(name, "linear"), np.random.default_rng(1)
    medium = Medium.build(cloud.grid, [PorousBody("rock", cloud.shape, **ROCK)])
    v = [random.normal(size=u.shape) for u in cloud.grid.faces()]
    n, d = cloud.x.shape
    u, affine, seen = cloud.u.copy(), np.ones((n, d, d)), cloud.to_particles(v)
    held = [np.zeros(f.shape, np.uint8) for f in v]
    crossing = (medium.material, medium.materials, medium.listed("inertia"), medium.listed("uniform"), held)
    _core.settle(cloud.grid.core, *crossing, v, cloud.x, u, affine, cloud.media)
    inertia = medium.on_faces(0)
    unlike = cloud.inertia_differs(inertia)
    assert 20 < np.count_nonzero(unlike) < unlike.size
    np.testing.assert_array_equal(affine, np.where(unlike, 0.0, 1.0)[..., None] * np.ones((n, d, d)))
    np.testing.assert_array_equal(u[~unlike], cloud.u[~unlike])
    assert np.all(np.abs(u[unlike]) <= np.abs(seen[unlike]) * (1.0 + 1e-12))


def test_bodies_of_one_medium_and_bodies_that_do_nothing_have_no_interface():
    halves = [PorousBody(n, Box((x, 0.0), (x + 0.45, 0.84)), **ROCK) for n, x in (("left", 0.0), ("right", 0.45))]
    assert Medium.build(PLANE, halves).interfaces is None
    assert Medium.build(PLANE, [PorousBody("air", Box((0.2, 0.0), (0.5, 0.84)), 1.0)]).interfaces is None
    assert Medium.build(PLANE).interfaces is None


def test_every_number_of_threads_gives_the_same_bits():
    found = []
    for threads in (1, 2, 3):
        _core.set_threads(threads)
        found.append(Cloud("slope", "linear").to_faces(Cloud("slope", "linear").u, 4)[0])
    _core.set_threads(1)
    for other in found[1:]:
        assert all(a.tobytes() == b.tobytes() for a, b in zip(found[0], other, strict=True))
