"""The operations of a time step, each on the whole flow: orchestration of the core, in the vocabulary of step.py."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from houle import _core
from houle.boundary.makers import Maker
from houle.boundary.open_side import OpenSide
from houle.boundary.paddle import place as place_paddles
from houle.errors import SimulationError
from houle.flow.ledger import Ledger
from houle.flow.state import SPRAY, Flow
from houle.flow.transfer import Transfer, interpolate
from houle.grid import FloatArray
from houle.medium.interfaces import Shared

LEAST_DEPTH = 1e-6  # of the centre of a pressure cell below the surface that counts, in cells
LEAST_DEPTH_CORRECTION = 0.2
FULL_CORRECTION = 0.25  # Courant number of a step to which the share of the correction is applied
MOST_CONTRAST = 30.0  # of C_r/n^2 at an interface that the Bernoulli force carries water across
MOST_SHIFT = 0.1  # cells a correction may move a particle


def sort(flow: Flow, transfer: Transfer, *more: FloatArray) -> tuple[FloatArray, ...]:
    """Particles in the order of their cells: neighbours in space are neighbours in memory. Sorts `more` along."""
    p, work = flow.particles, flow.work
    try:
        _core.sort_particles(flow.grid.core, p.position, p.velocity, p.volume, work.spare, work.order, flow.start)
    except FloatingPointError as error:
        raise SimulationError(
            str(error),
            diagnosis="A particle is where no water can be, most often because a velocity became infinite or not a "
            "number in this step.",
        ) from error
    for name, values in transfer.arrays.items():
        transfer.arrays[name] = values[work.order]
    flow.sample_medium()
    return tuple(values[work.order] for values in more)


def arrange(flow: Flow, transfer: Transfer) -> None:
    """Particles sorted, medium sampled where they are, surface found: what a step starts from and leaves."""
    sort(flow, transfer)
    flow.fastest = flow.max_pore_speed()
    find_surface(flow)


def prepare(flow: Flow, transfer: Transfer, ledger: Ledger) -> None:
    """Surface and pressure of the water as it stands at the start of a run."""
    dt = 1e-3 * float(min(flow.grid.spacing)) ** 0.5  # s; the pressure does not depend on it
    arrange(flow, transfer)
    transfer.to_grid(flow)
    for side in flow.sides:
        side.rest(flow)
    apply_forces(flow, dt)
    project(flow, dt, ledger)
    for u in flow.velocity:
        u[...] = 0.0
    if flow.particles.velocity.any():
        transfer.to_grid(flow)
    ledger.drag_work = ledger.open_work = 0.0


def find_surface(flow: Flow) -> None:
    """Fill fraction of the pores of every cell; depth below the free surface; cells under water.

    Valid for particles moved by up to two cells since they were sorted.
    """
    core, position, mixed = flow.grid.core, flow.particles.position, flow.mixed
    volume = flow.particles.volume
    _core.scatter_cells(core, flow.start, position, volume, flow.fill, flow.walls, flow.inverse_capacity, flow.gates)
    _core.column_heights(core, flow.start, position, volume, flow.height, flow.walls, flow.gates)
    _core.column_levels(
        core, flow.height, flow.column_porosity, flow.fill, flow.inverse_capacity,
        mixed.column, mixed.start, mixed.pieces, flow.level,
    )  # fmt: skip
    _core.find_surface(
        core, flow.fill, flow.medium.listed("open_cells"), flow.level, flow.depth, flow.active, flow.column,
        flow.eta, flow.gates,
    )  # fmt: skip
    for paddle in flow.paddles:
        paddle.shut()
    if flow.porous:
        cells = (flow.medium.listed("open_cells"), flow.medium.listed("contrast"))
        _core.hold_faces(core, flow.active, *cells, MOST_CONTRAST, flow.held)


def viscosity(flow: Flow, dt: float, ledger: Ledger) -> None:
    """Viscous acceleration of the faces, with the eddy viscosity if there is one."""
    if not flow.viscous:
        return
    core = flow.grid.core
    if flow.smagorinsky > 0.0:
        _core.eddy_viscosity(core, flow.velocity, flow.viscosity, flow.smagorinsky, flow.nu)
    flow.extra = flow.old_velocity
    _core.viscous_acceleration(
        core, flow.velocity, flow.work.face_mass, SPRAY * flow.grid.cell_volume, flow.viscosity, flow.nu,
        flow.listed("porosity"), flow.no_slip, flow.extra,
    )  # fmt: skip
    ledger.viscous_work -= dt * _core.face_power(core, flow.work.face_mass, flow.velocity, flow.extra)


def sph_viscosity(flow: Flow, dt: float, ledger: Ledger) -> None:
    """The paper's viscous term on the particles, added to their velocities: n/C_r nu_eff lap(u_d / n) dt."""
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


def make_waves(flow: Flow) -> None:
    """Accelerations of the wave makers, on top of the viscous ones."""
    if not flow.makers:
        return
    if not flow.push:
        flow.push, flow.pushed = flow.grid.faces(), _touched(flow.makers)
    for axis, where in flow.pushed.items():
        flow.push[axis][where] = 0.0
    for maker in flow.makers:
        maker.push(flow.time, flow.push)
    if flow.extra:
        for axis, where in flow.pushed.items():
            flow.extra[axis][where] += flow.push[axis][where]
    else:
        flow.extra = flow.push


def _touched(makers: list[Maker]) -> dict[int, slice]:
    """Axes of the faces that any of them pushes, and from which to which along x."""
    found: dict[int, slice] = {}
    for maker in makers:
        for axis, s in maker.touches().items():
            before = found.get(axis, s)
            found[axis] = slice(min(before.start, s.start), max(before.stop, s.stop))
    return found


def drive(flow: Flow, dt: float) -> None:
    """Velocities of the open sides in the middle of a step of dt [s] that begins now."""
    for side in flow.sides:
        side.drive(flow, dt)


def apply_forces(flow: Flow, dt: float) -> None:
    """Gravity, viscosity, porous resistance and Bernoulli term; the pressure's mobility."""
    m = flow.medium
    resists = (m.material, m.materials, flow.damping, flow.listed("energy"), flow.held)
    resistance = resists if flow.resists else ([], None, [], None, [])
    flow.velocity, flow.old_velocity = flow.old_velocity, flow.velocity
    flow.kick = dt
    _core.apply_forces(
        flow.grid.core, flow.old_velocity, *resistance, flow.gravity, flow.extra, dt,
        flow.velocity, flow.drag, flow.mobility,
    )  # fmt: skip
    flow.extra = []


def project(flow: Flow, dt: float, ledger: Ledger) -> None:
    """Pressure that makes div u_d = 0 in the water with p = 0 on its surface; velocity carried on into the air."""
    core, tolerance = flow.grid.core, flow.tolerance / dt
    work = flow.work
    system = (work.coefficient, work.dirichlet, work.rhs)
    star = [u.copy() for u in flow.velocity] if flow.heavy else []
    own_sides = [_join_sides(flow, axis, faces) for axis, faces in enumerate(flow.medium.shared)]
    _core.pressure_system(
        core, flow.active, flow.depth, flow.open_faces, flow.mobility, dt, flow.velocity, LEAST_DEPTH, *system
    )
    for plane in flow.driven:
        plane.feed(flow)
    work.solver.setup(flow.active, work.coefficient, work.dirichlet)
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
        core, flow.active, flow.depth, flow.open_faces, flow.mobility, dt, flow.pressure, LEAST_DEPTH,
        flow.velocity, work.valid,
    )  # fmt: skip
    for axis, (faces, side) in enumerate(zip(flow.medium.shared, own_sides, strict=True)):
        _part_sides(flow, axis, faces, side)
    for plane in flow.driven:
        plane.impose(flow)
    own = [u.ravel()[where] for u, (where, *_) in zip(flow.velocity, flow.edges, strict=False)]
    _core.extrapolate(core, 6, 2, flow.work.face_mass, SPRAY * flow.grid.cell_volume, flow.velocity, work.valid)
    _carry_changes(flow, star)
    _core.continue_upwards(core, 2, flow.active, flow.column, flow.velocity)
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
    now, closed = u[faces.face], flow.open_faces[axis].ravel()[faces.face] == 0.0
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
    """What drag and sponges took in this step, and what wave makers and open sides gave."""
    core, m, mass = flow.grid.core, flow.medium, flow.work.face_mass
    change = (mass, flow.mobility, flow.old_velocity, flow.velocity)
    if flow.porous:
        ledger.drag_work += _core.drag_work(core, m.material, m.materials, [], *change)
    if flow.damping:
        without = m.materials * [1.0, 0.0, 0.0]  # of what the bodies resist
        ledger.sponge_work += _core.drag_work(core, m.material, without, flow.damping, *change)
    for axis, where in flow.pushed.items():
        weight, f, u0, u1 = (field[axis][where] for field in (mass, flow.push, flow.old_velocity, flow.velocity))
        inertia = m.materials[m.material[axis][where], 0] if m.material else 1.0
        share = inertia * flow.mobility[axis][where] if flow.resists else dt
        ledger.source_work += float(np.sum(weight * share * f * (u0 + u1))) / 2
    for plane in flow.driven:
        if isinstance(plane, OpenSide):
            ledger.open_work += dt * plane.power(flow)
        else:
            ledger.source_work += dt * plane.power(flow)


def move_paddles(flow: Flow) -> None:
    """Moving walls to where they are at the end of the step."""
    for paddle in flow.paddles:
        paddle.advance()
    if flow.paddles:
        place_paddles(flow)


def settle(flow: Flow, transfer: Transfer) -> None:
    """Near porous faces where no pressure holds the water: particles take no more energy than the grid has there."""
    if flow.porous:
        p, affine = flow.particles, transfer.arrays.get("affine")
        medium, state = (*flow.crossing, flow.held), (flow.velocity, p.position, p.velocity, affine)
        _core.settle(flow.grid.core, *medium, *state, flow.interfaces)


@contextmanager
def _crossing(flow: Flow, dt: float, behind: float) -> Iterator[None]:
    """Around a motion of dt [s]: particles that cross to another porosity keep their energy where nothing holds them,
    and turn as C_r changes. behind: time [s] in which momentum falls behind where added mass is on the rate alone.
    """
    if not flow.porous:
        yield
        return
    ago = _convective_share(flow)
    change = _fall_behind(flow, behind) if flow.lag and behind > 0.0 else None
    yield
    if change is not None:
        flow.particles.velocity += change
    flow.carry(dt, ago)


def _convective_share(flow: Flow) -> FloatArray | None:
    """K/C_r where the particles are (N,); None where it is 1 everywhere."""
    if flow.lag is None:
        return None
    share, (number, lag) = np.empty(len(flow.particles)), flow.lag
    _core.gather_cells(flow.grid.core, flow.particles.position, lag[number], share)
    return 1.0 - share


def _fall_behind(flow: Flow, dt: float) -> FloatArray:
    """Change of the velocities (N, d) as momentum moves with K/C_r of the velocity of the water."""
    medium = (*flow.crossing, flow.held, flow.lag, flow.listed("particle_porosity"))
    on_faces, change = flow.grid.faces(), np.empty_like(flow.particles.velocity)
    _core.fall_behind(flow.grid.core, *medium, flow.velocity, dt, on_faces, flow.interfaces)
    interpolate(flow, on_faces, change)
    return change


def move(flow: Flow, dt: float) -> None:
    """Particles along the pore velocity of the grid, midpoint rule."""
    with _crossing(flow, dt, dt):
        _move(flow, dt)


def _move(flow: Flow, dt: float) -> None:
    p, before = flow.particles, _near_crests(flow, flow.particles.position)
    own = (p.velocity, p.volume, flow.bulk) if flow.interpolated else (None, None, None)
    _core.move(
        flow.grid.core, flow.velocity, flow.listed("particle_porosity"), *own,
        flow.medium.outline, flow.gates, dt, p.position, flow.walls, flow.interfaces,
    )  # fmt: skip
    _book_crossings(flow, before)


def drift(flow: Flow, start: FloatArray, velocity: FloatArray, porosity: FloatArray | None, dt: float) -> None:
    """Particles from `start` with velocities of their own. Without a porosity, a second time: the turn is done, and the
    velocities on the grid are those of this step.
    """
    position, m = flow.particles.position, flow.medium
    with _crossing(flow, *((dt, 0.0) if porosity is not None else (0.0, dt))):
        _core.drift(flow.grid.core, start, velocity, porosity, m.outline, flow.gates, dt, position, flow.walls)


def arrive(flow: Flow, start: FloatArray, velocity: FloatArray, dt: float) -> None:
    """Particles from `start` with pore velocities of their own, to where they stay."""
    drift(flow, start, velocity, None, dt)
    _book_crossings(flow, _near_crests(flow, start))


def _near_crests(flow: Flow, position: FloatArray) -> list[FloatArray]:
    """Copies of the positions near each crest."""
    return [position[crest.near(flow.start)].copy() for crest in flow.crests]


def _book_crossings(flow: Flow, before: list[FloatArray]) -> None:
    """Books what crosses the crests on the way from there to where the particles are now."""
    p = flow.particles
    for crest, was in zip(flow.crests, before, strict=True):
        near = crest.near(flow.start)
        crest.moved(was, p.position[near], p.volume[near])


def portion(correction: float, courant: float) -> float:
    """Share of the excess that a step spreads [-]. Disorder is made by moving: a step that moves little corrects
    little, one of several quarters of a cell as much as that many steps.
    """
    quarters = courant / FULL_CORRECTION
    return min(correction * quarters, 1.0 - (1.0 - correction) ** quarters)


def correct_positions(flow: Flow, correction: float, dt: float, ledger: Ledger) -> None:
    """Moves particles from overfull to underfull cells: a second projection, of positions (Kugelstadt et al. 2019).

    correction: share of the excess that is spread when the fastest particle crosses a quarter of a cell [-]. The
    velocity is left as it is.
    """
    share = portion(correction, flow.courant(dt))
    if share == 0.0:
        return
    g, m, work = flow.grid, flow.medium, flow.work
    find_surface(flow)
    _core.pressure_system(
        g.core, flow.active, flow.depth, flow.open_faces, [], 1.0, [], LEAST_DEPTH_CORRECTION,
        work.coefficient, work.dirichlet, work.rhs,
    )  # fmt: skip
    surface = (flow.active, flow.depth, flow.column, flow.eta, flow.fill)
    largest = _core.density_excess(g.core, *surface, m.listed("open_cells"), flow.listed("porosity"), share, work.rhs)
    if flow.paddles:
        for paddle in flow.paddles:
            work.rhs[paddle.column] *= paddle.share
        largest = float(max(work.rhs.max(), -work.rhs.min()))
    work.solver.setup(flow.active, work.coefficient, work.dirichlet)
    tolerance = max(1e-2 * largest, 1e-9)
    iterations = work.solver.solve(work.rhs, work.potential, tolerance, 50, flow.psi)[0]
    ledger.note(correction_iterations=iterations)
    displacement = work.coefficient
    _core.project(
        g.core, flow.active, flow.depth, flow.open_faces, [], 1.0, work.potential, LEAST_DEPTH_CORRECTION,
        displacement, work.valid, still=True,
    )  # fmt: skip
    _core.extrapolate(g.core, 3, 3, [], 0.0, displacement, work.valid)
    porosity, position = flow.listed("particle_porosity"), flow.particles.position
    before = _near_crests(flow, position)
    with _crossing(flow, 0.0, 0.0):
        _core.displace(g.core, displacement, porosity, m.outline, flow.gates, MOST_SHIFT, position, flow.walls)
    _book_crossings(flow, before)
