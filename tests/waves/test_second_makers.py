"""Pistons and sources to second order: against one frequency, the volume of bound waves, and where sources end."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from houle.boundary.internal_source import PairSource, make_source
from houle.case.acting import source_of
from houle.case.tables.waves import Waves
from houle.case.wave import make
from houle.grid import Grid
from houle.waves.dispersion import group_velocity, wave_number
from houle.waves.piston import Reading, double_harmonic, modes, response
from houle.waves.second_order import Kernel, SecondOrder
from houle.waves.second_piston import pair_motion, transfer
from houle.waves.second_source import pair_force
from houle.waves.spectra import focused, irregular

DEPTH, GRAVITY = 0.5, 9.81
SEA = {"kind": "jonswap", "height": 0.06, "period": 2.0, "depth": DEPTH, "order": 2}


def reading(omega):
    return Reading(float(wave_number(omega, DEPTH, GRAVITY)), DEPTH, GRAVITY)


@pytest.mark.parametrize("period", [1.0, 1.5, 3.0])
def test_a_frequency_with_itself_is_the_double_harmonic_of_regular_waves(period):
    omega = 2 * pi / period
    known, _ = double_harmonic(omega, 1.0 + 0j, DEPTH, GRAVITY, reading(omega))
    velocity, _ = transfer(omega, omega, DEPTH, GRAVITY)
    assert velocity / (2j * omega) == pytest.approx(known, rel=1e-10)


def test_the_reading_of_a_pair_is_that_of_regular_waves_where_they_meet():
    """With the modes that it takes: 12 near the piston instead of 60."""
    omega = 2 * pi / 1.5
    read = reading(omega)
    known = double_harmonic(omega, 1.0 + 0j, DEPTH, GRAVITY, read, count=12)[1]
    assert transfer(omega, omega, DEPTH, GRAVITY, read)[1] == pytest.approx(known, rel=1e-10)


def test_the_order_of_a_pair_does_not_matter():
    for sign in (1, -1):
        one, other = (transfer(a, sign * b, DEPTH, GRAVITY)[0] for a, b in ((4.0, 2.9), (2.9, 4.0)))
        assert one == pytest.approx(other if sign > 0 else other.conjugate(), rel=1e-10)


@pytest.mark.parametrize("period", [1.2, 2.0])
def test_the_piston_gives_the_flux_of_the_set_down_under_long_groups(period):
    """Of near frequencies: the mean place of the wall gives way by what the bound wave carries, d X_2' = c_g eta_2."""
    omega, apart = 2 * pi / period, 1e-3
    first, second = omega * (1 + apart), omega * (1 - apart)
    k = modes(omega, DEPTH, GRAVITY)[0]
    size = float(response(np.array([k]), DEPTH)[0].real)  # elevation of the wave that 1 m of displacement sends out
    velocity = transfer(first, -second, DEPTH, GRAVITY)[0]
    level = Kernel.of(np.array([first]), np.array([second]), DEPTH, GRAVITY, -1).level[0] * size**2
    assert DEPTH * velocity.real == pytest.approx(float(group_velocity(k.real, DEPTH, GRAVITY)) * level, rel=0.01)


def test_a_piston_of_a_sea_follows_every_pair_and_does_not_wander():
    wave = SecondOrder.of_linear(irregular("jonswap", 0.06, 2.0, DEPTH, GRAVITY), True)
    motion = pair_motion(wave, 0.5, reading(pi), 4.0, False)
    size = motion.first.amplitude
    for i, j in ((3, 40), (60, 61), (150, 30)):
        for sign, kernel in zip((1, -1), motion.speed, strict=True):
            other = motion.phasors[j] if sign > 0 else motion.phasors[j].conj()
            pair = transfer(motion.omega[i], sign * motion.omega[j], DEPTH, GRAVITY)[0]
            pair *= size[i] * (size[j] if sign > 0 else size[j].conj())
            assert motion.phasors[i] @ kernel @ other == pytest.approx(pair, rel=1e-5)
    low, high = motion.reach
    assert high - low < 4 * (motion.first.reach[1] - motion.first.reach[0])
    far = np.cumsum([motion.way(float(t), 0.05, 0.0) for t in np.arange(0.0, 200.0, 0.05)])
    assert low - 0.02 < far.min() and far.max() < high + 0.02


def test_a_piston_rests_before_and_after_a_group_and_has_made_room_for_its_set_down():
    wave = SecondOrder.of_linear(focused(0.05, 2.0, DEPTH, GRAVITY, 0.0, 25.0), False)
    motion = pair_motion(wave, 0.0, reading(pi), 0.0, False)
    times = np.arange(0.0, 50.0, 0.05)
    velocity = motion.velocity(times)
    assert np.abs(velocity[times < 5.0]).max() < 0.03 * np.abs(velocity).max()
    volume = float(np.sum(wave.bound(0.0, times))) * 0.05  # the bound waves at the sums of frequencies hold none
    assert volume < 0
    assert float(np.sum(velocity)) * 0.05 * DEPTH == pytest.approx(wave.group_velocity * volume, rel=0.1)


@pytest.mark.parametrize("side", ["right", "left", "both"])
def test_a_source_pushes_nothing_outside_it(side):
    """The bound waves fulfil Bernoulli's equation to second order there: the force falls to a thousandth."""
    wave = SecondOrder.of_linear(irregular("jonswap", 0.06, 2.0, DEPTH, GRAVITY), True)
    width = 0.5 * wave.length
    x = np.linspace(-1.5 * wave.length, 1.5 * wave.length, 301)
    force = pair_force(wave, width, side, 0.0, x, 0.0)
    force.first[...] = 0.0  # second order alone
    size = np.sqrt(np.mean([force.at(t) ** 2 for t in np.arange(10.0, 60.0, 0.7)], axis=0))
    outside = np.abs(x) > 0.75 * width + 1.5 * DEPTH
    assert size[outside].max() < 1e-3 * size.max()


def test_a_source_keeps_the_water():
    """What leaves it to one side is taken from the heap in it: its volume, as much as the group carries."""
    wave = SecondOrder.of_linear(focused(0.05, 2.0, DEPTH, GRAVITY, 0.0, 25.0), False)
    force = pair_force(wave, 1.0, "right", 0.0, np.linspace(-2, 2, 41), 0.0)
    heap = np.array([force.heap_at(t) for t in (5.0, 45.0)])
    times = np.arange(5.0, 45.0, 0.05)
    slow = float(np.sum(wave.bound(0.0, times))) * 0.05  # sums of frequencies leave no volume
    assert heap[1] - heap[0] == pytest.approx(wave.group_velocity * slow, rel=0.1)


def test_the_source_of_a_case_is_of_second_order_and_pushes_along_x_alone():
    grid = Grid((160, 4, 8), (0.05, 0.1, 0.1), (False, True, False))
    table = Waves.model_validate(SEA | {"source": {"x": 4.0}})
    wave = make(table)
    maker = make_source(source_of(table, wave), table.kind, wave, grid, table.ramp_time())
    assert isinstance(maker, PairSource)
    force = grid.faces()
    maker.push(7.3, force)
    assert force[0].any() and not force[1].any() and not force[2].any()
    assert np.ptp(force[0], axis=(1, 2)).max() == 0.0
