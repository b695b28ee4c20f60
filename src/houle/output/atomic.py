"""Files that are whole or absent: written under a hidden temporary name beside the target, then renamed over it."""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Iterator
from pathlib import Path

from houle.errors import HouleError

_CURES = {
    errno.ENOSPC: "free some space, or write elsewhere with --out",
    errno.EDQUOT: "the quota is used up: free some space, or write elsewhere with --out",
    errno.EFBIG: "the file system or a limit (ulimit -f) forbids a file this large: write elsewhere with --out",
    errno.EACCES: "make the folder writable, or write elsewhere with --out",
    errno.EPERM: "make the folder writable, or write elsewhere with --out",
    errno.EROFS: "the file system is read-only: write elsewhere with --out",
    errno.ENOTDIR: "a file stands where a folder is needed: write elsewhere with --out",
    errno.EEXIST: "a file stands where a folder is needed: write elsewhere with --out",
    errno.EIO: "the disk reports an error: write elsewhere with --out",
}


class OutputError(HouleError):
    """A result could not be written or read: the message gives the path, the reason and a cure."""

    def __init__(self, path: os.PathLike[str] | str, reason: str, cure: str = "", verb: str = "write") -> None:
        super().__init__(f"cannot {verb} {os.fspath(path)}: {reason}" + (f"\n  {cure}" if cure else ""))
        self.path = Path(path)


@contextlib.contextmanager
def reported(path: Path) -> Iterator[None]:
    """Turn what the file system and HDF5 raise into OutputError about `path`."""
    try:
        yield
    except OutputError:
        raise
    except (OSError, RuntimeError) as error:
        code = _errno(error)
        if code is None and not isinstance(error, OSError):
            raise  # not about files: HDF5 reports a failed write as RuntimeError with the errno in its text
        reason = os.strerror(code).lower() if code else str(error)
        raise OutputError(path, reason, _CURES.get(code or 0, "write elsewhere with --out")) from error


def _errno(error: BaseException) -> int | None:
    """The errno, also when HDF5 hides it in its message ("..., errno = 28, error message = ...")."""
    code = getattr(error, "errno", None)
    if code is None and "errno = " in str(error):
        digits = str(error).split("errno = ")[1].split(",")[0]
        code = int(digits) if digits.isdigit() else None
    return code


@contextlib.contextmanager
def replacing(path: Path, *, durable: bool = False) -> Iterator[Path]:
    """Yield a temporary path in the same folder; on leaving, rename it to `path`. On any error nothing of it stays.

    durable: the bytes are on the disk before the rename (against power cuts; a killed process needs no such care).
    """
    temporary = path.with_name(f".{path.stem}.tmp{path.suffix}")
    with reported(path):
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            yield temporary
            if durable:
                _sync(temporary)
            os.replace(temporary, path)
            if durable:
                _sync(path.parent)
        except BaseException:
            with contextlib.suppress(OSError):
                temporary.unlink()
            raise


def write_text(path: Path, text: str) -> None:
    """The whole text, in UTF-8, or nothing."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _sync(path: Path) -> None:
    """Flush a file, or a folder where the system allows it, to the disk."""
    if path.is_dir() and os.name == "nt":
        return  # Windows cannot open a folder
    descriptor = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
