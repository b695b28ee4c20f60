"""Surface, forces, projection and motion in plain NumPy: what core/houle computes, to be read first.

Everything is written as the formula says, particle by particle and face by face; nothing is fast. `grid` is a
houle.grid.Grid. A field of axis -1 lies at the cell centres, one of axis a on the faces across that axis.
"""

from __future__ import annotations

import itertools
from math import exp, floor, isnan, log, sqrt

import numpy as np
from scipy.ndimage import convolve1d, maximum_filter
from scipy.optimize import brentq

from houle.medium.integrals import Measure, with_tent
from houle.medium.sections import partition
from reference_transfer import close_periodic, fold, quadratic, stencil

# ---- free surface ----------------------------------------------------------------------------------------------------


def fill_of_depth(d):
    """Tent-smoothed fill of a cell whose centre lies d cells under a flat surface: the function to be inverted."""
    if d >= 0:
        return 1.0 - 0.5 * (1.0 - min(d, 1.0)) ** 2
    return 0.5 * (1.0 + max(d, -1.0)) ** 2


def column_heights(grid, position, volume):
    """[m] sum_p V_p B(x_p - x_c) / plan area, quadratic B-spline across, walls folded."""
    height = np.zeros(grid.shape[:-1])
    area = grid.cell_volume / grid.spacing[-1]
    for x, v in zip(position, volume, strict=True):
        lines = []
        for a in range(grid.dimension - 1):
            s = x[a] / grid.spacing[a] - 0.5
            near = range(floor(s) - 1, floor(s) + 3)
            lines.append([(fold(i, grid.shape[a], False, grid.periodic[a])[0], quadratic(s - i, 0)[0]) for i in near])
        for parts in itertools.product(*lines):
            column, w = zip(*parts, strict=True)
            height[column] += np.prod(w) * v / area
    return height


def water_held(grid, active, open_cells, fill, inverse_capacity, height):
    """Water in the columns [m^d]: what stands in them, and what cells without air around lack, unless at a bubble, less
    what those with air across a face have too much.
    """
    d, place = grid.dimension, 0.5**grid.dimension
    modes = ["wrap" if p else "nearest" for p in grid.periodic]

    def near(cells, size=3):
        return maximum_filter(cells, size, mode=modes)

    closed = open_cells <= 0.0
    air = (active == 0) & ~closed
    inner = ~near(air)
    capacity = np.divide(1.0, inverse_capacity, out=0.0 * fill, where=inverse_capacity > 0.0)
    missing = (1.0 - fill) * capacity
    for axis, p in enumerate(grid.periodic):
        missing = convolve1d(missing, np.ones(3), axis, mode="wrap" if p else "constant")
    bubble = inner & ~closed & (fill < 1.0 - place) & (missing * inverse_capacity >= place)
    across = (active > 0) & np.any([near(air, 1 + 2 * np.eye(d, dtype=int)[a]) for a in range(d)], axis=0)
    shown = np.where(inner & ~near(bubble), 1.0, np.where(across, np.minimum(fill, 1.0), fill))
    return grid.cell_volume / grid.spacing[-1] * height + np.sum((shown - fill) * capacity, axis=-1)


def surface_fraction(d_water, d_air, least):
    """Share of the way from the water's centre to its air neighbour's at which the surface lies."""
    depth = max(least, d_water)
    return min(1.0, depth / (depth - d_air))


# ---- faces -----------------------------------------------------------------------------------------------------------


def shifted(i, axis, by, grid):
    """Index i moved along an axis, wrapped where periodic; None outside the grid."""
    j = list(i)
    j[axis] += by
    if grid.periodic[axis]:
        j[axis] %= grid.shape[axis]
    return tuple(j) if 0 <= j[axis] < grid.shape[axis] else None


def beside(grid, axis, i):
    """The cells below and above face i of an axis; None behind a wall."""
    first = list(i)
    if grid.periodic[axis]:
        first[axis] %= grid.shape[axis]
    low = shifted(first, axis, -1, grid)
    return low, tuple(first) if first[axis] < grid.shape[axis] else None


def apply_forces(grid, u, inertia, darcy, forchheimer, energy, gravity, extra, dt):
    """(star, drag, mobility, resisted): the exponential Rosenbrock-Euler step of water/forces.hpp, face by face."""
    d = grid.dimension
    star, drag, mobility, resisted = grid.faces(), grid.faces(), grid.faces(), grid.faces()
    for a in range(d):
        for i in np.ndindex(*grid.face_shape(a)):
            low, high = beside(grid, a, i)
            cells = [c for c in (low, high) if c is not None]
            low, high = low or high, high or low  # zero gradient of the porosity at a wall
            v = np.zeros(d)
            for b in range(d):
                if b == a:
                    v[b] = u[a][i]
                else:  # mean of the four faces around
                    around = [u[b][(*c[:b], c[b] + s, *c[b + 1 :])] for c in cells for s in (0, 1)]
                    v[b] = np.mean(around)
            slope = np.zeros(d)
            slope[a] = (energy[high] - energy[low]) / grid.spacing[a]
            for b in set(range(d)) - {a}:
                after, before = (sum(energy[shifted(c, b, by, grid) or c] for c in (low, high)) for by in (1, -1))
                around = (after, energy[low] + energy[high], before)
                least = min([s2 for s2 in around if s2 >= 2.0 * inertia[a][i] * (1.0 - 1e-9)], default=max(around))
                slope[b] = least * log(after / before) / (4.0 * grid.spacing[b])
            sigma = 0.5 * v @ slope
            A, B, c = darcy[a][i], forchheimer[a][i], 1.0 / inertia[a][i]
            speed = sqrt(v @ v)
            R = A + B * speed + sigma
            J = A + B * (speed + (v[a] ** 2 / speed if speed > 0 else 0.0)) + 2.0 * max(sigma, 0.0)
            y = dt * c * J
            phi = (1.0 - exp(-y)) / y if y > 1e-5 else 1.0 - y / 2.0
            mobility[a][i] = phi * dt * c
            drag[a][i] = 1.0 - phi * dt * c * R
            resisted[a][i] = phi * dt * c * (A + B * speed)
            star[a][i] = drag[a][i] * u[a][i] + phi * dt * c * (gravity[a] + (extra[a][i] if extra else 0.0))
    return star, drag, mobility, resisted


def pressure_system(grid, active, depth, open_faces, mobility, star, least):
    """(k, e, rhs): k = open mobility / h^2; e: k / theta of the faces to air; rhs = - net outflux of star / h."""
    k = [o * m / h**2 for o, m, h in zip(open_faces, mobility, grid.spacing, strict=True)]
    e, rhs = grid.cells(), grid.cells()
    for a in range(grid.dimension):
        for i in np.ndindex(*grid.face_shape(a)):
            if grid.periodic[a] and i[a] == grid.shape[a]:
                continue  # the same as face 0
            low, high = beside(grid, a, i)
            if low is None or high is None:
                continue
            flux = open_faces[a][i] * star[a][i] / grid.spacing[a]
            rhs[low] -= flux
            rhs[high] += flux
            for here, there in ((low, high), (high, low)):
                if active[here] and not active[there] and k[a][i] > 0.0:
                    e[here] += k[a][i] / surface_fraction(depth[here], depth[there], least)
    return k, e, np.where(active, rhs, 0.0)


def project(grid, active, depth, open_faces, mobility, p, least, star):
    """(velocity, known): star less mobility grad p on the faces of the water, p = 0 on the surface; walls closed."""
    u, known = [s.copy() for s in star], [np.zeros(s.shape, np.uint8) for s in star]
    for a, h in enumerate(grid.spacing):
        for i in np.ndindex(*grid.face_shape(a)):
            low, high = beside(grid, a, i)
            if high is None and a == grid.dimension - 1 and not active[low]:
                u[a][i] = min(u[a][i], 0.0)  # spray may leave a dry lid, and not pass it
            elif low is None or high is None:
                u[a][i], known[a][i] = 0.0, 1
            elif (active[low] or active[high]) and open_faces[a][i] > 0.0:
                known[a][i] = 1
                if active[low] and active[high]:
                    slope = (p[high] - p[low]) / h
                elif active[low]:
                    slope = -p[low] / h / surface_fraction(depth[low], depth[high], least)
                else:
                    slope = p[high] / h / surface_fraction(depth[high], depth[low], least)
                u[a][i] -= mobility[a][i] * slope
    return u, known


def divergence(grid, open_faces, u):
    """[1/s] of every cell; walls let nothing through."""
    total = grid.cells()
    for a, h in enumerate(grid.spacing):
        flux = np.moveaxis(open_faces[a] * u[a], a, 0).copy()
        if not grid.periodic[a]:
            flux[0] = flux[-1] = 0.0
        total += np.moveaxis(np.diff(flux, axis=0), 0, a) / h
    return total


def extrapolate(grid, layers, near, mass, keep_mass, u, known):
    """(values, layer of each face): known faces carried outwards, each new one the mean of its known neighbours."""
    values, layer_of = [v.copy() for v in u], [k.copy() for k in known]
    for a in range(grid.dimension):
        v, k = values[a], layer_of[a]
        for layer in range(1, layers + 1):
            before = k.copy()
            for i in np.ndindex(*v.shape):
                if before[i]:
                    continue
                if mass and layer == near + 1 and mass[a][i] > keep_mass:
                    k[i] = layer + 1
                    continue
                found = []
                for b in range(grid.dimension):
                    for s in (-1, 1):
                        j = list(i)
                        j[b] += s
                        if grid.periodic[b]:
                            j[b] %= grid.shape[b]
                        if 0 <= j[b] < v.shape[b] and before[tuple(j)]:
                            found.append(v[tuple(j)])
                if found:
                    v[i], k[i] = np.mean(found), layer + 1
        v[k == 0] = 0.0
        close_periodic(grid, a, v)
    return values, layer_of


def continue_upwards(grid, layers, active, column, u):
    """Vertical velocity on the faces above the topmost active cell, such that the cells between have div u = 0."""
    values = [v.copy() for v in u]
    up, nz = grid.dimension - 1, grid.shape[-1]
    for c in np.ndindex(*grid.shape[:-1]):
        if isnan(column[c]) or not active[c].any():
            continue
        top = np.flatnonzero(active[c])[-1]
        for k in range(top + 1, min(top + 1 + layers, nz - 1)):
            i = (*c, k)
            squeeze = 0.0
            for a in range(up):
                right = tuple(n + (b == a) for b, n in enumerate(i))
                squeeze += (u[a][right] - u[a][i]) / grid.spacing[a]
            values[up][(*c, k + 1)] = values[up][i] - grid.spacing[up] * squeeze
    return values


# ---- motion ----------------------------------------------------------------------------------------------------------


def bring_into_tank(grid, x):
    """Around periodic sides, and back between the walls."""
    margin = 1e-9 * np.array(grid.spacing)
    return np.where(grid.periodic, x % grid.size, np.clip(x, margin, grid.size - margin))


def keep_inside(grid, solid, gates, start, x):
    """Where a particle that went from `start` to x is stopped: gates (x, lower edge), a box, walls; periodic sides."""
    x = np.array(x)
    stop_at_gates(grid, gates, start, x)
    if solid is not None:
        x = bring_into_tank(grid, x)
        leave_box(grid, solid, x)
        for turn in range(6):
            if not stop_at_gates(grid, gates, start, x):
                break
            if turn < 4:
                leave_box(grid, solid, x)
            else:
                x[:] = start
    return bring_into_tank(grid, x)


def stop_at_gates(grid, gates, start, x):
    """Puts x in front of a gate that lies on the way from `start`; returns whether one did."""
    stopped, height = False, max(x[-1], 1e-9 * grid.spacing[-1])
    for gate, bottom in gates:
        if (start[0] < gate) != (x[0] < gate) and height > bottom:
            x[0] = gate + (-1e-9 if start[0] < gate else 1e-9) * grid.spacing[0]
            stopped = True
    return stopped


def leave_box(grid, solid, x):
    if solid.distance(x) < 0.0:
        depth = np.stack([x - solid.lower, solid.upper - x])
        side, axis = np.unravel_index(np.argmin(depth), depth.shape)
        margin = 1e-9 * grid.spacing[1 if len(x) == 3 and axis == 1 else 0]
        x[axis] = solid.upper[axis] + margin if side else solid.lower[axis] - margin


def face_velocity(grid, u, x):
    """Face velocity at a point, linear."""
    found = [stencil(grid, "linear", a, x) for a in range(grid.dimension)]
    return np.array([w * sign @ v[node] for v, (node, w, sign, _) in zip(u, found, strict=True)])


def stop_at_solids(grid, closed, u):
    """Face velocities whose part along the normal of a solid is linear, 0 on its outline; closed: per axis (faces,
    rows of normal, point in the water one spacing away, depth of the face's centre in spacings)."""
    d, new = grid.dimension, [v.copy() for v in u]
    for a, (faces, rows) in enumerate(closed):
        for number, row in zip(faces, rows, strict=True):
            i = np.unravel_index(number, grid.face_shape(a))
            centre = (np.array(i) + 0.5 * (np.arange(d) != a)) * grid.spacing
            normal, outside, depth = row[:d], row[d : 2 * d], row[-1]
            across = normal @ face_velocity(grid, u, centre) + depth * (normal @ face_velocity(grid, u, outside))
            new[a][i] = u[a][i] - normal[a] * across
        close_periodic(grid, a, new[a])
    return new


def cell_value(grid, field, x):
    """Cell field at a point, linear; 1 without a field."""
    node, w, _, _ = stencil(grid, "linear", -1, x)
    return 1.0 if field is None else w @ field[node]


def move(grid, u, porosity, solid, gates, dt, position):
    """Midpoint rule with the pore velocity u_d / n (17)."""
    new = np.empty_like(position)
    for p, start in enumerate(position):
        middle = start + 0.5 * dt * face_velocity(grid, u, start) / cell_value(grid, porosity, start)
        middle = keep_inside(grid, solid, gates, start, middle)
        end = start + dt * face_velocity(grid, u, middle) / cell_value(grid, porosity, middle)
        new[p] = keep_inside(grid, solid, gates, start, end)
    return new


def fall_behind(grid, u, inertia, held, lag, porosity, dt):
    """What momentum that moves with 1 - lag of the velocity of the water changes on the faces while that moves for dt.

    inertia: of the faces, equal where the medium is the same; lag, porosity: cells. The velocity found at the end of
    `lag` of the way minus the one here: by M4' in one medium, else linear, between media in the share that is held.
    """
    change = grid.faces()
    for a, field in enumerate(u):
        for i in np.ndindex(*grid.face_shape(a)):
            x = y = (np.array(i) + 0.5 * (np.arange(grid.dimension) != a)) * grid.spacing
            share = cell_value(grid, lag, x)
            if not share > 0.0:
                continue
            for time in (0.5 * dt, dt):
                way = time * share / cell_value(grid, porosity, y) * face_velocity(grid, u, y)
                y = bring_into_tank(grid, x + way)
            node, w, sign, _ = stencil(grid, "m4prime", a, y)
            part = 1.0
            if np.any(inertia[a][node] != inertia[a][i]):
                node, w, sign, _ = stencil(grid, "linear", a, y)
                if np.any(inertia[a][node] != inertia[a][i]):
                    part = min(held[a][i], w @ held[a][node])
            change[a][i] = part * (w * sign @ field[node] - field[i])
    return change


def displace(grid, displacement, porosity, solid, gates, limit, position):
    """Moved by displacement / n, at most `limit` cells along each axis."""
    new = np.empty_like(position)
    most = limit * np.array(grid.spacing)
    for p, start in enumerate(position):
        step = face_velocity(grid, displacement, start) / cell_value(grid, porosity, start)
        new[p] = keep_inside(grid, solid, gates, start, start + np.clip(step, -most, most))
    return new


# ---- viscosity -------------------------------------------------------------------------------------------------------


def eddy_viscosity(grid, u, molecular, constant):
    """nu + (C_s Delta)^2 sqrt(2 S_ab S_ab), gradients between cell centres, one-sided at walls."""
    d = grid.dimension
    gradient = np.zeros((d, d, *grid.shape))
    for a in range(d):
        v = np.moveaxis(u[a], a, 0)
        gradient[a, a] = np.moveaxis(np.diff(v, axis=0), 0, a) / grid.spacing[a]
        centre = np.moveaxis(0.5 * (v[:-1] + v[1:]), 0, a)
        for b in set(range(d)) - {a}:
            n, h = grid.shape[b], grid.spacing[b]
            if grid.periodic[b]:
                gradient[a, b] = (np.roll(centre, -1, b) - np.roll(centre, 1, b)) / (2.0 * h)
            elif n > 1:
                gradient[a, b] = np.gradient(centre, h, axis=b)
    strain = 0.5 * (gradient + np.swapaxes(gradient, 0, 1))
    width = constant * grid.cell_volume ** (1.0 / d)
    return molecular + width**2 * np.sqrt(2.0 * np.sum(strain**2, axis=(0, 1)))


def wall_shear(v, y, nu, roughness=0.0):
    """v_*^2 of the law of the wall, smooth to rough, or of the viscous sublayer where that is more."""
    y = max(y, 0.5 * roughness)
    if nu <= 0.0:
        return v * abs(v) * (0.41 / np.log(30.0 * y / roughness)) ** 2 if roughness > 0.0 else 0.0
    re, c = abs(v) * y / nu, 9.8 / 30.0 * roughness / y
    if re <= (36.0 if roughness > 0.0 else 11.53**2):
        return nu * v / y
    least = 1.0 / (9.8 - c)  # the logarithm is 0 there
    s = brentq(lambda s: s * np.log(9.8 * s / (1.0 + c * s)) - 0.41 * re, least, re, xtol=1e-14, rtol=1e-14)
    return max(nu * abs(v) / y, (abs(v) * s / re) ** 2) * np.sign(v)


def rub(grid, cell, first, front, plane, start, x, volume, bulk, inertia, fill, nu, dt, u):
    """Velocities after the friction of walls, impulse of each plane, energy taken: core/houle/water/friction.hpp."""
    d, u, impulse, taken = grid.dimension, u.copy(), np.zeros((len(plane), grid.dimension)), 0.0
    for row, c in enumerate(cell):
        for k in range(first[row], first[row + 1]):
            normal, offset, roughness = plane[k, :d], plane[k, d], plane[k, d + 1]
            h = normal**2 @ grid.spacing
            sheet = h * min(max(fill.ravel()[front[k]], 0.25), 1.0)
            for p in range(start[c], start[c + 1]):
                away = normal @ x[p] - offset
                share = min(max(1.5 - max(away, 0.0) / h, 0.0), 1.0)
                along = u[p] - (normal @ u[p]) * normal
                v = np.linalg.norm(along)
                if share == 0.0 or away < -0.25 * h or volume[p] < 0.999 * bulk[p] or v == 0.0:
                    continue
                rate = share * wall_shear(v, max(away, 0.5 * sheet), nu, roughness) / (v * sheet)
                mass, before = bulk[p] * (inertia[p] if inertia is not None else 1.0), u[p].copy()
                u[p] -= along * rate * dt / (1.0 + rate * dt)
                impulse[k] += mass * (before - u[p])
                taken += 0.5 * np.sum(mass * (before**2 - u[p] ** 2))
    return u, impulse, taken


def viscous_acceleration(grid, u, mass, least, nu, porosity):
    """nu lap(u) / n on the faces that hold water; no gradient towards the others and along walls."""
    out = grid.faces()
    for a in range(grid.dimension):
        for i in np.ndindex(*grid.face_shape(a)):
            low, high = beside(grid, a, i)
            if mass[a][i] <= least or low is None or high is None:
                continue
            laplacian = 0.0
            n = 1.0 if porosity is None else 0.5 * (porosity[low] + porosity[high])
            for b, h in enumerate(grid.spacing):
                for s in (-1, 1):
                    j = list(i)
                    j[b] += s
                    if grid.periodic[b]:
                        j[b] %= grid.shape[b]
                    if not 0 <= j[b] < u[a].shape[b]:  # behind a wall
                        continue
                    at_wall = b == a and not grid.periodic[a] and j[a] in (0, grid.shape[a])
                    if mass[a][tuple(j)] > least or at_wall:
                        laplacian += (u[a][tuple(j)] - u[a][i]) / h**2
            out[a][i] = 0.5 * (nu[low] + nu[high]) * laplacian / n
    return out


def travel(axis, dt, u, mass, least, porosity, way):
    """(way + dt u, largest |way| / n where there is more than `least`), single precision: core/houle/water/advect.hpp.

    u, mass, way: on the faces of the axis; porosity (cells), of which a face has the mean of those on both sides.
    """
    way, n = (way + dt * u).astype(np.float32), np.float32(1.0)
    if porosity is not None:
        wide = np.pad(porosity, [(int(b == axis),) * 2 for b in range(u.ndim)], mode="edge")
        n = np.float32(0.5) * (np.delete(wide, 0, axis=axis) + np.delete(wide, -1, axis=axis)).astype(np.float32)
    return way, float(np.max(np.abs(way) * (mass > least) / n))


# ---- the medium ------------------------------------------------------------------------------------------------------


def tent_porosity(grid, bodies, solids):
    """Mean of n * open with the weight prod_a max(0, 1 - |x_a - xc_a| / h_a): what the tent of a full cell holds."""
    parts, tents = partition(grid, bodies, solids), [with_tent] * grid.dimension
    held = 1.0 - Measure.of(grid, [(span, solid) for span, solid, _ in parts]).mean(tents)
    for k, body in enumerate(bodies):
        held += (body.porosity - 1.0) * Measure.of(grid, [(span, areas[k]) for span, _, areas in parts]).mean(tents)
    return held
