"""The largest pressure at every sensor of a run, with its duration and impulse, from the series."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from houle.analysis import largest_pressure
from houle.output import series_table
from houle.output.netcdf import TIME, Variable

if TYPE_CHECKING:
    from houle.results.run import Run

STEPS = 5  # steps of the computation, or rows of the series, over which a pressure must last


def record(run: Run) -> dict[str, Any]:
    """The entry "pressure" of run.json, a list in the order of the sensors; {} without sensors or a second row."""
    series = series_table(run.directory)
    if not {"pressure", "step_size"} <= set(series) or series.sizes["time"] < 2:
        return {}
    time, step = series["time"].values, series["step_size"].values
    found = []
    for name, pressure in zip(series["sensor"].values, _along_time(series["pressure"]), strict=True):
        if not np.isfinite(pressure).all():
            continue
        at = float(step[max(1, int(np.argmax(pressure)))])
        window = STEPS * max(at, float(np.diff(time).max()))
        impact = largest_pressure(time, pressure, window=window)
        found.append({"sensor": str(name), **asdict(impact), "steps": impact.duration / at if at > 0 else 0.0})
    return {"pressure": found} if found else {}


def _along_time(variable: Variable) -> NDArray[np.float64]:
    """The values of each sensor against time, (sensors, times)."""
    return np.moveaxis(variable.values, variable.dims.index(TIME), -1)
