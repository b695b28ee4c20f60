"""Numbers that the sources print, or that a second program gives, within half of the last digit that they print."""

from math import radians

import numpy as np
import pytest

from houle import design


def met(value: float, printed: float, digit: float) -> bool:
    """True where the value is the printed one to half of its last digit."""
    return abs(value - printed) <= 0.5 * digit


def litres(found: design.Overtopping) -> tuple[float, float]:
    """Mean and design discharge [l/s/m]."""
    return 1000 * found.q, 1000 * found.q_design


def test_a_smooth_slope_overtops_as_the_deltares_toolbox_says():
    mean, designed = litres(design.overtopping_slope(wave_height=2, period=5, freeboard=5, cot_slope=3))
    assert met(mean, 0.3737, 1e-4) and met(designed, 0.8414, 1e-4)


def test_a_rough_slope_overtops_as_the_deltares_toolbox_says():
    found = design.overtopping_slope(wave_height=2, period=5, freeboard=2, cot_slope=3, roughness=0.45)
    assert met(litres(found)[1], 2.132, 1e-3)


def test_the_rubble_mound_of_case_study_8():
    found = design.overtopping_mound(wave_height=4.9, period=10, freeboard=5.61, cot_slope=1.5, roughness=0.44)
    assert met(litres(found)[1], 20.99, 1e-2)  # the manual prints 21


def test_the_wall_of_case_study_6():
    assert met(litres(design.overtopping_wall(wave_height=2.53, freeboard=5.94))[0], 0.0593, 1e-4)  # the manual: .059


def test_the_wall_of_case_study_12():
    """Waves that do not break (the manual prints .429), and that break against the wall, low (16.2) and high (.35)."""
    calm = design.overtopping_wall_foreshore(wave_height=2.22, period=5.7, depth=8, freeboard=5.67)
    assert met(litres(calm)[0], 0.427, 1e-3) and "(7.5)" in calm.branch
    period = (2 * np.pi * 1.56 / 0.0278 / 9.81) ** 0.5
    high, low = (
        design.overtopping_wall_foreshore(wave_height=1.56, period=period, depth=3.43, freeboard=freeboard)
        for freeboard in (7.21, 1.999)
    )
    assert met(litres(high)[0], 0.3500, 1e-4) and "(7.8)" in high.branch
    assert met(litres(low)[0], 16.20, 1e-2) and "(7.7)" in low.branch


def test_run_up_on_a_smooth_slope():
    assert met(design.run_up_slope(wave_height=2, period=5, cot_slope=3).R_2, 4.860, 1e-3)


@pytest.mark.parametrize(("roughness", "printed"), [(0.40, 0.290), (1.0, 0.619)])
def test_reflection_of_rock_and_of_a_smooth_slope(roughness, printed):
    found = design.reflection_slope(wave_height=0.1, period=1.45, cot_slope=2, roughness=roughness)
    assert met(found.K_r, printed, 1e-3) and met(found.ratios["xi"], 2.865, 1e-3)
    assert not found.verified and "RECALLED" in found.source


@pytest.mark.parametrize(("permeable", "printed"), [(True, 0.2791), (False, 0.3739)])
def test_transmission_as_the_deltares_toolbox_says(permeable, printed):
    found = design.transmission_low_crest(
        wave_height=2, peak_period=7, freeboard=0.5, crest_width=5, cot_slope=2, permeable=permeable
    )
    assert met(found.K_t, printed, 1e-4)


def test_goda_as_the_deltares_toolbox_says():
    """Bed 1:50, so the depth five significant heights of 3.05 m seaward is 5.305 m."""
    found = design.wall_goda(
        wave_height=5.8, period=8, depth=5, depth_on_berm=4, foot=6, crest=5, depth_seaward=5.305, density=1025
    )
    assert met(found.F / 1000, 574.1, 0.1)
    for value, printed in ((found.p1, 63.70), (found.p3, 52.02), (found.p4, 27.09), (found.pu, 43.81)):
        assert met(value / 1000, printed, 0.01)


def test_takahashi_as_in_the_book_of_goda():
    """Page 140; the depth seaward decides nothing there, as the impulsive coefficient is the larger."""
    found = design.wall_takahashi(
        wave_height=8.05, period=11.4, depth=10.1, depth_on_berm=5.6, foot=7.1, crest=3.4, depth_seaward=10.1,
        berm_width=8, obliquity=radians(15), density=1030,
    )  # fmt: skip
    assert met(8 / found.ratios["BM/L"], 107.54, 0.01) and met(found.ratios["alpha_I"], 0.3223, 1e-4)
    for value, printed in ((found.p1, 97.645), (found.p3, 87.212), (found.p4, 69.674), (found.pu, 65.739)):
        assert met(value / 1000, printed, 0.01)  # the book rounds on the way: the third decimal is not to be had


def test_sainflou():
    found = design.wall_sainflou(wave_height=2, period=8, depth=8, density=1025)
    assert met(found.length, 64.90, 0.01) and met(found.h0, 0.298, 1e-3) and met(found.p_bed / 1000, 15.29, 0.01)


def test_armour_of_van_der_meer_and_of_van_gent():
    meer = design.armour_van_der_meer(
        wave_height=3, mean_period=7, cot_slope=2, permeability=0.5, damage=2, waves=3000, buoyant_density=1.6
    )
    gent = design.armour_van_gent(
        wave_height=3, cot_slope=2, core_to_armour=0.3, damage=2, waves=3000, buoyant_density=1.6
    )
    assert met(meer.D_n50, 1.055, 1e-3) and met(gent.D_n50, 1.233, 1e-3)
    assert abs(meer.D_n50 / 1.063 - 1) < 0.01  # the form of the Deltares toolbox


@pytest.mark.parametrize(("period", "branch"), [(7.0, "plunging waves"), (16.0, "surging waves")])
def test_stones_of_the_size_for_a_damage_have_that_damage(period, branch):
    """The damage is the size solved the other way round; of the printed size it is 2 to the digits of the size."""
    sea = {"wave_height": 3, "cot_slope": 2, "waves": 3000, "buoyant_density": 1.6}
    meer = {**sea, "mean_period": period, "permeability": 0.5}
    gent = {**sea, "core_to_armour": 0.3}
    for damage in (2.0, 8.0):
        size = design.armour_van_der_meer(**meer, damage=damage)
        found = design.armour_damage_van_der_meer(**meer, D_n50=size.D_n50)
        assert pytest.approx(damage, rel=1e-12) == found.S and found.N_s == pytest.approx(size.N_s, rel=1e-12)
        assert found.branch == size.branch == branch and found.low < damage < found.high
        stone = design.armour_van_gent(**gent, damage=damage).D_n50
        assert pytest.approx(damage, rel=1e-12) == design.armour_damage_van_gent(**gent, D_n50=stone).S
    assert pytest.approx(2, rel=0.01) == design.armour_damage_van_der_meer(**{**meer, "mean_period": 7}, D_n50=1.055).S
    assert pytest.approx(2, rel=0.01) == design.armour_damage_van_gent(**gent, D_n50=1.233).S


def test_pore_pressure_in_a_core():
    found = design.pore_pressure(pressure=10e3, x=5, wave_height=3, wave_length=60, porosity=0.4, core_width=20)
    assert met(found.delta, 0.535, 1e-3) and met(found.p / 1000, 7.18, 0.01)


@pytest.mark.parametrize(
    ("upstream", "downstream", "length", "point", "line"),
    [
        (24.0, 4.0, 16.0, 12.70591, (22.59106, 20.43032, 17.47530, 14.07028)),
        (0.35, 0.15, 0.40, 0.16514, (0.32267, 0.28530, 0.23838, 0.18717)),
    ],
)
def test_seepage_through_a_dam(upstream, downstream, length, point, line):
    """The exit point to the digits; the line at four places, which the other program takes between its 200 points."""
    found = design.seepage_dam(upstream=upstream, downstream=downstream, length=length, conductivity=1e-3)
    assert met(found.exit, point, 1e-5)
    assert found.discharge == pytest.approx(1e-3 * (upstream**2 - downstream**2) / (2 * length), rel=1e-14)
    there = np.interp(np.array([0.25, 0.5, 0.75, 0.95]) * length, *found.line)
    assert there == pytest.approx(line, rel=2e-4)


def test_run_up_of_a_solitary_wave():
    assert met(design.run_up_solitary(wave_height=0.019, depth=1, cot_slope=19.85).R, 0.0890, 1e-4)


def test_a_ship_in_a_channel():
    limit = design.ship_limit_speed(canal_area=200, ship_area=30, canal_width=50)
    beside = design.ship_drawdown(speed=3, canal_area=200, ship_area=30, canal_width=50)
    assert met(limit.V_L, 3.393, 1e-3) and beside.V_L == limit.V_L
    assert met(beside.u, 0.883, 1e-3) and met(beside.z, 0.310, 1e-3)


@pytest.mark.parametrize(("kind", "printed"), [("motor ship", 0.272), ("push convoy", 0.154), ("tug", 0.309)])
def test_secondary_waves_of_a_ship(kind, printed):
    assert met(design.ship_waves(speed=4, depth=4, distance=40, kind=kind, draught=2.5).H, printed, 1e-3)


def test_drawdown_at_the_bank():
    """A ship 10 m off the axis of a channel of 200 m2, 4 m deep: A* = 0.2."""
    found = design.ship_drawdown_at_bank(
        drawdown=0.3, return_current=0.8, offset=10, depth=4, canal_area=200, canal_width=50, ship_length=80
    )
    assert (found.z_bank, found.u_bank, found.z_max) == pytest.approx((0.42, 0.96, 0.63), rel=1e-14)


def test_a_porosity_known_to_2_percent_is_a_quadratic_drag_known_to_19():
    found = design.drag_range(porosity=0.39, grain_diameter=0.02)
    assert met(found.b_spread, 0.19, 0.01) and "-17 to +21 %" in str(found)
    ends = [(1 - n) / n**3 for n in (0.41, 0.39, 0.37)]
    assert (found.b_low / found.b, found.b_high / found.b) == pytest.approx((ends[0] / ends[1], ends[2] / ends[1]))


def test_branches_that_no_source_has_a_number_for_are_those_of_a_second_program():
    """Written by another hand from the same formulas; on 20 000 random cases the two differ by 3e-13 at most."""
    wide = design.transmission_low_crest(wave_height=2, peak_period=7, freeboard=-1, crest_width=30, cot_slope=2)
    assert wide.K_t == pytest.approx(0.23803518464970844, rel=1e-12)
    surging = design.armour_van_der_meer(
        wave_height=2, mean_period=12, cot_slope=2, permeability=0.4, damage=4, waves=5000, buoyant_density=1.65
    )
    assert surging.D_n50 == pytest.approx(0.6934761442571484, rel=1e-12)
    crest = design.overtopping_mound(
        wave_height=0.1, period=1.45, freeboard=0.16, cot_slope=2, roughness=0.4, crest_width=0.24, stone_size=0.04
    )
    assert (crest.q, crest.q_design) == pytest.approx((2.581458094247999e-08, 1.105387229021175e-07), rel=1e-12)
    assert design.overtopping_wall(wave_height=2, freeboard=3).q == pytest.approx(0.00242904858595929, rel=1e-12)
    for depth, q in ((3, 0.02120838920999412), (8, 0.006844496598306727)):
        found = design.overtopping_wall_foreshore(wave_height=2, period=8, depth=depth, freeboard=3)
        assert found.q == pytest.approx(q, rel=1e-12)


def test_bands_are_one_standard_deviation_of_the_coefficients():
    """Of 1.65 0.10 and of 1.0 0.07 (run-up), of 0.047 0.007 and of 2.35 0.23 (wall), of 6.2 0.4 (armour)."""
    breaking = design.run_up_slope(wave_height=2, period=5, cot_slope=3)
    assert (breaking.low, breaking.high) == pytest.approx([breaking.R_2 * c / 1.65 for c in (1.55, 1.75)])
    surging = design.run_up_slope(wave_height=2, period=15, cot_slope=2)
    assert (surging.low, surging.high) == pytest.approx([surging.R_2 * c for c in (0.93, 1.07)])
    wall = design.overtopping_wall(wave_height=1, freeboard=1)
    ends = [c * np.exp(-(k**1.3)) * 9.81**0.5 for c, k in ((0.040, 2.58), (0.054, 2.12))]
    assert (wall.low, wall.high) == pytest.approx(ends)
    armour = design.armour_van_der_meer(wave_height=3, mean_period=7, cot_slope=2, permeability=0.5)
    assert (armour.low, armour.high) == pytest.approx([armour.D_n50 * 6.2 / c for c in (6.6, 5.8)])
