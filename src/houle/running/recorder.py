"""The recorder of a run: it decides when rows of the series and frames are written, and hands them to the writers.

Rows stand at exact multiples of `series_every`, frames at exact multiples of `every` and at the instants that a
comparison needs. Frames are stop times: the step before is shortened to land on them. Rows are not; they are
interpolated linearly between the samples of the steps around them, each quantity at its own instant (leapfrog: levels
stand at the ends of steps, velocities in their middles). The samples of the last three steps are therefore part of the
checkpoint.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from houle.flow.snapshot import Snapshot

Sample = dict[str, NDArray[np.float64] | float]
PREFIX = "recorder."  # all its names in a checkpoint begin so
SAME = 1e-6  # two times nearer to each other than this share of the interval between frames are the same


def multiple(k: int, interval: float) -> float:
    """k intervals [s], multiplied as the decimal numbers that the user wrote: 3 x 0.1 is 0.3 and equals 60 x 0.005."""
    return float(Decimal(repr(float(interval))) * k)


@dataclass(frozen=True)
class Observed:
    """A sample taken at the end of a step, with the time [s] at that end and the length of the step [s]."""

    time: float
    step: float
    values: Sample

    def instant(self, lag: float) -> float:
        """The time [s] to which a quantity belongs that lags by this share of the step."""
        return self.time - lag * self.step


def interpolate(time: float, observed: Sequence[Observed], lag: Mapping[str, float]) -> Sample:
    """A row at a time [s], linear between the samples before and after, each quantity at its own instant.

    lag: share of a step by which the instant of a quantity lies before the end of the step. After the last instant the
    line through the last two goes on. NaN (dry) on either side stays NaN.
    """
    between = {share: _between(time, [o.instant(share) for o in observed]) for share in {0.0, *lag.values()}}
    row: Sample = {}
    for name in observed[-1].values:
        i, weight = between[lag.get(name, 0.0)]
        after = observed[i].values[name]
        before = observed[i - 1].values[name]
        row[name] = after if weight == 1.0 else before + weight * (after - before)
    return row


def _between(time: float, instants: Sequence[float]) -> tuple[int, float]:
    """Number of the next instant (of the last one if none comes), and its weight against the instant before it."""
    i = next((i for i, t in enumerate(instants) if t >= time), len(instants) - 1)
    if i == 0 or instants[i] == time or instants[i] <= instants[i - 1]:
        return i, 1.0
    return i, (time - instants[i - 1]) / (instants[i] - instants[i - 1])


class Writers(Protocol):
    """Receiver of rows and frames; `houle.output.Outputs` is one."""

    def append_series(self, time: float, sample: Mapping[str, Any]) -> None: ...

    def append_frame(self, frame: Snapshot) -> None: ...


class Marching(Protocol):
    """The part of a simulation that a recorder uses."""

    @property
    def time(self) -> float: ...

    @property
    def step_size(self) -> float: ...

    @property
    def lag(self) -> dict[str, float]: ...

    def sample(self) -> Sample: ...

    def frame(self) -> Snapshot: ...


class Nowhere:
    """Takes rows and frames and keeps none: for a recorder that only compares."""

    def append_series(self, time: float, sample: Mapping[str, Any]) -> None:
        """Does nothing."""

    def append_frame(self, frame: Snapshot) -> None:
        """Does nothing."""


class Recorder:
    """Hands rows and frames to the writers. Call start() at time 0 or restore(), then step() after every step.

    In the default scheme velocities belong to the middle of a step and pressures to its beginning, so that a row waits
    for one more step.
    `finish()` writes the last one, at the end of a run.
    """

    def __init__(
        self, outputs: Writers, end: float, every: float, series_every: float, instants: Sequence[float] = ()
    ) -> None:
        self.outputs, self.end, self.every, self.series_every = outputs, float(end), every, series_every
        self.instants = sorted(t for t in instants if SAME * every < t)  # [s]
        self.rows = self.frames = 0  # rows that were written; multiples of `every` that are passed
        self.observed: list[Observed] = []  # the last three samples

    @property
    def stop(self) -> float:
        """The time [s] of the next frame, which no step may pass: a multiple of `every`, an instant, or the end.

        The later of two that are the same but for round-off, 0.3 and 3 * 0.1: a step between them would be no step.
        """
        same, now = SAME * self.every, self.last.time if self.observed else 0.0
        stop = self.end
        ahead = self.instants[bisect_right(self.instants, now + same) :]
        for due in (multiple(self.frames, self.every), *ahead[:1]):
            stop = due if due < stop - same else stop
        return stop

    @property
    def written(self) -> list[float]:
        """The times [s] of the frames up to now."""
        now = self.last.time + SAME * self.every
        regular = [multiple(k, self.every) for k in range(self.frames)]
        between = [t for t in self.instants if t <= now and self._between(t)]
        return sorted([*regular, *between])

    def _between(self, time: float) -> bool:
        """True for an instant that is no multiple of `every`."""
        return abs(time - multiple(round(time / self.every), self.every)) > SAME * self.every

    @property
    def last(self) -> Observed:
        return self.observed[-1]

    @property
    def last_row(self) -> float:
        """The time [s] of the last row of the series."""
        return multiple(self.rows - 1, self.series_every)

    def start(self, simulation: Marching) -> None:
        """Writes the first row and the first frame, at the time of the simulation."""
        self.observed = [Observed(simulation.time, 0.0, simulation.sample())]
        self.outputs.append_series(simulation.time, self.last.values)
        self.outputs.append_frame(simulation.frame())
        self.rows = self.frames = 1

    def step(self, simulation: Marching, values: Sample) -> None:
        """Writes the rows that are due, and the frame if the step ends on one; values: sample() of the simulation."""
        stop = self.stop
        self.observed = [*self.observed[-2:], Observed(simulation.time, simulation.step_size, values)]
        self._write_rows(self.observed[-2].time, simulation.lag)
        if simulation.time >= stop:
            self.outputs.append_frame(simulation.frame())
            self._count_frames()

    def _count_frames(self) -> None:
        """Counts the multiples of `every` up to now, by the time alone: a former end may have been no multiple."""
        self.frames = int(self.last.time / self.every + SAME) + 1

    def finish(self, simulation: Marching) -> None:
        """Writes the rows up to the last step; quantities that lag go on along the line of their last two values."""
        self._write_rows(self.last.time, simulation.lag)

    def _write_rows(self, until: float, lag: Mapping[str, float]) -> None:
        while (time := multiple(self.rows, self.series_every)) <= until:
            self.outputs.append_series(time, interpolate(time, self.observed, lag))
            self.rows += 1

    def agrees(self, simulation: Marching) -> bool:
        """True if the restored samples and rows belong to this simulation: to its time and the shapes of its sample."""
        shapes = {name: np.shape(value) for name, value in simulation.sample().items()}
        times = [observed.time for observed in self.observed]
        row = multiple(self.rows, self.series_every)
        return (
            bool(times)
            and times[-1] == simulation.time
            and all(a < b for a, b in pairwise(times))
            and all(0 <= o.step < np.inf for o in self.observed)
            and all({n: np.shape(v) for n, v in o.values.items()} == shapes for o in self.observed)
            and self.last_row <= ([0.0, *times])[-2] < row
        )

    def state(self) -> dict[str, Any]:
        """The state of the recorder for a checkpoint; all names start with PREFIX."""
        state: dict[str, Any] = {PREFIX + "rows": np.int64(self.rows), PREFIX + "frames": np.int64(self.frames)}
        for i, observed in enumerate(self.observed):
            state[f"{PREFIX}{i}.time"] = np.float64(observed.time)
            state[f"{PREFIX}{i}.step"] = np.float64(observed.step)
            state |= {f"{PREFIX}{i}.sample.{k}": v for k, v in observed.values.items()}
        return state

    def restore(self, state: dict[str, Any]) -> None:
        """Takes a state() back; names that are not the recorder's are ignored."""
        self.rows = int(state[PREFIX + "rows"])
        self.observed = []
        while (key := f"{PREFIX}{len(self.observed)}.") + "time" in state:
            mark = key + "sample."
            values: Sample = {
                k.removeprefix(mark): np.asarray(v, dtype=float) for k, v in state.items() if k.startswith(mark)
            }
            self.observed.append(Observed(float(state[key + "time"]), float(state[key + "step"]), values))
        self._count_frames()
