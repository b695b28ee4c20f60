"""The numbers of the page: those of the runs, and the paper's own from the table beside the plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from houle.analysis.coefficients import reflection
from houle.analysis.result import Reflection
from houle.data import laboratory
from houle.data.csv_table import read_columns
from houle.grid import FloatArray
from houle.reproduction.plan import Job
from houle.results.run import Run

TABLE = "table1.csv"
COLUMNS = ("slope", "height", "C", "A", "B", "H_R", "H_I", "C_R", "figure", "top", "bottom")
INSTANTS = (0.4, 0.8, 1.2)  # instants of the dam break in the paper [s]
TENS = 10.0  # factor of the instants of its waves: they are read as tens of seconds, see the page
NOTHING = (float("nan"), float("nan"))


@dataclass(frozen=True)
class Printed:
    """A row of the paper's table 1: levels above the bed and heights [m]; instants as its captions have them [s]."""

    slope: int
    height: float
    C: float
    A: float
    B: float
    H_R: float
    H_I: float
    C_R: float
    figure: int
    top: float
    bottom: float

    @property
    def instants(self) -> tuple[float, float]:
        """Instants [s] of the upper and lower figure, the seconds of the captions taken as tens of seconds."""
        return round(TENS * self.top, 6), round(TENS * self.bottom, 6)


def printed(folder: Path) -> list[Printed]:
    """The rows of the paper's table."""
    columns, _ = read_columns(folder / TABLE, COLUMNS, TABLE)
    rows = [dict(zip(COLUMNS, map(float, row), strict=True)) for row in zip(*columns, strict=True)]
    return [Printed(slope=int(row.pop("slope")), figure=int(row.pop("figure")), **row) for row in rows]


@dataclass(frozen=True)
class Reading:
    """Three points (x, level) [m] of a surface, as the paper names them.

    A, B  highest and lowest level in front of the block     C  level in it that is farthest from still water
    """

    A: tuple[float, float]
    B: tuple[float, float]
    C: tuple[float, float]


@dataclass(frozen=True)
class WaveRun:
    """A run with waves, and its results about the block."""

    job: Job
    run: Run

    @cached_property
    def entry(self) -> dict[str, Any]:
        """The entry "reflection" of run.json; empty if the run was too short to measure."""
        found = self.run.summary.get("reflection") or {}
        return {} if "problem" in found else found

    @property
    def C_R(self) -> float:
        return self.entry.get("C_R", float("nan"))

    @property
    def interval(self) -> tuple[float, float]:
        return tuple(self.entry.get("interval_R", NOTHING))

    @property
    def H_I(self) -> float:
        return self.entry.get("H_I", float("nan"))

    @property
    def H_R(self) -> float:
        return self.entry.get("H_R", float("nan"))

    @property
    def theory(self) -> float:
        """C_R of linear theory with Lorentz friction, NaN for a slope."""
        return (self.entry.get("theory") or {}).get("C_R", float("nan"))

    @cached_property
    def formula(self) -> Reflection:
        """Coefficients of the paper's formula, from the highest and the lowest level at the gauges in the window."""
        case, window = self.run.case, self.entry["window"]
        assert case.waves is not None and case.reflection is not None
        return reflection(
            self.run, depth=case.waves.depth, period=case.waves.period, method="jh2020",
            gauges=case.reflection.gauges, window=(window["start"], window["end"]), gravity=case.fluid.gravity,
        )  # fmt: skip

    @cached_property
    def levels(self) -> FloatArray:
        """Levels (G, T) [m] above the bed at the gauges in the window."""
        record, window = self.formula.record, self.formula.window
        return record.between(window.start, window.end).eta

    @property
    def highest(self) -> float:
        return float(self.levels.max())

    @property
    def lowest(self) -> float:
        return float(self.levels.min())

    @property
    def envelope(self) -> float:
        """C_R of equation (19) with the largest and the smallest wave height along the flume, as it is meant."""
        heights = np.ptp(self.levels, axis=1)
        return float((heights.max() - heights.min()) / (heights.max() + heights.min()))

    @property
    def origin(self) -> float:
        """x [m] of the source, where the paper's flume begins."""
        assert self.run.case.waves is not None
        return self.run.case.waves.place

    @property
    def depth(self) -> float:
        assert self.run.case.waves is not None
        return self.run.case.waves.depth

    @property
    def face(self) -> float:
        assert self.run.case.reflection is not None
        return self.run.case.reflection.structure[0]

    def read(self, time: float) -> Reading:
        """The three points at an instant [s]; A and B within a wavelength in front of the block."""
        surface, waves, wave = self.run.surface, self.run.case.waves, self.run.case.wave
        assert waves is not None and wave is not None
        x, eta = surface.x.values, laboratory.level(surface, time, surface.x.values)
        slope = self.run.case.porous[0]
        foot = self.face if slope.polygon is None else _waterline(slope.polygon, waves.depth)
        front = np.flatnonzero((x > foot - wave.length) & (x < foot))
        inside = np.flatnonzero(x > foot)
        places = (
            front[np.argmax(eta[front])],
            front[np.argmin(eta[front])],
            inside[np.argmax(np.abs(eta[inside] - waves.depth))],
        )
        return Reading(*((float(x[i]), float(eta[i])) for i in places))


def _waterline(polygon: Sequence[tuple[float, float]], level: float) -> float:
    """Place x [m] at which the front of a body goes through the level."""
    corners = np.array([*polygon, polygon[0]], dtype=float)
    found = []
    for (x0, z0), (x1, z1) in pairwise(corners):
        if (z0 - level) * (z1 - level) < 0:
            found.append(x0 + (level - z0) / (z1 - z0) * (x1 - x0))
    return float(min(found))


@dataclass(frozen=True)
class Pair:
    """A dam break with both schemes, on the same grid."""

    name: str
    ours: Run
    papers: Run

    def gain(self, run: Run, time: float) -> float:
        """Relative change of the water volume of a run since the start, at a time [s]."""
        drift = run.series.volume_drift
        return float(np.interp(time, drift.time.values, drift.values))

    def offset(self, time: float) -> float:
        """Mean level of the paper's scheme above ours [m]."""
        return float(np.mean(self._difference(time)))

    def distance(self, time: float) -> float:
        """Root mean square of the difference of the levels [m]."""
        return float(np.sqrt(np.mean(self._difference(time) ** 2)))

    def _difference(self, time: float) -> FloatArray:
        x = self.ours.surface.x.values
        return laboratory.level(self.papers.surface, time, x) - laboratory.level(self.ours.surface, time, x)

    def scores(self) -> list[tuple[float, float, float]]:
        """Time [s], rms [m] against the laboratory by our scheme and by the paper's; empty without points."""
        one, other = (run.summary.get("reference") for run in (self.ours, self.papers))
        if not one or not other:
            return []
        return list(zip(one["times"], one["rms"], other["rms"], strict=False))

    def overall(self) -> tuple[float, float]:
        """rms over all laboratory points [m], of our scheme and of the paper's."""
        one, other = (run.summary.get("reference") or {} for run in (self.ours, self.papers))
        return one.get("overall", float("nan")), other.get("overall", float("nan"))


@dataclass(frozen=True)
class Found:
    """All results for the page: the table of the paper, pairs of dam breaks, runs with waves."""

    table: list[Printed]
    pairs: list[Pair]
    waves: list[WaveRun]

    def of_part(self, part: str, slope: int = 0, height: float = 0.0, flume: int = 0) -> list[WaveRun]:
        """Runs with waves of a part of the plan, slope, height and flume; 0 stands for any."""
        wanted = {"part": part, **{k: v for k, v in (("slope", slope), ("height", height), ("flume", flume)) if v}}
        return [w for w in self.waves if all(getattr(w.job, k) == v for k, v in wanted.items())]

    def row(self, p: Printed, flume: int) -> WaveRun | None:
        """The run of a row of the table in a flume of this length [m]; None if there is none long enough."""
        rows = [w for w in self.of_part("table", p.slope, p.height, flume) if w.entry]
        return rows[0] if rows else None


@dataclass
class Done:
    """Finished runs by the name of their job, and the reasons why others failed."""

    runs: dict[str, Run] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)


def gather(folder: Path, jobs: Sequence[Job], runs: Mapping[str, Run]) -> Found:
    """All results of these runs of the plan in this folder."""
    there = [(job, runs[job.name]) for job in jobs if job.name in runs]
    dams = {(job.of, job.scheme): run for job, run in there if job.part == "dam-break"}
    names = list(dict.fromkeys(of for of, _ in dams))
    pairs = [
        Pair(n, dams[n, "houle"], dams[n, "jh2020"]) for n in names if {(n, "houle"), (n, "jh2020")} <= dams.keys()
    ]
    return Found(printed(folder), pairs, [WaveRun(job, run) for job, run in there if job.part != "dam-break"])
