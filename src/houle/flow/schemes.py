"""The schemes of a time step (step.py): a name for a set of choices, any of which a case can change."""

from __future__ import annotations

from dataclasses import dataclass

from houle.flow.kernels import PAPER
from houle.registry import Choices


@dataclass(frozen=True)
class Scheme:
    """A scheme as the case file and `houle describe` know it.

    takes: the values of the other keys of [numerics] for which the name stands
    """

    name: str
    what: str
    source: str
    takes: dict[str, str | int | float]
    range: str = ""


SCHEMES = Choices(
    "scheme",
    (
        Scheme(
            "houle",
            "Particles carry the Darcy velocity and a water volume; the grid solves the pressure with p = 0 on the "
            "true surface inside the cells. The drag is implicit inside the projection, the change of porosity acts as "
            "a force on the faces, particles move with the pore velocity u_d/n. Transfer by the full mass matrix "
            "(fmpm) with the linear kernel, positions corrected towards uniform volume, remeshing that conserves "
            "volume and momentum.",
            "docs/theory.md and docs/decisions",
            {
                "transfer": "fmpm",
                "order": 4,
                "flip": 0.99,
                "kernel": "linear",
                "remesh": "conservative",
                "remesh_every": 5,
                "correction": 0.5,
                "tolerance": 1e-7,
            },
        ),
        Scheme(
            "jh2020",
            "The combination of the founding paper: second-order Taylor Gaussian as kernel with particles of size "
            "dx/n^(1/d), pressure gradient added to the particles' own velocity, M'4 remeshing as in (6)-(7) every "
            "200 steps, time stepping (12)-(17), with the corrections without which it does not hold (pore velocity "
            "in (12), (17); powers of n in (13); tensor product in (7)). Kept to quantify its defect at the free "
            "surface, not for work.",
            PAPER,
            {
                "transfer": "flip",
                "order": 1,
                "flip": 1.0,
                "kernel": "gaussian-taylor2",
                "remesh": "paper",
                "remesh_every": 200,
                "correction": 0.0,
                "tolerance": 1e-7,
            },
        ),
    ),
)
