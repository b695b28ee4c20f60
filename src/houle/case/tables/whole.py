"""All tables of a case file: the order in which they are written out, and their consistency with each other.

A table checks its own keys. Here are the checks of dimensions, of names, and of tables that need others.
"""

from __future__ import annotations

from typing import Annotated, get_args

from pydantic import Field

from houle.case import messages
from houle.case.tables.base import Table
from houle.case.tables.boundaries import Boundaries
from houle.case.tables.control import Numerics, Output, Time
from houle.case.tables.observed import Observed
from houle.case.tables.results import Reference, Reflection
from houle.case.tables.tank import Domain, Fluid, Head, Porous, Solid, Water
from houle.case.tables.waves import PASSING

WEAK = 1e-3  # [m/s2] a weaker gravity makes no waves


class Tank(Table):
    """The tables of a case about the tank, the water and the bodies in it."""

    case: Head
    domain: Domain
    fluid: Fluid = Fluid()
    water: Annotated[
        tuple[Water, ...], Field(strict=False, min_length=1, description="where water stands at the start")
    ]
    porous: Annotated[tuple[Porous, ...], Field(strict=False, max_length=100, description="porous bodies")] = ()
    solid: Annotated[tuple[Solid, ...], Field(strict=False, description="impermeable bodies")] = ()


class Course(Table):
    """The tables of a case about the course of the run and the evaluation of its results."""

    time: Time
    numerics: Numerics = Numerics()
    output: Output = Output()
    reflection: Reflection | None = None
    reference: Reference | None = None


class Tables(Course, Observed, Boundaries, Tank):
    """All tables of a case file."""


def prefixes(case: type[Tables]) -> dict[str, str]:
    """Keys of the tables whose rows have names, and the prefix of the names of those that give none."""
    rows = {key: (*get_args(info.annotation), None)[0] for key, info in case.model_fields.items()}
    return {key: row.prefix for key, row in rows.items() if getattr(row, "prefix", "")}


def disagreements(case: Tables) -> list[str]:
    """All contradictions between the tables of a case, one line each: key, value, cure."""
    d, found = case.domain.dimension, []
    for key in ("water", "porous", "solid", "sponge"):
        for i, shape in enumerate(getattr(case, key)):
            if shape.box is not None and len(shape.box[0]) != d:
                place = messages.place((key, i, "box"), case.__dict__)
                found.append(
                    f"{place} has corners of {len(shape.box[0])} numbers, domain.size has {d}: give {d} everywhere"
                )
    if case.fluid.acceleration is not None and len(case.fluid.acceleration) != d:
        found.append(f"fluid.acceleration has {len(case.fluid.acceleration)} numbers, domain.size has {d}: give {d}")
    if case.fluid.gravity < WEAK and (need := [k for k in ("waves", "absorber", "open") if getattr(case, k)]):
        found.append(
            f"fluid.gravity = {case.fluid.gravity:g} m/s2: there are no waves without gravity, and [{need[0]}] needs "
            f"them: gravity >= {WEAK:g}"
        )
    if case.waves is not None and case.waves.direction and d == 2:
        found.append(f"waves.direction = {case.waves.direction:g} degrees in 2D, where waves go along x: remove it")
    if (case.ship is not None) != (case.waves is not None and case.waves.kind == "ship"):
        found.append(
            'waves.kind = "ship" needs the table [ship]: length, beam, draught, speed, distance, ...'
            if case.ship is None
            else 'ship: [waves] with kind = "ship", depth and zone = {x = [0, to]} makes its waves; or remove [ship]'
        )
    for i, water in enumerate(case.water):
        if water.velocity is not None and len(water.velocity) != d:
            found.append(f"water[{i}].velocity has {len(water.velocity)} numbers, domain.size has {d}: give {d}")
    if len({row.side for row in case.open}) < len(case.open):
        found.append(f'open: the side "{case.open[0].side}" is given twice; put both into one table')
    found += _observables_fit(case) + _until_fits(case)
    for key in prefixes(type(case)):
        names = [row.name for row in getattr(case, key)]
        found += [
            f"{key}: the name {n} is given twice; names must differ"
            for n in sorted({n for n in names if names.count(n) > 1})
        ]
    if case.reflection is not None and case.waves is not None and case.waves.current:
        found.append(
            f"reflection: waves.current = {case.waves.current:g} m/s: incident and reflected waves have other lengths "
            "on a current and cannot be separated; remove [reflection]"
        )
    return found + _reflection_fits(case)


def _observables_fit(case: Tables) -> list[str]:
    """Contradictions between tables of observables and the rest of the case."""
    bodies = {"porous": tuple(b.name for b in case.porous), "solid": tuple(b.name for b in case.solid)}
    return [
        f"{messages.place((key, i, *word.split()), case.__dict__)} {text}"
        for key in case.observed()
        for i, row in enumerate(getattr(case, key))
        for word, text in row.disagreements(case.domain.dimension, bodies)
    ]


def _until_fits(case: Tables) -> list[str]:
    """Contradictions between time.until and the tables whose answers it asks for."""
    until = case.time.until
    if until is None:
        return []
    needed = {
        "q": ("[[overtopping]]", case.overtopping),
        "run_up": ("[[runup]]", case.runup),
        "reflection": ("[reflection]", case.reflection),
    }
    found = [
        f"time.until.{key} = {getattr(until, key):g} asks for an answer of {table}, which is not there: add it, or "
        f"remove {key}"
        for key, (table, there) in needed.items()
        if getattr(until, key) is not None and not there
    ]
    if case.waves is None or case.waves.kind in PASSING:
        stated = "there are no [waves]" if case.waves is None else f'waves.kind = "{case.waves.kind}" passes once'
        found.append(f"time.until counts waves that go on, {stated}: remove it, time.end ends the run")
    return found


def _reflection_fits(case: Tables) -> list[str]:
    """Contradictions between [reflection] and waves, gauges and tank."""
    asked = case.reflection
    if asked is None:
        return []
    if case.waves is None or case.waves.kind in PASSING:
        stated = "there are no [waves]" if case.waves is None else f'waves.kind = "{case.waves.kind}"'
        return [f"reflection needs regular or irregular waves, {stated}: remove [reflection]"]
    place = {gauge.name: gauge.x for gauge in case.gauge}
    named = [("gauges", name) for name in asked.gauges] + [("behind", name) for name in asked.behind]
    found = [
        f"reflection.{key}: there is no gauge {name}.{messages.nearest(name, place)} There are: "
        f"{', '.join(place) or 'none'}"
        for key, name in named
        if name not in place
    ]
    start, structure = case.waves.place, asked.structure
    outside = [x for x in structure if not 0 <= x <= case.domain.size[0]]
    if outside:
        return [*found, f"reflection.structure: {outside[0]:g} m is outside the tank, 0 to {case.domain.size[0]:g}"]
    towards = 1.0 if structure[0] > start else -1.0
    if len(structure) == 2 and towards * (structure[1] - structure[0]) <= 0:
        found.append(
            f"reflection.structure = [{structure[0]:g}, {structure[1]:g}]: first the face that the waves from "
            f"x = {start:g} m meet, then the back"
        )
    for key, name in named:
        after = key == "behind"
        beyond = structure[-1] if after else structure[0]
        if name in place and (towards * (place[name] - beyond) > 0) != after:
            found.append(
                f"reflection.{key}: gauge {name} stands at {place[name]:g} m, {'not ' if after else ''}behind "
                f"{beyond:g} m: move it, or name another"
            )
    return found
