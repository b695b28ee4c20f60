"""Remeshing: the particles are replaced by new ones on a regular lattice, two per cell and axis.

Advection brings particles together along some directions and apart along others; every N steps their water is handed
to the nodes of a lattice with the M4' weights of the paper, eqs (6)-(7) (Monaghan 1985, J. Comput. Phys. 60, 253;
Chaniotis, Poulikakos & Koumoutsakos 2002, J. Comput. Phys. 182, 67). The two schemes differ where a particle does not
see all the nodes around it, that is at the free surface and at porous interfaces.

To add a remesher copy the shortest class, change its `__call__` and add a line to `STRATEGIES`. When particles are
remeshed, and what happens around it, is in remeshing_schedule.py.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.errors import SimulationError
from houle.flow.particles import Particles
from houle.grid import FloatArray, Grid
from houle.medium.interfaces import Interfaces
from houle.medium.medium import Medium
from houle.medium.solids import Outline

Nodes = tuple[int, int]
EVERYWHERE: Nodes = (0, -1)


class Remesher(Protocol):
    """What replaces the particles of a flow by others that are in order.

    with_water: a remesher that makes the same particles, and hands on whatever stands in the place of the velocities as
    it hands on volume (`handed_on`).
    """

    @property
    def with_water(self) -> Remesher: ...

    def __call__(
        self,
        particles: Particles,
        porosity: FloatArray | None,
        between: Nodes = EVERYWHERE,
        gates: FloatArray | None = None,
    ) -> Particles:
        """New particles with the columns of the old ones, those declared holding the values of new particles.

        porosity  at the particles (N,); None where it is 1 everywhere
        between   first node and end of the nodes along x, where walls stand that are not the sides of the tank
        gates     (K, 2) x of the face of each and height of its lower edge, on a grid line [m]; None: there are none
        """
        ...


def handed_on(remesher: Remesher, old: Particles, values: FloatArray, *where: Any) -> FloatArray:
    """What goes with the water: values (N, *shape) of the old particles, per volume, at the new ones (M, *shape).

    where: all that the remesher takes besides the particles. The sum of volume times value is conserved as that of
    volume is: by "conservative" to round-off.
    """
    flat, d = values.reshape(len(old), -1), old.position.shape[1]
    handed = []
    for first in range(0, flat.shape[1], d):  # d numbers at a time, in the place of the velocities
        carried = np.zeros_like(old.position)
        part = flat[:, first : first + d]
        carried[:, : part.shape[1]] = part
        new = remesher.with_water(Particles(old.position, carried, old.volume), *where)
        handed.append(new.velocity[:, : part.shape[1]])
    return np.concatenate(handed, axis=1).reshape(-1, *values.shape[1:])


@dataclass(frozen=True)
class Conservative:
    """Volume, momentum and centre of volume conserved, up to the surface and across porous interfaces.

    porosity: of the cells, as Medium.listed gives it, None: 1; body: of the half cells, negative in solids
    (Medium.body). Between the centres of the cells the porosity is linear; where it varies the nodes around a particle
    receive in proportion to that of their half cells, so that water which fills the pores goes on filling them.
    outline: of the solids, None: none. interfaces: along which each side hands on its own velocity (docs/theory.md,
    section 8); with_water: the same remeshing for what goes with the water itself.

    Conserved to round-off, whatever the particles: sum V, sum V u_d and sum V x, so the potential energy; what would
    have left the tank or entered a solid is made good by those around it. Around a periodic axis x is known up to its
    length. The true momentum sum V u_d / n is conserved as far as n is the same for all. Gates are walls: what was on
    one side of one that is shut stays there, each side by itself conserves all this. A particle whose water would reach
    above the lower edge of a raised one gives to its own side.

    Kinetic energy: noise is filtered, and particles that drifted in a wave for a period lose some 1e-5 of it. Second
    moments of momentum are not those of energy, though: on particles shaken by 0.3 spacings a velocity gradient leaves
    some noise behind, +2e-3 of the energy of a wave 24 dx long, falling with the square of its length.

    Particles within a spacing or two of the surface, of an interface or a wall end up slightly off the lattice: there
    sits the centre of the water they got. Spray away from any water is left as it is.
    """

    grid: Grid
    porosity: tuple[NDArray[np.int32], FloatArray] | None
    body: NDArray[np.int8]
    outline: Outline | None = None
    interfaces: Interfaces | None = None
    along: bool = True

    @property
    def with_water(self) -> Conservative:
        """The same remeshing without sides: what goes with the water is handed across interfaces as volume is."""
        return replace(self, along=False)

    @classmethod
    def of(cls, grid: Grid, medium: Medium) -> Conservative:
        porosity = medium.listed("particle_porosity") if medium.bodies else None
        return cls(grid, porosity, medium.body, medium.outline, medium.interfaces)

    def __call__(
        self,
        particles: Particles,
        porosity: FloatArray | None,
        between: Nodes = EVERYWHERE,
        gates: FloatArray | None = None,
    ) -> Particles:
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
class Paper:
    """A full particle, V = n h^d, on every node filled to more than the threshold: paper eqs (6)-(7).

    With V_j inside the sum of (6) and the tensor product of the 1-D weights (7), without which constants are not
    reproduced. Raises the surface by up to a lattice spacing each time, and so the volume: the offset that the paper
    reports in its section 5.1. There to be compared with, not to be used.
    """

    grid: Grid
    threshold: float = 0.01
    outline: Outline | None = None

    @property
    def with_water(self) -> Paper:
        """Itself: it hands on momentum as it hands on volume."""
        return self

    def __call__(
        self,
        particles: Particles,
        porosity: FloatArray | None,
        between: Nodes = EVERYWHERE,
        gates: FloatArray | None = None,
    ) -> Particles:
        core = self.grid.core
        new = _made_anew(_core.remesh_paper, (core,), particles, (porosity, self.threshold, gates))
        _core.leave_solids(core, self.outline, new.position)
        return new


def _made_anew(
    scheme: Callable[..., tuple[FloatArray, FloatArray, FloatArray]],
    tank: tuple[Any, ...],
    old: Particles,
    others: tuple[Any, ...],
) -> Particles:
    """The particles of a remeshing of the core, `scheme(*tank, position, velocity, volume, *others)`.

    SimulationError where it refuses the old ones, because they hold what is not a number.
    """
    arguments = (*tank, old.position, old.velocity, old.volume, *others)
    try:
        new = scheme(*(np.ascontiguousarray(a) if isinstance(a, np.ndarray) else a for a in arguments))
        return old.replaced(*new)
    except FloatingPointError as error:
        raise SimulationError(
            str(error), diagnosis="What a particle carries became infinite or not a number in this step."
        ) from error


@dataclass(frozen=True)
class Keep:
    """No remeshing: the particles as they are, the very same object."""

    @property
    def with_water(self) -> Keep:
        """Itself."""
        return self

    def __call__(
        self,
        particles: Particles,
        porosity: FloatArray | None,
        between: Nodes = EVERYWHERE,
        gates: FloatArray | None = None,
    ) -> Particles:
        return particles


# name in the case file -> remesher for a grid and what stands on it
STRATEGIES: dict[str, Callable[[Grid, Medium], Remesher]] = {
    "conservative": Conservative.of,
    "paper": lambda grid, medium: Paper(grid, outline=medium.outline),
    "none": lambda grid, medium: Keep(),
}
