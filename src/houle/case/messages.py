"""Messages about errors in a case file: key, value, allowed range and cure, one line per error.

A message of a validator of a model begins with the key that it is about, before which a dot is put, or with "=" or ":",
which are put directly after the name of the table.
"""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from math import inf
from typing import Annotated, Any, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]*$"  # pattern of the name of a case, a body or a gauge
MOST = 5  # most errors in one message
LONGEST = 80  # letters of a value beyond which its middle is left out
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff]")  # letters that nothing can print
SMALLEST, LARGEST = 1e-20, 1e20  # bounds of the size of numbers other than 0

LENGTHS = ((1e-3, "mm"), (1e-2, "cm"))
# key: (typical lowest, typical highest, ((factor to SI, unit the reader may have meant), ...))
UNITS: dict[str, tuple[float, float, tuple[tuple[float, str], ...]]] = {
    "porosity": (0.02, 1.0, ((0.01, "%"),)),
    "grain_diameter": (1e-4, 2.0, LENGTHS),
    "spacing": (1e-4, 10.0, LENGTHS),
    "size": (1e-2, 1e4, LENGTHS),
    "below": (1e-3, 100.0, LENGTHS),
    "viscosity": (
        1e-7,
        1e-4,
        ((1e-6, "mm2/s"), (1e-3, "Pa s")),
    ),
    "density": (500.0, 20000.0, ((1000.0, "g/cm3"),)),
    "gravity": (1.0, 30.0, ((-1.0, ""), (1e-2, "cm/s2"), (1e-3, "mm/s2"))),
    "permeability": (1e-13, 1e-2, ((1e-6, "mm2"), (1e-12, "darcy"))),
    "speed": (0.01, 20.0, ((1e-2, "cm/s"), (1e-3, "mm/s"), (-1.0, ""))),
    "end": (0.01, 1e5, ((1e-3, "ms"),)),
    "courant": (0.1, 1.0, ((0.01, "%"),)),
    "flip": (0.1, 1.0, ((0.01, "%"),)),
    "correction": (0.1, 1.0, ((0.01, "%"),)),
}
SAME = {  # name of a key in other codes and papers -> our name of it
    "n": "porosity", "por": "porosity", "d50": "grain_diameter", "D50": "grain_diameter", "diameter": "grain_diameter",
    "dx": "spacing", "dp": "spacing", "particle_spacing": "spacing", "nu": "viscosity", "rho": "density",
    "g": "gravity", "gamma": "added_mass", "cfl": "courant", "CFL": "courant", "dt": "step", "time_step": "step",
    "t_end": "end", "duration": "end",
    "model": "law", "KC": "kc", "K": "permeability", "Cf": "forchheimer", "C_f": "forchheimer",
    "level": "below", "geometry": "domain", "layer": "porous", "obstacle": "solid", "length": "size", "position": "at",
}  # fmt: skip
KINDS = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "text in quotes",
    "bool_type": "true or false",
    "tuple_type": "a list [...]",
    "model_type": "a table",
}
WORD, TABLE = "<word>", "<table>"  # forms of a value that may be either: they are no part of its place
LATER = {"stl"}  # keys of later versions


def show(value: Any) -> str:
    """A value as the case file would have it, in TOML."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{k} = {show(v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(show(v) for v in value) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return repr(value)
    return json.dumps(str(value), ensure_ascii=False)


def shortened(text: str) -> str:
    """A text, with its middle left out if it is long."""
    return text if len(text) <= LONGEST else f"{text[: LONGEST // 2]} ... {text[-LONGEST // 4 :]}"


def nearest(word: str, words: Iterable[str]) -> str:
    """' Did you mean "..."?' with the most similar of the words, or ""; capital letters do not matter."""
    small = {w.lower(): w for w in words}
    found = difflib.get_close_matches(word.lower(), list(small), n=1, cutoff=0.5)
    return f' Did you mean "{small[found[0]]}"?' if found else ""


def guess(key: str, value: Any, upper: float | None = None) -> str:
    """' Did you mean 0.0159 (15.9 mm)?' if the value would be usual in another unit, and below `upper`; else ""."""
    low, high, units = UNITS.get(key, (0.0, 0.0, ()))
    high = high if upper is None else min(high, upper)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return ""
    for factor, unit in units:
        if low <= (meant := value * factor) <= high:
            what = "" if not unit else f" ({value:g}{'' if unit == '%' else ' '}{unit})"
            return f" Did you mean {float(f'{meant:.10g}')!r}{what if unit != '%' else ''}?"
    return ""


def place(loc: Iterable[str | int], data: Any) -> str:
    """The place of a key in words: porous.dam.porosity, porous[0] for a body without name, polygon[2][1] in a list."""
    text = ""
    for part in loc:
        name = None
        if isinstance(part, int):
            try:
                data = data[part]
                name = data.get("name") if isinstance(data, Mapping) else getattr(data, "name", None)
            except (IndexError, KeyError, TypeError):
                data = None
            text += f".{name}" if isinstance(name, str) and re.fullmatch(NAME, name) else f"[{part}]"
        else:
            data = data.get(part) if isinstance(data, Mapping) else None
            text += f".{part}" if text else part
    return text


def immense(data: Any, loc: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Places of numbers so large or small that squares or inverses of them overflow, whatever the unit."""
    if isinstance(data, Mapping | list | tuple):
        for key, value in data.items() if isinstance(data, Mapping) else enumerate(data):
            yield from immense(value, (*loc, key))
    elif isinstance(data, int | float) and data and abs(data) < inf and not SMALLEST <= abs(data) <= LARGEST:
        yield loc


def unprintable(data: Any, loc: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Places of text that files and terminals cannot take: control characters, halves of a surrogate pair."""
    if isinstance(data, Mapping | list | tuple):
        for key, value in data.items() if isinstance(data, Mapping) else enumerate(data):
            yield from unprintable(value, (*loc, key))
    elif isinstance(data, str) and CONTROL.search(data):
        yield loc


def told(loc: Iterable[str | int], data: Any) -> str:
    """The place and the value there: porous.dam.porosity = 45."""
    value = data
    for part in loc:
        value = value[part]
    return f"{place(loc, data)} = {shortened(show(value))}"


def explain(error: ValidationError, model: type[BaseModel], data: dict[str, Any]) -> str:
    """One message about all errors of a failed validation; it shows the first few."""
    errors: list[dict[str, Any]] = [
        {**e, "loc": tuple(part for part in e["loc"] if part not in (WORD, TABLE))} for e in error.errors()
    ]
    inner = [e["loc"] for e in errors]
    kept = [e for e in errors if not any(len(o) > len(e["loc"]) and o[: len(e["loc"])] == e["loc"] for o in inner)]
    lines = [line for e in kept for line in _lines(e, model, data)]
    return several(list(dict.fromkeys(lines)))


def several(lines: list[str]) -> str:
    """One message of the first few lines and the number of the others."""
    more = len(lines) - MOST
    return "\n".join(lines[:MOST] + ([f"... and {more} more"] if more > 0 else []))


def toml_line(message: str, text: str) -> str:
    """The message of the TOML parser, with the text of the line that it names."""
    where = re.search(r"line (\d+)", message)
    lines = text.splitlines()
    if where and int(where[1]) <= len(lines):
        return f"{message}: {lines[int(where[1]) - 1].strip()}"
    return message


def _lines(error: Any, model: type[BaseModel], data: dict[str, Any]) -> list[str]:
    """The lines of the message about one error of pydantic, most often one."""
    loc, kind, value = error["loc"], error["type"], error["input"]
    field, table = _field(model, loc)
    where, key = place(loc, data), next((p for p in reversed(loc) if isinstance(p, str)), "")
    if kind == "extra_forbidden":
        return [f"{where} is not a key of the case file.{_meant(str(loc[-1]), table)}"]
    if kind == "missing":
        return [f"{where} is missing: {_what(field)}"]
    if kind == "value_error":
        own = str(error["ctx"]["error"]).split("\n")
        return [where + ("" if m[0] == ":" else " " if m[0] == "=" else "." if where else "") + m for m in own]
    shown = f"{where} = {shortened(show(value))}"
    if kind == "finite_number":
        return [f"{shown} is not a finite number{_allowed(key, field)}"]
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        unit = _unit(field)
        return [f"{shown} is outside {_range(key, field, error['ctx'])}{unit}.{guess(key, value)}"]
    if kind == "literal_error":
        allowed = _allowed_words(field)
        near = nearest(value, allowed) if isinstance(value, str) else ""
        return [f"{shown} is not one of {', '.join(show(v) for v in allowed)}.{near}"]
    if kind == "string_pattern_mismatch":
        return [f"{shown} is not a name: letters, digits, - _ . only, a letter or digit first"]
    if kind == "string_too_long":
        return [f"{shown} has {len(value)} letters: at most {error['ctx']['max_length']}"]
    if kind in ("too_short", "too_long"):
        return [
            f"{shown if value else where} has {error['ctx']['actual_length']} entries: {_count(error)}. {_what(field)}"
        ]
    return [_wrong_type(shown, kind, value, key, field, top=len(loc) == 1)]


def _wrong_type(shown: str, kind: str, value: Any, key: str, field: FieldInfo | None, top: bool) -> str:
    """The message about a value of the wrong type. top: it is a whole table."""
    wanted = KINDS.get(kind, kind)
    cure = ""
    if isinstance(value, str) and kind in ("float_type", "int_type"):
        number = re.match(r"\s*([-+]?\.?[0-9][-+0-9.eE]*)\s*(.*)$", value)
        cure = f" Write it without quotes, in SI units: {number[1]}" if number and not number[2] else ""
        cure = cure or (" Write the number alone, in SI units." if number else "")
    if kind == "tuple_type" and isinstance(value, Mapping) and top:
        cure = f" Write [[{key}]] instead of [{key}]."
    if kind.startswith("model") and isinstance(value, list) and top:
        cure = f" Write [{key}] once instead of [[{key}]]."
    return f"{shown} is of the wrong kind: {wanted} is needed{_allowed(key, field)}.{cure}"


def _field(model: type[BaseModel], loc: Iterable[str | int]) -> tuple[FieldInfo | None, type[BaseModel] | None]:
    """The field of a model at a place, and the model of the table in which it is."""
    field, table, inside = None, None, model
    for part in loc:
        if isinstance(part, int):
            continue
        table = inside
        field = table.model_fields.get(part) if table else None
        inside = _model(field.annotation) if field else None  # type: ignore[assignment]
    return field, table


def _model(kind: Any) -> type[BaseModel] | None:
    """The first model in a type annotation, None without."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind
    return next((m for arg in get_args(kind) if (m := _model(arg))), None)


def _allowed_words(field: FieldInfo | None) -> list[str]:
    """The words that a field allows: those of a Literal, or the names of a kind of choice (`tables.base.OneOf`)."""
    if field is None:
        return []
    named = next((entry.allowed for entry in field.metadata if hasattr(entry, "allowed")), None)
    return named if named is not None else [v for v in _literals(field.annotation) if v is not None]


def _literals(kind: Any) -> list[Any]:
    if get_origin(kind) is not None and "Literal" in str(get_origin(kind)):
        return list(get_args(kind))
    return [v for arg in get_args(kind) for v in _literals(arg)]


def _bounds(metadata: Iterable[Any], kind: Any) -> dict[str, float]:
    """Bounds gt, ge, lt, le of a field, or of the numbers in its list."""
    found: dict[str, float] = {}
    for entry in metadata:
        if isinstance(entry, FieldInfo):
            found |= _bounds(entry.metadata, None)
        found |= {w: getattr(entry, w) for w in ("gt", "ge", "lt", "le") if getattr(entry, w, None) is not None}
    if get_origin(kind) is Annotated:
        found |= _bounds(get_args(kind)[1:], None)
    for arg in get_args(kind):
        found |= _bounds((), arg)
    return found


def _range(key: str, field: FieldInfo | None, context: Mapping[str, Any] | None = None) -> str:
    bounds = _bounds(field.metadata, field.annotation) if field else {}
    bounds = bounds or {k: v for k, v in (context or {}).items() if k in ("gt", "ge", "lt", "le")}
    low = f"{bounds['gt']:g} < " if "gt" in bounds else f"{bounds['ge']:g} <= " if "ge" in bounds else ""
    high = f" < {bounds['lt']:g}" if "lt" in bounds else f" <= {bounds['le']:g}" if "le" in bounds else ""
    return f"{low}{key}{high}" if low or high else ""


def _allowed(key: str, field: FieldInfo | None) -> str:
    span = _range(key, field)
    return f", {span}{_unit(field)}" if span else ""


def _unit(field: FieldInfo | None) -> str:
    found = re.search(r"\[([^\[\]]+)\]$", (field.description or "") if field else "")
    return f" [{found[1]}]" if found and found[1] != "-" else ""


def _what(field: FieldInfo | None) -> str:
    if field is None:
        return "add it"
    if (table := _model(field.annotation)) is not None and not field.description:
        needs = [k for k, f in table.model_fields.items() if f.is_required()]
        return f"add the table with {', '.join(needs)}"
    example = f", for example {field.examples[0]}" if field.examples else ""
    return f"{field.description}{example}"


def _count(error: Any) -> str:
    context = error["ctx"]
    return f"at least {context['min_length']}" if "min_length" in context else f"at most {context['max_length']}"


def _meant(word: str, table: type[BaseModel] | None) -> str:
    """A hint at the key that was meant by an unknown word, and the keys that the table has."""
    keys = list(table.model_fields) if table else []
    if word in LATER:
        return " It belongs to a later version of houle."
    if SAME.get(word) in keys:
        return f' Did you mean "{SAME[word]}"?'
    return nearest(word, keys) + (f" Keys here: {', '.join(keys)}" if keys else "")
