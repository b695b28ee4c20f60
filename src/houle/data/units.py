"""Units of lengths and times, as the names of columns in a table give them."""

from __future__ import annotations

import re

# lengths by unit [m], times by unit [s], and units of other quantities that a table may hold
LENGTHS = {"m": 1.0, "metre": 1.0, "meter": 1.0, "metres": 1.0, "meters": 1.0, "dm": 0.1, "cm": 1e-2, "mm": 1e-3,
           "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "km": 1e3, "in": 0.0254,
           "inch": 0.0254, "ft": 0.3048, "feet": 0.3048}  # fmt: skip
TIMES = {"s": 1.0, "sec": 1.0, "secs": 1.0, "sek": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "msec": 1e-3,
         "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "min": 60.0, "mins": 60.0, "minutes": 60.0, "h": 3600.0, "hr": 3600.0,
         "hour": 3600.0, "hours": 3600.0, "d": 86400.0, "day": 86400.0, "days": 86400.0}  # fmt: skip
SPEEDS = {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3}
OTHERS = {"", "-", "--", "1", "v", "volt", "volts", "mv", "a", "ma", "pa", "kpa", "hpa", "mbar", "bar", "n", "kn", "°c",
          "c", "deg", "°", "hz", *SPEEDS, "m2/s", "m3/s", "l/s", "m3", "l", "%"}  # fmt: skip
TIME_NAMES = re.compile(
    r"(t|time|times|zeit|temps|tid|tijd|tiempo|tempo|x_value|elapsed.*|seconds?|date|datum|datetime|date.?time|timestamp"
    r"|clock|uhrzeit|hour|heure|hora)([^a-z].*)?",
    re.IGNORECASE,
)


def unit_of(name: str) -> tuple[str, str]:
    """A column name split into name and unit: W1 [mm], t(ms), W1_cm, eta / mm, Time s; the unit is "" without one."""
    word = name.strip()
    if found := re.fullmatch(r"(.*?)\s*[\[({]\s*([^\])}]*?)\s*[\])}]", word):
        inside = found[2]
        return (word, "") if "=" in inside or re.fullmatch(r"[-+.\d\s]*", inside) else (found[1], inside)
    if found := re.fullmatch(r"(.+)_(cm|mm|m)_s", word):
        return found[1], f"{found[2]}/s"
    if found := re.fullmatch(r"(.+)_(cm|mm|ms|min|m|s)", word):
        return found[1], found[2]
    if re.search(r"\bx\s*=", word, re.IGNORECASE):
        return word, ""  # "eta x=1.5 m": the unit belongs to the place x, not to the values
    known = "|".join(sorted(LENGTHS | TIMES | SPEEDS, key=len, reverse=True))
    if found := re.fullmatch(rf"(.+?)\s*[/,]\s*({known})", word, re.IGNORECASE):
        return found[1], found[2]
    if found := re.fullmatch(r"(.+)\s(mm|cm|m|s|ms|sec|seconds)", word, re.IGNORECASE):
        return found[1], found[2]
    return word, ""


def is_time(name: str) -> bool:
    """True for the name of a column of times: t, Time [s], Zeit, X_Value, ..."""
    stem, unit = unit_of(name)
    return bool(TIME_NAMES.fullmatch(stem.strip())) and (not unit or unit.lower() in TIMES or unit.lower() in OTHERS)


def ratio(unit: str, own: str) -> float:
    """Factor from `unit` to the unit `own`: 10 from cm to mm; 0 if one is a length and the other a time, or unknown."""
    kind = next((k for k in (LENGTHS, TIMES, SPEEDS) if unit in k and own in k), None)
    return kind[unit] / kind[own] if kind else 0.0


def are_units(cells: list[str]) -> bool:
    """True for the cells of a line of units: all look like units, and at least half are known ones."""
    bare = [cell.strip("[](){} ").lower() for cell in cells]
    known = [word in LENGTHS or word in TIMES or word in SPEEDS for word in bare]
    like = [
        k or word in OTHERS or re.fullmatch(r"[\[(].*[\])]", cell.strip()) is not None
        for k, word, cell in zip(known, bare, cells, strict=True)
    ]
    return all(like) and 2 * sum(known) >= len(cells) and not (len(cells) == 2 and cells == ["t", "m"])
