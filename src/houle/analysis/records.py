"""Surface elevations at places along a flume, from arrays, a run, a dataset or a laboratory's CSV."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError, positive
from houle.analysis.holes import ROUNDED, UNITS, rising, seconds
from houle.analysis.levels import Gauges
from houle.data.csv_table import Table, missing_codes, read_table
from houle.data.units import LENGTHS, TIMES, is_time, unit_of

if TYPE_CHECKING:
    import xarray

Real = NDArray[np.float64]
PLACE = r"\bx\s*=\s*([-+]?\d*[.,]?\d+)\s*(mm|cm|m)?\b"
# names of columns that number the rows
COUNTS = {"sample", "samples", "index", "no", "nr", "n", "i", "record", "scan", "point", "#"}


def gauges(time: ArrayLike, x: ArrayLike, eta: ArrayLike, names: Sequence[str] | None = None) -> Gauges:
    """Gauges made of arrays, after a check: time (T,), x (G,), eta (G, T), or (T,) for one. Raises AnalysisError."""
    t, places = seconds(time), np.atleast_1d(np.asarray(x, dtype=float))
    rows = np.atleast_2d(np.asarray(eta, dtype=float))
    labels = tuple(f"x={p:.4g}" for p in places) if names is None else tuple(str(n) for n in names)
    if t.ndim != 1 or len(t) < 3 or rows.shape != (len(places), len(t)) or len(labels) != len(places):
        raise AnalysisError(
            f"eta has shape {rows.shape}, time {t.shape}, x {places.shape}, {len(labels)} names: eta must be "
            "(gauges, times)"
        )
    t = _evenly(rising(t))
    for label, row in zip(labels, rows, strict=True):
        codes = np.flatnonzero(missing_codes(row, UNITS))
        bad = codes if codes.size else np.flatnonzero(~np.isfinite(row))
        if bad.size:
            i = int(bad[0])
            what = f"holds {row[i]:g}, a code for a missing value," if codes.size else "has no level"
            raise AnalysisError(
                f"gauge {label} {what} at t = {t[i]:g} s ({'' if codes.size else 'dry, or '}missing): leave the gauge "
                f"out or shorten the record{_longest(t, bad)}"
            )
    return Gauges(t, places, rows, labels)


def _evenly(t: Real) -> Real:
    """The times, even to a hundredth of the interval; rounded ones are corrected. Raises AnalysisError."""
    gaps = np.diff(t)
    mean = float(gaps.mean())
    if np.all(np.abs(gaps - mean) < 0.01 * mean):
        return t
    straight = np.linspace(t[0], t[-1], len(t))
    if np.abs(t - straight).max() <= ROUNDED * mean and np.ptp(np.round(t, _digits(t)) - t) < 1e-9 * abs(t).max():
        return straight
    i = int(np.argmax(np.abs(gaps - np.median(gaps))))
    raise AnalysisError(
        f"the times are not evenly spaced and rising: samples {i} and {i + 1} are {gaps[i]:.6g} s apart (t = {t[i]:.8g}"
        f" s), most others {np.median(gaps):.6g} s: interpolate the record to a fixed interval first, or shorten it"
    )


def _digits(t: Real) -> int:
    """Number of decimals with which the times were written, 12 at most."""
    wanted = (d for d in range(12) if np.all(np.abs(np.round(t, d) - t) < 1e-9 * max(1.0, float(np.abs(t).max()))))
    return next(wanted, 12)


def _longest(t: Real, bad: NDArray[np.intp]) -> str:
    """Words on the longest part of the record without bad samples; "" if there is none."""
    edges = np.concatenate([[-1], bad, [len(t)]])
    i = int(np.argmax(np.diff(edges)))
    first, last = int(edges[i]) + 1, int(edges[i + 1]) - 1
    return f" (the longest whole part is {t[first]:g} to {t[last]:g} s)" if last > first else ""


def as_gauges(
    source: Any, chosen: Sequence[str | int] | None = None, window: tuple[float, float] | None = None
) -> Gauges:
    """Gauges from Gauges, a Run of houle, a Dataset like series.nc, a tuple (time, x, eta) or a path (see read).

    Only the chosen gauges and the samples in the window need to be wet. surface.nc, eta(time, x), works too: every
    column of cells is a gauge (2D). Raises AnalysisError.
    """
    everything = _raw(source).pick(chosen)
    if window is not None:
        everything = everything.between(*window)
    try:
        return gauges(everything.time, everything.x, everything.eta, everything.names)
    except AnalysisError as error:
        raise AnalysisError(f"{error}. {everything.notes}" if everything.notes else str(error)) from None


def places(source: Any) -> Gauges:
    """Names and places of all the gauges of a source; the levels may hold NaN, where a gauge is dry."""
    return _raw(source)


def _raw(source: Any) -> Gauges:
    if isinstance(source, Gauges):
        return source
    notes = ""
    if isinstance(source, tuple):
        if len(source) != 3:
            raise AnalysisError(f"{len(source)} arrays were given: (time, x, eta) are needed")
        time, (x, eta) = seconds(source[0]), (np.asarray(part, dtype=float) for part in source[1:])
        names: Sequence[str] = [f"x={p:.4g}" for p in np.atleast_1d(x)]
    else:
        data = read(source) if isinstance(source, str | os.PathLike) else getattr(source, "series", source)
        time, x, eta, names = _of_dataset(data)
        notes = str(data.attrs.get("notes", ""))
    rows = np.atleast_2d(eta)
    if rows.shape != (np.size(x), np.size(time)):
        raise AnalysisError(
            f"eta has shape {rows.shape}, time {np.shape(time)}, x {np.shape(x)}: eta must be (gauges, times)"
        )
    if np.size(time) < 3:
        raise AnalysisError(f"the record has {np.size(time)} samples: three or more are needed")
    return Gauges(time, np.atleast_1d(x), rows, tuple(names), notes)


def _of_dataset(data: xarray.Dataset) -> tuple[Real, Real, Real, list[str]]:
    if "eta" not in data or "time" not in data["eta"].dims:
        raise AnalysisError("the dataset has no eta(gauge, time): was the case run without gauges?")
    eta = data["eta"]
    place = "gauge" if "gauge" in eta.dims else "x"
    if set(eta.dims) != {place, "time"}:
        raise AnalysisError(f"eta has the dimensions {eta.dims}: (gauge, time) or (time, x) can be used")
    x = data["gauge_x"] if place == "gauge" else data["x"]
    names = [str(n) for n in data["gauge"].values] if place == "gauge" else [f"x={p:.4g}" for p in x.values]
    levels = eta.transpose(place, "time").values * _factor(eta.attrs.get("units"), LENGTHS, "eta")
    time = seconds(data["time"].values) * _factor(data["time"].attrs.get("units"), TIMES, "time")
    return time, x.values.astype(float) * _factor(x.attrs.get("units"), LENGTHS, "x"), levels, names


def _factor(unit: Any, units: dict[str, float], name: str) -> float:
    """Factor to m or s of the unit in a dataset ("s", "hours since ..."), 1 without one. Raises AnalysisError."""
    word = str(unit).strip().lower().split(" since ")[0] if unit is not None else ""
    if word and word not in units and word != "1":
        raise AnalysisError(f"the dataset has {name} in {unit!r}: convert it to one of {', '.join(sorted(units))}")
    return units.get(word, 1.0)


def read(path: str | os.PathLike[str]) -> xarray.Dataset:
    """Reads eta(gauge, time) from the folder of a run, a netCDF file or a laboratory's table. Raises AnalysisError."""
    import xarray

    place = Path(path) / "series.nc" if Path(path).is_dir() else Path(path)
    if place.suffix not in (".nc", ".nc4"):
        return read_csv(place)
    try:
        return xarray.load_dataset(place, engine="h5netcdf", decode_times=False)
    except (OSError, ValueError, KeyError) as error:
        raise AnalysisError(f"{place} cannot be read: {error}") from None


def read_csv(
    path: str | os.PathLike[str], positions: Sequence[float] | None = None, interval: float | None = None
) -> xarray.Dataset:
    """Reads a laboratory's table as a dataset like series.nc: eta(gauge, time) [m], gauge_x [m].

    Numbers separated by semicolons, tabs, commas or blanks, with a decimal point or comma; above them a line of names,
    perhaps one of units, titles and comments (#), or nothing. The column of times is that with the name of one (t,
    Time [s], Zeit, X_Value, a date), or the first if it rises; every other one is a gauge. A table without times takes
    `interval` [s] between its rows. Units in names or under them are converted, [mm], (ms), _cm, / mm; without, m and
    s. Dates and clocks become seconds since the first row. The places come from `positions` [m], or from a line
    "# x: 1.0, 1.35, 1.9", or from names like "x=1.35". Empty cells and codes for missing values (-9999) become NaN; the
    attribute `notes` names the codes. Raises AnalysisError, with the line.
    """
    import xarray

    table = read_table(Path(path), str(path), AnalysisError)
    values, names = table.values, [unit_of(name)[0] for name in table.names]
    time, used = _times(path, table, interval)
    columns = [c for c in range(values.shape[1]) if c not in used and not _is_count(table, c)]
    columns = [c for c in columns if table.names[c] or not np.all(np.isnan(values[:, c]))]
    labels = [names[c] or f"column {c + 1}" for c in columns]
    labels = [f"{n} ({labels[:i].count(n) + 1})" if labels.count(n) > 1 else n for i, n in enumerate(labels)]
    if not columns:
        raise AnalysisError(f"{path} has no gauge beside the time")
    notes, scale = [], [_scale(path, table, c, LENGTHS, positions is not None) for c in columns]
    for label, column in zip(labels, columns, strict=True):
        if (codes := np.flatnonzero(missing_codes(values[:, column]))).size:
            line, code = table.lines[codes[0]], values[codes[0], column]
            notes.append(f"{label}: {code:g} is taken for a missing value, {codes.size} times, first in line {line}")
            values[codes, column] = np.nan
    x = _positions(path, [table.names[c] for c in columns], table.above) if positions is None else list(positions)
    if len(x) != len(labels):
        raise AnalysisError(f"{path} has {len(labels)} gauges ({', '.join(labels)}) and {len(x)} positions were given")
    eta = values[:, columns].T
    eta *= np.array(scale)[:, None]
    coordinates = {"time": ("time", time), "gauge": ("gauge", labels), "gauge_x": ("gauge", np.asarray(x, float))}
    return xarray.Dataset(
        {"eta": (("gauge", "time"), eta)}, coordinates, {"source": str(path), "notes": "; ".join(notes)}
    )


def _times(path: Any, table: Table, interval: float | None) -> tuple[Real, list[int]]:
    """Times (T,) [s], rising, and the numbers of the columns that are not gauges."""
    named = [c for c, name in enumerate(table.names) if is_time(name) or _has_unit(table, c, TIMES)]
    column = 0 if table.stamped else named[0] if named else None
    same = [c for c in named if column is not None and _equal(table.values[:, c], table.values[:, column])]
    if len(named) > 1 and len(same) < len(named) and not table.stamped:
        raise AnalysisError(f"{path} has {len(named)} columns of times: {', '.join(table.names[c] for c in named)}")
    if interval is not None:
        positive(interval=interval)
        return np.asarray(interval * np.arange(len(table.values)), dtype=float), named
    if column is None and _rises(table.values[:, 0]) and not _like_a_gauge(table):
        column = 0
    if column is None:
        first = f"its first column, {table.names[0]!r}," if table.names[0] else "its first column"
        raise AnalysisError(
            f"{path} has no column of times: {first} has not the name of one and does not rise. Give interval=, the "
            "time between two rows in s"
        )
    time = table.values[:, column] * (1.0 if table.stamped else _scale(path, table, column, TIMES, False))
    if np.all(np.isnan(time)) and (step := _lvm_step(table)):
        time = np.asarray(step * np.arange(len(time)), dtype=float)
    bad = (
        np.flatnonzero(~np.isfinite(time)) if not np.all(np.isfinite(time)) else 1 + np.flatnonzero(np.diff(time) <= 0)
    )
    if bad.size:
        i = int(bad[0])
        before = f" after {time[i - 1]:.12g}" if i else ""
        raise AnalysisError(
            f"{path}, line {table.lines[i]}: the time is {time[i]:.12g} s{before}: times must rise. Sort the rows, or "
            "give interval="
        )
    return time, sorted({column, *named})


def _has_unit(table: Table, column: int, units: dict[str, float]) -> bool:
    unit = unit_of(table.names[column])[1] or table.units[column].strip("[](){} ")
    return unit.lower() in units


def _scale(path: Any, table: Table, column: int, units: dict[str, float], placed: bool) -> float:
    """Factor that turns a column into m or s.

    Raises AnalysisError for another unit, or for one that may be that of the place.
    """
    name, below = table.names[column], table.units[column].strip("[](){} ")
    unit = unit_of(name)[1]
    if unit and below and unit.lower() != below.lower():
        raise AnalysisError(f"{path}: column {name!r} has the unit {below!r} under it: which is right?")
    unit = unit or below
    place = re.search(PLACE, name, re.IGNORECASE)
    if not unit and not placed and units is LENGTHS and place and (place[2] or "m").lower() != "m":
        raise AnalysisError(
            f"{path}: column {name!r}: is {place[2]} the unit of the place or of the levels? Write it in brackets, "
            "x=1.35 [mm], with the place in m"
        )
    if unit and unit.lower() not in units:
        raise AnalysisError(
            f"{path}: column {name or column + 1!r}: the unit {unit!r} is not one of {', '.join(sorted(units))}: "
            "convert it, or leave the column out"
        )
    return units[unit.lower()] if unit else 1.0


def _is_count(table: Table, column: int) -> bool:
    """True for a column that numbers the rows, by its name and its values."""
    name = table.names[column].strip().lower().rstrip(".")
    return name in COUNTS and bool(np.all(np.diff(table.values[:, column]) == 1.0))


def _rises(values: Real) -> bool:
    return bool(np.all(np.isfinite(values)) and np.all(np.diff(values) > 0))


def _equal(one: Real, other: Real) -> bool:
    return bool(np.array_equal(one, other, equal_nan=True))


def _like_a_gauge(table: Table) -> bool:
    """True if the first column is named like the others: W1, W2; x=0.5, x=1.0."""
    stems = [re.sub(r"[-+.\d]+", "", unit_of(name)[0]).strip().lower() for name in table.names]
    return bool(table.names[0]) and ((len(stems) > 1 and stems[0] == stems[1]) or stems[0].startswith("x="))


def _lvm_step(table: Table) -> float:
    """Interval [s] of a LabVIEW measurement without times; 0 if the table is none."""
    found = [re.match(r"Delta_X[\t;,\s]+([-+\d.,eE]+)", line) for line in table.above]
    return next((float(m[1].rstrip(",").replace(",", ".")) for m in found if m), 0.0)


def _positions(path: Any, names: list[str], above: Sequence[str]) -> list[float]:
    for line in above:
        found = re.match(r"x\s*(?:[\[(]\s*(\w+)\s*[\])]|_(\w+))?\s*[:=;\t,]\s*(.+)$", line, re.IGNORECASE)
        if found:
            unit = (found[1] or found[2] or "m").lower()
            if unit not in LENGTHS:
                raise AnalysisError(f"{path}: {line!r}: the unit {unit!r} is not one of {', '.join(sorted(LENGTHS))}")
            return [LENGTHS[unit] * float(w) for w in re.findall(r"[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?", found[3])]
    in_names = [re.search(PLACE, name, re.IGNORECASE) for name in names]
    if all(in_names):
        return [float(m[1].replace(",", ".")) * LENGTHS[(m[2] or "m").lower()] for m in in_names if m]
    raise AnalysisError(
        f"{path} does not say where its gauges stand: give positions=[...] in metres, or a line '# x: 1.0, 1.35, 1.9'"
    )
