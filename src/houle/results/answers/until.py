"""The entry "until" of run.json in words: how sure each answer is beside what time.until asks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any


def lines(rows: Iterable[Mapping[str, Any]]) -> list[tuple[str, str]]:
    """Rows of the summary from the entry "until" of run.json."""
    return [(row["name"], _told(row)) for row in rows]


def _told(row: Mapping[str, Any]) -> str:
    if row["key"] == "waves":
        return f"{row['half']:.0f} of {row['target']:.0f}"
    number = "{:.3f}" if row["key"] == "reflection" else "{:.1%}"
    asked = f"+-{number.format(row['target'])} asked"
    if row["half"] is None:
        return f"no interval yet, {asked}"
    had = f"+-{number.format(row['half'])}, {asked}"
    return had if row["met"] else f"{had}: some {row['more']:.0f} waves more would do"
