"""The conservative remeshing in plain NumPy, particle by particle: what core/remesh.hpp computes, to be read first."""

from __future__ import annotations

import itertools

import numpy as np

RECEIVE, KEEP, SEE, WEIGH = 0.1, 0.05, 0.5, 0.3  # in half cells, in half cells, sums of weights


def m4_prime(s):
    """Monaghan (1985), paper eq. (7), along one axis; s = distance / spacing."""
    s = np.abs(s)
    inner = 1 - 2.5 * s**2 + 1.5 * s**3
    outer = 0.5 * (2 - s) ** 2 * (1 - s)
    return np.where(s < 1, inner, np.where(s < 2, outer, 0.0))


def stencil(grid, x):
    """The 4^d nodes around a position: [(node, weight, reach)], node an index tuple, reach (d,) from x to it [m]."""
    axes = []
    for a, (n, h) in enumerate(zip(grid.shape, grid.spacing, strict=True)):
        n, h = 2 * n, h / 2
        s = x[a] / h - 0.5
        line = []
        for i in range(int(np.floor(s)) - 1, int(np.floor(s)) + 3):
            inside = i % n if grid.periodic[a] else (-1 - i if i < 0 else 2 * n - 1 - i if i >= n else i)
            line.append((inside, m4_prime(i - s), ((i if grid.periodic[a] else inside) - s) * h))
        axes.append(line)
    for parts in itertools.product(*axes):
        node, weights, reach = zip(*parts, strict=True)
        yield node, np.prod(weights), np.array(reach)


def half_cells(grid, cells, body):
    """Porosity in the middle of each half cell, linear between the centres of the cells; 0 in solids."""
    n = cells
    for axis, wraps in enumerate(grid.periodic):
        margins = [(int(a == axis),) * 2 for a in range(n.ndim)]
        wide = np.moveaxis(np.pad(n, margins, mode="wrap" if wraps else "edge"), axis, 0)
        pairs = np.stack([0.25 * wide[:-2] + 0.75 * wide[1:-1], 0.75 * wide[1:-1] + 0.25 * wide[2:]], axis=1)
        n = np.moveaxis(pairs.reshape(-1, *wide.shape[1:]), 0, axis)
    return np.where(body < 0, 0.0, n)


def conservative(grid, pores, position, velocity, volume, porosity):
    """(position, velocity, volume) after remeshing; see core/remesh.hpp for the rules."""
    d, half = grid.dimension, np.array(grid.spacing) / 2
    shape = tuple(2 * n for n in grid.shape)

    def half_cell(x):
        return tuple(np.minimum((x / half).astype(int), np.array(shape) - 1))

    stencils = [list(stencil(grid, x)) for x in position]

    fill = np.zeros(shape)
    for nodes, v, n in zip(stencils, volume, porosity, strict=True):
        for node, w, _ in nodes:
            fill[node] += w * v / n / half.prod()
    receives = (fill >= RECEIVE) & (pores > 0)

    got_volume, got_bulk = np.zeros(shape), np.zeros(shape)
    got_momentum, got_moment = np.zeros((*shape, d)), np.zeros((*shape, d))
    stayed = []
    for p, nodes in enumerate(stencils):
        own = pores[half_cell(position[p])]
        seen = [part for part in nodes if own > 0 and receives[part[0]]]
        plain = sum(w for _, w, _ in seen)
        alike = len(seen) == len(nodes) and all(pores[node] == own for node, _, _ in seen)
        if not alike:
            seen = [(node, w * pores[node], reach) for node, w, reach in seen]
        total = sum(w for _, w, _ in seen)
        near = min(seen, key=lambda part: np.sum((part[2] / half) ** 2), default=None)
        if alike or (plain > SEE and total > WEIGH * plain * own):
            shares = [(node, w / total, reach) for node, w, reach in seen]
        elif near is not None and np.sum((near[2] / half) ** 2) < 1:
            shares = [(near[0], 1.0, near[2])]
        else:
            stayed.append(p)
            continue
        centre = sum(w * reach for _, w, reach in shares)  # of what the particle gives, from the particle
        for node, w, _ in shares:
            got_volume[node] += w * volume[p]
            got_bulk[node] += w * volume[p] / porosity[p]
            got_momentum[node] += w * volume[p] * velocity[p]
            got_moment[node] -= w * volume[p] * centre

    enough = KEEP * half.prod()
    small = list(zip(*np.nonzero((got_volume != 0) & (got_bulk < enough)), strict=True))
    targets = {}
    for node in small:
        for radius in (1, 2, 3):
            best = None
            for step in itertools.product(range(-radius, radius + 1), repeat=d):
                raw = np.add(node, step)
                other = tuple(
                    int(i % n) if per else int(i) for i, n, per in zip(raw, shape, grid.periodic, strict=True)
                )
                if any(i < 0 or i >= n for i, n in zip(other, shape, strict=True)) or pores[other] <= 0:
                    continue
                if got_bulk[other] > (got_bulk[best[0]] if best else enough):
                    best = other, step
            if best:
                targets[node] = best
                break
    for node, (other, step) in targets.items():
        got_moment[other] += got_moment[node] - got_volume[node] * np.array(step) * half
        got_volume[other] += got_volume[node]
        got_momentum[other] += got_momentum[node]
        got_volume[node] = 0

    x, u, v = [], [], []
    for node in zip(*np.nonzero(got_volume), strict=True):
        centre = (np.array(node) + 0.5) * half
        offset = np.clip(got_moment[node] / got_volume[node], -half, half)
        place = np.where(grid.periodic, np.mod(centre + offset, grid.size), centre + offset)
        inside = np.all((place >= 0) & (place <= grid.size))
        if not inside or pores[half_cell(place)] <= 0:  # held back
            place = centre + np.clip(offset, -0.5 * half, 0.5 * half)
        x.append(place)
        u.append(got_momentum[node] / got_volume[node])
        v.append(got_volume[node])
    for p in stayed:
        x.append(position[p]), u.append(velocity[p]), v.append(volume[p])
    return np.array(x), np.array(u), np.array(v)
