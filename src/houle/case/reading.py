"""Case files as TOML: finding, reading, overriding and writing their tables, whatever these mean."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from houle.case.messages import NAME, nearest, shortened, show, toml_line
from houle.data.files import exists
from houle.errors import CaseError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

SHIPPED = Path(__file__).parent.parent / "validation"  # one folder per shipped case, each with a case.toml


def shipped() -> list[str]:
    """Names of the cases that come with houle."""
    return sorted(p.parent.name for p in SHIPPED.glob("*/case.toml"))


def find(source: str | Path) -> Path:
    """The path of a case file, given as a file or as the name of a shipped case. Raises CaseError with a near name."""
    path = Path(source)
    if is_file(path):
        return path
    if re.match(NAME, str(source)) and is_file(SHIPPED / str(source) / "case.toml"):
        return SHIPPED / str(source) / "case.toml"
    if exists(path) and path.is_dir():
        raise CaseError(f"{source} is a folder: give the case file in it, or the name of a shipped case")
    if exists(path):
        raise CaseError(f"{source} is a device or a pipe: give a file, or the name of a shipped case")
    near = nearest(str(source).removesuffix(".toml"), shipped())
    there = ", ".join(shipped()) or "none"
    raise CaseError(f"{shortened(str(source))}: no such file, and no shipped case of that name.{near} Shipped: {there}")


def is_file(path: Path) -> bool:
    """True for an ordinary file; False for a folder, a device or a pipe, and for a name that no file can have."""
    return exists(path) and path.is_file()


def read_toml(path: Path) -> dict[str, Any]:
    """The tables of a TOML file. Raises CaseError, with the line, if it cannot be read."""
    try:
        text = path.read_bytes().decode("utf-8-sig")  # Windows may put a mark in front
    except UnicodeDecodeError as error:
        raise CaseError(f"{path} is not a text file in UTF-8 (byte {error.start}): save it as UTF-8 text") from None
    except OSError as error:
        raise CaseError(f"{path} cannot be read: {error.strerror}") from None
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"{path} is not valid TOML: {toml_line(str(error), text)}") from None


def parse_override(text: str) -> tuple[str, Any]:
    """Key and value of `domain.spacing=0.01`. The value is TOML; a word without quotes is taken as text."""
    key, equal, value = text.partition("=")
    key, value = key.strip(), value.strip()
    if not equal or not key or not value:
        raise CaseError(f"--set {text}: give key=value, for example --set domain.spacing=0.01")
    try:
        return key, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        if re.match(NAME, value) and not value[0].isdigit():
            return key, value
        raise CaseError(
            f"--set {text}: {value} is not a TOML value (a number, true, [1, 2], or text in quotes)"
        ) from None


def plain(value: Any) -> Any:
    """A copy in which arrays and numbers of NumPy are lists and numbers of Python, and paths are text."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: plain(inside) for key, inside in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inside) for inside in value]
    return str(value) if isinstance(value, Path) else value


def override(data: dict[str, Any], key: str, value: Any) -> None:
    """Puts a value at `table.key`, `table.name.key` or `table[0].key`. Raises CaseError if there is no such place."""
    parts = re.sub(r"\[(\d+)\]", r".\1", key).split(".")
    target: Any = data
    while len(parts) > 1:
        part = parts.pop(0)
        target = _row(target, part, key, parts) if isinstance(target, list) else target.setdefault(part, {})
        if not isinstance(target, (dict, list)):
            raise CaseError(f"--set {key}: {part} is a single value, it has no keys inside")
    last = parts[0]
    if isinstance(target, list):
        index = int(last) if last.isdigit() else -1
        if not 0 <= index < len(target):
            raise CaseError(f"--set {key}: {last} is not one of 0 to {len(target) - 1}")
        target[index] = value
    else:
        target[last] = value


def _row(rows: list[Any], part: str, key: str, parts: list[str]) -> Any:
    """The entry of an array of tables by its number or its name.

    Names may hold dots: the longest name that fits is taken, and its further parts are removed from `parts`.
    """
    if part.isdigit() and int(part) < len(rows):
        return rows[int(part)]
    named = {str(r.get("name")): r for r in rows if isinstance(r, dict) and "name" in r}
    for used in range(len(parts) - 1, -1, -1):
        word = ".".join([part, *parts[:used]])
        if word in named:
            del parts[:used]
            return named[word]
    there = ", ".join([*named, *(str(i) for i in range(len(rows)))])
    raise CaseError(f"--set {key}: there is no {part}. There is: {there}")


def to_toml(data: dict[str, Any]) -> str:
    """Tables as TOML text: one level of tables and arrays of tables, everything deeper inline."""
    lines: list[str] = []
    for key, value in data.items():
        for row in value if isinstance(value, list) else [value]:
            lines += ["", f"[[{key}]]" if isinstance(value, list) else f"[{key}]"]
            lines += [f"{k} = {show(v)}" for k, v in row.items()]
    return "\n".join(lines[1:]) + "\n"
