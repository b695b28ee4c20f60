"""The goal of a run with time.until: it ends as soon as its answers are as sure as the case asks."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from houle.running.recorder import SAME, Recorder, multiple

if TYPE_CHECKING:
    from houle.case.model import Case

WAVES = 20  # between two looks


class Goal:
    """Looks at the answers at every so many frames: a run ends at the same step however often it was resumed."""

    def __init__(self, case: Case) -> None:
        self.every, self.frames, wave = case.output.every, 0, case.wave
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

    def met(self, directory: Path) -> bool:
        """True if every answer that the case names is as sure as it asks, by what the files of the run hold."""
        from houle.results import reflection
        from houle.results.answers import enough, record
        from houle.results.run import Run

        run = Run(directory)
        wanted = run.case.time.until is not None and run.case.time.until.reflection is not None
        rows = record.answers(run, reflection.look(run) if wanted else {})
        return all(one.met for one in enough.asked(run.case, rows, enough.waves_of(run.case, run.directory)))
