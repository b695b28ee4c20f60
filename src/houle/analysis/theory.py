"""Reflection and transmission of linear regular waves by a full-depth vertical porous block.

Time goes as exp(-i omega t), x points into the block (0 < x < b), z is up from still water, the bottom is at -h.
In the pores (Sollitt & Cross 1972), with the intrinsic velocity u = grad(phi),

    S du/dt = -grad(p / rho + g z) - f omega u        p / rho = i omega c phi,   c = S + i f,
    omega^2 c = g K tanh(K h)                         complex dispersion relation, Im K >= 0;

at the faces pressure and discharge are continuous: phi_water = c phi_pores, d(phi_water)/dx = n d(phi_pores)/dx.
Both regions are expanded in their own vertical modes (Dalrymple, Losada & Martin 1991). A block in the open is the mean
of two half problems mirrored about its middle, one with no flow through the middle (a wall), one with no pressure
there: R = (R_wall + R_pressure) / 2, T = (R_wall - R_pressure) / 2. So one solver of M x M covers block, and block
with wall.

The friction f of a Darcy-Forchheimer drag a u_d + b |u_d| u_d per unit mass is that of equal work (Lorentz):
f = <a n u^2 + b n^2 |u|^3> / (omega <u^2>), means over the block and the period.

References: Sollitt & Cross (1972) Proc. 13th ICCE, 1827-1846; Madsen (1974) J. Waterways Harbors Coast. Eng. 100,
319-328; Dalrymple, Losada & Martin (1991) J. Fluid Mech. 224, 625-644.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle.analysis.errors import AnalysisError
from houle.waves.dispersion import GRAVITY

BEYOND = 1.2  # Im(x c), over the largest root wanted, from which on the roots are near the poles of tanh

Complex = NDArray[Any]
Real = NDArray[np.float64]


@dataclass(frozen=True)
class Scatter:
    """Reflected and transmitted complex amplitudes at the faces, over the incident one, and the linear friction f.

    Behind a wall `transmitted` is 0. `velocity` is the rms of the pore velocity in the block [m/s] for the height that
    was given (Lorentz), NaN if the friction was.
    """

    reflected: complex
    transmitted: complex
    friction: float
    velocity: float = float("nan")

    @property
    def C_R(self) -> float:
        return abs(self.reflected)

    @property
    def C_T(self) -> float:
        return abs(self.transmitted)

    @property
    def C_D(self) -> float:
        return 1.0 - self.C_R**2 - self.C_T**2


def vertical_modes(omega: float, depth: float, c: complex, number: int, gravity: float = GRAVITY) -> Complex:
    """The roots K (number,) [rad/m] of omega^2 c = g K tanh(K h) with the least Im K, none missed, none twice.

    cosh(K (z + h)) obeys Y'' = K^2 Y, Y'(-h) = 0, h Y'(0) = x c Y(0), x = omega^2 h / g. In Legendre polynomials P_2j
    of s = 1 + z / h (even: the bottom is met by itself) the weak form is a diagonal mass 1 / (4 j + 1), the stiffness
    m (2 m + 1), m = min(i, j), in closed form, and x c times a matrix of ones: its eigenvalues are (K h)^2. Three
    times as many polynomials as modes are taken, and each root is polished by Newton to rounding.

    The matrix grows with x |c|. Where friction is so large that Im(x c) lies beyond all the roots wanted, these are
    near the poles of tanh, K h = i pi (m - 1/2) + artanh(K h / (x c)), and this iteration contracts by 1 / |x c|.
    """
    x = omega**2 * depth / gravity
    if (x * c).imag > BEYOND * np.pi * number:
        return _near_poles(x * c, number) / depth
    size = 3 * number + 20 + int(3 * x * abs(c))
    j = np.arange(size)
    m = np.minimum(j[:, None], j[None, :])
    matrix = (x * c - m * (2.0 * m + 1.0)) * (4.0 * j + 1.0)[:, None]
    y = np.sqrt(np.linalg.eigvals(matrix).astype(complex))
    y = np.where((y.imag < -1e-9 * abs(y)) | ((abs(y.imag) <= 1e-9 * abs(y)) & (y.real < 0)), -y, y)
    y = y[np.argsort(y.imag, kind="stable")][:number]
    for _ in range(20):
        t = np.tanh(y)
        step = (y * t - x * c) / (t + y * (1.0 - t * t))
        y = y - step
        if np.max(abs(step) / abs(y)) < 1e-15:
            break
    apart = abs(y[:, None] - y[None, :]) + np.eye(number) * 9.0
    if not np.all(np.isfinite(y)) or apart.min() < 1e-6:
        raise AnalysisError(f"the dispersion relation has a double root at omega = {omega:g} rad/s, S + i f = {c:g}")
    return y / depth


def _near_poles(xc: complex, number: int) -> Complex:
    """The first roots of y tanh(y) = x c for a large Im(x c)."""
    poles = 1j * np.pi * (np.arange(number) + 0.5)
    y = poles
    for _ in range(30):
        last, y = y, poles + np.arctanh(y / xc)
        if np.max(abs(y - last) / abs(y)) < 1e-15:
            break
    return y


@dataclass(frozen=True)
class _Region:
    """Vertical modes of water and pores, their overlaps <Z_q, Y_m> and norms; surface value 1."""

    depth: float
    c: complex
    water: Complex
    pores: Complex
    overlap: Complex
    water_norm: Complex
    pores_norm: Complex


def _region(omega: float, depth: float, c: complex, modes: int, gravity: float) -> _Region:
    k = vertical_modes(omega, depth, 1.0 + 0j, modes, gravity)
    K = k if c == 1 else vertical_modes(omega, depth, c, modes, gravity)
    deep = omega**2 / gravity  # = k tanh(k h); that of the pores is c times it: tanh itself is lost near its poles
    difference = k[:, None] ** 2 - K[None, :] ** 2
    same = abs(difference) < 1e-9 * abs(k[:, None] ** 2)
    overlap = np.where(same, _norm(k, deep, depth)[:, None], deep * (1.0 - c) / np.where(same, 1.0, difference))
    return _Region(depth, c, k, K, overlap, _norm(k, deep, depth), _norm(K, c * deep, depth))


def _norm(K: Complex, product: complex, h: float) -> Complex:
    """Integral over the depth of (cosh(K (z + h)) / cosh(K h))^2, where K tanh(K h) = product."""
    t = product / K
    return 0.5 * (h * (1.0 - t * t) + t / K)


def _half(r: _Region, porosity: float, length: float, wall: bool) -> tuple[Complex, Complex]:
    """Incident wave of surface potential 1 on a block that ends at x = length with no flow (wall) or no pressure.

    Returns the amplitudes R (M,) of the water modes exp(-i k x) and P (M,) of the pore modes, which are
    cos(K (x - length)) / cos(K length) behind a wall, sin(K (length - x)) / sin(K length) else: 1 at the face.
    """
    tangent = np.tan(r.pores * length)
    slope = r.pores * (tangent if wall else -1.0 / tangent)  # d/dx of the pore modes at x = 0
    incident = np.zeros(len(r.water), complex)
    incident[0] = 1.0
    flow = 1j * r.water
    # pressure on Z_q: Z_q norm (incident + R) = c overlap P; discharge on Y_m: overlap^T flow (incident - R) = n slope
    # norm P
    to_reflected = r.c * r.overlap / r.water_norm[:, None]
    matrix = np.diag(porosity * slope * r.pores_norm) + r.overlap.T @ (flow[:, None] * to_reflected)
    pores = np.linalg.solve(matrix, 2.0 * (r.overlap.T @ (flow * incident)))
    return to_reflected @ pores - incident, pores


def porous_block(
    omega: float,
    depth: float,
    width: float,
    porosity: float,
    friction: float,
    *,
    inertia: float = 1.0,
    wall: bool = False,
    modes: int = 30,
    gravity: float = GRAVITY,
) -> Scatter:
    """Eigenfunction solution for a block of a width [m] with linear friction f; `wall`: impermeable behind it.

    omega [rad/s], depth [m], inertia S = C_r. Converged to some 1e-4 with 30 modes. Raises AnalysisError.
    """
    _check(omega, depth, width, porosity, friction, inertia)
    region = _region(omega, depth, complex(inertia, friction), modes, gravity)
    behind_wall, _ = _half(region, porosity, width if wall else 0.5 * width, True)
    if wall:
        return Scatter(complex(behind_wall[0]), 0j, friction)
    no_pressure, _ = _half(region, porosity, 0.5 * width, False)
    reflected, transmitted = behind_wall[0] + no_pressure[0], behind_wall[0] - no_pressure[0]
    return Scatter(complex(0.5 * reflected), complex(0.5 * transmitted), friction)


def pore_velocity(
    omega: float,
    depth: float,
    width: float,
    porosity: float,
    friction: float,
    *,
    inertia: float = 1.0,
    wall: bool = False,
    modes: int = 30,
    points: tuple[int, int] = (41, 21),
    gravity: float = GRAVITY,
) -> tuple[Complex, Complex, Real]:
    """u_x, u_z (nx, nz) in the block for an incident wave of surface potential 1 m2/s, and the weights (nx, nz) [m2].

    The points are those of Gauss-Legendre: the velocity is singular (integrably) at the corners.
    """
    _check(omega, depth, width, porosity, friction, inertia)
    region = _region(omega, depth, complex(inertia, friction), modes, gravity)
    return _field(region, porosity, width, wall, points)


def _field(r: _Region, porosity: float, width: float, wall: bool, points: tuple[int, int]) -> Any:
    """u_x, u_z and weights of pore_velocity() for these modes."""
    gx, wx = np.polynomial.legendre.leggauss(points[0])
    gz, wz = np.polynomial.legendre.leggauss(points[1])
    x, s = 0.5 * width * (gx + 1.0), 0.5 * r.depth * (gz + 1.0)  # s: height above the bottom
    K = r.pores[:, None]
    if wall:
        _, P = _half(r, porosity, width, True)
        along, change = _hyperbolic(K, x - width, width, True)
        along, change = P[:, None] * along, P[:, None] * change
    else:
        half = 0.5 * width
        (_, even), (_, odd) = _half(r, porosity, half, True), _half(r, porosity, half, False)
        (a, da), (b, db) = _hyperbolic(K, x - half, half, True), _hyperbolic(K, x - half, half, False)
        along, change = (0.5 * (even[:, None] * p + odd[:, None] * q) for p, q in ((a, b), (da, db)))
    # cosh(K s) / cosh(K h), free of overflow
    grow, fall, bottom = np.exp(K * (s - r.depth)), np.exp(-K * (s + r.depth)), 1.0 + np.exp(-2.0 * K * r.depth)
    cosh, sinh = (grow + fall) / bottom, (grow - fall) / bottom
    ux = np.einsum("mx,mz->xz", change, cosh)
    uz = np.einsum("mx,mz->xz", along, r.pores[:, None] * sinh)
    return ux, uz, np.outer(0.5 * width * wx, 0.5 * r.depth * wz)


def _hyperbolic(K: Complex, x: Real, length: float, even: bool) -> tuple[Complex, Complex]:
    """cos(K x) / cos(K length), or sin(-K x) / sin(K length), and its derivative; free of overflow for Im K > 0."""
    forth, back = np.exp(1j * K * (x + length)), np.exp(1j * K * (length - x))  # both decay
    sign = 1.0 if even else -1.0
    whole = 1.0 + sign * np.exp(2j * K * length)
    return (back + sign * forth) / whole, 1j * K * (sign * forth - back) / whole


def porous_block_lorentz(
    omega: float,
    depth: float,
    width: float,
    porosity: float,
    height: float,
    a: float,
    b: float,
    *,
    inertia: float = 1.0,
    wall: bool = False,
    modes: int = 15,
    gravity: float = GRAVITY,
) -> Scatter:
    """Solution for the drag a u_d + b |u_d| u_d (a [1/s], b [1/m]) and an incident wave of a height [m].

    The linear friction f does the work of the drag (Lorentz); it is iterated until f is steady to 1e-7. Raises
    AnalysisError.
    """
    if not (height > 0 and a >= 0 and b >= 0):
        raise AnalysisError(
            f"height = {height:g} m, a = {a:g} 1/s, b = {b:g} 1/m: height > 0, a >= 0, b >= 0 are needed"
        )
    f, amplitude = max(1.0, a / omega), 0.5 * height * gravity / omega
    phases = np.exp(-2j * np.pi * np.arange(32) / 32)[:, None, None]
    _check(omega, depth, width, porosity, f, inertia)
    for _ in range(100):
        region = _region(omega, depth, complex(inertia, f), modes, gravity)
        ux, uz, weight = _field(region, porosity, width, wall, (41, 21))
        square = amplitude**2 * ((ux * phases).real ** 2 + (uz * phases).real ** 2).reshape(32, -1)
        second, third = (np.mean(power @ weight.ravel()) for power in (square, square**1.5))
        new = float((porosity * a + porosity**2 * b * third / second) / omega)
        if abs(new - f) <= 1e-7 * max(new, 1e-12):
            result = porous_block(
                omega, depth, width, porosity, new, inertia=inertia, wall=wall, modes=modes, gravity=gravity
            )
            return Scatter(result.reflected, result.transmitted, new, float(np.sqrt(second / weight.sum())))
        f = 0.5 * (f + new)
    raise AnalysisError(f"the Lorentz friction did not settle: f = {f:g} and then {new:g}")


def long_wave(
    omega: float,
    depth: float,
    width: float,
    porosity: float,
    friction: float,
    *,
    inertia: float = 1.0,
    wall: bool = False,
    gravity: float = GRAVITY,
) -> Scatter:
    """Solution for k h << 1 (Madsen 1974): eps = n / sqrt(S + i f), K = omega sqrt((S + i f) / (g h))."""
    _check(omega, depth, width, porosity, friction, inertia)
    root = np.sqrt(complex(inertia, friction))
    eps, K = porosity / root, omega / np.sqrt(gravity * depth) * root
    if wall:
        admittance = -1j * eps * np.tan(K * width)
        return Scatter(complex((1.0 - admittance) / (1.0 + admittance)), 0j, friction)
    e2 = np.exp(2j * K * width)  # decays
    below = (1.0 + eps) ** 2 - (1.0 - eps) ** 2 * e2
    reflected = (1.0 - eps**2) * (1.0 - e2) / below
    return Scatter(complex(reflected), complex(4.0 * eps * np.exp(1j * K * width) / below), friction)


def _check(omega: float, depth: float, width: float, porosity: float, friction: float, inertia: float) -> None:
    given = {"omega": omega, "depth": depth, "width": width, "inertia": inertia}
    for name, value in given.items():
        if not value > 0:
            raise AnalysisError(f"{name} = {value:g} must be > 0")
    if not (0 < porosity <= 1 and friction >= 0):
        raise AnalysisError(
            f"porosity = {porosity:g}, friction = {friction:g}: 0 < porosity <= 1, friction >= 0 are needed"
        )
