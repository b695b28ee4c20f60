"""The pressure system as a sparse matrix: the readable twin of core/houle/pressure/poisson.hpp."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import scipy.sparse.csgraph
import scipy.sparse.linalg


def links(active, k, periodic):
    """The faces that join two active cells: (their cells (M,), the cells above (M,), coefficients (M,)).

    active bool (shape); k one array per axis, one entry longer along it; periodic one bool per axis.
    """
    number = np.arange(active.size).reshape(active.shape)
    below, above, value = [], [], []
    for axis, coefficient in enumerate(k):
        n = active.shape[axis]
        ends = [(np.arange(n - 1), np.arange(1, n))]
        if periodic[axis] and n > 1:
            ends.append((np.array([n - 1]), np.array([0])))
        for lower, upper in ends:
            face = np.take(coefficient, upper, axis)
            a, b = np.take(number, lower, axis), np.take(number, upper, axis)
            keep = active.ravel()[a] & active.ravel()[b]
            below.append(a[keep])
            above.append(b[keep])
            value.append(face[keep])
    return np.concatenate(below), np.concatenate(above), np.concatenate(value)


def matrix(active, k, e, periodic):
    """sum_f k_f (p_c - p_nb) + e_c p_c over all cells of the box; rows of inactive cells are empty."""
    i, j, value = links(active, k, periodic)
    diagonal = sp.diags_array(np.where(active, e, 0).ravel())
    off = sp.coo_array((value, (i, j)), shape=(active.size, active.size))
    off = (off + off.T).tocsr()
    return (diagonal + sp.diags_array(off.sum(axis=0)) - off).tocsr()


def solve(active, k, e, rhs, periodic):
    """The solution (shape) and the closed components (list of cell-number arrays).

    In a closed component the mean of rhs is taken out and the solution with zero mean returned.
    """
    a = matrix(active, k, e, periodic)
    i, j, value = links(active, k, periodic)
    graph = sp.coo_array((value[value > 0], (i[value > 0], j[value > 0])), shape=a.shape)
    _, label = scipy.sparse.csgraph.connected_components(graph, directed=False)
    b = np.where(active, rhs, 0).ravel()
    cells = np.flatnonzero(active)
    open_labels = set(label[cells[e.ravel()[cells] > 0]])
    closed = [cells[label[cells] == c] for c in set(label[cells]) - open_labels]
    keep = active.ravel().copy()
    for members in closed:
        b[members] -= b[members].mean()
        keep[members[0]] = False  # fixes the constant
    p = np.zeros(active.size)
    if keep.any():
        p[keep] = scipy.sparse.linalg.spsolve(a[keep][:, keep].tocsc(), b[keep])
    for members in closed:
        p[members] -= p[members].mean()
    return p.reshape(active.shape), closed
