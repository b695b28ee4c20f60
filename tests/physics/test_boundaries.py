"""Boundaries compose: any two stand in one tank, with its water conserved, or one of them says why they cannot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import combinations_with_replacement
from math import fsum

import numpy as np
import pytest

from houle import load
from houle.boundary.absorbing import WaveCommand
from houle.boundary.gate import Gate
from houle.boundary.internal_source import Source, make_source
from houle.boundary.open_side import OpenSide
from houle.boundary.paddle import Command, Paddle
from houle.boundary.relaxation_zone import RelaxationZone
from houle.boundary.sponge import Sponge
from houle.case.build import build
from houle.data.history import Record
from houle.errors import CaseError
from houle.flow.boundaries import Boundary
from houle.flow.simulation import Simulation
from houle.waves.piston import law_of, reading_of
from houle.waves.theories import regular

DEPTH, END, GATE, OPENS = 0.3, 0.5, 1.5, 0.2  # m, s; place [m] and time [s] of the gate
TANK = {
    "case": {"name": "tank"},
    "domain": {"size": [3.0, 0.5], "spacing": 0.05},
    "water": [{"below": DEPTH}],
    "porous": [
        {"name": "rock", "box": [[1.9, 0.0], [2.1, 0.2]], "porosity": 0.45, "resistance": {"a": 9.0, "b": 30.0}}
    ],
    "solid": [{"name": "bed", "polygon": [[1.55, 0.0], [1.9, 0.0], [1.9, 0.06]]}],
    "time": {"end": END},
}
WAVE = regular("airy", 0.04, 1.2, DEPTH)
READ = reading_of(WAVE, DEPTH, 9.81)


def _piston(grid, medium, water):
    law = law_of(WAVE, 0.3, READ, 0.3, regular=True)
    return Paddle("piston", grid, 0.3, 1, WaveCommand(law, READ, grid, True))


def _side(far: bool, **given: float):
    def side(grid, medium, water):
        known = {key: Record(np.zeros(1), np.array([value])) for key, value in given.items()}
        faces = medium.open_faces[0].astype(float)
        return OpenSide.of(far, known, 0.1, None, 9.81, grid, faces, water)

    return side


def _source(grid, medium, water):
    return make_source(Source(1.0, 0.8, "finite", "both"), "regular", WAVE, grid, 0.3)


KINDS: dict[str, Callable[..., Boundary]] = {
    "gate": lambda grid, *_: Gate(grid, GATE, 1.0, OPENS),
    "piston": _piston,
    "absorber": lambda grid, *_: Paddle("absorber", grid, 2.7, -1, WaveCommand(None, READ, grid, True)),
    "open left": _side(False, velocity=0.1),
    "open right": _side(True, level=0.28),
    "source": _source,
    "zone": lambda grid, *_: RelaxationZone.of((0.0, 1.2), WAVE, grid, 0.3),
    "sponge": lambda grid, *_: Sponge(grid, ((2.2, 0.0), (3.0, 0.5)), 10.0),
}
REFUSED = {
    ("piston", "piston"): "both close the water at its left end",
    ("absorber", "absorber"): "both close the water at its right end",
    ("piston", "open left"): "the open left side is behind piston, where no water is",
    ("absorber", "open right"): "the open right side is behind absorber, where no water is",
    ("open left", "open left"): "given twice",
    ("open right", "open right"): "given twice",
    ("piston", "zone"): "leads the water from x = 0 to 1.2 m as if nothing stood there, but piston does",
    ("zone", "zone"): "lead the water",
}
PAIRS = list(combinations_with_replacement(KINDS, 2))


def tank(*makes: Callable[..., Boundary], **changes: object) -> Simulation:
    """The tank between these boundaries, water 0.1 m lower behind the gate where there is one."""
    case = load(TANK, changes or None)
    return Simulation(replace(build(case), boundaries=makes, settles=False), 1)


@pytest.mark.parametrize("pair", [pair for pair in PAIRS if pair not in REFUSED], ids="+".join)
def test_two_stand_in_one_tank(pair):
    """In either order, while a gate rises: water to round-off, faces shut under the gate, the medium untouched."""
    for names in {pair, pair[::-1]}:
        sim = tank(*(KINDS[name] for name in names))
        medium = [faces.copy() for faces in sim.medium.open_faces]
        face, steps = round(GATE / 0.05), 0
        while sim.time < END:
            stood = sim.time
            sim.advance(END)
            steps += 1
            shut = sim.flow.boundaries.open_faces[0][face, round(max(0.0, stood - OPENS) / 0.05) :]
            assert "gate" not in pair or not shut.any()
            assert all(np.array_equal(a, b) for a, b in zip(sim.medium.open_faces, medium, strict=True))
        assert steps > 20 and abs(sim.volume_drift) < 1e-13
        assert max(sim.flow.fastest) < 2.0
        moving = sum(1 for name in pair if name in ("piston", "absorber"))
        walls = sim.flow.boundaries.walls
        assert (0 if walls is None else len(walls)) == moving


@pytest.mark.parametrize("pair", REFUSED, ids="+".join)
def test_two_that_cannot_say_why(pair):
    for names in {pair, pair[::-1]}:
        with pytest.raises(CaseError, match=REFUSED[pair]):
            tank(*(KINDS[name] for name in names))


@pytest.mark.parametrize(
    ("gate", "words"),
    [
        (0.15, "gate at x = 0.15 m is behind piston, where no water is"),
        (0.4, "piston at x = 0.3 m needs 3 cells, 0.15 m, between it and the sides of the tank and any gate"),
        (2.6, "absorber at x = 2.7 m needs 3 cells"),
        (2.85, "gate at x = 2.85 m is behind absorber"),
    ],
)
def test_a_gate_needs_room_before_a_wall_and_water_on_both_sides(gate, words):
    with pytest.raises(CaseError, match=words):
        tank(lambda grid, *_: Gate(grid, gate, 1.0), KINDS["piston"], KINDS["absorber"])


def test_a_gate_does_not_stand_where_an_open_side_reads_its_level():
    with pytest.raises(CaseError, match=r"stands in the 3 columns, .* over which the open right side reads"):
        tank(KINDS["open right"], lambda grid, *_: Gate(grid, 2.9, 1.0))


@pytest.mark.parametrize("moved", [0.0, 0.3])
def test_a_wall_that_shakes_its_lattice_moves_no_water_through_a_shut_gate(moved):
    """Particles made anew in every step before a moving wall, whose lattice gives way to it over ten cells and more."""

    class Push(Command):
        def way(self, tank, paddle, dt):
            x = [0.3 + moved * (0.5 - 0.5 * np.cos(np.pi * t / 0.4)) + 0.013 for t in (tank.time, tank.time + dt)]
            return x[1] - x[0]

        def notice(self, tank, paddle):
            """It does not listen."""

    sim = tank(
        lambda grid, *_: Gate(grid, 0.8, 1.0, 10.0),
        lambda grid, *_: Paddle("wall", grid, 0.3, 1, Push()),
        **{"numerics.remesh_every": 1},
    )
    sim.step.remeshing.travel = 0.0

    def beyond() -> float:
        return fsum(sim.particles.volume[sim.particles.position[:, 0] > 0.8])

    before = beyond()
    while sim.time < 0.4:
        sim.advance(0.4)
    assert beyond() == pytest.approx(before, rel=1e-13)
    assert sim.flow.boundaries[1].x == pytest.approx(0.3 + moved)


def test_all_of_them_in_one_tank():
    """What can stand together does: gate, walls, source and sponge; gate, open sides and zone."""
    for names in (("gate", "piston", "absorber", "source", "sponge"), ("gate", "open left", "open right", "zone")):
        sim = tank(*(KINDS[name] for name in names))
        while sim.time < END:
            sim.advance(END)
        assert abs(sim.volume_drift) < 1e-13
