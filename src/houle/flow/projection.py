"""The projection: the pressure that makes the Darcy velocity free of divergence, and the velocity that follows."""

from __future__ import annotations

import numpy as np

from houle import _core
from houle.errors import SimulationError
from houle.flow.ledger import Ledger
from houle.flow.state import SPRAY, Flow
from houle.grid import FloatArray
from houle.medium.interfaces import Shared

LEAST_DEPTH = 1e-6  # of the centre of a pressure cell below the surface that counts, in cells


def project(flow: Flow, dt: float, ledger: Ledger) -> None:
    """Pressure that makes div u_d = 0 in the water with p = 0 on its surface; velocity carried on into the air."""
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
    """Velocity and mobility of faces that two media share become the means over both media: what the pressure drives.

    Returns, (K,) each, velocity [m/s] and mobility [s] of the medium at the centre, then the same of both media.
    """
    fields = (flow.velocity[axis], flow.mobility[axis])
    own, joint = [field.ravel()[faces.face] for field in fields], [faces.mean(field) for field in fields]
    for field, both in zip(fields, joint, strict=True):
        field.ravel()[faces.face] = both
    return own + joint


def _part_sides(flow: Flow, axis: int, faces: Shared, before: list[FloatArray]) -> None:
    """After the projection: shared faces have that of the medium at the centre again, moved by the same pressure."""
    u, mobility = flow.velocity[axis].ravel(), flow.mobility[axis].ravel()
    own, own_mobility, joint, joint_mobility = before
    now, closed = u[faces.face], flow.boundaries.open_faces[axis].ravel()[faces.face] == 0.0
    u[faces.face] = np.where(closed, now, own + own_mobility / joint_mobility * (now - joint))
    mobility[faces.face] = own_mobility


def _carry_changes(flow: Flow, star: list[FloatArray]) -> None:
    """In heavy pores (`Flow.heavy`) the faces just beyond the pressure keep their own velocity and take the change that
    the pressure made in those beside them; a layer further out they keep their own.

    star: velocities on the faces before the projection; empty where no pores are heavy.

    Gravity changes next to nothing there in a step: a velocity carried outwards again and again grew without a force,
    by 5 % a step in a film that fell through n = 0.2.
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
    """Where the inertia of the faces changes, a velocity carried outwards has no more energy than the water there had,
    or a face beside that has a pressure: u_d carried from clear water into pores would be many times that.
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
    """What drag and sponges took in this step, and what the boundaries gave."""
    core, m, mass, boundaries = flow.grid.core, flow.medium, flow.work.face_mass, flow.boundaries
    change = (mass, flow.mobility, flow.old_velocity, flow.velocity)
    if flow.porous:
        ledger.drag_work += _core.drag_work(core, m.material, m.materials, [], *change)
    if boundaries.damping:
        without = m.materials * [1.0, 0.0, 0.0]  # of what the bodies resist
        ledger.sponge_work += _core.drag_work(core, m.material, without, boundaries.damping, *change)
    for axis, where in boundaries.pushed.items():
        fields = (mass, boundaries.pushes, flow.old_velocity, flow.velocity)
        weight, f, u0, u1 = (field[axis][where] for field in fields)
        inertia = m.materials[m.material[axis][where], 0] if m.material else 1.0
        share = inertia * flow.mobility[axis][where] if flow.resists else dt
        ledger.source_work += float(np.sum(weight * share * f * (u0 + u1))) / 2
    for boundary in boundaries:
        ledger.give(boundary.work, dt * boundary.power(flow))
