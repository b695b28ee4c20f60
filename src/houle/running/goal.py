"""The goal of a run with time.until: it ends as soon as its answers are as sure as the case asks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from houle.running.recorder import SAME, Recorder, multiple

if TYPE_CHECKING:
    from houle.case.model import Case

WAVES = 20  # between two looks


class Goal:
    """Looks at the answers at every so many frames: a run ends at the same step however often it was resumed."""

    def __init__(self, case: Case, sure: Callable[[Path], bool]) -> None:
        """sure: whether the answers of the run in a folder are as sure as its case asks."""
        self.every, self.frames, self.sure, wave = case.output.every, 0, sure, case.wave
        if case.time.until is not None and wave is not None:
            self.frames = max(1, round(WAVES * wave.period / self.every))

    def due(self, recorder: Recorder) -> bool:
        """True if the last step ended on a frame at which the answers are looked at."""
        number, now = recorder.frames - 1, recorder.last.time
        return (
            self.frames > 0
            and number > 0
            and number % self.frames == 0
            and abs(now - multiple(number, self.every)) <= SAME * self.every
        )
