"""The conservative remeshing in plain NumPy, particle by particle: what water/remesh.hpp computes, to be read first."""

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


def between_gates(gates, x, half, top, i):
    """Node i along x, or its mirror image where a gate that reaches down to row `top` stands between it and x [m]."""
    for at, bottom in gates:
        node = round(at / half[0])
        if top >= round(bottom / half[-1]) and (x < at) != (i < node):
            return 2 * node - 1 - i
    return i


def stencil(grid, x, gates=()):
    """The 4^d nodes around a position: [(node, weight, reach)], node an index tuple, reach (d,) from x to it [m]."""
    axes, half = [], np.array(grid.spacing) / 2
    top = int(np.floor(x[-1] / half[-1] - 0.5)) + 2
    for a, (n, h) in enumerate(zip(grid.shape, grid.spacing, strict=True)):
        n, h = 2 * n, h / 2
        s = x[a] / h - 0.5
        line = []
        for i in range(int(np.floor(s)) - 1, int(np.floor(s)) + 3):
            weight = m4_prime(i - s)
            i = between_gates(gates, x[0], half, top, i) if a == 0 else i
            inside = i % n if grid.periodic[a] else (-1 - i if i < 0 else 2 * n - 1 - i if i >= n else i)
            line.append((inside, weight, ((i if grid.periodic[a] else inside) - s) * h))
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


def conservative(grid, pores, position, velocity, volume, porosity, gates=()):
    """(position, velocity, volume) after remeshing; see water/remesh.hpp for the rules. No outline: half cells only.
    gates (x, lower edge) [m]: no x axis that is periodic.
    """
    lattice = Lattice(grid, pores, gates)
    stays, radius = np.zeros(len(volume), bool), 4
    while True:
        got, stayed = lattice.share_out(position, velocity, volume, porosity, stays)
        lattice.merge(got)
        x, held = lattice.place(got)
        open_nodes = [node for node, moment in held.items() if not lattice.settle(node, moment, x, got)]
        if not open_nodes:
            break
        homes = [lattice.half_cell(at) for at in position]
        near = {other for node in open_nodes for other in lattice.near(node, radius)}
        stays, radius = stayed | np.array([home in near for home in homes]), 2 * radius
    nodes = sorted(x)
    new = [(x[i], got[i].momentum / got[i].volume, got[i].volume) for i in nodes]
    new += [(position[p], velocity[p], volume[p]) for p in np.flatnonzero(stayed)]
    return tuple(np.array(column) for column in zip(*new, strict=True))


class Gathered:
    """What a node was given: V, V/n, V u_d, V (where the water was - where the node is)."""

    def __init__(self, d):
        self.volume = self.bulk = 0.0
        self.momentum, self.moment = np.zeros(d), np.zeros(d)

    def take(self, w, volume, bulk, momentum, moment):
        self.volume += w * volume
        self.bulk += w * bulk
        self.momentum += w * momentum
        self.moment += w * moment


class Lattice:
    """The nodes of a grid, one per half cell, and the rules by which they get water and give it on."""

    def __init__(self, grid, pores, gates=()):
        self.grid, self.pores, self.gates, self.d = grid, pores, gates, grid.dimension
        self.half, self.shape = np.array(grid.spacing) / 2, tuple(2 * n for n in grid.shape)

    def half_cell(self, x):
        return tuple(int(i) for i in np.minimum((x / self.half).astype(int), np.array(self.shape) - 1))

    def centre(self, node):
        return (np.array(node) + 0.5) * self.half

    def near(self, node, radius):
        """The nodes within `radius` nodes, once each."""
        lines = []
        for i, n, periodic in zip(node, self.shape, self.grid.periodic, strict=True):
            line = range(i - radius, i + radius + 1)
            lines.append(list(dict.fromkeys(k % n for k in line)) if periodic else [k for k in line if 0 <= k < n])
        return itertools.product(*lines)

    def way(self, onto, node):
        """From a node to another [nodes], the short way around periodic axes."""
        way = np.subtract(onto, node)
        far = np.array(self.grid.periodic) & (2 * np.abs(way) > self.shape)
        return way - far * np.sign(way) * self.shape

    def parted(self, x, y):
        """Whether a gate stands between two points, of which one is above its edge."""
        return any((x[0] < at) != (y[0] < at) and max(x[-1], y[-1]) > bottom for at, bottom in self.gates)

    def in_sight(self, node, other):
        way = self.way(other, node)
        if self.parted(self.centre(node), self.centre(node) + way * self.half):
            return False
        steps = max(1, np.abs(way).max())
        for s in range(1, steps):
            share = s * way / steps
            between = np.array(node) + np.sign(share) * np.floor(np.abs(share) + 0.5)
            if self.pores[tuple(np.mod(between, self.shape).astype(int))] <= 0:
                return False
        return True

    def share_out(self, position, velocity, volume, porosity, stays):
        stencils = [list(stencil(self.grid, x, self.gates)) for x in position]
        fill = np.zeros(self.shape)
        for p in np.flatnonzero(~stays):
            for node, w, _ in stencils[p]:
                fill[node] += w * volume[p] / porosity[p] / self.half.prod()
        receives = (fill >= RECEIVE) & (self.pores > 0)
        got = {tuple(int(i) for i in node): Gathered(self.d) for node in np.argwhere(receives)}
        stayed = stays.copy()
        for p in np.flatnonzero(~stays):
            shares = self.shares(position[p], stencils[p], receives)
            stayed[p] = not shares
            centre = sum(w * reach for _, w, reach in shares)  # of what the particle gives, from the particle
            for node, w, _ in shares:
                v = volume[p]
                got[node].take(w, v, v / porosity[p], v * velocity[p], -v * centre)
        return got, stayed

    def joined(self, nodes, home):
        """Which of the 4^d nodes of a stencil open half cells join with the home among them."""
        places = list(itertools.product(range(4), repeat=self.d))
        open_ = {place for place, node in zip(places, nodes, strict=True) if self.pores[node] > 0}
        found = {place for place, node in zip(places, nodes, strict=True) if node == home}
        while new := {place for place in open_ - found for at in found if np.abs(np.subtract(place, at)).sum() == 1}:
            found |= new
        return [place in found for place in places]

    def shares(self, x, nodes, receives):
        own, joined = self.pores[self.half_cell(x)], self.joined([node for node, _, _ in nodes], self.half_cell(x))
        seen = [part for part, near in zip(nodes, joined, strict=True) if own > 0 and near and receives[part[0]]]
        plain = sum(w for _, w, _ in seen)
        alike = len(seen) == len(nodes) and all(self.pores[node] == own for node, _, _ in seen)
        if not alike:
            seen = [(node, w * self.pores[node], reach) for node, w, reach in seen]
        total = sum(w for _, w, _ in seen)
        near = min(seen, key=lambda part: np.sum((part[2] / self.half) ** 2), default=None)
        if alike or (plain > SEE and total > WEIGH * plain * own):
            return [(node, w / total, reach) for node, w, reach in seen]
        if near is not None and np.sum((near[2] / self.half) ** 2) < 1:
            return [(near[0], 1.0, near[2])]
        return []

    def fullest(self, node, radius, got, may):
        """The other node in sight that holds most, among those for which may(what it holds) is true."""
        best = None
        for other in self.near(node, radius):
            if other == node or other not in got or got[other].bulk <= (got[best].bulk if best else 0.0):
                continue
            if may(got[other]) and self.in_sight(node, other):
                best = other
        return best

    def hand_over(self, node, onto, got):
        g = got.pop(node)
        got[onto].take(1.0, g.volume, g.bulk, g.momentum, g.moment + g.volume * self.way(node, onto) * self.half)

    def merge(self, got):
        enough = KEEP * self.half.prod()
        for node in [node for node, g in got.items() if g.volume == 0.0]:
            del got[node]
        while True:
            targets = {}
            for node in sorted(node for node, g in got.items() if g.bulk < enough):
                radii = (self.fullest(node, r, got, lambda g: g.bulk > enough) for r in (1, 2, 3))
                target = next((found for found in radii if found), None)
                if target:
                    targets[node] = target
            if not targets:
                break
            for node, target in targets.items():
                self.hand_over(node, target, got)
        assert all(g.bulk > 0 and g.volume > 0 for g in got.values())  # debts: test_remesh_thin.py

    def in_pores(self, x):
        return bool(np.all((x >= 0) & (x <= self.grid.size))) and self.pores[self.half_cell(x)] > 0

    def wrapped(self, x):
        return np.where(self.grid.periodic, np.mod(x, self.grid.size), x)

    def place(self, got):
        """Position of each node's particle, and the moment that the held back ones take."""
        x, held = {}, {}
        for node, g in got.items():
            right = g.moment / g.volume
            offset = np.clip(right, -self.half, self.half)
            x[node] = self.wrapped(self.centre(node) + offset)
            if not self.in_pores(x[node]) or self.parted(self.centre(node), x[node]):
                offset = np.clip(offset, (-0.5 + 1e-9) * self.half, (0.5 - 1e-9) * self.half)
                x[node] = self.centre(node) + offset
            if np.any(right != offset):
                held[node] = g.volume * (right - offset)
        return x, {node: held[node] for node in sorted(held)}

    def may_go(self, x, way):
        return self.in_pores(self.wrapped(x + way)) and not self.parted(x, x + way)

    def settle(self, node, moment, x, got):
        """Moves those around by the same step, so that the moment is what it was; False where they cannot."""
        size = np.linalg.norm(moment)
        way, least = moment / size, self.half.min()
        for most in (0.25, 1.0, 4.0):
            for radius in (1, 2, 4, 8, 16, 32):
                around = [i for i in self.near(node, radius) if i in x and self.in_sight(node, i)]
                movers, step = around, most * least
                while True:
                    movers = [i for i in movers if self.may_go(x[i], step * way)]
                    volume = sum(got[i].volume for i in movers)
                    if size > most * least * volume:
                        break
                    if step == size / volume:
                        for i in movers:
                            x[i] = self.wrapped(x[i] + step * way)
                        return True
                    step = size / volume
        return False
