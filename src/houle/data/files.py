"""Files that a case names: whether they are there, and can be read."""

from __future__ import annotations

from pathlib import Path

from houle.errors import CaseError


def exists(path: Path) -> bool:
    """Whether something is there; False for a name that the system does not take."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def require_file(file: Path, key: str, error: type[CaseError] = CaseError) -> None:
    """Raises `error` where something else than a file is: a device or a pipe would be read for ever."""
    if exists(file) and not file.is_file():
        raise error(f"{key} = {file} cannot be read: it is a folder, a device or a pipe, no file")
