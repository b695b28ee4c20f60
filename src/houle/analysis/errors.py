"""AnalysisError: the data cannot carry the answer."""

from houle.errors import HouleError


class AnalysisError(HouleError):
    """Signals, places or window cannot give the answer asked for; the message says why, and the cure."""


def positive(**numbers: float) -> None:
    """Raises AnalysisError for a number that is not above 0, by the name it is passed with: positive(depth=0.25)."""
    for name, number in numbers.items():
        if not number > 0:
            raise AnalysisError(f"{name} = {number:g} must be above 0, in SI units")
