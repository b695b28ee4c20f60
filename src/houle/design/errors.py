"""DesignError: a formula was given what it cannot be about."""

from houle.errors import HouleError


class DesignError(HouleError):
    """An input of a formula is no number, of the wrong sign or in the wrong unit; the message says which, and the cure.

    An input that lies outside the range in which a formula was measured is no error: the answer names it in `outside`.
    """
