"""The two ways a run can end badly: the input was wrong (exit status 2), or the run failed (exit status 3); hints."""

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


def metres(value: float, size: float) -> str:
    """A guess at the unit in which a position was given that lies far outside a tank of this size [m], or nothing."""
    units = ((0.01, "cm"), (0.001, "mm"))
    return next((f" Were {u} given? Lengths are in m." for f, u in units if 10 * size < value <= size / f), "")
