"""Choices that houle does not have: a row and its function stand here, and everything else finds them."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from pydantic import Field as Key
from rich.console import Console

import houle
from houle.case import describe, model
from houle.case.build import build
from houle.case.tables.base import Point2
from houle.case.tables.boundaries import Standing
from houle.check.rules import require
from houle.errors import CaseError
from houle.flow.boundaries import BOUNDARIES, Boundary, BoundaryKind, Surroundings
from houle.flow.particles import Particles
from houle.flow.remeshers import REMESHERS, Keep
from houle.flow.simulation import Simulation
from houle.flow.state import Flow
from houle.flow.transfer import TRANSFERS, Pic
from houle.grid import Faces, Grid
from houle.medium.medium import Medium
from houle.medium.resistance import LAWS, Law, Pair
from houle.registry import Choices
from houle.waves.linear import airy
from houle.waves.wave import THEORIES, Theory, Wave

# ---- what a newcomer would write in medium/resistance.py, waves/, flow/transfer.py and flow/remeshers.py


def darcy(n: float, d: float, nu: float, factor: float) -> Pair:
    """a = factor nu/d^2,  b = 0."""
    return factor * nu / d**2, 0.0


LAW = Law(
    "darcy-1856", darcy, {"factor": 180.0}, "Darcy (1856), Les fontaines publiques de Dijon", "RECALLED", (0.3, 0.5)
)


def calm(height: float, period: float, depth: float, gravity: float, phase: float, direction: float) -> Wave:
    return airy(height / 2, period, depth, gravity, phase, direction)


THEORY = Theory("half", "Half as high as asked for.", "nowhere", "this test", calm, place=99)


class Calm(Pic):
    """Particles at rest, whatever the grid says."""

    name = "calm"
    what = "Particles stand still."
    source = "this test"

    def to_particles(self, flow: Flow) -> None:
        flow.particles.velocity[...] = 0.0


class Left(Keep):
    """The particles as they are."""

    name = "left-alone"
    what = "Nothing is done to the particles."
    source = "this test"


class Fan(Boundary):
    """Pushes the water between two faces along x with an acceleration [m/s2]."""

    def __init__(self, grid: Grid, between: tuple[float, float], acceleration: float) -> None:
        self.first, self.last = (round(x / grid.spacing[0]) for x in between)
        self.acceleration = acceleration

    def touches(self) -> dict[int, slice]:
        return {0: slice(self.first, self.last)}

    def push(self, t: float, acceleration: Faces) -> None:
        acceleration[0][self.first : self.last] += self.acceleration


def fan(case: Surroundings, grid: Grid, medium: Medium, water: Particles, **keys: Any) -> Fan:
    return Fan(grid, **keys)


FAN = BoundaryKind("fan", "It pushes the water along.", "this test", fan, place=9, full_height=False)


class FanTable(Standing):
    """[[fan]]: what pushes the water."""

    between: Point2 = Key(description="from, to [m]")
    acceleration: float = Key(description="along x [m/s2]")


ADDED: list[tuple[Choices[Any], Any, str]] = [
    (LAWS, LAW, "resistance"),
    (THEORIES, THEORY, "theories"),
    (TRANSFERS, Calm, "transfers"),
    (REMESHERS, Left, "remeshing"),
    (BOUNDARIES, FAN, "makers"),
]


@pytest.fixture(autouse=True)
def added() -> Iterator[None]:
    for table, row, _ in ADDED:
        table.add(row)
    model.add_table("fan", FanTable, "what pushes the water")
    yield
    del model.Case.model_fields["fan"]
    model.Case.model_rebuild(force=True)
    for table, row, _ in ADDED:
        table.remove(row.name)


CASE: dict[str, Any] = {
    "case": {"name": "tank"},
    "domain": {"size": [0.6, 0.2], "spacing": 0.02},
    "water": [{"box": [[0.0, 0.0], [0.2, 0.1]]}],
    "porous": [
        {"name": "sand", "box": [[0.4, 0.0], [0.5, 0.1]], "porosity": 0.4, "grain_diameter": 0.002,
         "resistance": {"law": "darcy-1856"}}
    ],
    "numerics": {"transfer": "calm", "remesh": "left-alone"},
    "time": {"end": 0.1},
}  # fmt: skip
WAVES = {"kind": "regular", "theory": "half", "height": 0.02, "period": 1.0, "depth": 0.1, "zone": {"x": [0.0, 0.3]}}


@pytest.mark.parametrize(
    ("row", "topic"), [(row, topic) for _, row, topic in ADDED], ids=lambda v: getattr(v, "name", v)
)
def test_houle_describe_tells_it(row: Any, topic: str):
    told = io.StringIO()
    describe.TOPICS[topic](Console(file=told, width=200))
    assert row.name in told.getvalue() and row.what[:12] in told.getvalue()


def test_the_case_file_knows_them():
    case = houle.load(CASE | {"waves": WAVES})
    assert (case.numerics.transfer, case.numerics.remesh) == ("calm", "left-alone")
    assert case.porous[0].resistance.law == "darcy-1856"
    assert houle.load(case.to_dict()).hash == case.hash
    schema = str(model.schema())
    assert all(f"'{row.name}'" in schema for _, row, _ in ADDED)
    with pytest.raises(CaseError, match=r'transfer = "clam" is not one of .*"calm"\. Did you mean "calm"'):
        houle.load(CASE | {"numerics": {"transfer": "clam"}})


def test_a_run_takes_them():
    case = houle.load(CASE)
    require(case)
    sim = Simulation(build(case), 1)
    assert sim.setup.bodies[0].a == pytest.approx(180.0 * 1e-6 / 0.002**2) and sim.setup.bodies[0].b == 0.0
    before = sim.particles.position.copy()
    sim.advance(0.1)
    np.testing.assert_array_equal(sim.particles.velocity, 0.0)
    assert len(before) == len(sim.particles)
    wave = houle.load(CASE | {"waves": WAVES}).wave
    assert wave is not None and wave.crest == pytest.approx(0.005)


def test_a_boundary_acts_in_a_run():
    """It gives the water momentum towards where it pushes, in a tank that otherwise stays at rest."""
    still = {**CASE, "water": [{"below": 0.1}], "porous": [], "numerics": {}}
    pushed = still | {"fan": [{"between": [0.1, 0.5], "acceleration": 1e-3}]}
    tank, other = (Simulation(build(houle.load(case)), 1) for case in (still, pushed))
    assert (len(tank.flow.boundaries), len(other.flow.boundaries)) == (0, 1)
    for sim in (tank, other):
        sim.advance(0.01)
    given = other.sample()["momentum_x"]
    assert given > 0.0
    assert abs(tank.sample()["momentum_x"]) < 1e-3 * given  # what the pressure solve leaves of water at rest
    assert "[[fan]]" in houle.load(pushed).to_toml()


def test_two_choices_of_one_name_are_refused():
    with pytest.raises(ValueError, match="two choices of kind resistance law with the name darcy-1856"):
        LAWS.add(Law("darcy-1856", darcy, {}, "", ""))
