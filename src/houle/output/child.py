"""Reading of files that may be damaged, in a child process: on such a file HDF5 may hang, or crash the process."""

from __future__ import annotations

import os
import signal
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

NO_END = "is damaged (HDF5 does not come through it)"
SPEED = 2e7  # bytes that are read in a second of CPU, at least: a child that takes longer hangs


def in_child(look: Callable[[], str], path: Path) -> str | None:
    """The answer of `look` about the file, run in a child process; None if it hangs or crashes there.

    The child is made by a fork. Where the system has none, `look` runs in this process, and HDF5 is trusted.
    """
    if sys.platform != "linux":
        return look()
    reading, writing = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # about forks beside threads: the child calls HDF5 alone
        child = os.fork()
    if child == 0:
        os.close(reading)
        _answer(look, path, writing)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        said = pipe.read()
    _, status = os.waitpid(child, 0)
    return said.decode("utf-8", "replace") if status == 0 else None


def _answer(look: Callable[[], str], path: Path, writing: int) -> None:
    """Runs `look` in the child, writes its answer to the pipe, and ends the child."""
    import resource

    status = 1
    try:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU, signal.SIGSEGV, signal.SIGABRT):
            signal.signal(number, signal.SIG_DFL)
        seconds = 1 + int(path.stat().st_size / SPEED)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with os.fdopen(writing, "wb") as pipe:
            pipe.write(look().encode("utf-8", "replace"))
        status = 0
    finally:
        os._exit(status)
