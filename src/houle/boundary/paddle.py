"""A paddle: a vertical wall that moves along x, from floor to lid and across the tank; a wave maker or an absorber.

It stands anywhere between the faces of the grid, and cuts one column of cells. A share of the volume of this column,
and of its faces along the wall, is open to the water. The faces of the column towards the wall are closed to the
pressure and carry the flux of the wall, so that the water gives way by exactly the volume that the wall sweeps. Sums
over particles, for fill and levels, count their mirror images behind the wall as well, so that nothing is divided by
the open share. Particles are kept in front of the wall; behind it there is no water. Section 14 of docs/theory.md.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence

import numpy as np

from houle.errors import CaseError, SimulationError
from houle.flow.boundaries import Boundaries, Boundary, Row, Tank
from houle.flow.component import Component, State
from houle.flow.particles import Particles
from houle.grid import FloatArray, Grid, SingleFaces

ROOM = 3  # cells between a paddle and the sides of the tank or a gate: the mirror images need them
LEEWAY = 40  # cells in front of a paddle over which particles are shifted for a remeshing
SLIVER = 1e-6  # cells: a paddle so near to a face stands on it
THIN = 0.02  # open share of the column: a smaller one counts as this when the velocity is extrapolated over it
CLEARANCE = 1e-9  # cells between a particle and the paddle


class Command(Component):
    """The control of a paddle: tells it how far to go in each step."""

    @abstractmethod
    def way(self, tank: Tank, paddle: Paddle, dt: float) -> float:
        """Displacement of the paddle in the step of dt [s] that begins now [m], positive towards larger x."""

    def notice(self, tank: Tank, paddle: Paddle) -> None:
        """Takes notice of the pressure on the face of the paddle, when it was just found; nothing by default."""


class Paddle(Boundary):
    """A wall that moves as its command says.

    rest, x   position at rest and now [m]
    water     +1 if the water is on its right, at larger x, -1 if on its left
    way       displacement in the present step [m], 0 once it is done; velocity: the mean over the step [m/s]
    column    number along x of the column of cells that it cuts; share: the open share of that [-]
    behind    range of the columns behind it; face: number of the face of the cut column on the side of the wall
    inner     number of the other face of the cut column
    ahead     x of the nearest gate in front of it [m], None without; between: limits of its position [m]
    leeway    length in front of it over which particles are shifted for a remeshing [m]
    """

    def __init__(self, name: str, grid: Grid, rest: float, water: int, command: Command) -> None:
        self.name, self.grid, self.rest, self.water, self.command = name, grid, rest, water, command
        self.x, self.velocity = rest, 0.0
        self.way = 0.0
        self._cut()

    # ---- where it stands -----------------------------------------------------------------------------------------

    def join(self, tank: Tank, boundaries: Boundaries) -> None:
        """Removes the water behind it. Raises CaseError where something stands behind it, or too near to it."""
        h = self.grid.spacing[0]
        self._refuse(boundaries)
        gates = [x for boundary in boundaries for x, _ in boundary.gates()]
        self.ahead = min(gates, key=lambda x: self.water * x, default=None)
        low, high = ROOM * h, self.grid.size[0] - ROOM * h
        if self.ahead is not None:
            low, high = (low, self.ahead - ROOM * h) if self.water > 0 else (self.ahead + ROOM * h, high)
        self.between = low, high
        if not low <= self.rest <= high:
            raise CaseError(
                f"{self.name} at x = {self.rest:g} m needs {ROOM} cells, {ROOM * h:.3g} m, between it and the sides of "
                f"the tank and any gate, for the mirror images of the water: {low:.4g} <= x <= {high:.4g}"
            )
        p = tank.particles
        tank.particles = p.select(self.water * (p.position[:, 0] - self.x) > 0)
        self.leeway = self._clear(tank) * h

    def _refuse(self, boundaries: Boundaries) -> None:
        """Raises CaseError where another wall closes the same end of the water, or something stands behind it."""
        for other in boundaries:
            for _, water in other.images():
                if other is not self and water == self.water:
                    end = "left" if water > 0 else "right"
                    raise CaseError(f"{self.name} and {other.name} both close the water at its {end} end: remove one")
            for x in (*(x for x, _ in other.images() if other is not self), *(x for x, _ in other.gates())):
                if self.water * (x - self.rest) <= 0.0:
                    raise CaseError(f"{other.name} at x = {x:g} m is behind {self.name}, where no water is: remove one")

    def _clear(self, tank: Tank) -> int:
        """Number of cells in front of it over which particles can be shifted: 1 to `LEEWAY`.

        They end where bodies or solids change, or halfway to the end of the tank.
        """
        body = tank.medium.body.reshape(2 * self.grid.shape[0], -1)[:: self.water]
        first = round(2.0 * self.rest / self.grid.spacing[0])
        ahead = body[first:] if self.water > 0 else body[len(body) - first :]
        other = np.flatnonzero((ahead != ahead[0]).any(axis=1))
        return max(1, min(LEEWAY, (int(other[0]) if len(other) else len(ahead) // 2) // 2))

    def _cut(self) -> None:
        """Sets column, share, behind, face and inner for the place where it stands."""
        at = self.x / self.grid.spacing[0]
        if self.water > 0:
            column = int(np.floor(at + SLIVER))
            self.share = min(1.0, column + 1 - at)
            self.behind, self.face, self.inner = slice(0, column), column, column + 1
        else:
            column = int(np.ceil(at - SLIVER)) - 1
            self.share = min(1.0, at - column)
            self.behind, self.face, self.inner = slice(column + 1, None), column + 1, column
        self.column = column

    def openness(self, faces: SingleFaces) -> None:
        across, *along = faces
        across[self.behind] *= 0.0
        across[self.face] *= 0.0
        for others in along:
            others[self.behind] *= 0.0
            others[self.column] *= self.share

    def columns(self, share: FloatArray) -> None:
        share[self.behind] *= 0.0
        share[self.column] *= self.share

    def images(self) -> Sequence[Row]:
        return [(self.x, float(self.water))]

    def dry(self, tank: Tank) -> None:
        """Marks the columns behind it as dry."""
        tank.active[self.behind] = 0
        tank.eta[self.behind] = np.nan

    # ---- in the step ---------------------------------------------------------------------------------------------

    def begin(self, tank: Tank, dt: float) -> None:
        self.way = self.command.way(tank, self, dt)
        self.velocity = self.way / dt

    def feed(self, tank: Tank) -> None:
        flux = self.water * self.velocity / self.grid.spacing[0]
        tank.work.rhs[self.column] += tank.active[self.column] * flux

    def impose(self, tank: Tank) -> None:
        """Sets the velocity of the face behind the paddle by linear extrapolation from the water in front.

        So the velocity between the two faces is, at x, that of the paddle. Then lets the command read the pressure.
        """
        u, known = tank.velocity[0], tank.work.valid[0]
        lead = 1.0 / max(self.share, THIN)
        led = u[self.inner] + lead * (self.velocity - u[self.inner])
        known[self.face] = known[self.inner] == 1
        u[self.face] = np.where(known[self.face] == 1, led, self.velocity)
        self.command.notice(tank, self)

    def power(self, tank: Tank) -> float:
        flux = self.water * self.velocity * self.grid.cell_volume / self.grid.spacing[0]
        return flux * float(np.sum(tank.active[self.column] * tank.pressure[self.column]))

    def advance(self, tank: Tank) -> None:
        self.x += self.way
        self.way = 0.0
        self._cut()
        if not self.between[0] <= self.x <= self.between[1]:
            raise SimulationError(
                f"{self.name} has gone {abs(self.x - self.rest):.3g} m from where it stands at rest, "
                f"x = {self.rest:g}, to within {ROOM} cells of the side of the tank or of a gate",
                place=(self.x,),
                diagnosis="A moving wall that absorbs goes as far as the waves take it: give it more room.",
            )

    # ---- around a remeshing --------------------------------------------------------------------------------------

    def to_lattice(self, particles: Particles) -> None:
        """Shifts particles by up to a quarter of a cell at the paddle, and ever less up to `_reach` in front of it."""
        x, reach = particles.position[:, 0], self._reach
        gap = reach - np.clip(self.water * (x - self.x), 0.0, reach)
        x += (self._node_at - self.x) * gap / reach
        self._keep(x, self._node_at)

    def from_lattice(self, particles: Particles) -> None:
        x = particles.position[:, 0]
        reach = self._reach - self.water * (self._node_at - self.x)
        gap = reach - np.clip(self.water * (x - self._node_at), 0.0, reach)
        x += (self.x - self._node_at) * gap / reach
        self._keep(x, self.x)

    @property
    def _reach(self) -> float:
        """Length in front of it over which particles are shifted [m]: not beyond a gate, which nothing may pass."""
        return self.leeway if self.ahead is None else min(self.leeway, abs(self.ahead - self.x))

    @property
    def _node_at(self) -> float:
        """Place midway between two nodes of the lattice of particles that is nearest to it [m]."""
        h = self.grid.spacing[0]
        return 0.5 * round(2.0 * (self.x / h)) * h

    def _keep(self, x: FloatArray, wall: float) -> None:
        """Keeps positions x (N,) [m] in front of a wall [m], in place."""
        margin = CLEARANCE * self.grid.spacing[0]
        if self.water > 0:
            np.maximum(x, wall + margin, out=x)
        else:
            np.minimum(x, wall - margin, out=x)

    # ---- checkpoints ---------------------------------------------------------------------------------------------

    def parts(self) -> Mapping[str, Component]:
        return {"command": self.command}

    def state(self) -> State:
        return {**super().state(), "x": np.array(self.x)}

    def restore(self, state: Mapping[str, FloatArray]) -> None:
        super().restore(state)
        self.x = float(state["x"])
        self._cut()
