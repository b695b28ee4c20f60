"""Stability of the banks of a run, from the series of its [[bank]] tables: does seepage, or the flow, move the grains?

Of each bank: excess pore pressure, exit gradient, factor of safety against sliding (`houle.analysis.slope`) and Shields
number (`houle.analysis.erosion`), the worst of all its places and times. With a ship, the return current that it drives
along the bank, normal to the section, rubs over the grains too.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from houle.analysis import AnalysisError, Layer, along_layer, critical_gradient, excess_pore_pressure, shields
from houle.case.build import site_of
from houle.observe.bank import Bank
from houle.observe.faces import Face
from houle.output import series_table
from houle.output.netcdf import TIME, Variable
from houle.waves.ship import ShipWave

if TYPE_CHECKING:
    from houle.case.model import Case
    from houle.results.run import Run

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Seen:
    """A bank as it was seen.

    time  (T,) [s]    face, inside  pressures on the face and on the plane inside (N, T) [Pa]
    speed             along the face (N, T) [m/s]
    """

    time: Real
    face: Real
    inside: Real
    speed: Real


@dataclass(frozen=True)
class Worst:
    """A number at its worst: value, place on the face x [m], time [s]."""

    value: float
    x: float
    time: float

    @classmethod
    def of(cls, values: Real, x: Real, time: Real, lowest: bool = False) -> Worst:
        """The largest, or lowest, of values (N, T)."""
        i, j = np.unravel_index(int(values.argmin() if lowest else values.argmax()), values.shape)
        return cls(float(values[i, j]), float(x[i]), float(time[j]))


@dataclass(frozen=True)
class Stability:
    """The answers about one bank.

    safety     lowest factor of safety against sliding; `still` is that in still water, `unstable` the time below 1 [s]
    gradient   largest exit gradient; `critical` lifts the grains, `lifting` is the time above it [s]
    excess     largest pore pressure above that of water at rest with the level outside [Pa]
    shields    largest Shields number; `mobile` moves the grains; `moving`: longest time above it at one place [s]; None
               of a body without grains
    current    largest current along the bank, from a ship, that is part of it [m/s]
    shields_in_section   largest Shields number without this current
    """

    bank: str
    safety: Worst
    still: float
    unstable: float
    gradient: Worst
    critical: float
    lifting: float
    excess: Worst
    shields: Worst | None
    mobile: float
    moving: float
    current: float
    shields_in_section: float


def record(run: Run) -> dict[str, Any]:
    """The entry "bank" of run.json, a list in the order of the tables; {} without any, or without a second row.

    A bank that no answer can be given about has the entry "problem".
    """
    series = series_table(run.directory)
    if "bank_speed" not in series or series.sizes["time"] < 2:
        return {}
    names = np.asarray(series["bank"].values)
    time = np.asarray(series["time"].values, dtype=float)
    face, inside, speed = (
        _along_time(series[name]) for name in ("bank_pressure_face", "bank_pressure_inside", "bank_speed")
    )
    found = []
    for table in run.case.bank:
        mine = names == table.name
        try:
            answers = stability(run.case, table.name, Seen(time, face[mine], inside[mine], speed[mine]))
            found.append(asdict(answers))
        except AnalysisError as error:
            found.append({"bank": table.name, "problem": str(error)})
    return {"bank": found}


def _along_time(variable: Variable) -> Real:
    """The values of each place against time, (N, T)."""
    return np.moveaxis(np.asarray(variable.values, dtype=float), variable.dims.index(TIME), -1)


def stability(case: Case, name: str, seen: Seen) -> Stability:
    """The answers about the bank of this name in a case, from what it saw."""
    table = next(row for row in case.bank if row.name == name)
    bank = Bank(**{key: getattr(table, key) for key in type(table).model_fields})
    face = bank.face(site_of(case))
    x, time, dt, layer = face.points[:, 0], seen.time, np.gradient(seen.time), _layer(case, bank, face)
    safety = layer.safety(seen.face, seen.inside, along_layer(_down(face), seen.face.T, seen.inside.T).T)
    outwards = _exit_gradient(layer, seen)
    critical = critical_gradient(layer.porosity, bank.grain_density / layer.density) * np.cos(face.slope)
    number, in_section, mobile = _shields(case, bank, seen, face)
    return Stability(
        bank=name,
        safety=Worst.of(safety, x, time, lowest=True),
        still=float(np.min(layer.still)),
        unstable=float(((safety < 1.0) @ dt).max()),
        gradient=Worst.of(outwards, x, time),
        critical=float(critical.min()),
        lifting=float(((outwards > critical[:, None]) @ dt).max()),
        excess=Worst.of(_excess(layer, face, seen), x, time),
        shields=Worst.of(number, x, time) if np.isfinite(number).all() else None,
        mobile=float(mobile.min()),
        moving=float(((number > mobile) @ dt).max()),
        current=float(_along_the_bank(case, time).max()),
        shields_in_section=float(in_section.max()),
    )


def _layer(case: Case, bank: Bank, face: Face) -> Layer:
    """The layer of a bank that might slide."""
    body = next(row for row in case.porous if row.name == bank.body)
    return Layer(
        thickness=bank.depth,
        slope=face.slope[:, None],
        porosity=body.porosity,
        friction_angle=float(np.radians(bank.friction_angle)),
        grain_density=bank.grain_density,
        density=case.fluid.density,
        gravity=case.fluid.gravity,
    )


def _exit_gradient(layer: Layer, seen: Seen) -> Real:
    """Gradient of the head from the plane out to the face (N, T) [-], minus infinity where the plane is dry."""
    head = (seen.inside - seen.face) / (layer.density * layer.gravity) - layer.thickness * np.cos(layer.slope)
    return np.where(seen.inside > 0.0, head / layer.thickness, -np.inf)


def _excess(layer: Layer, face: Face, seen: Seen) -> Real:
    """Pore pressure above that of water at rest with the level outside (N, T) [Pa]; that is the lowest place's head."""
    height, lowest = face.points[:, -1:], int(face.points[:, -1].argmin())
    level = seen.face[lowest] / (layer.density * layer.gravity) + height[lowest]
    below = height - layer.thickness * np.cos(layer.slope)
    return excess_pore_pressure(seen.inside, level, below, density=layer.density, gravity=layer.gravity)


def _down(face: Face) -> Real:
    """Places (N,) [m] along the face, in the direction in which it goes down."""
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(face.points, axis=0), axis=1))])
    return way if face.points[-1, -1] <= face.points[0, -1] else -way


def _shields(case: Case, bank: Bank, seen: Seen, face: Face) -> Real:
    """Shields numbers with and without the current along the bank, and the critical ones: (3, N, T)."""
    fluid, grain = case.fluid, next(row.grain_diameter for row in case.porous if row.name == bank.body)
    if grain is None:
        return np.full((3, *seen.face.shape), np.nan)
    current, height = _along_the_bank(case, seen.time), bank.height(site_of(case))
    repose, found = float(np.radians(bank.friction_angle)), []
    for slope, speed, pressure in zip(face.slope, seen.speed, seen.face, strict=True):
        keys = {
            "slope": min(float(slope), repose * (1 - 1e-9)), "repose": repose, "viscosity": fluid.viscosity,
            "relative_density": bank.grain_density / fluid.density, "gravity": fluid.gravity,
        }  # fmt: skip
        depth = pressure / (fluid.density * fluid.gravity)
        both = shields(speed, height, grain, across=current, depth=depth, **keys)
        alone = shields(speed, height, grain, **keys)
        found.append([both.number, alone.number, np.full(len(speed), both.critical)])
    return np.moveaxis(np.array(found), 1, 0)


def _along_the_bank(case: Case, time: Real) -> Real:
    """The return current of the ship of a case along the bank [m/s]; 0 without a ship."""
    wave = case.wave
    return wave.passage.along(time) if isinstance(wave, ShipWave) else np.zeros(len(time))
