"""The lock of a run folder: one process at a time writes it. The system frees the lock when the process ends."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from houle.errors import CaseError
from houle.output.atomic import reported

NAME = ".lock"
TAKEN = (errno.EAGAIN, errno.EACCES, errno.EDEADLK)
BEYOND = 4096  # the byte that is locked, behind the number of the process, which others may read


@contextlib.contextmanager
def exclusive(directory: Path) -> Iterator[None]:
    """Keeps a folder for this process, and makes it if it is not there. Raises CaseError if another process writes it.

    File systems that know no locks are trusted.
    """
    path = directory / NAME
    with reported(path):
        directory.mkdir(parents=True, exist_ok=True)
        file = open(path, "a+b", buffering=0)  # noqa: SIM115
    with file:
        try:
            lock(file)
        except OSError as error:
            if error.errno in TAKEN:
                file.seek(0)
                text = f"{directory} is being written by another houle (process {file.read(20).decode() or '?'})"
                raise CaseError(f"{text}: wait for it, or take another folder (houle run CASE --out DIR)") from None
        with contextlib.suppress(OSError):
            file.truncate(0)
            file.write(str(os.getpid()).encode())
        _open.add(file)
        try:
            yield
        finally:
            _open.discard(file)
            with contextlib.suppress(OSError):
                path.unlink()


def _let_go() -> None:
    """Closes the files in the child of a fork: the lock stays the parent's."""
    for file in _open:
        file.close()


_open: set[BinaryIO] = set()  # lock files of the folders that this process writes
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_let_go)


def lock(file: BinaryIO) -> None:
    """Locks a file, without waiting. Raises OSError, with an errno of TAKEN if another process holds the lock."""
    if sys.platform == "win32":
        import msvcrt

        file.seek(BEYOND)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
