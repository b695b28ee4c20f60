"""From tables of a case file to shapes: of water, porous bodies and solids."""

from __future__ import annotations

import numpy as np

from houle.case.tables import tank
from houle.errors import CaseError
from houle.medium.shapes import Box, Polygon, Shape, enclosed


def shape_of(entry: tank.Shape, dimension: int) -> Shape:
    """The shape of a case entry, from the first of box, polygon, below that it gives. Raises CaseError."""
    if (corners := entry.box) is not None:
        lower, upper = (tuple(map(float, corner)) for corner in corners)
        if not (len(lower) == len(upper) == dimension and all(a < b for a, b in zip(lower, upper, strict=True))):
            raise CaseError(
                f"box = [{list(lower)}, {list(upper)}] is not a box in {dimension}D: "
                f"give two corners of {dimension} numbers, the first one the lower on every axis."
            )
        return Box(lower, upper)
    if (outline := entry.polygon) is not None:
        try:
            return Polygon(enclosed(outline), dimension)
        except ValueError as error:
            raise CaseError(f"polygon = {list(outline)} is not a simple polygon: it {error}") from None
    if (level := entry.below) is not None:
        return Box((-np.inf,) * dimension, (*[np.inf] * (dimension - 1), float(level)))
    raise CaseError("a shape needs one of: box = [[lower], [upper]], polygon = [[x, z], ...], below = level.")
