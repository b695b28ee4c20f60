"""The kernels of the transfers: the weights with which particles and nodes of the grid see each other.

The weights themselves are in the core (grid/kernels.hpp). To add a kernel, write its weights there, name it in the
dispatch of bind/transfer.cpp, and add a row here.
"""

from __future__ import annotations

from dataclasses import dataclass

from houle.registry import Choices

PAPER = "Ramos Ortega, Beaudoin & Huberson (2020), 17emes Journees de l'Hydrodynamique (JH2020)"


@dataclass(frozen=True)
class Kernel:
    """A kernel as the case file, `houle describe` and the transfers know it.

    nodes     number of nodes that it reaches on each side of a particle, along each axis
    negative  whether some of its weights are negative
    sized     whether it depends on the size of the particle: a square with the side (V/n)^(1/d)
    """

    name: str
    what: str
    source: str
    range: str = ""
    nodes: int = 2
    negative: bool = False
    sized: bool = False


KERNELS = Choices(
    "kernel",
    (
        Kernel("linear", "Tent over two nodes per axis.", "Harlow's cloud in cell; Brackbill & Ruppel (1986)", nodes=1),
        Kernel(
            "quadratic",
            "Quadratic B-spline over three nodes per axis, smooth first derivative.",
            "Steffen, Kirby & Berzins (2008)",
        ),
        Kernel(
            "m4prime",
            "Monaghan's M'4 as a tensor product over four nodes per axis: third order, has negative lobes.",
            "Monaghan (1985), J. Comput. Phys. 60; Cottet & Koumoutsakos (2000)",
            range="not with transfer fmpm, whose terms do not converge with negative weights",
            negative=True,
        ),
        Kernel("gaussian", "Gaussian at the particle's centre.", f"{PAPER}, (8)", sized=True),
        Kernel(
            "gaussian-taylor2",
            "Gaussian with the second moments of the particle's own square, of side dx/n^(1/d), by a Taylor series; "
            "one wider than 1.7 cells counts as one of 1.7, beyond which the series has negative weights.",
            f"{PAPER}, (8)-(11); after Beaudoin, Huberson & Rivoalen (2003)",
            sized=True,
        ),
        Kernel(
            "gaussian-cell",
            "Gaussian integrated exactly over the particle's own square: a difference of error functions per axis, "
            "what the Taylor series approaches.",
            "docs/theory.md",
            sized=True,
        ),
    ),
)
