"""Stamps of date and time in a table, as loggers write them, converted to seconds."""

from __future__ import annotations

import datetime
import re
from math import inf

DATE = r"(?P<a>\d{1,4})(?P<mark>[-/.])(?P<b>\d{1,2})(?P=mark)(?P<c>\d{1,4})"
CLOCK = (
    r"(?P<h>\d{1,2}):(?P<m>\d{2}(?:[.,]\d+)?)(?::(?P<s>\d{2}(?:[.,]\d+)?))?\s*"
    r"(?P<half>[AaPp][Mm])?(?:Z|UTC|[-+]\d{2}:?\d{2})?"
)
STAMP = re.compile(rf"(?:{DATE})?(?:(?<=\d)[T ]+)?(?:{CLOCK})?", re.ASCII)


def stamp_columns(cells: list[str]) -> int:
    """Number of columns at the left that hold date and time: 1 for "2024-03-01 12:00:00", 2 for a date and a clock."""
    if not cells or not (first := _stamp(cells[0])):
        return 0
    date_only = first["a"] is not None and first["h"] is None
    second = _stamp(cells[1]) if len(cells) > 1 and date_only else None
    return 2 if second and second["h"] is not None and second["a"] is None else 1


def _stamp(cell: str) -> re.Match[str] | None:
    """The parts of a date, a clock time or both in a cell; None if it holds something else."""
    found = STAMP.fullmatch(cell)
    if not found or (found["a"] is None and found["h"] is None):
        return None
    return None if found["a"] is not None and max(len(found["a"]), len(found["c"])) < 2 else found


class Clock:
    """Converts the stamps of a table, row by row, to seconds since midnight of the first day.

    In a date such as 03/04/24 the rows have to show which number is the day: one above 12 does. If all rows have the
    same date the order does not matter. A clock without dates goes on past midnight. A row that is wrong raises `error`
    with the name of the file and the line.

    first      parts of the first date whose order is not known, None before there is one
    day_first  whether the day stands first; None as long as this is not known
    last       time of the last row [s]; midnights: times that a clock without dates has passed midnight
    origin     number of the first day, as of `date.toordinal`
    """

    def __init__(self, name: str, error: type[Exception]) -> None:
        self.name, self.error = name, error
        self.first: tuple[str, ...] | None = None
        self.day_first: bool | None = None
        self.last = -inf
        self.midnights = 0
        self.origin: int | None = None

    def seconds(self, cells: list[str], number: int) -> str:
        """The time of the stamp in these cells of line `number`, as text with a number of seconds."""
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
            raise self.error(f"{self.name}, line {number}: {words!r} is no date or time") from None
        self.last = time
        return repr(float(time))

    @staticmethod
    def _clock(found: re.Match[str]) -> float:
        """Seconds since midnight; 0 for a date alone. Raises ValueError where there is no such time."""
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
        """Number of the day, as of `date.toordinal`. Raises `error` where day and month may be swapped."""
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
                raise self.error(
                    f"{self.name}, line {number}: {a}/{b} may be a day and a month or the reverse: write dates as "
                    "2024-12-31"
                )
            day_first = self.day_first is not False
            self.first = self.first or (a, b, c)
            return datetime.date(year, int(b if day_first else a), int(a if day_first else b)).toordinal()
        if self.first is not None and self.day_first is None and day_first is False:
            raise self.error(f"{self.name}, line {number}: write dates as 2024-12-31")
        self.day_first = day_first
        return datetime.date(year, int(b if day_first else a), int(a if day_first else b)).toordinal()
