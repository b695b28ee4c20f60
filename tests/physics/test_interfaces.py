"""Porous faces with water that goes through them, and along them: no clumps, no bumps of the surface, no friction."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from situations import run, simulation

from houle.flow.motion import move
from houle.flow.surface import arrange
from houle.observe.points import velocity_at

SLOSH: dict[str, Any] = {
    "case": {"name": "slosh-through-a-block"},
    "domain": {"size": [1.2, 0.35], "spacing": 0.02},
    "water": [{"polygon": [[0.0, 0.0], [1.2, 0.0], [1.2, 0.24], [0.0, 0.26]]}],
    "time": {"end": 3.0},
}


@pytest.mark.parametrize(("porosity", "crowding", "bumps"), [(0.85, 0.02, 1.6e-3), (0.49, 0.04, 3.2e-3)])
def test_the_surface_is_smooth_over_the_faces_of_a_block(porosity, crowding, bumps):
    """Second differences of the level [m], and fill of the cells well under water, mean over the depth, both rms.

    Waves of 10 mm. With the water kept apart by bodies in remeshing, particles that took their porosity from cell means
    and levels that counted every particle of a column they were 9.4 and 12.2 mm, 0.08 and 0.13; now 1.0 and 2.1 mm,
    0.01 and 0.02.
    """
    block = {"name": "block", "box": [[0.4, 0.0], [0.8, 0.35]], "porosity": porosity, "added_mass": 0.0}
    sim = simulation({**SLOSH, "porous": [{**block, "resistance": {"a": 0.5, "b": 0.0}}]})
    levels, fill = [], []
    while sim.time < 2.999:
        run(sim, 5, 3.0)
        levels.append(sim.flow.eta.copy())
        fill.append(sim.flow.fill[:, :10].mean(axis=1))
    bump = np.diff(np.array(levels)[10:], n=2, axis=1)
    assert np.sqrt(np.mean(bump**2, axis=0)).max() < bumps
    assert np.sqrt(np.mean((np.array(fill)[10:] - 1.0) ** 2, axis=0)).max() < crowding


STILL = {"a": 5.0, "b": 0.0}


@pytest.mark.parametrize(("edge", "porosity"), [(0.5, 0.45), (0.5061, 0.45), (0.5125, 0.3), (0.5, 0.85)])
def test_water_that_moves_on_alike_leaves_pores_as_full_and_levels_where_they_are(edge, porosity):
    """By a thousandth of a cell, across the face of a block. What is left is the difference between the porosity at the
    centre of the water of a half cell and the mean in it.

    Where water lay as the structure holds it, what came to a tent was .08 (n = .45) to .41 (n = .3) of the way too much
    or too little, and levels moved by .33 and 2.8 of the way.
    """
    sim = simulation(
        {
            "case": {"name": "face"},
            "domain": {"size": [1.0, 0.4], "spacing": 0.025},
            "water": [{"below": 0.2537}],
            "porous": [{"name": "block", "box": [[edge, 0.0], [1.0, 0.4]], "porosity": porosity, "resistance": STILL}],
            "time": {"end": 1.0},
        }
    )
    flow, way = sim.flow, 1e-3
    fill, level = flow.fill.copy(), flow.filled_level.copy()
    flow.velocity[0][...], flow.velocity[1][...] = way * 0.025, 0.0
    sim.particles.velocity[...] = way * 0.025, 0.0
    move(flow, 1.0, interpolated=False)
    arrange(flow)
    inner = slice(10, 30)  # not at the walls
    pores = 1.0 / flow.inverse_capacity[inner, 5] / 0.025**2
    assert np.abs((flow.fill[inner, 5] - fill[inner, 5]) * pores).max() < 0.025 * way
    assert np.abs(flow.filled_level[inner] - level[inner]).max() < 0.16 * way * 0.025


IMPERMEABLE = {"porosity": 0.45, "added_mass": 0.0, "resistance": {"a": 1e6, "b": 0.0}}


@pytest.mark.parametrize("transfer", ["fmpm", "flip", "apic"])
def test_a_uniform_stream_along_an_impermeable_bed_keeps_its_momentum(transfer):
    """To the half of 1 % that the water in the pores has and loses at once.

    With one velocity for both sides of the face the transfers took 11 % of it (FMPM) in the two seconds.
    """
    sim = simulation(
        {
            "case": {"name": "stream"},
            "domain": {"size": [0.4, 0.2], "spacing": 0.02, "walls": {"x": "periodic"}},
            "fluid": {"viscosity": 0.0},
            "water": [{"box": [[0, 0.06], [0.4, 0.16]], "velocity": [0.5, 0.0]}, {"box": [[0, 0], [0.4, 0.06]]}],
            "porous": [{"name": "bed", "box": [[0, 0], [0.4, 0.06]], **IMPERMEABLE}],
            "time": {"end": 2.0},
            "numerics": {"transfer": transfer},
        }
    )
    start = sim.particles.volume @ sim.particles.velocity[:, 0]
    remeshed = 0
    while sim.time < 2.0:
        sim.advance(2.0)
        remeshed += sim.step.remeshing.count == 0
    assert remeshed > 10
    assert sim.particles.volume @ sim.particles.velocity[:, 0] == pytest.approx(start, rel=5e-3)


def amplitudes(ends: dict[str, Any], x0: float, periods: int) -> list[float]:
    """Amplitudes [m] in the first and last period of half a standing wave, 0.75 m long, from x0 on; cells of 30 mm."""
    length, depth, height, cell = 0.75, 0.36, 0.02, 0.03
    k = np.pi / length
    omega = np.sqrt(9.81 * k * np.tanh(k * depth))
    s = np.linspace(0.0, length, 100)
    surface = [[x0 + length - x, depth - height * np.cos(k * x)] for x in s]
    water = [{"polygon": [[x0, 0.0], [x0 + length, 0.0], *surface]}]
    if x0 > 0.0:
        water += [{"box": [[0.0, 0.0], [x0, depth]]}, {"box": [[x0 + length, 0.0], [length + 0.27, depth]]}]
    case = {
        "case": {"name": "basin"},
        "domain": {"size": [length + (0.27 if x0 > 0.0 else 0.0), 0.48], "spacing": cell},
        "fluid": {"viscosity": 0.0},
        "water": water,
        "time": {"end": periods * 2 * np.pi / omega},
    }
    sim = simulation({**case, **ends})
    x = sim.grid.axis_points(0)
    inside = (x > x0 + 2 * cell) & (x < x0 + length - 2 * cell)
    modes = np.stack([np.ones(inside.sum()), np.cos(k * (x[inside] - x0))], axis=1)
    time, wave = [], []
    while sim.time < sim.setup.time.end:
        sim.advance(sim.setup.time.end)
        time.append(sim.time)
        wave.append(np.linalg.lstsq(modes, sim.flow.eta[inside], rcond=None)[0][1])
    found = []
    for first in (0.0, (periods - 1) * 2 * np.pi / omega):
        part = (np.array(time) >= first) & (np.array(time) <= first + 2 * np.pi / omega)
        phase = omega * np.array(time)[part]
        one = np.stack([np.cos(phase), np.sin(phase), np.ones(part.sum())], axis=1)
        found.append(np.hypot(*np.linalg.lstsq(one, np.array(wave)[part], rcond=None)[0][:2]))
    return found


@pytest.mark.parametrize(("shift", "less"), [(0.0, 0.004), (0.004, 0.004), (0.008, 0.02), (0.015, 0.02)])
def test_a_block_of_huge_drag_reflects_as_a_wall(shift, less):
    """From the first to the last of six periods, in ten reflections, a standing wave between two such blocks loses
    little more than between walls.

    On the grid lines and an eighth of a cell off them each reflection is within 0.004 of that of a wall, 50 cells to
    the length; a quarter and half a cell off, where more of the face is rock, within 0.02. With one velocity along both
    sides of a face each was 0.02 (on the grid lines) to 0.07 (off them) lower.
    """
    walls = amplitudes({}, 0.0, 6)
    blocks = [
        {"name": name, "box": [[low, 0.0], [high, 0.48]], **IMPERMEABLE}
        for name, low, high in (("left", 0.0, 0.12 + shift), ("right", 0.87 + shift, 1.02))
    ]
    between = amplitudes({"porous": blocks}, 0.12 + shift, 6)
    assert between[1] / between[0] > walls[1] / walls[0] * (1.0 - less) ** 10


def test_water_at_rest_over_a_bed_off_the_lines_stays_at_rest():
    """Gravity and pressure cancel in the water and in the rock of a shared face, whatever their mobilities."""
    body = {"name": "bed", "box": [[0.0, 0.0], [0.437, 0.151]], "porosity": 0.4, "resistance": {"a": 50.0, "b": 9.0}}
    sim = simulation(
        {
            "case": {"name": "rest"},
            "domain": {"size": [1.0, 0.4], "spacing": 0.02},
            "water": [{"below": 0.257}],
            "porous": [body],
            "time": {"end": 0.5},
            "numerics": {"tolerance": 1e-11},
        }
    )
    while sim.time < 0.5:
        sim.advance(0.5)
    assert np.abs(sim.particles.velocity).max() < 1e-9


@pytest.mark.parametrize("top", [0.1, 0.105, 0.115])
def test_a_section_counts_both_media_of_a_face_that_they_share(top):
    """A stream over a bed, before any of it is slowed: the discharge is that of 0.2 m/s in what is clear water."""
    bed = {"name": "bed", "box": [[0.0, 0.0], [0.8, top]], "porosity": 0.45, "resistance": {"a": 1e5, "b": 0.0}}
    sim = simulation(
        {
            "case": {"name": "stream-over-a-bed"},
            "domain": {"size": [0.8, 0.3], "spacing": 0.02, "walls": {"x": "periodic"}},
            "fluid": {"viscosity": 0.0},
            "water": [{"box": [[0, top], [0.8, 0.247]], "velocity": [0.2, 0.0]}, {"box": [[0, 0], [0.8, top]]}],
            "porous": [bed],
            "flux": [{"x": 0.41}],
            "time": {"end": 0.2},
        }
    )
    sim.advance(0.2)
    assert sim.sample()["discharge"][0] == pytest.approx(0.2 * (0.247 - top), rel=0.01)
    over, under = velocity_at(sim.flow, np.array([[0.41, top + 0.004], [0.41, top - 0.004]]))[:, 0]
    assert over == pytest.approx(0.2, rel=0.01) and abs(under) < 1e-3


def test_a_closed_tank_with_a_slab_off_the_lines_around_a_periodic_axis_converges():
    """No surface: what flows out at one end of the axis must flow in at the other, to round-off."""
    free = {"a": 0.0, "b": 0.0}
    sim = simulation(
        {
            "case": {"name": "closed"},
            "domain": {"size": [1.0, 0.05, 0.05], "spacing": 0.025, "walls": {"x": "periodic", "y": "periodic"}},
            "fluid": {"gravity": 0.0, "viscosity": 0.0},
            "water": [{"box": [[0, 0, 0], [1.0, 0.05, 0.05]], "velocity": [0.2, 0.1, 0.0]}],
            "porous": [{"box": [[0.411, 0, 0], [0.811, 0.05, 0.05]], "porosity": 0.8, "resistance": free}],
            "time": {"end": 0.5},
        }
    )
    run(sim, 20)
    assert abs(sim.volume_drift) < 1e-12


def test_the_ends_of_a_periodic_axis_are_one_face_also_where_pores_meet_there():
    """A dam break splashes through the joined ends: what is carried into the air there is limited alike on both."""
    sim = simulation(
        {
            "case": {"name": "joined"},
            "domain": {"size": [1.0, 0.5], "spacing": 0.05, "walls": {"x": "periodic"}},
            "water": [{"box": [[0.5, 0.0], [1.0, 0.3]]}, {"box": [[0.0, 0.0], [0.4, 0.1]]}],
            "porous": [{"box": [[0.0, 0.0], [0.4, 0.5]], "porosity": 0.45, "resistance": {"a": 9.0, "b": 3.0}}],
            "time": {"end": 1.0},
        }
    )
    while sim.time < 1.0:
        sim.advance(1.0)
        np.testing.assert_array_equal(sim.flow.velocity[0][0], sim.flow.velocity[0][-1])


@pytest.mark.parametrize("transfer", ["fmpm", "flip"])
def test_no_water_passes_the_floor_under_a_front_off_the_lines(transfer):
    """The faces on the floor are closed, whatever media would share them."""
    sim = simulation(
        {
            "case": {"name": "floor"},
            "domain": {"size": [1.0, 0.4], "spacing": 0.02},
            "water": [{"polygon": [[0.0, 0.0], [1.0, 0.0], [1.0, 0.2], [0.0, 0.3]]}],
            "porous": [{"box": [[0.407, 0.0], [0.69, 0.4]], "porosity": 0.45, "resistance": {"a": 50.0, "b": 0.0}}],
            "time": {"end": 0.3},
        },
        numerics__transfer=transfer,
    )
    while sim.time < 0.3:
        sim.advance(0.3)
        assert np.abs(sim.flow.velocity[1][:, 0]).max() == 0.0
