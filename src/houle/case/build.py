"""From the tables of a case file to physics: `build(case)` makes the `Setup` from which a simulation is made.

    Simulation(build(case), threads)

This is the one place that knows both sides: nothing under flow, medium, boundary, waves or observe reads a table, and
no table computes. What stands in a tank is built when its flow is (a run builds its flow anew on a higher grid), so
boundaries and observers are functions here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from houle.boundary import gate, sponge
from houle.boundary.absorbing import Drive
from houle.boundary.internal_source import FiniteSource, InternalSource, Source, make_source, source_width
from houle.boundary.open_side import OpenSide, Record
from houle.boundary.paddle import Paddle
from houle.boundary.relaxation_zone import RelaxationZone
from houle.boundary.sponge import damping, way_length
from houle.case.instruments import instruments
from houle.case.model import Case
from houle.case.tables.sides import COLUMNS, Open
from houle.case.tables.tank import Absorber, Gate, Porous, Resistance, Sponge
from houle.case.tables.waves import Waves
from houle.data.csv_table import header
from houle.data.files import require_file
from houle.data.history import History, read_history
from houle.errors import CaseError
from houle.flow.boundaries import Boundary
from houle.flow.particles import Particles
from houle.flow.rows import MARGIN
from houle.flow.setup import Fluid, Make, Numerics, Setup, TimeControl, Water
from houle.flow.viscosity import longest_step
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.resistance import LAWS, Pair, from_permeability, inertia_coefficient
from houle.medium.sections import PorousBody
from houle.medium.shapes import shape_of
from houle.waves.piston import Law, Reading, law_of, reading_of
from houle.waves.wave import Wave

LEAST = 2  # rows of the file of an open side


def build(case: Case) -> Setup:
    """The physics of a case. Raises CaseError where a file that it names, or its wave, cannot be had."""
    d, wave = case.dimension, case.wave
    period = case.drag_period if case.porous else math.inf
    return Setup(
        grid=case.domain.grid,
        rows=first_rows(case),
        water=tuple(Water(shape_of(entry, d), entry.velocity) for entry in case.water),
        bodies=tuple(porous_body(entry, d, case.fluid.viscosity, period) for entry in case.porous),
        solids=tuple(shape_of(entry, d) for entry in case.solid),
        fluid=Fluid(
            case.fluid.density, case.fluid.viscosity, case.fluid.smagorinsky, case.fluid.gravity, case.acceleration
        ),
        numerics=Numerics(**case.numerics.model_dump()),
        time=TimeControl(case.time.end, case.time.courant, case.time.step, viscous_step(case)),
        no_slip=case.domain.walls.no_slip(d),
        settles=not case.gate,
        boundaries=tuple(_boundaries(case, wave)),
        instruments=instruments(case),
        wave=wave,
    )


def first_rows(case: Case) -> int:
    """Rows of cells to start with. The whole domain where waves are made or sides are open or move: they reach over its
    height.
    """
    grid = case.domain.grid
    if case.waves is not None or case.open or case.absorber:
        return grid.shape[-1]
    shapes = [shape_of(entry, case.dimension).bounds[1][-1] for entry in (*case.water, *case.porous, *case.solid)]
    highest = max(0.0, *shapes, *(kind.highest for kind in instruments(case)))
    rows = math.ceil(min(highest, grid.size[-1]) / grid.spacing[-1]) + MARGIN
    return min(rows, grid.shape[-1])


def viscous_step(case: Case) -> float:
    """Longest stable time step [s] with the viscosity of the fluid, which is explicit; inf without."""
    held = any(map(any, case.domain.walls.no_slip(case.dimension)))
    return longest_step(case.domain.grid, case.fluid.viscosity, case.numerics.scheme == "jh2020", held)


# ---- porous bodies -----------------------------------------------------------------------------------------------


def porous_body(entry: Porous, dimension: int, viscosity: float, period: float) -> PorousBody:
    """The body of a table, for water of this viscosity [m2/s] and waves of this period [s], inf: steady flow."""
    a, b = coefficients(entry.resistance, entry.porosity, entry.grain_diameter, viscosity, period)
    inertia = inertia_coefficient(entry.porosity, entry.added_mass)
    on_rate = entry.added_mass_on == "rate"
    return PorousBody(entry.name, shape_of(entry, dimension), entry.porosity, a, b, inertia, on_rate)


def coefficients(
    resistance: Resistance,
    porosity: float,
    grain_diameter: float | None,
    viscosity: float,
    period: float = math.inf,
) -> Pair:
    """Canonical a [1/s], b [1/m] of a body as its case file gives it. A law needs the grain diameter [m].

    period  of the waves [s], for the laws that know it, unless the file gives kc or a period itself; inf: steady flow
    """
    r = resistance
    if r.law is not None:
        if grain_diameter is None:
            raise ValueError(f"the law {r.law} needs a grain diameter")
        return LAWS[r.law](porosity, grain_diameter, viscosity, **stated(r, period))
    if r.permeability is not None and r.forchheimer is not None:
        return from_permeability(r.permeability, r.forchheimer, viscosity)
    if r.a is None or r.b is None:
        raise ValueError("resistance needs a law, or a and b, or permeability and forchheimer")
    return r.a, r.b


def stated(r: Resistance, period: float) -> dict[str, float]:
    """Coefficients of the law that the file states itself, and the period of the waves if it says nothing of it."""
    given = r.given
    if r.law is None or not LAWS[r.law].knows_period or {"kc", "period"} & set(given) or period == math.inf:
        return given
    return {**given, "period": period}


# ---- boundaries --------------------------------------------------------------------------------------------------


def _boundaries(case: Case, wave: Wave | None) -> Iterator[Make]:
    """What makes the boundaries, in the order of the case: gates, moving walls, open sides, source or zone, sponges."""
    waves, gravity = case.waves, case.fluid.gravity
    for plate in case.gate:
        yield partial(_gate, plate)
    if waves is not None and waves.piston is not None and wave is not None:
        yield _piston(case, wave)
    for absorber in case.absorber:
        yield partial(_absorber, absorber, wave, gravity)
    for side in case.open:
        yield _open_side(case, side, wave)
    if waves is not None and waves.piston is None and wave is not None:
        yield _maker(waves, wave, all(side.side != "left" for side in case.open))
    for box in case.sponge:
        yield partial(_sponge, box, wave, gravity)


def _gate(table: Gate, grid: Grid, medium: Medium, water: Particles) -> Boundary:
    return gate.Gate(grid, table.x, table.speed, table.start)


def law_of_piston(case: Case, wave: Wave) -> tuple[Law, Reading, float]:
    """How the piston of a case moves, what it reads, and where it stands at rest [m]. Raises CaseError."""
    waves = case.waves
    assert waves is not None and waves.piston is not None
    rest = case.domain.grid.nearest_face(waves.piston.x)
    read = reading_of(wave, wave.depth, wave.gravity)
    return law_of(wave, rest, read, waves.ramp_time(), regular=waves.kind == "regular"), read, rest


def _piston(case: Case, wave: Wave) -> Make:
    law, read, rest = law_of_piston(case, wave)
    absorb = case.waves is not None and case.waves.piston is not None and case.waves.piston.absorb

    def piston(grid: Grid, medium: Medium, water: Particles) -> Boundary:
        return Paddle("piston", grid, rest, 1, Drive(law, read, grid, absorb))

    return piston


def source_of(table: Waves, wave: Wave) -> Source:
    """The source of [waves], its width known."""
    given = table.source
    assert given is not None
    return Source(given.x, source_width(given.width, table.kind, wave), given.form, given.side)


def make_maker(
    table: Waves, wave: Wave, grid: Grid, wall: bool = True
) -> InternalSource | FiniteSource | RelaxationZone:
    """The maker inside the water that the table asks for; `wall`: at a left side that is not open. Raises WaveError."""
    if table.zone is not None:
        return RelaxationZone.of(table.zone.x, wave, grid, table.ramp_time(), wall)
    return make_source(source_of(table, wave), table.kind, wave, grid, table.ramp_time(), table.current)


def _maker(waves: Waves, wave: Wave, wall: bool) -> Make:
    """The maker inside the water; wall: whether the left side of the tank is one."""

    def maker(grid: Grid, medium: Medium, water: Particles) -> Boundary:
        return make_maker(waves, wave, grid, wall)

    return maker


def _sponge(table: Sponge, wave: Wave | None, gravity: float, grid: Grid, medium: Medium, water: Particles) -> Boundary:
    """A sponge as strong as its table says, or as takes up the waves that are made, or long waves."""
    speed = math.sqrt(gravity * float(water.position[:, -1].max())) if wave is None else wave.group_velocity
    strength = table.strength or damping(speed, way_length(table.box, grid))
    return sponge.Sponge(grid, table.box, strength, table.name)


def _absorber(
    table: Absorber, wave: Wave | None, gravity: float, grid: Grid, medium: Medium, water: Particles
) -> Boundary:
    """A wall that absorbs what reaches it, by the depth of the water there."""
    rest, side = grid.nearest_face(table.x), 1 if table.side == "left" else -1
    column = round(rest / grid.spacing[0]) + min(side, 0)
    depth = float(np.mean(water.depths(grid)[column]))
    read = reading_of(wave, depth, gravity, table.period)
    return Paddle(table.name, grid, rest, side, Drive(None, read, grid, True))


def records(table: Open, folder: Path) -> dict[str, Record]:
    """What an open side prescribes against time, by the keys of COLUMNS. Raises CaseError."""
    if table.file is None:
        constant = {key: getattr(table, key) for key in COLUMNS if getattr(table, key) is not None}
        return {key: Record(np.zeros(1), np.array([value])) for key, value in constant.items()}
    names, known = history(table, folder)
    return {name: Record(known.time, value) for name, value in zip(names, known.values, strict=True)}


def history(table: Open, folder: Path) -> tuple[list[str], History]:
    """What the file of an open side holds: keys of COLUMNS, their values on the clock of the run. Raises CaseError."""
    file, key = folder / str(table.file), f"open.{table.side}.file"
    require_file(file, key)
    there = {name: column for name, column in COLUMNS.items() if column in header(file, key)}
    if not there or {"velocity", "discharge"} <= set(there):
        raise CaseError(
            f"{key} = {file} needs a column t_s and one of velocity_m_s, discharge_m2_s, level_m, or level_m with one "
            f"of the others; it has {', '.join(there.values()) or 'none of them'}"
        )
    return list(there), read_history(file, tuple(there.values()), key, LEAST, table.start)


def _open_side(case: Case, table: Open, wave: Wave | None) -> Make:
    """An open side; the left one belongs to the wave that a relaxation zone makes."""
    known, waves, gravity = records(table, case.folder), case.waves, case.fluid.gravity

    def open_side(grid: Grid, medium: Medium, water: Particles) -> Boundary:
        faces = medium.open_faces[0].astype(float)
        far = table.side == "right"
        side = OpenSide.of(far, known, table.ramp, table.response, gravity, grid, faces, water)
        if waves is not None and waves.zone is not None and not far:
            side.wave, side.wave_ramp = wave, waves.ramp_time()
            side.long_from = waves.zone.x[1] if waves.kind in ("series", "solitary") else 0.0
        return side

    return open_side
