"""Resistance of porous bodies: one function per published law, all giving the canonical pair a [1/s], b [1/m].

The drag per unit mass of water is a u_d + b |u_d| u_d with the Darcy velocity u_d = n u. Every law has its own powers
of the porosity n: coefficients may not be carried from one law to another. To add a law, write a function like
`ergun_1952`, whose docstring begins with the formula, and a row of LAWS below with its coefficients, citation and
range: the case file, `houle describe` and the tests find it there. A case file may ask for n = 1: where the formula
divides by 1 - n, the function returns (0, 0) there, as `huang_2003` does. READ means that the formula was checked in
the named source or in a code that implements it; RECALLED that it is written from memory of the literature and should
be compared with the paper before it is trusted.

In oscillating flow of period T, b grows by the factor (1 + 7.5/KC) with the Keulegan-Carpenter number
KC = |u_d| T/(n d). If KC is taken from the local velocity, this share of b |u_d| u_d is linear in u_d and does not
depend on the grain: it is 7.5 beta (1-n)/(n^2 T), a part of a. So a law needs the period and no iteration. Taken from
the amplitude U of the velocity instead, the share b 7.5 n d/(U T) |u_d| u_d does 8/(3 pi) of the work. Section 2 of
docs/theory.md, (6) and (6b).

Comparison of the formulations: Dusterhoft-Wriggers, Larese, Onate & Rung (arXiv 2106.13267): the differences stay small
for most applications, in particular for a porous Reynolds number u_d d50 / nu below 5000.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, sqrt

from houle.registry import Choices

Pair = tuple[float, float]


def to_and_fro(n: float, beta: float, period: float) -> float:
    """Part of a [1/s] that the factor (1 + 7.5/KC) makes, with the local KC = |u_d| T/(n d): 7.5 beta (1-n)/(n^2 T)."""
    return 7.5 * beta * (1 - n) / (n**2 * period)


def van_gent_1995(
    n: float, d: float, nu: float, alpha: float, beta: float, kc: float = inf, period: float = inf
) -> Pair:
    """a = alpha (1-n)^2/n^3 nu/d^2,  b = beta (1 + 7.5/KC) (1-n)/n^3 / d. KC = u T/(n d), infinite in steady flow.

    With the period T instead of kc: a = alpha (1-n)^2/n^3 nu/d^2 + 7.5 beta (1-n)/(n^2 T), b = beta (1-n)/n^3 / d.
    """
    a, b = alpha * (1 - n) ** 2 / n**3 * nu / d**2, beta * (1 + 7.5 / kc) * (1 - n) / n**3 / d
    return a + to_and_fro(n, beta, period), b


def liu_1999(n: float, d: float, nu: float, alpha: float, beta: float, kc: float = inf, period: float = inf) -> Pair:
    """a = alpha (1-n)^2/n^3 nu/d^2 + 7.5 beta (1-n)/(n^2 T),  b = beta (1-n)/n^3 / d, T = max(1 s, period).

    With kc it is van Gent's formula. The codes of the authors take KC as at 0.01 m/s where the water is slower; there
    the drag of this formula is the larger one.
    """
    return van_gent_1995(n, d, nu, alpha, beta, kc, max(1.0, period))


def engelund_1953(n: float, d: float, nu: float, alpha: float, beta: float) -> Pair:
    """a = alpha (1-n)^3/n^2 nu/d^2,  b = beta (1-n)/n^3 / d."""
    return alpha * (1 - n) ** 3 / n**2 * nu / d**2, beta * (1 - n) / n**3 / d


def olaflow(n: float, d: float, nu: float, alpha: float, beta: float, kc: float = inf, period: float = inf) -> Pair:
    """a = alpha (1-n)^3/n^3 nu/d^2 (the cube is olaFlow's own),  b = beta (1 + 7.5/KC) (1-n)/n^3 / d.

    With the period T instead of kc: a grows by 7.5 beta (1-n)/(n^2 T), b is without KC.
    """
    a, b = alpha * (1 - n) ** 3 / n**3 * nu / d**2, beta * (1 + 7.5 / kc) * (1 - n) / n**3 / d
    return a + to_and_fro(n, beta, period), b


def ergun_1952(n: float, d: float, nu: float, alpha: float, beta: float) -> Pair:
    """a = alpha (1-n)^2/n^3 nu/d^2,  b = beta (1-n)/n^3 / d."""
    return alpha * (1 - n) ** 2 / n**3 * nu / d**2, beta * (1 - n) / n**3 / d


def huang_2003(n: float, d: float, nu: float) -> Pair:
    """K_p = 1.643e-7 (d/10 mm)^1.57 n^3/(1-n)^2 [m2],  C_f = 100 [d sqrt(n/K_p)]^-1.5, see from_permeability."""
    if n == 1:
        return 0.0, 0.0
    permeability = 1.643e-7 * (d / 0.010) ** 1.57 * n**3 / (1 - n) ** 2
    forchheimer = 100 * (d * sqrt(n / permeability)) ** -1.5
    return from_permeability(permeability, forchheimer, nu)


def from_permeability(permeability: float, forchheimer: float, nu: float) -> Pair:
    """a = nu/K_p, b = C_f/sqrt(K_p), from a permeability K_p [m2] and a Forchheimer coefficient C_f [-]."""
    return nu / permeability, forchheimer / sqrt(permeability)


def inertia_coefficient(n: float, added_mass: float = 0.34) -> float:
    """C_r = 1 + gamma (1-n)/n. gamma = 0.34: van Gent 1995 (READ in waves2Foam and MONGOOSE)."""
    return 1 + added_mass * (1 - n) / n


@dataclass(frozen=True)
class Law:
    """A formula with the coefficients that its authors published and the range in which they measured.

    name          name in the case file
    formula       (n, d, nu, **coefficients) -> (a [1/s], b [1/m]), grain diameter d [m], kinematic viscosity nu [m2/s]
    coefficients  name -> published value; inf for kc and period means steady flow
    porosity, diameter [m], reynolds (u_d d/nu)    ranges of the experiments behind it
    status        READ or RECALLED, see the top of the module
    note          what a user of the law should know besides
    """

    name: str
    formula: Callable[..., Pair]
    coefficients: dict[str, float]
    source: str
    status: str
    porosity: Pair = (0.0, 1.0)
    diameter: Pair = (0.0, inf)
    reynolds: Pair = (0.0, inf)
    note: str = ""

    @property
    def what(self) -> str:
        """The formula as one line: the head of the function's docstring."""
        return (self.formula.__doc__ or "").strip().split("\n\n")[0]

    @property
    def range(self) -> str:
        """The porosities, grain diameters [m] and Reynolds numbers of the experiments behind it; "" where unknown."""
        spans = (
            ("n", self.porosity, (0.0, 1.0)),
            ("d", self.diameter, (0.0, inf)),
            ("u_d d/nu", self.reynolds, (0.0, inf)),
        )
        return ", ".join(f"{w} {low:g}-{high:g}" for w, (low, high), all_of_it in spans if (low, high) != all_of_it)

    @property
    def knows_period(self) -> bool:
        """True for a law that resists more in oscillating flow."""
        return "period" in self.coefficients

    def taken(self, **given: float) -> dict[str, float]:
        """The coefficients: the published ones, except those given; a period that is given replaces kc."""
        known = {**self.coefficients, **given}
        return {**known, "kc": inf} if known.get("period", inf) < inf and "kc" not in given else known

    def __call__(self, n: float, d: float, nu: float, **given: float) -> Pair:
        """The pair a [1/s], b [1/m] for porosity n, grain diameter d [m], kinematic viscosity nu [m2/s]."""
        return self.formula(n, d, nu, **self.taken(**given))


LAWS: Choices[Law] = Choices(
    "resistance law",
    (
        Law(
            "van-gent-1995",
            van_gent_1995,
            {"alpha": 1000.0, "beta": 1.1, "kc": inf, "period": inf},
            "van Gent (1995), Wave interaction with permeable coastal structures, PhD thesis, TU Delft",
            "formula READ in waves2Foam vanGent1995.C; alpha, beta and the range RECALLED",
            porosity=(0.36, 0.50),
            diameter=(0.01, 0.07),
        ),
        Law(
            "jensen-2014",
            van_gent_1995,
            {"alpha": 500.0, "beta": 2.0, "kc": 128.0, "period": inf},
            "Jensen, Jacobsen & Christensen (2014), Coastal Engineering 84; calibrated on Liu et al. (1999)",
            "READ in waves2Foam and the OpenFOAM tutorials; range: the calibration",
            porosity=(0.39, 0.53),
            diameter=(0.003, 0.0159),
            note="kc = 128 is that of the dam break of the calibration: under waves the period stands in its place.",
        ),
        Law(
            "liu-1999",
            liu_1999,
            {"alpha": 200.0, "beta": 1.1, "kc": inf, "period": inf},
            "Liu, Lin, Chang & Sakakiyama (1999), J. Waterway, Port, Coastal and Ocean Eng. 125(6)",
            "READ in the MONGOOSE code of the COBRAS lineage; range: the experiment",
            porosity=(0.39, 0.49),
            diameter=(0.003, 0.0159),
            note="The authors' codes take KC locally, max(|u_d|, 0.01 m/s) max(1 s, T)/(n d50), with T = 1 s in a dam "
            "break: give period = 1 for that. Or one number for all: kc (0.1 m/s in the crushed rock is kc = 12.8).",
        ),
        Law(
            "engelund-1953",
            engelund_1953,
            {"alpha": 1000.0, "beta": 2.8},
            "Engelund (1953), On the laminar and turbulent flows of ground water, Trans. Danish Acad. Techn. Sci. 3(4)",
            "formula READ in waves2Foam engelund1953.C; alpha (780-1500), beta (1.8-3.6) and the range RECALLED",
            porosity=(0.30, 0.50),
        ),
        Law(
            "ergun-1952",
            ergun_1952,
            {"alpha": 150.0, "beta": 1.75},
            "Ergun (1952), Fluid flow through packed columns, Chem. Eng. Progress 48",
            "RECALLED (textbook form and range; packed spheres and granules)",
            porosity=(0.35, 0.55),
            reynolds=(0.0, 2500.0),
        ),
        Law(
            "olaflow",
            olaflow,
            {"alpha": 50.0, "beta": 2.0, "kc": inf, "period": inf},
            "Higuera, Lara & Losada (2014), Coastal Engineering 83; olaFlow",
            "READ in olaFlow UEqn.H (note its cube of 1-n: coefficients of van Gent's form do not fit here)",
            note="olaFlow itself takes C_r = 1 + 0.34, without (1-n)/n: added_mass = 0.34 n/(1-n) gives the same.",
        ),
        Law(
            "huang-2003",
            huang_2003,
            {},
            "Huang, Chang & Hwang (2003), Coastal Engineering 49; used by Shao (2010), Coastal Engineering 57",
            "RECALLED and doubtful: three times Ergun's drag in the rock of Liu et al. (1999), and b grows with the "
            "porosity. Read the paper before using it.",
            porosity=(0.3, 0.5),
        ),
    ),
)


def steady_velocity(a: float, b: float, gradient: float, gravity: float = 9.81) -> float:
    """Darcy velocity u [m/s] of steady flow under the hydraulic gradient i [-]: a u + b u^2 = g i; inf without drag."""
    drive = gravity * gradient
    if a == 0 and b == 0:
        return inf
    return 2 * drive / (a + sqrt(a * a + 4 * b * drive))  # the stable root, also for b = 0
