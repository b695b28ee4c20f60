"""Heights of waves that grow on a beach by potential flow: fully non-linear, without friction, up to breaking.

    python benchmarks/shoaling.py [--height 0.0685] [--spacing 0.025] [--layers 9] [--steps 80] [--periods 17]

An oracle for `beach` (Hansen & Svendsen 1979, test 061071) that has no particle and no cell in common with houle. With
the potential phi on the surface z = eta and its vertical derivative W there (Zakharov 1968),

    eta_t = W (1 + eta_x^2) - phi_x eta_x          phi_t = -g eta - phi_x^2 / 2 + W^2 (1 + eta_x^2) / 2,

W from Laplace's equation between bed and surface, solved on layers sigma = (z + h)/(h + eta) by differences of second
order along x and fourth across (Engsig-Karup, Bingham & Lindberg 2009, J. Comput. Phys. 228), and four stages of Runge
& Kutta. A zone of 3 m makes a stream function wave. Behind x = 6.9 m from the toe the waves are damped, as nothing here
can break: heights count up to there. It prints height and mean level of every period at places along the beach.
"""

from __future__ import annotations

import argparse

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as linalg

from houle.grid import FloatArray
from houle.waves.fenton import fenton

GRAVITY, PERIOD, DEPTH, SLOPE = 9.81, 1.6667, 0.36, 1 / 34.26
BEGIN, MADE, END, SHALLOW = -6.0, -3.0, 11.5, 0.11  # x from the toe [m]; least depth [m]
DAMPED, ABSORBED = 6.9, 7.2  # x from which on waves are damped, and taken up [m]
PLACES = (-1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.5, 6.0, 6.5, 6.75)


class Layers:
    """Laplace's equation between the bed and a surface, on layers that follow both.

    sigma runs from 0 at the bed to 1 at the surface, closer there. `vertical` gives W; the last solution is its first
    guess, and the inverse of a matrix of before prepares the iterations (GMRES).
    """

    def __init__(self, depth: FloatArray, spacing: float, layers: int) -> None:
        self.depth, self.spacing, columns = depth, spacing, len(depth)
        self.sigma = np.sin(np.linspace(0.0, 0.5 * np.pi, layers))
        self.bed_slope, self.bed_curve = self.along(depth), self.second(depth)
        first, second = self._across(1), self._across(2)
        self.top = first[-1]
        one, here = sp.identity(columns), sp.identity(layers)
        x, xx = self._ends(np.array([-0.5, 0.0, 0.5]) / spacing), self._ends(np.array([1.0, -2.0, 1.0]) / spacing**2)
        self.x, self.xx = sp.kron(x, here).tocsr(), sp.kron(xx, here).tocsr()
        self.s, self.ss = sp.kron(one, first).tocsr(), sp.kron(one, second).tocsr()
        self.xs = (self.x @ self.s).tocsr()
        row = np.zeros((columns, layers))
        row[:, 0], row[:, -1] = 1.0, 2.0
        self.bed, self.surface = (sp.diags_array((row.ravel() == k).astype(float)) for k in (1.0, 2.0))
        self.inside = sp.diags_array((row.ravel() == 0.0).astype(float))
        self.solution, self.prepared = np.zeros(columns * layers), None

    def along(self, f: FloatArray) -> FloatArray:
        """Derivative along x, of fourth order inside."""
        d = np.gradient(f, self.spacing)
        d[2:-2] = (8.0 * (f[3:-1] - f[1:-3]) - (f[4:] - f[:-4])) / (12.0 * self.spacing)
        return d

    def second(self, f: FloatArray) -> FloatArray:
        """Second derivative along x."""
        wide = np.pad(f, 1, mode="edge")
        return (wide[2:] - 2.0 * f + wide[:-2]) / self.spacing**2

    def _ends(self, weights: FloatArray) -> sp.csr_matrix:
        """A difference along x, with what lies beyond an upright wall as its mirror image."""
        n = len(self.depth)
        matrix = sp.diags_array(list(weights), offsets=[-1, 0, 1], shape=(n, n)).tolil()
        matrix[0, 1] += weights[0]
        matrix[-1, -2] += weights[2]
        return matrix.tocsr()

    def _across(self, order: int) -> FloatArray:
        """Derivatives across the layers from five of them."""
        n = len(self.sigma)
        matrix = np.zeros((n, n))
        for row in range(n):
            low = min(max(row - 2, 0), n - 5)
            powers = np.vander(self.sigma[low : low + 5] - self.sigma[row], increasing=True).T
            matrix[row, low : low + 5] = np.linalg.solve(powers, np.eye(5)[order] * order)
        return matrix

    def matrix(self, eta: FloatArray) -> sp.csr_matrix:
        """Laplace's equation inside, no flow through the bed, the potential given on the surface."""
        whole, sigma = (self.depth + eta)[:, None], self.sigma[None]
        slope, curve = self.along(whole[:, 0])[:, None], self.second(whole[:, 0])[:, None]
        bed = np.broadcast_to(self.bed_slope[:, None], (len(eta), len(self.sigma)))
        across = (bed - sigma * slope) / whole  # sigma_x, and below sigma_xx and sigma_z
        bent = (self.bed_curve[:, None] - sigma * curve - 2.0 * across * slope) / whole
        up = np.broadcast_to(1.0 / whole, bed.shape)
        laplace = self.xx + _by(2.0 * across) @ self.xs + _by(bent) @ self.s + _by(across**2 + up**2) @ self.ss
        through = _by(up + bed * across) @ self.s + _by(bed) @ self.x
        size = float(self.depth.mean())
        return (self.inside @ laplace * size**2 + self.bed @ through * size + self.surface).tocsr()

    def vertical(self, eta: FloatArray, phi: FloatArray) -> FloatArray:
        """W on the surface [m/s] for its elevation [m] and potential [m2/s]."""
        matrix, layers, counted = self.matrix(eta), len(self.sigma), []
        given = np.zeros(len(self.solution))
        given[layers - 1 :: layers] = phi
        if self.prepared is None:
            self.prepared = linalg.splu(matrix.tocsc())
        nearly = linalg.LinearOperator(matrix.shape, self.prepared.solve)
        self.solution, failed = linalg.gmres(
            matrix, given, x0=self.solution, rtol=1e-8, restart=30, M=nearly,
            callback=counted.append, callback_type="pr_norm",
        )  # fmt: skip
        if failed:
            raise RuntimeError("Laplace's equation was not solved: give a finer grid or lower waves")
        if len(counted) > 12:
            self.prepared = linalg.splu(matrix.tocsc())
        return (self.solution.reshape(-1, layers) @ self.top) / (self.depth + eta)


def _by(values: FloatArray) -> sp.dia_array:
    return sp.diags_array(np.ravel(values).copy())


class Beach:
    """Rates of change of surface and potential on the beach, with what makes and takes up the waves."""

    def __init__(self, height: float, spacing: float, layers: int) -> None:
        self.x = np.arange(BEGIN, END, spacing)
        depth = np.maximum(DEPTH - SLOPE * np.maximum(self.x, 0.0), SHALLOW)
        depth = np.convolve(np.pad(depth, 2, mode="edge"), np.ones(5) / 5, "valid")
        self.layers, self.wave = Layers(depth, spacing, layers), fenton(height, PERIOD, DEPTH, GRAVITY, 0.0, 0.0)
        self.made = 6.0 * np.clip((MADE - self.x) / (MADE - BEGIN), 0.0, 1.0) ** 2
        self.taken = 4.0 * np.clip((self.x - ABSORBED) / 3.5, 0.0, 1.0) ** 2
        self.viscosity = 0.02 * np.clip((self.x - DAMPED) / 0.6, 0.0, 1.0) ** 2

    def rates(self, t: float, eta: FloatArray, phi: FloatArray) -> tuple[FloatArray, FloatArray]:
        """d eta/dt and d phi/dt."""
        w, slope, u = self.layers.vertical(eta, phi), self.layers.along(eta), self.layers.along(phi)
        wanted = self.wanted(t)
        own = (
            w * (1.0 + slope**2) - u * slope,
            -GRAVITY * eta - 0.5 * u**2 + 0.5 * w**2 * (1.0 + slope**2),
        )
        extra = (
            self.viscosity * self.layers.second(f) - self.taken * f + self.made * (goal - f)
            for f, goal in zip((eta, phi), wanted, strict=True)
        )
        rise, change = (a + b for a, b in zip(own, extra, strict=True))
        return rise, change

    def wanted(self, t: float) -> tuple[FloatArray, FloatArray]:
        """Elevation and potential on the surface of the stream function wave, growing over two periods."""
        wave, grown = self.wave, 0.5 - 0.5 * np.cos(np.pi * min(t / (2.0 * PERIOD), 1.0))
        eta = wave.elevation(self.x, t)
        jk = np.arange(1, len(wave.speeds) + 1)[:, None] * wave.k
        phase = jk * (self.x - wave.celerity * t)
        phi = (wave.speeds[:, None] / jk * np.cosh(jk * (DEPTH + eta)) * np.sin(phase)).sum(axis=0)
        return grown * eta, grown * phi

    def step(self, t: float, dt: float, eta: FloatArray, phi: FloatArray) -> tuple[FloatArray, FloatArray]:
        """A step of dt [s] by the four stages of Runge & Kutta."""
        sums, rates = (0.0, 0.0), (0.0, 0.0)
        for share, weight in ((0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)):
            rates = self.rates(t + share * dt, eta + share * dt * rates[0], phi + share * dt * rates[1])
            sums = sums[0] + weight * rates[0], sums[1] + weight * rates[1]
        return eta + dt / 6.0 * sums[0], phi + dt / 6.0 * sums[1]


def smooth(f: FloatArray) -> FloatArray:
    """Takes off what is two points long (Shapiro 1975): of a wave of ten points 0.01 %."""
    r = f.copy()
    pairs = [f[4 - k : len(f) - 4 - k] + f[4 + k : len(f) - 4 + k] for k in range(1, 5)]
    r[4:-4] -= (70 * f[4:-4] - 56 * pairs[0] + 28 * pairs[1] - 8 * pairs[2] + pairs[3]) / 256
    return r


def main() -> None:
    """Prints height and mean level [mm] at the places in every period."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--height", type=float, default=0.0685)
    parser.add_argument("--spacing", type=float, default=0.025)
    parser.add_argument("--layers", type=int, default=9)
    parser.add_argument("--steps", type=int, default=80)
    parser.add_argument("--periods", type=int, default=17)
    given = parser.parse_args()
    beach, dt = Beach(given.height, given.spacing, given.layers), PERIOD / given.steps
    eta, phi = np.zeros(len(beach.x)), np.zeros(len(beach.x))
    print("x [m]   " + "".join(f"{x:13g}" for x in PLACES))
    for period in range(given.periods):
        levels = np.zeros((given.steps, len(eta)))
        for step in range(given.steps):
            eta, phi = beach.step((period * given.steps + step) * dt, dt, eta, phi)
            if step % 10 == 0:
                eta, phi = smooth(eta), smooth(phi)
            levels[step] = eta
        height, mean = (np.interp(PLACES, beach.x, 1e3 * f) for f in (np.ptp(levels, axis=0), levels.mean(axis=0)))
        row = "".join(f"{a:6.1f} ({b:4.1f})" for a, b in zip(height, mean, strict=True))
        print(f"t/T = {period + 1:2d}{row}", flush=True)


if __name__ == "__main__":
    main()
