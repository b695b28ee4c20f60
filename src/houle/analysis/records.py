"""Surface elevations at places along a flume, from wherever they come: arrays, a run, a dataset, a laboratory's CSV."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError

if TYPE_CHECKING:
    import xarray

Real = NDArray[np.float64]
UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "s": 1.0, "ms": 1e-3, "min": 60.0}


@dataclass(frozen=True)
class Gauges:
    """time (T,) [s], evenly spaced and rising; x (G,) [m]; eta (G, T) [m] above any fixed level, finite."""

    time: Real
    x: Real
    eta: Real
    names: tuple[str, ...]

    @property
    def step(self) -> float:
        """Sampling interval [s]."""
        return float((self.time[-1] - self.time[0]) / (len(self.time) - 1))

    def pick(self, chosen: Sequence[str | int] | None) -> Gauges:
        """Only these gauges, by name or number, in this order; all of them when None."""
        if chosen is None:
            return self
        unknown = [c for c in chosen if (c not in self.names if isinstance(c, str) else not 0 <= c < len(self.names))]
        if unknown:
            raise AnalysisError(f"there is no gauge {unknown[0]!r}; there are: {', '.join(self.names)}")
        rows = [self.names.index(c) if isinstance(c, str) else int(c) for c in chosen]
        return Gauges(self.time, self.x[rows], self.eta[rows], tuple(self.names[r] for r in rows))

    def between(self, start: float, end: float) -> Gauges:
        """The samples of start <= time < end (to a thousandth of the sampling interval)."""
        keep = (self.time >= start - 1e-3 * self.step) & (self.time < end - 1e-3 * self.step)
        if not keep.any():
            raise AnalysisError(
                f"no sample between {start:g} and {end:g} s; the record goes from {self.time[0]:g} to "
                f"{self.time[-1]:g} s"
            )
        return Gauges(self.time[keep], self.x, self.eta[:, keep], self.names)


def gauges(time: ArrayLike, x: ArrayLike, eta: ArrayLike, names: Sequence[str] | None = None) -> Gauges:
    """Checks arrays: time (T,), x (G,), eta (G, T), or (T,) for one gauge. Raises AnalysisError."""
    t, places = np.asarray(time, dtype=float), np.atleast_1d(np.asarray(x, dtype=float))
    rows = np.atleast_2d(np.asarray(eta, dtype=float))
    labels = tuple(f"x={p:.4g}" for p in places) if names is None else tuple(str(n) for n in names)
    if t.ndim != 1 or len(t) < 3 or rows.shape != (len(places), len(t)) or len(labels) != len(places):
        raise AnalysisError(
            f"eta has shape {rows.shape}, time {t.shape}, x {places.shape}, {len(labels)} names: eta must be "
            "(gauges, times)"
        )
    step = np.diff(t)
    if not (np.all(np.isfinite(t)) and np.all(np.abs(step - step.mean()) < 0.01 * step.mean())):
        raise AnalysisError(
            "the times are not evenly spaced and rising: interpolate the record to a fixed interval first"
        )
    if not np.all(np.isfinite(rows)):
        g, i = np.argwhere(~np.isfinite(rows))[0]
        raise AnalysisError(
            f"gauge {labels[g]} has no level at t = {t[i]:g} s (dry, or missing): leave the gauge out or shorten the "
            "record"
        )
    return Gauges(t, places, rows, labels)


def as_gauges(
    source: Any, chosen: Sequence[str | int] | None = None, window: tuple[float, float] | None = None
) -> Gauges:
    """From a Gauges, a houle Run, an xarray Dataset like series.nc, a tuple (time, x, eta), or a path (see read).

    Only the chosen gauges and the samples in the window need to be wet. surface.nc, eta(time, x), works too: every
    column of cells is a gauge (2D). Raises AnalysisError.
    """
    everything = _raw(source).pick(chosen)
    if window is not None:
        everything = everything.between(*window)
    return gauges(everything.time, everything.x, everything.eta, everything.names)


def places(source: Any) -> Gauges:
    """Names and places of all the gauges of a source; the levels may hold NaN, where a gauge is dry."""
    return _raw(source)


def _raw(source: Any) -> Gauges:
    if isinstance(source, Gauges):
        return source
    if isinstance(source, tuple):
        time, x, eta = (np.asarray(part, dtype=float) for part in source)
        names: Sequence[str] = [f"x={p:.4g}" for p in np.atleast_1d(x)]
    else:
        data = read(source) if isinstance(source, str | os.PathLike) else getattr(source, "series", source)
        time, x, eta, names = _of_dataset(data)
    rows = np.atleast_2d(eta)
    if rows.shape != (np.size(x), np.size(time)):
        raise AnalysisError(
            f"eta has shape {rows.shape}, time {np.shape(time)}, x {np.shape(x)}: eta must be (gauges, times)"
        )
    return Gauges(time, np.atleast_1d(x), rows, tuple(names))


def _of_dataset(data: xarray.Dataset) -> tuple[Real, Real, Real, list[str]]:
    if "eta" not in data or "time" not in data["eta"].dims:
        raise AnalysisError("the dataset has no eta(gauge, time): was the case run without gauges?")
    eta = data["eta"]
    place = "gauge" if "gauge" in eta.dims else "x"
    if set(eta.dims) != {place, "time"}:
        raise AnalysisError(f"eta has the dimensions {eta.dims}: (gauge, time) or (time, x) can be used")
    x = data["gauge_x"] if place == "gauge" else data["x"]
    names = [str(n) for n in data["gauge"].values] if place == "gauge" else [f"x={p:.4g}" for p in x.values]
    return data["time"].values.astype(float), x.values.astype(float), eta.transpose(place, "time").values, names


def read(path: str | os.PathLike[str]) -> xarray.Dataset:
    """eta(gauge, time) of the folder of a run, of a netCDF file, or of a laboratory's table. Raises AnalysisError."""
    import xarray

    place = Path(path) / "series.nc" if Path(path).is_dir() else Path(path)
    if place.suffix not in (".nc", ".nc4"):
        return read_csv(place)
    try:
        return xarray.load_dataset(place, engine="h5netcdf", decode_times=False)
    except (OSError, ValueError, KeyError) as error:
        raise AnalysisError(f"{place} cannot be read: {error}") from None


def read_csv(path: str | os.PathLike[str], positions: Sequence[float] | None = None) -> xarray.Dataset:
    """A laboratory's table as a dataset like series.nc: eta(gauge, time) [m], gauge_x [m].

    One line of names, then numbers, separated by commas, semicolons (then a decimal comma is understood), tabs or
    blanks; # starts a comment. The first column is the time, each other one a gauge. Units [cm], [mm], (ms), _cm, ...
    in a name are converted; no unit: m and s. The places come from `positions`, or from a comment line "# x: 1.0,
    1.35, 1.9" [m], or from names like "x=1.35". Raises AnalysisError.
    """
    import xarray

    try:
        text = Path(path).read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise AnalysisError(f"{path} cannot be read: {error}") from None
    comments = [line.strip().lstrip("#").strip() for line in text if line.lstrip().startswith("#")]
    lines = [line.strip() for line in text if line.strip() and not line.lstrip().startswith("#")]
    header, numbers = _table(path, lines)
    scale = np.array([_unit(name) for name in header])
    values = numbers * scale
    names = [re.sub(r"\s*[\[(].*?[\])]\s*$", "", name) for name in header[1:]]
    x = _positions(path, names, comments) if positions is None else list(positions)
    if len(x) != len(names):
        raise AnalysisError(f"{path} has {len(names)} gauges ({', '.join(names)}) and {len(x)} positions were given")
    coordinates = {
        "time": ("time", values[:, 0]),
        "gauge": ("gauge", names),
        "gauge_x": ("gauge", np.asarray(x, float)),
    }
    return xarray.Dataset({"eta": (("gauge", "time"), values[:, 1:].T)}, coordinates, {"source": str(path)})


def _table(path: Any, lines: list[str]) -> tuple[list[str], Real]:
    if len(lines) < 4:
        raise AnalysisError(
            f"{path} has {len(lines)} lines that are not comments: a line of names and numbers are needed"
        )
    mark = next((m for m in (";", "\t", ",") if m in lines[0]), None)
    split = [[w.strip() for w in line.split(mark)] for line in lines]
    if mark == ";":
        split = [split[0], *([w.replace(",", ".") for w in row] for row in split[1:])]
    try:
        numbers = np.array([[float(w) if w else np.nan for w in row] for row in split[1:]])
    except ValueError as error:
        raise AnalysisError(f"{path} is not a table of numbers with one line of names: {error}") from None
    if numbers.ndim != 2 or numbers.shape[1] != len(split[0]) or numbers.shape[1] < 2:
        raise AnalysisError(f"{path}: {len(split[0])} names and rows of another length, or no gauge beside the time")
    return split[0], numbers


def _unit(name: str) -> float:
    found = re.search(r"[\[(]\s*(\w+)\s*[\])]\s*$", name) or re.search(r"_(cm|mm|ms|min|m|s)$", name)
    if found is None:
        return 1.0
    if found.group(1) not in UNITS:
        raise AnalysisError(f"column {name!r}: the unit {found.group(1)!r} is not one of {', '.join(UNITS)}")
    return UNITS[found.group(1)]


def _positions(path: Any, names: list[str], comments: list[str]) -> list[float]:
    for line in comments:
        found = re.match(r"x\s*(?:\[m\]|_m|\(m\))?\s*[:=]\s*(.+)$", line)
        if found:
            return [float(w) for w in re.findall(r"[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?", found.group(1))]
    in_names = [re.search(r"x\s*=\s*([-+]?\d*\.?\d+)", name) for name in names]
    if all(in_names):
        return [float(m.group(1)) for m in in_names if m]
    raise AnalysisError(
        f"{path} does not say where its gauges stand: give positions=[...] in metres, or a line '# x: 1.0, 1.35, 1.9'"
    )
