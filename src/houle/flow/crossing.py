"""Crossings in a motion of particles: of interfaces between porosities, which change velocities, and of crests.

A crest is a section at which overtopping is counted (crest.py).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from houle import _core
from houle.flow.state import Flow
from houle.grid import FloatArray


@contextmanager
def crossing(flow: Flow, dt: float, behind: float) -> Iterator[None]:
    """Surrounds a motion of dt [s] in which particles may cross to another porosity.

    Where no pressure holds it, a particle keeps its kinetic energy on the way, and its velocity turns as C_r changes
    (docs/theory.md, (14a) and (4a)). behind: time [s] over which momentum falls behind the water where the added mass
    stands before the local acceleration alone, (19a); 0 for none.
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
    """K/C_r (N,) at the particles, the share of their velocity with which momentum moves; None: 1 everywhere."""
    if flow.lag is None:
        return None
    share, (number, lag) = np.empty(len(flow.particles)), flow.lag
    _core.gather_cells(flow.grid.core, flow.particles.position, lag[number], share)
    return 1.0 - share


def _fall_behind(flow: Flow, dt: float) -> FloatArray:
    """Change of the velocities (N, d) [m/s] in dt [s], as momentum moves with K/C_r of the velocity: (19a)."""
    medium = (*flow.crossed_medium, flow.held, flow.medium.listed("lag"), flow.medium.listed("particle_porosity"))
    on_faces, change = flow.grid.faces(), np.empty_like(flow.particles.velocity)
    _core.fall_behind(flow.grid.core, *medium, flow.velocity, dt, on_faces, flow.interfaces)
    flow.interpolate(on_faces, change)
    return change


def near_crests(flow: Flow, position: FloatArray) -> list[FloatArray]:
    """Copies of the positions of the particles near each crest, one array (n, d) [m] per crest."""
    return [position[crest.near(flow.start)].copy() for crest in flow.crests]


def book_crossings(flow: Flow, before: list[FloatArray]) -> None:
    """Books the water that crossed the crests between these positions, of `near_crests`, and the present ones."""
    p = flow.particles
    for crest, was in zip(flow.crests, before, strict=True):
        near = crest.near(flow.start)
        crest.moved(was, p.position[near], p.volume[near])
