"""A wall that moves through the grid: volume, waves, energy, absorption; and that it does not depend on the machine."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from situations import copy_state, differing, simulation

from houle import _core, load
from houle.boundary.paddle import Command, Paddle
from houle.case.build import build
from houle.errors import SimulationError
from houle.flow.simulation import Simulation
from houle.flow.start import prepare
from houle.waves.dispersion import group_velocity, wave_number

FLUME: dict[str, Any] = {
    "case": {"name": "flume"},
    "domain": {"size": [4.4, 0.6], "spacing": 0.04},
    "fluid": {"viscosity": 0.0},
    "water": [{"below": 0.4}],
    "waves": {"kind": "regular", "height": 0.06, "period": 1.6, "depth": 0.4, "piston": {"x": 0.4}},
    "time": {"end": 100.0},
}
ENDED = {**FLUME, "absorber": [{"x": 4.0}]}


class Push(Command):
    """Moves a paddle as told: displacement(t) [m]."""

    def __init__(self, displacement):
        self.displacement = displacement

    def way(self, tank, paddle, dt):
        return self.displacement(tank.time + dt) - self.displacement(tank.time)

    def notice(self, tank, paddle):
        pass


def pushed(displacement, water=1, **overrides):
    """A tank of 1.2 m, 0.25 m deep, with one paddle at 0.3 m from its left or right end."""
    tank = {
        "case": {"name": "tank"},
        "domain": {"size": [1.2, 0.4], "spacing": 0.025},
        "water": [{"below": 0.25}],
        "time": {"end": 100.0},
    }
    sim = simulation(tank, **overrides)
    sim.flow.enclose([Paddle("pushed", sim.grid, 0.3 if water > 0 else 0.9, water, Push(displacement))])
    sim.ledger.volume0 = sim.particles.total_volume
    prepare(sim.flow, sim.step.transfer, sim.ledger)
    return sim


def to(sim, end):
    while sim.time < end:
        sim.advance(end)
    return sim


def levels(sim):
    return sim.flow.eta[~np.isnan(sim.flow.eta)]


@pytest.mark.parametrize("water", [1, -1])
def test_a_slow_paddle_lifts_the_level_as_the_volume_says(water):
    """Over five cells, through every cut of a cell: volume to round-off, all water in front, level to 1 % of a cell."""
    sim = pushed(lambda t: water * 0.125 * (0.5 - 0.5 * np.cos(np.pi * min(t / 6.0, 1.0))), water)
    paddle, volume = sim.flow.boundaries[0], sim.particles.total_volume
    assert volume == pytest.approx(0.9 * 0.25, rel=1e-12)
    for end in (2.0, 4.0, 7.0):
        to(sim, end)
        assert abs(sim.particles.total_volume / volume - 1.0) < 1e-14
        assert (paddle.water * (sim.particles.position[:, 0] - paddle.x)).min() > 0.0
        room = 1.2 - paddle.x if water > 0 else paddle.x
        assert sim.sample()["mean_level"] == pytest.approx(volume / room, abs=0.05e-3)
        assert levels(sim).mean() == pytest.approx(volume / room, abs=0.25e-3)
        assert np.abs(levels(sim) - volume / room).max() < 2.5e-3
    assert paddle.x == pytest.approx(0.3 + 0.125 if water > 0 else 0.9 - 0.125)


def test_a_paddle_that_leaves_its_room_stops_the_run():
    sim = pushed(lambda t: -0.3 * t)
    with pytest.raises(SimulationError, match=r"pushed has gone 0.2\d* m from where it stands at rest, x = 0.3"):
        to(sim, 1.0)


def test_water_stays_at_rest_before_a_paddle_at_rest():
    sim = pushed(lambda t: 0.0, numerics__tolerance=1e-12)
    to(sim, 0.3)
    assert np.abs(sim.particles.velocity).max() < 1e-9
    assert np.abs(levels(sim) - 0.25).max() < 1e-9


def test_the_work_of_the_paddle_is_the_energy_of_the_water():
    """Water pushed to and fro: kinetic energy and that of the levels grow by what pressure times velocity gave."""
    sim = pushed(lambda t: 0.04 * np.sin(2 * np.pi * t / 1.5) * min(1.0, t / 1.5))
    paddle, h = sim.flow.boundaries[0], sim.grid.spacing[0]

    def energy():
        eta = np.nan_to_num(sim.flow.eta)
        raised = 0.5 * 1000.0 * 9.81 * h * np.sum(sim.flow.boundaries.column_share * eta**2)
        return float(sim.sample()["kinetic_energy"]) + raised

    first, kept = energy(), []
    for end in np.arange(0.25, 3.01, 0.25):
        to(sim, float(end))
        kept.append((energy() - first, float(sim.sample()["source_work"])))
    gained, work = np.array(kept).T
    assert np.abs(work).max() > 10.0
    assert np.abs(gained - work).max() < 0.03 * np.abs(work).max()
    assert paddle.velocity != 0.0


def first_harmonics(sim, periods, low, high):
    """Heights [m] of the waves to the right and to the left between two places, over so many periods from now."""
    period, depth = 1.6, 0.4
    omega = 2 * np.pi / period
    k = float(wave_number(omega, depth))
    x = sim.grid.axis_points(0)
    seen = (x > low) & (x < high)
    times, etas = [], []
    end = sim.time + periods * period
    while sim.time < end:
        sim.advance(end)
        times.append(sim.time)
        etas.append(sim.flow.eta[seen] - depth)
    t = np.array(times)[:, None]
    basis = [f(n * omega * t) for n in (1, 2) for f in (np.cos, np.sin)]
    found = np.linalg.lstsq(np.concatenate([np.ones_like(t), *basis], axis=1), np.array(etas), rcond=None)[0]
    modes = np.stack([np.exp(-1j * k * x[seen]), np.exp(1j * k * x[seen])], axis=1)
    return 2 * np.abs(np.linalg.lstsq(modes, found[1] - 1j * found[2], rcond=None)[0])


def test_the_piston_makes_the_height_that_is_asked_for_and_the_far_wall_takes_it_up():
    """On ten cells of depth: first harmonic to 2 % of theory's, reflection of the absorbing wall below 3 %."""
    sim = to(simulation(ENDED), 8.0)
    out, back = first_harmonics(sim, 2, 0.8, 3.6)
    assert out == pytest.approx(2 * sim.wave.components().amplitude[0], rel=0.02)
    assert back / out < 0.03
    assert abs(sim.flow.boundaries[1].x - 4.0) < 0.05  # it stays about its place


def test_a_piston_that_absorbs_holds_the_height_before_a_wall():
    """A closed end sends all back. An absorbing piston still sends out what is asked; the other one adds up."""
    heights = {}
    for absorb in (True, False):
        sim = to(
            simulation({**FLUME, "domain": {"size": [3.2, 0.6], "spacing": 0.04}}, waves__piston__absorb=absorb), 9.6
        )
        heights[absorb] = first_harmonics(sim, 1, 0.8, 2.8)[0]
    assert heights[True] == pytest.approx(0.06, rel=0.05)
    assert abs(heights[False] / 0.06 - 1.0) > 0.2


def test_a_solitary_wave_is_as_high_and_as_fast_as_theory():
    """Goring's motion: after some depths the crest is within 2 % of the height, its speed within 1 %.

    The place of the wave is the middle of what stands above half its height: the crest itself is as flat as a cell.
    """
    waves = {"kind": "solitary", "height": 0.08, "depth": 0.4, "piston": {"x": 0.4}}
    sim = simulation({**FLUME, "waves": waves, "domain": {"size": [8.8, 0.6], "spacing": 0.04}})
    crest, x = [], sim.grid.axis_points(0)
    for end in (3.4, 4.4):
        to(sim, end)
        eta = np.nan_to_num(sim.flow.eta - 0.4)
        top = int(np.argmax(eta))
        c = np.polyfit(x[top - 3 : top + 4], eta[top - 3 : top + 4], 2)
        upper = np.maximum(eta - 0.04, 0.0)
        crest.append((float(np.sum(upper * x) / np.sum(upper)), np.polyval(c, -c[1] / (2 * c[0]))))
    (x0, _), (x1, height) = crest
    assert height == pytest.approx(0.08, rel=0.02)
    assert x1 - x0 == pytest.approx(sim.wave.celerity * 1.0, rel=0.01)


def test_a_run_that_was_stopped_goes_on_to_the_last_bit():
    table = {**ENDED, "numerics": {"remesh_every": 5}}
    sim = to(simulation(table, waves__piston__absorb=True), 0.9)
    state = copy_state(sim)
    for _ in range(15):
        sim.advance(100.0)
    again = simulation(table, waves__piston__absorb=True)
    again.restore(state)
    for _ in range(15):
        again.advance(100.0)
    assert differing(copy_state(sim), copy_state(again)) == []
    assert sim.flow.boundaries[0].x != 0.4 and "flow/boundaries/1/command/memory" in state


def test_the_number_of_threads_changes_no_bit():
    states = []
    for threads in (1, 2):
        _core.set_threads(threads)
        sim = simulation({**ENDED, "numerics": {"remesh_every": 5}}, waves__piston__absorb=True)
        for _ in range(25):
            sim.advance(100.0)
        states.append(copy_state(sim))
    _core.set_threads(1)
    assert differing(*states) == []


def test_three_dimensions_give_what_two_give():
    """A slice of four cells, without the corrections of positions that settle to 1 %: the same levels across."""
    table = {**FLUME, "domain": {"size": [2.8, 0.6], "spacing": 0.04}, "numerics": {"correction": 0.0}}
    flat = to(simulation(table), 1.2)
    deep = to(simulation({**table, "domain": {"size": [2.8, 0.16, 0.6], "spacing": 0.04}}), 1.2)
    assert np.nanmax(np.abs(deep.flow.eta - flat.flow.eta[:, None])) < 1e-6
    assert deep.sample()["source_work"] == pytest.approx(0.16 * float(flat.sample()["source_work"]), rel=1e-4)


def test_what_a_wave_carries_arrives():
    """The piston's work over the periods before anything comes back is the energy flux of the wave, rho g H^2 c_g/8."""
    sim = simulation({**FLUME, "domain": {"size": [8.0, 0.6], "spacing": 0.04}}, waves__ramp=0.0)
    to(sim, 1.6)
    before = float(sim.sample()["source_work"])
    to(sim, 4.8)
    work = float(sim.sample()["source_work"]) - before
    k = float(wave_number(2 * np.pi / 1.6, 0.4))
    assert work == pytest.approx(9810.0 * 0.06**2 / 8 * float(group_velocity(k, 0.4)) * 3.2, rel=0.08)


# ---- a paddle moved from a file --------------------------------------------------------------------------------------


def from_file(folder, time, values, column="displacement_m", waves=None, **overrides):
    """The flume with a paddle that moves by these samples."""
    text = "\n".join(f"{float(t)!r},{float(v)!r}" for t, v in zip(time, values, strict=True))
    (folder / "paddle.csv").write_text(f"t_s,{column}\n{text}\n")
    table = {"kind": "paddle", "file": "paddle.csv", "depth": 0.4, "piston": {"x": 0.4}, **(waves or {})}
    (folder / "a.toml").write_text(load({**FLUME, "waves": table}).to_toml())
    return Simulation(build(load(folder / "a.toml", overrides)))


UNEVEN = np.cumsum(np.random.default_rng(2).uniform(0.02, 0.15, 60))


def test_the_wall_stands_where_the_file_says_at_each_sample_and_no_water_is_lost(tmp_path):
    way = 0.06 * (1 + np.tanh(3.0 * (UNEVEN - 1.2))) - 0.07 + 1e-4 * np.random.default_rng(4).standard_normal(60)
    sim = from_file(tmp_path, UNEVEN, way)
    volume = sim.particles.total_volume
    for t, x in zip(UNEVEN[:24], way[:24], strict=True):
        to(sim, float(t))
        assert sim.time == t
        assert sim.flow.boundaries[0].x - 0.4 == pytest.approx(x - way[0], abs=1e-15)
        assert abs(sim.particles.total_volume / volume - 1.0) < 1e-14
    assert sim.flow.boundaries[0].x > 0.5  # it has gone through cells


def test_samples_of_the_motion_for_a_solitary_wave_make_that_wave(tmp_path):
    """Twice as many of them: sixteen times nearer to the run that goes by the law itself."""
    waves = {"kind": "solitary", "height": 0.08, "depth": 0.4, "piston": {"x": 0.4}}
    table = {**FLUME, "time": {"end": 3.0, "step": 0.005}}
    law = simulation(table, waves=waves)
    motion = law.flow.boundaries[0].command.law
    offsets = [0.0]
    for i in range(3000):
        offsets.append(offsets[-1] + motion.way(0.001 * i, 0.001, offsets[-1]))
    to(law, 2.4)
    off = []
    for every in (160, 80):
        folder = tmp_path / str(every)
        folder.mkdir()
        sim = from_file(folder, 0.001 * np.arange(0, 3001, every), offsets[::every], **{"time.step": 0.005})
        to(sim, 2.4)
        off.append(np.nanmax(np.abs(sim.flow.eta - law.flow.eta)))
        assert sim.flow.boundaries[0].x == pytest.approx(law.flow.boundaries[0].x, abs=2e-5)
    assert np.nanmax(law.flow.eta) > 0.47
    assert off[0] < 4e-5 and off[1] < off[0] / 10  # m; a spline of fourth order


def test_a_run_with_a_file_that_was_stopped_goes_on_to_the_last_bit(tmp_path):
    t = np.arange(0.0, 3.0, 0.05)
    for column, duration in (("displacement_m", 0.0), ("velocity_m_s", 1.0)):
        values = 0.05 * np.sin(2 * np.pi * t / 1.6) + 0.03
        sim = to(from_file(tmp_path, t, values, column, {"ramp": duration}), 0.9)
        state = copy_state(sim)
        for _ in range(15):
            sim.advance(100.0)
        again = from_file(tmp_path, t, values, column, {"ramp": duration})
        again.restore(state)
        for _ in range(15):
            again.advance(100.0)
        assert differing(copy_state(sim), copy_state(again)) == []
        assert sim.flow.boundaries[0].x != 0.4


def test_with_a_file_the_number_of_threads_changes_no_bit(tmp_path):
    t, states = np.arange(0.0, 3.0, 0.05), []
    for threads in (1, 2):
        _core.set_threads(threads)
        sim = from_file(tmp_path, t, 0.05 * np.sin(2 * np.pi * t / 1.6), waves={"ramp": 0.4})
        for _ in range(25):
            sim.advance(100.0)
        states.append(copy_state(sim))
    _core.set_threads(1)
    assert differing(*states) == []
