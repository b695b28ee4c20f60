"""Water at rest stays at rest: speed, level, pressure."""

from houle.validation.measure import rest_checks as compare

__all__ = ["compare"]
