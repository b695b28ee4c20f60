"""Motion of the particles: with the grid or with velocities of their own, past walls, interfaces and crests."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from houle import _core
from houle.flow.state import Flow
from houle.flow.surface import find_surface, sort
from houle.flow.transfer import interpolate
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


@contextmanager
def crossing(flow: Flow, dt: float, behind: float) -> Iterator[None]:
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
    medium = (*flow.crossing, flow.held, flow.medium.listed("lag"), flow.medium.listed("particle_porosity"))
    on_faces, change = flow.grid.faces(), np.empty_like(flow.particles.velocity)
    _core.fall_behind(flow.grid.core, *medium, flow.velocity, dt, on_faces, flow.interfaces)
    interpolate(flow, on_faces, change)
    return change


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


def near_crests(flow: Flow, position: FloatArray) -> list[FloatArray]:
    """Copies of the positions near each crest."""
    return [position[crest.near(flow.start)].copy() for crest in flow.crests]


def book_crossings(flow: Flow, before: list[FloatArray]) -> None:
    """Books what crosses the crests on the way from there to where the particles are now."""
    p = flow.particles
    for crest, was in zip(flow.crests, before, strict=True):
        near = crest.near(flow.start)
        crest.moved(was, p.position[near], p.volume[near])
