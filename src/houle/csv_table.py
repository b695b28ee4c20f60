"""Tables of numbers that come with a case: comment lines (#), a header of names, rows separated by commas."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from houle.errors import CaseError


def header(file: Path, key: str, error: type[CaseError] = CaseError) -> list[str]:
    """The names of the columns. Raises `error` when the file, named by `key` of the case file, cannot be read."""
    lines = _lines(file, key, error)
    return [name.strip() for name in lines[0].split(",")] if lines else []


def read_columns(
    file: Path, columns: tuple[str, ...], key: str, error: type[CaseError] = CaseError
) -> tuple[list[NDArray[np.float64]], NDArray[np.float64]]:
    """The columns (N,) of these names, in this order; and the whole table (N, columns of the file).

    `key` of the case file names the file. Raises `error` when it cannot be read, or is no such table.
    """
    lines = _lines(file, key, error)
    try:
        header = [name.strip() for name in lines[0].split(",")]
        rows = np.array([[float(word) for word in line.split(",")] for line in lines[1:]])
        return [rows[:, header.index(name)] for name in columns], rows
    except (ValueError, IndexError) as problem:
        wanted = f"the header {','.join(columns)}, numbers with a decimal point, commas between them"
        raise error(f"{key} = {file} is not a table with {wanted} ({problem})") from None


def _lines(file: Path, key: str, error: type[CaseError]) -> list[str]:
    """Those that are neither empty nor comments, from text as Windows writes it as well."""
    try:
        text = file.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise error(f"{key} = {file} is not text in UTF-8 (byte {problem.start}): save it as UTF-8 text") from None
    except (OSError, ValueError) as problem:
        raise error(f"{key} = {file} cannot be read: {getattr(problem, 'strerror', None) or problem}") from None
    return [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
