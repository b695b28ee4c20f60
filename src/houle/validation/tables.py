"""Tables of a comparison as files: one for programs, one for people."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from houle.output.atomic import write_text
from houle.validation.check import Check

HEAD = ("variant", "what", "measured", "unit", "target", "reached", "note")


def write(path: Path, title: str, rows: Iterable[tuple[str, Check]]) -> None:
    """Writes path.csv and path.md, one line per check, labelled with its variant."""
    lines = [
        (label, c.name, f"{c.value:.6g}", c.unit, c.target, "" if not c.target else "yes" if c.passed else "no", c.note)
        for label, c in rows
    ]
    save(path, title, HEAD, lines)


def save(path: Path, title: str, head: Sequence[str], lines: Sequence[Sequence[str]]) -> None:
    """Writes a table of words as path.csv and path.md."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([head, *lines])
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path.with_name(path.name + ".csv"), text.getvalue())
    rule = ["---"] * len(head)
    rows = ("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in [head, rule, *lines])
    write_text(path.with_name(path.name + ".md"), f"# {title}\n\n" + "\n".join(rows) + "\n")
