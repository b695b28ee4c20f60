"""The intervals of answers beside what time.until asks of them, and the number of waves that is lacking."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from math import ceil, inf, isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any

from houle.output import series_table
from houle.output.netcdf import TIME
from houle.results.answers.sea import first_place, sea_of
from houle.results.answers.table import Answer, not_answered

if TYPE_CHECKING:
    from houle.case.model import Case

NAMES = {  # beginnings and ends of the names of answers
    "q": ("overtopping", ", mean discharge"),
    "run_up": ("run-up", ", R_2%"),
    "reflection": ("reflection", ", C_R (reflected)"),
}

ROUND = 1e-6  # waves: less is rounding


@dataclass(frozen=True)
class Asked:
    """Half of the interval of an answer beside the most that is asked for, or a number of waves beside the least.

    half  share of the answer, of C_R the number itself; NaN as long as the answer has no interval
    more  waves that are still to come, as intervals shrink with the root of the number of waves; NaN if it is not known
    """

    key: str
    name: str
    half: float
    target: float
    met: bool
    more: float


def asked(case: Case, rows: Iterable[Answer], waves: float) -> list[Asked]:
    """All that time.until asks for, of the rows of answers of a run in which so many waves came; [] without it."""
    return [] if case.time.until is None else list(_asked(case, list(rows), waves))


def _asked(case: Case, rows: list[Answer], waves: float) -> Iterator[Asked]:
    until = case.time.until
    assert until is not None
    for key, (begin, end) in NAMES.items():
        if (target := getattr(until, key)) is not None:
            questions = {row.name.split(", ")[0] for row in rows if row.name.startswith(begin)} or {begin}
            found = {row.name: row for row in rows}
            for name in (question + end for question in sorted(questions)):
                row = found.get(name, not_answered(name, "nothing yet"))
                yield _width(key, row, target, waves)
    if until.waves is not None:
        lacking = max(0.0, until.waves - waves)
        yield Asked("waves", "waves", waves, float(until.waves), lacking == 0.0, ceil(lacking))


def _width(key: str, row: Answer, target: float, waves: float) -> Asked:
    """Half of the interval of a row: a share of its value, or for C_R the number itself."""
    half = (row.high - row.low) / 2
    if key != "reflection":
        half = half / row.value if row.value > 0 else nan
    met = half <= target
    more = 0.0 if met else nan if not isfinite(half) else ceil(waves * ((half / target) ** 2 - 1) - ROUND)
    return Asked(key, row.name, half, target, met, more)


def waves_of(case: Case, directory: Path) -> float:
    """Number of waves that have come to the first place that the case asks about, by the series in the folder."""
    sea = sea_of(case)
    if sea is None:
        return 0.0
    end = float(series_table(directory)[TIME].values[-1])
    return max(0.0, (end - sea.start(first_place(case, sea))) / sea.mean)


def entry(found: list[Asked]) -> dict[str, Any]:
    """The entry "until" of run.json; {} where the case asks for nothing."""
    rows = [
        {k: None if isinstance(v, float) and not abs(v) < inf else v for k, v in asdict(one).items()} for one in found
    ]
    return {"until": rows} if rows else {}
