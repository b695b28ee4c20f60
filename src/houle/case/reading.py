"""Case files on disk: finding, reading, overriding and writing the tables. Nothing here knows what they mean."""

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
    """The case file meant: a file, or the name of a shipped case. Raises CaseError with what is near."""
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
    """Whether an ordinary file is there: no folder, device or pipe, and no name that the system does not take."""
    return exists(path) and path.is_file()


def read_toml(path: Path) -> dict[str, Any]:
    """Tables of a TOML file. Raises CaseError with the line when it cannot be read."""
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
    """`domain.spacing=0.01` as key and value; the value is TOML, a bare word is taken as text."""
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
    """A copy with the lists and numbers of Python for those of NumPy, and text for paths."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: plain(inside) for key, inside in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inside) for inside in value]
    return str(value) if isinstance(value, Path) else value


def override(data: dict[str, Any], key: str, value: Any) -> None:
    """Put a value at `table.key`, `table.name.key` or `table[0].key`. Raises CaseError if no body has that name."""
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
    """The entry of an array of tables with that number or name (names may hold dots: longest first)."""
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
    """Tables as TOML: one level of tables and arrays of tables, anything deeper inline."""
    lines: list[str] = []
    for key, value in data.items():
        for row in value if isinstance(value, list) else [value]:
            lines += ["", f"[[{key}]]" if isinstance(value, list) else f"[{key}]"]
            lines += [f"{k} = {show(v)}" for k, v in row.items()]
    return "\n".join(lines[1:]) + "\n"
