"""Answers of [[bank]]: safety against sliding, exit gradient, excess pore pressure, Shields number at their worst."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from math import isfinite
from typing import Any

from houle.errors import CaseError
from houle.results.answers.given import Given, Question, worst
from houle.results.answers.table import Answer, Beside, not_answered

GRAINS = "Soulsby & Whitehouse (1997) on the slope: moves the grains"
LIFTS = "(s - 1) (1 - n) cos(beta): lifts the grains"
STILL = "tan(phi) / tan(beta): still water"
WORST = "worst of all places and times"


def questions(given: Given, runs: Sequence[Sequence[Mapping[str, Any]]]) -> Iterator[Question]:
    """Two questions for each bank, from its entry in run.json of each run (`houle.results.bank`)."""
    for entries in zip(*runs, strict=True):
        name = f"bank {entries[0]['bank']}"
        yield name, partial(worst, given, [partial(_sliding, entry) for entry in entries], lowest=True)
        if any("problem" not in entry for entry in entries):
            yield name, partial(worst, given, [partial(_rows, entry) for entry in entries])


def _sliding(entry: Mapping[str, Any]) -> Iterator[Answer]:
    """The row of the factor of safety. Raises CaseError where nothing could be said of the bank."""
    if "problem" in entry:
        raise CaseError(entry["problem"])
    name, sliding = f"bank {entry['bank']}, factor of safety", f"{WORST}, infinite slope"
    row = _row(name, entry["safety"], "-", sliding, "safety", STILL, entry["still"])
    yield row.noted(f"below 1 for {entry['unstable']:.3g} s")


def _rows(entry: Mapping[str, Any]) -> Iterator[Answer]:
    """The other rows of a bank, of which the largest is the worst; none where nothing could be said of it."""
    if "problem" in entry:
        return
    name = f"bank {entry['bank']}"
    row = _row(f"{name}, exit gradient", entry["gradient"], "-", WORST, "gradient", LIFTS, entry["critical"])
    yield row.noted(f"above that for {entry['lifting']:.3g} s")
    method = f"{WORST}, above water at rest with the level outside"
    yield _row(f"{name}, excess pore pressure", entry["excess"], "Pa", method, "pore pressure")
    if entry["shields"] is not None:
        row = _row(f"{name}, Shields number", entry["shields"], "-", WORST, "Shields", GRAINS, entry["mobile"])
        flow = f"{entry['shields_in_section']:.3g} without the current along the bank" if entry["current"] else ""
        yield row.noted(f"above that for {entry['moving']:.3g} s", flow)


def _row(
    name: str, worst: Mapping[str, Any], unit: str, method: str, group: str, limit: str = "", value: float | None = None
) -> Answer:
    """The row of a number at its worst, and the limit that it is held against.

    A face that is level does not slide, and through a dry plane nothing flows: then the number is not finite.
    """
    if worst["value"] is None or not isfinite(worst["value"]):
        return not_answered(name, "the face is level, or the plane inside it stayed dry", unit)
    beside = (Beside(limit, value),) if value is not None else ()
    note = f"at x = {worst['x']:.4g} m, {worst['time']:.4g} s"
    return Answer(name, float(worst["value"]), unit, method=method, formulas=beside, note=note, group=group)
