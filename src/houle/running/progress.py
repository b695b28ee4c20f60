"""Reports of a run while it works: a bar with numbers on a terminal, plain lines elsewhere, or nothing.

Nothing heavy is imported here, so that the first words appear at once, before NumPy and the numerical core are loaded.
"""

from __future__ import annotations

import os
import sys
from collections import deque
from collections.abc import Iterator, Sized
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter
from typing import Protocol, TextIO

from houle.results.seconds import duration

BAR_EVERY = 0.25  # wall time between two drawings of the bar [s]
LINE_EVERY = 10.0  # wall time between two plain lines [s]
WINDOW = 30.0  # wall time over which speeds are averaged [s]


class Underway(Protocol):
    """The part of a simulation that its progress is read from: time [s], steps, particles, drift of the volume."""

    steps: int

    @property
    def time(self) -> float: ...

    @property
    def particles(self) -> Sized: ...

    @property
    def volume_drift(self) -> float: ...


@dataclass(frozen=True)
class Numbers:
    """Progress of a run. Speeds are means over the last WINDOW seconds; None as long as nothing was measured."""

    time: float
    end: float
    particles: int
    drift: float  # change of the water volume since the start, relative
    steps_per_second: float | None
    microseconds: float | None  # wall time per particle and step
    left: float | None  # wall time to the end [s]

    def __str__(self) -> str:
        return ", ".join([f"t = {self.time:.3f} of {self.end:g} s", self.share, *self.details])

    @property
    def share(self) -> str:
        """The share that is done, and the time that the rest will take, in words."""
        done = f"{100.0 * self.time / self.end:.0f} %"
        return done if self.left is None else f"{done}, {duration(self.left)} left"

    @property
    def details(self) -> list[str]:
        speed = []
        if self.steps_per_second is not None and self.microseconds is not None:
            speed = [f"{self.steps_per_second:.3g} steps/s", f"{self.microseconds:.2f} us/particle/step"]
        return [*speed, f"{self.particles:,} particles".replace(",", " "), f"volume drift {self.drift:+.0e}"]


class Meter:
    """Measures the progress of a simulation towards the time `end` [s]."""

    def __init__(self, end: float) -> None:
        self.end = end
        self.past: deque[tuple[float, float, int]] = deque()  # wall time, simulated time, steps

    def read(self, simulation: Underway) -> Numbers:
        now, count = perf_counter(), len(simulation.particles)
        self.past.append((now, simulation.time, simulation.steps))
        while len(self.past) > 2 and now - self.past[0][0] > WINDOW:
            self.past.popleft()
        then, time, steps = self.past[0]
        wall, done = now - then, simulation.steps - steps
        drift = simulation.volume_drift
        speed = micro = left = None
        if done > 0 and wall > 0:
            speed, micro = done / wall, 1e6 * wall / done / max(1, count)
            left = max(0.0, self.end - simulation.time) * wall / max(1e-300, simulation.time - time)
        return Numbers(simulation.time, self.end, count, drift, speed, micro, left)


class Silent:
    """Says nothing: for scripts and tests."""

    def say(self, text: str) -> None:
        pass

    def start(self, simulation: Underway, end: float) -> None:
        pass

    def step(self, simulation: Underway) -> None:
        pass

    def stop(self) -> None:
        pass


class Lines(Silent):
    """Plain lines, every LINE_EVERY seconds: for log files and batch queues.

    If nobody reads any more (the terminal closed, `| head` has seen enough) the run goes on without a word.
    """

    every = LINE_EVERY

    def __init__(self, stream: TextIO) -> None:
        self.stream, self.next, self.heard = stream, 0.0, True

    def say(self, text: str) -> None:
        if self.heard:
            try:
                print(text, file=self.stream, flush=True)
            except (OSError, ValueError):
                self.heard = False

    def start(self, simulation: Underway, end: float) -> None:
        self.meter, self.simulation = Meter(end), simulation
        self.show(self.meter.read(simulation))

    def step(self, simulation: Underway) -> None:
        if perf_counter() >= self.next:
            self.show(self.meter.read(simulation))

    def show(self, numbers: Numbers) -> None:
        self.next = perf_counter() + self.every
        self.say(str(numbers))

    def stop(self) -> None:
        self.show(self.meter.read(self.simulation))


class Bar(Lines):
    """A bar and a line of numbers on a terminal, drawn again a few times a second."""

    every = BAR_EVERY

    def start(self, simulation: Underway, end: float) -> None:
        from rich.console import Console
        from rich.live import Live

        self.live = Live(console=Console(file=self.stream), auto_refresh=False)
        with self._heard():
            self.live.start()
        super().start(simulation, end)

    def show(self, numbers: Numbers) -> None:
        from rich.console import Group
        from rich.progress_bar import ProgressBar
        from rich.table import Table
        from rich.text import Text

        self.next = perf_counter() + self.every
        first = Table.grid(padding=(0, 1))
        bar = ProgressBar(total=numbers.end, completed=numbers.time, width=30)
        first.add_row(f"t = {numbers.time:.3f} of {numbers.end:g} s", bar, numbers.share)
        with self._heard():
            self.live.update(Group(first, Text(" · ".join(numbers.details))), refresh=True)

    def stop(self) -> None:
        super().stop()
        with self._heard():
            self.live.stop()

    @contextmanager
    def _heard(self) -> Iterator[None]:
        try:
            yield
        except (OSError, ValueError):
            self.heard = False


def reporter(progress: bool, stream: TextIO | None = None) -> Silent:
    """A reporter for a stream (by default standard error): a bar if it is a terminal that can draw one, else lines."""
    stream = stream or sys.stderr
    if not progress or stream is None:  # none where it was closed
        return Silent()
    return Bar(stream) if stream.isatty() and os.environ.get("TERM") != "dumb" else Lines(stream)
