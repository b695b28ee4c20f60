"""Files that are whole or absent: written under a hidden temporary name beside the target, then renamed over it."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import shutil
from collections.abc import Callable, Iterator
from io import FileIO
from pathlib import Path
from typing import Any, Literal

import h5py

from houle.errors import HouleError

_CURES = {
    errno.ENOSPC: "free some space (houle resume goes on with a run that was stopped), or write elsewhere with --out",
    errno.EDQUOT: "the quota is used up: free some space, or write elsewhere with --out",
    errno.EFBIG: "the file system or a limit (ulimit -f) forbids a file this large: write elsewhere with --out",
    errno.EACCES: "make the folder writable, or write elsewhere with --out",
    errno.EPERM: "make the folder writable, or write elsewhere with --out",
    errno.EROFS: "the file system is read-only: write elsewhere with --out",
    errno.ENOTDIR: "a file stands where a folder is needed: write elsewhere with --out",
    errno.EEXIST: "a file stands where a folder is needed: write elsewhere with --out",
    errno.ENOENT: "the folder is not there: was it removed or renamed while houle was writing?",
    errno.EIO: "the disk reports an error: write elsewhere with --out",
}


LEFTOVER = re.compile(r"\.[\w.-]+\.(tmp|next|former)\.(nc|vtkhdf|h5|json|toml|png|mp4|html|csv)")


class OutputError(HouleError):
    """A result could not be written or read: the message gives the path, the reason and a cure."""

    def __init__(self, path: os.PathLike[str] | str, reason: str, cure: str = "", verb: str = "write") -> None:
        super().__init__(f"cannot {verb} {os.fspath(path)}: {reason}" + (f"\n  {cure}" if cure else ""))
        self.path = Path(path)


# Exceptions that h5py, h5netcdf and our own reading raise about a damaged file
DAMAGES = (OSError, LookupError, ValueError, TypeError, RuntimeError, AttributeError, ArithmeticError, MemoryError)


def told(error: BaseException) -> str:
    """An exception in one line: its class and its text."""
    words = " ".join(str(error).split())[:200]
    return f"{type(error).__name__}: {words}" if words else type(error).__name__


def regular(path: Path) -> Path:
    """The path itself. Raises OSError for a device or a pipe, which would be read for ever."""
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise OSError(f"{path.name} is a device or a pipe, no file")
    return path


def remove(path: Path) -> None:
    """Removes a file, if it is there."""
    with contextlib.suppress(FileNotFoundError):
        path.unlink()


def remove_leftovers(directory: Path) -> None:
    """Removes half-written files of runs that were killed. Only the process that has locked the folder may call it."""
    for folder in (directory, directory / ".fields"):
        for path in folder.glob(".*"):
            if LEFTOVER.fullmatch(path.name):
                with contextlib.suppress(OSError):
                    path.unlink()
    shutil.rmtree(directory / "failure.tmp", ignore_errors=True)


def put_aside(path: Path) -> None:
    """Renames a damaged file to NAME.damaged, if it is there at all."""
    with reported(path), contextlib.suppress(FileNotFoundError):
        os.replace(path, path.with_name(path.name + ".damaged"))


@contextlib.contextmanager
def reported(path: Path) -> Iterator[None]:
    """Turns errors of the file system, and of HDF5 when it writes, into OutputError about `path`."""
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
    """Yields a temporary path in the same folder and renames it to `path` at the end. After an error it is removed.

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


@contextlib.contextmanager
def new_hdf5(path: Path, *, durable: bool = False) -> Iterator[h5py.File]:
    """Yields an HDF5 file to be filled, which appears under its name whole or not at all."""
    with (
        replacing(path, durable=durable) as temporary,
        Sink(temporary) as sink,
        h5py.File(sink, "w") as file,
    ):
        yield file


class Sink:
    """A file for HDF5, which crashes when a write fails: this takes every write, and raises the first error at the end.

    The file is a new one, or with mode "r+b" the one that is there. Bytes written after an error are kept in memory:
    HDF5 may want to read them again before it is done.
    """

    def __init__(self, path: Path, mode: Literal["w+b", "r+b"] = "w+b") -> None:
        self.file: FileIO = open(path, mode, buffering=0)  # noqa: SIM115
        self.error: OSError | None = None
        self.kept: list[tuple[int, bytes]] = []  # places, and the bytes that could not be written there
        self.place, self.end = 0, os.fstat(self.file.fileno()).st_size

    def __enter__(self) -> Sink:
        return self

    def __exit__(self, *_: object) -> None:
        self.file.close()
        if self.error:
            raise self.error

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        self.place = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self.place, os.SEEK_END: self.end}[whence]
        return self.place

    def tell(self) -> int:
        return self.place

    def write(self, data: Any) -> int:
        view = memoryview(data).cast("B")
        size = len(view)
        self._try(self.file.seek, self.place)
        while len(view) and not self.error:
            view = view[self._try(self.file.write, view) or 0 :]
        if len(view):
            self.kept.append((self.place + size - len(view), bytes(view)))
        self.place += size
        self.end = max(self.end, self.place)
        return size

    def read(self, size: int = -1) -> bytes:
        buffer = bytearray(self.end - self.place if size < 0 else size)
        self.readinto(buffer)
        return bytes(buffer)

    def readinto(self, buffer: Any) -> int:
        view = memoryview(buffer).cast("B")
        self.file.seek(self.place)
        got = self.file.readinto(view) or 0
        view[got:] = bytes(len(view) - got)
        for place, data in self.kept:
            first, last = max(place, self.place), min(place + len(data), self.place + len(view))
            if first < last:
                view[first - self.place : last - self.place] = data[first - place : last - place]
        self.place += len(view)
        return len(view)

    def truncate(self, size: int) -> int:
        self._try(self.file.truncate, size)
        self.end = size
        return size

    def flush(self) -> None:
        pass

    def _try(self, action: Callable[..., Any], *arguments: Any) -> Any:
        if self.error is None:
            try:
                return action(*arguments)
            except OSError as error:
                self.error = error
        return None


def write_text(path: Path, text: str) -> None:
    """Writes a text file in UTF-8, whole or not at all."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _sync(path: Path) -> None:
    """Flushes a file, or a folder where the system allows it, to the disk."""
    if path.is_dir() and os.name == "nt":
        return  # Windows cannot open a folder
    descriptor = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
