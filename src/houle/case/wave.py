"""From the table [waves] to the wave of theory, and to the record of elevations that it may name."""

from __future__ import annotations

from math import cos, radians
from pathlib import Path

from houle.case.tables.waves import Waves
from houle.data.history import History, read_history
from houle.waves import record, spectra, theories
from houle.waves.current import carried, moved
from houle.waves.dispersion import GRAVITY
from houle.waves.wave import THEORIES, Wave, WaveError

ARRIVES = 1.5  # half lengths before the maker at which the crest of a solitary wave without focus is at t = 0
LEAST = 4  # fewest samples in a record


def make(table: Waves, gravity: float = GRAVITY, folder: Path = Path()) -> Wave:
    """The wave of the table. Raises WaveError where no theory gives it. folder: that of its file.

    A regular wave has a crest at x = 0 at t = 0. A series is the elevation at the maker (`Waves.place`), and its time
    `start` is t = 0. The crest of a solitary wave comes to its focus, or else starts well before the maker. The waves
    that a source sends to the left only are those of -x.
    """
    angle = radians(table.direction)
    current = table.current * cos(angle)
    along = cos(angle) * (-1.0 if table.source is not None and table.source.side == "left" else 1.0)
    if table.kind == "series":
        known = read_record(table, folder)
        eta = known.values[0]
        return record.series(known.time, eta, table.depth, gravity, angle, place=along * table.place, current=current)
    height, period = float(table.height or 0), float(table.period or 0)
    if table.kind == "regular":
        return carried(
            lambda t: theories.regular(table.theory, height, t, table.depth, gravity, 0.0, angle),
            period,
            table.depth,
            gravity,
            current,
        )
    if table.kind == "solitary":
        single = THEORIES["solitary-5" if table.theory == "auto" else table.theory].make
        assert single is not None
        wave = moved(single(height, table.depth, gravity, 0.0, angle), current)
        crest = table.place - ARRIVES * wave.length / 2
        if table.focus is not None:
            crest = table.focus.x - wave.celerity * table.focus.time
        return moved(single(height, table.depth, gravity, crest, angle), current)
    if table.kind == "focused" and table.focus is not None:
        return spectra.focused(
            height,
            period,
            table.depth,
            gravity,
            along * table.focus.x,
            table.focus.time,
            angle,
            table.seed,
            table.gamma,
            current=current,
        )
    return spectra.irregular(
        table.kind, height, period, table.depth, gravity, angle, table.seed, table.gamma, current=current
    )


def read_record(table: Waves, folder: Path = Path()) -> History:
    """Times [s], 0 at `waves.start` of the file, and elevations [m] of its columns t_s, eta_m. Raises WaveError."""
    return read_history(folder / str(table.file), ("eta_m",), "waves.file", LEAST, table.start, WaveError)
