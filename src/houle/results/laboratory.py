"""The distance of a run from the laboratory points of its case."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from houle.data import laboratory
from houle.output import surface_table
from houle.results.run import Run


def record(run: Run) -> dict[str, Any]:
    """The entry "reference" of run.json, in plain numbers; {} if there are no points to compare with."""
    file, given = run.case.laboratory, run.case.reference
    if file is None or given is None:
        return {}
    score = laboratory.score(laboratory.read(file), surface_table(run.directory))
    return {} if score is None else {"reference": {"label": given.label, "error": given.error, **asdict(score)}}
