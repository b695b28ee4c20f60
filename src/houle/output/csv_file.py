"""Tables of words and numbers as CSV, written whole or not at all."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from houle.output.atomic import write_text


def write_csv(path: Path, columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> Path:
    """Writes rows under the names of their columns: RFC 4180, UTF-8, numbers in full, nothing where a value is None."""
    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=list(columns), lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: _cell(row.get(name)) for name in columns} for row in rows)
    write_text(path, text.getvalue())
    return path


def _cell(value: Any) -> str:
    """A value as text that gives the same number again."""
    if value is None:
        return ""
    return repr(float(value)) if isinstance(value, float) else str(value)
