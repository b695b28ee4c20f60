"""The errors that users see: the input was wrong (exit status 2), or the run failed (exit status 3)."""

from __future__ import annotations


class HouleError(Exception):
    """Base of the errors whose message is meant for the user. Any other exception that escapes is a bug of houle."""


class CaseError(HouleError):
    """The input is wrong. The message gives key, value, allowed range and cure. Nothing has been written."""


class SimulationError(HouleError):
    """The run failed.

    step, time [s], place [m]  when and where, as far as known
    diagnosis                  the likely cause, and what to try
    """

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
    """A hint for the end of a message: a position far outside a tank of this size [m] may be in cm or mm. Else ""."""
    units = ((0.01, "cm"), (0.001, "mm"))
    return next((f" Were {u} given? Lengths are in m." for f, u in units if 10 * size < value <= size / f), "")
