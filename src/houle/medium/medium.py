"""The porous medium on the grid: porosity, openness, inertia and resistance of cells and faces, from the shapes.

Everything is fixed in time and exact: shapes are polygons in the section, and the solver needs averages <.> of
properties that are constant in each body: over cells, over one-cell boxes around faces, or with the tent function as
weight (integrals.py). Where shapes overlap, a solid replaces a porous body, and a porous body replaces those before it
in the case.

The resistance per unit mass of water is a u_d + b |u_d| u_d with the Darcy velocity u_d, and its inertia C_r Du/Dt with
u = u_d / n. So a face needs <C_r / n>, <a> and <b>. The Bernoulli force needs K / n^2, to which the kinetic energy of
water at a given u_d is in proportion. K is the coefficient of the convective acceleration: C_r, or 1 where the added
mass stands before the local acceleration alone (docs/theory.md, sections 1 and 3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from houle.grid import Faces, FloatArray, Grid, SingleFaces, beside, fixed, seen, widened
from houle.medium.integrals import Measure, around_faces, covered_faces, over_cells, with_tent
from houle.medium.interfaces import Interfaces, Shared, stand_along
from houle.medium.sections import Layer, PorousBody, partition
from houle.medium.shapes import Shape, covers
from houle.medium.solids import ClosedFaces, Outline, closed_faces
from houle.medium.thin_solids import SLIT, thickened

FITTED = 1e-5  # error of the means over tents at which the fit of the particle porosity stops
LEAST = 0.5  # least particle porosity of a cell, as a share of the least porosity around it
NEAR = 8  # cells within which `contrast` looks for another medium: farther, the particle porosity is that of the body
CLOSED = 1e-3  # a cell or a face less open than this is closed: its coefficients would only spoil the pressure solve
ROUND_OFF = 1e-9  # shares that differ by less are equal, when they are compared with `SLIT`
OBLIQUE = 1e12  # `contrast` at oblique interfaces: so large that the Bernoulli force is not used there


@dataclass(frozen=True)
class Medium:
    """The medium on the grid; it does not move. Averages are over the open (not solid) part of the space.

    Most cells and faces lie in one body or in clear water, so few of them differ: a field is a number per cell or face
    and a table of the values that the number stands for.

    kind           cells  number of the cell in each of `kinds`, int32
    kinds          name -> values (K,), by number, of
        porosity          mean n; 1 in clear water. A closed cell beside open ones has their mean, so that interpolation
                          to points beside a solid sees no clear water inside it (the same holds for the next three)
        particle_porosity n at the cell centres, between which the porosity of particles is linear: fitted such that
                          the tents hold as much water with it as in the pores of the structure (decision 0010)
        open_cells        open fraction of the volume; 0 where it is less than `CLOSED` and in slits (`SLIT`)
        energy            K / n^2, taken as <K / n> / <n>
        coefficient       <K>
        contrast          largest over least K / n^2 of the open cells within `NEAR` each way, or that of C_r / n^2 if
                          it is more; 1 without an interface near; `OBLIQUE` at oblique ones
        inertia           C_r / n where all faces that a particle in the cell sees have the same; else 0
        uniform           the same, if a particle there also sees one particle porosity only; else 0
        lag               1 - <K> / <C_r>; there only if K is not C_r in some body
    open_faces     faces  open fraction of the area (without the domain walls); 0 where it is less than `CLOSED` or
                          where a cell beside the face is closed; in single precision
    material       faces  number of the face in `materials`, int32; empty without bodies, where it is 0
    materials      (K, 3) <C_r / n>, <a> [1/s] and <b> [1/m] over the one-cell box around a face (over its inner half
                          at a wall)
    body           int8   (2 nx, [2 ny,] 2 nz): k + 1 where body number k holds the centre of the half cell, 0 in clear
                          water, -1 in a solid
    outline        outline of the solids, for particles near them; None without solids
    closed_faces   per axis, the faces in solids near the water; empty without solids
    interfaces     interfaces between the media; None where there is one medium
    shared         per axis, the faces that two media share side by side; empty where there is one medium
    settles        whether water beside upright interfaces is seeded as flow leaves it (`seeding.Settled`): not where
                   gates stand
    """

    grid: Grid
    bodies: tuple[PorousBody, ...]
    solids: tuple[Shape, ...]
    kind: NDArray[np.int32]
    kinds: dict[str, FloatArray]
    open_faces: SingleFaces
    material: list[NDArray[np.int32]]
    materials: FloatArray
    body: NDArray[np.int8]
    outline: Outline | None
    closed_faces: list[ClosedFaces]
    interfaces: Interfaces | None
    shared: list[Shared]
    settles: bool

    @classmethod
    def build(
        cls, grid: Grid, bodies: Sequence[PorousBody] = (), solids: Sequence[Shape] = (), settles: bool = True
    ) -> Medium:
        """The medium of these bodies and solids, thickened where they divide cells; clear water where there are none.

        settles: see the class.
        """
        solids = thickened(grid, solids)
        parts = partition(grid, bodies, solids)
        sections = [(span, area) for span, area, _ in parts]
        solid = Measure.of(grid, sections)
        inside = [Measure.of(grid, [(span, areas[k]) for span, _, areas in parts]) for k in range(len(bodies))]
        porosities = [b.porosity for b in bodies]

        cells = _Mean(solid, inside, [over_cells] * grid.dimension)
        covered = covered_faces(grid, sections)
        open_cells = np.where((cells.open < CLOSED) | _slits(grid, cells.open, covered), 0.0, cells.open)

        def factors(coefficients: Sequence[float]) -> tuple[FloatArray, ...]:
            """Three cell fields for these K of the bodies: K/n^2, K, and the contrast of K/n^2."""
            over_n = [k / n for k, n in zip(coefficients, porosities, strict=True)]
            factor = cells.of(over_n, 1.0) / cells.of(porosities, 1.0), cells.of(coefficients, 1.0)
            energy, mean = (_extend(field, open_cells, grid.periodic) for field in factor)
            return energy, mean, _contrast(energy, open_cells > 0.0, grid.periodic, NEAR)

        energy, coefficient, contrast = factors([b.convective for b in bodies])
        lag = {}
        if any(b.convective != b.inertia for b in bodies):
            _, inertia, other = factors([b.inertia for b in bodies])
            contrast, lag = np.maximum(contrast, other), {"lag": 1.0 - coefficient / inertia}
        open_faces = _open_faces(grid, open_cells, covered)
        outline = Outline.of(grid, solids)
        body = _index_bodies(grid, parts)
        interfaces = Interfaces.of(grid, parts, bodies, body)
        if interfaces is not None:
            contrast[(contrast > 1.0) & interfaces.oblique(grid)] = OBLIQUE
        material, materials = _list_materials(grid, bodies, solid, inside)
        material, materials, shared = stand_along(grid, parts, bodies, interfaces, material, materials)
        porosity = particle_porosity = _extend(cells.of(porosities, 1.0), open_cells, grid.periodic)
        if bodies:
            tents = _Mean(solid, inside, [with_tent] * grid.dimension).of(porosities, 1.0)
            particle_porosity = _fit_tents(porosity, tents, open_cells > 0.0, grid.periodic)
        one_inertia, uniform = _uniform(grid, particle_porosity, [materials[number, 0] for number in material])
        fields = {
            "porosity": porosity, "particle_porosity": particle_porosity, "open_cells": open_cells, "energy": energy,
            "coefficient": coefficient, "contrast": contrast, "inertia": one_inertia, "uniform": uniform, **lag,
        }  # fmt: skip
        kind, kinds = _listed(list(fields.values()))
        return cls(
            grid=grid,
            bodies=tuple(bodies),
            solids=solids,
            kind=fixed(kind),
            kinds=dict(zip(fields, np.ascontiguousarray(kinds.T), strict=True)),
            open_faces=open_faces,
            material=[fixed(number) for number in material],
            materials=materials,
            body=body,
            outline=outline,
            closed_faces=closed_faces(grid, outline, open_cells, open_faces) if outline else [],
            interfaces=interfaces,
            shared=shared,
            settles=settles,
        )

    def listed(self, name: str) -> tuple[NDArray[np.int32], FloatArray]:
        """One of `kinds` as the core takes it: the number of each cell, and the table of values."""
        return self.kind, self.kinds[name]

    @property
    def porosity(self) -> FloatArray:
        """Mean porosity of the cells [-]. This property and the next four make new arrays; see the class."""
        return self.kinds["porosity"][self.kind]

    @property
    def particle_porosity(self) -> FloatArray:
        return self.kinds["particle_porosity"][self.kind]

    @property
    def open_cells(self) -> FloatArray:
        return self.kinds["open_cells"][self.kind]

    @property
    def energy(self) -> FloatArray:
        return self.kinds["energy"][self.kind]

    @property
    def contrast(self) -> FloatArray:
        return self.kinds["contrast"][self.kind]

    @property
    def at_interface(self) -> NDArray[np.bool_]:
        """Cells (grid.shape) within two cells, along each axis, of another K / n^2."""
        return self.near_contrast(1.0)

    def near_contrast(self, ratio: float) -> NDArray[np.bool_]:
        """Cells (grid.shape) within two cells of which, along each axis, K / n^2 differs by more than this ratio."""
        return _contrast(self.energy, self.open_cells > 0.0, self.grid.periodic, 2) > ratio

    def on_faces(self, column: int) -> Faces:
        """Face fields of one column of `materials`: 0 inertia C_r / n, 1 and 2 the resistances a [1/s], b [1/m]."""
        if not self.material:
            return self.grid.faces(self.materials[0, column])
        return [self.materials[number, column] for number in self.material]


class _Mean:
    """Averages over the open space of properties that are constant in each body and in clear water.

    open    open fraction of each average; shares: fraction that each body takes
    """

    def __init__(self, solid: Measure, inside: Sequence[Measure], averaging: Sequence) -> None:
        self.open = np.maximum(1.0 - solid.mean(averaging), 0.0)
        self.shares = [m.mean(averaging) for m in inside]

    def of(self, values: Sequence[float], clear: float) -> FloatArray:
        """Mean of a property with these values in the bodies and `clear` in clear water; `clear` if nothing is open."""
        extra = np.zeros_like(self.open)
        for value, share in zip(values, self.shares, strict=True):
            extra += (value - clear) * share
        return clear + np.divide(extra, self.open, out=np.zeros_like(self.open), where=self.open > 0)


def _list_materials(
    grid: Grid, bodies: Sequence[PorousBody], solid: Measure, inside: Sequence[Measure]
) -> tuple[list[NDArray[np.int32]], FloatArray]:
    """`Medium.material` and `Medium.materials` of these bodies: numbers per axis, and the table."""
    if not bodies:
        return [], np.array([[1.0, 0.0, 0.0]])
    values = [
        ([b.inertia / b.porosity for b in bodies], 1.0),
        ([b.a for b in bodies], 0.0),
        ([b.b for b in bodies], 0.0),
    ]
    numbers, table = [], np.empty((0, 3))
    for axis in range(grid.dimension):
        box = _Mean(solid, inside, [around_faces if a == axis else over_cells for a in range(grid.dimension)])
        number, rows = _listed([box.of(*value) for value in values])
        numbers.append(number + np.int32(len(table)))
        table = np.concatenate([table, rows])
    return numbers, table


def _contrast(energy: FloatArray, open_: NDArray[np.bool_], periodic: Sequence[bool], reach: int) -> FloatArray:
    """Ratio of largest to least value of a positive cell field in the open cells up to `reach` away along the axes.

    1 where no cell around is open.
    """
    most, least = np.where(open_, energy, -np.inf), np.where(open_, energy, np.inf)
    for axis in range(energy.ndim):
        for _ in range(reach):
            most, least = beside(np.maximum, most, axis, periodic), beside(np.minimum, least, axis, periodic)
    return np.divide(most, least, out=np.ones_like(energy), where=most > least)


def _uniform(grid: Grid, porosity: FloatArray, inertia: Faces) -> tuple[FloatArray, FloatArray]:
    """`Medium.kinds` "inertia" and "uniform" of the cells, from the particle porosity and the C_r / n of the faces."""
    if not inertia:
        return np.ones(grid.shape), np.ones(grid.shape)
    extremes = [seen(choose, f, a, grid.periodic) for a, f in enumerate(inertia) for choose in (np.minimum, np.maximum)]
    J = np.where(np.all([field == extremes[0] for field in extremes], axis=0), extremes[0], 0.0)
    least = most = porosity
    for axis in range(grid.dimension):
        most, least = beside(np.maximum, most, axis, grid.periodic), beside(np.minimum, least, axis, grid.periodic)
    return J, np.where(least == most, J, 0.0)


def _listed(fields: Sequence[FloatArray]) -> tuple[NDArray[np.int32], FloatArray]:
    """Several fields as one field of numbers and a table; its rows (K, fields) are the different tuples of values."""
    flat = [f.ravel() for f in fields]
    first = np.concatenate([[True], np.any([f[1:] != f[:-1] for f in flat], axis=0)])  # starts of runs of equal tuples
    start = np.flatnonzero(first)
    table, number = np.unique(np.stack([f[start] for f in flat], axis=1), axis=0, return_inverse=True)
    runs = np.diff(start, append=len(first))
    return np.repeat(number.ravel().astype(np.int32), runs).reshape(fields[0].shape), table


def _slits(grid: Grid, open_cells: FloatArray, covered: Faces) -> NDArray[np.bool_]:
    """Cells less open than `SLIT` that water can reach from others only through faces less open than that."""
    wide = [np.moveaxis(1.0 - share >= SLIT - ROUND_OFF, axis, 0).copy() for axis, share in enumerate(covered)]
    for faces, wraps in zip(wide, grid.periodic, strict=True):
        faces[[0, -1]] &= wraps  # walls of the tank are closed
    narrow, reached = open_cells < SLIT - ROUND_OFF, True
    while reached:
        found = np.zeros_like(narrow)
        for axis, (faces, wraps) in enumerate(zip(wide, grid.periodic, strict=True)):
            water = ~widened(narrow, axis, wraps)
            found |= np.moveaxis((faces[:-1] & water[:-2]) | (faces[1:] & water[2:]), 0, axis)
        found &= narrow
        narrow, reached = narrow & ~found, bool(found.any())
    return narrow


def _open_faces(grid: Grid, open_cells: FloatArray, covered: Faces) -> SingleFaces:
    """Open fraction of the faces: 1 - covered fraction; 0 where that is below `CLOSED`, or beside a closed cell."""
    faces = [1.0 - share for share in covered]
    for axis, face in enumerate(faces):
        wide = widened(open_cells, axis, grid.periodic[axis])
        least = np.moveaxis(np.minimum(wide[:-1], wide[1:]), 0, axis)
        face[(face < CLOSED) | (least == 0)] = 0.0
        if grid.periodic[axis]:  # the first and the last face are the same
            first = np.minimum(face.take([0], axis), face.take([-1], axis))
            np.moveaxis(face, axis, 0)[[0, -1]] = np.moveaxis(first, axis, 0)
    return [face.astype(np.float32) for face in faces]


def _extend(values: FloatArray, open_cells: FloatArray, periodic: Sequence[bool]) -> FloatArray:
    """The cell values; closed cells get the mean of the open ones among the 3^d around them, weighted by openness."""
    if open_cells.all():
        return values
    total, weight = values * open_cells, open_cells.copy()
    for axis in range(values.ndim):
        for field in (total, weight):
            neighbours = np.moveaxis(field, axis, 0)
            before = neighbours.copy()
            neighbours[1:] += before[:-1]
            neighbours[:-1] += before[1:]
            if periodic[axis]:
                neighbours[0] += before[-1]
                neighbours[-1] += before[0]
    return np.where((open_cells == 0) & (weight > 0), total / np.where(weight > 0, weight, 1.0), values)


def _fit_tents(
    porosity: FloatArray, tent: FloatArray, open_: NDArray[np.bool_], periodic: Sequence[bool]
) -> FloatArray:
    """Cell values (n) whose linear interpolant has the means `tent` over the tents of the open cells.

    The mean over a tent weighs the values around by 1/6, 4/6, 1/6 along each axis. The system is solved by iteration
    from the cell means, up to an error of `FITTED`; values that hardly differ from the cell means stay those. No value
    is below `LEAST` times the least porosity around.
    """
    n, least = porosity, porosity
    for axis, wraps in enumerate(periodic):
        wide = widened(least, axis, wraps)
        least = np.moveaxis(np.minimum(np.minimum(wide[:-2], wide[1:-1]), wide[2:]), 0, axis)
    if np.array_equal(least, porosity):
        return porosity
    for _ in range(100):
        mean = n
        for axis, wraps in enumerate(periodic):
            wide = widened(mean, axis, wraps)
            mean = np.moveaxis((wide[:-2] + 4.0 * wide[1:-1] + wide[2:]) / 6.0, 0, axis)
        change = np.where(open_, tent - mean, 0.0)
        n = n + change
        if np.abs(change).max() < FITTED:
            break
    n = np.where(np.abs(n - porosity) < 10.0 * FITTED, porosity, n)
    return np.ascontiguousarray(np.maximum(n, LEAST * least))


def _index_bodies(grid: Grid, parts: Sequence[Layer]) -> NDArray[np.int8]:
    """`Medium.body`: the number of the body at the centre of each half cell."""
    lines = [(np.arange(2 * n) + 0.5) * h / 2 for n, h in zip(grid.shape, grid.spacing, strict=True)]
    x, z = np.meshgrid(lines[0], lines[-1], indexing="ij")
    index = np.zeros([len(line) for line in lines], np.int8)
    for span, solid, areas in parts:
        plane = np.zeros(x.shape, np.int8)
        for value, area in [*enumerate(areas, 1), (-1, solid)]:
            if not area.is_empty:
                plane[covers(area, x, z)] = value
        if grid.dimension == 2:
            return plane
        index[:, (lines[1] >= span[0]) & (lines[1] <= span[1])] = plane[:, None]
    return index
