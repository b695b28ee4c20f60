"""Motion of the particles: with the velocity of the grid or with their own, past walls, interfaces and crests.

A crest is a section at which overtopping is counted (crest.py).
"""

from __future__ import annotations

from houle import _core
from houle.flow.crossing import book_crossings, crossing, near_crests
from houle.flow.state import Flow
from houle.flow.surface import find_surface, sort
from houle.grid import FloatArray


def begin(flow: Flow, dt: float) -> None:
    """Begins a step of dt [s]: gates take the place of this instant, moving walls choose how far they go in the step.

    Where a gate has moved, the medium at the particles and the free surface are found anew.
    """
    flow.last_step, flow.step_size = flow.step_size, dt
    for boundary in flow.boundaries:
        boundary.begin(flow, dt)
    if flow.stand():
        flow.sample_medium()
        find_surface(flow)


def move_walls(flow: Flow) -> None:
    """Puts moving walls where they stand at the end of the step."""
    for boundary in flow.boundaries:
        boundary.advance(flow)
    flow.stand()


def exchange(flow: Flow, dt: float) -> None:
    """Lets water in and takes water out for a step of dt [s], after the particles have moved."""
    if not (open_ := flow.boundaries.with_method("exchange")):
        return
    for boundary in open_:
        boundary.exchange(flow, dt)
    sort(flow)


def limit_energy(flow: Flow) -> None:
    """Limits the velocities of particles near porous interfaces, where the inertia of the faces around them differs.

    They take the velocity of the grid by linear interpolation, whatever the transfer, and where no pressure holds the
    water with no more kinetic energy than the grid has there: otherwise the way back from the grid would make energy
    (docs/theory.md, section 6).
    """
    if flow.porous:
        p = flow.particles
        medium, state = (*flow.crossed_medium, flow.held), (flow.velocity, p.position, p.velocity, p.get("affine"))
        _core.settle(flow.grid.core, *medium, *state, flow.interfaces)


def move(flow: Flow, dt: float, interpolated: bool) -> None:
    """Moves the particles with the pore velocity of the grid over dt [s], by the midpoint rule (19).

    interpolated: whether the velocities of the particles are those of the grid, linearly interpolated to where they
    are, as `Transfer.to_particles` says; the first half of the step then does not interpolate again.
    """
    with crossing(flow, dt, dt):
        _move(flow, dt, interpolated)


def _move(flow: Flow, dt: float, interpolated: bool) -> None:
    p, before = flow.particles, near_crests(flow, flow.particles.position)
    velocity, volume, bulk = (p.velocity, p.volume, flow.bulk) if interpolated else (None, None, None)
    _core.move(
        flow.grid.core, flow.velocity, flow.listed("particle_porosity"), velocity, volume, bulk,
        flow.medium.outline, flow.boundaries.gates, dt, p.position, flow.boundaries.walls, flow.interfaces,
    )  # fmt: skip
    book_crossings(flow, before)


def drift(flow: Flow, start: FloatArray, velocity: FloatArray, porosity: FloatArray | None, dt: float) -> None:
    """Moves the particles from `start` (N, d) [m] over dt [s] with velocities of their own (N, d) [m/s].

    The scheme jh2020 does so twice in a step. The first time they have Darcy velocities and their porosity (N,), and
    turn as C_r changes. The second time they have pore velocities and no porosity: they have turned already, but the
    grid has the velocities of this step, with which momentum falls behind (`crossing`).
    """
    position, solids, between = flow.particles.position, flow.medium.outline, flow.boundaries
    with crossing(flow, *((dt, 0.0) if porosity is not None else (0.0, dt))):
        _core.drift(flow.grid.core, start, velocity, porosity, solids, between.gates, dt, position, between.walls)


def arrive(flow: Flow, start: FloatArray, velocity: FloatArray, dt: float) -> None:
    """Moves the particles from `start` (N, d) [m] with pore velocities of their own [m/s] to their final places."""
    drift(flow, start, velocity, None, dt)
    book_crossings(flow, near_crests(flow, start))
