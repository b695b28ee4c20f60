"""What a motion of particles crosses: interfaces between porosities, where their velocities change, and crests."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from houle import _core
from houle.flow.state import Flow
from houle.grid import FloatArray


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
    flow.interpolate(on_faces, change)
    return change


def near_crests(flow: Flow, position: FloatArray) -> list[FloatArray]:
    """Copies of the positions near each crest."""
    return [position[crest.near(flow.start)].copy() for crest in flow.crests]


def book_crossings(flow: Flow, before: list[FloatArray]) -> None:
    """Books what crosses the crests on the way from there to where the particles are now."""
    p = flow.particles
    for crest, was in zip(flow.crests, before, strict=True):
        near = crest.near(flow.start)
        crest.moved(was, p.position[near], p.volume[near])
