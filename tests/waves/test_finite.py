"""The force for waves of finite height: it ends with the source, and makes the wave of linear theory when it is low."""

import numpy as np
import pytest
from places import DEPTH, GRAVITY

from houle.waves.finite import FLAT, potential
from houle.waves.theories import regular
from houle.waves.wave import WaveError

BOTH, RIGHT = (True, True), (True, False)


def found(height, period, sides, degrees=0.0, width=1.0):
    wave = regular("fenton", height, period, DEPTH, GRAVITY, direction=np.radians(degrees))
    return wave, potential(wave, width * wave.length, sides)


def strength(force, x, length, low, high):
    """Largest harmonic of the force between two places, over the largest of all; places in wavelengths."""
    there = (x > low * length) & (x < high * length)
    return np.abs(force[:, there]).max() / np.abs(force).max()


@pytest.mark.parametrize("sides", [BOTH, RIGHT])
@pytest.mark.parametrize(("height", "period"), [(0.01, 1.0), (0.08, 1.2), (0.08, 2.0)])
def test_the_wave_of_theory_needs_no_force(height, period, sides):
    """Between where it has grown and where it is ended the flow is the stream function wave; beyond, water at rest.

    The force is what is left of Bernoulli's equation: any error of the flow, the current or the harmonics is seen.
    """
    wave, made = found(height, period, sides)
    assert strength(made.along, made.x, wave.length, 1.25, FLAT - 1.25) < 2e-4
    quiet = (-FLAT - 0.9, -FLAT - 1.25) if sides == BOTH else (-3.0, -1.25)
    assert strength(made.along, made.x, wave.length, min(quiet), max(quiet)) < 2e-4


@pytest.mark.parametrize("degrees", [0.0, 35.0])
@pytest.mark.parametrize("sides", [BOTH, RIGHT])
def test_a_low_wave_has_the_height_of_linear_theory(sides, degrees):
    """P of any shape sends waves of amplitude omega |p(k)| / (2 g c_g cos), p(k) its Fourier transform."""
    wave, made = found(1e-4, 1.2, sides, degrees)
    cos = np.cos(wave.direction)
    near = np.abs(made.x) < 1.3 * wave.length
    right, left = (
        np.trapezoid((made.value[1] * np.exp(sign * 1j * wave.k * cos * made.x))[near], made.x[near])
        for sign in (-1.0, 1.0)
    )
    made_right, made_left = (wave.omega * abs(p) / (2 * GRAVITY * wave.group_velocity * cos) for p in (right, left))
    assert made_right == pytest.approx(wave.height / 2, rel=2e-3)
    assert made_left == pytest.approx(wave.height / 2 if sides == BOTH else 0.0, rel=2e-3, abs=1e-3 * wave.height)


def test_harmonics_grow_as_their_power_of_the_height():
    """What the ramp relies on."""
    low, high = (found(height, 1.2, RIGHT)[1].along for height in (0.01, 0.02))
    sizes = np.abs(high[:3]).max(axis=1) / np.abs(low[:3]).max(axis=1)
    assert sizes == pytest.approx([4.0, 2.0, 4.0], rel=0.05)


def test_a_narrow_source_of_a_steep_wave_is_refused():
    with pytest.raises(WaveError, match=r"waves.source: .* form = \"linear\""):
        found(0.08, 1.2, RIGHT, width=0.4)
