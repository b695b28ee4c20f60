"""Tables of the keys of a case file as Markdown, from the JSON Schema that `houle.Case` makes of its models.

Key, values with their range, unit, default and meaning come from the models; pages add notes to single keys. Nothing is
written down twice, so the page cannot say other than the program does.
"""

from __future__ import annotations

import re
from functools import cache
from typing import Any

Schema = dict[str, Any]

HEAD = "| key | value | unit | default | meaning |\n|---|---|---|---|---|"
PLURALS = {"number": "numbers", "whole number": "whole numbers", "text": "texts", "name": "names"}
BEYOND = 1e9  # a bound as large as this only keeps out nonsense
COUNTS = {1: "one", 2: "two", 3: "three"}


@cache
def schema() -> Schema:
    import houle

    return houle.Case.model_json_schema()


def tables() -> dict[str, str]:
    """Name of each table of a case file and of the model behind it, "sponge": "Sponge", in the order of the models."""
    return {name: _model(row) for name, row in schema()["properties"].items()}


def parts() -> dict[str, str]:
    """The same for tables within tables: "waves.zone": "Zone"."""
    return {
        f"{table}.{key}": model
        for table, owner in tables().items()
        for key, row in _properties(owner).items()
        if (model := _model(row, optional=True))
    }


def model_of(table: str) -> str:
    """The model behind a table or a table in one, "waves" or "waves.zone". Raises KeyError."""
    return {**tables(), **parts()}[table]


def meaning_of(table: str) -> str:
    """The first line that the model of a table says about itself, without the table's own name."""
    text = schema()["$defs"][model_of(table)].get("description", "")
    return re.sub(r"^\[+[\w.]+\]+:? ?", "", text)


def markdown(table: str, notes: dict[str, str] | None = None, only: list[str] | None = None) -> str:
    """The keys of one table, each a row; notes (by key) are added to what the model says.

    only: these keys and no others. Raises ValueError when a note or a key of `only` is about no key of the table.
    """
    properties, required = _properties(model_of(table)), _required(model_of(table))
    notes = notes or {}
    if strange := [key for key in [*notes, *(only or [])] if key not in properties]:
        raise ValueError(f"[{table}] has no key {strange[0]!r}: it has {', '.join(properties)}")
    rows = [
        _row(key, row, key in required, notes.get(key, ""))
        for key, row in properties.items()
        if not only or key in only
    ]
    return "\n".join([HEAD, *rows])


def keys_of(table: str) -> list[str]:
    """The keys of a table."""
    return list(_properties(model_of(table)))


def _model(row: Schema, optional: bool = False) -> str:
    """Name of the model that a property refers to, directly, in a list or as a choice; "" without."""
    found = [row, row.get("items", {}), *row.get("anyOf", row.get("oneOf", []))]
    names = [str(part["$ref"]).rpartition("/")[2] for part in found if "$ref" in part]
    if not names and not optional:
        raise ValueError(f"no table: {row}")
    return names[0] if names else ""


def _body(model: str) -> Schema:
    """The object schema of a model, also where a word may stand for it (domain.walls)."""
    found: Schema = schema()["$defs"][model]
    return next((part for part in found.get("anyOf", []) if "properties" in part), found)


def _properties(model: str) -> dict[str, Schema]:
    return _body(model)["properties"]


def _required(model: str) -> list[str]:
    return _body(model).get("required", [])


def _row(key: str, row: Schema, required: bool, note: str) -> str:
    meaning, unit = _split(row.get("description", ""))
    text = f"{meaning}; {note}" if note else meaning
    cells = (f"`{key}`", values(row), unit, _default(row, required), text)
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"


def _split(description: str) -> tuple[str, str]:
    """Meaning and unit of "width of the zone [m]"; the unit is "" without."""
    both = re.search(r"\s*\[(\S+)\], 2D \[(\S+)\]$", description)
    if both:
        return description[: both.start()], f"{_power(both[1])}, in 2D {_power(both[2])}"
    one = re.search(r"\s+\[([^\[\]]+)\]$", description)
    if not one:
        return description, ""
    return description[: one.start()], "" if one[1] == "-" else _power(one[1])


def _power(unit: str) -> str:
    return re.sub(r"(?<=[a-z])([23])", lambda digit: "²³"[int(digit[1]) - 2], unit)


def _default(row: Schema, required: bool) -> str:
    if required:
        return "–"
    value = row.get("default")
    if value is None or value in ("", []) or (isinstance(value, dict) and "left" not in value):
        return "*none*"
    if isinstance(value, dict):  # of walls: one word for all sides
        value = next(iter(value.values()))
    return f"`{_toml(value)}`"


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else f"{value}"


def values(row: Schema) -> str:
    """What a key takes, in words: "number above 0", "two lists of 2 or 3 numbers"."""
    if "enum" in row:
        return ", ".join(f'`"{choice}"`' for choice in row["enum"])
    if "$ref" in row:
        return _reference(row)
    if either := row.get("anyOf", row.get("oneOf")):
        kinds = [part for part in either if part.get("type") != "null"]
        return " or ".join(dict.fromkeys(values(part) for part in kinds))
    if "const" in row:
        return f'`"{row["const"]}"`'
    kind = row["type"]
    if kind == "array":
        return _list(row)
    return {"boolean": "`true` or `false`", "string": _text(row)}.get(kind) or _word(row) + _range(row)


def _reference(row: Schema) -> str:
    model = schema()["$defs"][str(row["$ref"]).rpartition("/")[2]]
    words = [values(part) for part in model.get("anyOf", []) if "enum" in part]
    return " or ".join([*words, "table"])


def _text(row: Schema) -> str:
    return "name" if "pattern" in row else "text"


def _word(row: Schema) -> str:
    return "whole number" if row["type"] == "integer" else "number"


def _range(row: Schema) -> str:
    """ " above 0, up to 1", from the bounds of a number; "" when it has none."""
    if "minimum" in row and "maximum" in row and row["maximum"] < BEYOND:
        return f" from {row['minimum']:g} to {row['maximum']:g}"
    words = (("minimum", "from"), ("exclusiveMinimum", "above"), ("maximum", "up to"), ("exclusiveMaximum", "below"))
    found = [f"{word} {row[key]:g}" for key, word in words if key in row and abs(row[key]) < BEYOND]
    return f" {', '.join(found)}" if found else ""


def _list(row: Schema) -> str:
    inner = row["prefixItems"][0] if "prefixItems" in row else row["items"]
    low, high = row.get("minItems", 0), row.get("maxItems")
    if inner["type"] == "array":
        count = COUNTS[low] if low == high else f"{low} or more" if low else "any number of"
        return f"{count} {_list(inner).replace('list', 'lists', 1)}"
    what = PLURALS[_text(inner) if inner["type"] == "string" else _word(inner)]
    count = f"{low} " if low == high else f"{low} or {high} " if high else f"{low} or more " if low > 1 else ""
    return f"list of {count}{what}" + (f", each{_range(inner)}" if _range(inner) else "")
