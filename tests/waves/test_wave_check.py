"""What `houle check` says about a wave: the numbers, and every refusal with both numbers and the cure."""

import numpy as np
import pytest

from houle.check.wave_theory import assess
from houle.waves import limits
from houle.waves.cnoidal import cnoidal, solitary
from houle.waves.linear import airy
from houle.waves.record import series
from houle.waves.spectra import focused, irregular
from houle.waves.stokes import second_harmonic, stokes
from houle.waves.theories import regular

DEPTH, GRAVITY = 0.25, 9.81
GOOD = 0.005


def said(wave, spacing, level):
    return [text for kind, text in assess(wave, spacing) if kind == level]


def test_numbers_of_the_papers_wave():
    wave = regular("auto", 0.04, 1.2, DEPTH)
    text = "\n".join(said(wave, GOOD, "info"))
    assert wave.reason in text
    for number in ("kh = 0.942", "H/L = 0.024", "Ursell number 7.11", "L/dx = 333", "H/dx = 8", "25% of the lowest"):
        assert number in text, number
    assert not said(wave, GOOD, "error") and not said(wave, GOOD, "warning")


def test_limits_at_their_ends():
    """Deep water: Miche 0.142 L, Williams 0.141 L. Solitary: 0.833 d; the highest solitary wave is 0.8332 d (1974)."""
    assert limits.miche(1.0, 100.0) == pytest.approx(0.142)
    assert limits.williams(1.0, 100.0) == pytest.approx(0.141, abs=1e-3)
    assert limits.williams(1e6, 1.0) == pytest.approx(0.8332, abs=1e-3)
    assert limits.mccowan(2.0) == 1.56
    # Fenton's program prints H/d = 0.678 for L/d = 8 and 0.234 for L/d = 1.65
    assert limits.williams(8.0, 1.0) == pytest.approx(0.678, abs=5e-4)
    assert limits.williams(1.6526, 1.0) == pytest.approx(0.234, abs=5e-4)
    found = limits.limits(0.1, 2.0, 0.25)
    assert found.ursell == pytest.approx(25.6) and found.kh == pytest.approx(np.pi / 4)
    assert found.breaking == min(found.miche, found.mccowan, found.williams)
    assert found.share == pytest.approx(0.1 / found.breaking)


@pytest.mark.parametrize(
    ("wave", "spacing", "level", "words"),
    [
        (airy(0.2, 1.2, DEPTH, GRAVITY, 0, 0), GOOD, "error", ("H = 0.2 m", "0.1607 m", "give a height below")),
        (solitary(0.22, DEPTH, GRAVITY), GOOD, "error", ("0.22 m", "0.208", "give a height below")),
        (irregular("tma", 0.2, 1.2, DEPTH, GRAVITY), GOOD, "error", ("H = 0.2 m", "waves of this height break")),
        (focused(0.1, 1.2, DEPTH, GRAVITY, 0, 0), GOOD, "error", ("H = 0.2 m", "break")),
        (regular("fenton", 0.14, 1.2, DEPTH), GOOD, "warning", ("0.14 m", "crests may break")),
        (stokes(0.03, 2.2, DEPTH, GRAVITY, 0, 0, 3), GOOD / 2, "error", ("Ursell number", "above 20", "fenton")),
        (airy(0.05, 2.0, DEPTH, GRAVITY, 0, 0), GOOD, "warning", ("16.3% of its height", "3%", "auto")),
        (cnoidal(0.04, 1.2, DEPTH, GRAVITY, 0, 0), GOOD, "error", ("L/d = 6.66", "below 8", "fenton")),
        (cnoidal(0.11, 4.0, DEPTH, GRAVITY, 0, 0), GOOD, "warning", ("H/d = 0.44", "0.4", "fenton")),
        (solitary(0.15, DEPTH, GRAVITY), GOOD, "warning", ("H/d = 0.6", "0.5", "0.125 m")),
        (regular("auto", 0.04, 1.2, DEPTH), 0.1, "error", ("L/dx = 16.7", "below 20", "0.0833 m")),
        (regular("auto", 0.04, 1.2, DEPTH), 0.04, "warning", ("L/dx = 41.7", "below 50", "0.0333 m")),
        (regular("auto", 0.002, 1.2, DEPTH), 0.02, "warning", ("H/dx = 0.1", "below 0.2", "0.01 m")),
        (regular("auto", 0.11, 1.2, DEPTH), 0.03, "warning", ("harmonic 4", "of the first", "below 20")),
        (irregular("jonswap", 0.08, 1.2, DEPTH, GRAVITY), 0.02, "warning", ("of the energy", "domain.spacing")),
        (irregular("jonswap", 0.11, 2.5, DEPTH, GRAVITY), GOOD, "warning", ("H/d = 0.44", "0.4", "0.1 m")),
    ],
)  # fmt: skip
def test_what_is_doubtful_is_told_with_its_numbers(wave, spacing, level, words):
    found = said(wave, spacing, level)
    assert any(all(w in text for w in words) for text in found), assess(wave, spacing)


def test_second_harmonic_of_stokes():
    """H k cosh(kd) (2 + cosh 2kd) / (16 sinh^3 kd): Dean & Dalrymple (1991), section 11.2."""
    k, d, h = 2.1, 0.25, 0.05
    wanted = h * k * np.cosh(k * d) * (2 + np.cosh(2 * k * d)) / (16 * np.sinh(k * d) ** 3)
    assert second_harmonic(h, 2 * np.pi / k, d) == pytest.approx(wanted, rel=1e-12)


def test_just_inside_nothing_is_refused():
    for wave in (stokes(0.03, 2.0, DEPTH, GRAVITY, 0, 0, 3), airy(0.01, 1.2, DEPTH, GRAVITY, 0, 0)):
        assert not said(wave, 0.0025, "error") and not said(wave, 0.0025, "warning")


def test_what_was_measured_to_be_fine_is_left_in_peace():
    """H/dx = 0.33 came out within 1 % of the height, 40 mm at 20 mm within 0.9 %, 5 mm at 25 mm within 0.5 %."""
    for height, spacing in ((0.0066, 0.02), (0.04, 0.02), (0.005, 0.025)):
        assert not said(regular("auto", height, 1.2, DEPTH), spacing, "warning"), (height, spacing)


def test_secondary_waves_of_a_ship_are_not_lost_in_silence():
    """They hold little energy beside the drawdown, but the bank feels them."""
    t = np.arange(0, 120, 0.1)
    eta = -0.3 * np.exp(-(((t - 50) / 12) ** 2)) + 0.03 * np.sin(2 * np.pi * t / 1.5) * np.exp(-(((t - 85) / 12) ** 2))
    wave = series(t, eta, 3.0, GRAVITY)
    assert any("Hm0 = 0.0" in text for text in said(wave, 0.25, "warning"))
    assert not any("Hm0" in text for text in said(wave, 0.05, "warning"))
