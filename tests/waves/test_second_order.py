"""Sums of waves to second order: Stokes where two frequencies meet, Longuet-Higgins & Stewart where they nearly do."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from pydantic import ValidationError

from houle.case.tables.waves import Waves
from houle.case.wave import make
from houle.check.wave_theory import assess
from houle.check.wave_theory import bound as told
from houle.waves.dispersion import frequency, group_velocity, wave_number
from houle.waves.linear import Linear
from houle.waves.record import series
from houle.waves.second_order import Kernel, SecondOrder
from houle.waves.spectra import focused, irregular
from houle.waves.theories import regular
from houle.waves.wave import Components, WaveError

DEPTH, GRAVITY = 0.5, 9.81
DEPTHS = (0.5, 1.0, 2.0, 4.0)  # k d


def kernel(first, second, sign):
    return Kernel.of(np.array([first]), np.array([second]), DEPTH, GRAVITY, sign)


def group(size, periods=(1.4, 1.0), closed=True):
    """Two waves of amplitudes `size` and half of it [m], out of phase, and what is bound to them."""
    omega = 2 * pi / np.array(periods)
    k = wave_number(omega, DEPTH, GRAVITY)
    parts = Components(size * np.array([1.0, 0.5]), omega, k, np.array([0.3, 1.9]), np.zeros(2))
    return SecondOrder.of_linear(Linear.of("group", 3 * size, periods[0], DEPTH, GRAVITY, parts, 2 * size, 0.0), closed)


@pytest.mark.parametrize("kd", DEPTHS)
def test_the_sum_of_a_wave_with_itself_is_stokes_second_harmonic(kd):
    """E_2 = a^2 k cosh kd (2 + cosh 2kd) / (4 sinh^3 kd); u_2 = 3/4 a^2 omega k cosh 2kz / sinh^4 kd."""
    k = kd / DEPTH
    omega = float(frequency(k, DEPTH, GRAVITY))
    found = kernel(omega, omega, 1)
    assert found.level[0] == pytest.approx(k * np.cosh(kd) * (2 + np.cosh(2 * kd)) / (4 * np.sinh(kd) ** 3), rel=1e-12)
    z = np.array([0.0, 0.2, DEPTH])
    u = 0.75 * omega * k * np.cosh(2 * k * z) / np.sinh(kd) ** 4
    np.testing.assert_allclose(found.along(z, DEPTH)[:, 0], u, rtol=1e-11)


@pytest.mark.parametrize("kd", DEPTHS)
def test_the_difference_of_near_frequencies_is_the_set_down_of_longuet_higgins_and_stewart(kd):
    """eta = -S_xx / rho (g d - c_g^2) with S_xx = rho g a^2/2 (2 c_g/c - 1/2); its flux is c_g eta."""
    k = kd / DEPTH
    omega, speed = float(frequency(k, DEPTH, GRAVITY)), float(group_velocity(k, DEPTH, GRAVITY))
    wanted = -GRAVITY / 2 * (2 * speed * k / omega - 0.5) / (GRAVITY * DEPTH - speed**2)
    for apart, allowed in ((0.0, 1e-4), (3e-4, 1e-3)):
        found = kernel(omega * (1 + apart), omega * (1 - apart), -1)
        assert found.level[0] == pytest.approx(wanted, rel=allowed)
        below = found.speed[0] * DEPTH + GRAVITY * k / (2 * omega)  # of the pair, and what the crests carry
        assert below == pytest.approx(speed * wanted, rel=allowed)


def test_a_pair_is_the_same_in_either_order():
    for sign in (1, -1):
        one, other = kernel(5.0, 3.0, sign), kernel(3.0, 5.0, sign)
        assert one.level == pytest.approx(other.level, rel=1e-12)
        assert one.speed == pytest.approx(other.speed, rel=1e-12)
        assert sign * one.wave == pytest.approx(other.wave, rel=1e-12)


def test_one_component_is_the_stokes_wave_of_a_closed_flume():
    """Second order of `stokes-2` at the same wave number: its celerity differs at third order only."""
    stokes = regular("stokes-2", 0.01, 1.2, DEPTH)
    k = np.array([stokes.k])
    parts = Components(np.array([0.005]), frequency(k, DEPTH, GRAVITY), k, np.zeros(1), np.zeros(1))
    wave = SecondOrder.of_linear(
        Linear.of("one", 0.01, 2 * pi / parts.omega[0], DEPTH, GRAVITY, parts, 0.005, 0.0), True
    )
    x, z = np.linspace(0, stokes.length, 9), np.linspace(0, DEPTH - 0.01, 5)
    np.testing.assert_allclose(wave.elevation(x, 0.0), stokes.elevation(x, 0.0), atol=1e-7)
    for mine, known in zip(wave.velocity_on(x, z, 0.0), stokes.velocity_on(x, z, 0.0), strict=True):
        np.testing.assert_allclose(mine, known, atol=2e-6 * stokes.celerity)


def surface_errors(wave, x, t=0.4):
    """Largest error of the kinematic condition [m/s], and of Euler's equation along the surface [m/s2]."""
    h = 1e-4
    level = DEPTH + wave.elevation(x, t)
    u, w = wave.velocity(x, level, t)
    slope = (wave.elevation(x + h, t) - wave.elevation(x - h, t)) / (2 * h)
    rise = (wave.elevation(x, t + h) - wave.elevation(x, t - h)) / (2 * h)

    def derivative(dx, dz, dt):
        ahead, behind = (wave.velocity(x + s * dx, level + s * dz, t + s * dt) for s in (1, -1))
        return [(a - b) / (2 * h) for a, b in zip(ahead, behind, strict=True)]

    by_x, by_z, by_t = derivative(h, 0, 0), derivative(0, h, 0), derivative(0, 0, h)
    along, up = (by_t[i] + u * by_x[i] + w * by_z[i] for i in (0, 1))
    return np.abs(rise + u * slope - w).max(), np.abs(along + (up + GRAVITY) * slope).max()


@pytest.mark.parametrize("closed", [True, False])
def test_both_conditions_at_the_surface_fail_by_third_order_only(closed):
    """Half the steepness, an eighth of the error; of the linear waves alone it is a quarter."""
    x = np.linspace(0.0, 6.0, 241)
    steep, gentle = (surface_errors(group(a, closed=closed), x) for a in (0.008, 0.004))
    for one, half in zip(steep, gentle, strict=True):
        assert one / half == pytest.approx(8.0, rel=0.1)
    wave = group(0.004)
    linear = Linear.of("linear", 0.012, 1.4, DEPTH, GRAVITY, wave.parts, 0.008, 0.0)
    for mine, first in zip(gentle, surface_errors(linear, x), strict=True):
        assert mine < 0.2 * first


def test_the_flow_keeps_its_volume_has_no_curl_and_does_not_cross_the_bed():
    wave, h = group(0.02), 1e-4
    x, z = np.linspace(0, 3, 31)[:, None], np.linspace(0.01, 0.48, 9)
    by_x = [(a - b) / (2 * h) for a, b in zip(wave.velocity(x + h, z, 1.0), wave.velocity(x - h, z, 1.0), strict=True)]
    by_z = [(a - b) / (2 * h) for a, b in zip(wave.velocity(x, z + h, 1.0), wave.velocity(x, z - h, 1.0), strict=True)]
    size = np.abs(by_x[0]).max()
    assert np.abs(by_x[0] + by_z[1]).max() < 1e-6 * size
    assert np.abs(by_x[1] - by_z[0]).max() < 1e-6 * size
    assert np.abs(wave.velocity(x[:, 0], 0.0, 1.0)[1]).max() < 1e-12


def test_a_sea_has_its_level_and_pumps_nothing():
    """Over a common period of the two waves; without the return current half a litre a second would go."""
    for size in (0.01, 0.005):
        wave = group(size, periods=(1.5, 1.0))
        t = np.arange(0, 3, 0.025)
        assert abs(np.mean(wave.elevation(0.0, t))) < 1e-12
        mean = np.mean([wave.flux(0.0, v)[0] for v in t])
        pumped = float(np.sum(wave.parts.amplitude**2 * GRAVITY * wave.parts.k / (2 * wave.parts.omega)))
        assert abs(mean) < 0.05 * pumped * (size / 0.01) ** 0.9
    assert np.mean(group(0.01, (1.5, 1.0), closed=False).elevation(0.0, t)) < -1e-5  # the set-down of a passing group


def test_the_vectors_hold_all_pairs_of_a_sea():
    """Against the sums over all 200 x 200 pairs, at the surface and within the water."""
    wave = SecondOrder.of_linear(irregular("jonswap", 0.06, 2.0, DEPTH, GRAVITY), True)
    p, x, t = wave.pairs, np.linspace(0, 5, 20), 3.3
    theta = p.k * x[:, None] - p.omega * t + p.phase
    found = np.zeros((3, len(x)))
    for sign in (1, -1):
        pair = Kernel.of(p.omega[:, None], p.omega, DEPTH, GRAVITY, sign)
        size, turn = np.outer(p.amplitude, p.amplitude), theta[:, :, None] + sign * theta[:, None, :]
        found[0] += (size * pair.level * np.cos(turn)).sum((1, 2))
        found[1] += (size * pair.along(np.array([0.2]), DEPTH)[0] * np.cos(turn)).sum((1, 2))
        found[2] += (size * pair.up(np.array([0.2]), DEPTH)[0] * np.sin(turn)).sum((1, 2))
    linear = Linear.velocity(wave, x, 0.2, t)
    u, w = wave.velocity(x, 0.2, t)
    mine = wave.bound(x, t) + wave._still[0], u - linear[0] + wave._still[1], w - linear[1]
    for one, known in zip(mine, found, strict=True):
        np.testing.assert_allclose(one, known, atol=2e-5 * np.abs(known).max())
    for a, b in zip(wave.velocity_on(x, np.array([0.2]), t), (u, w), strict=True):
        np.testing.assert_allclose(a[:, 0], b, atol=1e-13)


@pytest.mark.parametrize("height", [0.06, 0.2])
def test_the_velocity_for_a_zone_is_the_velocity(height):
    """From the vectors in the whole, or with components apart that are too short for bound waves (at 0.2 m)."""
    wave = SecondOrder.of_linear(irregular("jonswap", height, 2.0, DEPTH, GRAVITY), True)
    assert (wave._others is None) == (height == 0.06)
    x, z = np.linspace(0, 4, 15), np.linspace(0.01, 0.7, 12)
    for t in (3.3, 4.4):
        u, w = wave.velocity_on(x, z, t)
        np.testing.assert_allclose(wave.along_on(x, z, t), u, atol=1e-5 * np.abs(u).max())
        np.testing.assert_array_equal(wave.up_on(x, z, t), w)


def test_the_sizes_of_the_bound_waves_are_those_of_a_long_record():
    wave = SecondOrder.of_linear(irregular("jonswap", 0.06, 2.0, DEPTH, GRAVITY), True)
    eta = wave.bound(0.0, np.arange(0, 3600, 0.1))
    assert 4 * eta.std() == pytest.approx(np.hypot(*wave.sizes), rel=0.05)
    slow = np.convolve(eta, np.ones(10) / 10, "valid")  # over a second, half the peak period
    assert 4 * slow.std() == pytest.approx(wave.sizes[1], rel=0.1)


def test_what_is_bound_in_a_record_is_not_sent_out_free():
    """The record of a group with its bound waves: order 2 finds the waves that the record without them is made of."""
    wave = SecondOrder.of_linear(focused(0.03, 1.6, DEPTH, GRAVITY, 0.0, 20.0), False)
    t = np.arange(0.0, 40.0, 0.05)
    eta, bound = wave.elevation(0.0, t), wave.bound(0.0, t)
    known = series(t, eta - bound, DEPTH, GRAVITY)
    first, second = (series(t, eta, DEPTH, GRAVITY, order=order) for order in (1, 2))
    np.testing.assert_allclose(second.elevation(0.0, t), eta, atol=3e-3 * eta.max())
    np.testing.assert_allclose(second.bound(0.0, t), bound, atol=0.01 * np.abs(bound).max())
    free = [w.parts.elevation(0.0, t) - known.parts.elevation(0.0, t) for w in (first, second)]
    assert free[0].std() > 0.9 * bound.std() and free[1].std() < 0.01 * bound.std()


def test_a_record_of_long_waves_is_refused_at_second_order():
    t = np.arange(0.0, 200.0, 0.25)
    eta = 0.15 * np.exp(-(((t - 100.0) / 20.0) ** 2)) * np.cos(2 * pi * t / 12.0)
    with pytest.raises(WaveError, match=r"waves\.order = 2: the bound waves of this record"):
        series(t, eta, DEPTH, GRAVITY, order=2)


def test_check_tells_what_first_order_costs_and_where_second_order_ends():
    sea = irregular("jonswap", 0.1, 1.6, 0.4, GRAVITY)
    assert "order = 1 makes free waves as high" in told(sea)
    second = SecondOrder.of_linear(sea, True)
    assert "19.0%" in told(second) and told(second).endswith("made with the waves")
    assert told(regular("airy", 0.01, 1.2, DEPTH)) == ""
    assert not [text for _, text in assess(second, 0.01) if "second order ends" in text]
    shallow = SecondOrder.of_linear(irregular("jonswap", 0.05, 3.0, 0.2, GRAVITY), True)
    ends = [text for level, text in assess(shallow, 0.01) if level == "warning" and "second order ends" in text]
    assert len(ends) == 1 and "kh = 0.304" in ends[0]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"kind": "regular"}, 'order does not belong to kind = "regular"'),
        ({"direction": 20.0, "source": {"x": 2.0}}, "order = 2: waves along x only"),
        ({"source": {"x": 2.0, "form": "linear"}}, r'order = 2: source\.form = "linear" makes linear waves'),
        ({"order": 3}, "1 or 2"),
    ],
)
def test_a_case_that_cannot_be_of_second_order_is_refused(more, words):
    table = {"kind": "jonswap", "height": 0.03, "period": 1.2, "depth": DEPTH, "order": 2}
    if "source" not in more:
        table["zone"] = {"x": [0.0, 4.0]}
    with pytest.raises(ValidationError, match=words):
        Waves.model_validate(table | more)


def test_the_kinds_of_a_case_take_their_order():
    table = {
        "height": 0.03,
        "period": 1.2,
        "depth": DEPTH,
        "zone": {"x": [0.0, 4.0]},
        "focus": {"x": 6.0, "time": 20.0},
    }
    for kind in ("jonswap", "tma", "pierson-moskowitz", "focused"):
        given = {k: v for k, v in table.items() if k != "focus" or kind == "focused"}
        first, second = (make(Waves.model_validate(given | {"kind": kind, "order": order})) for order in (1, 2))
        assert type(first) is Linear and isinstance(second, SecondOrder)
        assert second.closed == (kind != "focused")
        assert first.components().phase.tobytes() == second.components().phase.tobytes()  # the same sea
