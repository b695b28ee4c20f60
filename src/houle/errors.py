"""The two ways a run can end badly: the input was wrong (exit status 2), or the run failed (exit status 3)."""

from __future__ import annotations


class HouleError(Exception):
    """What the user should read; anything else that escapes is a bug of ours."""


class CaseError(HouleError):
    """The input is wrong: the message gives key, value, allowed range and cure. Nothing has been written."""


class SimulationError(HouleError):
    """The run failed at a step, time [s] and place [m]; `diagnosis`: what is known of the cause, and what to try."""

    def __init__(
        self,
        message: str,
        *,
        step: int = 0,
        time: float = 0.0,
        place: tuple[float, ...] | None = None,
        diagnosis: str = "",
    ) -> None:
        super().__init__(message)
        self.step, self.time, self.place, self.diagnosis = step, time, place, diagnosis
