"""The block of linear theory: against tables of an independent code, and against what must hold whatever the code."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from houle.analysis import theory
from houle.analysis.errors import AnalysisError
from houle.waves.dispersion import wave_number

DATA = Path(__file__).parent / "data"
DEPTH, WIDTH = 0.25, 1.5


def table(name):
    return np.genfromtxt(DATA / name, delimiter=",", names=True, comments="#", skip_header=2)


def test_table_of_the_block_with_given_friction():
    rows = [row for row in table("paper_case_f.csv") if row["n"] in (0.85, 0.49)]
    assert len(rows) > 60
    for row in rows:
        given = (2 * np.pi / row["T_s"], DEPTH, WIDTH, row["n"], row["f"])
        behind = theory.porous_block(*given, wall=True, modes=21)
        through = theory.porous_block(*given, modes=21)
        assert pytest.approx(row["CR_wall_eigen"], abs=1e-4) == behind.C_R, row
        assert pytest.approx(row["CR_trans_eigen"], abs=1e-4) == through.C_R, row
        assert pytest.approx(row["CT_trans_eigen"], abs=1e-4) == through.C_T, row
        assert behind.C_T == 0.0
        assert pytest.approx(row["CR_wall_long"], abs=1e-4) == theory.long_wave(*given, wall=True).C_R
        assert pytest.approx(row["CT_trans_long"], abs=1e-4) == theory.long_wave(*given).C_T


@pytest.mark.parametrize("row", table("paper_case_lorentz.csv")[6:12], ids=lambda row: f"T{row['T_s']}-H{row['H0_m']}")
def test_table_of_the_block_with_quadratic_drag(row):
    n, d = row["n"], row["d50_m"]
    a, b = 200 * (1 - n) ** 2 / n**3 * 1e-6 / d**2, 1.1 * (1 - n) / n**3 / d
    given = (2 * np.pi / row["T_s"], DEPTH, WIDTH, n, row["H0_m"], a, b)
    for wall, name in ((True, "wall"), (False, "trans")):
        block = theory.porous_block_lorentz(*given, inertia=1 + 0.34 * (1 - n) / n, wall=wall)
        assert block.friction == pytest.approx(row[f"f_{name}"], abs=2e-3)
        assert pytest.approx(row[f"CR_{name}"], abs=1e-3) == block.C_R
    assert pytest.approx(row["CT_trans"], abs=1e-3) == block.C_T
    assert np.sqrt(2) * block.velocity == pytest.approx(row["urms_block_m_s"], rel=0.02)  # the table holds amplitudes


def test_nothing_is_reflected_where_nothing_stands():
    block = theory.porous_block(2 * np.pi / 1.5, DEPTH, WIDTH, 1.0, 0.0)
    assert block.C_R < 1e-12
    phase = np.exp(1j * float(wave_number(2 * np.pi / 1.5, DEPTH)) * WIDTH)
    assert block.transmitted == pytest.approx(phase, abs=1e-12)


def test_without_friction_the_energy_goes_on():
    omega = 2 * np.pi / 1.5
    assert abs(theory.porous_block(omega, DEPTH, 0.7, 0.45, 0.0, inertia=1.2).C_D) < 1e-10
    assert abs(theory.porous_block(omega, DEPTH, 0.7, 0.45, 0.0, inertia=1.2, wall=True).C_R - 1.0) < 1e-10


@pytest.mark.parametrize(
    ("n", "f", "width", "wall"), [(0.45, 1.0, 0.5, False), (0.85, 0.5, 1.5, True), (0.4, 4.0, 0.3, True)]
)
def test_what_is_lost_is_the_work_of_the_friction(n, f, width, wall):
    """1 - R^2 - T^2 = friction work in the block over the incident flux, w k / 2 times the integral of Z^2."""
    omega = 2 * np.pi / 1.5
    block = theory.porous_block(omega, DEPTH, width, n, f, wall=wall, modes=60)
    ux, uz, weight = theory.pore_velocity(omega, DEPTH, width, n, f, wall=wall, modes=60, points=(121, 81))
    work = 0.5 * n * f * omega * np.sum(weight * (abs(ux) ** 2 + abs(uz) ** 2))
    k = float(wave_number(omega, DEPTH))
    norm = 0.5 * (DEPTH / np.cosh(k * DEPTH) ** 2 + np.tanh(k * DEPTH) / k)
    assert pytest.approx(work / (0.5 * omega * k * norm), rel=1e-5) == block.C_D


@pytest.mark.parametrize("wall", [False, True])
def test_long_waves_are_those_of_madsen(wall):
    given = (2 * np.pi / 60.0, DEPTH, 3.0, 0.45, 2.0)
    full, long = theory.porous_block(*given, inertia=1.1, wall=wall), theory.long_wave(*given, inertia=1.1, wall=wall)
    assert abs(full.reflected - long.reflected) + abs(full.transmitted - long.transmitted) < 1e-3


def test_a_thick_block_of_no_friction_reflects_by_its_porosity_alone():
    """Half a wavelength of averaging over the width: C_R of the first face is (1 - n) / (1 + n)."""
    weak = theory.long_wave(2 * np.pi / 60.0, DEPTH, 1e5, 0.49, 0.05)
    assert pytest.approx(0.51 / 1.49, abs=2e-3) == weak.C_R


@pytest.mark.parametrize(("period", "c"), [(1.0, 1 + 2j), (1.5, 1 + 4j), (0.8, 1 + 1j), (0.8, 1 + 8j), (2.0, 1.3 + 0j)])
def test_no_mode_is_missed(period, c):
    """Argument principle for F = y sinh y - x c cosh y around half a plane up to Im y = 17."""
    omega, height = 2 * np.pi / period, 17.0
    x, t = omega**2 * DEPTH / 9.81, np.linspace(0, 1, 20000)
    reach = 6 + abs(x * c)
    corners = [-reach + 1e-3j, reach + 1e-3j, reach + 1j * height, -reach + 1j * height, -reach + 1e-3j]
    path = np.concatenate([p + (q - p) * t for p, q in itertools.pairwise(corners)])
    turns = np.unwrap(np.angle(path * np.sinh(path) - x * c * np.cosh(path)))
    count = round((turns[-1] - turns[0]) / (2 * np.pi))
    y = theory.vertical_modes(omega, DEPTH, c, 13) * DEPTH
    assert count == np.sum((y.imag < height) & (y.imag > 1e-3))
    assert np.max(abs(y * np.tanh(y) - x * c)) < 1e-6 * abs(x * c)


def test_twenty_modes_are_enough():
    given = (2 * np.pi / 1.5, DEPTH, 0.5, 0.45, 2.0)
    few, many = theory.porous_block(*given, modes=20), theory.porous_block(*given, modes=60)
    assert abs(few.C_R - many.C_R) < 3e-4


def test_impossible_blocks_are_refused():
    with pytest.raises(AnalysisError, match="porosity = 85"):
        theory.porous_block(4.0, DEPTH, WIDTH, 85.0, 1.0)
    with pytest.raises(AnalysisError, match="width = 0"):
        theory.porous_block(4.0, DEPTH, 0.0, 0.85, 1.0)


@pytest.mark.parametrize("wall", [False, True])
def test_a_block_of_any_friction_and_width_has_a_reflection(wall):
    """From 1e2 to 1e12, in the end that of a wall; memory does not grow (a matrix of 1.2 TiB was asked for)."""
    omega = 2 * np.pi / 0.969152
    for width in (1e-6, 0.225, 1000.0):
        reflected = [
            theory.porous_block(omega, 0.45, width, 0.45, f, wall=wall).C_R
            for f in (1e3, 1e4, 1e5, 1e6, 1e8, 1e10, 1e12)
        ]
        assert np.all(np.diff(reflected) > -1e-9) and np.all(np.array(reflected) <= 1.0 + 1e-9)
        assert reflected[-1] > 0.999
    assert pytest.approx(1.0, abs=1e-4) == theory.porous_block(omega, 0.45, 0.225, 0.45, 1e6, wall=wall).C_R


@pytest.mark.parametrize(("a", "b"), [(1e6, 0.0), (1e12, 0.0), (0.0, 1e12), (1e12, 1e12)])
def test_lorentz_settles_for_any_drag(a, b):
    found = theory.porous_block_lorentz(6.48, 0.45, 0.225, 0.45, 0.01, a, b)
    assert found.C_R > 0.999 and found.C_T < 1e-4
