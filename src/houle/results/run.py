"""A run folder, as `houle run` leaves it and `houle.open_run` opens it."""

from __future__ import annotations

import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from houle.errors import CaseError

if TYPE_CHECKING:
    import xarray

    from houle.case.model import Case
    from houle.output.fields import FieldsReader

CASE_FILE = "case.toml"


class Run:
    """A run folder: `directory`, `case`, `summary`, `series` and `surface` (xarray), `fields`, `pictures` (paths)."""

    def __init__(self, directory: str | os.PathLike[str]) -> None:
        self.directory = Path(directory)

    @cached_property
    def case(self) -> Case:
        from houle.case.model import load

        return load(self.directory / CASE_FILE)

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """All of run.json, as a dict."""
        from houle.output import read_manifest

        return read_manifest(self.directory)

    @property
    def summary(self) -> dict[str, Any]:
        """Outcome of the run: finished, time, steps, seconds, volume drift, energy, score against the laboratory."""
        return {"finished": self.manifest["finished"], **self.manifest["summary"]}

    @cached_property
    def series(self) -> xarray.Dataset:
        """Gauges, sensors and ledger against time."""
        from houle.output import read_series

        return read_series(self.directory)

    @cached_property
    def surface(self) -> xarray.Dataset:
        """Profiles of the free surface: eta(time, x), in 3D eta(time, y, x) [m]."""
        from houle.output import read_surface

        return read_surface(self.directory)

    @cached_property
    def fields(self) -> FieldsReader:
        """The frames: .times [s], .frame(i) -> houle.flow.snapshot.Snapshot."""
        from houle.output import read_fields

        return read_fields(self.directory)

    @property
    def pictures(self) -> list[Path]:
        return sorted(self.directory.glob("*.png"))

    def __repr__(self) -> str:
        s = self.summary
        state = "finished" if s["finished"] else "not finished"
        return f"<houle run {self.directory}: {state}, t = {s['time']:g} s, {s['steps']} steps>"

    def _repr_html_(self) -> str:
        from houle.results.summary import as_html

        return as_html(self.summary, self.directory)


def open_run(directory: str | os.PathLike[str]) -> Run:
    """The run in this folder; CaseError if there is none."""
    folder = checked_path(directory, "directory")
    if not (folder / "run.json").exists():
        raise CaseError(f"{folder} holds no run (no run.json). Give the folder that houle run wrote to")
    run = Run(folder)
    run.manifest  # noqa: B018  (raises where it is none of ours)
    return run


def checked_path(path: Any, key: str) -> Path:
    """A path that the system can take. Raises CaseError that names the key."""
    if not isinstance(path, str | os.PathLike):
        raise CaseError(f"{key} = {path!r} is not a folder: give a path, as text or pathlib.Path")
    if not os.fspath(path):
        raise CaseError(f"{key} is empty: give a path, '.' for the present folder")
    try:
        found = Path(path)
        found.absolute().lstat()
    except FileNotFoundError:
        pass
    except (OSError, ValueError, TypeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        if not isinstance(error, NotADirectoryError):
            words = str(path) if len(str(path)) < 80 else f"{str(path)[:60]}... ({len(str(path))} letters)"
            raise CaseError(f"{key} = {words!r} cannot be used: {reason.lower()}. Give another folder") from None
    return found
