"""From the tables of a case file to physics: `build(case)` makes the `Setup` from which a simulation is made.

    Simulation(build(case), threads)

This is the one place that knows both sides: nothing under flow, medium, boundary, waves or observe reads a table, and
no table computes. A run may build its flow anew on a higher grid, and boundaries and observers with it: so the setup
holds functions that make these.
"""

from __future__ import annotations

import math
import pkgutil
from collections.abc import Iterator
from dataclasses import fields
from functools import partial
from importlib import import_module
from typing import Any

from houle import observe
from houle.case.acting import law_of_piston, source_of
from houle.case.model import Case
from houle.case.porous import porous_body
from houle.case.shapes import shape_of
from houle.case.tables.waves import Waves
from houle.errors import CaseError
from houle.flow.boundaries import BOUNDARIES, Surroundings
from houle.flow.observer import Instruments, Observer, Site
from houle.flow.rows import MARGIN
from houle.flow.setup import Fluid, Make, Numerics, Setup, TimeControl, Water
from houle.flow.viscosity import longest_step
from houle.grid import MOST_NUMBERS, Grid
from houle.observe.ledger import Books, LedgerRow
from houle.observe.paddle import MovingWall, PaddlePositions
from houle.observe.snapshot import Snapshots
from houle.waves.wave import Wave

ALWAYS: tuple[type[Observer[Any]], ...] = (PaddlePositions, LedgerRow)  # observers that no table asks for


def build(case: Case) -> Setup:
    """The physics of a case.

    Raises CaseError if a file that it names cannot be read, if no theory gives its wave, and if it has too many cells.
    """
    _require_numbers(case.domain.grid)
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
        rough=tuple(entry.roughness for entry in case.solid),
        rough_sides=case.domain.walls.rough(d, smooth=case.numerics.scheme != "jh2020"),
        settles=not any(BOUNDARIES[key].divides for key, _ in case.standing),
        boundaries=_boundaries(case, wave),
        instruments=instruments(case),
        frames=Snapshots,
        wave=wave,
    )


def _require_numbers(grid: Grid) -> None:
    """Raises CaseError if the grid has more cells than the core can number, before memory is asked for."""
    cells = math.prod(grid.shape)
    if cells > MOST_NUMBERS:
        finer = min(grid.spacing) * (1.01 * cells / MOST_NUMBERS) ** (1 / grid.dimension)
        raise CaseError(
            f"domain.spacing = {min(grid.spacing):.3g} makes {cells:.3g} cells: at most {MOST_NUMBERS:.3g} can be "
            f"numbered, from spacing = {finer:.2g} m on"
        )


def first_rows(case: Case) -> int:
    """Number of rows of cells with which a run starts (`houle.flow.rows`).

    All rows of the domain where waves are made, or where sides are open or move: these reach over its whole height.
    """
    grid = case.domain.grid
    if case.waves is not None or any(BOUNDARIES[key].full_height for key, _ in case.standing):
        return grid.shape[-1]
    shapes = [shape_of(entry, case.dimension).bounds[1][-1] for entry in (*case.water, *case.porous, *case.solid)]
    highest = max(0.0, *shapes, *(kind.highest for kind in instruments(case)))
    rows = math.ceil(min(highest, grid.size[-1]) / grid.spacing[-1]) + MARGIN
    return min(rows, grid.shape[-1])


def viscous_step(case: Case) -> float:
    """Longest stable time step [s] with the viscosity of the fluid, which is explicit; inf without."""
    return longest_step(case.domain.grid, case.fluid.viscosity, case.numerics.scheme == "jh2020")


def _boundaries(case: Case, wave: Wave | None) -> tuple[Make, ...]:
    """Functions that make the boundaries, in the order of `BoundaryKind.place`."""
    waves = case.waves
    rest = Surroundings(
        gravity=case.fluid.gravity,
        wave=wave,
        ramp=waves.ramp_time() if waves is not None else 0.0,
        zone=waves.zone.x if waves is not None and waves.zone is not None else None,
        lets_long=waves is not None and waves.kind in ("series", "solitary", "ship"),
        open_left=any(side.side == "left" for side in case.open),
    )
    found = [(BOUNDARIES[key], table.keys(case.folder)) for key, table in case.standing]
    if waves is not None and wave is not None:
        key, keys = maker(case, waves, wave)
        found.append((BOUNDARIES[key], keys))
    found.sort(key=lambda entry: entry[0].place)
    return tuple(partial(kind.make, rest, **keys) for kind, keys in found)


def maker(case: Case, waves: Waves, wave: Wave) -> tuple[str, dict[str, Any]]:
    """The kind of boundary that makes the waves, and the arguments of its `make`."""
    if waves.piston is not None:
        law, read, rest = law_of_piston(case, wave)
        return "piston", {"rest": rest, "law": law, "read": read, "absorb": waves.piston.absorb}
    if waves.zone is not None:
        return "zone", {"x": waves.zone.x}
    return "source", {"source": source_of(waves, wave), "kind": waves.kind, "current": waves.current}


# ---- observables ----------------------------------------------------------------------------------------------------


def asked_by_tables() -> dict[str, type[Observer[Any]]]:
    """The classes of observers by the key of the table that asks for them.

    They are those of every file of `houle.observe`, and others that a user has defined.
    """
    for module in pkgutil.iter_modules(observe.__path__, "houle.observe."):
        import_module(module.name)
    return {observer.table: observer for observer in Observer.__subclasses__() if observer.table}


def site_of(case: Case) -> Site:
    """The tank of a case as its instruments know it."""
    d = case.dimension
    return Site(
        size=case.domain.size,
        grid=case.domain.grid,
        density=case.fluid.density,
        porous={body.name: shape_of(body, d) for body in case.porous},
        solid={body.name: shape_of(body, d) for body in case.solid},
        grains={body.name: body.grain_diameter for body in case.porous if body.grain_diameter is not None},
        open=tuple(table.side for table in case.open),
    )


def instruments(case: Case) -> tuple[Instruments, ...]:
    """All instruments of a case, by kind: those of its tables, its moving walls, and the ledger."""
    site = site_of(case)
    asked = (asked_for(case, key, site) for key in case.observed())
    return (*(kind for kind in asked if kind.them), *_always(case, site))


def asked_for(case: Case, key: str, site: Site) -> Instruments:
    """The instruments that the tables [[key]] ask for, each with those keys of its table that it knows.

    Other keys are for what is made of the results.
    """
    observer = asked_by_tables()[key]
    kind: Any = observer.instrument
    known = {field.name for field in fields(kind)}
    rows = (
        {name: getattr(row, name) for name in type(row).model_fields if name in known} for row in getattr(case, key)
    )
    return Instruments(observer, tuple(kind(**row) for row in rows), site)


def _always(case: Case, site: Site) -> Iterator[Instruments]:
    piston = case.waves.piston if case.waves is not None else None
    walls = [MovingWall("piston", piston.x)] if piston is not None else []
    walls += [MovingWall(absorber.name, absorber.x) for absorber in case.absorber]
    if walls:
        yield Instruments(PaddlePositions, tuple(walls), site)
    yield Instruments(LedgerRow, (Books(by_levels=case.waves is not None),), site)
