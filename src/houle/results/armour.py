"""Loads on the outer stones of the armour layers of a run, from the series of its [[armour]] tables.

The force of the water along the normal of the slope, over the submerged weight: per volume of the layer the water
pushes its stones with rho g i - rho dq/dt, i the gradient of the head out of the slope and q the Darcy velocity, whose
change takes a part of the gradient; the stones weigh (rho_s - rho) (1 - n) g. So

    F/W = (i - (dq/dt)/g) / [(s - 1) (1 - n)]

which in a steady flow is that of the infinite slope: the water lifts stones at i = (s - 1) (1 - n) cos(beta), F/W =
cos(beta). Neither the change of q along the way of the water nor the force of what runs over a single stone is in it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from houle.case.build import site_of
from houle.errors import CaseError
from houle.grid import FloatArray
from houle.observe.armour import Armour
from houle.output import series_table
from houle.output.csv_file import write_csv
from houle.output.netcdf import TIME
from houle.results.answers.given import EXPECTED, Given
from houle.results.answers.sea import sea_of

if TYPE_CHECKING:
    from houle.case.tables import observed
    from houle.results.run import Run

TABLE = "armour.csv"
TENTH = 0.1  # part of the waves whose largest values are averaged
ENOUGH = 20  # waves from which on a tenth of them is told
COLUMNS = (
    "armour", "x", "y", "z", "slope", "force_over_weight", "force_over_weight_time", "gradient_down",
    "gradient_down_time", "speed", "speed_time", "pore_velocity", "pore_velocity_time",
)  # fmt: skip


def record(run: Run) -> dict[str, Any]:
    """Writes armour.csv; the entry "armour" of run.json, a list in the order of the tables; {} without any.

    An armour that no answer can be given about has the entry "problem".
    """
    case, series = run.case, series_table(run.directory)
    if not case.armour or series.sizes["time"] < 3:
        return {}
    given, found, rows = Given(case, series, sea_of(case)), [], []
    for table in case.armour:
        try:
            stones = Stones(given, table)
            found.append(stones.entry())
            rows += list(stones.table_rows())
        except EXPECTED as error:
            found.append({"armour": table.name, "problem": str(error)})
    if rows:
        write_csv(run.directory / TABLE, COLUMNS, rows)
    return {"armour": found}


@dataclass(frozen=True)
class Largest:
    """The largest load of all stones and times.

    value, x, z, slope  of the stone [m], [rad]     time, lasts  when, and for how long it stays above half [s]
    tenth               mean of the highest tenth of the waves at this stone; None of few waves
    """

    value: float
    x: float
    z: float
    slope: float
    time: float
    lasts: float
    tenth: float | None


class Stones:
    """The outer stones of one [[armour]] in a run, from the arrival of the waves on."""

    def __init__(self, given: Given, table: observed.Armour) -> None:
        self.given, self.table = given, table
        self.mine = np.flatnonzero(np.asarray(given.series["armour"].values) == table.name)
        site = site_of(given.case)
        keys = ("name", "body", "x", "stone", "stone_density", "y")
        armour = Armour(**{key: getattr(table, key) for key in keys})
        self.face, self.size = armour.face(site), armour.size(site)
        self.body = next(row for row in given.case.porous if row.name == table.body)
        if self.body.porosity == 1.0:
            raise CaseError(f"porous.{table.body} has a porosity of 1, so there are no stones")

    @property
    def buoyant(self) -> float:
        """Relative buoyant density of the stones, Delta."""
        return self.table.stone_density / self.given.case.fluid.density - 1.0

    @cached_property
    def place(self) -> float:
        """The place that the waves reach first, x [m]."""
        x = self.face.points[:, 0]
        return float(x[0] if self.given.sea is None else x[np.argmin(np.abs(x - self.given.sea.maker))])

    @cached_property
    def late(self) -> FloatArray:
        """Numbers of the rows of the series that are looked at. Raises AnalysisError."""
        return np.asarray(self.given.late(self.place))

    @cached_property
    def time(self) -> FloatArray:
        return self.given.time[self.late]

    def _values(self, name: str) -> FloatArray:
        """Values of a quantity of the series against time, (N, T); of a vector (N, T, d)."""
        variable = self.given.series[name]
        return np.moveaxis(np.asarray(variable.values), variable.dims.index(TIME), 1)[self.mine][:, self.late]

    @cached_property
    def velocity(self) -> FloatArray:
        """Darcy velocity in the stones (N, T, d) [m/s]."""
        return self._values("armour_velocity")

    @cached_property
    def force(self) -> FloatArray:
        """Force out of the slope over the submerged weight [-], mean over two rows as its change of velocity is.

        It is 0 where the stone is dry at one of the three ends: a stone that gets wet has no change of velocity.
        """
        gravity, n = self.given.case.fluid.gravity, self.body.porosity
        gradient = _over_two(self._values("armour_gradient"))
        change = np.gradient((self.velocity * self.face.normals[:, None]).sum(axis=2), self.time, axis=1)
        wet = (self.velocity != 0.0).any(axis=2)
        wet[:, 1:-1] &= wet[:, :-2] & wet[:, 2:]
        return np.where(wet, (gradient - change / gravity) / (self.buoyant * (1.0 - n)), 0.0)

    @cached_property
    def down(self) -> FloatArray:
        """Gradient of the head down the slope while the water in the stones runs down it [-], 0 while it runs up."""
        falls = (self.velocity * self.face.down[:, None]).sum(axis=2) > 0.0
        return np.where(falls, self._values("armour_gradient_down"), 0.0)

    @cached_property
    def speed(self) -> FloatArray:
        """Speed of the water over the stones [m/s]."""
        return self._values("armour_speed")

    @cached_property
    def pores(self) -> FloatArray:
        """Speed of the water in the pores of the outer stones [m/s]."""
        return np.asarray(np.linalg.norm(self.velocity, axis=2) / self.body.porosity)

    @property
    def loads(self) -> dict[str, FloatArray]:
        """All loads by their columns of armour.csv."""
        names = ("force_over_weight", "gradient_down", "speed", "pore_velocity")
        return dict(zip(names, (self.force, self.down, self.speed, self.pores), strict=True))

    def entry(self) -> dict[str, Any]:
        """The entry of run.json: sizes, where the waves come first, the crest, and the largest of each load."""
        x, z = self.face.points[:, 0], self.face.points[:, -1]
        tops = x[z >= z.max() - 1e-6]
        return {
            "armour": self.table.name,
            "stones": len(x),
            "size": self.size,
            "buoyant": self.buoyant,
            "porosity": self.body.porosity,
            "place": self.place,
            "crest": float(tops[np.argmin(np.abs(tops - self.place))]),
            **{name: asdict(self.largest(load)) for name, load in self.loads.items()},
        }

    def largest(self, load: FloatArray) -> Largest:
        """The largest of a load (N, T)."""
        i, row = (int(at) for at in np.unravel_index(int(load.argmax()), load.shape))
        x, z, slope = self.face.points[i, 0], self.face.points[i, -1], self.face.slope[i]
        lasts = _lasts(load[i], self.time, row)
        return Largest(
            float(load[i, row]), float(x), float(z), float(slope), float(self.time[row]), lasts, self.tenth(load[i])
        )

    def tenth(self, values: FloatArray) -> float | None:
        """The mean of the highest tenth of the waves of a load (T,) at one stone; None where there are too few."""
        sea = self.given.sea
        count = 0 if sea is None or self.given.single else int((self.time[-1] - self.time[0]) / sea.mean)
        if count < ENOUGH:
            return None
        highest = np.sort([part.max() for part in np.array_split(values, count)])
        return float(highest[-max(1, round(TENTH * count)) :].mean())

    def table_rows(self) -> Iterator[dict[str, Any]]:
        """The rows of armour.csv: place and slope [rad] of each stone, its largest loads and their times."""
        for i, point in enumerate(self.face.points):
            row = {"armour": self.table.name, "x": float(point[0]), "z": float(point[-1])}
            row |= {"slope": float(self.face.slope[i]), "y": float(point[1]) if len(point) == 3 else None}
            for name, load in self.loads.items():
                at = int(load[i].argmax())
                row |= {name: float(load[i, at]), f"{name}_time": float(self.time[at])}
            yield row


def _over_two(values: FloatArray) -> FloatArray:
    """Means over two intervals of a series (N, T), by trapezoids: those over which np.gradient takes a change."""
    found = values.copy()
    found[:, 1:-1] = (values[:, :-2] + 2.0 * values[:, 1:-1] + values[:, 2:]) / 4.0
    found[:, 0], found[:, -1] = values[:, :2].mean(axis=1), values[:, -2:].mean(axis=1)
    return found


def _lasts(values: FloatArray, time: FloatArray, row: int) -> float:
    """Time [s] around a row for which a load stays above half of its value there."""
    low = np.flatnonzero(values <= 0.5 * values[row])
    before, after = low[low < row], low[low > row]
    first = time[before[-1]] if len(before) else time[0]
    last = time[after[0]] if len(after) else time[-1]
    return float(last - first)
