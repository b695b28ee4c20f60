"""Sums over all pairs of components, without a loop over pairs: what waves of second order are made of.

A quantity of second order is a double sum over components with the phasors E_i = exp(i theta_i),

    q = Re sum_ij a_i a_j (S_ij E_i E_j + D_ij E_i E*_j) ,

S the kernel of the sums and D that of the differences of two frequencies. 200 components make 40 000 pairs. But the
kernels are smooth functions of both frequencies, so that a few vectors v_r, which all kernels of a wave share, hold
them:

    a_i a_j S_ij = sum_rs v_ir s_rs v_jr ,  F_r = sum_i v_ir E_i ,
    q = Re sum_rs (s_rs F_r F_s + d_rs F_r F*_s) .

Some ten vectors do to 1e-6. The kernels are computed at nodes: the components themselves if they are few, else
Chebyshev points in frequency, between which a polynomial leads to the components (Trefethen 2013, Approximation
theory).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from houle.waves.wave import Array

Complex = NDArray[np.complex128]
NODES = 64  # nodes; so many components or fewer are the nodes themselves
ROUNDING = 1e-15  # smaller eigenvalues, as a share of the largest, are rounding
TOLERANCE = 1e-6  # share of the root mean square of the kernels that the vectors leave out


@dataclass(frozen=True)
class Nodes:
    """Frequencies [rad/s] at which kernels are known, and the way from there to the components.

    omega  (n,) of the nodes
    unit   (N, m) orthonormal columns; lead (m, n): a_i times the interpolation to component i is unit @ lead
    """

    omega: Array
    unit: Array
    lead: Array

    @classmethod
    def of(cls, omega: Array, amplitude: Array, count: int = NODES) -> Nodes:
        """The nodes for components of these frequencies [rad/s] and amplitudes [m], (N,), `count` at most."""
        nodes, weights = omega, np.eye(len(omega))
        if len(omega) > count:
            nodes, weights = _interpolation(omega, count)
        weighted = amplitude[:, None] * weights
        size, across = np.linalg.eigh(weighted.T @ weighted)
        kept = size > ROUNDING * size[-1]
        size, across = np.sqrt(size[kept]), across[:, kept]
        return cls(nodes, weighted @ across / size, (across * size).T)

    def led(self, kernel: NDArray) -> NDArray:
        """A kernel (..., n, n) at the nodes as one between the columns of `unit`."""
        return self.lead @ kernel @ self.lead.T

    def few(self, kernels: list[NDArray], single: Array | None = None) -> Array:
        """The vectors (m, R), in the columns of `unit`, that hold these kernels (..., n, n) to `TOLERANCE`.

        single: functions of one frequency (..., n) that they hold as well.
        """
        spread = np.zeros((self.lead.shape[0],) * 2)
        for kernel in kernels:
            led = self.led(kernel).reshape(-1, *self.lead.shape[:1] * 2)
            square = np.einsum("mij,mkj->ik", led, led.conj(), optimize=True).real
            spread += square / max(float(np.trace(square)), 1e-300)
        if single is not None:
            led = single @ self.lead.T
            spread += led.T @ led / float(np.sum(led**2))
        size, vectors = np.linalg.eigh(spread)
        left = np.cumsum(np.maximum(size, 0.0))
        return np.asarray(vectors[:, left > TOLERANCE**2 * left[-1]])


def _interpolation(omega: Array, count: int) -> tuple[Array, Array]:
    """Chebyshev points over the range of omega (N,), and the weights (N, n) with which values there lead to omega."""
    low, high = omega.min(), omega.max()
    j = np.arange(count)
    points = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(np.pi * j / (count - 1))
    share = np.where(j % 2, -1.0, 1.0) * np.where((j == 0) | (j == count - 1), 0.5, 1.0)
    off = omega[:, None] - points
    at = np.abs(off) < 1e-13 * high
    weights = share / np.where(at, 1.0, off)
    weights /= weights.sum(-1, keepdims=True)
    hit = at.any(-1)
    weights[hit] = at[hit]
    return points, weights
