"""Motion of the particles: with the grid or with velocities of their own, past walls, interfaces and crests."""

from __future__ import annotations

from houle import _core
from houle.flow.crossing import book_crossings, crossing, near_crests
from houle.flow.state import Flow
from houle.flow.surface import find_surface, sort
from houle.grid import FloatArray


def begin(flow: Flow, dt: float) -> None:
    """Boundaries at the start of a step of dt [s]: gates stand where they are by now, walls decide where to go."""
    flow.last_step, flow.step_size = flow.step_size, dt
    for boundary in flow.boundaries:
        boundary.begin(flow, dt)
    if flow.stand():
        flow.sample_medium()
        find_surface(flow)


def move_walls(flow: Flow) -> None:
    """Moving walls to where they are at the end of the step."""
    for boundary in flow.boundaries:
        boundary.advance(flow)
    flow.stand()


def exchange(flow: Flow, dt: float) -> None:
    """Lets water in and takes water out for a step of dt [s], after the particles have moved."""
    if not (open_ := flow.boundaries.that("exchange")):
        return
    for boundary in open_:
        boundary.exchange(flow, dt)
    sort(flow)


def settle(flow: Flow) -> None:
    """Near porous faces where no pressure holds the water: particles take no more energy than the grid has there."""
    if flow.porous:
        p = flow.particles
        medium, state = (*flow.crossing, flow.held), (flow.velocity, p.position, p.velocity, p.get("affine"))
        _core.settle(flow.grid.core, *medium, *state, flow.interfaces)


def move(flow: Flow, dt: float, linear: bool) -> None:
    """Particles along the pore velocity of the grid, midpoint rule. linear: whether they have that velocity where they
    are, as `Transfer.to_particles` says: then it is not interpolated again.
    """
    with crossing(flow, dt, dt):
        _move(flow, dt, linear)


def _move(flow: Flow, dt: float, linear: bool) -> None:
    p, before = flow.particles, near_crests(flow, flow.particles.position)
    velocity, volume, bulk = (p.velocity, p.volume, flow.bulk) if linear else (None, None, None)
    _core.move(
        flow.grid.core, flow.velocity, flow.listed("particle_porosity"), velocity, volume, bulk,
        flow.medium.outline, flow.boundaries.gates, dt, p.position, flow.boundaries.walls, flow.interfaces,
    )  # fmt: skip
    book_crossings(flow, before)


def drift(flow: Flow, start: FloatArray, velocity: FloatArray, porosity: FloatArray | None, dt: float) -> None:
    """Particles from `start` with velocities of their own. Without a porosity, a second time: the turn is done, and the
    velocities on the grid are those of this step.
    """
    position, solids, between = flow.particles.position, flow.medium.outline, flow.boundaries
    with crossing(flow, *((dt, 0.0) if porosity is not None else (0.0, dt))):
        _core.drift(flow.grid.core, start, velocity, porosity, solids, between.gates, dt, position, between.walls)


def arrive(flow: Flow, start: FloatArray, velocity: FloatArray, dt: float) -> None:
    """Particles from `start` with pore velocities of their own, to where they stay."""
    drift(flow, start, velocity, None, dt)
    book_crossings(flow, near_crests(flow, start))
