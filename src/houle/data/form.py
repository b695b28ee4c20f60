"""The form of a table in a text file, found from its first lines: how its numbers are written, and the column names.

The encoding is UTF-8, UTF-16, or else Windows-1252; the separator is ;, tab, comma, | or blanks; the decimal sign is a
point or a comma. Titles and comments, a line of names and a line of units may stand above the numbers, stamps of date
and time to their left, and remarks to their right.
"""

from __future__ import annotations

import codecs
import csv
import os
import re
import stat
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from houle.data.clock import stamp_columns
from houle.data.units import LENGTHS, are_units, is_time
from houle.errors import HouleError

LONGEST = 1 << 20  # most letters in a line
HEAD = 2000  # lines within which the numbers must begin
MARKS = (";", "\t", ",", "|", None)  # separators of cells, the most reliable first; None: blanks
NUMBER = re.compile(r"[-+]?(\d+([.,]\d*)?|[.,]\d+)([eEdD][-+]?\d+)?", re.ASCII)
MISSING = {"", "nan", "-nan", "+nan", "nan(ind)", "-nan(ind)", "na", "n/a", "null", "none", "nil", "inf", "-inf",
           "+inf", "-", "--", "---", "*", "**", "***", "****", "*****", "?", "#n/a", "#na", "#nv", "#value!",
           "#div/0!", "#num!", "missing", "dry"}  # fmt: skip
REMARKS = {"comment", "comments", "remark", "remarks", "bemerkung"}


@dataclass
class Form:
    """The form of a table: how its numbers are written, and the names of its columns.

    name     name of the file in messages; error: class of the errors to raise
    mark     separator of the cells; None: blanks
    columns  number of columns, without remarks
    stamps   number of columns at the left that hold date and time: 0, 1 or 2
    first    number of the first line with numbers, from 1
    remark   whether a last column of words follows
    names    names of the columns, empty without; units: the same
    above    lines above the numbers, comments first
    decimal  decimal sign, "" until one has been met
    """

    name: str
    error: type[HouleError]
    mark: str | None = None
    columns: int = 0
    first: int = 0
    remark: bool = False
    stamps: int = 0
    names: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    above: list[str] = field(default_factory=list)
    decimal: str = ""


def encoding_of(file: Path | str, name: str, error: type[HouleError]) -> str:
    """The name of the encoding of a file. Raises `error` where it is no file, cannot be read, or is not text."""
    try:
        mode = os.stat(file).st_mode
        if not stat.S_ISREG(mode):
            kind = "a folder" if stat.S_ISDIR(mode) else "a device or a pipe"
            raise error(f"{name} is {kind}: the name of a file with a table is needed")
        with open(file, "rb") as stream:
            head = stream.read(LONGEST)
    except (OSError, ValueError) as problem:
        raise error(f"{name} cannot be read: {getattr(problem, 'strerror', None) or problem}") from None
    if not head.strip():
        raise error(f"{name} is empty: a table of numbers is needed")
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if head.startswith(b"PK\x03\x04"):
        raise error(f"{name} is a spreadsheet or an archive: save the table as CSV text")
    if b"\0" in head:
        raise error(f"{name} is not text (byte {head.index(0)} is 0): save the table as CSV text")
    try:
        codecs.getincrementaldecoder("utf-8-sig")().decode(head, final=len(head) < LONGEST)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"


def lines_of(file: Path | str, encoding: str, name: str, error: type[HouleError]) -> Iterator[tuple[int, str]]:
    """Number, from 1, and text of every line of a file. Raises `error` where it cannot be read or is not text."""
    number = 0
    try:
        with open(file, encoding=encoding, errors="replace") as stream:
            while line := stream.readline(LONGEST):
                number += 1
                if len(line) >= LONGEST:
                    raise error(f"{name}, line {number} has more than {LONGEST} letters: that is no table")
                if "\0" in line:
                    raise error(f"{name}, line {number} is not text: save the table as CSV text")
                yield number, line
    except (OSError, UnicodeError) as problem:
        raise error(f"{name} cannot be read: {problem}") from None


def sniff(file: Path | str, encoding: str, name: str, error: type[HouleError]) -> Form:
    """The form of a file, from the first lines with numbers in it. Raises `error` where there are none.

    The numbers begin at the first line that, with one of `MARKS`, holds numbers only, as does the line after it.
    """
    head: list[tuple[int, str]] = []
    for number, line in lines_of(file, encoding, name, error):
        head.append((number, line))
        if number >= HEAD:
            break
    text = [(number, line) for number, line in head if line.strip() and not line.lstrip().startswith("#")]
    for i in range(len(text)):
        for mark in MARKS:
            if mark is not None and mark not in text[i][1]:
                continue
            remark = _with_remark(text, i, mark)
            rows = [cells_of(line, mark) for _, line in text[i : i + 50]]
            rows = [row[:-1] if remark and len(row) > 1 and not is_number(row[-1]) else row for row in rows]
            if _holds_numbers(rows[0]) and (len(rows) == 1 or _holds_numbers(rows[1])):
                form = Form(name, error, mark, first=text[i][0], remark=remark)
                _name_columns(form, head, text, i, [row for row in rows if _holds_numbers(row)])
                return form
    raise error(f"{name} holds no rows of numbers in its first {len(head)} lines: a table is needed")


def _with_remark(lines: list[tuple[int, str]], i: int, mark: str | None) -> bool:
    """True if the line above row i calls its last column a remark or a comment."""
    above = _trimmed(cells_of(lines[i - 1][1], mark)) if i and mark else []
    return len(above) > 1 and above[-1].lower() in REMARKS


def _holds_numbers(cells: list[str]) -> bool:
    """True for the cells of a row of the table: numbers or missing values, at least one number, stamps at the left."""
    rest = cells[stamp_columns(cells) :]
    numbers = sum(map(is_number, rest))
    return numbers > 0 and all(is_number(cell) or cell.lower() in MISSING for cell in rest)


def _name_columns(
    form: Form, head: list[tuple[int, str]], text: list[tuple[int, str]], i: int, rows: list[list[str]]
) -> None:
    """Sets names, units, columns, stamps and above of the form, from the lines above row i.

    head: all first lines with their numbers; text: those that are not empty and no comments; rows: cells of the first
    rows of numbers. Raises the error of the form where the line above the numbers fits them neither as names nor as a
    title.
    """
    counts = [len(_trimmed(row)) for row in rows]
    filled, most = max(set(counts), key=lambda n: (counts.count(n), n)), len(rows[0])
    form.stamps = stamp_columns(rows[0])
    above = [line for number, line in text[:i]]
    form.columns = filled
    remark = 1 if form.remark else 0
    comments = [line.strip().lstrip("#").strip() for n, line in head if n < form.first and line.lstrip()[:1] == "#"]
    form.above = [*comments, *(line.strip() for line in above)]
    if not above:
        told = next(([c.strip() for c in n] for n in _splits(comments[-1], form.mark) if len(n) == filled), None) \
            if comments else None  # fmt: skip
        form.names = told if told and is_time(told[0]) and not all(map(is_number, told)) else []
        return
    last = above[-1].strip().lstrip("%!").strip()
    found = next((n for n in _splits(last, form.mark) if filled <= len(n) - remark <= max(most, filled)), None)
    if found is None:
        _require_title(form, last, text[i - 1][0], filled)
        return
    names = found[: len(found) - remark]
    form.columns = len(names)
    before = above[-2].strip().lstrip("%!").strip() if len(above) > 1 else ""
    if are_units(names):
        form.units = names
        known = (n for n in _splits(before, form.mark) if len(n) - remark == len(names)) if before else iter(())
        form.names = next(known, [""] * (len(names) + remark))[: len(names)]
    elif is_number(names[0]) or (not is_time(names[0]) and len(names) > 1 and all(map(_is_decimal, names[1:]))):
        words = next((n for n in names if not is_number(n) and n.lower() not in MISSING), names[0])
        raise form.error(
            f"{form.name}, line {text[i - 1][0]}: {words[:40]!r} is not a number, and the line is not one of names"
        )
    else:
        form.names = names


def _splits(line: str, mark: str | None) -> Iterator[list[str]]:
    """The cells of a line of names: split as the rows are, then in every other way."""
    first = [] if mark is None else [_trimmed(cells_of(line, mark))]
    others = [_trimmed(cells_of(line, m)) for m in MARKS if m is not None and m in line and m != mark]
    blanks = [re.split(r"\s+(?![\[(])", line.strip()), line.split(), re.split(r"\s{2,}|\t", line.strip())]
    yield from [*first, *others, *(blanks if mark is None or not others else [])]


def _require_title(form: Form, line: str, number: int, columns: int) -> None:
    """Raises the error of the form if the line above the numbers is a line of names, too many or too few, no title."""
    cells = _trimmed(cells_of(line, form.mark))
    names = len(cells) > 1 and (form.mark is not None or is_time(cells[0]))
    if names and not cells[0].startswith("***"):
        raise form.error(f"{form.name}, line {number} has {len(cells)} names, the rows below it {columns} numbers")


def lvm_units(form: Form) -> list[str]:
    """Units of the columns from the header of a LabVIEW measurement, if all of them are lengths; else none."""
    lines = (_trimmed(cells_of(line, form.mark)) for line in form.above if line.startswith("Y_Unit_Label"))
    told = next(lines, [])[1:]
    levels = [i for i, name in enumerate(form.names) if not is_time(name)]
    if not told or len(told) != len(levels) or not all(unit.lower() in LENGTHS for unit in told):
        return []
    units = [""] * form.columns
    for i, unit in zip(levels, told, strict=True):
        units[i] = unit
    return units


def cells_of(line: str, mark: str | None) -> list[str]:
    """The cells of a line between the separators `mark`, without blanks and quotes around them."""
    if mark is None:
        return line.replace('"', "").split()
    line = line.strip(" \r\n") if mark == "\t" else line.strip()
    if '"' in line:
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=mark, skipinitialspace=True), [])]
        except csv.Error:
            return [line]
    return [cell.strip() for cell in line.split(mark)]


def _trimmed(cells: list[str]) -> list[str]:
    """The cells without the empty ones at the end."""
    last = max((i for i, cell in enumerate(cells) if cell), default=-1)
    return cells[: last + 1]


def is_number(cell: str) -> bool:
    """True for a number, which may have a decimal point or comma and an exponent."""
    return NUMBER.fullmatch(cell.replace("−", "-")) is not None


def _is_decimal(cell: str) -> bool:
    return is_number(cell) and bool(re.search(r"[.,]", cell))
