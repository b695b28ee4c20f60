"""Laboratory tests of mean overtopping that are most like a case: its nearest neighbours in the CLASH database (2004).

A test and a case are compared by dimensionless numbers, as the neural networks that learnt from the database do:
freeboard Rc/Hm0, steepness s = Hm0/L0, depth at the toe h/Hm0, slope cot a, roughness gamma_f, width Gc/Hm0 of the
armour's crest and its height (Ac - Rc)/Hm0 against the crest that keeps the water. The difference of each is divided by
its standard deviation among the tests of the kind, and the distance is the root of the sum of squares: 1 means that one
number is off by as much as the tests differ among themselves. No weight is fitted. Steepness and depth, whose largest
values are six to ten times the smallest, enter by their logarithm. The height of the armour's crest is a height like Rc
and divided by the same; most tests have both at one level. A number that all tests have in common counts nothing in the
distance: `outside` names it where the case has another.

The table holds no test with q* = q / sqrt(g Hm0^3) below 1e-5. So the neighbours of a case that lets less water over
are tests that let more, and their mean is too high.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from math import exp, inf, log, nan
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from houle.design.errors import DesignError
from houle.design.formula import FORMULAS, Answer, Choice, Input, formula, quantity
from houle.design.inputs import CotSlope, Depth, EnergyPeriod, Freeboard, Height, Roughness
from houle.design.overtopping import (
    Overtopping,
    overtopping_mound,
    overtopping_slope,
    overtopping_wall,
    overtopping_wall_foreshore,
)
from houle.design.sea import deep_length, discharge

TABLE = Path(__file__).parent / "clash.csv"
NEEDED = {"slope": ("cot_slope",), "wall": (), "mound": ("cot_slope", "roughness", "crest_width")}
LOGARITHMS = [1, 2]  # places of s and h/Hm0, which are compared by their logarithm
ROUND_OFF = 1e-9  # differences of numbers and distances that count as none
FAR = 95  # per cent of the tests have a neighbour as near as a case that lies among them

Reals = NDArray[np.float64]
Kind = Annotated[str, Choice("structure", tuple(NEEDED))]
CrestWidth = Annotated[float, Input("width of the crest of the armour, G_c", "m", least=0)]
ArmourCrest = Annotated[
    float, Input("height of the armour's crest above still water, A_c; freeboard without wall", "m")
]
Count = Annotated[int, Input("number of tests", "-", least=1)]


def numbers(
    wave_height: float,
    period: float,
    depth: float,
    freeboard: float,
    cot_slope: float,
    roughness: float,
    crest_width: float,
    armour_crest: float,
) -> dict[str, float]:
    """The dimensionless numbers by which tests are compared, by name."""
    return {
        "Rc/Hm0": freeboard / wave_height,
        "s": wave_height / deep_length(period),
        "h/Hm0": depth / wave_height,
        "cot a": cot_slope,
        "gamma_f": roughness,
        "Gc/Hm0": crest_width / wave_height,
        "(Ac - Rc)/Hm0": (armour_crest - freeboard) / wave_height,
    }


@dataclass(frozen=True)
class LaboratoryTest:
    """A test of mean overtopping in a laboratory: its sizes in metres and seconds as they were there.

    row          its line in the CLASH database
    kind         "slope", "wall" or "mound"
    wave_height  H_m0 at the toe; period T_m-1,0 there; peak_period T_p, NaN where the database has none
    depth        of still water at the toe; foreshore is the cotangent of the bed's slope before it, inf of a level bed
    freeboard    R_c; armour_crest A_c and crest_width G_c are those of the armour's crest
    cot_slope    of the structure, 0 of a wall; roughness its gamma_f
    q            mean overtopping discharge [m3/s/m]
    """

    row: int
    kind: str
    wave_height: float
    period: float
    peak_period: float
    depth: float
    foreshore: float
    freeboard: float
    armour_crest: float
    crest_width: float
    cot_slope: float
    roughness: float
    q: float

    @property
    def q_star(self) -> float:
        """q / sqrt(g Hm0^3) [-]."""
        return self.q / discharge(self.wave_height)

    @property
    def ratios(self) -> dict[str, float]:
        """Its dimensionless numbers by name."""
        return numbers(
            self.wave_height, self.period, self.depth, self.freeboard, self.cot_slope, self.roughness,
            self.crest_width, self.armour_crest,
        )  # fmt: skip

    def by_formula(self, roughness_rule: str = "eurotop-2018") -> Overtopping:
        """Overtopping that EurOtop (2018) gives for it; a wall counts as one with a foreshore where the bed slopes."""
        waves: dict[str, Any] = {"wave_height": self.wave_height, "period": self.period, "freeboard": self.freeboard}
        slope: dict[str, Any] = {"cot_slope": self.cot_slope, "roughness": self.roughness}
        if self.kind == "slope":
            return overtopping_slope(**waves, **slope)
        if self.kind == "mound":
            return overtopping_mound(**waves, **slope, crest_width=self.crest_width, roughness_rule=roughness_rule)
        if self.foreshore < inf:
            return overtopping_wall_foreshore(**waves, depth=self.depth)
        return overtopping_wall(wave_height=self.wave_height, freeboard=self.freeboard)


@dataclass(frozen=True)
class Neighbour:
    """A laboratory test beside a case.

    test      the test
    distance  from the case, in standard deviations of the table
    q         its mean discharge in waves as high as those of the case (Froude) [m3/s/m]
    """

    test: LaboratoryTest
    distance: float
    q: float

    def __str__(self) -> str:
        test = self.test
        ratios = ", ".join(f"{name} {value:.3g}" for name, value in test.ratios.items() if value)
        found = f"distance {self.distance:.2f}, q {self.q:.3g} m3/s/m (q* {test.q_star:.3g})"
        return f"row {test.row}, Hm0 {test.wave_height:g} m: {found}; {ratios}"


@dataclass(frozen=True, kw_only=True)
class NearestTests(Answer):
    """The laboratory tests that are most like a case, the nearest first, in `tests`; the band is their spread."""

    q: float = quantity("mean discharge of the nearest tests, their geometric mean", "m3/s/m")
    q_star: float = quantity("the same over sqrt(g Hm0^3)", "-")
    distance: float = quantity("distance of the nearest test", "-")
    tests: tuple[Neighbour, ...] = field(default=())

    def __str__(self) -> str:
        return "\n  ".join([super().__str__(), *map(str, self.tests)])


@dataclass(frozen=True)
class Cloud:
    """The tests of a kind as points, which lie apart as far as the tests differ.

    tests   N tests
    ratios  (N, 7) dimensionless numbers of each
    weight  (7,) one over the standard deviation of each number, 0 where all tests share it
    points  (N, 7) numbers as they are compared, times their weight
    """

    tests: tuple[LaboratoryTest, ...]
    ratios: Reals
    weight: Reals
    points: Reals

    @property
    def q_star(self) -> Reals:
        """Dimensionless discharge (N,) of the tests."""
        return np.array([test.q_star for test in self.tests])

    def distances(self, ratios: Mapping[str, float]) -> Reals:
        """Distance (N,) of each test from a case with these numbers."""
        return self._distances(_compared(np.array(list(ratios.values()))) * self.weight)

    def apart(self) -> Reals:
        """Distances (N, N) of the tests from each other, inf of each from itself."""
        between = np.array([self._distances(point) for point in self.points])
        np.fill_diagonal(between, inf)
        return between

    def twins(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Places of the two tests of each pair (P,) of which all numbers are the same."""
        first, second = np.nonzero(np.triu(self.apart() < ROUND_OFF))
        return first, second

    def _distances(self, point: Reals) -> Reals:
        return np.asarray(np.linalg.norm(self.points - point, axis=1))


@cache
def cloud(kind: str) -> Cloud:
    """All tests of a kind."""
    tests = tuple(test for test in _read() if test.kind == kind)
    ratios = np.array([list(test.ratios.values()) for test in tests])
    spread = _compared(ratios).std(axis=0)
    spread[-1] = spread[0]  # heights of crests
    weight = np.divide(1.0, spread, out=np.zeros_like(spread), where=spread > 0)
    return Cloud(tests, ratios, weight, _compared(ratios) * weight)


@cache
def far(kind: str) -> float:
    """Distance within which 95 % of the tests of a kind have another."""
    return float(np.percentile(cloud(kind).apart().min(axis=1), FAR))


def others(kind: str, count: int = 5, rows: int = 0) -> NDArray[np.int64]:
    """Places (N, count) of the tests that are nearest to each test of a kind, without itself.

    rows: tests whose line in the database is as near as that are left out too; neighbours in the database are mostly a
    series of one laboratory, with the same structure in other waves.
    """
    between, row = cloud(kind).apart(), np.array([test.row for test in cloud(kind).tests])
    between[np.abs(row[:, None] - row) <= rows] = inf
    return np.argsort(between, axis=1, kind="stable")[:, :count]


@formula(
    "nearest-tests",
    "Mean overtopping in the laboratory tests that are most like a slope, a wall or a rubble mound: no formula.",
    source="CLASH database (2004): Steendam, van der Meer, Verhaeghe, Besley, Franco & van Gent",
    status="Measured; a repeated test differs by a factor of 1.25, and of pairs of mounds with the same numbers 62 % "
    "agree within two: the database knows neither stones nor core",
    holds="400 smooth slopes, 103 vertical walls, 532 rubble mounds; normal waves, no berm, no toe, q* from 1e-5 on",
    scatter="The mean of the five nearest of the other tests lies within a factor of two of a test for 74 % of the "
    "slopes, 53 % of the walls and 60 % of the mounds; for 52, 39 and 39 % without those up to 100 rows away in the "
    "database, which are mostly of the same laboratory.",
    example={
        "kind": "mound", "wave_height": 4.0, "period": 9.0, "depth": 15.0, "freeboard": 4.4, "cot_slope": 1.5,
        "roughness": 0.40, "crest_width": 4.0,
    },
)  # fmt: skip
def nearest_tests(
    *,
    kind: Kind,
    wave_height: Height,
    period: EnergyPeriod,
    depth: Depth,
    freeboard: Freeboard,
    cot_slope: CotSlope | None = None,
    roughness: Roughness | None = None,
    crest_width: CrestWidth | None = None,
    armour_crest: ArmourCrest | None = None,
    count: Count = 5,
) -> NearestTests:
    """Laboratory tests nearest to a case, each with its row in the database, its distance and its discharge.

    Distance is the root of the sum of squares of the differences of Rc/Hm0, ln Hm0/L0, ln h/Hm0, cot a, gamma_f, Gc/Hm0
    and (Ac - Rc)/Hm0, each over its standard deviation among the tests of the kind. Discharges are brought to the waves
    of the case by Froude's law. A slope needs cot_slope, a mound roughness and crest_width as well; a wall none.
    """
    given = {"cot_slope": cot_slope, "roughness": roughness, "crest_width": crest_width}
    _require(kind, given, count)
    ratios = numbers(
        wave_height, period, depth, freeboard, cot_slope or 0.0, 1.0 if roughness is None else roughness,
        crest_width or 0.0, freeboard if armour_crest is None else armour_crest,
    )  # fmt: skip
    tests, distances, unit = cloud(kind).tests, cloud(kind).distances(ratios), discharge(wave_height)
    nearest = np.argsort(distances, kind="stable")[: int(count)]
    found = tuple(Neighbour(tests[i], float(distances[i]), tests[i].q_star * unit) for i in nearest)
    q = exp(sum(log(one.q) for one in found) / len(found))
    return NearestTests(
        q=q,
        q_star=q / unit,
        distance=found[0].distance,
        tests=found,
        low=min(one.q for one in found),
        high=max(one.q for one in found),
        band=f"the least and the most of the {len(found)} nearest tests",
        ratios=ratios,
        branch=f"among {len(tests)} tests of the kind {kind!r}",
        outside=tuple(_outside(kind, ratios, found[0].distance)),
    )


def _require(kind: str, given: Mapping[str, float | None], count: float) -> None:
    """Raises DesignError where a number is missing that tests of the kind differ in, or the table has too few tests."""
    for name in NEEDED[kind]:
        if given[name] is None:
            told = FORMULAS["nearest-tests"].inputs[name]
            raise DesignError(f"{name} is missing: tests of the kind {kind!r} differ in it: {told.told} [{told.unit}]")
    most = len(cloud(kind).tests)
    if count != int(count) or count > most:
        raise DesignError(
            f"count = {count:g} must be a whole number from 1 to {most}: number of tests, of kind {kind!r}"
        )


def _outside(kind: str, ratios: Mapping[str, float], distance: float) -> Iterator[str]:
    """A sentence for each number that no test of the kind reaches, and one where no test is near."""
    table, among = cloud(kind).ratios, f"of the {len(cloud(kind).tests)} tests of the kind {kind!r}"
    for (name, value), column in zip(ratios.items(), table.T, strict=True):
        low, high = float(column.min()), float(column.max())
        if value < low - ROUND_OFF:
            yield f"{name} = {value:.4g} is below {low:.4g}, the least {among}"
        if value > high + ROUND_OFF:
            yield f"{name} = {value:.4g} is above {high:.4g}, the most {among}"
    if distance > far(kind):
        yield f"the nearest test lies {distance:.3g} away; {FAR} % {among} have another within {far(kind):.3g}"


def _compared(ratios: Reals) -> Reals:
    """Numbers (..., 7) with the logarithm of those that are compared by it."""
    compared = ratios.copy()
    compared[..., LOGARITHMS] = np.log(compared[..., LOGARITHMS])
    return compared


@cache
def _read() -> tuple[LaboratoryTest, ...]:
    """All tests of the table."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return tuple(
        LaboratoryTest(
            row=int(r["row"]),
            kind=r["kind"],
            wave_height=float(r["hm0_toe"]),
            period=float(r["tm10_toe"]),
            peak_period=float(r["tp_toe"] or nan),
            depth=float(r["depth_toe"]),
            foreshore=inf if float(r["foreshore_cot"]) >= 1000 else float(r["foreshore_cot"]),
            freeboard=float(r["rc"]),
            armour_crest=float(r["ac"]),
            crest_width=float(r["gc"]),
            cot_slope=float(r["slope_cot"]),
            roughness=float(r["gamma_f"]),
            q=float(r["q"]),
        )
        for r in rows
    )
