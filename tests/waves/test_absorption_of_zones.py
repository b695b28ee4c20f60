"""What zones and sponges send back, and how high the waves of a zone are: long waves, d eta/dt = -dq/dx and
dq/dt = -deta/dx - sigma (q - s q_wave), in units of wavelength and period, solved exactly in frequency."""

import numpy as np
import pytest
from scipy.linalg import solve_banded

from houle.boundary.relaxation_zone import RelaxationZone
from houle.boundary.sponge import Sponge, damping, sent_back
from houle.grid import Grid
from houle.waves.theories import regular

DEPTH, PERIOD, CELLS = 0.01, 2.0, 400  # kd = 0.1


def answer(sigma, share, length, tone, incident):
    """Complex amplitude of what leaves to the right from a closed end: sigma and share on faces from wall to edge, the
    length in wavelengths of the period of design and sigma in its frequency; waves of `tone` times that frequency."""
    n, omega = len(sigma) - 1, 2 * np.pi * tone
    h = length / n
    x = np.arange(n + 1) * h
    mobility = 1 / (-1j * omega + 2 * np.pi * sigma)
    pushed = mobility * 2 * np.pi * sigma * share * np.exp(1j * omega * x) * (not incident)
    coming = incident * np.exp(-1j * omega * x[-1])
    a, edge = np.zeros((3, n), complex), 2 / (2 - 1j * omega * h)  # flux through the edge: edge (eta - 2 coming)
    rhs, flow = np.zeros(n, complex), mobility[1:-1] / h**2
    a[1] = -1j * omega
    a[1, :-1] += flow
    a[1, 1:] += flow
    a[0, 1:] = a[2, :-1] = -flow
    rhs[:-1] -= pushed[1:-1] / h
    rhs[1:] += pushed[1:-1] / h
    a[1, -1] += edge / h
    rhs[-1] += 2 * coming * edge / h
    eta = solve_banded((1, 1), a, rhs)
    return edge * (eta[-1] - 2 * coming) + coming


@pytest.fixture(scope="module")
def zone():
    """Rates of a zone of a wavelength and a half over the frequency, its shares, from the wall on; its length."""
    wave = regular("airy", 1e-5, PERIOD, DEPTH)
    end = 1.5 * wave.length
    grid = Grid((CELLS, 2), (end / CELLS, DEPTH), (False, False))
    found = RelaxationZone.of((0.0, end), wave, grid, 1.0)
    return found.sigma[0] / wave.omega, found.share, 1.5


@pytest.fixture(scope="module")
def sponge():
    """The same of a sponge."""
    return sponge_of(1.5)


def sponge_of(length):
    """Rates of a sponge of this length in wavelengths, as `zone`."""
    wave = regular("airy", 1e-5, PERIOD, DEPTH)
    end = length * wave.length
    grid = Grid((2 * CELLS, 2), (end / CELLS, DEPTH), (False, False))
    rate = grid.faces()
    Sponge(grid, ((0.0, 0.0), (end, 2 * DEPTH)), damping(wave.group_velocity, end)).resist(rate)
    return rate[0][: CELLS + 1, 0] / wave.omega, np.zeros(CELLS + 1), length


@pytest.mark.parametrize(("tone", "limit"), [(1.0, 0.01), (1.4, 0.01), (0.7, 0.08)])
@pytest.mark.parametrize("name", ["zone", "sponge"])
def test_little_comes_back(name, tone, limit, request):
    sigma, share, length = request.getfixturevalue(name)
    assert abs(answer(sigma, share, length, tone, incident=True)) < limit


@pytest.mark.parametrize("tone", [0.7, 1.0, 1.4])
def test_a_zone_makes_waves_as_high_as_asked_for(zone, tone):
    assert abs(answer(*zone, tone, incident=False)) == pytest.approx(1.0, abs=0.01)


def test_a_wall_alone_sends_everything_back():
    nothing = np.zeros(CELLS + 1)
    assert abs(answer(nothing, nothing, 1.5, 1.0, incident=True)) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("length", [0.25, 0.5, 0.75, 1.0, 1.5, 2.0])
def test_what_a_sponge_of_any_length_sends_back_is_that_of_the_solution_in_frequency(length):
    """The other way to solve the same equation has an error of (k h)^2 / 12 over the length, and sigma 2 % from c_g."""
    wave = regular("airy", 1e-5, PERIOD, DEPTH)
    end = length * wave.length
    told = sent_back(damping(wave.group_velocity, end), end, 2 * np.pi / wave.length, wave.group_velocity)
    assert told == pytest.approx(abs(answer(*sponge_of(length), 1.0, incident=True)), rel=0.02, abs=2e-4)


def test_without_resistance_the_wall_behind_a_sponge_sends_all_back():
    assert sent_back(0.0, 0.3, 20.0, 1.0) == pytest.approx(1.0, rel=1e-12)
