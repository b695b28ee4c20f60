"""Forces on the faces: gravity, viscosity, wave makers, porous resistance and the Bernoulli term."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.flow.ledger import Ledger
from houle.flow.state import SPRAY, Flow
from houle.grid import Faces, FloatArray, Listed


def viscosity(flow: Flow, dt: float, ledger: Ledger) -> Faces:
    """Viscous acceleration of the faces [m/s2], with the eddy viscosity if there is one; empty in inviscid flow.

    The result stands in the arrays of flow.old_velocity, which are free until `apply_forces`. The work over dt [s] is
    booked in the ledger.
    """
    if not flow.viscous:
        return []
    core, acceleration = flow.grid.core, flow.old_velocity
    if flow.nu is not None:
        _core.eddy_viscosity(core, flow.velocity, flow.viscosity, flow.smagorinsky, flow.nu)
    _core.viscous_acceleration(
        core, flow.velocity, flow.work.face_mass, SPRAY * flow.grid.cell_volume, flow.viscosity, flow.nu,
        flow.listed("porosity"), acceleration,
    )  # fmt: skip
    ledger.viscous_work -= dt * _core.face_power(core, flow.work.face_mass, flow.velocity, acceleration)
    return acceleration


def sph_viscosity(flow: Flow, dt: float, ledger: Ledger) -> None:
    """Adds the paper's viscous term to the velocities of the particles: n/C_r nu_eff lap(u_d / n) dt.

    nu_eff is the viscosity and that of the eddies. The energy that the term takes is booked in the ledger.
    """
    if not flow.viscous:
        return
    flow.sample_medium()
    p, near, velocity = flow.particles, flow.smoothing, flow.pore_velocity()
    nu = np.full(len(p), flow.viscosity)
    if flow.smagorinsky > 0.0:
        nu += near.eddy_viscosity(p.position, flow.start, velocity, flow.bulk, flow.smagorinsky)
    change = dt * near.viscous_acceleration(p.position, flow.start, velocity, flow.bulk, nu)
    if flow.inertia is not None:
        change /= flow.inertia
    before = flow.kinetic_energy()
    p.velocity += change
    ledger.viscous_work += before - flow.kinetic_energy()


def rub(flow: Flow, dt: float, ledger: Ledger) -> None:
    """Slows the particles near walls that rub, by the law of the wall over dt [s]: core/houle/water/friction.hpp.

    The particles are sorted. On return flow.impulse is what the planes of flow.walls got, and the energy is booked.
    """
    if flow.walls is None:
        return
    p, walls = flow.particles, flow.walls
    with ledger.operation("forces"):
        ledger.friction_work += _core.rub(
            flow.grid.core, walls[:4], flow.start, p.position, p.volume, flow.bulk, flow.inertia,
            flow.fill, flow.viscosity, dt, p.velocity, flow.impulse,
        )  # fmt: skip


def gather_behind(flow: Flow) -> None:
    """Gives the momentum of faces in solids to the open faces beside them, where walls rub (`Flow.behind_walls`).

    Particles beside a solid give to faces inside it, whose velocity is after the projection that of the open ones.
    Without this, a shear along the wall was made anew in each step: a bed took 73 to 93 % of what it should.
    """
    for axis, (face, count, beside, number, share) in enumerate(flow.behind_walls):
        u, mass = flow.velocity[axis].ravel(), flow.work.face_mass[axis].ravel()
        given = np.repeat(mass[face], count) * share
        momentum = np.bincount(number, given * np.repeat(u[face], count), minlength=len(beside))
        total = mass[beside] + np.bincount(number, given, minlength=len(beside))
        carries = total > 0.0
        u[beside[carries]] = ((mass[beside] * u[beside] + momentum)[carries]) / total[carries]
        if len(face):
            first = np.cumsum(count) - count
            u[face] = np.add.reduceat(u[beside][number] * share, first)


def make_waves(flow: Flow, acceleration: Faces) -> Faces:
    """The accelerations of the faces [m/s2] together with those by which boundaries push the water, as makers do.

    acceleration is that of the viscosity: it is added to in place, unless it is empty.
    """
    pushed = flow.boundaries.pushed
    if not pushed:
        return acceleration
    push = flow.boundaries.push(flow.time)
    if not acceleration:
        return push
    for axis, where in pushed.items():
        acceleration[axis][where] += push[axis][where]
    return acceleration


def drive(flow: Flow, dt: float) -> None:
    """Lets open sides choose the velocity of their faces in the middle of a step of dt [s] that begins now."""
    for boundary in flow.boundaries:
        boundary.drive(flow, dt)


def _resistance(
    flow: Flow,
) -> tuple[list[NDArray[np.int32]], FloatArray | None, Faces, Listed | None, list[NDArray[np.uint8]]]:
    """The resistances as the core takes them; all empty where nothing resists.

    These are the material of each face and the table of materials (`Medium`), the damping of boundaries [1/s], K/n^2
    of the cells for the Bernoulli term, and the faces at which that acts.
    """
    if not flow.resists:
        return [], None, [], None, []
    return flow.medium.material, flow.medium.materials, flow.boundaries.damping, flow.listed("energy"), flow.held


def apply_forces(flow: Flow, dt: float, acceleration: Faces) -> None:
    """Makes u* of (12) from u: gravity, drag, Bernoulli term and the given accelerations of the faces over dt [s].

    On return flow.velocity holds u* and flow.old_velocity u [m/s], flow.mobility the factor Phi of the pressure
    gradient [s], and flow.drag, if it is asked for, the factor D of the old velocity.
    """
    flow.velocity, flow.old_velocity = flow.old_velocity, flow.velocity
    flow.kick = dt
    _core.apply_forces(
        flow.grid.core, flow.old_velocity, *_resistance(flow), flow.gravity, acceleration, dt,
        flow.velocity, flow.drag, flow.mobility,
    )  # fmt: skip
