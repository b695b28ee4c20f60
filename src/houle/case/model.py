"""The case file: all its tables in one model, and how it is read. Data only; unknown keys are errors.

The models of `tables/` are named after the TOML tables. They check the file, not the physics of the whole, which
`check/rules.py` does. `messages.py` explains the errors of a file, one line each. To add a key, add a field with its
unit and range.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from math import inf
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PrivateAttr, ValidationError, model_validator
from pydantic.fields import FieldInfo

from houle.case import messages
from houle.case.reading import find, override, plain, read_toml, to_toml
from houle.case.tables.base import Table
from houle.case.tables.whole import Tables, disagreements, prefixes
from houle.case.wave import make
from houle.errors import CaseError
from houle.registry import choices
from houle.waves.wave import Wave


class Case(Tables):
    """A case file of houle: waves and dam-break flow through porous structures. SI units throughout."""

    _path: Path | None = PrivateAttr(None)

    @model_validator(mode="before")
    @classmethod
    def fill_names(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            return value
        value = dict(value)
        for key, prefix in prefixes(cls).items():
            rows = value.get(key)
            if isinstance(rows, (list, tuple)):
                value[key] = [
                    {"name": f"{prefix}{i}", **row} if isinstance(row, dict) else row
                    for i, row in enumerate(rows, start=1)
                ]
        return value

    @model_validator(mode="after")
    def tables_agree(self) -> Case:
        if found := disagreements(self):
            raise ValueError("\n".join(found))
        return self

    @property
    def folder(self) -> Path:
        """The folder of the other files that the case names."""
        return self._path.parent if self._path else Path()

    @property
    def path(self) -> Path | None:
        """The file from which the case was read, None without; other files that it names lie beside it."""
        return self._path

    @property
    def title(self) -> str:
        """Title for pictures: that of the case, or else its name."""
        return self.case.title or self.case.name

    @property
    def laboratory(self) -> Path | None:
        """The file of laboratory points that [reference] names; None without [reference]."""
        return None if self.reference is None else self.folder / self.reference.surface

    @property
    def dimension(self) -> int:
        return self.domain.dimension

    @property
    def acceleration(self) -> tuple[float, ...]:
        """Gravity and fluid.acceleration together, per axis, last up [m/s2]."""
        push = self.fluid.acceleration or (0.0,) * self.dimension
        return (*push[:-1], push[-1] - self.fluid.gravity)

    @property
    def wave(self) -> Wave | None:
        """The wave of [waves]; None without [waves]. Raises WaveError, a CaseError, if no theory gives it."""
        return None if self.waves is None else make(self.waves, self.fluid.gravity, self.folder, self.ship)

    @property
    def drag_period(self) -> float:
        """Period of the oscillating flow in porous bodies [s], for the laws of resistance that depend on it.

        It is the period of regular waves, T_m-1,0 of sums of waves, and infinite without waves or for a single one.
        Raises WaveError as `wave` does.
        """
        wave = self.wave
        parts = None if wave is None else wave.components()
        if wave is None or parts is None:
            return inf
        return wave.period if self.waves is not None and self.waves.kind == "regular" else parts.energy_period

    def to_dict(self) -> dict[str, Any]:
        """The case as plain dicts, lists and numbers, with the defaults written out; `load` reads it back."""
        data = self.model_dump(mode="json", exclude_none=True)
        if self.time.step is not None:
            del data["time"]["courant"]
        return data

    def to_toml(self) -> str:
        """The text of a case file that gives the same case."""
        return to_toml(self.to_dict())

    @property
    def identity(self) -> dict[str, str | None]:
        """Name, title, file, hash and text of the case, as the files of a run hold them."""
        file = str(self.path) if self.path else None
        return {
            "name": self.case.name,
            "title": self.case.title,
            "file": file,
            "hash": self.hash,
            "text": self.to_toml(),
        }

    @property
    def hash(self) -> str:
        """16 hexadecimal digits that depend on everything in the case, defaults included, but not on its files."""
        return hashlib.sha256(json.dumps(self.to_dict(), sort_keys=True).encode()).hexdigest()[:16]


def add_table(key: str, row: type[Table], description: str) -> None:
    """Makes [[key]] a table of the case file, for an observable or a boundary that houle does not have.

    row  the model of the table, like those of `houle.case.tables.observed` and `houle.case.tables.boundaries`; the
         observer has the key as its `table`, the boundary as its name in `BOUNDARIES`
    """
    rows: Any = Annotated[tuple[row, ...], Field(strict=False, description=description)]  # type: ignore[valid-type]
    Case.model_fields[key] = FieldInfo.from_annotated_attribute(rows, ())
    Case.model_rebuild(force=True)


def schema() -> dict[str, Any]:
    """JSON Schema of the case file, for editors and forms."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Case.model_json_schema()}


def load(source: str | Path | dict[str, Any] | Case, overrides: dict[str, Any] | None = None) -> Case:
    """The case in a file, or the shipped case of that name, or the tables of a dict. SI units.

    overrides  {"domain.spacing": 0.01, "porous.dam.porosity": 0.4}: a body, gauge or sensor by its name or its
               number from 0

    Raises CaseError, one line per error: key, value, allowed range, cure. `houle.check.rules.require` checks whether
    the shapes fit together.
    """
    if isinstance(source, Case):
        if not overrides:
            return source
        path, data = source.path, source.to_dict()
        if "numerics.scheme" in overrides:  # the choices of the old scheme give way to those of the new one
            old = choices("scheme")[source.numerics.scheme].takes
            data["numerics"] = {k: v for k, v in data["numerics"].items() if old.get(k) != v}
    elif isinstance(source, dict):
        path, data = None, plain(source)
    elif not isinstance(source, str | Path):
        raise CaseError(f"case = {source!r}: give a file, the name of a shipped case, a dict of its tables, or a Case")
    else:
        path = find(source)
        data = read_toml(path)
    if not (overrides is None or (isinstance(overrides, Mapping) and all(isinstance(key, str) for key in overrides))):
        raise CaseError(f'overrides = {overrides!r}: give a dict of keys and values, {{"domain.spacing": 0.01}}')
    for key, value in plain(overrides or {}).items():
        override(data, key, value)
        if key in ("time.step", "time.courant"):
            data["time"].pop("courant" if key == "time.step" else "step", None)
    if immense := list(messages.immense(data)):
        text = f"is beyond any measure: 0, or between {messages.SMALLEST:g} and {messages.LARGEST:g}, in SI units"
        raise CaseError(messages.several([f"{messages.told(loc, data)} {text}" for loc in immense]))
    if odd := list(messages.unprintable(data)):
        text = "holds a control character: letters, digits, signs and blanks only"
        raise CaseError(messages.several([f"{messages.told(loc, data)} {text}" for loc in odd]))
    try:
        case = Case.model_validate(data)
    except ValidationError as error:
        raise CaseError(messages.explain(error, Case, data)) from None
    case._path = path
    return case
