"""Linear theory of waves on a section of any shape: slopes, layers of rock, solids, on a flat bed before it.

In water and pores, with the Darcy velocity q as exp(-i omega t) and the drag made linear, per unit mass

    (a + B - i omega C_r / n) q = -grad(p / rho + g z),   div q = 0,

and at the level of still water p / rho = g eta, q_z = -i omega n eta. With the potential P = p / rho + g z this is one
Poisson equation with complex coefficients, solved here on the faces and cells of a fine grid, whose means are those of
the solver (`houle.medium`). The incident wave comes in, and the reflected one goes out, through the first column; the
transmitted one leaves through the last column, or that is a wall. The waves that die away from the structure
(evanescent modes) are left out there: two depths away they have fallen to exp(-2 pi).

B replaces b |q| and does its work (Lorentz), in every place: B = b <|q|^3> / <|q|^2>, means over the period, or over
the Gaussian distribution of the velocity in a sea. If l1 and l2 are the variances of q along its principal axes and c
and s cosine and sine of an angle, the ratio is m <(l1 c^2 + l2 s^2)^(3/2)> / (l1 + l2), a mean over the angle; m is
2^(3/2) on an ellipse and 3 (pi / 2)^(1/2), the third moment of Rayleigh's distribution, in a sea.

References: Sollitt & Cross (1972) Proc. 13th ICCE, 1827-1846; Sulisz (1985) Coast. Eng. 9, 371-386, for the rubble
mound by boundary elements; Madsen (1974) J. Waterways Harbors Coast. Eng. 100, 319-328, for B.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError
from houle.analysis.theory import Scatter
from houle.waves.dispersion import GRAVITY, wave_number

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from houle.medium.medium import Medium

Complex = NDArray[Any]
Real = NDArray[np.float64]

ANGLES = np.pi * (np.arange(12) + 0.5) / 12.0  # over which |q|^3 is taken
ELLIPSE, GAUSS = 2.0**1.5, 3.0 * np.sqrt(0.5 * np.pi)  # means of the third power
SETTLED = 1e-4  # change of C_R and C_T from one B to the next at which the linear drag counts as found
ROUNDS = 60


@dataclass(frozen=True)
class Section:
    """The water of a flume below its still level, nx times nz cells; the waves come from the first column.

    spacing       (hx, hz) [m]
    open          along x (nx + 1, nz) and z (nx, nz + 1): open share of the faces; 0 on the bed and beyond the ends
    inertia, a, b per axis on the same faces: <C_r / n>, <a> [1/s], <b> [1/m]
    porosity      (nx,) at the still level
    gravity       [m/s2]
    """

    spacing: tuple[float, float]
    open: tuple[Real, Real]
    inertia: tuple[Real, Real]
    a: tuple[Real, Real]
    b: tuple[Real, Real]
    porosity: Real
    gravity: float = GRAVITY

    @classmethod
    def of(cls, medium: Medium, rows: int, first: int, last: int, gravity: float = GRAVITY) -> Section:
        """The columns first <= i < last of a medium in 2D with its lowest rows; backwards if last < first."""
        step = 1 if last > first else -1
        low, high = min(first, last), max(first, last)

        def cut(faces: Iterable[NDArray[Any]]) -> tuple[Real, Real]:
            along, up = faces
            x, z = along[low : high + 1, :rows], up[low:high, : rows + 1]
            return np.asarray(x[::step], dtype=float), np.asarray(z[::step], dtype=float)

        along, up = cut(medium.open_faces)
        along[[0, -1]] = 0.0
        up[:, 0] = 0.0
        porosity = medium.porosity[low:high, rows - 1][::step]
        inertia, a, b = (cut(medium.on_faces(column)) for column in range(3))
        hx, hz = medium.grid.spacing
        return cls((hx, hz), (along, up), inertia, a, b, porosity, gravity)

    @property
    def shape(self) -> tuple[int, int]:
        return self.open[0].shape[0] - 1, self.open[1].shape[1] - 1


def scatter(section: Section, omega: ArrayLike, height: ArrayLike, *, wall: bool) -> Scatter:
    """Reflected and transmitted waves of a section, for regular waves or a sea.

    omega, height  of regular waves [rad/s], [m]; several (N,) of a sea: those of its components, or of bands of its
                   spectrum. Then the coefficients are roots of shares of the energy of all.
    wall           the last column ends at a wall; else the waves go on behind it, in the depth that is there

    The waves are those in the first and in the last column. Raises AnalysisError where these are not open water, or the
    linear drag does not settle.
    """
    omegas, heights = np.atleast_1d(omega).astype(float), np.atleast_1d(height).astype(float)
    problems = [_Problem(section, one, wall) for one in omegas]
    mean, amplitudes = ELLIPSE if len(omegas) == 1 else GAUSS, 0.5 * section.gravity * heights
    linear: list[Real] = [np.zeros_like(b) for b in section.b]
    last = np.array([np.inf, np.inf])
    for count in range(ROUNDS):
        potentials = [problem.solve(linear) for problem in problems]
        found = np.array([problem.amplitudes(p) for problem, p in zip(problems, potentials, strict=True)])
        share = np.sqrt(np.average(abs(found) ** 2, axis=0, weights=heights**2))
        if np.max(abs(share - last)) < SETTLED:
            reflected, transmitted = (complex(v) for v in (found[0] if len(found) == 1 else share))
            return Scatter(reflected, transmitted, float("nan"))
        waves = zip(problems, amplitudes, potentials, strict=True)
        asked = _drag(section, [problem.velocity(one * p, linear) for problem, one, p in waves], mean)
        linear = asked if count == 0 else [0.5 * (old + new) for old, new in zip(linear, asked, strict=True)]
        last = share
    raise AnalysisError(f"the linear drag did not settle: C_R = {last[0]:.4f} and then {share[0]:.4f}")


def _drag(section: Section, velocities: Sequence[Sequence[Complex]], mean: float) -> list[Real]:
    """The linear drag B [1/s] on the faces of each axis that does the work of b |q| q.

    velocities: along x and z in the cells, amplitudes (nx, nz) [m/s] of each wave; mean: `ELLIPSE` or `GAUSS`.
    """
    xx = sum(0.5 * abs(x) ** 2 for x, _ in velocities)
    zz = sum(0.5 * abs(z) ** 2 for _, z in velocities)
    xz = sum(0.5 * (x * np.conj(z)).real for x, z in velocities)
    middle, half = 0.5 * (xx + zz), np.hypot(0.5 * (xx - zz), xz)
    third = np.mean([(middle + half * np.cos(2.0 * angle)) ** 1.5 for angle in ANGLES], axis=0)
    speed = mean * np.divide(third, 2.0 * middle, out=np.zeros_like(third), where=middle > 0.0)
    along, up = (np.pad(speed, margin, "edge") for margin in ([(1, 1), (0, 0)], [(0, 0), (1, 1)]))
    means = 0.5 * (along[:-1] + along[1:]), 0.5 * (up[:, :-1] + up[:, 1:])
    return [b * one for b, one in zip(section.b, means, strict=True)]


class _Problem:
    """The discrete problem of one frequency; potentials are over that of the incident wave at the still level."""

    def __init__(self, section: Section, omega: float, wall: bool) -> None:
        self.section, self.omega = section, omega
        self.wet = _connected(section)
        self.before = _Mode.of(section, omega, 0)
        self.behind = None if wall or not self.wet[-1].any() else _Mode.of(section, omega, -1)

    def mobility(self, linear: list[Real]) -> list[Complex]:
        """q over -grad P on the faces of each axis [s], in their open part."""
        s = self.section
        parts = zip(s.inertia, s.a, linear, strict=True)
        return [1.0 / (a + b - 1j * self.omega * inertia) for inertia, a, b in parts]

    def rise(self, up: Complex) -> Complex:
        """q_z through the still level over P in the uppermost cells (nx,) [s/m]; up: mobility of the upright faces."""
        s, open_ = self.section, self.section.open[1][:, -1]
        swing = -1j * self.omega * s.porosity / s.gravity
        return open_ / (0.5 * s.spacing[1] / up[:, -1] + 1.0 / swing)

    def solve(self, linear: list[Real]) -> Complex:
        """P (nx, nz), 0 where there is no water."""
        from scipy.linalg import solve_banded

        (hx, hz), (open_x, open_z) = self.section.spacing, self.section.open
        along, up = self.mobility(linear)
        x, z = open_x * along * (hz / hx), open_z * up * (hx / hz)  # links between cells, per unit of P
        x[[0, -1]] = z[:, [0, -1]] = 0.0
        diagonal = x[:-1] + x[1:] + z[:, :-1] + z[:, 1:] + np.where(self.wet, 0.0, 1.0)
        diagonal[:, -1] += self.rise(up) * hx
        right = np.zeros_like(diagonal)
        right[0] = x[1] * (1.0 / self.before.step - self.before.step) * self.before.shape
        diagonal[0] += x[1] * (1.0 - self.before.step)
        if self.behind is not None:
            diagonal[-1] += x[-2] * (1.0 - self.behind.step)
        nz = self.wet.shape[1]
        bands = np.zeros((2 * nz + 1, diagonal.size), complex)  # cells are numbered column by column
        bands[nz] = diagonal.ravel()
        bands[nz - 1], bands[nz + 1] = -z[:, :-1].ravel(), -z[:, 1:].ravel()
        bands[0], bands[2 * nz] = -x[:-1].ravel(), -x[1:].ravel()
        potential = solve_banded((nz, nz), bands, right.ravel()).reshape(self.wet.shape)
        return np.where(self.wet, potential, 0.0)

    def amplitudes(self, potential: Complex) -> Complex:
        """Reflected wave in the first column, transmitted one in the last: amplitudes over that of the incident one."""
        behind = 0j if self.behind is None else self.behind.share(potential[-1])
        return np.array([self.before.share(potential[0]) - 1.0, behind])

    def velocity(self, potential: Complex, linear: list[Real]) -> list[Complex]:
        """Complex amplitude of the Darcy velocity along each axis, in the cells (nx, nz) [m/s]."""
        (hx, hz), (open_x, open_z) = self.section.spacing, self.section.open
        along, up = self.mobility(linear)
        x, z = np.zeros_like(along), np.zeros_like(up)
        x[1:-1] = -along[1:-1] * np.diff(potential, axis=0) / hx * (open_x[1:-1] > 0)
        z[:, 1:-1] = -up[:, 1:-1] * np.diff(potential, axis=1) / hz * (open_z[:, 1:-1] > 0)
        z[:, -1] = self.rise(up) * potential[:, -1]
        x[0], x[-1] = x[1], x[-2]
        return [0.5 * (x[:-1] + x[1:]), 0.5 * (z[:, :-1] + z[:, 1:])]


@dataclass(frozen=True)
class _Mode:
    """The wave that goes on for ever in the depth of one column.

    shape  (nz,) its potential in the cells, 1 at the still level; 0 in the bed
    step   its factor from one column to the next, exp(i k hx)
    """

    shape: Real
    step: complex

    @classmethod
    def of(cls, section: Section, omega: float, column: int) -> _Mode:
        """The mode in the first (0) or the last column (-1). AnalysisError: there is no open water over a bed there."""
        open_ = section.open[0][1 if column == 0 else -2]
        depth = float(open_.sum()) * section.spacing[1]
        if depth <= 0.0 or section.porosity[column] < 1.0:
            raise AnalysisError("no open water at the ends of the section, where waves come in or leave")
        k = float(wave_number(omega, depth, section.gravity))
        level = (np.arange(len(open_)) + 0.5 - len(open_)) * section.spacing[1] + depth  # above the bed
        shape = np.where(open_ > 0.0, np.cosh(k * level) / np.cosh(k * depth), 0.0)
        return cls(shape, complex(np.exp(1j * k * section.spacing[0])))

    def share(self, potential: Complex) -> complex:
        """Share of the mode in the potential of a column (nz,)."""
        return complex(np.sum(self.shape * potential) / np.sum(self.shape**2))


def _connected(section: Section) -> NDArray[np.bool_]:
    """The cells (nx, nz) that water joins with the first column."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    (nx, nz), (along, up) = section.shape, section.open
    number = np.arange(nx * nz).reshape(nx, nz)
    x, z = along[1:-1] > 0.0, up[:, 1:-1] > 0.0
    low = np.concatenate([number[:-1][x], number[:, :-1][z]])
    high = np.concatenate([number[1:][x], number[:, 1:][z]])
    _, group = connected_components(
        coo_matrix((np.ones(len(low)), (low, high)), shape=(nx * nz, nx * nz)), directed=False
    )
    return np.asarray(group == group[nz - 1]).reshape(nx, nz)
