"""Interfaces between porous media, for the transfers: the velocity along an interface is not continuous across it.

So a particle near an interface sees the faces on its own side only, (11a) in docs/theory.md. Media are told apart by
their effect on the water: porosity, inertia and resistance. Bodies that have the same are one medium, and a body
without any effect is clear water. A cell near an interface knows it as a plane: the edge of the section nearest to its
centre, in 3D also the end of a layer in y. Gates count as interfaces, too (docs/decisions/0017 and 0020).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from houle.grid import FloatArray, Grid, beside, fixed, seen, spread
from houle.medium.sections import Layer, PorousBody, repeated
from houle.medium.shapes import Span, covers, polygons

REACH = 2  # cells around a cell: an interface in none of them does not concern the particles in it
ALONG = 0.99  # square of the normal's part along an axis: with less, the interface does not lie across that axis
PARALLEL = 1e-9  # 1 less the normal's part along an axis: with less, the interface is parallel to the axis's faces
LEAST_SHARE = 1e-6  # share of the box around a face: another medium that takes less does not share the face
ON_LINE = 1e-6  # [spacings] a point nearer to an interface lies on it
ASIDE = 1e-3  # [spacings] distance from an interface at which the media of its two sides are looked up
SOLID = -1  # number of a medium: a solid
GATE = (-3.0, -2.0)  # numbers of media: the two sides of a gate, at smaller and at larger x


class Interfaces(NamedTuple):
    """The interfaces as the core takes them.

    number  cells, int32: row in `planes` of the interface nearest to the centre of the cell; -1 without an interface
            within `REACH`
    close   cells, int32: the same for the linear kernel, -1 also where all faces that a particle in the cell can see
            are in one medium
    planes  (K, d + 3): unit normal; its product with a point on the plane [m]; number of the medium on the side where
            that product is smaller, and on the side where it is larger
    medium  faces, int8: number of the medium at the centre of the face, 0 for clear water, -1 in a solid; on an
            interface that of the medium that resists less
    """

    number: NDArray[np.int32]
    close: NDArray[np.int32]
    planes: FloatArray
    medium: list[NDArray[np.int8]]

    @classmethod
    def of(
        cls, grid: Grid, parts: Sequence[Layer], bodies: Sequence[PorousBody], body: NDArray[np.int8]
    ) -> Interfaces | None:
        """The interfaces between these bodies; None where the tank holds one medium. body: `Medium.body`."""
        media, _ = number_media(bodies)
        sections = [_LayerMedia.of(grid, part, media) for part in parts]
        near = _near(grid, np.array([0, *media, SOLID], np.int8)[body]) if media.any() else np.zeros(grid.shape, bool)
        cell = np.argwhere(near)
        planes = _planes(grid, sections, (cell + 0.5) * np.array(grid.spacing))
        kept = (planes[:, -1] != planes[:, -2]) & (planes[:, -2:] != SOLID).all(axis=1)
        if not kept.any():
            return None
        number = np.full(grid.shape, -1, np.int32)
        number[tuple(cell[kept].T)] = np.arange(np.count_nonzero(kept))
        planes = planes[kept]
        on_it = ON_LINE * min(grid.spacing)  # points on an interface are in the medium that resists less
        planes[:, -3] += np.where(planes[:, -2] < planes[:, -1], on_it, -on_it)
        medium = [_on_faces(grid, sections, axis) for axis in range(grid.dimension)]
        close = np.where(_several_seen(grid, medium), number, np.int32(-1))
        return cls(number, close, np.ascontiguousarray(planes), medium)

    @classmethod
    def with_gates(cls, grid: Grid, gates: FloatArray, media: Interfaces | None) -> Interfaces | None:
        """The interfaces together with shut gates, on each side of which the water has its own velocity.

        In the cells beside a gate, above its lower edge, it replaces other interfaces. gates (K, 2): x of the face and
        height of the lower edge [m]; media: the interfaces without gates, None without any.
        """
        d, h = grid.dimension, grid.spacing
        if media is None:
            medium = [fixed(np.zeros(grid.face_shape(a), np.int8)) for a in range(d)]
            nowhere = np.full(grid.shape, -1, np.int32)
            media = cls(nowhere, nowhere, np.empty((0, d + 3)), medium)
        number, close, planes = media.number.copy(), media.close.copy(), np.zeros((len(gates), d + 3))
        planes[:, 0], planes[:, d], planes[:, -2:] = 1.0, gates[:, 0], GATE
        for k, (x, bottom) in enumerate(gates):
            face, row = round(x / h[0]), round(bottom / h[-1])
            for table in (number, close):
                table[face - 1 : face + 1, ..., row:] = len(media.planes) + k
        return cls(fixed(number), fixed(close), np.concatenate([media.planes, planes]), media.medium)

    def oblique(self, grid: Grid) -> NDArray[np.bool_]:
        """Cells whose nearest interface is oblique, that is across no axis (`ALONG`), and all cells around those."""
        near = (self.number >= 0) & np.all(self.planes[:, : grid.dimension] ** 2 < ALONG, axis=1)[self.number]
        return spread(near, grid.periodic)


Kind = tuple[float, float, float, float, float]  # a, b, n, C_r and K of a medium


def number_media(bodies: Sequence[PorousBody]) -> tuple[NDArray[np.int8], list[Kind]]:
    """The number of the medium of each body, and the properties of the media by number.

    Number 0 is clear water; the others are in the order of their resistance, the least first.
    """
    clear, kinds = (0.0, 0.0, 1.0, 1.0, 1.0), [(b.a, b.b, b.porosity, b.inertia, b.convective) for b in bodies]
    media = sorted({clear, *kinds}, key=lambda m: (m != clear, m[0], m[1], -m[2], *m[3:]))
    return np.array([media.index(kind) for kind in kinds], np.int8), media


class _LayerMedia(NamedTuple):
    """The media in the section of one layer in y, continued beyond the sides of the tank.

    span    the y of the layer [m]
    areas   (number of the medium, its area), those that resist less first, the solids last; wider by `ON_LINE` than
            they are
    inside  all areas together, and narrower by `ON_LINE` than they are
    edge    (E, 2, 2) ends of the edges between media [m]
    """

    span: Span
    areas: list[tuple[int, shapely.Geometry]]
    inside: shapely.Geometry
    edge: FloatArray

    @classmethod
    def of(cls, grid: Grid, part: Layer, media: NDArray[np.int8]) -> _LayerMedia:
        span, solid, bodies = part
        areas = []
        for medium in np.unique(media[media > 0]):
            same = [area for area, m in zip(bodies, media, strict=True) if m == medium]
            areas.append((int(medium), shapely.union_all(same)))
        areas.append((SOLID, solid))
        areas = [(medium, _beyond(grid, area)) for medium, area in areas if not area.is_empty]
        edges = [_edges(grid, area, _beyond(grid, solid)) for medium, area in areas if medium != SOLID]
        on_line = ON_LINE * min(grid.spacing)
        inside = shapely.buffer(shapely.union_all([area for _, area in areas]), -on_line, join_style="mitre")
        wide = [(medium, shapely.buffer(area, on_line, join_style="mitre")) for medium, area in areas]
        return cls(span, wide, inside, np.concatenate([np.empty((0, 2, 2)), *edges]))

    def medium_at(self, x: FloatArray, z: FloatArray) -> NDArray[np.int8]:
        """The medium at points of the section; on an interface the one that resists less."""
        found = np.zeros(np.shape(x), np.int8)
        if self.areas:
            inside = covers(self.inside, x, z)
            for medium, area in reversed(self.areas):
                found[inside & covers(area, x, z)] = medium
        return found

    def nearest(self, x: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Distance (N,) from points to the nearest edge [m], and (N, 2, 2) its unit normal and its nearest point [m].

        At a corner of an edge the normal is the direction from there to the point. Of edges that are equally near the
        most upright one is taken.
        """
        if len(self.edge) == 0:
            return np.full(len(x), np.inf), np.zeros((len(x), 2, 2))
        tree = shapely.STRtree(shapely.linestrings(self.edge))
        points = shapely.points(x, z)
        _, near = tree.query_nearest(points, all_matches=False, return_distance=True)
        reach = near + ON_LINE * near.max(initial=0.0)
        found, which = tree.query(points, predicate="dwithin", distance=reach)
        steep = np.abs(self.edge[which, 1, 1] - self.edge[which, 0, 1])
        steep /= np.linalg.norm(self.edge[which, 1] - self.edge[which, 0], axis=1)
        order = np.lexsort((-np.round(steep, 6), found))
        found, first = np.unique(found[order], return_index=True)
        edge = np.empty((len(x), 2, 2))
        edge[found] = self.edge[which[order][first]]
        along, start = edge[:, 1] - edge[:, 0], edge[:, 0]
        at = np.stack([x, z], axis=1)
        share = np.clip(np.sum((at - start) * along, axis=1) / np.sum(along**2, axis=1), 0.0, 1.0)
        foot = start + share[:, None] * along
        way = at - foot
        distance = np.linalg.norm(way, axis=1)
        across = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
        corner = (share == 0.0) | (share == 1.0)
        round_it = corner & (distance > 1e-6 * np.abs(np.sum(way * across, axis=1)) + 1e-12)
        normal = np.where(round_it[:, None], way / np.maximum(distance, 1e-300)[:, None], across)
        return distance, np.stack([normal, foot], axis=1)


def _beyond(grid: Grid, area: shapely.Geometry) -> shapely.Geometry:
    """The polygons of the area, continued beyond the sides of the tank: mirrored, or repeated along periodic axes."""
    return shapely.multipolygons(polygons(repeated(grid, area, mirrored=True)))


def _edges(grid: Grid, area: shapely.Geometry, solid: shapely.Geometry) -> FloatArray:
    """Edges of the area (E, 2, 2) [m] that lie within `REACH` of the tank and not on the outline of the solids."""
    reach = REACH * max(grid.spacing)
    window = shapely.box(-reach, -reach, grid.size[0] + reach, grid.size[-1] + reach)
    outline = shapely.intersection(shapely.boundary(area), window)
    outline = shapely.difference(outline, shapely.buffer(solid, ON_LINE * min(grid.spacing)))
    lines = shapely.get_parts(shapely.line_merge(outline))
    found = [np.empty((0, 2, 2))]
    for line in lines:
        points = shapely.get_coordinates(line)
        found.append(np.stack([points[:-1], points[1:]], axis=1))
    return np.concatenate(found)


def _near(grid: Grid, medium: NDArray[np.int8]) -> NDArray[np.bool_]:
    """True for cells that have different media within `REACH` cells. medium: number in each half cell."""
    low = high = medium
    for axis in range(grid.dimension):
        low = np.minimum(np.delete(low, np.s_[1::2], axis), np.delete(low, np.s_[0::2], axis))
        high = np.maximum(np.delete(high, np.s_[1::2], axis), np.delete(high, np.s_[0::2], axis))
    for axis, _ in itertools.product(range(grid.dimension), range(REACH)):
        low, high = beside(np.minimum, low, axis, grid.periodic), beside(np.maximum, high, axis, grid.periodic)
    return low != high


def _several_seen(grid: Grid, medium: list[NDArray[np.int8]]) -> NDArray[np.bool_]:
    """True for cells in which the linear kernel of a particle can reach faces of one axis in several media."""
    found = np.zeros(grid.shape, bool)
    for axis, number in enumerate(medium):
        least = seen(np.minimum, np.where(number == SOLID, np.int8(127), number), axis, grid.periodic)
        found |= least < seen(np.maximum, number, axis, grid.periodic)
    return found


def _planes(grid: Grid, sections: Sequence[_LayerMedia], centre: FloatArray) -> FloatArray:
    """The interfaces nearest to points (N, d) [m], as `Interfaces.planes`; where there is none the media are equal."""
    d, aside = grid.dimension, ASIDE * min(grid.spacing)
    planes = np.zeros((len(centre), d + 3))
    nearest = np.full(len(centre), np.inf)
    x, z = centre[:, 0], centre[:, -1]
    for section in sections:
        last = section is sections[-1]
        here = np.flatnonzero((centre[:, 1] >= section.span[0]) & ((centre[:, 1] < section.span[1]) | last) | (d == 2))
        nearest[here], at = section.nearest(x[here], z[here])
        normal, foot = at[:, 0], at[:, 1]
        planes[here, 0], planes[here, d - 1] = normal.T
        planes[here, d] = np.sum(normal * foot, axis=1)
        for column, sign in ((d + 1, -1.0), (d + 2, 1.0)):
            planes[here, column] = section.medium_at(*(foot + sign * aside * normal).T)
    ends = [(low.span[1], low, high) for low, high in itertools.pairwise(sections)]
    if d == 3 and grid.periodic[1]:
        ends += [(end, sections[-1], sections[0]) for end in (0.0, grid.size[1])]
    for end, low, high in ends:
        below, above = low.medium_at(x, z), high.medium_at(x, z)
        across = (below != above) & (below != SOLID) & (above != SOLID) & (np.abs(centre[:, 1] - end) < nearest)
        nearest[across] = np.abs(centre[across, 1] - end)
        planes[across] = [0.0, 1.0, 0.0, end, 0.0, 0.0]
        planes[across, -2], planes[across, -1] = below[across], above[across]
    return planes


def _on_faces(grid: Grid, sections: Sequence[_LayerMedia], axis: int) -> NDArray[np.int8]:
    """`Interfaces.medium` of one axis: number of the medium at the centre of each face."""
    centre = grid.points(axis).reshape(-1, grid.dimension)
    return _medium_at(grid, sections, centre).reshape(grid.face_shape(axis))


class Shared(NamedTuple):
    """Faces of one axis that two media share side by side, along an interface parallel to the grid.

    face    (K,) int64: flat numbers of these faces
    beside  (K,) int64: flat number of the neighbour of each whose centre is in the other medium
    share   (K,) share of the box around the face that the other medium takes [-], at most one half
    """

    face: NDArray[np.int64]
    beside: NDArray[np.int64]
    share: FloatArray

    def mean(self, field: FloatArray) -> FloatArray:
        """Means (K,) over both media on these faces of a field on all faces of the axis.

        The value of the other medium is that of the face beside.
        """
        every = field.ravel()
        own = every[self.face]
        return own + self.share * (every[self.beside] - own)


def stand_along(
    grid: Grid, parts: Sequence[Layer], bodies: Sequence[PorousBody], interfaces: Interfaces | None,
    material: list[NDArray[np.int32]], materials: FloatArray,
) -> tuple[list[NDArray[np.int32]], FloatArray, list[Shared]]:  # fmt: skip
    """Treats the faces along which an interface runs: returns `Medium.material`, `Medium.materials`, `Medium.shared`.

    material and materials hold, on entry, the means over the boxes around the faces. Where the interface is across the
    component of velocity on the face, the media follow one behind the other, and this mean resists. Where it is along
    it, they lie side by side, each with a velocity of its own: the face then has the properties of the medium at its
    centre, and may be shared.
    """
    if not bodies or interfaces is None:
        return material, materials, []
    media, kinds = number_media(bodies)
    pure = np.array([[inertia / n, a, b] for a, b, n, inertia, _ in kinds])
    sections = [_LayerMedia.of(grid, part, media) for part in parts]
    numbers, shared = [], []
    for axis, number in enumerate(material):
        several = ~np.any(np.all(materials[:, None] == pure, axis=2), axis=1)[number]  # media in the box of the face
        if grid.periodic[axis]:  # the last faces are the first
            np.moveaxis(several, axis, 0)[-1] = False
        mixed = np.flatnonzero(several)
        index = np.stack(np.unravel_index(mixed, number.shape), axis=1)
        centre = grid.points(axis).reshape(-1, grid.dimension)[mixed]
        planes = _planes(grid, sections, centre)
        medium = interfaces.medium[axis].ravel()[mixed]
        along = (planes[:, axis] ** 2 < ALONG) & (medium >= 0) & (planes[:, -1] != planes[:, -2])
        mean = materials[number.ravel()[mixed]]
        shared.append(_shared(grid, axis, index, centre, planes, medium, interfaces.medium[axis], pure, mean))
        flat = number.ravel().copy()
        flat[mixed[along]] = len(materials) + medium[along].astype(np.int32)
        numbers.append(flat.reshape(number.shape))
        if grid.periodic[axis]:
            ends = np.moveaxis(numbers[-1], axis, 0)
            ends[-1] = ends[0]
            shared[-1] = _repeated_at_end(grid, axis, shared[-1])
    return numbers, np.concatenate([materials, pure]), shared


def _repeated_at_end(grid: Grid, axis: int, shared: Shared) -> Shared:
    """The shared faces together with those at the far end of a periodic axis, which are the first ones again."""
    shape = grid.face_shape(axis)
    first = np.unravel_index(shared.face, shape)[axis] == 0
    way = grid.shape[axis] * int(np.prod(shape[axis + 1 :]))
    return Shared(
        np.concatenate([shared.face, shared.face[first] + way]),
        np.concatenate([shared.beside, shared.beside[first] + way]),
        np.concatenate([shared.share, shared.share[first]]),
    )


def _shared(
    grid: Grid, axis: int, index: NDArray[np.int64], centre: FloatArray, planes: FloatArray, medium: NDArray[np.int8],
    media: NDArray[np.int8], pure: FloatArray, mean: FloatArray,
) -> Shared:  # fmt: skip
    """The shared faces among M faces of one axis, without those at corners of bodies or beside a third medium.

    index   (M, d) numbers of the faces along the axes; centre: (M, d) their centres [m]
    planes  (M, d + 3) the interface nearest to each, as in `Interfaces.planes`
    medium  (M,) number of the medium at their centres; media: the same of all faces of the axis
    pure    (media, 3) C_r / n, a and b of each medium; mean: (M, 3) their means over the boxes around the faces
    """
    d = grid.dimension
    found = []
    for b in range(d):
        if b == axis:
            continue
        distance = planes[:, d] - planes[:, b] * centre[:, b]  # along the normal, to the interface
        share = 0.5 - np.abs(distance) / grid.spacing[b]
        above = distance <= 0.0  # True if the centre lies where normal . x is larger
        other = np.where(above, planes[:, -2], planes[:, -1]).astype(int)
        step = np.where(above, -1, 1) * np.sign(planes[:, b]).astype(int)
        neighbour = index.copy()
        neighbour[:, b] += step
        if grid.periodic[b]:
            neighbour[:, b] %= grid.shape[b]
        inside = (neighbour[:, b] >= 0) & (neighbour[:, b] < grid.shape[b])
        neighbour[~inside] = index[~inside]
        own = np.maximum(medium, 0).astype(int)
        other = np.maximum(other, 0)
        expected = (1.0 - share)[:, None] * pure[own] + share[:, None] * pure[other]
        kept = inside & (medium >= 0) & (np.abs(planes[:, b]) > 1.0 - PARALLEL) & (share > LEAST_SHARE)
        kept &= ((index[:, axis] > 0) & (index[:, axis] < grid.shape[axis])) | grid.periodic[axis]
        kept &= (other != own) & (media[tuple(neighbour.T)] == other)
        kept &= np.isclose(expected, mean, rtol=1e-6, atol=0.0).all(axis=1)
        flat = [np.ravel_multi_index(tuple(i[kept].T), media.shape) for i in (index, neighbour)]
        found.append((*flat, share[kept]))
    return Shared(*(np.concatenate(columns) for columns in zip(*found, strict=True)))


def _medium_at(grid: Grid, sections: Sequence[_LayerMedia], point: FloatArray) -> NDArray[np.int8]:
    """Number of the medium at points (N, d) [m] in the tank; between layers in y that of the one that resists less."""
    found = np.full(len(point), SOLID, np.int8).view(np.uint8)  # -1, a solid, is the largest uint8
    for section in sections:
        here = (point[:, 1] >= section.span[0]) & (point[:, 1] <= section.span[1]) | (grid.dimension == 2)
        if grid.dimension == 3 and grid.periodic[1] and (section is sections[0] or section is sections[-1]):
            here |= (point[:, 1] == 0.0) | (point[:, 1] == grid.size[1])  # the seam of the last layer and the first
        found[here] = np.minimum(found[here], section.medium_at(point[here, 0], point[here, -1]).view(np.uint8))
    return found.view(np.int8)
