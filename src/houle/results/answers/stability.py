"""Safety of a wall against sliding and tilting: the least factor in time, for a weight and a friction of its base.

The forces of the water are taken whole, at rest and moving, so that buoyancy and uplift are in them:

    sliding   friction (W - F_z)/|F_x|
    tilting   (W arm - M_rest)/(M - M_rest)

with W the weight in air, F_x and F_z the force of the water, M its moment about the heel, M_rest that at rest. Either
is 1 where the wall begins to move, and sliding is 0 where the water lifts the wall. It is the moving part of the
moment, uplift included, that is compared with what holds the wall in still water.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from houle.analysis.events import rest_level
from houle.errors import CaseError
from houle.grid import FloatArray
from houle.results.answers.table import WINDOW, Answer, not_answered

if TYPE_CHECKING:
    from houle.case.tables.observed import Force
    from houle.results.answers.given import Given
    from houle.results.answers.structure import Wall


def safety(given: Given, wall: Wall, table: Force) -> Iterator[Answer]:
    """The rows of the two factors. Raises AnalysisError; CaseError for a wall that floats or tips in still water."""
    assert table.weight is not None and given.sea is not None
    weight, late = table.weight / given.width, given.late(wall.front)
    time, up, along = given.time[late], wall.upward[late], wall.horizontal[late]
    if weight <= float(np.median(up)):
        raise CaseError(
            f"weight = {weight:g} N/m is less than the {np.median(up):.4g} N/m by which still water lifts the structure"
        )
    rest = rest_level(time, wall.moment[late], WINDOW * given.sea.mean)
    if not (held := weight * wall.arm - float(rest.max())) > 0.0:
        raise CaseError(
            f"the structure tips in still water: weight and water hold it with a moment of {held:.4g} N, above 0 is "
            f"needed; {wall.about}. Give another heel or weight"
        )
    warning = "" if wall.under else "no water is under the structure, so neither buoyancy nor uplift is counted"
    if table.friction is None:
        yield not_answered(f"safety {wall.name}, sliding", "friction is not given in [[force]]", "-")
    else:
        factor = _over(table.friction * np.maximum(weight - up, 0.0), np.abs(along))
        words = f"least of friction {table.friction:g} x (W - F_z)/|F_x|, W {weight:.4g} N/m in air"
        yield _least(f"safety {wall.name}, sliding", time, factor, words).noted(warning)
    factor = _over(weight * wall.arm - rest, wall.moment[late] - rest)
    words = f"least of (W arm - M_rest)/(M - M_rest), W {weight:.4g} N/m in air at an arm of {wall.arm:.4g} m"
    yield _least(f"safety {wall.name}, tilting", time, factor, words).noted(wall.about, warning)


def _over(holds: FloatArray, moves: FloatArray) -> FloatArray:
    """Ratio (T,), infinite where nothing moves the wall."""
    return np.divide(holds, moves, out=np.full_like(holds, np.inf), where=moves > 0.0)


def _least(name: str, time: FloatArray, factor: FloatArray, method: str) -> Answer:
    """The row of the least factor, with its time."""
    i = int(np.argmin(factor))
    if not np.isfinite(factor[i]):
        return not_answered(name, "no load of the waves moves it", "-")
    row = Answer(name, float(factor[i]), "-", method=method, note=f"at {time[i]:.4g} s", group="safety")
    return row.noted("it moves, which the run does not follow") if factor[i] < 1.0 else row
