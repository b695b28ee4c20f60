"""When the particles of a flow are remeshed, and what has to be done before and after it.

Columns of the water and the marks of the crests are handed on to the new particles. Paddles shift the particles in
front of them to where the lattice has its nodes, and back. Energy that a remeshing makes near porous interfaces is
taken off again. The remeshings themselves are in remeshers.py.
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
    """Calls a remesher after at least `every` steps, once water has moved on by `travel` cells (`Remesher.travel`).

    count      steps since the last remeshing
    travelled  integral of the Darcy velocity over time on the faces since then, one array per axis [m], float32; over
               the porosity, it is how far the water has moved

    The distance from where the water was is what counts, not the length of its path: waves whose orbits are small
    beside a cell carry the particles to and fro and leave them in order (docs/decisions/0009, 0010).
    """

    on_rows = ("travelled",)

    def __init__(self, remesher: Remesher, every: int) -> None:
        self.remesher, self.every, self.travel = remesher, every, remesher.travel
        self.count = 0
        self.travelled: list[NDArray[np.float32]] = []

    def after_step(self, flow: Flow, transfer: Transfer, dt: float) -> None:
        """Ends a step of dt [s]: remeshes if it is time to. The particles are then not sorted any more."""
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
        """Steps since the last remeshing, and how far water has moved since on the faces of each axis."""
        ways = {f"travelled.{axis}": way for axis, way in enumerate(self.travelled)}
        return {"count": np.array(self.count), **ways}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Goes on from a state()."""
        self.count = int(state["count"])
        self.travelled = [np.array(state[key]) for key in sorted(state) if key.startswith("travelled.")]

    def _go_on(self, flow: Flow, dt: float) -> float:
        """Adds a step of dt [s] to `travelled`; returns how far water has moved, the largest of all faces [cells]."""
        grid, least = flow.grid, SPRAY * flow.grid.cell_volume
        fields = (flow.velocity, flow.work.face_mass, least, flow.listed("porosity"), self.travelled)
        ways = _core.travel(grid.core, dt, *fields)
        return max(way / h for way, h in zip(ways, grid.spacing, strict=True))


def _energy(flow: Flow) -> FloatArray:
    """Twice the kinetic energy per density of each cell near interfaces together with all around it [m^d m2/s2]."""
    p, total = flow.particles, flow.grid.cells()
    _core.cell_energy(flow.grid.core, flow.around_interface, p.position, flow.bulk, p["inertia"], p.velocity, total)
    for axis, wraps in enumerate(flow.grid.periodic):
        wide = widened(total, axis, wraps)
        total = np.moveaxis(wide[:-2] + wide[1:-1] + wide[2:], 0, axis)
    return total


def _take_made(flow: Flow, before: FloatArray) -> None:
    """Takes off the kinetic energy that remeshing has made near porous interfaces where no Bernoulli force acts.

    Energy at a given u_d is in proportion to C_r/n^2, so water that is given to a node of another porosity with its u_d
    changes energy (docs/theory.md, section 6). No cell may have more than before. But at oblique interfaces well under
    water the pressure joins the cells: what some have more and others less is the scatter of the particles, so there
    no more is taken off than all of them together have more, in proportion.
    before: of `_energy`, before the remeshing. The velocities in a cell that has more are scaled down.
    """
    held = np.ones(flow.grid.shape, bool)
    for axis, faces in enumerate(flow.held):
        held &= np.minimum(np.delete(faces, 0, axis=axis), np.delete(faces, -1, axis=axis)) > 0
    after, p = _energy(flow), flow.particles
    made = (after > before) & ~held & flow.at_interface
    if not made.any():
        return
    joined = flow.joined_cells()
    wanted = before + np.where(joined, _kept((after - before)[joined]), 0.0) * (after - before)
    share = np.sqrt(np.divide(wanted, after, out=np.ones_like(after), where=made))
    _core.scale_by_cell(flow.grid.core, np.ascontiguousarray(share), p.position, p.velocity)


def _kept(change: FloatArray) -> float:
    """Share of the gains in these changes that their losses pay for."""
    gains, losses = change[change > 0.0].sum(), -change[change < 0.0].sum()
    return float(min(1.0, losses / gains)) if gains > 0.0 else 0.0
