"""Every regular theory: height, speed, no divergence, no transport, errors at the surface of the right order."""

import numpy as np
import pytest
from places import DEPTH, GRAVITY, PLACES, surface_errors
from raschii import FentonWave
from scipy.optimize import brentq

from houle.waves import limits, theories
from houle.waves.fenton import NotConverged, fenton
from houle.waves.stokes import stokes
from houle.waves.theories import regular
from houle.waves.wave import KINDS, THEORIES, WaveError, ramp

X = np.linspace(-1.3, 2.1, 41)
STOKES = ("stokes-2", "stokes-3", "stokes-4", "stokes-5")


def test_height_crest_and_mean_level(wave):
    x = np.linspace(0, wave.length, 4000, endpoint=False)
    eta = wave.elevation(x, 0.0)
    assert np.argmax(eta) == 0 and eta[0] == pytest.approx(wave.crest, rel=1e-12)
    if wave.name.startswith("solitary"):
        assert eta[0] == pytest.approx(wave.height, rel=1e-14)
        return
    assert np.ptp(eta) == pytest.approx(wave.height, rel=1e-6 if wave.name != "stokes-2" else 2e-2)
    assert eta.mean() == pytest.approx(0, abs=1e-15)
    assert wave.elevation(x + wave.length, 0.0) == pytest.approx(eta, abs=1e-12)


def test_crest_moves_with_the_celerity(wave):
    assert wave.celerity == pytest.approx(wave.length / wave.period, rel=1e-12)
    np.testing.assert_allclose(wave.elevation(X + wave.celerity * 0.37, 0.37), wave.elevation(X, 0.0), atol=1e-13)
    for t in (0.0, 0.9):
        u0, w0 = wave.velocity(X, 0.2, t)
        u1, w1 = wave.velocity(X + wave.celerity * 0.37, 0.2, t + 0.37)
        np.testing.assert_allclose(u1, u0, atol=1e-12)
        np.testing.assert_allclose(w1, w0, atol=1e-12)


@pytest.mark.parametrize("theory", PLACES)
def test_phase_shifts_the_crest(theory):
    wave = regular(theory, *PLACES[theory], DEPTH)
    later = regular(theory, *PLACES[theory], DEPTH, phase=-wave.k * 0.3)
    np.testing.assert_allclose(later.elevation(X + 0.3, 0.0), wave.elevation(X, 0.0), atol=1e-13)
    for a, b in zip(later.velocity(X + 0.3, 0.2, 0.0), wave.velocity(X, 0.2, 0.0), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-13)
    parts = later.components()
    np.testing.assert_allclose(parts.elevation(X, 0.6), later.elevation(X, 0.6), atol=1e-9 * wave.height)


def gradients(wave, x, z, h=1e-4):
    (ux, wx), (uz, wz) = (
        [(a - b) / (2 * h) for a, b in zip(wave.velocity(*p, 0.1), wave.velocity(*q, 0.1), strict=True)]
        for p, q in (((x + h, z), (x - h, z)), ((x, z + h), (x, z - h)))
    )
    return ux, wx, uz, wz


def test_water_is_not_compressed(wave):
    """Divergence by central differences: what is left is their own error, h^2 of the third derivatives."""
    z = np.linspace(0.01, 0.9 * (DEPTH - wave.height), 9)
    coarse, fine = (np.abs(g[0] + g[3]).max() for g in (gradients(wave, X[:, None], z, h) for h in (2e-3, 1e-3)))
    scale = np.abs(gradients(wave, X[:, None], z)[0]).max()
    assert fine < 1e-3 * scale
    assert fine < coarse / 3.5 or fine < 1e-9 * scale


def test_water_does_not_rotate(wave):
    """Series of Laplace's equation: exactly. Cnoidal and solitary: to their order."""
    z = np.linspace(0.01, 0.9 * (DEPTH - wave.height), 9)
    ux, wx, uz, _ = gradients(wave, X[:, None], z)
    limit = 0.02 if wave.name.startswith(("cnoidal", "solitary")) else 1e-5
    assert np.abs(wx - uz).max() < limit * np.abs(ux).max()


def test_bed_is_tight(wave):
    assert np.abs(wave.velocity(X, 0.0, 0.2)[1]).max() == 0


def test_no_water_is_pumped(wave):
    """Time mean of the integral of u from bed to surface, in a closed flume; a solitary wave carries its own volume."""
    if wave.name == "airy":
        pytest.skip("linear: the transport is of second order, and not taken out")
    if wave.name.startswith("solitary"):
        x = np.linspace(-12, 12, 4001)
        volume = wave.elevation(x, 0.0).sum() * (x[1] - x[0])
        third = 1.5 * (wave.height / wave.depth) ** 3  # the order of what is left out
        assert wave.flux(0.0, 0.0)[0] == pytest.approx(wave.celerity * wave.height, rel=third)
        transport = wave.flux(x, 0.0).sum() * (x[1] - x[0]) / wave.celerity
        assert transport == pytest.approx(volume, rel=third)
        return
    times = np.arange(240) * wave.period / 240
    mean = np.mean([wave.flux(0.7, t)[0] for t in times])
    assert abs(mean) < 1e-12 * wave.celerity * wave.height


def test_above_the_crest_the_velocity_is_that_of_the_crest(wave):
    top = DEPTH + wave.crest
    for a, b in zip(wave.velocity(X, top + 0.1, 0.3), wave.velocity(X, top, 0.3), strict=True):
        np.testing.assert_array_equal(a, b)


def test_grid_and_points_agree(wave):
    z = np.linspace(0, 0.4, 17)
    for a, b in zip(wave.velocity_on(X, z, 0.4), wave.velocity(X[:, None], z, 0.4), strict=True):
        assert a.shape == (len(X), len(z))
        np.testing.assert_allclose(a, b, atol=1e-14)


def test_components_add_up_to_the_elevation(wave):
    parts = wave.components()
    if wave.name.startswith("solitary"):
        assert parts is None
        return
    np.testing.assert_allclose(parts.elevation(X, 0.6), wave.elevation(X, 0.6), atol=1e-9 * wave.height)
    assert parts.direction.shape == parts.omega.shape


def test_direction_turns_the_components():
    wave = regular("fenton", 0.04, 1.2, DEPTH, direction=0.5)
    x, y = 1.3, 0.4
    along = x * np.cos(0.5) + y * np.sin(0.5)
    assert wave.components().elevation(x, 0.2, y) == pytest.approx(wave.elevation(along, 0.2), abs=1e-15)


def test_stream_function_satisfies_the_surface_conditions():
    for height, period in ((0.002, 0.8), (0.04, 1.2), (0.08, 1.2), (0.12, 2.0), (0.1, 4.0)):
        kinematic, dynamic = surface_errors(regular("fenton", height, period, DEPTH))
        assert kinematic < 2e-8 and dynamic < 1e-8, (height, period)


@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_order_of_stokes(order):
    """The dynamic condition is off by the order + 1 of the height; the length by an even order."""
    errors = [surface_errors(stokes(h, 1.2, DEPTH, GRAVITY, 0, 0, order))[1] for h in (0.02, 0.01)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order + 1, abs=0.1)
    exact, near = fenton(0.02, 1.2, DEPTH, GRAVITY, 0, 0), stokes(0.02, 1.2, DEPTH, GRAVITY, 0, 0, order)
    assert near.length == pytest.approx(exact.length, rel=(1e-5, 5e-6, 3e-8, 5e-8)[order - 2])


@pytest.mark.parametrize(("height", "period"), [(0.04, 1.2), (0.08, 1.5), (0.1, 2.5)])
def test_stream_function_against_raschii(height, period):
    """The same wave in the frame of the crest; raschii iterates to 1e-8 and has no return current."""
    ours = regular("fenton", height, period, DEPTH)
    theirs = FentonWave(height=height, depth=DEPTH, length=ours.length, N=len(ours.heights))
    assert ours.celerity == pytest.approx(theirs.data["Q"] / DEPTH, abs=1e-7)
    np.testing.assert_allclose(ours.elevation(X, 0.0), np.ravel(theirs.surface_elevation(X)) - DEPTH, atol=1e-7)
    z = np.full_like(X, 0.1)
    uw = np.asarray(theirs.velocity(X, z, all_points_wet=True))
    u, w = ours.velocity(X, z, 0.0)
    np.testing.assert_allclose(u - ours.current, uw[:, 0], atol=1e-6)
    np.testing.assert_allclose(w, uw[:, 1], atol=1e-6)


# Output files of J. D. Fenton's program Fourier, 20 terms, mean Eulerian velocity zero, in the repository
# FentonStokesClass of C. C. Tsai: H/d; L/d or T sqrt(g/d); c / sqrt(g d); Q / sqrt(g d^3); E_j k
FENTON = {
    "L/d = 8": (
        0.3,
        "length",
        8.0,
        0.9395,
        0.9279,
        {1: 1.1060569e-1, 2: 2.7800975e-2, 3: 6.6573116e-3, 5: 4.9366487e-4},
    ),
    "L/d = 8, high": (0.45, "length", 8.0, 0.9685, 0.9445, {1: 1.5372070e-1, 2: 5.4632283e-2, 3: 1.9049744e-2}),
    "86 % of breaking": (0.2, "period", 3.0, 0.5509, 0.5424, {1: 3.4415007e-1, 2: 7.7124456e-2, 4: 1.2081391e-2}),
}


@pytest.mark.parametrize("name", FENTON)
def test_stream_function_against_fentons_program(name):
    height, given, value, celerity, flow, harmonics = FENTON[name]

    def difference(period):
        wave = fenton(height, period, 1.0, 1.0, 0, 0)
        return (wave.length if given == "length" else wave.length / (wave.celerity - wave.current)) - value

    low, high = (8.2, 9.2) if given == "length" else (2.97, 3.2)
    wave = fenton(height, brentq(difference, low, high, xtol=1e-12), 1.0, 1.0, 0, 0)
    assert wave.celerity - wave.current == pytest.approx(celerity, abs=6e-5)
    assert wave.celerity == pytest.approx(flow, abs=6e-5)
    for j, printed in harmonics.items():
        assert wave.heights[j - 1] * wave.k == pytest.approx(printed, rel=2e-6)


def test_return_current_of_a_published_wave():
    """Fenton's program Cnoidal, fifth order and Aitken: H/d = 0.492, T sqrt(g/d) = 22.47, no transport."""
    wave = fenton(0.492, 22.47, 1.0, 1.0, 0, 0)
    assert wave.length == pytest.approx(24.9115, rel=2e-4)
    assert wave.celerity == pytest.approx(1.1087, rel=2e-4)
    assert wave.current == pytest.approx(-0.0160, abs=2e-4)


def test_highest_waves():
    """94 % of the highest wave is found; above it there is none, and the message says so."""
    for height, period in ((0.080, 0.6), (0.154, 1.2), (0.173, 2.0), (0.183, 4.0)):
        wave = regular("fenton", height, period, DEPTH)
        assert limits.williams(wave.length, DEPTH) * 0.92 < height
        assert max(surface_errors(wave)) < 2e-3
    with pytest.raises(NotConverged, match="give a lower height"):
        regular("fenton", 0.24, 2.0, DEPTH)
    with pytest.raises(WaveError, match=r"0\.2 m is above the highest wave .* 0\.176 m"):
        regular("auto", 0.2, 1.5, DEPTH)


def test_stokes_refuses_what_it_cannot():
    with pytest.raises(WaveError, match='use theory = "fenton"'):
        regular("stokes-5", 0.08, 4.0, DEPTH)


def test_auto_says_why():
    for height, period, name in (
        (0.001, 1.2, "airy"),
        (0.04, 1.2, "fenton"),
        (0.1, 4.0, "fenton"),
        (0.05, 60.0, "cnoidal"),
    ):
        wave = regular("auto", height, period, DEPTH)
        assert wave.name == name and wave.reason.startswith(f"{name}: ") and wave.reason.count("\n") == 0
    assert regular("airy", 0.001, 1.2, DEPTH).reason == ""


def test_auto_does_not_call_a_wave_linear_that_is_not():
    """Where airy is chosen, the surface differs from the stream function's by less than 2 % of the height."""
    for period in (0.6, 1.2, 2.5):
        height = brentq(lambda h, p=period: (theories.choose(h, p, DEPTH, GRAVITY)[0] == "airy") - 0.5, 1e-5, 0.05)
        height *= 0.999
        linear, exact = regular("auto", height, period, DEPTH), regular("fenton", height, period, DEPTH)
        assert linear.name == "airy"
        x = np.linspace(0, linear.length, 200)
        assert np.abs(linear.elevation(x, 0.0) - exact.elevation(x, 0.0)).max() < 0.02 * height


def test_every_theory_says_where_it_holds():
    assert all(row.what and row.range and row.source for row in (*THEORIES.values(), *KINDS.values()))


def test_the_ramp_grows_as_half_a_cosine():
    assert ramp(np.array([-1.0, 0.0, 1.0, 2.0, 9.0]), 2.0) == pytest.approx([0, 0, 0.5, 1, 1])
    assert ramp(0.0, 0.0) == 1
