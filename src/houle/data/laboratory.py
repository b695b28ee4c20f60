"""Laboratory points of the free surface: reading them, and the error of a computed surface against them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from houle.data.csv_table import read_columns
from houle.errors import CaseError


class Data(Protocol):
    """Variables by name, each with .values: an xarray.Dataset, or a Table of houle.output."""

    def __getitem__(self, name: Any, /) -> Any: ...

    def __contains__(self, name: Any, /) -> bool: ...


COLUMNS = ("t_s", "x_m", "eta_m")
SAME = 1e-9  # [s] times that differ by less are the same


@dataclass(frozen=True)
class Points:
    """Levels (N,) above z = 0 [m] measured at x (N,) [m] and time (N,) [s], sorted by time."""

    time: NDArray[np.float64]
    x: NDArray[np.float64]
    eta: NDArray[np.float64]

    @property
    def times(self) -> list[float]:
        """The times at which there are points, ascending [s]."""
        return [float(t) for t in np.unique(self.time)]


@dataclass(frozen=True)
class Score:
    """Error of a run against laboratory points: the rms of computed minus measured level [m].

    times    laboratory times that the run has reached [s]; rms: the error at each [m]
    overall  error over all points of the times after 0 [m]
    points   number of points of all these times
    """

    times: list[float]
    rms: list[float]
    overall: float
    points: int


def read(file: Path) -> Points:
    """The points of a CSV file: comment lines (#), a header t_s,x_m,eta_m, numbers. Raises CaseError."""
    (time, x, eta), rows = read_columns(file, COLUMNS, "reference.surface")
    if not np.all(np.isfinite(rows)):
        row = int(np.argwhere(~np.isfinite(rows))[0][0]) + 1
        raise CaseError(
            f"reference.surface = {file} holds a number that is not finite in its row {row}: leave out points "
            "without level"
        )
    order = np.argsort(time, kind="stable")
    return Points(time[order], x[order], eta[order])


def instants(file: Path | None) -> list[float]:
    """The times [s] of the laboratory points in a file, at which a run writes a profile and a frame; none without."""
    return [] if file is None else read(file).times


def level(surface: Data, time: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Computed level [m] at x (N,) [m] and time [s], from the profiles of a run; NaN where all is dry.

    It is linear between wet columns, constant beyond the outermost, and linear between two profiles if there is none at
    this time. In 3D it is the mean over the wet columns across the width.
    """
    times, eta = surface["time"].values, surface["eta"].values
    near = _around(times, time)
    first, last = (_profile(surface["x"].values, along(eta[i]), x) for i in (near[0], near[-1]))
    if len(near) == 1:
        return first
    start, stop = times[near]
    return first + (time - start) / (stop - start) * (last - first)


def along(eta: NDArray[np.float64]) -> NDArray[np.float64]:
    """A profile (nx,): as it is in 2D; in 3D (ny, nx) the mean of the wet columns across the width."""
    if eta.ndim == 1:
        return eta
    wet = np.isfinite(eta)
    count = wet.sum(axis=0)
    return np.where(count > 0, np.where(wet, eta, 0.0).sum(axis=0) / np.maximum(count, 1), np.nan)


def score(points: Points, surface: Data) -> Score | None:
    """Error of the run at the laboratory times that it has reached; None if it has reached none after 0."""
    reached = [t for t in points.times if t <= surface["time"].values[-1] + SAME]
    errors = [level(surface, t, points.x[points.time == t]) - points.eta[points.time == t] for t in reached]
    later = [e for t, e in zip(reached, errors, strict=True) if t > 0]
    if not later:
        return None
    return Score(reached, [_rms(e) for e in errors], _rms(np.concatenate(later)), sum(len(e) for e in errors))


def _profile(columns: NDArray[np.float64], eta: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
    wet = np.isfinite(eta)
    return np.interp(x, columns[wet], eta[wet]) if wet.any() else np.full(x.shape, np.nan)


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _around(times: NDArray[np.float64], time: float) -> list[int]:
    """Number of the profile at this time (`SAME`), or of the two around it."""
    nearest = int(np.argmin(np.abs(times - time)))
    if abs(times[nearest] - time) < SAME or time > times[-1] or time < times[0]:
        return [nearest]
    after = int(np.searchsorted(times, time))
    return [after - 1, after]
