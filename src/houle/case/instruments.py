"""From the tables of what is observed to the instruments of `houle.observe`, and the tank that they stand in."""

from __future__ import annotations

import pkgutil
from collections.abc import Iterator
from importlib import import_module
from typing import Any

from houle import observe
from houle.case.model import Case
from houle.flow.observer import Instruments, Observer, Site
from houle.medium.shapes import shape_of
from houle.observe.ledger import Books, LedgerRow
from houle.observe.paddle import MovingWall, PaddlePositions

ALWAYS: tuple[type[Observer[Any]], ...] = (PaddlePositions, LedgerRow)  # observers that no table asks for


def asked_by_tables() -> dict[str, type[Observer[Any]]]:
    """The observers that tables of the case file ask for, by the key of the table: those of every file of
    `houle.observe`, and others that have been defined.
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
        open=tuple(table.side for table in case.open),
    )


def instruments(case: Case) -> tuple[Instruments, ...]:
    """Everything that a case observes: what its tables say, its moving walls, and the ledger."""
    site = site_of(case)
    asked = (asked_for(case, key, site) for key in case.observed())
    return (*(kind for kind in asked if kind.them), *_always(case, site))


def asked_for(case: Case, key: str, site: Site) -> Instruments:
    """The instruments of the tables [[key]]: each has the keys of its table."""
    observer = asked_by_tables()[key]
    rows = ({name: getattr(row, name) for name in type(row).model_fields} for row in getattr(case, key))
    return Instruments(observer, tuple(observer.instrument(**row) for row in rows), site)


def _always(case: Case, site: Site) -> Iterator[Instruments]:
    piston = case.waves.piston if case.waves is not None else None
    walls = [MovingWall("piston", piston.x)] if piston is not None else []
    walls += [MovingWall(absorber.name, absorber.x) for absorber in case.absorber]
    if walls:
        yield Instruments(PaddlePositions, tuple(walls), site)
    yield Instruments(LedgerRow, (Books(by_levels=case.waves is not None),), site)
