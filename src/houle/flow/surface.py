"""The place of the water: sorts the particles by cell and finds fill, free surface and cells under water.

Section 4 of docs/theory.md; the equations are in core/houle/water/surface.hpp and columns.hpp.
"""

from __future__ import annotations

from houle import _core
from houle.errors import SimulationError
from houle.flow.state import MOST_CONTRAST, Flow
from houle.grid import FloatArray


def sort(flow: Flow, *more: FloatArray) -> tuple[FloatArray, ...]:
    """Sorts the particles by cell, so that neighbours in space are neighbours in memory, and samples the medium there.

    Returns the arrays `more` (N, ...), which have a row per particle, in the new order.
    """
    work = flow.work
    work.resize(len(flow.particles))
    try:
        flow.particles.sort(flow.grid, work.spare, work.order, flow.start)
    except FloatingPointError as error:
        raise SimulationError(
            str(error),
            diagnosis="A particle is where no water can be, most often because a velocity became infinite or not a "
            "number in this step.",
        ) from error
    flow.sample_medium()
    return tuple(values[work.order] for values in more)


def arrange(flow: Flow) -> None:
    """Arranges the flow: sorts the particles, samples the medium at them, finds the free surface.

    A step starts from an arranged flow and leaves one.
    """
    sort(flow)
    flow.fastest = flow.max_pore_speed()
    find_surface(flow)


def find_surface(flow: Flow) -> None:
    """Finds the fill (7) of every cell, the levels of the columns (9), the depths (8) and the cells under water.

    Particles may have moved by up to two cells since they were sorted.
    """
    core, position, mixed = flow.grid.core, flow.particles.position, flow.mixed
    volume, walls, gates = flow.particles.volume, flow.boundaries.walls, flow.boundaries.gates
    _core.scatter_cells(
        core,
        flow.start,
        position,
        volume,
        flow.fill,
        flow.boundaries.walls,
        flow.inverse_capacity,
        flow.boundaries.gates,
    )
    _core.column_heights(core, flow.start, position, volume, flow.water_height, walls, gates)
    _core.column_levels(
        core, flow.water_height, flow.column_porosity, flow.fill, flow.inverse_capacity,
        mixed.column, mixed.start, mixed.pieces, flow.filled_level,
    )  # fmt: skip
    _core.find_surface(
        core, flow.fill, flow.medium.listed("open_cells"), flow.filled_level, flow.submergence, flow.active,
        flow.single_level, flow.eta, gates,
    )  # fmt: skip
    for boundary in flow.boundaries:
        boundary.dry(flow)
    if flow.porous:
        cells = (flow.medium.listed("open_cells"), flow.medium.listed("contrast"))
        _core.hold_faces(core, flow.active, *cells, MOST_CONTRAST, flow.held)
