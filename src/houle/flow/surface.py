"""Where the water is: particles in the order of their cells, fill, depth below the free surface, cells under water."""

from __future__ import annotations

from houle import _core
from houle.errors import SimulationError
from houle.flow.state import Flow
from houle.grid import FloatArray

MOST_CONTRAST = 30.0  # of C_r/n^2 at an interface that the Bernoulli force carries water across


def sort(flow: Flow, *more: FloatArray) -> tuple[FloatArray, ...]:
    """Particles in the order of their cells: neighbours in space are neighbours in memory. Sorts `more` along."""
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
    """Particles sorted, medium sampled where they are, surface found: what a step starts from and leaves."""
    sort(flow)
    flow.fastest = flow.max_pore_speed()
    find_surface(flow)


def find_surface(flow: Flow) -> None:
    """Fill fraction of the pores of every cell; depth below the free surface; cells under water.

    Valid for particles moved by up to two cells since they were sorted.
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
