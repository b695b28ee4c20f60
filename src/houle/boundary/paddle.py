"""A vertical wall that moves along x, from floor to lid and across the whole tank: piston wave maker, absorbing wall.

It stands anywhere between the faces of the grid. Of the column of cells that it cuts the share `open` is left: that
share of its upright faces and of its volume. The faces towards it are closed to the pressure and carry the flux of the
wall (`driven.Driven`), so that what it sweeps is what the water gives or takes. Particles have mirror images behind it
where fill and levels are summed, and are kept in front of it; so nothing of the cut column is small. Behind it is no
water.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from houle.errors import SimulationError
from houle.flow.particles import Particles
from houle.grid import FloatArray

if TYPE_CHECKING:
    from houle.flow.state import Flow

ROOM = 3  # cells between a paddle and the sides of the tank: its mirror images need them
LEEWAY = 40  # cells in front of a paddle over which the lattice of the particles gives way to it
SLIVER = 1e-6  # of a cell: what is less of a column is closed
THIN = 0.02  # of a cell: in a thinner column the velocity is not led on behind the paddle
CLEARANCE = 1e-9  # cells between a particle and the paddle


class Command(Protocol):
    """What moves a paddle. What a checkpoint needs of it is in `memory`, an array that is changed in place."""

    memory: FloatArray

    def way(self, flow: Flow, paddle: Paddle, dt: float) -> float:
        """How far it goes in the step of dt [s] that begins [m]."""

    def notice(self, flow: Flow, paddle: Paddle) -> None:
        """Reads the pressure on its face, just found."""


class Paddle:
    """rest, x: position at rest and now [m]; water: +1 where the water is to the right, -1 to the left.

    velocity: mean over the present step [m/s]; column, share: number of the cut column, its open share.
    """

    def __init__(self, name: str, rest: float, water: int, command: Command, flow: Flow) -> None:
        self.name, self.rest, self.water, self.command = name, rest, water, command
        self.x, self.velocity, self.flow = rest, 0.0, flow
        self.way = 0.0  # of the present step [m]
        flow.particles = flow.particles.select(self._in_front(flow.particles))
        self.leeway = self._clear() * flow.grid.spacing[0]
        flow.paddles.append(self)
        flow.driven.append(self)
        place(flow)

    def _clear(self) -> int:
        """Cells in front of it that are like those at its face, LEEWAY at most."""
        body = self.flow.medium.body.reshape(2 * self.flow.grid.shape[0], -1)[:: self.water]
        first = round(2.0 * self.rest / self.flow.grid.spacing[0])
        ahead = body[first:] if self.water > 0 else body[len(body) - first :]
        other = np.flatnonzero((ahead != ahead[0]).any(axis=1))
        return max(1, min(LEEWAY, (int(other[0]) if len(other) else len(ahead) // 2) // 2))

    def _in_front(self, particles: Particles) -> NDArray[np.bool_]:
        """Which of the particles stand on its side of the water (N,)."""
        return self.water * (particles.position[:, 0] - self.x) > 0

    # ---- in the step ---------------------------------------------------------------------------------------------

    def begin(self, dt: float) -> None:
        """Decides how it moves in the step of dt [s] that begins."""
        self.way = self.command.way(self.flow, self, dt)
        self.velocity = self.way / dt

    def advance(self) -> None:
        """To where it is at the end of the step."""
        self.x += self.way
        self.way = 0.0
        grid = self.flow.grid
        room = ROOM * grid.spacing[0]
        if not room <= self.x <= grid.size[0] - room:
            raise SimulationError(
                f"{self.name} has gone {abs(self.x - self.rest):.3g} m from where it stands at rest, "
                f"x = {self.rest:g}, to within {ROOM} cells of the side of the tank",
                place=(self.x,),
                diagnosis="A moving wall that absorbs goes as far as the waves take it: give it more room behind.",
            )

    def close(self) -> None:
        """Closes faces, as it stands."""
        flow, at = self.flow, self.x / self.flow.grid.spacing[0]
        self.node = round(2.0 * at)
        if self.water > 0:
            column = int(np.floor(at + SLIVER))
            self.share = min(1.0, column + 1 - at)
            self.behind, self.face, self.inner = slice(0, column), column, column + 1
        else:
            column = int(np.ceil(at - SLIVER)) - 1
            self.share = min(1.0, at - column)
            self.behind, self.face, self.inner = slice(column + 1, None), column + 1, column
        self.column = column
        across, *along = flow.open_faces
        across[self.behind] = across[self.face] = 0.0
        for faces in along:
            faces[self.behind] = 0.0
            faces[column] *= self.share

    def outline(self) -> tuple[float, float]:
        """x [m] and side, as the core knows it."""
        return self.x, float(self.water)

    def to_lattice(self, particles: Particles) -> None:
        """Shifts the particles in front of it so that it stands between two nodes of the lattice, for the remeshing.

        By up to a quarter of a cell at the paddle and less and less in front of it, nothing from `leeway` on.
        """
        x, margin = particles.position[:, 0], CLEARANCE * self.flow.grid.spacing[0]
        gap = self.leeway - np.clip(self.water * (x - self.x), 0.0, self.leeway)
        x += (self._node_at - self.x) * gap / self.leeway
        self._keep(x, self._node_at, margin)

    def from_lattice(self, particles: Particles) -> None:
        """Back again."""
        x, margin = particles.position[:, 0], CLEARANCE * self.flow.grid.spacing[0]
        reach = self.leeway - self.water * (self._node_at - self.x)
        gap = reach - np.clip(self.water * (x - self._node_at), 0.0, reach)
        x += (self.x - self._node_at) * gap / reach
        self._keep(x, self.x, margin)

    @property
    def _node_at(self) -> float:
        return 0.5 * self.node * self.flow.grid.spacing[0]

    def _keep(self, x: FloatArray, wall: float, margin: float) -> None:
        if self.water > 0:
            np.maximum(x, wall + margin, out=x)
        else:
            np.minimum(x, wall - margin, out=x)

    def shut(self) -> None:
        """No water behind it."""
        self.flow.active[self.behind] = 0
        self.flow.eta[self.behind] = np.nan

    # ---- driven faces --------------------------------------------------------------------------------------------

    def feed(self, flow: Flow) -> None:
        flow.work.rhs[self.column] += flow.active[self.column] * (self.water * self.velocity / flow.grid.spacing[0])

    def impose(self, flow: Flow) -> None:
        """Led on linearly behind the paddle, so that it is its own velocity where it stands."""
        u, known = flow.velocity[0], flow.work.valid[0]
        lead = 1.0 / max(self.share, THIN)
        led = u[self.inner] + lead * (self.velocity - u[self.inner])
        known[self.face] = known[self.inner] == 1
        u[self.face] = np.where(known[self.face] == 1, led, self.velocity)

    def power(self, flow: Flow) -> float:
        self.command.notice(flow, self)
        flux = self.water * self.velocity * flow.grid.cell_volume / flow.grid.spacing[0]
        return flux * float(np.sum(flow.active[self.column] * flow.pressure[self.column]))


def place(flow: Flow) -> None:
    """Openness of faces, and nodes of the lattice, with gates and paddles where they are now."""
    flow.open_passages()
    for paddle in flow.paddles:
        paddle.close()
    flow.walls = np.array([paddle.outline() for paddle in flow.paddles])
    left = [paddle.node for paddle in flow.paddles if paddle.water > 0]
    right = [paddle.node for paddle in flow.paddles if paddle.water < 0]
    flow.nodes = max(left, default=0), min(right, default=2 * flow.grid.shape[0])
