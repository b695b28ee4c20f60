"""Answers of [reflection]: the coefficients, from its entry in run.json."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isfinite, nan, sqrt
from typing import Any

import numpy as np

from houle.errors import CaseError
from houle.results.answers import formulas
from houle.results.answers.given import Given, Question, with_formulas
from houle.results.answers.outline import OutlineError, emerged, outline_of
from houle.results.answers.structure import Outline, Sea
from houle.results.answers.table import CONFIDENCE, Answer, Beside

LINEAR = "linear theory"
WORDS = {"C_R": "reflected", "C_T": "transmitted", "C_D": "dissipated energy"}


def pooled(entries: Sequence[Mapping[str, Any]], seeds: Sequence[str]) -> dict[str, Any]:
    """One entry of several runs in seas of one kind, of which each has the same weight; {} where none has one.

    C_R and C_T are those of all waves, roots of mean energies; of independent runs the halves of the intervals add up
    as squares. A run without an answer leaves its reason.
    """
    if len(entries) == 1 or not all(entries):
        return dict(entries[0])
    for entry, seed in zip(entries, seeds, strict=True):
        if "problem" in entry:
            return {"problem": f"{seed}: {entry['problem']}"}
    found, count = dict(entries[0]), len(entries)
    incident = np.array([entry["H_I"] for entry in entries], dtype=float)
    for key, height in (("C_R", "H_R"), ("C_T", "H_T")):
        values = np.array([entry[key] for entry in entries], dtype=float)  # None is NaN
        found[key] = float(np.sqrt(np.mean((values * incident) ** 2) / np.mean(incident**2)))
        heights = np.array([entry[height] for entry in entries], dtype=float)
        found[height] = float(np.sqrt(np.mean(heights**2)))
    found["H_I"] = float(np.sqrt(np.mean(incident**2)))
    found["C_D"] = float(np.mean(np.array([entry["C_D"] for entry in entries], dtype=float)))
    for key in ("C_R", "C_T", "C_D"):
        ends = np.array([entry[f"interval_{key[-1]}"] for entry in entries], dtype=float)
        values = np.array([entry[key] for entry in entries], dtype=float)
        low, high = np.sqrt(((values[:, None] - ends) ** 2).sum(axis=0)) / count
        found[f"interval_{key[-1]}"] = [found[key] - low, found[key] + high]
    found["covers"] = f"{found['covers']}; {count} seeds, halves of their intervals added up as squares"
    found["notes"] = list(dict.fromkeys(note for entry in entries for note in entry["notes"]))
    return found


def questions(given: Given, entry: Mapping[str, Any]) -> Iterator[Question]:
    """One question, if the case has [reflection]; `entry` is what was measured."""
    if given.case.reflection is not None and entry:
        yield "reflection", lambda: _rows(given, entry)


def _rows(given: Given, entry: Mapping[str, Any]) -> Iterator[Answer]:
    """The rows of the coefficients. Raises CaseError where none was measured."""
    if "problem" in entry:
        raise CaseError(entry["problem"])
    sure = entry["confidence"] == CONFIDENCE
    window = entry["window"]
    method = f"{entry['method']}, {window['start']:.4g} to {window['end']:.4g} s; interval: {entry['covers']}"
    for key, word in WORDS.items():
        value = entry[key]
        if value is None or not isfinite(value):
            continue
        low, high = entry[f"interval_{key[-1]}"] if sure else (nan, nan)
        row = Answer(f"reflection, {key} ({word})", value, "-", low, high, method, group="coefficient")
        yield _beside(given, row, entry) if key == "C_R" else row


def _beside(given: Given, row: Answer, entry: Mapping[str, Any]) -> Answer:
    """The row of C_R with linear theory beside it where there is one, and the formula of Zanuttigh & Van der Meer."""
    theory, sea = entry.get("theory"), given.sea
    linear: tuple[Beside, ...] = ()
    if theory:
        spread = theory.get("error", nan)
        linear = (Beside(LINEAR, theory["C_R"], max(theory["C_R"] - spread, 0.0), theory["C_R"] + spread),)
    if sea is None:
        return replace(row, formulas=linear)
    found = with_formulas(row, _same_energy(sea), lambda: [formulas.reflection(_same_energy(sea), _front(given, sea))])
    if sea.regular and found.formulas:
        found = found.noted("the formula is that of a sea of the same energy, H_m0 = sqrt(2) H")
    return replace(found, formulas=(*linear, *found.formulas))


def _same_energy(sea: Sea) -> Sea:
    """The sea of the energy of regular waves, for which there is a formula; another sea as it is."""
    if not sea.regular:
        return sea
    return replace(sea, height=sqrt(2.0) * sea.height, regular=False, lack="")


def _front(given: Given, sea: Sea) -> Outline:
    """The section of the structure in [reflection]. Raises OutlineError: a slope is asked for."""
    assert given.case.reflection is not None
    structure = given.case.reflection.structure
    end = structure[1] if len(structure) == 2 else _behind(given, structure[0])
    x = emerged(given.case, sea, structure[0], end)
    if x is None:
        raise OutlineError("nothing of it stands above still water")
    found = outline_of(given.case, sea, x)
    if found.kind == "wall":
        raise OutlineError("its front is an upright wall, the formula is for slopes")
    return found


def _behind(given: Given, x: float) -> float:
    """The end of the tank behind a structure at x [m]."""
    assert given.sea is not None
    return given.case.domain.size[0] if x > given.sea.maker else 0.0
