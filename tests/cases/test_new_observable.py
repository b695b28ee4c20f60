"""An observable that houle does not have: its two pieces stand here, and everything else finds it."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from pydantic import Field as Key
from rich.console import Console

import houle
from houle.case import describe, model
from houle.case.tables.base import Name, Point2
from houle.case.tables.observed import Row
from houle.check.rules import require
from houle.errors import CaseError
from houle.fields import Field, Stations
from houle.flow.observer import Instrument, Now, Observer, Remark, Sample, Site, outside
from houle.flow.state import Flow
from houle.grid import FloatArray

# ---- the file in houle/observe -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Basin(Instrument):
    """The stretch of the tank between two x [m]."""

    name: str
    between: tuple[float, float]

    def check(self, site: Site) -> Iterator[Remark]:
        for x in self.between:
            yield from outside(site, "between", x, 0)


class Basins(Observer[Basin]):
    """Water in each basin, and the time integral of it, which has to survive a checkpoint."""

    table = "basin"
    instrument = Basin
    fields = (
        Field("basin_volume", "V_b", "m3", "basin", "volume of water in the basin", unit_2d="m2"),
        Field("basin_integral", "I_b", "m3 s", "basin", "time integral of that volume", unit_2d="m2 s"),
    )

    def __init__(self, instruments: Sequence[Basin], site: Site, flow: Flow) -> None:
        self.ends, self.flow = np.array([basin.between for basin in instruments]), flow
        self.integral = np.zeros(len(instruments))

    @classmethod
    def stations(cls, instruments: Sequence[Basin], site: Site) -> Stations:
        ends = np.array([basin.between for basin in instruments])
        places = {"from": ("left end of the basin", ends[:, 0]), "to": ("right end of the basin", ends[:, 1])}
        return Stations([basin.name for basin in instruments], places, cls.fields)

    def volumes(self) -> FloatArray:
        x, volume = self.flow.particles.position[:, 0], self.flow.particles.volume
        return np.array([volume[(x >= low) & (x < high)].sum() for low, high in self.ends])

    def sample(self, now: Now) -> Sample:
        return {"basin_volume": self.volumes(), "basin_integral": self.integral}

    def after_step(self, dt: float) -> None:
        self.integral = self.integral + dt * self.volumes()

    def state(self) -> dict[str, FloatArray]:
        return {"integral": self.integral}

    def restore(self, state: Mapping[str, FloatArray]) -> None:
        self.integral = np.array(state["integral"])


# ---- its table in houle/case/tables/observed.py ------------------------------------------------------------------


class BasinTable(Row):
    """[[basin]]: water between two x."""

    prefix = "B"

    name: Name = Key(default="", description="name in the results; B1, B2, ... when left out")
    between: Point2 = Key(description="ends [m]")


@pytest.fixture(autouse=True)
def added() -> Iterator[None]:
    model.add_table("basin", BasinTable, "water in basins")
    yield
    del model.Case.model_fields["basin"]
    model.Case.model_rebuild(force=True)


CASE: dict[str, Any] = {
    "case": {"name": "tank"},
    "domain": {"size": [0.4, 0.2], "spacing": 0.02},
    "water": [{"box": [[0.0, 0.0], [0.2, 0.1]]}],
    "basin": [{"between": [0.0, 0.2]}, {"name": "right", "between": [0.2, 0.4]}],
    "gauge": [{"x": 0.1}],
    "time": {"end": 0.2},
    "output": {"every": 0.1, "series_every": 0.01},
}


def test_the_case_file_knows_it():
    case = houle.load(CASE)
    assert [row.name for row in case.basin] == ["B1", "right"]
    assert houle.load(case.to_dict()).hash == case.hash
    assert "[[basin]]" in case.to_toml()
    assert model.schema()["properties"]["basin"]["description"] == "water in basins"
    with pytest.raises(CaseError, match=r"basin\[0\]\.betwen is not a key .*Did you mean \"between\""):
        houle.load({**CASE, "basin": [{"betwen": [0.0, 0.2]}]})


def test_houle_check_looks_at_where_it_stands():
    require(houle.load(CASE))
    with pytest.raises(CaseError, match=r"basin\.B1\.between = 20 lies outside .*Were cm given"):
        require(houle.load({**CASE, "basin": [{"between": [0.0, 20.0]}]}))


def test_houle_describe_fields_tells_it():
    told = io.StringIO()
    describe.fields(Console(file=told, width=200))
    assert "basin_volume" in told.getvalue() and "volume of water in the basin" in told.getvalue()


def test_series_hold_it(tmp_path):
    """With its place, unit and sentence; all of the water is in one basin or the other at any time."""
    series = houle.run(houle.load(CASE), out=tmp_path / "run").series
    assert series.basin_volume.dims == ("basin", "time")
    assert series.basin_volume.attrs["units"] == "m2"
    assert series.basin_volume.attrs["long_name"] == "volume of water in the basin"
    assert list(series.basin.values) == ["B1", "right"]
    assert series.basin_from.values == pytest.approx([0.0, 0.2])
    assert series.basin_volume.values[:, 0] == pytest.approx([0.02, 0.0])
    assert series.basin_volume.values.sum(axis=0) == pytest.approx(series.volume.values)
    assert series.basin_volume.values[1, -1] > 0.002  # the dam breaks


def test_a_run_that_was_stopped_goes_on_with_it(tmp_path):
    whole = houle.run(houle.load(CASE), out=tmp_path / "whole").series
    houle.run(houle.load(CASE), out=tmp_path / "parts", until=0.1)
    parts = houle.resume(tmp_path / "parts").series
    for name in ("basin_volume", "basin_integral"):
        np.testing.assert_array_equal(parts[name].values, whole[name].values)
