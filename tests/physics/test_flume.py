"""Waves in an empty flume, as the makers send them and the sponges take them up; 0.25 m deep, eight cells."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from situations import simulation

from houle.analysis import harmonics
from houle.boundary.sponge import LEFT_OVER, damping

DEPTH, PERIOD, SPACING = 0.25, 1.2, 0.03125
OMEGA = 2 * np.pi / PERIOD


def flume(size, waves, *sponges):
    return simulation(
        {
            "case": {"name": "flume"},
            "domain": {"size": [size, 0.34375], "spacing": SPACING},
            "water": [{"below": DEPTH}],
            "waves": {"kind": "regular", "period": PERIOD, "depth": DEPTH, **waves},
            "sponge": [{"box": [[a, 0.0], [b, 0.34375]]} for a, b in sponges],
            "time": {"end": 100.0},
        }
    )


def levels(sim, duration):
    """Times and elevations of all columns over the last two periods before `duration` [s]."""
    times, rows = [], []
    while sim.time < duration:
        sim.advance(min(duration, sim.time + 0.04))
        if sim.time > duration - 2 * PERIOD:
            times.append(sim.time)
            rows.append(sim.flow.eta - DEPTH)
    return np.array(times), np.array(rows)


@cache
def source(side):
    """Complex amplitude of the fundamental in every column, with the source in the middle of 8.3 m."""
    sim = flume(8.3, {"height": 0.02, "source": {"x": 4.15, "side": side}}, (0.0, 2.075), (6.225, 8.3))
    t, eta = levels(sim, 8 * PERIOD)
    return sim, sim.grid.axis_points(0), harmonics(t, eta.T, OMEGA)[..., 1]


def mean_amplitude(x, fundamental, low, high):
    """Over a length; half a wavelength, so that a reflected wave drops out to first order."""
    return np.abs(fundamental[(x > low) & (x < high)]).mean()


# 1.25 widths of the source on each side push: from 6.2 m on the wave runs free.
RIGHT, LEFT = (5.8, 6.6), (1.7, 2.5)


def test_a_source_sends_the_height_asked_for_to_both_sides():
    _, x, fundamental = source("both")
    right, left = (mean_amplitude(x, fundamental, *where) for where in (RIGHT, LEFT))
    assert right == pytest.approx(0.01, rel=0.02)
    assert left == pytest.approx(right, rel=0.01)


def test_the_crest_stands_where_linear_theory_has_it():
    """eta = a cos(k x - omega t) at the source, to both sides of it."""
    sim, x, fundamental = source("both")
    assert sim.wave is not None
    right = (x > RIGHT[0]) & (x < RIGHT[1])
    behind = np.angle(fundamental[right] * np.exp(-1j * sim.wave.k * x[right]))
    assert np.abs(np.mean(np.exp(1j * behind))) > 0.999  # one wave, of that length
    assert abs(np.angle(np.mean(np.exp(1j * behind)))) < 0.15


def test_a_source_to_one_side_leaves_the_other_still():
    _, x, fundamental = source("right")
    right, left = (mean_amplitude(x, fundamental, *where) for where in (RIGHT, LEFT))
    assert right == pytest.approx(0.01, rel=0.03)
    assert left < 0.05 * right


def test_a_zone_sends_the_wave_of_the_theory():
    """H = 0.04 m, a cell and a quarter: the surface is that of the stream function to 3 % of the height."""
    sim = flume(7.0, {"height": 0.04, "zone": {"x": [0.0, 2.5]}}, (4.5, 7.0))
    t, eta = levels(sim, 9 * PERIOD)
    x = sim.grid.axis_points(0)
    free = (x > 2.7) & (x < 4.4)
    assert sim.wave is not None
    parts = sim.wave.components()
    exact = np.array([sim.wave.elevation(x[free], time) for time in t])
    assert np.sqrt(np.mean((eta[:, free] - exact) ** 2)) < 0.03 * 0.04
    fundamental = harmonics(t, eta[:, free].T, OMEGA)[..., 1]
    assert parts is not None
    assert np.abs(fundamental).mean() == pytest.approx(parts.amplitude[0], rel=0.02)


def test_sponges_take_what_the_source_gives():
    """Over a steady period: source = sponges + losses, and the losses are a few per cent of what goes through."""
    sim, _, _ = source("both")
    begin, end = budget(sim), sim.time + PERIOD
    while sim.time < end:
        sim.advance(end)
    gave, sponge, viscous, stored = budget(sim) - begin
    lost = gave - sponge - viscous - stored
    assert gave > 0 and abs(stored) < 0.05 * gave
    assert 0 < lost < 0.08 * gave  # on two paths of a wavelength and a half, eight cells deep


def budget(sim):
    """Work of the source, of the sponges, of viscosity; energy of the wave, as the series has them."""
    row = sim.sample()
    energy = row["kinetic_energy"] + row["potential_energy"]
    return np.array([row["source_work"], row["sponge_work"], row["viscous_work"], energy])


def test_potential_energy_of_waves_is_that_of_the_levels():
    """rho g (eta^2 - still^2)/2 per column, to round-off, above that of still water, where the packing is no matter."""
    sim, _, _ = source("both")
    eta = sim.flow.eta
    assert np.ptp(eta) > 0.01
    exact = 1000 * 9.81 * sim.grid.spacing[0] * (eta**2).sum() / 2
    assert sim.sample()["potential_energy"] == pytest.approx(exact, rel=1e-12)


def test_a_sponge_lets_one_per_cent_come_back():
    """sigma grows with the square of the way in; over the depth it takes sigma/2 from the amplitude, both ways."""
    speed, length = 1.13, 2.0
    x = np.linspace(0.0, length, 1001)
    rate = damping(speed, length) * (x / length) ** 2
    assert np.exp(-2 * np.trapezoid(rate / 2, x) / speed) == pytest.approx(LEFT_OVER, rel=1e-4)
