"""When a run writes what: series rows at exact multiples of `series_every`, frames at exact multiples of `every`.

Frames are stop times: the step before is shortened to land on them. Series rows are not; they are interpolated linearly
between the samples of the steps around them. The sample of the last step is therefore part of the checkpoint.
"""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

Sample = dict[str, NDArray[np.float64]]
PREFIX = "recorder."


def multiple(k: int, interval: float) -> float:
    """k intervals [s], multiplied as the decimal number the user wrote: 3 x 0.1 is 0.3 and equals 60 x 0.005."""
    return float(Decimal(repr(float(interval))) * k)


def interpolate(time: float, before: tuple[float, Sample], after: tuple[float, Sample]) -> Sample:
    """Linear in time, before < time <= after; exactly `after` at its time. NaN (dry) on either side stays NaN."""
    (t0, first), (t1, second) = before, after
    if time == t1:
        return second
    weight = (time - t0) / (t1 - t0)
    return {name: first[name] + weight * (second[name] - first[name]) for name in second}


class Recorder:
    """Hands rows and frames to the writers. Call start() at time 0 or restore(), then step() after every step."""

    def __init__(self, outputs: Any, end: float, every: float, series_every: float) -> None:
        self.outputs, self.end, self.every, self.series_every = outputs, float(end), every, series_every
        self.rows = self.frames = 0  # how many were written
        self.before: tuple[float, Sample] = (0.0, {})

    @property
    def stop(self) -> float:
        """The time [s] of the next frame, which no step may pass: a multiple of `every`, or the end."""
        return min(multiple(self.frames, self.every), self.end)

    @property
    def written(self) -> float:
        """The time [s] up to which rows and frames were handed over: that of the last step."""
        return self.before[0]

    def start(self, simulation: Any) -> None:
        """The first row and the first frame, at the time of the simulation."""
        self.before = (simulation.time, sample(simulation))
        self.outputs.append_series(simulation.time, self.before[1])
        self.outputs.append_frame(simulation.frame())
        self.rows = self.frames = 1

    def step(self, simulation: Any, values: Sample) -> None:
        """The rows since the last step, given sample(simulation), and the frame if this step ends on one."""
        after = (simulation.time, values)
        while (time := multiple(self.rows, self.series_every)) <= after[0]:
            self.outputs.append_series(time, interpolate(time, self.before, after))
            self.rows += 1
        self.before = after
        if simulation.time >= self.stop:
            self.outputs.append_frame(simulation.frame())
            self.frames += 1

    def state(self) -> dict[str, Any]:
        """What a checkpoint must hold beside the simulation's own state; every name starts with PREFIX."""
        time, values = self.before
        counters = {"rows": np.int64(self.rows), "frames": np.int64(self.frames), "time": np.float64(time)}
        return {PREFIX + k: v for k, v in counters.items()} | {f"{PREFIX}sample.{k}": v for k, v in values.items()}

    def restore(self, state: dict[str, Any]) -> None:
        """Goes on from state(); names that are not the recorder's are left alone."""
        self.rows, self.frames = int(state[PREFIX + "rows"]), int(state[PREFIX + "frames"])
        mark = PREFIX + "sample."
        values = {k.removeprefix(mark): np.asarray(v, dtype=float) for k, v in state.items() if k.startswith(mark)}
        self.before = (float(state[PREFIX + "time"]), values)


def sample(simulation: Any) -> Sample:
    """What the simulation observes now, copied."""
    return {name: np.array(value, dtype=float) for name, value in simulation.sample().items()}
