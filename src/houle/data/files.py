"""Files that a case names: are they there, and can they be read?"""

from __future__ import annotations

from pathlib import Path

from houle.errors import CaseError


def exists(path: Path) -> bool:
    """True if something exists at a path; False also for a name that the system does not allow."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def require_file(file: Path, key: str, error: type[CaseError] = CaseError) -> None:
    """Raises `error` if a folder, a device or a pipe is at a path: a device or a pipe would be read for ever.

    A missing file is left to the reader, whose own message says so.
    """
    if exists(file) and not file.is_file():
        raise error(f"{key} = {file} cannot be read: it is a folder, a device or a pipe, no file")
