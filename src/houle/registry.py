"""Tables of choices, one per kind: what a case file offers, such as resistance laws and wave theories; design formulas.

A row has a name, a description, a range and a source. It stands beside the class or function that it describes, and is
added to the table of its kind. Everyone who needs the choices asks here by their kind: the case file for the values
that it allows, `houle describe`, the site and the tests for descriptions and sources. So a choice is added in one
place, and its name is written once. This module is cheap to import: it imports the module of a table when the table is
asked for.

    choices("law")["van-gent-1995"].source
"""

from __future__ import annotations

import pkgutil
from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module
from typing import Any, Protocol, TypeVar

TABLES = {
    "law": ("houle.medium.resistance", "LAWS"),
    "theory": ("houle.waves.wave", "THEORIES"),
    "waves": ("houle.waves.wave", "KINDS"),
    "boundary": ("houle.flow.boundaries", "BOUNDARIES"),
    "scheme": ("houle.flow.schemes", "SCHEMES"),
    "transfer": ("houle.flow.transfer", "TRANSFERS"),
    "kernel": ("houle.flow.kernels", "KERNELS"),
    "remesh": ("houle.flow.remeshers", "REMESHERS"),
    "formula": ("houle.design.formula", "FORMULAS"),
}  # kind of choice: the module of its table, and the name of the table there


class Row(Protocol):
    """A choice: a class or an object with these attributes.

    name    its name in the case file
    what    a description of it, in a sentence or two
    range   the range in which it holds; "" if it holds everywhere
    source  its source in the literature or in our documents
    """

    @property
    def name(self) -> str: ...

    @property
    def what(self) -> str: ...

    @property
    def range(self) -> str: ...

    @property
    def source(self) -> str: ...


R = TypeVar("R", bound=Row)


class Choices(Mapping[str, R]):
    """The rows of one kind by name, in the order in which they were added, or by `place` where the rows have one.

    kind     name of the kind, for messages
    package  a package whose modules add rows when they are imported: all of them are imported before a row is read;
             "" where the rows are given
    """

    def __init__(self, kind: str, rows: Iterable[R] = (), package: str = "") -> None:
        self.kind, self._package = kind, package
        self._rows: dict[str, R] = {}
        self._complete = not package
        for row in rows:
            self.add(row)

    def add(self, row: R) -> None:
        """Adds a row. Raises ValueError if another row has its name."""
        if self._rows.get(row.name, row) is not row:
            raise ValueError(f"there are two choices of kind {self.kind} with the name {row.name}: rename one of them")
        self._rows[row.name] = row

    def remove(self, name: str) -> None:
        """Takes a row out again."""
        del self._rows[name]

    def _read(self) -> dict[str, R]:
        if not self._complete:
            self._complete = True
            for module in pkgutil.iter_modules(import_module(self._package).__path__, f"{self._package}."):
                import_module(module.name)
            self._rows = dict(sorted(self._rows.items(), key=lambda item: getattr(item[1], "place", 0)))
        return self._rows

    def __getitem__(self, name: str) -> R:
        return self._read()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._read())

    def __len__(self) -> int:
        return len(self._read())


def choices(kind: str) -> Choices[Any]:
    """The table of a kind of choice, one of `TABLES`."""
    module, name = TABLES[kind]
    table: Choices[Any] = getattr(import_module(module), name)
    return table
