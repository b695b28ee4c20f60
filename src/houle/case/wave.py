"""From the table [waves] to the wave of theory, and to the record of elevations that it may name."""

from __future__ import annotations

from math import cos, radians
from pathlib import Path

from houle.case.ship import passage_of
from houle.case.tables.ship import Ship
from houle.case.tables.waves import Waves
from houle.data.csv_table import columns_in
from houle.data.files import require_file
from houle.data.history import History, read_history
from houle.waves import record, spectra, theories
from houle.waves.current import carried, moved
from houle.waves.dispersion import GRAVITY
from houle.waves.paddle import PaddleWave, RecordedMotion, elevation, require_moves
from houle.waves.ship import ShipWave
from houle.waves.ship import record as incident_record
from houle.waves.wave import THEORIES, Wave, WaveError

ARRIVES = 1.5  # half lengths before the maker at which the crest of a solitary wave without focus is at t = 0
LEAST = 4  # fewest samples in a record
MOTIONS = {"displacement": "displacement_m", "velocity": "velocity_m_s"}  # columns of waves.file of a paddle


def make(table: Waves, gravity: float = GRAVITY, folder: Path = Path(), ship: Ship | None = None) -> Wave:
    """The wave of the table. Raises WaveError where no theory gives it. folder: that of its file; ship: [ship].

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
    if table.kind == "paddle":
        quantity, known = read_motion(table, folder)
        rests = known.resting(True, rest_of(quantity))
        motion = RecordedMotion.of(known.time, known.values[0], quantity, rests, table.ramp_time())
        require_moves(motion, table.depth, gravity)
        time, eta = elevation(motion, table.depth, gravity)
        return PaddleWave.sent_by(motion, record.series(time, eta, table.depth, gravity, place=table.place))
    if table.kind == "ship":
        if ship is None:
            raise WaveError('waves.kind = "ship" needs the table [ship]')
        passage = passage_of(ship, table.depth, gravity, table.place)
        time, eta = incident_record(passage, ship.toe - table.place, table.depth, gravity)
        return ShipWave.of_passage(passage, record.series(time, eta, table.depth, gravity, place=ship.toe))
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


def read_motion(table: Waves, folder: Path = Path()) -> tuple[str, History]:
    """The quantity in the file of a paddle, "displacement" or "velocity", and its samples [m] or [m/s] at times [s].

    Time 0 is `waves.start` of the file. Raises WaveError.
    """
    file, key = folder / str(table.file), "waves.file"
    require_file(file, key, WaveError)
    there = columns_in(file, tuple(MOTIONS.values()), key, WaveError)
    if len(there) != 1:
        held = "both are there: keep one of them" if there else "neither is there"
        raise WaveError(f"{key} = {file} needs a column t_s and one of {' or '.join(MOTIONS.values())}; {held}")
    quantity = next(name for name, column in MOTIONS.items() if column == there[0])
    return quantity, read_history(file, (there[0],), key, LEAST, table.start, WaveError)


def rest_of(quantity: str) -> float | None:
    """The value of what a file of a paddle holds at which the wall is at rest; None: any that stays."""
    return 0.0 if quantity == "velocity" else None
