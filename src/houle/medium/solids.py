"""The outline of the solids, edge by edge: it tells particles whether they are inside, and the way out.

A distance field that is interpolated between nodes would round the corners off, by a fifth of a cell where three edges
meet, and so much water would stand inside. Instead, each cell of the section into which solids reach has a list of
edges, and the edge nearest to any point of the cell is among them. The nearest edge tells inside from outside, and the
way out, to round-off (decision 0013). In 3D there is one section for each layer in y.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.polygon import orient

from houle import _core
from houle.grid import FloatArray, Grid, SingleFaces, fixed, widened
from houle.medium.integrals import section_moments
from houle.medium.sections import layers, repeated, section
from houle.medium.shapes import Shape, polygons

ON_OUTLINE = 1e-6  # [spacings] a face nearer to the outline lies on it


class Outline(NamedTuple):
    """The outline of the union of the solids.

    Behind a wall of the domain the solids go on as their mirror images, or repeat: so a wall is no edge of them.

    start  (layers nx nz + 1) int64: begin of the list of each cell of each section in `number`
    number int32: the lists, numbers of edges; a cell into which no solid reaches has an empty one
    edge   (E, 8) x and z of both ends [m], the solid on the left, and at both the mean outward normal of the two edges
           that meet there
    top    (layers,) largest y of each layer [m], infinite in 2D
    """

    start: NDArray[np.int64]
    number: NDArray[np.int32]
    edge: FloatArray
    top: FloatArray

    @classmethod
    def of(cls, grid: Grid, solids: Sequence[Shape]) -> Outline | None:
        """The outline of the solids; None where the tank holds none."""
        counts, numbers, edges, top, before = [], [], [np.empty((0, 8))], [], 0
        for span in layers(grid, solids):
            area = section(grid, solids, span)
            edge = _edges(repeated(grid, area, mirrored=True))
            count, number = _lists(grid, area, edge)
            used, number = np.unique(number, return_inverse=True)
            counts.append(count)
            numbers.append(number.ravel() + before)
            edges.append(edge[used])
            top.append(span[1])
            before += len(used)
        if before == 0:
            return None
        start = np.concatenate([[0], np.cumsum(np.concatenate(counts))]).astype(np.int64)
        number = np.concatenate(numbers).astype(np.int32)
        return cls(fixed(start), fixed(number), np.concatenate(edges), np.array(top, float))


class ClosedFaces(NamedTuple):
    """The closed faces of one axis from which water beside a solid interpolates its velocity.

    face   (N,) int64: flat numbers of the faces
    place  (N, 2 d + 1): unit normal out of the solid; the point in the water one spacing beyond the outline along it
           [m]; depth of the centre of the face in the solid [spacings], at most 1
    """

    face: NDArray[np.int64]
    place: FloatArray


def closed_faces(grid: Grid, outline: Outline, open_cells: FloatArray, open_faces: SingleFaces) -> list[ClosedFaces]:
    """The closed faces of every axis near the water. Where the centre lies on the outline, the normal is the axis."""
    d, spacing, found = grid.dimension, min(grid.spacing), []
    for axis in range(d):
        beside, near = _beside(grid, open_cells, axis)
        index = np.argwhere((open_faces[axis] == 0.0) & near)
        index = index[(index[:, axis] > 0) | grid.periodic[axis]]
        index = index[index[:, axis] < grid.shape[axis]]
        centre = (index + 0.5 * (np.arange(d) != axis)) * grid.spacing
        surface = centre.copy()
        _core.leave_solids(grid.core, outline, surface)
        way = surface - centre
        depth = np.linalg.norm(way, axis=1, keepdims=True)
        on_it = depth < ON_OUTLINE * spacing
        normal = np.where(on_it, np.eye(d)[axis], way / np.where(on_it, 1.0, depth))
        outside = np.clip(surface + spacing * normal, 0.0, grid.size)
        place = np.concatenate([normal, outside, np.where(on_it, 0.0, np.minimum(depth / spacing, 1.0))], axis=1)
        used = ~on_it[:, 0] | beside[tuple(index.T)]
        face = np.ravel_multi_index(tuple(index[used].T), grid.face_shape(axis))
        found.append(ClosedFaces(fixed(face.astype(np.int64)), np.ascontiguousarray(place[used])))
    return found


def _beside(grid: Grid, open_cells: FloatArray, axis: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Masks of the faces of an axis: with an open cell on one side at least; seen by a particle in some open cell."""
    beside = near = open_cells > 0.0
    for a, periodic in enumerate(grid.periodic):
        wide, own = widened(near, a, periodic), widened(beside, a, periodic)
        if a == axis:
            near, beside = (np.moveaxis(f[:-1] | f[1:], 0, a) for f in (wide, own))
        else:
            near = np.moveaxis(wide[:-2] | wide[1:-1] | wide[2:], 0, a)
    return beside, near


def _edges(area: shapely.Geometry) -> FloatArray:
    """Edges (E, 8) of a section as in `Outline.edge` [m]."""
    found = [np.empty((0, 8))]
    for part in map(orient, polygons(area)):
        for ring in (part.exterior, *part.interiors):
            corner = shapely.get_coordinates(ring)
            along = np.diff(corner, axis=0)
            outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
            outward /= np.linalg.norm(outward, axis=1, keepdims=True)
            mean = outward + np.roll(outward, 1, axis=0)  # outward normal at the start of each edge
            mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-12)
            found.append(np.concatenate([corner[:-1], corner[1:], mean, np.roll(mean, -1, axis=0)], axis=1))
    return np.concatenate(found)


def _lists(grid: Grid, area: shapely.Geometry, edge: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Length of the list of each cell (nx nz,), and the edges of all lists.

    An edge can be the nearest to a point of the cell only if it is no farther from the centre than the one nearest to
    the centre and the cell's diagonal together.
    """
    spacing, shape = (grid.spacing[0], grid.spacing[-1]), (grid.shape[0], grid.shape[-1])
    covered = section_moments(area, spacing, shape)[0, 0] > 0.0
    counts, numbers = np.zeros(shape, np.intp), [np.empty(0, np.intp)]
    along, length = edge[:, 2:4] - edge[:, :2], (1.0 + 1e-9) * np.hypot(*spacing)
    ends = np.sort(edge[:, :4].reshape(-1, 2, 2), axis=1)  # lower and upper corner of the box around each edge
    tree = shapely.STRtree(shapely.linestrings(edge[:, :4].reshape(-1, 2, 2)))
    for i in np.flatnonzero(covered.any(axis=1)):
        k = np.flatnonzero(covered[i])
        centre = np.stack([np.full(len(k), i + 0.5), k + 0.5], axis=1) * spacing
        _, nearest = tree.query_nearest(shapely.points(centre), return_distance=True, all_matches=False)
        far = nearest.max() + 2.0 * length  # no edge farther away is listed
        some = np.flatnonzero(
            ((ends[:, 0] <= centre.max(axis=0) + far) & (ends[:, 1] >= centre.min(axis=0) - far)).all(axis=1)
        )
        off = centre[:, None] - edge[some, :2]
        share = np.clip((off * along[some]).sum(axis=-1) / (along[some] ** 2).sum(axis=-1), 0.0, 1.0)
        distance = np.linalg.norm(off - share[..., None] * along[some], axis=-1)
        near = distance <= distance.min(axis=1, keepdims=True) + length
        counts[i, k] = near.sum(axis=1)
        numbers.append(some[np.nonzero(near)[1]])
    return counts.ravel(), np.concatenate(numbers)
