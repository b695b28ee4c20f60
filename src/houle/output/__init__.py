"""The files of a run: series, surface, fields, checkpoints, manifest, pictures. kill -9 leaves all of them readable.

For the runner (every failure of the file system is an OutputError: one message with path and cure):

    out = Outputs(directory, grid, stations, about(case.identity))   writes nothing yet; stations of the observers
    out.truncate_after(time, row)          to resume: goes on with the files there and drops all after those times;
                                           returns in words what is missing before
    out.append_series(time, sample)        Simulation.sample(): eta, pressure, velocity and ledger scalars
    out.append_frame(frame)                a profile of surface.nc and a frame of fields.vtkhdf
    out.commit()                           everything appended so far is in the files; call it before each checkpoint
    out.commit_if_due(seconds)             the same, at most once in so many seconds of wall time; call it every step
    out.close()                            commit, and pack each of the three into the file that stays

    save_checkpoint(directory, step, state, meta)   state: arrays and scalars by name; meta: values for JSON
    load_newest(directory)                          Checkpoint or None: .path .step .state .meta; skips a damaged file
    checkpoints(directory)                          their paths, newest first

    collect(case.identity, threads)                 the manifest at the start of a run
    summarise(manifest, finished=, time=, ...)      with the outcome, at the end
    write_manifest(directory, manifest)             run.json; read_manifest(directory)

    read_series(directory), read_surface(directory) xarray.Dataset, in memory; the files are closed
    series_table(directory), surface_table(directory)   the same as Table, without the import of xarray
    read_fields(directory)                          FieldsReader: .times, .nearest(time), .frame(i)

Pictures and films import matplotlib, so import them late:

    houle.output.pictures.write_pictures(directory, case, grid, series, surface, fields)
    houle.output.movie.write_movie(path, case, fields, rate=25)

A new writer: copy surface.py, add it to Outputs.
"""

from __future__ import annotations

import time as clock
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from houle.fields import Stations
from houle.flow.snapshot import Snapshot
from houle.grid import Grid
from houle.output.atomic import OutputError
from houle.output.checkpoint import Checkpoint, checkpoints, load_newest, save_checkpoint
from houle.output.fields import FieldsReader, FieldsWriter, read_fields
from houle.output.manifest import about, collect, read_manifest, summarise, write_manifest
from houle.output.netcdf import Table
from houle.output.series import SeriesWriter, read_series, series_table
from houle.output.surface import SurfaceWriter, read_surface, surface_table

__all__ = [
    "Checkpoint",
    "FieldsReader",
    "FieldsWriter",
    "OutputError",
    "Outputs",
    "SeriesWriter",
    "SurfaceWriter",
    "Table",
    "about",
    "checkpoints",
    "collect",
    "load_newest",
    "read_fields",
    "read_manifest",
    "read_series",
    "read_surface",
    "save_checkpoint",
    "series_table",
    "summarise",
    "surface_table",
    "write_manifest",
]


class Outputs:
    """The files of a run that grow: series.nc, surface.nc, fields.vtkhdf."""

    def __init__(
        self, directory: Path | str, grid: Grid, stations: Sequence[Stations], attributes: Mapping[str, str]
    ) -> None:
        """stations: where the values of each observer stand; attributes: global ones of all files (`about`)."""
        folder = Path(directory)
        self.series = SeriesWriter(folder, grid.dimension, stations, attributes)
        self.surface = SurfaceWriter(folder, grid, attributes)
        self.fields = FieldsWriter(folder, grid, attributes)
        self._committed = clock.monotonic()

    def append_series(self, time: float, sample: Mapping[str, Any]) -> None:
        """Adds one row of gauges, sensors and ledger at a simulated time [s]."""
        self.series.append(time, sample)

    def append_frame(self, frame: Snapshot) -> None:
        """Adds one profile of the surface and one frame of the fields."""
        self.surface.append(frame)
        self.fields.append(frame)

    def commit(self) -> None:
        """Brings everything appended into the files, which others can read then. Call it before a checkpoint."""
        for writer in (self.series, self.surface, self.fields):
            writer.commit()
        self._committed = clock.monotonic()

    def commit_if_due(self, seconds: float) -> None:
        """Commits, at most once in so many seconds of wall time."""
        if clock.monotonic() - self._committed > seconds:
            self.commit()

    def close(self) -> None:
        """Commits, and packs each file as it stays, at the end of a stretch of a run, however it ends."""
        for writer in (self.series, self.surface, self.fields):
            writer.close()

    def truncate_after(
        self,
        time: float,
        row: float,
        frames: Sequence[float] = (),
        sample: Mapping[str, Any] | None = None,
        hashes: Collection[str] = (),
    ) -> list[str]:
        """Resume at a checkpoint of this simulated time [s], whose last row of the series was at `row` [s].

        All that is later is dropped: the run writes it again. Returns in words what should be there and is lost.

        frames  times [s] of the frames that were written     sample  a row of the series as it will be appended
        hashes  of the cases whose files they may be
        """
        last = frames[-1] if frames else time
        return [
            *self.series.truncate_after(row, sample, hashes),
            *self.surface.truncate_after(last, self.surface.blank, hashes),
            *self.fields.truncate_after(time, frames, hashes),
        ]
