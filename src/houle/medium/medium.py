"""The porous medium on the grid: porosity, openness, inertia and resistance of cells and faces, from the shapes.

Everything is fixed in time and exact: shapes are polygons in the section, and what the solver needs are averages of a
piecewise constant property over cells, over one-cell boxes around faces, or with the tent function (integrals.py).
Where shapes overlap, a solid replaces a porous body, and a porous body replaces those before it in the case.
Resistance per unit mass of water is a u_d + b |u_d| u_d with the Darcy velocity u_d; the acceleration is C_r Du/Dt with
u = u_d / n, so a face needs <C_r / n>, <a> and <b>, and the Bernoulli force C_r / n^2, the kinetic energy of water at
a given Darcy velocity. K is C_r of what the convective acceleration sees: C_r, or 1 where the added mass stands before
the local one alone.
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

FITTED = 1e-5  # of the porosity at particles: what its tents may be off
LEAST = 0.5  # of the least porosity around a cell: what `particle_porosity` is at least
NEAR = 8  # cells from an interface: beyond, the porosity of particles is that of the body
CLOSED = 1e-3  # a cell or a face less open than this is closed: its coefficients would only spoil the pressure solve
ROUND_OFF = 1e-9  # of shares that are compared with `SLIT`: what differs by less is equal to it
OBLIQUE = 1e12  # `contrast` at oblique interfaces: more than the Bernoulli force is used at


@dataclass(frozen=True)
class Medium:
    """The medium on the grid, at rest. Averages are over the open (not solid) part of the space.

    kind           cells  number of a column of each of `kinds` (int32): most cells lie in one body, or in clear water
    kinds          name -> values (K,) of
        porosity          mean n; 1 in clear water. A closed cell beside open ones has their mean, so that interpolation
                          to points beside a solid sees no clear water inside it (the same holds for the next three)
        particle_porosity n at the cell centres, between which that of the particles is linear: such that water
                          which fills it fills the tents as it does the pores of the structure (decision 0010)
        open_cells        open fraction of the volume, 0 where less than `CLOSED` and in slits (`SLIT`)
        energy            K / n^2 as <K / n> / <n>: that of water that fills the pores of the cell with one u_d
        coefficient       <K>
        contrast          largest over least K / n^2 of the open cells `NEAR` each way, that of C_r / n^2 if it is more;
                          1: no interface near; at oblique ones `OBLIQUE`: no force on faces takes water across
        inertia           C_r / n where all faces that a particle there sees have the same, else 0
        uniform           the same where it sees one porosity of particles, too, else 0
        lag               1 - <K> / <C_r>; only where K is not C_r in some body
    open_faces     faces  open fraction of the area (without the domain walls), 0 where less than `CLOSED` or where a
                          cell beside it is closed; in single precision
    material       faces  number of a row of `materials` (int32): most faces stand in one body, or in clear water;
                          empty without bodies: 0
    materials      (K, 3) <C_r / n>, <a> [1/s] and <b> [1/m] over the one-cell box around a face (its inner half at a
                          wall)
    body           int8   (2 nx, [2 ny,] 2 nz): k + 1 where body number k holds the centre of the half cell, 0 in clear
                          water, -1 in a solid
    outline        of the solids, for particles near them; None without solids
    closed_faces   of each axis, those in solids near the water; none without solids
    interfaces     between the media; None where there is one
    shared         of each axis, the faces that two media share side by side; empty where there is one medium
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

        def of(coefficients: Sequence[float]) -> tuple[FloatArray, ...]:
            """K/n^2 of the cells for these K of the bodies, K itself, and the contrast."""
            over_n = [k / n for k, n in zip(coefficients, porosities, strict=True)]
            factor = cells.of(over_n, 1.0) / cells.of(porosities, 1.0), cells.of(coefficients, 1.0)
            energy, mean = (_extend(field, open_cells, grid.periodic) for field in factor)
            return energy, mean, _contrast(energy, open_cells > 0.0, grid.periodic, NEAR)

        energy, coefficient, contrast = of([b.convective for b in bodies])
        lag = {}
        if any(b.convective != b.inertia for b in bodies):
            _, inertia, other = of([b.inertia for b in bodies])
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
        """One of `kinds` as the core takes it: the number of each cell, and the values by number."""
        return self.kind, self.kinds[name]

    @property
    def porosity(self) -> FloatArray:
        """Mean porosity of the cells [-]; a new array, like the fields below."""
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
        """Cells (grid.shape) that have another K / n^2 up to two cells away along each axis."""
        return _contrast(self.energy, self.open_cells > 0.0, self.grid.periodic, 2) > 1.0

    def on_faces(self, column: int) -> Faces:
        """Face fields of one column of `materials`: 0 inertia C_r / n, 1 and 2 the resistances a [1/s], b [1/m]."""
        if not self.material:
            return self.grid.faces(self.materials[0, column])
        return [self.materials[number, column] for number in self.material]


class _Mean:
    """Averages over the open space of properties that are constant in each body and in clear water."""

    def __init__(self, solid: Measure, inside: Sequence[Measure], averaging: Sequence) -> None:
        self.open = np.maximum(1.0 - solid.mean(averaging), 0.0)
        self.shares = [m.mean(averaging) for m in inside]

    def of(self, values: Sequence[float], clear: float) -> FloatArray:
        """Mean of the property with these values in the bodies; its clear-water value where nothing is open."""
        extra = np.zeros_like(self.open)
        for value, share in zip(values, self.shares, strict=True):
            extra += (value - clear) * share
        return clear + np.divide(extra, self.open, out=np.zeros_like(self.open), where=self.open > 0)


def _list_materials(
    grid: Grid, bodies: Sequence[PorousBody], solid: Measure, inside: Sequence[Measure]
) -> tuple[list[NDArray[np.int32]], FloatArray]:
    """Tables `Medium.material` and `Medium.materials` of these bodies."""
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
    """Largest over least of a positive cell field, over the open cells up to `reach` away each way; 1 if none."""
    most, least = np.where(open_, energy, -np.inf), np.where(open_, energy, np.inf)
    for axis in range(energy.ndim):
        for _ in range(reach):
            most, least = beside(np.maximum, most, axis, periodic), beside(np.minimum, least, axis, periodic)
    return np.divide(most, least, out=np.ones_like(energy), where=most > least)


def _uniform(grid: Grid, porosity: FloatArray, inertia: Faces) -> tuple[FloatArray, FloatArray]:
    """C_r / n of all faces that a particle in the cell sees, 0 where they differ; and the same, 0 also where it sees
    several porosities.
    """
    if not inertia:
        return np.ones(grid.shape), np.ones(grid.shape)
    extremes = [seen(choose, f, a, grid.periodic) for a, f in enumerate(inertia) for choose in (np.minimum, np.maximum)]
    J = np.where(np.all([field == extremes[0] for field in extremes], axis=0), extremes[0], 0.0)
    least = most = porosity
    for axis in range(grid.dimension):
        most, least = beside(np.maximum, most, axis, grid.periodic), beside(np.minimum, least, axis, grid.periodic)
    return J, np.where(least == most, J, 0.0)


def _listed(fields: Sequence[FloatArray]) -> tuple[NDArray[np.int32], FloatArray]:
    """The different tuples of values of some fields, as rows of a table, and the number of its row for each entry."""
    flat = [f.ravel() for f in fields]
    first = np.concatenate([[True], np.any([f[1:] != f[:-1] for f in flat], axis=0)])  # of a run of equal ones
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
    """1 - covered fraction; 0 where that is tiny, or beside a closed cell."""
    faces = [1.0 - share for share in covered]
    for axis, face in enumerate(faces):
        wide = widened(open_cells, axis, grid.periodic[axis])
        beside = np.moveaxis(np.minimum(wide[:-1], wide[1:]), 0, axis)
        face[(face < CLOSED) | (beside == 0)] = 0.0
        if grid.periodic[axis]:  # the first and the last face are the same
            first = np.minimum(face.take([0], axis), face.take([-1], axis))
            np.moveaxis(face, axis, 0)[[0, -1]] = np.moveaxis(first, axis, 0)
    return [face.astype(np.float32) for face in faces]


def _extend(values: FloatArray, open_cells: FloatArray, periodic: Sequence[bool]) -> FloatArray:
    """The values; closed cells get the mean of the open cells around them (3^d, weighted by openness), if any."""
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
    """Cell values whose linear interpolant has these means over the tents of the open cells: a least-squares fit.

    Its mean over a tent is 1/6, 4/6, 1/6 of the values around along each axis; solved by iteration from the cell
    means, to `FITTED`; what differs less from them is left alone. Never below `LEAST` times the least porosity around.
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
    """The body at the centre of each half cell, as in `Medium.body`."""
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
