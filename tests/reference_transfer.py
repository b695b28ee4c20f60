"""Kernels and transfers in plain NumPy: core/houle/grid/kernels.hpp and water/transfer.hpp, to be read first.

Everything is written as the formula says, particle by particle and face by face; nothing is fast. `grid` is a
houle.grid.Grid. A field of axis -1 lies at the cell centres, one of axis a on the faces across that axis.
"""

from __future__ import annotations

from math import erf, exp, floor, sqrt

import numpy as np

SIGMA = 0.6  # standard deviation of the Gaussian kernels, in cells
REACH = 3  # where they are cut, in cells

# ---- kernels: (weight, second-moment term) at a distance of r cells, for a particle with an edge of `side` cells -----


def linear(r, side):
    return max(0.0, 1.0 - abs(r)), 0.0


def quadratic(r, side):
    r = abs(r)
    return (0.75 - r * r if r < 0.5 else 0.5 * max(0.0, 1.5 - r) ** 2), 0.0


def m4prime(r, side):
    """Monaghan (1985), paper (7)."""
    r = abs(r)
    if r < 1.0:
        return 1.0 - 2.5 * r**2 + 1.5 * r**3, 0.0
    return (0.5 * (2.0 - r) ** 2 * (1.0 - r) if r < 2.0 else 0.0), 0.0


def gaussian(r, side):
    return (exp(-0.5 * (r / SIGMA) ** 2) if -REACH <= r < REACH else 0.0), 0.0


def gaussian_taylor2(r, side):
    """Paper (10), (11): W + M20/M00 W''/2, with the moment M20/M00 = side^2/12 of a square, 1.7 cells wide at most."""
    return gaussian(r, side)[0], min(side**2 / 24.0 / SIGMA**2, 1.0 / 3.0) * ((r / SIGMA) ** 2 - 1.0)


def gaussian_cell(r, side):
    """The Gaussian integrated over the particle's square."""
    if not -REACH <= r < REACH:
        return 0.0, 0.0
    return erf((r + side / 2) / SIGMA / sqrt(2)) - erf((r - side / 2) / SIGMA / sqrt(2)), 0.0


KERNELS = {
    "linear": linear,
    "quadratic": quadratic,
    "m4prime": m4prime,
    "gaussian": gaussian,
    "gaussian-taylor2": gaussian_taylor2,
    "gaussian-cell": gaussian_cell,
}


def fold(i, cells, on_faces, periodic):
    """Node i brought into the grid, and the sign with which a velocity normal to the wall is seen in its mirror."""
    if periodic:
        return i % cells, 1.0
    last, sign = (cells if on_faces else cells - 1), 1.0
    while not 0 <= i <= last:
        low = i < 0
        i = (-i if low else 2 * last - i) if on_faces else (-1 - i if low else 2 * last + 1 - i)
        sign = -sign
    return i, sign


def stencil(grid, kernel, axis, x, side=0.0):
    """The M nodes that a particle at x sees: indices (tuple of (M,)), weights (M,), signs (M,), reaches (M, d) [m].

    The reach is from the particle to the node itself, also behind a wall or beyond a periodic side.
    """
    lines = []
    for a, (n, h) in enumerate(zip(grid.shape, grid.spacing, strict=True)):
        s = x[a] / h - (0.0 if a == axis else 0.5)
        line = []
        for i in range(floor(s) - 2, floor(s) + 4):
            w, q = KERNELS[kernel](s - i, side / h)
            node, sign = fold(i, n, a == axis, grid.periodic[a])
            line.append((node, w, q, sign if a == axis else 1.0, (i - s) * h))
        lines.append(np.array([entry for entry in line if entry[1] != 0.0]))
    every = np.stack([m.ravel() for m in np.meshgrid(*[np.arange(len(line)) for line in lines], indexing="ij")])
    node, w, q, sign, reach = np.moveaxis([line[k] for line, k in zip(lines, every, strict=True)], -1, 0)
    weight = w.prod(axis=0) * (1.0 + q.sum(axis=0))
    if kernel.startswith("gaussian"):
        weight /= weight.sum()
    return tuple(node.astype(int)), weight, sign.prod(axis=0), reach.T


def matrices(grid, kernel, axis, position, side=None):
    """Weights (N, nodes) of the mass and of the velocity (signed), and the moments of each axis b (d, 2, N, nodes):
    signed weight * reach_b, and weight * reach_b^2."""
    d, n, shape = grid.dimension, len(position), grid.shape if axis < 0 else grid.face_shape(axis)
    sums = np.zeros((2 + 2 * d, n, *shape))
    for p, x in enumerate(position):
        node, w, sign, reach = stencil(grid, kernel, axis, x, 0.0 if side is None else side[p])
        rows = [w, w * sign]
        for b in range(d):
            rows += [w * sign * reach[:, b], w * reach[:, b] ** 2]
        for target, row in zip(sums, rows, strict=True):
            np.add.at(target[p], node, row)
    sums = sums.reshape(len(sums), n, -1)
    return sums[0], sums[1], sums[2:].reshape(d, 2, n, -1)


def close_periodic(grid, axis, field):
    """The last face of a periodic axis is the first."""
    if axis >= 0 and grid.periodic[axis]:
        field = np.moveaxis(field, axis, 0)
        field[-1] = field[0]


# ---- transfers -------------------------------------------------------------------------------------------------------


def scatter_cells(grid, position, amount):
    plain, _, _ = matrices(grid, "linear", -1, position)
    return (amount @ plain).reshape(grid.shape)


def gather_cells(grid, position, field):
    plain, _, _ = matrices(grid, "linear", -1, position)
    return plain @ field.ravel()


def to_faces(grid, kernel, position, side, mass, u, affine=None):
    """(velocity, face mass): (1/m_f) sum_p m_p w_fp (u_p + C_p (x_f - x_p)), m_f = sum_p m_p w_fp."""
    velocity, face_mass = grid.faces(), grid.faces()
    for a in range(grid.dimension):
        plain, signed, moments = matrices(grid, kernel, a, position, side)
        m = mass @ plain
        momentum = (mass * u[:, a]) @ signed
        if affine is not None:
            momentum += sum((mass * affine[:, a, b]) @ moments[b, 0] for b in range(grid.dimension))
        face_mass[a][...] = m.reshape(face_mass[a].shape)
        velocity[a][...] = np.where(m > 0, momentum / np.where(m > 0, m, 1.0), 0.0).reshape(velocity[a].shape)
        close_periodic(grid, a, face_mass[a])
        close_periodic(grid, a, velocity[a])
    return velocity, face_mass


def add_residual(grid, kernel, position, side, mass, u, face_mass, velocity):
    """velocity + (1/m_f) sum_p m_p w_fp (u_p - interpolated velocity)."""
    result = []
    for a, (m, v) in enumerate(zip(face_mass, velocity, strict=True)):
        _, signed, _ = matrices(grid, kernel, a, position, side)
        residual = (mass * (u[:, a] - signed @ v.ravel())) @ signed
        result.append(v + np.where(m > 0, residual.reshape(m.shape) / np.where(m > 0, m, 1.0), 0.0))
        close_periodic(grid, a, result[a])
    return result


def to_particles(grid, kernel, position, side, now, change, drag, flip, u):
    """flip (I[drag] u + I[change]) + (1 - flip) I[now]; a scalar factor has no sign behind a wall."""
    new = np.empty_like(u)
    for a in range(grid.dimension):
        plain, signed, _ = matrices(grid, kernel, a, position, side)
        new[:, a] = (1.0 - flip) * (signed @ now[a].ravel())
        if flip > 0.0:
            new[:, a] += flip * ((plain @ drag[a].ravel()) * u[:, a] + signed @ change[a].ravel())
    return new


def affine_from(grid, kernel, position, side, velocity):
    """APIC: C_ab = sum_f w u_f r_b / sum_f w r_b^2, r = x_f - x_p (Jiang et al. 2015)."""
    d = grid.dimension
    affine = np.zeros((len(position), d, d))
    for a in range(d):
        _, _, moments = matrices(grid, kernel, a, position, side)
        for b in range(d):
            first, second = moments[b, 0] @ velocity[a].ravel(), moments[b, 1].sum(axis=1)
            known = second > 1e-10 * grid.spacing[b] ** 2
            affine[known, a, b] = first[known] / second[known]
    return affine
