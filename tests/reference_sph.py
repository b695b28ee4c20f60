"""The particle sums of core/houle/water/sph.hpp in plain NumPy, over all pairs and all mirror images."""

from __future__ import annotations

import itertools

import numpy as np


def wendland(r, radius, d):
    """W and -W'/r of the quintic C2 kernel of Wendland (1995), integral 1."""
    q = np.minimum(r / radius, 1.0)
    scale = {2: 7 / np.pi, 3: 21 / (2 * np.pi)}[d] / radius**d
    return scale * (1 - q) ** 4 * (1 + 4 * q), 20 * scale * (1 - q) ** 3 / radius**2


def images(grid, walls, x, u):
    """[(positions, velocities)] of the particles and of their images one tank away, corners included."""
    per_axis = []
    for a in range(grid.dimension):
        length = grid.size[a]
        if grid.periodic[a]:
            per_axis.append([(1, 0, None), (1, length, None), (1, -length, None)])
        else:
            sides = [(-1, 0, walls[2 * a]), (-1, 2 * length, walls[2 * a + 1])]
            per_axis.append([(1, 0, None), *[s for s in sides if s[2] != "free"]])
    for choice in itertools.product(*per_axis):
        y, v = x.copy(), u.copy()
        for a, (sign, shift, wall) in enumerate(choice):
            y[:, a] = sign * x[:, a] + shift
            if wall == "slip":
                v[:, a] *= -1
            elif wall == "no-slip":
                v *= -1
        yield y, v


def density_sum(grid, walls, radius, x, bulk):
    out = np.zeros(len(x))
    for y, _ in images(grid, walls, x, x):
        distance = np.linalg.norm(y[None] - x[:, None], axis=2)
        out += wendland(distance, radius, grid.dimension)[0] @ bulk
    return out


def viscous_acceleration(grid, walls, radius, x, u, bulk, nu):
    d = grid.dimension
    out = np.zeros_like(x)
    for y, v in images(grid, walls, x, u):
        r = y[None] - x[:, None]
        distance = np.linalg.norm(r, axis=2)
        slope = wendland(distance, radius, d)[1]
        along = np.einsum("ijk,ijk->ij", v[None] - u[:, None], r)
        f = 0.5 * (nu[:, None] + nu) * bulk * along * slope / np.where(distance > 0, distance, 1) ** 2
        out += 2 * (d + 2) * np.einsum("ij,ijk->ik", f, r)
    return out


def velocity_gradient(radius, x, u, bulk):
    r = x[None] - x[:, None]
    w = bulk * wendland(np.linalg.norm(r, axis=2), radius, x.shape[1])[1]
    m = np.einsum("ij,ija,ijb->iab", w, r, r)
    g = np.einsum("ij,ija,ijb->iab", w, u[None] - u[:, None], r)
    return g @ np.linalg.inv(m)
