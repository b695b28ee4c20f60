"""Remeshers: they replace the particles of a flow by new ones on a regular lattice, two per cell and axis.

Advection brings particles together along some directions and apart along others. From time to time their water is
given to the nodes of the lattice, with the M4' weights of the paper, eqs (6)-(7); each node that gets water becomes a
new particle. The remeshers differ where a particle does not see all the nodes around it, that is at the free surface,
at solids and at porous interfaces.

To add a remesher copy the shortest class, change its row and its `__call__`, and add it to `REMESHERS` at the bottom.
remeshing_schedule.py decides when particles are remeshed.

References: Monaghan 1985, J. Comput. Phys. 60, 253 (M4'); Chaniotis, Poulikakos & Koumoutsakos 2002, J. Comput. Phys.
182, 67 (remeshing); Cottet & Koumoutsakos 2000, Vortex Methods (both).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.errors import SimulationError
from houle.flow.particles import EVERYWHERE, Nodes, Particles
from houle.grid import FloatArray, Grid
from houle.medium.interfaces import Interfaces
from houle.medium.medium import Medium
from houle.medium.solids import Outline
from houle.registry import Choices


class Remesher:
    """Base of the remeshers. `name` is that in the case file; `what`, `source` and `range` are for `houle describe`.

    travel     cells by which some water must have moved on before a remeshing is worth it
    conserves  whether the volume of the water is conserved to round-off
    """

    name: ClassVar[str]
    what: ClassVar[str]
    source: ClassVar[str]
    range: ClassVar[str] = ""
    travel: ClassVar[float] = 0.5
    conserves: ClassVar[bool] = True

    @classmethod
    def of(cls, grid: Grid, medium: Medium) -> Remesher:
        """The remesher for a tank with this grid and medium."""
        return cls()

    @property
    def with_water(self) -> Remesher:
        """A remesher that makes the same particles, but treats values in the place of velocities as it does volume."""
        return self

    def __call__(
        self,
        particles: Particles,
        porosity: FloatArray | None,
        between: Nodes = EVERYWHERE,
        gates: FloatArray | None = None,
    ) -> Particles:
        """New particles with the columns of the old ones; declared columns have their values for new particles.

        porosity  at the particles (N,); None where it is 1 everywhere
        between   nodes along x that may get water: those between moving walls
        gates     (K, 2) x of the face and height of the lower edge of each gate, on a grid line [m]; None: no gates
        """
        raise NotImplementedError


@dataclass(frozen=True)
class Conservative(Remesher):
    """Conserves volume, momentum and centre of volume, up to the surface and across porous interfaces.

    porosity    porosity of particles at the cell centres, as Medium.listed gives it; None: 1 everywhere
    body        number of the body that each half cell lies in (`Medium.body`), negative in solids
    outline     outline of the solids; None without solids
    interfaces  where porous media meet: along them each side keeps its own velocity (docs/theory.md, section 11)
    along       True for velocities; False for quantities that are handed across interfaces with the water itself

    Between the centres of the cells the porosity is linear; where it varies the nodes around a particle receive in
    proportion to that of their half cells, so that water which fills the pores goes on filling them.

    For any particles, sum V, sum V u_d and sum V x are conserved to round-off, and with them the potential energy. New
    particles that would lie outside the tank or in a solid are moved out, and those around them make up for it. Around
    a periodic axis x is known up to its length. The momentum sum V u_d / n is conserved where n is the same for all.
    Gates are walls: each side of a shut gate conserves all this by itself. A particle whose nodes reach above the lower
    edge of a raised gate gives to its own side only.

    Kinetic energy is not conserved exactly: noise is filtered, and particles that drifted in a wave for a period lose
    some 1e-5 of it. Conserving moments of momentum does not conserve energy: on particles shaken by 0.3 spacings a
    velocity gradient leaves some noise behind, +2e-3 of the energy of a wave 24 dx long, falling with the square of its
    length.

    Particles within a spacing or two of the surface, of an interface or of a wall end up slightly off the lattice, at
    the centre of the water that they got. Spray away from any other water is left as it is.
    """

    name = "conservative"
    what = (
        "M'4 onto the lattice where the neighbourhood is full; elsewhere to the nodes that hold water, beside porous "
        "interfaces in proportion to their porosity. Volume, momentum and height kept to round-off."
    )
    source = "docs/decisions; kernel: Monaghan (1985), Cottet & Koumoutsakos (2000)"

    grid: Grid
    porosity: tuple[NDArray[np.int32], FloatArray] | None
    body: NDArray[np.int8]
    outline: Outline | None = None
    interfaces: Interfaces | None = None
    along: bool = True

    @classmethod
    def of(cls, grid: Grid, medium: Medium) -> Conservative:
        """The remesher for a tank with these porous bodies and solids."""
        porosity = medium.listed("particle_porosity") if medium.bodies else None
        return cls(grid, porosity, medium.body, medium.outline, medium.interfaces)

    @property
    def with_water(self) -> Conservative:
        """This remesher without sides of interfaces: it hands quantities across them as it does volume."""
        return replace(self, along=False)

    def __call__(
        self,
        particles: Particles,
        porosity: FloatArray | None,
        between: Nodes = EVERYWHERE,
        gates: FloatArray | None = None,
    ) -> Particles:
        """New particles. SimulationError where the old ones hold something not finite, or are too far apart."""
        tank = (self.grid.core, self.porosity, self.body, self.outline)
        others = (porosity, *between, self.interfaces, self.along, gates)
        new = _made_anew(_core.remesh_conservative, tank, particles, others)
        if len(new) and not new.volume.min() > 0.0:
            worst = int(np.argmin(new.volume))
            raise SimulationError(
                f"remeshing left a particle with {new.volume[worst]:.3g} m{self.grid.dimension} of water",
                place=tuple(new.position[worst]),
                diagnosis="particles are NaN, or too far apart to fill the nodes between them: remesh more often",
            )
        return new


@dataclass(frozen=True)
class Paper(Remesher):
    """Puts a full particle, V = n h^d, on every node that is filled to more than `threshold`: paper, eqs (6)-(7).

    h is half the grid spacing. V_j stands inside the sum of (6), and the weights (7) are a tensor product: otherwise
    constants would not be reproduced. The surface rises by up to a lattice spacing each time, and the volume with it:
    this is the offset that the paper reports in its section 5.1. The remesher is there to be compared with, not to be
    used. It acts after every `remesh_every` steps, whether water has moved or not.
    """

    name = "paper"
    what = "New particles on every node that old ones reach, each filled: raises the free surface at every remeshing."
    source = "Ramos Ortega, Beaudoin & Huberson (2020), 17emes Journees de l'Hydrodynamique (JH2020), (6)-(7)"
    travel = 0.0
    conserves = False

    grid: Grid
    threshold: float = 0.01
    outline: Outline | None = None

    @classmethod
    def of(cls, grid: Grid, medium: Medium) -> Paper:
        """The remesher for a tank; of the medium it takes the solids alone."""
        return cls(grid, outline=medium.outline)

    def __call__(
        self,
        particles: Particles,
        porosity: FloatArray | None,
        between: Nodes = EVERYWHERE,
        gates: FloatArray | None = None,
    ) -> Particles:
        """New particles, none in a solid. SimulationError where the old ones hold something not finite."""
        core = self.grid.core
        new = _made_anew(_core.remesh_paper, (core,), particles, (porosity, self.threshold, gates))
        _core.leave_solids(core, self.outline, new.position)
        return new


class Keep(Remesher):
    """Leaves the particles as they are."""

    name = "none"
    what = "Particles are never made regular; the position correction alone keeps them apart."
    source = "-"

    def __call__(
        self,
        particles: Particles,
        porosity: FloatArray | None,
        between: Nodes = EVERYWHERE,
        gates: FloatArray | None = None,
    ) -> Particles:
        """The particles themselves."""
        return particles


def handed_on(remesher: Remesher, old: Particles, values: FloatArray, *where: Any) -> FloatArray:
    """Values (M, *shape) of the new particles of a quantity that moves with the water, from those of the old ones.

    values  (N, *shape) amounts per volume of water, as a concentration is, of the old particles
    where   everything that the remesher takes besides the particles

    The remesher conserves the sum of volume times value as it does that of volume: "conservative" to round-off.
    """
    width, d = math.prod(values.shape[1:]), old.position.shape[1]
    flat, handed = values.reshape(len(old), width), []
    for first in range(0, width, d):  # d numbers at a time, in the place of the velocities
        carried = np.zeros_like(old.position)
        part = flat[:, first : first + d]
        carried[:, : part.shape[1]] = part
        new = remesher.with_water(Particles(old.position, carried, old.volume), *where)
        handed.append(new.velocity[:, : part.shape[1]])
    return np.concatenate(handed, axis=1).reshape(-1, *values.shape[1:])


def _made_anew(
    scheme: Callable[..., tuple[FloatArray, FloatArray, FloatArray]],
    tank: tuple[Any, ...],
    old: Particles,
    others: tuple[Any, ...],
) -> Particles:
    """The particles that a function of the core makes, `scheme(*tank, position, velocity, volume, *others)`.

    SimulationError where it refuses the old ones because they hold something not finite.
    """
    arguments = (*tank, old.position, old.velocity, old.volume, *others)
    try:
        new = scheme(*(np.ascontiguousarray(a) if isinstance(a, np.ndarray) else a for a in arguments))
        return old.replaced(*new)
    except FloatingPointError as error:
        raise SimulationError(
            str(error), diagnosis="What a particle carries became infinite or not a number in this step."
        ) from error


REMESHERS: Choices[type[Remesher]] = Choices("remeshing", (Conservative, Paper, Keep))
