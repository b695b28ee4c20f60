"""The projection: the pressure that makes the Darcy velocity free of divergence, and the velocity that follows.

Equations (15) to (18) of docs/theory.md. `work.valid` numbers the faces by layers outwards: 1 where the velocity is
known from the pressure or at a wall, 2, 3, ... in the layers to which it is carried on from there, 0 beyond.
"""

from __future__ import annotations

import numpy as np

from houle import _core
from houle.errors import SimulationError
from houle.flow.ledger import Ledger
from houle.flow.state import SPRAY, Flow
from houle.grid import FloatArray
from houle.medium.interfaces import Shared

LEAST_DEPTH = 1e-6  # cells: depth below the surface that the centre of a pressure cell is given at least


def project(flow: Flow, dt: float, ledger: Ledger) -> None:
    """Solves for the pressure that makes div u_d = 0 in the water, with p = 0 on its surface, and applies it.

    flow.velocity holds u* on entry and u' on return, carried on into the air as far as particles need it; dt [s] is
    the time over which the forces acted. flow.pressure is p / rho [m2/s2]. Raises SimulationError where the solver
    does not reach the tolerance.
    """
    core, tolerance = flow.grid.core, flow.tolerance / dt
    work, open_faces = flow.work, flow.boundaries.open_faces
    star = [u.copy() for u in flow.velocity] if flow.heavy else []
    own_sides = [_join_sides(flow, axis, faces) for axis, faces in enumerate(flow.medium.shared)]
    _core.pressure_system(
        core, flow.active, flow.submergence, open_faces, flow.mobility, dt, flow.velocity, LEAST_DEPTH,
        work.coefficient, work.dirichlet, work.rhs,
    )  # fmt: skip
    for boundary in flow.boundaries:
        boundary.feed(flow)
    work.set_up(flow.active)
    iterations, residual = work.solver.solve(work.rhs, flow.pressure, tolerance, 200)
    ledger.note(pressure_iterations=iterations, divergence=residual * dt)
    if not residual <= tolerance:
        place = np.unravel_index(np.argmax(np.nan_to_num(np.abs(work.rhs), nan=np.inf)), flow.grid.shape)
        raise SimulationError(
            f"the pressure did not converge: max |div u_d| dt = {residual * dt:.2e}, wanted {flow.tolerance:.2e}",
            place=tuple((i + 0.5) * h for i, h in zip(place, flow.grid.spacing, strict=True)),
            diagnosis="The projection leaves more divergence than numerics.tolerance allows. A tolerance near "
            "round-off (1e-13) cannot be met; else the flow itself has become unphysical near the place given.",
        )
    _core.project(
        core, flow.active, flow.submergence, open_faces, flow.mobility, dt, flow.pressure, LEAST_DEPTH,
        flow.velocity, work.valid,
    )  # fmt: skip
    for axis, (faces, side) in enumerate(zip(flow.medium.shared, own_sides, strict=True)):
        _part_sides(flow, axis, faces, side)
    for boundary in flow.boundaries:
        boundary.impose(flow)
    own = [u.ravel()[where] for u, (where, *_) in zip(flow.velocity, flow.edges, strict=False)]
    _core.extrapolate(core, 6, 2, flow.work.face_mass, SPRAY * flow.grid.cell_volume, flow.velocity, work.valid)
    _carry_changes(flow, star)
    _core.continue_upwards(core, 2, flow.active, flow.single_level, flow.velocity)
    _limit_carried(flow, own)
    if flow.medium.closed_faces:
        _core.stop_at_solids(core, flow.medium.closed_faces, flow.velocity)
    _book_works(flow, dt, ledger)


def _join_sides(flow: Flow, axis: int, faces: Shared) -> list[FloatArray]:
    """Sets velocity and mobility of the faces that two media share to the means over both, for the projection.

    Returns four arrays (K,): velocity [m/s] and mobility [s] of the medium at the centre of the face, then the means.
    """
    fields = (flow.velocity[axis], flow.mobility[axis])
    own, joint = [field.ravel()[faces.face] for field in fields], [faces.mean(field) for field in fields]
    for field, both in zip(fields, joint, strict=True):
        field.ravel()[faces.face] = both
    return own + joint


def _part_sides(flow: Flow, axis: int, faces: Shared, before: list[FloatArray]) -> None:
    """Gives shared faces the velocity of the medium at their centre again, changed by the same pressure gradient.

    before: of `_join_sides`. The mobility is restored as well.
    """
    u, mobility = flow.velocity[axis].ravel(), flow.mobility[axis].ravel()
    own, own_mobility, joint, joint_mobility = before
    now, closed = u[faces.face], flow.boundaries.open_faces[axis].ravel()[faces.face] == 0.0
    u[faces.face] = np.where(closed, now, own + own_mobility / joint_mobility * (now - joint))
    mobility[faces.face] = own_mobility


def _carry_changes(flow: Flow, star: list[FloatArray]) -> None:
    """Replaces velocities that were carried outwards in heavy pores (`Flow.heavy`), in two layers of faces.

    In the first layer a face keeps its own velocity and takes the mean change that the pressure made in the faces
    beside it; in the second it keeps its own. Gravity hardly changes a velocity there in a step: one that is carried
    outwards again and again grew without a force, by 5 % a step in a film that fell through n = 0.2.

    star: velocities u* on the faces before the projection; empty where no pores are heavy.
    """
    for axis, (where, around) in enumerate(flow.heavy):
        u, own, valid = flow.velocity[axis].ravel(), star[axis].ravel(), flow.work.valid[axis].ravel()
        wet = flow.work.face_mass[axis].ravel()[where] > SPRAY * flow.grid.cell_volume
        beyond = wet & ((valid[where] == 2) | (valid[where] == 3))
        face, beside = where[beyond], around[beyond]
        known = valid[beside] == 1
        change = np.where(known, u[beside] - own[beside], 0.0).sum(axis=1) / np.maximum(known.sum(axis=1), 1)
        u[face] = own[face] + change


def _limit_carried(flow: Flow, own: list[FloatArray]) -> None:
    """Limits velocities that were carried outwards to faces of another inertia (`Flow.edges`).

    Such a velocity gets no more kinetic energy than the face had before, or than a face beside it that has a pressure:
    u_d carried from clear water into pores would have many times that. own: the velocities (K,) before, per axis.
    """
    for axis, ((where, around, inertia, others), before) in enumerate(zip(flow.edges, own, strict=True)):
        u, valid = flow.velocity[axis].ravel(), flow.work.valid[axis].ravel()
        carried = valid[where] != 1
        if not carried.any():
            continue
        face, near, J = where[carried], around[carried], inertia[carried]
        beside = np.where(valid[near] == 1, others[carried] * u[near] ** 2, 0.0).max(axis=1, initial=0.0)
        most = np.sqrt(np.maximum(beside, J * before[carried] ** 2) / J)
        u[face] = np.clip(u[face], -most, most)


def _book_works(flow: Flow, dt: float, ledger: Ledger) -> None:
    """Books the work of drag and sponges in this step, and that of pushes and pressure at the boundaries."""
    core, m, mass, boundaries = flow.grid.core, flow.medium, flow.work.face_mass, flow.boundaries
    change = (mass, flow.mobility, flow.old_velocity, flow.velocity)
    if flow.porous:
        ledger.drag_work += _core.drag_work(core, m.material, m.materials, [], *change)
    if boundaries.damping:
        without = m.materials * [1.0, 0.0, 0.0]  # the inertia of the bodies without their resistance
        ledger.sponge_work += _core.drag_work(core, m.material, without, boundaries.damping, *change)
    for axis, where in boundaries.pushed.items():
        fields = (mass, boundaries.pushes, flow.old_velocity, flow.velocity)
        weight, f, u0, u1 = (field[axis][where] for field in fields)
        inertia = m.materials[m.material[axis][where], 0] if m.material else 1.0
        share = inertia * flow.mobility[axis][where] if flow.resists else dt
        ledger.source_work += float(np.sum(weight * share * f * (u0 + u1))) / 2
    for boundary in boundaries:
        ledger.give(boundary.work, dt * boundary.power(flow))
