"""Open sides: channels, rivers, levels, waves that leave; water in and out to the last digit; 0.25 m deep."""

from __future__ import annotations

import numpy as np
import pytest
from situations import copy_state, differing, run, simulation

from houle import _core
from houle.waves.dispersion import wave_number

DEPTH, SPEED = 0.25, 0.3
LONG = np.sqrt(9.81 * DEPTH)  # m/s


def channel(left, right, *, size=2.0, spacing=0.025, velocity=SPEED, scheme="houle", water=None, **tables):
    return simulation(
        {
            "case": {"name": "channel"},
            "domain": {"size": [size, 0.4], "spacing": spacing},
            "water": water or [{"below": DEPTH, "velocity": [velocity, 0.0]}],
            "open": [{"side": "left", **left}, {"side": "right", **right}],
            "numerics": {"scheme": scheme},
            "time": {"end": 100.0},
            **tables,
        }
    )


def advance(sim, until):
    while sim.time < until:
        sim.advance(until)
    return sim


def kept(sim):
    """Volume that is there and should not be, over what there was and came."""
    ledger = sim.ledger
    there = ledger.volume0 + ledger.inflow - ledger.outflow
    return abs(sim.particles.total_volume - there) / (ledger.volume0 + ledger.inflow)


def test_a_uniform_river_stays_uniform():
    """A discharge comes in, the level holds it back: three seconds, half a tank of new water."""
    sim = advance(channel({"discharge": SPEED * DEPTH}, {"level": DEPTH}), 3.0)
    inner = slice(4, -4)
    assert sim.ledger.inflow == pytest.approx(SPEED * DEPTH * sim.time, rel=1e-9)
    assert sim.ledger.outflow == pytest.approx(sim.ledger.inflow, rel=0.01)
    assert np.abs(sim.flow.eta[inner] - DEPTH).max() < 0.005 * DEPTH
    x = sim.particles.position[:, 0]
    inside = (x > 0.2) & (x < 1.8)
    assert sim.particles.velocity[inside, 0].mean() == pytest.approx(SPEED, rel=0.01)
    assert kept(sim) < 1e-14


def test_a_sheared_river_leaves_as_it_came():
    """Velocity linear over the depth, from 0.1 to 0.5 m/s: a side that let water out at 0.3 m/s all over the depth
    would make it pile up, and the level inside fall by the mean of u'^2 / g, 1.4 mm, and more while it starts.
    """
    shear, layers = 0.4, 10
    speeds = SPEED + shear * ((np.arange(layers) + 0.5) / layers - 0.5)
    edges = np.linspace(0.0, DEPTH, layers + 1)
    water = [
        {"box": [[0.0, low], [2.0, high]], "velocity": [float(u), 0.0]}
        for low, high, u in zip(edges[:-1], edges[1:], speeds, strict=True)
    ]
    sim = advance(channel({"velocity": SPEED}, {"level": DEPTH}, water=water), 0.6)
    fall = shear**2 / 12 / 9.81
    undisturbed = slice(40, 76)  # from 1.0 m, where the uniform water from the left has not come to, to 1.9 m
    assert np.abs(sim.flow.eta[undisturbed] - DEPTH).max() < fall / 3
    assert -sim.flow.boundaries[1].speed[:layers] == pytest.approx(speeds, abs=0.05 * shear)


@pytest.mark.parametrize("scheme", ["houle", "jh2020"])
def test_what_comes_in_less_what_goes_out_is_what_is_there(scheme):
    """More comes in than goes out; also with the paper's sequence."""
    sim = channel({"velocity": 0.5}, {"velocity": -0.2}, velocity=0.0, scheme=scheme)
    sim.step.remeshing.every = 10**9  # the paper's remeshing makes water
    run(sim, 40)
    assert sim.ledger.inflow > 1.5 * sim.ledger.outflow > 0
    assert kept(sim) < 1e-14


def test_apic_carries_its_gradients_along():
    sim = channel({"velocity": 0.5}, {"velocity": -0.5}, velocity=0.5, numerics={"transfer": "apic"})
    run(sim, 30)
    assert len(sim.particles["affine"]) == len(sim.particles)
    assert kept(sim) < 1e-14


def test_water_at_rest_between_two_levels_rests():
    sim = channel({"level": DEPTH}, {"level": DEPTH}, velocity=0.0)
    before = len(sim.particles)
    run(sim, 40)
    assert np.abs(sim.particles.velocity).max() < 1e-6
    assert len(sim.particles) == before
    assert sim.ledger.inflow + sim.ledger.outflow < 1e-8


def test_a_tank_fills_to_the_level_outside_as_its_two_laws_say():
    """l e'' + c e' + c/T e = 0 for e = eta - level; critically damped for T = 4 l/c: e = -E (1 - r t) exp(-r t)."""
    step, rate = 0.02, 0.5 * LONG / 1.0
    sim = advance(channel({"level": DEPTH + step}, {"velocity": 0.0}, size=1.0, velocity=0.0), 6.0)
    left = -step * (1.0 - rate * sim.time) * np.exp(-rate * sim.time)
    assert sim.flow.eta.mean() - DEPTH - step == pytest.approx(left, abs=4e-4)
    assert kept(sim) < 1e-14


def test_a_long_wave_leaves():
    """A hump 20 mm high splits into two waves that leave; what comes back of each is below 4 %."""
    x = np.linspace(0.0, 4.0, 81)
    top = DEPTH + 0.02 * np.exp(-(((x - 2.0) / 0.5) ** 2))
    hump = {"polygon": [[0.0, 0.0], [4.0, 0.0], *np.stack([x, top], axis=-1)[::-1].tolist()]}
    side = {"level": DEPTH, "velocity": 0.0}
    sim = channel(side, side, size=4.0, water=[hump])
    passing = 0.0
    while sim.time < 1.5 * 4.0 / LONG:
        sim.advance(10.0)
        if 0.6 < sim.time < 1.0:
            passing = max(passing, float(np.nanmax(sim.flow.eta[20:140]) - DEPTH))
    assert passing > 0.008
    assert np.abs(sim.flow.eta[4:-4] - DEPTH).max() < 0.08 * passing
    assert kept(sim) < 1e-14


def test_a_record_of_levels_is_followed(tmp_path):
    """A slow tide at the left side; the far side is a wall."""
    (tmp_path / "tide.csv").write_text("# metres\nt_s,level_m\n0,0.25\n2,0.25\n8,0.22\n20,0.22\n")
    case = {
        "case": {"name": "tide"},
        "domain": {"size": [1.0, 0.4], "spacing": 0.025},
        "water": [{"below": DEPTH}],
        "open": [{"side": "left", "file": str(tmp_path / "tide.csv")}],
        "time": {"end": 20.0},
    }
    sim = advance(simulation(case), 12.0)
    assert sim.flow.eta[4:-4].mean() == pytest.approx(0.22, abs=2e-3)
    assert sim.ledger.outflow - sim.ledger.inflow == pytest.approx(1.0 * 0.03, rel=0.06)


def test_three_dimensions_are_two_where_nothing_changes_across():
    sims = [
        simulation(
            {
                "case": {"name": "channel"},
                "domain": {"size": size, "spacing": 0.05},
                "water": [{"below": DEPTH, "velocity": [SPEED, *([0.0] * (len(size) - 1))]}],
                "open": [{"side": "left", "velocity": SPEED}, {"side": "right", "level": DEPTH}],
                "time": {"end": 10.0, "step": 0.01},
            }
        )
        for size in ([1.0, 0.4], [1.0, 0.15, 0.4])
    ]
    flat, deep = (run(sim, 25) for sim in sims)
    assert deep.ledger.inflow == pytest.approx(0.15 * flat.ledger.inflow, rel=1e-6)
    assert deep.ledger.outflow == pytest.approx(0.15 * flat.ledger.outflow, rel=1e-6)
    assert deep.flow.eta == pytest.approx(np.repeat(flat.flow.eta[:, None], 3, axis=1), abs=1e-6)


def test_going_on_from_a_state_gives_the_same_bits():
    make = [channel({"discharge": 0.1}, {"level": 0.24}, velocity=0.0) for _ in range(2)]
    one, other = make
    run(one, 33)
    other.restore(copy_state(one))
    run(one, 20)
    run(other, 20)
    assert differing(copy_state(one), copy_state(other)) == []


def test_two_threads_give_the_same_bits():
    states = []
    for threads in (1, 2):
        _core.set_threads(threads)
        states.append(copy_state(run(channel({"velocity": 0.5}, {"level": DEPTH}, size=0.6), 8)))
    _core.set_threads(1)
    assert differing(*states) == []


def test_dupuit_discharge_through_a_dyke():
    """q = K (h1^2 - h2^2) / (2 L) between two levels, whatever the shape of the surface inside (Charny 1951)."""
    h1, h2, length, permeability = 0.35, 0.15, 0.4, 0.1
    top = [[1.0, h2], [0.7, h2], [0.3, h1], [0.0, h1]]
    sim = simulation(
        {
            "case": {"name": "dyke"},
            "domain": {"size": [1.0, 0.425], "spacing": 0.025},
            "water": [{"polygon": [[0.0, 0.0], [1.0, 0.0], *top]}],
            "porous": [
                {
                    "box": [[0.3, 0.0], [0.7, 0.425]],
                    "porosity": 0.4,
                    "resistance": {"a": 9.81 / permeability, "b": 0.0},
                }
            ],
            "open": [{"side": "left", "level": h1}, {"side": "right", "level": h2}],
            "time": {"end": 10.0},
        }
    )
    advance(sim, 6.0)
    before, since = (sim.ledger.inflow, sim.ledger.outflow), sim.time
    advance(sim, 8.0)
    exact = permeability * (h1**2 - h2**2) / (2 * length)
    came = (sim.ledger.inflow - before[0]) / (sim.time - since)
    went = (sim.ledger.outflow - before[1]) / (sim.time - since)
    assert came == pytest.approx(exact, rel=0.03)
    assert went == pytest.approx(exact, rel=0.03)


def test_a_wave_on_a_current_has_the_length_that_doppler_gives_it():
    """A following current of 0.2 m/s makes a wave of 1.2 s 18 % longer; neither zone nor sponge slows the water."""
    period, current, omega = 1.2, 0.2, 2 * np.pi / 1.2
    zone, free, size = 2.3, 2.6, 7.2
    side = {"level": DEPTH}
    sim = channel(
        {"velocity": current, **side},
        {"velocity": -current, **side},
        size=size,
        spacing=0.04,
        velocity=current,
        waves={
            "kind": "regular", "height": 0.02, "period": period, "depth": DEPTH, "current": current,
            "zone": {"x": [0.0, zone]},
        },
        sponge=[{"box": [[zone + free, 0.0], [size, 0.4]]}],
    )  # fmt: skip
    end, times, rows = 6.5 * period, [], []
    while sim.time < end:
        sim.advance(min(end, sim.time + 0.04))
        if sim.time > end - period:
            times.append(sim.time)
            rows.append(sim.flow.eta - DEPTH)
    x = sim.grid.axis_points(0)
    inside = (x > zone + 0.2) & (x < zone + free - 0.2)
    basis = np.stack([np.cos(omega * np.array(times)), np.sin(omega * np.array(times)), np.ones(len(times))], axis=1)
    cos, sin = np.linalg.lstsq(basis, np.array(rows)[:, inside], rcond=None)[0][:2]
    k = abs(np.polyfit(x[inside], np.unwrap(np.arctan2(sin, cos)), 1)[0])
    expected = float(wave_number(omega, DEPTH, current=current))
    assert k == pytest.approx(expected, rel=0.015)
    assert float(wave_number(omega, DEPTH)) > 1.15 * expected
    assert np.hypot(cos, sin).mean() == pytest.approx(0.01, rel=0.05)
    speed, place = sim.particles.velocity[:, 0], sim.particles.position[:, 0]
    for low, high in ((zone, zone + free), (zone + free, size)):
        assert speed[(place > low) & (place < high)].mean() == pytest.approx(current, rel=0.05)
    assert kept(sim) < 1e-14


def test_a_zone_at_an_open_side_carries_the_volume_of_a_long_wave(tmp_path):
    """A trough of 10 mm and 6 s doubles at the wall, and goes out again: the water is back, and level."""
    time = np.arange(0.0, 6.01, 0.1)
    rows = "\n".join(f"{t:.1f},{-0.005 * (1 - np.cos(2 * np.pi * t / 6)):.6f}" for t in time)
    (tmp_path / "trough.csv").write_text(f"t_s,eta_m\n{rows}\n")
    case = {
        "case": {"name": "trough"},
        "domain": {"size": [4.0, 0.4], "spacing": 0.05},
        "water": [{"below": DEPTH}],
        "waves": {
            "kind": "series",
            "file": str(tmp_path / "trough.csv"),
            "depth": DEPTH,
            "zone": {"x": [0.0, 1.5]},
        },
        "open": [{"side": "left", "level": DEPTH, "velocity": 0.0}],
        "time": {"end": 20.0},
    }
    sim = simulation(case)
    lowest = 0.0
    while sim.time < 14.0:
        sim.advance(14.0)
        lowest = min(lowest, float(sim.flow.eta[-10:].mean()) - DEPTH)
    assert lowest == pytest.approx(-0.020, rel=0.08)  # at a wall the zone reaches -0.016 and heaps up 0.06 behind it
    assert np.abs(sim.flow.eta[4:] - DEPTH).max() < 0.001
    assert sim.ledger.outflow > 0.02 and sim.ledger.inflow == pytest.approx(sim.ledger.outflow, rel=0.05)
    other = simulation(case)
    other.restore(copy_state(sim))
    assert differing(copy_state(run(sim, 3)), copy_state(run(other, 3))) == []


def test_a_zone_for_a_long_wave_may_fill_the_tank():
    """What comes back to it is read in the last columns then."""
    sim = simulation(
        {
            "case": {"name": "all-zone"},
            "domain": {"size": [4.0, 0.4], "spacing": 0.05},
            "water": [{"below": DEPTH}],
            "waves": {"kind": "solitary", "height": 0.02, "depth": DEPTH, "zone": {"x": [0.0, 3.99]}},
            "open": [{"side": "left", "level": DEPTH}],
            "time": {"end": 1.0},
        }
    )
    run(sim, 20)
    assert abs(sim.flow.boundaries[0].outgoing) < 1e-3
    assert np.abs(sim.flow.eta - DEPTH).max() < 0.02
