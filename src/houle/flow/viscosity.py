"""Viscosity: the viscous acceleration between particles, eq. (3) of the paper, and the longest step that it allows.

    a_i = K sum_j nu_ij ((u_j - u_i) . r / |r|^2) grad_i W(x_i - x_j) B_j,    K = 2 (d + 2),  B = V/n

Expanding u to second order shows that for constant nu the sum is lap(u) + 2 grad(div u), the Laplacian only where
div u = 0, and for smooth nu div(nu (grad u + grad u^T)) + grad(nu div u), with either mean of nu. The arithmetic mean
is used: the harmonic one, made for jumps between two fluids, lets an eddy viscosity that vanishes at a particle cut the
particle off. Each pair pulls along the line between the particles, so angular momentum is kept as well as momentum.

Near a free surface the sum sees only the water: no stress acts across the surface. At a slip wall the mirror images
make the shear vanish, at a no-slip wall the velocity; both from images with the velocity reversed, its normal component
or all of it.

References: Monaghan & Gingold 1983, J. Comput. Phys. 52, 374 (the operator); Espanol & Revenga 2003, Phys. Rev. E 67,
026705 (its continuum limit); Wendland 1995, Adv. Comput. Math. 4, 389 (kernel); Smagorinsky 1963, Mon. Weather Rev. 91,
99; Randles & Libersky 1996, Comput. Methods Appl. Mech. Eng. 139, 375 (corrected gradient).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.grid import FloatArray, Grid

KERNEL_STIFFNESS = {"wendland": 14.0, "gaussian": 18.0}  # radius^2 times the integral of -W'(r)/r (time_step_limit)
REACH = 2.0  # grid spacings within which the sums between particles see neighbours


def longest_step(grid: Grid, viscosity: float, between_particles: bool) -> float:
    """Longest stable step [s] of the explicit viscous term with a viscosity [m2/s]; inf without viscosity.

    between_particles  whether the term is a sum over particles, or one on the faces of the grid

    On faces nu lap(u) has eigenvalues up to 4 nu sum 1/h^2, and twice that is allowed for. The friction of walls is
    implicit. Eddies do not count: theirs is a share C_s^2 dt |S| of it, below a tenth at the steps that the Courant
    limit allows.
    """
    if between_particles:
        return Smoothing(grid, (), REACH * max(grid.spacing)).time_step_limit(viscosity)
    spectrum = 8 * viscosity * sum(1 / h**2 for h in grid.spacing)
    return 2 / spectrum if spectrum > 0 else np.inf


@dataclass(frozen=True)
class Smoothing:
    """Sums over the neighbours of each particle, weighted with a kernel.

    walls   "slip" or "no-slip" for the lower and the upper side of each axis in turn (ignored on periodic axes)
    radius  of the support of the kernel [m]
    kernel  "wendland" or "gaussian"

    Every method takes particles that are sorted by cell: position (N, d) [m]; cell_start (cells + 1,) int32, number of
    the first particle of each cell, cells in C order; bulk (N,), their V/n [m^d]. For particles on the lattice the sums
    fall short of the integrals: with a radius of 2 grid spacings the density sum by 0.1 % and the viscous term by 4 %
    (2D; 2 % in 3D), with 3 by 0.02 % and 1 % (0.3 %).
    """

    grid: Grid
    walls: tuple[str, ...]
    radius: float
    kernel: str = "wendland"

    def density_sum(self, position: FloatArray, cell_start: NDArray[np.int32], bulk: FloatArray) -> FloatArray:
        """Share of space that the water fills around each particle, sum_j B_j W(x_i - x_j), (N,) [-].

        It is the paper's eq. (14) over n rho: 1 in full water, up to the walls; about 1/2 at a flat free surface.
        """
        out = np.empty(len(position))
        near = (self.grid.core, self.walls, self.kernel, self.radius, position, _as_core(cell_start))
        _core.sph_density_sum(*near, bulk, out)
        return out

    def velocity_gradient(
        self, position: FloatArray, cell_start: NDArray[np.int32], velocity: FloatArray, bulk: FloatArray
    ) -> FloatArray:
        """Gradient of a velocity (N, d) [m/s] at the particles, du_a/dx_b, (N, d, d) [1/s].

        It is exact for linear fields, at the surface too, and zero where neighbours are too few.
        """
        d = self.grid.dimension
        out = np.empty((len(position), d, d))
        near = (self.grid.core, self.kernel, self.radius, position, _as_core(cell_start))
        _core.sph_velocity_gradient(*near, velocity, bulk, out)
        return out

    def eddy_viscosity(
        self,
        position: FloatArray,
        cell_start: NDArray[np.int32],
        velocity: FloatArray,
        bulk: FloatArray,
        smagorinsky: float,
    ) -> FloatArray:
        """Eddy viscosity of Smagorinsky (1963) at the particles, (C_s dx)^2 |S|, (N,) [m2/s].

        |S| = sqrt(2 S:S), dx is the geometric mean of the grid spacings; smagorinsky: C_s [-].
        """
        gradient = self.velocity_gradient(position, cell_start, velocity, bulk)
        strain = 0.5 * (gradient + np.swapaxes(gradient, 1, 2))
        length = smagorinsky * self.grid.cell_volume ** (1 / self.grid.dimension)
        return length**2 * np.sqrt(2.0 * np.einsum("nab,nab->n", strain, strain))

    def viscous_acceleration(
        self,
        position: FloatArray,
        cell_start: NDArray[np.int32],
        velocity: FloatArray,
        bulk: FloatArray,
        viscosity: FloatArray | float,
    ) -> FloatArray:
        """Viscous acceleration of the particles, eq. (3), (N, d) [m/s2].

        velocity: the pore velocity u_d/n for eq. (13), (N, d) [m/s]; viscosity: (N,) or a number [m2/s].
        """
        out = np.empty_like(position)
        nu = viscosity if isinstance(viscosity, np.ndarray) else np.full(len(position), viscosity)
        near = (self.grid.core, self.walls, self.kernel, self.radius, position, _as_core(cell_start))
        _core.sph_viscous_acceleration(*near, velocity, bulk, nu, out)
        return out

    def time_step_limit(self, viscosity: float) -> float:
        """Longest stable explicit step [s] with the largest viscosity [m2/s] in full water; inf without viscosity.

        It is 2 over a bound of the spectrum: by Gershgorin, eigenvalues are at most twice the diagonal, which is K nu/d
        times the integral of -W'(r)/r. For the Wendland kernel in 2D that makes radius^2 / (56 nu).
        """
        d = self.grid.dimension
        spectrum = 2 * 2 * (d + 2) / d * KERNEL_STIFFNESS[self.kernel] * viscosity / self.radius**2
        return 2 / spectrum if spectrum > 0 else np.inf


def _as_core(cell_start: NDArray) -> NDArray[np.int32]:
    """The numbers of the first particles of the cells as int32; nothing is copied if they are that already."""
    return np.ascontiguousarray(cell_start, np.int32)
