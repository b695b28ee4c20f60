"""Tables of numbers as laboratories, loggers and spreadsheets write them: CSV, tabs, blanks, LabVIEW.

What a file is like is read off its first lines: the encoding (UTF-8, UTF-16, else Windows-1252), the separator (;, tab,
comma, | or blanks), a decimal point or comma, title and comment lines above, a line of names, a line of units, stamps
of date and time. The numbers then go through NumPy's loadtxt line by line: a table of 1 GB needs little more memory
than its numbers. Whatever does not fit is refused with the number of its line; nothing is guessed twice.

pandas does not do this: it wants to be told the separator, the decimal sign, the lines to leave out and the encoding.
Once they are known loadtxt is as exact, tells more about what is wrong, and every run that reads a table is spared the
half second and the memory of importing it.
"""

from __future__ import annotations

import codecs
import csv
import datetime
import os
import re
import stat
from array import array
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from houle.errors import CaseError, HouleError

LONGEST = 1 << 20  # letters of a line
HEAD = 2000  # lines in which the numbers begin
MARKS = (";", "\t", ",", "|", None)  # between cells, None: blanks; in the order of trust

LENGTHS = {"m": 1.0, "metre": 1.0, "meter": 1.0, "metres": 1.0, "meters": 1.0, "dm": 0.1, "cm": 1e-2, "mm": 1e-3,
           "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "km": 1e3, "in": 0.0254,
           "inch": 0.0254, "ft": 0.3048, "feet": 0.3048}  # fmt: skip
TIMES = {"s": 1.0, "sec": 1.0, "secs": 1.0, "sek": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "msec": 1e-3,
         "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "min": 60.0, "mins": 60.0, "minutes": 60.0, "h": 3600.0, "hr": 3600.0,
         "hour": 3600.0, "hours": 3600.0, "d": 86400.0, "day": 86400.0, "days": 86400.0}  # fmt: skip
OTHERS = {"", "-", "--", "1", "v", "volt", "volts", "mv", "a", "ma", "pa", "kpa", "hpa", "mbar", "bar", "n", "kn", "°c",
          "c", "deg", "°", "hz", "m/s", "mm/s", "cm/s", "m2/s", "m3/s", "l/s", "m3", "l", "%"}  # fmt: skip
NUMBER = re.compile(r"[-+]?(\d+([.,]\d*)?|[.,]\d+)([eEdD][-+]?\d+)?", re.ASCII)
MISSING = {"", "nan", "-nan", "+nan", "nan(ind)", "-nan(ind)", "na", "n/a", "null", "none", "nil", "inf", "-inf",
           "+inf", "-", "--", "---", "*", "**", "***", "****", "*****", "?", "#n/a", "#na", "#nv", "#value!",
           "#div/0!", "#num!", "missing", "dry"}  # fmt: skip
CODES = (99.9, 99.99, 999.0, 999.9, 999.99, 999.25, 9999.0, 9999.9, 9999.25, 9999.99, 99999.0, 99999.9, 999999.0,
         32767.0, 32768.0, 65535.0)  # fmt: skip
REMARKS = {"comment", "comments", "remark", "remarks", "bemerkung"}
DATE = r"(?P<a>\d{1,4})(?P<mark>[-/.])(?P<b>\d{1,2})(?P=mark)(?P<c>\d{1,4})"
CLOCK = (
    r"(?P<h>\d{1,2}):(?P<m>\d{2}(?:[.,]\d+)?)(?::(?P<s>\d{2}(?:[.,]\d+)?))?\s*"
    r"(?P<half>[AaPp][Mm])?(?:Z|UTC|[-+]\d{2}:?\d{2})?"
)
STAMP = re.compile(rf"(?:{DATE})?(?:(?<=\d)[T ]+)?(?:{CLOCK})?", re.ASCII)
TIME_NAMES = re.compile(
    r"(t|time|times|zeit|temps|tid|tijd|tiempo|tempo|x_value|elapsed.*|seconds?|date|datum|datetime|date.?time|timestamp"
    r"|clock|uhrzeit|hour|heure|hora)([^a-z].*)?",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Table:
    """values (N, C), NaN where a cell is empty; names (C,) and units (C,) as written, "" without; lines (N,) of the
    file, from 1. stamped: the first column is a date or a clock, in seconds since the first row. above: lines before
    the numbers that are neither names nor units.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: NDArray[np.float64]
    lines: NDArray[np.int64]
    stamped: bool
    above: tuple[str, ...]


@dataclass
class _Form:
    """How the numbers of a file are written; first: line of the first of them; remark: a last column of words."""

    name: str
    error: type[HouleError]
    mark: str | None = None
    columns: int = 0
    first: int = 0
    remark: bool = False
    stamps: int = 0  # columns of date and time at the left: 0, 1, or 2
    names: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    above: list[str] = field(default_factory=list)
    decimal: str = ""


def read_table(file: Path | str, name: str, error: type[HouleError]) -> Table:
    """The table in a file. Raises `error`, the message beginning with `name`, when there is none, or a row is wrong."""
    encoding = _encoding(file, name, error)
    form = _sniff(file, encoding, name, error)
    lines = array("q")
    clock = _Clock(form)
    options: dict = {"delimiter": form.mark, "comments": None, "ndmin": 2, "dtype": float}
    try:
        values = np.loadtxt(_rows(_lines(file, encoding, name, error), form, lines, clock, False), **options)
    except ValueError as problem:
        for _ in _rows(_lines(file, encoding, name, error), form, array("q"), _Clock(form), True):
            pass  # names the line
        raise error(f"{name} is not a table of numbers: {problem}") from None
    values[~np.isfinite(values)] = np.nan
    if form.stamps:
        values[:, 0] = np.round(values[:, 0] - values[0, 0], 9)  # s, of stamps of a nanosecond
    names = form.names or [""] * form.columns
    units = form.units or _lvm_units(form) or [""] * form.columns
    if form.stamps == 2:
        names, units = ["time", *names[2:]], ["", *units[2:]]
    where = np.frombuffer(lines, dtype=np.int64)
    return Table(tuple(names), tuple(units), values, where, form.stamps > 0, tuple(form.above))


def header(file: Path, key: str, error: type[CaseError] = CaseError) -> list[str]:
    """The names of the columns. Raises `error` when the file, named by `key` of the case file, cannot be read."""
    name = f"{key} = {file}"
    return _sniff(file, _encoding(file, name, error), name, error).names


def read_columns(
    file: Path, columns: tuple[str, ...], key: str, error: type[CaseError] = CaseError
) -> tuple[list[NDArray[np.float64]], NDArray[np.float64]]:
    """The columns (N,) of these names, in this order; and the whole table (N, columns of the file).

    `key` of the case file names the file. eta_m is also found as "eta [mm]", t_s as "Time (ms)" or as a stamp of date
    and time, and brought to the unit asked for. What is missing is NaN. Raises `error` when the file cannot be read, is
    no such table, or holds a code for a missing value.
    """
    name, wanted = f"{key} = {file}", ",".join(columns)
    try:
        table = read_table(file, name, error)
    except error as problem:
        raise error(f"{problem}. A table with the header {wanted} is needed") from None
    places = [_find(table, column) for column in columns]
    if missing := [column for column, place in zip(columns, places, strict=True) if place is None]:
        there = ", ".join(filter(None, table.names)) or "no line of names"
        raise error(f"{name} is not a table with the header {wanted}: there is no {missing[0]} ({there})")
    chosen = []
    for column, place in zip(columns, places, strict=True):
        assert place is not None
        values = table.values[:, place[0]]
        if column[:2] not in ("t_", "x_") and (bad := np.flatnonzero(missing_codes(values))).size:
            raise error(
                f"{name}, line {table.lines[bad[0]]}: {column} = {values[bad[0]]:g} is a code for a missing value, not "
                "a measurement: leave the row out"
            )
        chosen.append(values * place[1] if place[1] != 1.0 else values)
    return chosen, table.values


def missing_codes(values: NDArray[np.float64], units: tuple[float, ...] = (1.0,)) -> NDArray[np.bool_]:
    """Where values (N,) are codes for a missing one: nines (-9999, 99.99, 999.9), -999.25, 32767, 1e15 and above.

    Such a number is taken for a code only if it lies away from all others by more than three times their range. units:
    factors by which the codes may have been multiplied before.
    """
    size = np.abs(values)
    likely = size >= 1e15
    for code in (code * unit for unit in units for code in CODES):
        likely |= np.abs(size - code) <= 2e-7 * code
    known = values[~likely & np.isfinite(values)] if likely.any() else values[:0]
    if not len(known):
        return np.zeros(len(values), dtype=bool)
    low, high = float(known.min()), float(known.max())
    away = 3.0 * max(high - low, 1e-3 * max(abs(low), abs(high)))
    with np.errstate(invalid="ignore"):
        return np.asarray(likely & ((values > high + away) | (values < low - away)), dtype=bool)


def unit_of(name: str) -> tuple[str, str]:
    """The name without its unit, and the unit: W1 [mm], t(ms), W1_cm, eta / mm, Time s. "" where none is written."""
    word = name.strip()
    if found := re.fullmatch(r"(.*?)\s*[\[({]\s*([^\])}]*?)\s*[\])}]", word):
        inside = found[2]
        return (word, "") if "=" in inside or re.fullmatch(r"[-+.\d\s]*", inside) else (found[1], inside)
    if found := re.fullmatch(r"(.+)_(cm|mm|ms|min|m|s)", word):
        return found[1], found[2]
    if re.search(r"\bx\s*=", word, re.IGNORECASE):
        return word, ""  # the unit, if any, is that of the place
    known = "|".join(sorted(LENGTHS | TIMES, key=len, reverse=True))
    if found := re.fullmatch(rf"(.+?)\s*[/,]\s*({known})", word, re.IGNORECASE):
        return found[1], found[2]
    if found := re.fullmatch(r"(.+)\s(mm|cm|m|s|ms|sec|seconds)", word, re.IGNORECASE):
        return found[1], found[2]
    return word, ""


def is_time(name: str) -> bool:
    """Whether a column of this name is one of times: t, Time [s], Zeit, X_Value, ..."""
    stem, unit = unit_of(name)
    return bool(TIME_NAMES.fullmatch(stem.strip())) and (not unit or unit.lower() in TIMES or unit.lower() in OTHERS)


def _find(table: Table, column: str) -> tuple[int, float] | None:
    """Place of a column and the factor to its unit: its name as it is, or its stem with a unit of the same kind."""
    if column in table.names:
        place = table.names.index(column)
        unit = table.units[place].strip("[]() ").lower()
        stem, own = unit_of(column)
        return (place, _factor(unit, own)) if unit and _factor(unit, own) else (place, 1.0)
    stem, own = unit_of(column)
    for place, name in enumerate(table.names):
        other, unit = unit_of(name)
        unit = (unit or table.units[place]).strip("[]() ").lower()
        same = other.lower() == stem.lower() or (stem == "t" and (is_time(name) or (table.stamped and place == 0)))
        unit = "s" if table.stamped and place == 0 else unit
        if same and (factor := _factor(unit, own)):
            return place, factor
    return None


def _factor(unit: str, own: str) -> float:
    """How many of the unit `own` one `unit` is; 0 if they are not of one kind."""
    kind = next((k for k in (LENGTHS, TIMES) if unit in k and own in k), None)
    return kind[unit] / kind[own] if kind else 0.0


# the file


def _encoding(file: Path | str, name: str, error: type[HouleError]) -> str:
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


def _lines(file: Path | str, encoding: str, name: str, error: type[HouleError]) -> Iterator[tuple[int, str]]:
    """Number and text of every line."""
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


# what the numbers look like


def _cells(line: str, mark: str | None) -> list[str]:
    """The cells of a line, without blanks and quotes around them."""
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
    """Without the empty cells at the end."""
    last = max((i for i, cell in enumerate(cells) if cell), default=-1)
    return cells[: last + 1]


def _is_number(cell: str) -> bool:
    return NUMBER.fullmatch(cell.replace("−", "-")) is not None


def _stamp_columns(cells: list[str]) -> int:
    """Columns at the left that hold date and time: "2024-03-01 12:00:00", or a date and a clock in two."""
    if not cells or not (first := _stamp(cells[0])):
        return 0
    date_only = first["a"] is not None and first["h"] is None
    second = _stamp(cells[1]) if len(cells) > 1 and date_only else None
    return 2 if second and second["h"] is not None and second["a"] is None else 1


def _stamp(cell: str) -> re.Match[str] | None:
    """A date, a clock or both."""
    found = STAMP.fullmatch(cell)
    if not found or (found["a"] is None and found["h"] is None):
        return None
    return None if found["a"] is not None and max(len(found["a"]), len(found["c"])) < 2 else found


def _holds_numbers(cells: list[str]) -> bool:
    """Whether these are the cells of a row: numbers and missing ones, at least one number, stamps at the left."""
    rest = cells[_stamp_columns(cells) :]
    numbers = sum(map(_is_number, rest))
    return numbers > 0 and all(_is_number(cell) or cell.lower() in MISSING for cell in rest)


def _with_remark(lines: list[tuple[int, str]], i: int, mark: str | None) -> bool:
    above = _trimmed(_cells(lines[i - 1][1], mark)) if i and mark else []
    return len(above) > 1 and above[-1].lower() in REMARKS


def _sniff(file: Path | str, encoding: str, name: str, error: type[HouleError]) -> _Form:
    """The form of a file, from the lines in which its numbers begin."""
    head: list[tuple[int, str]] = []
    for number, line in _lines(file, encoding, name, error):
        head.append((number, line))
        if number >= HEAD:
            break
    text = [(number, line) for number, line in head if line.strip() and not line.lstrip().startswith("#")]
    for i in range(len(text)):
        for mark in MARKS:
            if mark is not None and mark not in text[i][1]:
                continue
            remark = _with_remark(text, i, mark)
            rows = [_cells(line, mark) for _, line in text[i : i + 50]]
            rows = [row[:-1] if remark and len(row) > 1 and not _is_number(row[-1]) else row for row in rows]
            if _holds_numbers(rows[0]) and (len(rows) == 1 or _holds_numbers(rows[1])):
                form = _Form(name, error, mark, first=text[i][0], remark=remark)
                _name_columns(form, head, text, i, [row for row in rows if _holds_numbers(row)])
                return form
    raise error(f"{name} holds no rows of numbers in its first {len(head)} lines: a table is needed")


def _name_columns(
    form: _Form, head: list[tuple[int, str]], text: list[tuple[int, str]], i: int, rows: list[list[str]]
) -> None:
    """Finds names and units in the lines above row i, and how many columns there are."""
    counts = [len(_trimmed(row)) for row in rows]
    filled, most = max(set(counts), key=lambda n: (counts.count(n), n)), len(rows[0])
    form.stamps = _stamp_columns(rows[0])
    above = [line for number, line in text[:i]]
    form.columns = filled
    remark = 1 if form.remark else 0
    comments = [line.strip().lstrip("#").strip() for n, line in head if n < form.first and line.lstrip()[:1] == "#"]
    form.above = [*comments, *(line.strip() for line in above)]
    if not above:
        told = next(([c.strip() for c in n] for n in _splits(comments[-1], form.mark) if len(n) == filled), None) \
            if comments else None  # fmt: skip
        form.names = told if told and is_time(told[0]) and not all(map(_is_number, told)) else []
        return
    last = above[-1].strip().lstrip("%!").strip()
    found = next((n for n in _splits(last, form.mark) if filled <= len(n) - remark <= max(most, filled)), None)
    if found is None:
        _require_title(form, last, text[i - 1][0], filled)
        return
    names = found[: len(found) - remark]
    form.columns = len(names)
    before = above[-2].strip().lstrip("%!").strip() if len(above) > 1 else ""
    if _are_units(names):
        form.units = names
        known = (n for n in _splits(before, form.mark) if len(n) - remark == len(names)) if before else iter(())
        form.names = next(known, [""] * (len(names) + remark))[: len(names)]
    elif _is_number(names[0]) or (not is_time(names[0]) and len(names) > 1 and all(map(_is_decimal, names[1:]))):
        words = next((n for n in names if not _is_number(n) and n.lower() not in MISSING), names[0])
        raise form.error(
            f"{form.name}, line {text[i - 1][0]}: {words[:40]!r} is not a number, and the line is not one of names"
        )
    else:
        form.names = names


def _lvm_units(form: _Form) -> list[str]:
    """Units of the columns that the header of a LabVIEW measurement tells, if all are lengths; else none."""
    lines = (_trimmed(_cells(line, form.mark)) for line in form.above if line.startswith("Y_Unit_Label"))
    told = next(lines, [])[1:]
    levels = [i for i, name in enumerate(form.names) if not is_time(name)]
    if not told or len(told) != len(levels) or not all(unit.lower() in LENGTHS for unit in told):
        return []
    units = [""] * form.columns
    for i, unit in zip(levels, told, strict=True):
        units[i] = unit
    return units


def _is_decimal(cell: str) -> bool:
    return _is_number(cell) and bool(re.search(r"[.,]", cell))


def _splits(line: str, mark: str | None) -> Iterator[list[str]]:
    """The line of names taken apart as the rows are, then in the other ways that there are."""
    first = [] if mark is None else [_trimmed(_cells(line, mark))]
    others = [_trimmed(_cells(line, m)) for m in MARKS if m is not None and m in line and m != mark]
    blanks = [re.split(r"\s+(?![\[(])", line.strip()), line.split(), re.split(r"\s{2,}|\t", line.strip())]
    yield from [*first, *others, *(blanks if mark is None or not others else [])]


def _require_title(form: _Form, line: str, number: int, columns: int) -> None:
    """The line above the numbers must be words, not a line of names with too many or too few."""
    cells = _trimmed(_cells(line, form.mark))
    names = len(cells) > 1 and (form.mark is not None or is_time(cells[0]))
    if names and not cells[0].startswith("***"):
        raise form.error(f"{form.name}, line {number} has {len(cells)} names, the rows below it {columns} numbers")


def _are_units(cells: list[str]) -> bool:
    bare = [cell.strip("[](){} ").lower() for cell in cells]
    known = [word in LENGTHS or word in TIMES for word in bare]
    like = [
        k or word in OTHERS or re.fullmatch(r"[\[(].*[\])]", cell.strip()) is not None
        for k, word, cell in zip(known, bare, cells, strict=True)
    ]
    return all(like) and 2 * sum(known) >= len(cells) and not (len(cells) == 2 and cells == ["t", "m"])


# the rows


def _rows(
    lines: Iterator[tuple[int, str]], form: _Form, where: array[int], clock: _Clock, strict: bool
) -> Iterator[str]:
    """Rows as loadtxt reads them: numbers with points between marks, nan for what is missing. Line numbers to where.

    A row of plain numbers goes through as it is. strict: each number is looked at, and the first bad one is named.
    """
    mark, columns = form.mark, form.columns
    plain = re.compile(rf"[-+.eE\d {re.escape(mark or ' ')}]+").fullmatch
    joined = mark or " "
    quick = not strict and not form.stamps and not form.remark
    for number, line in lines:
        if number < form.first:
            continue
        text = line.strip(" \r\n") if mark == "\t" else line.strip()
        if not text or text.startswith("#"):
            continue
        where.append(number)
        if quick and form.decimal != "," and plain(text):
            count = len(text.split()) if mark is None else text.count(mark) + 1
            if count == columns and (mark is None or not _has_gap(text, mark)):
                form.decimal = "." if not form.decimal and "." in text else form.decimal
                yield text
                continue
        yield joined.join(_numbers(form, number, text, clock))


def _has_gap(text: str, mark: str) -> bool:
    return mark + mark in text or text[0] == mark or text[-1] == mark or f"{mark} " in text or " " + mark in text


def _numbers(form: _Form, number: int, text: str, clock: _Clock) -> list[str]:
    """The cells of a row, each a number or nan. Raises the error of the form with the line."""
    cells = _cells(text, form.mark)
    if form.remark:
        cells = cells[: form.columns]
    while len(cells) > form.columns and not cells[-1]:
        cells.pop()
    if len(cells) != form.columns:
        raise form.error(f"{form.name}, line {number} has {len(cells)} cells, the lines above it {form.columns}")
    stamp = [clock.seconds(cells[: form.stamps], number)] if form.stamps else []
    return stamp + [_number(form, number, i, cell) for i, cell in enumerate(cells) if i >= form.stamps]


def _number(form: _Form, number: int, column: int, cell: str) -> str:
    if cell.lower() in MISSING:
        return "nan"
    plain = cell.replace("−", "-")
    if not NUMBER.fullmatch(plain):
        name = f"{form.names[column]!r}" if form.names and form.names[column] else f"column {column + 1}"
        raise form.error(f"{form.name}, line {number}: {name} is {cell[:40]!r}, not a number")
    sign = "," if "," in plain else "." if "." in plain else ""
    if sign and form.decimal and sign != form.decimal:
        raise form.error(
            f"{form.name}, line {number}: {cell[:40]!r} has a decimal {sign!r}, the numbers above it {form.decimal!r}"
        )
    form.decimal = form.decimal or sign
    return plain.replace(",", ".").replace("D", "E").replace("d", "e")


class _Clock:
    """Stamps of date and time in seconds; which of two numbers is the day is found, or must not matter."""

    def __init__(self, form: _Form) -> None:
        self.form = form
        self.first: tuple[str, ...] | None = None
        self.day_first: bool | None = None
        self.last = -np.inf
        self.midnights = 0
        self.origin: int | None = None  # number of the first day

    def seconds(self, cells: list[str], number: int) -> str:
        found = STAMP.fullmatch(" ".join(cells))
        try:
            if found is None or (found["a"] is None and found["h"] is None):
                raise ValueError
            time = self._clock(found)
            if found["a"] is None:
                self.midnights += time + 86400.0 * self.midnights < self.last - 43200.0
                time += 86400.0 * self.midnights
            else:
                day = self._day(found, number)
                self.origin = day if self.origin is None else self.origin
                time += 86400.0 * (day - self.origin)
        except ValueError:
            words = " ".join(cells)[:40]
            raise self.form.error(f"{self.form.name}, line {number}: {words!r} is no date or time") from None
        self.last = time
        return repr(float(time))

    @staticmethod
    def _clock(found: re.Match[str]) -> float:
        if found["h"] is None:
            return 0.0
        hour, minute, second = float(found["h"]), found["m"].replace(",", "."), found["s"]
        if second is None and "." in minute:  # minutes and seconds
            return 60.0 * hour + float(minute)
        if found["half"]:
            hour = hour % 12 + (12 if found["half"].lower() == "pm" else 0)
        if hour > 24 or float(minute) >= 60:
            raise ValueError
        return 3600.0 * hour + 60.0 * float(minute) + float((second or "0").replace(",", "."))

    def _day(self, found: re.Match[str], number: int) -> int:
        """Number of the day. Raises ValueError, or the error of the form where day and month cannot be told apart."""
        a, b, c = found["a"], found["b"], found["c"]
        if len(a) == 4:
            return datetime.date(int(a), int(b), int(c)).toordinal()
        year = int(c) + (2000 if len(c) <= 2 else 0)
        if found["mark"] == "." or int(a) > 12:
            day_first = True
        elif int(b) > 12:
            day_first = False
        else:
            changes = self.first is not None and self.first != (a, b, c)
            if changes and self.day_first is None and a != b:
                raise self.form.error(
                    f"{self.form.name}, line {number}: {a}/{b} may be a day and a month or the reverse: write dates as "
                    "2024-12-31"
                )
            day_first = self.day_first is not False
            self.first = self.first or (a, b, c)
            return datetime.date(year, int(b if day_first else a), int(a if day_first else b)).toordinal()
        if self.first is not None and self.day_first is None and day_first is False:
            raise self.form.error(f"{self.form.name}, line {number}: write dates as 2024-12-31")
        self.day_first = day_first
        return datetime.date(year, int(b if day_first else a), int(a if day_first else b)).toordinal()
