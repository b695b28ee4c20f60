"""Tables of what there is to choose: for each kind rows with name, what it is, where it holds, its source.

They are the choices that a case file offers, and the design formulas. A row stands beside the class or function that
it is about, in the table of its room. Who wants to know what there is asks here by the kind of choice: the case file
for the values that it allows, `houle describe`, the site and the tests for words and sources. So a choice is added in
one place, and its name is written once. This module imports no room before it is asked, and is cheap to import.

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
}  # kind of choice: the module that holds its table, and what the table is called there


class Row(Protocol):
    """What every choice says about itself: a class with these attributes, or an object.

    name    in the case file
    what    it is, in a sentence or two
    range   in which it holds, "" where it holds everywhere
    source  in the literature or in our documents
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

    package: whose modules add rows as they are imported, all of them before a row is read; "" where none does.
    """

    def __init__(self, kind: str, rows: Iterable[R] = (), package: str = "") -> None:
        self.kind, self._package = kind, package
        self._rows: dict[str, R] = {}
        self._complete = not package
        for row in rows:
            self.add(row)

    def add(self, row: R) -> None:
        """Adds a row. ValueError where the name is taken: two choices of one name would hide each other."""
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
