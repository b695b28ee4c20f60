"""When the particles of a flow are remeshed, and what goes on around it.

Columns of the water and the marks of the crests are handed on; paddles move the particles in front of them to where the
lattice has its nodes, and back; near porous interfaces no energy is made. How particles are remeshed stands in
remeshers.py.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.flow.component import Component, State
from houle.flow.remeshers import Remesher, handed_on
from houle.flow.state import SPRAY, Flow
from houle.flow.transfer import Transfer
from houle.grid import FloatArray, widened


class RemeshingSchedule(Component):
    """Calls a remesher every `every` steps, once water has moved on by `travel` cells (`Remesher.travel`).

    count      steps since the last remeshing
    travelled  integral of the pore velocity on the faces since then [m], float32

    What counts is how far water is from where it was, not the length of its way: waves whose orbits are small beside a
    cell carry the particles to and fro and leave them in order (docs/decisions/0009, 0010).
    """

    on_rows = ("travelled",)

    def __init__(self, remesher: Remesher, every: int) -> None:
        self.remesher, self.every, self.travel = remesher, every, remesher.travel
        self.count = 0
        self.travelled: list[NDArray[np.float32]] = []

    def after_step(self, flow: Flow, transfer: Transfer, dt: float) -> None:
        """Remeshes where it is time to, with all that goes with the water. On return the particles are not sorted.

        dt: how long the particles have moved with the velocity of the grid [s].
        """
        self.count += 1
        self.travelled = self.travelled or [np.zeros(u.shape, np.float32) for u in flow.velocity]
        farthest = self._go_on(flow, dt)
        if self.count < self.every or farthest < self.travel:
            return
        self.count = 0
        for way in self.travelled:
            way[...] = 0.0
        flow.sample_medium()
        energy = _energy(flow) if flow.porous else None
        self._remesh(flow)
        flow.sample_medium()
        if energy is not None:
            _take_made(flow, energy)
        transfer.renew(flow)

    def _remesh(self, flow: Flow) -> None:
        """Replaces the particles; the columns and marks that go with the water are handed on with it."""
        old, porosity = flow.particles, flow.porosity if flow.porous else None
        marks = [crest.marks(old.position) for crest in flow.crests]
        where = (porosity, flow.boundaries.nodes, flow.boundaries.gates)
        flow.drop_work()
        for boundary in flow.boundaries:
            boundary.to_lattice(old)
        new = self.remesher(old, *where)
        if new is not old:
            for name in old.of_kind("water"):
                new[name][...] = handed_on(self.remesher, old, old[name], *where)
        handed = [None if mark is None else handed_on(self.remesher, old, mark, *where) for mark in marks]
        for boundary in flow.boundaries:
            boundary.from_lattice(new)
        if flow.boundaries.walls is not None:
            _core.leave_solids(flow.grid.core, flow.medium.outline, new.position)
        for crest, shares in zip(flow.crests, handed, strict=True):
            if shares is not None:
                crest.handed(new.position, new.volume, shares)
        flow.particles = new

    def state(self) -> State:
        """When the last remeshing was, and how far water has moved since on each axis."""
        ways = {f"travelled.{axis}": way for axis, way in enumerate(self.travelled)}
        return {"count": np.array(self.count), **ways}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Goes on from a state()."""
        self.count = int(state["count"])
        self.travelled = [np.array(state[key]) for key in sorted(state) if key.startswith("travelled.")]

    def _go_on(self, flow: Flow, dt: float) -> float:
        """Adds a step to `travelled`; returns how far water is from where it was, the largest of all faces [cells]."""
        grid, least = flow.grid, SPRAY * flow.grid.cell_volume
        fields = (flow.velocity, flow.work.face_mass, least, flow.listed("porosity"), self.travelled)
        ways = _core.travel(grid.core, dt, *fields)
        return max(way / h for way, h in zip(ways, grid.spacing, strict=True))


def _energy(flow: Flow) -> FloatArray:
    """Twice the kinetic energy in each cell near interfaces and those around it [m^d m2/s2], per density."""
    p, total = flow.particles, flow.grid.cells()
    _core.cell_energy(flow.grid.core, flow.around_interface, p.position, flow.bulk, p["inertia"], p.velocity, total)
    for axis, wraps in enumerate(flow.grid.periodic):
        wide = widened(total, axis, wraps)
        total = np.moveaxis(wide[:-2] + wide[1:-1] + wide[2:], 0, axis)
    return total


def _take_made(flow: Flow, before: FloatArray) -> None:
    """Takes what remeshing has made of energy near interfaces where no pressure holds the water.

    Water that is given to a node of another porosity with its u_d has C_r/n^2 there times the energy (section 7 of
    docs/theory.md); in cells that are held the pressure pays for it.
    """
    held = np.ones(flow.grid.shape, bool)
    for axis, faces in enumerate(flow.held):
        held &= np.minimum(np.delete(faces, 0, axis=axis), np.delete(faces, -1, axis=axis)) > 0
    after, p = _energy(flow), flow.particles
    made = (after > before) & ~held & flow.at_interface
    if made.any():
        share = np.sqrt(np.divide(before, after, out=np.ones_like(after), where=made))
        _core.scale_by_cell(flow.grid.core, np.ascontiguousarray(share), p.position, p.velocity)
