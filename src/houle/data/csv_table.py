"""Tables of numbers as laboratories, loggers and spreadsheets write them: CSV, tabs, blanks, LabVIEW.

`form.sniff` finds out how the numbers of a file are written. They then go through NumPy's loadtxt line by line, so that
a table of 1 GB needs little more memory than its numbers. A row that does not fit is refused with the number of its
line.

pandas would not save this work: it has to be told the separator, the decimal sign, the lines to leave out and the
encoding. Once these are known, loadtxt is as exact, its errors are more precise, and a run that reads a table does not
spend half a second and memory on importing pandas.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from houle.data.clock import Clock
from houle.data.form import MISSING, NUMBER, Form, cells_of, encoding_of, lines_of, lvm_units, sniff
from houle.data.units import is_time, ratio, unit_of
from houle.errors import CaseError, HouleError

# numbers that loggers write for a missing value
CODES = (99.9, 99.99, 999.0, 999.9, 999.99, 999.25, 9999.0, 9999.9, 9999.25, 9999.99, 99999.0, 99999.9, 999999.0,
         32767.0, 32768.0, 65535.0)  # fmt: skip


@dataclass(frozen=True)
class Table:
    """A table of N rows and C columns.

    names, units  (C,) as written in the file, "" without
    values        (N, C), NaN where a value is missing
    lines         (N,) number of the line of each row, from 1
    stamped       whether the first column was a date or a clock: it holds seconds since the first row
    above         lines above the numbers, also those of names and units
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: NDArray[np.float64]
    lines: NDArray[np.int64]
    stamped: bool
    above: tuple[str, ...]


def read_table(file: Path | str, name: str, error: type[HouleError]) -> Table:
    """The table in a file. Raises `error`, with a message that begins with `name`, where it has none or a wrong row."""
    encoding = encoding_of(file, name, error)
    form = sniff(file, encoding, name, error)
    lines = array("q")
    clock = Clock(name, error)
    options: dict = {"delimiter": form.mark, "comments": None, "ndmin": 2, "dtype": float}
    try:
        values = np.loadtxt(_rows(lines_of(file, encoding, name, error), form, lines, clock, False), **options)
    except ValueError as problem:
        for _ in _rows(lines_of(file, encoding, name, error), form, array("q"), Clock(name, error), True):
            pass  # names the line
        raise error(f"{name} is not a table of numbers: {problem}") from None
    values[~np.isfinite(values)] = np.nan
    if form.stamps:
        values[:, 0] = np.round(values[:, 0] - values[0, 0], 9)  # stamps are no finer than a nanosecond
    names, units = _heading(form)
    where = np.frombuffer(lines, dtype=np.int64)
    return Table(names, units, values, where, form.stamps > 0, tuple(form.above))


def _heading(form: Form) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units of the columns, as written; "" without."""
    names = form.names or [""] * form.columns
    units = form.units or lvm_units(form) or [""] * form.columns
    if form.stamps == 2:
        names, units = ["time", *names[2:]], ["", *units[2:]]
    return tuple(names), tuple(units)


def columns_in(file: Path, columns: tuple[str, ...], key: str, error: type[CaseError] = CaseError) -> list[str]:
    """Those of the columns that `read_columns` finds in a file, by its first lines: velocity_m_s as "Velocity [cm/s]".

    Raises `error` when the file, named by `key` of the case file, cannot be read.
    """
    name = f"{key} = {file}"
    form = sniff(file, encoding_of(file, name, error), name, error)
    names, units = _heading(form)
    return [column for column in columns if _find(names, units, form.stamps > 0, column) is not None]


def read_columns(
    file: Path, columns: tuple[str, ...], key: str, error: type[CaseError] = CaseError
) -> tuple[list[NDArray[np.float64]], NDArray[np.float64]]:
    """The columns (N,) of these names, in this order; and the whole table (N, columns of the file).

    A column eta_m is also found as "eta [mm]", and t_s as "Time (ms)" or as a stamp of date and time; the values are
    converted to the unit in the name that is asked for. Missing values are NaN. key: the key of the case file that
    names the file, for messages. Raises `error` where the file cannot be read, lacks a column, or holds a code for a
    missing value.
    """
    name, wanted = f"{key} = {file}", ",".join(columns)
    try:
        table = read_table(file, name, error)
    except error as problem:
        raise error(f"{problem}. A table with the header {wanted} is needed") from None
    places = [_find(table.names, table.units, table.stamped, column) for column in columns]
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
    """True (N,) for values that are codes for a missing one: nines (-9999, 99.99, 999.9), -999.25, 32767, above 1e15.

    Such a number counts as a code only if it is farther from all others than three times their range. units: factors by
    which the codes may have been multiplied before.
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


def _find(names: Sequence[str], units: Sequence[str], stamped: bool, column: str) -> tuple[int, float] | None:
    """Number of a column among those of a table, and the factor to the unit that is asked for; None if it is not there.

    It is found by its name as it is, or by the stem of its name with another unit of the same kind. stamped: the first
    column holds stamps of date and time.
    """
    if column in names:
        place = names.index(column)
        unit = units[place].strip("[]() ").lower()
        stem, own = unit_of(column)
        return (place, ratio(unit, own)) if unit and ratio(unit, own) else (place, 1.0)
    stem, own = unit_of(column)
    for place, name in enumerate(names):
        other, unit = unit_of(name)
        unit = (unit or units[place]).strip("[]() ").lower()
        same = other.lower() == stem.lower() or (stem == "t" and (is_time(name) or (stamped and place == 0)))
        unit = "s" if stamped and place == 0 else unit
        if same and (factor := ratio(unit, own)):
            return place, factor
    return None


def _rows(lines: Iterator[tuple[int, str]], form: Form, where: array[int], clock: Clock, strict: bool) -> Iterator[str]:
    """The rows as loadtxt reads them: numbers with decimal points between marks, nan for missing values.

    Appends the number of the line of each row to `where`. A row of plain numbers is passed on as it is; if strict, each
    number is checked, and the first bad one raises the error of the form.
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
    """True for a row with an empty cell."""
    return mark + mark in text or text[0] == mark or text[-1] == mark or f"{mark} " in text or " " + mark in text


def _numbers(form: Form, number: int, text: str, clock: Clock) -> list[str]:
    """The cells of a row, each a number or nan. Raises the error of the form, with the line, for anything else."""
    cells = cells_of(text, form.mark)
    if form.remark:
        cells = cells[: form.columns]
    while len(cells) > form.columns and not cells[-1]:
        cells.pop()
    if len(cells) != form.columns:
        raise form.error(f"{form.name}, line {number} has {len(cells)} cells, the lines above it {form.columns}")
    stamp = [clock.seconds(cells[: form.stamps], number)] if form.stamps else []
    return stamp + [_number(form, number, i, cell) for i, cell in enumerate(cells) if i >= form.stamps]


def _number(form: Form, number: int, column: int, cell: str) -> str:
    """A cell as a number with a decimal point, or nan. The file must have one decimal sign only."""
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
