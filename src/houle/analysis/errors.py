"""What an analysis says when the data cannot carry the answer."""

from houle.errors import HouleError


class AnalysisError(HouleError):
    """The signals, the places or the window do not determine what was asked for; the message says which and the
    cure.
    """
