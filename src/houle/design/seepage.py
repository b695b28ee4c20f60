"""Steady seepage through a rectangular dam: discharge, phreatic line and exit point, exact.

The flow is two-dimensional, by Darcy's law, between vertical faces on an impermeable base. The discharge is that of
Dupuit, though his parabola is not the phreatic line (Charny 1951). The line, and the point at which it meets the
downstream face above the water there, follow from a conformal mapping with two parameters 0 <= alpha < beta < 1
(Polubarinova-Kochina 1962, in the form of Hornung & Krueger 1985): the length of the dam, the level downstream, the
seepage face and the rest of the upstream level are integrals of the complete elliptic integral K(m), all times one
factor.

With y = cot t instead of the angle t that is found in books, and its logarithm as the variable, these integrals are
those of functions that are analytic up to arg y = pi/2 and fall off at both ends: the trapezoidal rule gives them to
rounding. The complements 1 - alpha, 1 - beta and beta - alpha are variables of their own, since long dams have a beta
that is 1 to all digits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import exp
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import root
from scipy.special import ellipkm1

from houle.design.errors import DesignError
from houle.design.formula import Answer, Input, formula, quantity

POINTS = 81  # points of the phreatic line
CLOSE = 1e-10  # relative error allowed in levels and length
STEP = 0.2  # step of log y
LOG_Y = np.arange(-345.0, 80.0, STEP)  # the integrands fall off like y below, like 1/y above
TRIED = np.linspace(-12.0, 12.0, 9)  # first guesses of the parameters

Real = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Seepage(Answer):
    """Seepage through a dam. `line` (2, 81) [m]: x from the upstream face on and height z of the phreatic line."""

    discharge: float = quantity("discharge per metre of dam", "m2/s")
    exit: float = quantity("height above the base at which the phreatic line meets the downstream face", "m")
    face: float = quantity("height of the seepage face, above the water downstream", "m")
    line: Real = field(default_factory=lambda: np.empty((2, 0)), compare=False, repr=False)


class Parameters(NamedTuple):
    """alpha and beta with their complements, each to all digits; `apart` is beta - alpha."""

    alpha: float
    beta: float
    below_alpha: float
    below_beta: float
    apart: float


@formula(
    "seepage-dam",
    "Discharge, phreatic line and exit point of a dam with vertical faces.",
    source="Dupuit, Charny (1951); Polubarinova-Kochina (1962); Hornung & Krueger (1985)",
    status="Exact; an independent program for the same integrals gives the same exit point",
    holds="Darcy's law, impermeable base, no capillary fringe",
    example={"upstream": 24.0, "downstream": 4.0, "length": 16.0, "conductivity": 1.0e-3},
)
def seepage_dam(
    *,
    upstream: Annotated[float, Input("depth of the water upstream, h1", "m", above=0)],
    downstream: Annotated[float, Input("depth of the water downstream, h2", "m", above=0)],
    length: Annotated[float, Input("length of the dam between its faces, L", "m", above=0)],
    conductivity: Annotated[float, Input("hydraulic conductivity K: g/a of a law a u", "m/s", above=0)],
) -> Seepage:
    """Seepage through a rectangular dam: q = K (h1^2 - h2^2)/(2 L), with the exact phreatic line."""
    if not downstream < upstream:
        raise DesignError(f"downstream = {downstream:g} must be below upstream = {upstream:g}: depths of the water [m]")
    p = _parameters(length / upstream, downstream / upstream)
    scale = length / _total(_length, p)
    face = scale * _total(_face, p)
    return Seepage(
        discharge=conductivity * (upstream**2 - downstream**2) / (2 * length),
        exit=downstream + face,
        face=face,
        line=_phreatic(p, scale, length, upstream),
        ratios={"L/h1": length / upstream, "h2/h1": downstream / upstream},
    )


def _parameters(length: float, level: float) -> Parameters:
    """alpha and beta of a dam with an upstream level of 1. Raises DesignError where none were found."""

    def mapped(y: Real) -> Parameters:
        a, b = (float(v) for v in np.clip(y, -300, 300))
        below_alpha, share = 1 / (1 + exp(a)), 1 / (1 + exp(b))  # share: of 1 - beta in 1 - alpha
        alpha, apart = 1 / (1 + exp(-a)), below_alpha / (1 + exp(-b))
        return Parameters(alpha, alpha + apart, below_alpha, below_alpha * share, apart)

    def missing(y: Real) -> Real:
        p = mapped(y)
        below = _total(_level, p)
        height = below + _total(_face, p) + _total(_line, p)
        ratios = (_total(_length, p) / height / length, below / height / level)
        return np.log(np.maximum(ratios, np.finfo(float).tiny))

    guesses = sorted((float(np.abs(missing(np.array([a, b]))).max()), a, b) for a in TRIED for b in TRIED)
    for _, a, b in guesses[:6]:
        found = root(missing, np.array([a, b]), tol=1e-14)
        if np.max(np.abs(missing(found.x))) < CLOSE:
            return mapped(found.x)
    raise DesignError(
        f"no phreatic line was found for L/h1 = {length:g}, h2/h1 = {level:g}: 0.05 to 10 and 0.001 to 0.9 are sure to "
        "work; the discharge K (h1^2 - h2^2)/(2 L) holds all the same"
    )


Integrand = Callable[[Real, Parameters], Real]


def _total(integrand: Integrand, p: Parameters) -> float:
    """Integral over all log y."""
    return STEP * float(integrand(np.exp(LOG_Y), p).sum())


def _length(y: Real, p: Parameters) -> Real:
    """The length of the dam, as an integral over log y."""
    part = p.below_beta + p.below_alpha * y**2
    return ellipkm1(part / (1 + y**2)) * y / (np.sqrt(part) * np.sqrt(1 + y**2))


def _level(y: Real, p: Parameters) -> Real:
    """The level downstream."""
    part = np.sqrt(1 + y**2) * np.sqrt(p.below_alpha + y**2) * np.sqrt(p.apart + p.beta * y**2)
    return np.sqrt(p.alpha) * ellipkm1((p.below_alpha + y**2) / (1 + y**2)) * y / part


def _face(y: Real, p: Parameters) -> Real:
    """The height of the seepage face."""
    part = np.sqrt(p.alpha + y**2) * np.sqrt(p.beta + y**2)
    return ellipkm1(1 / (1 + y**2)) * y**2 / (1 + y**2) / part


def _line(y: Real, p: Parameters) -> Real:
    """The height of the phreatic line above the exit point."""
    return ellipkm1(1 / (1 + y**2)) * _along(y, p)


def _run(y: Real, p: Parameters) -> Real:
    """The distance of the phreatic line from the downstream face."""
    return ellipkm1(y**2 / (1 + y**2)) * _along(y, p)


def _along(y: Real, p: Parameters) -> Real:
    """The common factor of rise and run; roots are taken one by one, lest a product is smaller than any number."""
    return y / (np.sqrt(1 + y**2) * np.sqrt(p.below_alpha + y**2) * np.sqrt(p.below_beta + y**2))


def _phreatic(p: Parameters, scale: float, length: float, upstream: float) -> Real:
    """Points (2, POINTS) of the phreatic line, from the upstream face to the exit, about evenly in x."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    y = np.exp(LOG_Y[:-1, None] + STEP * (nodes + 1) / 2)
    panels = [scale * STEP / 2 * (integrand(y, p) @ weights) for integrand in (_run, _line)]
    x, fall = (np.concatenate([[0.0], np.cumsum(panel)]) for panel in panels)  # from the upstream face on: y rises
    at = np.interp(np.linspace(0.0, length, POINTS), x, LOG_Y)
    line = np.array([CubicSpline(LOG_Y, x)(at), upstream - CubicSpline(LOG_Y, fall)(at)])
    line[:, 0] = 0.0, upstream
    line[:, -1] = length, upstream - fall[-1]
    return line
