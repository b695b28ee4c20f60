"""Resistance laws against values computed by hand, and what follows from their physics."""

from math import inf, isclose, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from houle.case.model import load
from houle.case.porous import coefficients
from houle.check.drag import drag_sheet
from houle.medium.resistance import (
    LAWS,
    from_permeability,
    inertia_coefficient,
    steady_velocity,
)

NU, G = 1e-6, 9.81
ROCK, BEADS = (0.49, 0.0159), (0.39, 0.003)  # porosity, d50 [m]: crushed rock and glass beads of Liu et al. (1999)

# law, coefficients, then a [1/s], b [1/m] and drag/g at u_d = 0.1 m/s in rock and in beads, from a pocket calculator:
# (1-n)^2/n^3 is 2.2108 in the rock and 6.2729 in the beads, (1-n)/n^3 is 4.3349 and 10.2834
TABLE = [
    ("liu-1999", {}, (1.75, 300, 0.32), (139, 3771, 5.3)),
    ("jensen-2014", {}, (4.37, 577, 0.63), (348, 7257, 11)),
    ("ergun-1952", {}, (1.31, 477, 0.50), (105, 5999, 7.2)),
    ("olaflow", {}, (0.223, 545, 0.56), (21.3, 6856, 7.2)),
    ("van-gent-1995", {}, (8.75, 300, 0.395), (697, 3771, 11)),
    ("engelund-1953", {}, (2.19, 763, 0.80), (166, 9598, 11.5)),
]


@pytest.mark.parametrize(("law", "given_values", "rock", "beads"), TABLE)
def test_published_laws_give_the_values_computed_by_hand(law, given_values, rock, beads):
    for (n, d), (a, b, drag) in ((ROCK, rock), (BEADS, beads)):
        computed = LAWS[law](n, d, NU, **given_values)
        assert computed == pytest.approx((a, b), rel=0.006)
        assert (computed[0] + computed[1] * 0.1) * 0.1 / G == pytest.approx(drag, rel=0.025)


@pytest.mark.parametrize(("material", "b"), [(ROCK, 475), (BEADS, 4101)])
def test_liu_with_the_local_keulegan_carpenter_number(material, b):
    n, d = material
    kc = 0.1 * 1.0 / (n * d)  # |u_d| T/(n d), T = 1 s
    assert LAWS["liu-1999"](n, d, NU, kc=kc)[1] == pytest.approx(b, rel=0.003)


@pytest.mark.parametrize("period", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("speed", [0.01, 0.1, 0.7])
def test_liu_with_keulegan_carpenter_numbers_where_the_water_is(speed, period):
    """Drag is that of the number at this very velocity; 19.27 /s in the rock at 1 s, by hand."""
    n, d = ROCK
    linear, quadratic = LAWS["liu-1999"](n, d, NU, period=period)
    a, b = LAWS["liu-1999"](n, d, NU, kc=speed * max(1.0, period) / (n * d))
    assert linear + quadratic * speed == pytest.approx(a + b * speed, rel=1e-12)
    assert LAWS["liu-1999"](n, d, NU, period=1.0)[0] == pytest.approx(19.27, abs=0.01)


@pytest.mark.parametrize("law", [name for name, law in LAWS.items() if law.knows_period])
@pytest.mark.parametrize("period", [1.2, 8.0])
@pytest.mark.parametrize("speed", [0.003, 0.1, 0.7])
def test_a_period_is_the_keulegan_carpenter_number_where_the_water_is(law, period, speed):
    """7.5/KC of the quadratic drag with KC = |u_d| T/(n d) is linear: the same drag at every speed, no iteration."""
    n, d = ROCK
    linear, quadratic = LAWS[law](n, d, NU, period=period)
    a, b = LAWS[law](n, d, NU, kc=speed * period / (n * d))
    assert linear + quadratic * speed == pytest.approx(a + b * speed, rel=1e-12)
    assert quadratic == pytest.approx(LAWS[law](n, d, NU, kc=1e12)[1], rel=1e-9), "without KC"


def test_the_share_of_oscillating_flow_by_hand():
    """Armour, n = 0.45, T = 1.6 s: 7.5 x 1.1 x 0.55 / (0.2025 x 1.6) = 14.00 /s, whatever the grain."""
    for d in (0.048, 0.02):
        steady, b = LAWS["van-gent-1995"](0.45, d, NU)
        assert LAWS["van-gent-1995"](0.45, d, NU, period=1.6) == pytest.approx((steady + 14.0046, b), rel=1e-4)


def test_exact_digits_of_one_law():
    a, b = LAWS["ergun-1952"](0.5, 0.01, 1e-6)  # (1-n)^2/n^3 = 2, (1-n)/n^3 = 4
    assert a == pytest.approx(150 * 2 * 1e-6 / 1e-4, rel=1e-14)
    assert b == pytest.approx(1.75 * 4 / 0.01, rel=1e-14)
    a, b = LAWS["engelund-1953"](0.5, 0.01, 1e-6)  # (1-n)^3/n^2 = 1/2
    assert (a, b) == pytest.approx((5.0, 1120.0), rel=1e-14)
    assert LAWS["olaflow"](0.5, 0.01, 1e-6)[0] == pytest.approx(50 * 1 * 1e-6 / 1e-4, rel=1e-14)  # cube: 1
    assert LAWS["jensen-2014"](0.5, 0.01, 1e-6)[1] == pytest.approx(2 * (1 + 7.5 / 128) * 4 / 0.01, rel=1e-14)


def test_huang_is_three_times_ergun_in_the_rock_as_its_status_warns():
    drag = {law: (a + b * 0.1) * 0.1 for law in ("huang-2003", "ergun-1952") for a, b in [LAWS[law](*ROCK, NU)]}
    assert 2.5 < drag["huang-2003"] / drag["ergun-1952"] < 4
    permeability = 1.643e-7 * 1.59**1.57 * 0.49**3 / 0.51**2  # [m2], by hand 1.539e-7
    assert permeability == pytest.approx(1.539e-7, rel=1e-3)
    assert LAWS["huang-2003"](*ROCK, NU)[0] == pytest.approx(NU / permeability, rel=1e-12)


@pytest.mark.parametrize("law", LAWS)
@given(n=st.floats(0.2, 0.9), d=st.floats(1e-3, 1.0))
def test_every_law_resists_more_with_smaller_pores_and_finer_grains(law, n, d):
    a, b = LAWS[law](n, d, NU)
    assert a > 0 and b >= 0  # b = 0 of a law for seepage alone
    denser = LAWS[law](0.95 * n, d, NU)
    assert denser[0] > a
    assert denser[1] > b or b == 0 or law == "huang-2003"  # as its status says
    finer = LAWS[law](n, 0.5 * d, NU)
    assert finer[0] > a and (finer[1] > b or b == 0)
    assert LAWS[law](n, d, 2 * NU)[0] == pytest.approx(2 * a)  # Darcy's term is viscous


@pytest.mark.parametrize("law", LAWS)
def test_clear_water_does_not_resist_and_every_law_says_where_it_is_from(law):
    assert LAWS[law](1.0, 0.01, NU) == (0.0, 0.0)
    assert "READ" in LAWS[law].status or "RECALLED" in LAWS[law].status
    assert ("(" in LAWS[law].source and "a =" in LAWS[law].what) or "K_p =" in LAWS[law].what


@given(k=st.floats(1e-10, 1e-4), c=st.floats(0.01, 5.0))
def test_permeability_and_forchheimer_come_back(k, c):
    a, b = from_permeability(k, c, NU)
    assert isclose(NU / a, k) and isclose(b * sqrt(NU / a), c)


def test_the_inertia_coefficient_is_one_in_clear_water():
    assert inertia_coefficient(0.49, 0.34) == pytest.approx(1.353877551)
    assert inertia_coefficient(1.0) == 1.0


@given(a=st.floats(1e-3, 1e3), b=st.floats(0.0, 1e4), i=st.floats(0.01, 1.0))
def test_steady_velocity_balances_the_gradient(a, b, i):
    u = steady_velocity(a, b, i)
    assert a * u + b * u * u == pytest.approx(G * i)


def test_without_drag_there_is_no_steady_velocity():
    assert steady_velocity(0.0, 0.0, 1.0) == inf


def body(**changes):
    tables = {
        "case": {"name": "t"},
        "domain": {"size": [1.0, 0.5], "spacing": 0.01},
        "water": [{"below": 0.2}],
        "porous": [{"name": "dam", "box": [[0.3, 0.0], [0.6, 0.4]], "porosity": 0.49, "grain_diameter": 0.0159}],
        "time": {"end": 1.0},
    }
    tables["porous"][0] |= {"resistance": {"law": "jensen-2014"}, **changes}
    return load(tables)


def test_drag_sheet_of_the_rock():
    case = body()
    p = drag_sheet(case.porous[0], case.fluid, velocity=0.1)
    assert (p.a, p.b) == pytest.approx((4.37, 577), rel=0.002)
    assert p.permeability == pytest.approx(2.287e-7, rel=1e-3)  # 1e-6/4.3725
    assert p.forchheimer == pytest.approx(0.2760, rel=1e-3)  # 577.2 sqrt(2.287e-7)
    assert p.linear_share == pytest.approx(4.3725 / (4.3725 + 57.72), rel=1e-3)
    assert p.gradient == pytest.approx(0.633, rel=1e-3) and p.gradient == p.reference_gradient
    assert p.reynolds == pytest.approx(1590) and p.warnings == ()
    assert p.inertia == pytest.approx(1.35388, rel=1e-5)


def test_drag_sheet_in_steady_flow_uses_the_whole_gradient():
    case = body()
    p = drag_sheet(case.porous[0], case.fluid, gradient=0.5)
    assert p.gradient == pytest.approx(0.5)


def test_drag_sheet_warns_outside_the_range_of_the_law():
    case = body(grain_diameter=0.08, porosity=0.7)
    warnings = "; ".join(drag_sheet(case.porous[0], case.fluid).warnings)
    assert "porosity = 0.7 is outside 0.39 to 0.53" in warnings
    assert "grain_diameter = 0.08 m is outside 0.003 to 0.0159" in warnings


@pytest.mark.parametrize(
    ("resistance", "expected"),
    [
        ({"a": 3.0, "b": 400.0}, (3.0, 400.0)),
        ({"permeability": 1e-7, "forchheimer": 0.5}, (10.0, 0.5 / sqrt(1e-7))),
        ({"law": "van-gent-1995", "alpha": 500.0, "beta": 2.0, "kc": 128.0}, (4.3725, 577.22)),
    ],
)
def test_three_ways_to_give_a_resistance(resistance, expected):
    case = body(resistance=resistance)
    rock = case.porous[0]
    assert coefficients(rock.resistance, rock.porosity, rock.grain_diameter, NU) == pytest.approx(expected, rel=1e-4)


REGULAR = {"kind": "regular", "height": 0.02, "period": 1.5, "depth": 0.2, "zone": {"x": [0.0, 0.5]}}
SEA = {**REGULAR, "kind": "jonswap"}
CREST = {"kind": "solitary", "height": 0.02, "depth": 0.2, "zone": {"x": [0.0, 0.5]}}
GROUP = {**REGULAR, "kind": "focused", "focus": {"x": 0.5, "time": 1.0}}


def under(waves, **resistance):
    """(a, b) of the rock that a run of the case has."""
    case = load(body(resistance={"law": "van-gent-1995", **resistance}).to_dict() | ({"waves": waves} if waves else {}))
    rock = case.porous[0]
    return coefficients(rock.resistance, rock.porosity, rock.grain_diameter, NU, case.drag_period)


def test_the_period_is_that_of_the_waves_unless_the_file_says_another():
    law = lambda **given: LAWS["van-gent-1995"](*ROCK, NU, **given)  # noqa: E731
    assert under(REGULAR) == law(period=1.5)
    assert under(REGULAR, period=3.0) == law(period=3.0)
    assert under(REGULAR, kc=20.0) == law(kc=20.0)
    assert under(None) == law() and under(CREST) == law(), "steady: no waves, or a single one"
    assert under(None, period=2.0) == law(period=2.0)
    assert under(REGULAR, law="ergun-1952") == LAWS["ergun-1952"](*ROCK, NU), "it has no KC"
    assert under(REGULAR, law="jensen-2014") == LAWS["jensen-2014"](*ROCK, NU, period=1.5), "not the 128 of a dam break"
    assert under(None, law="jensen-2014") == LAWS["jensen-2014"](*ROCK, NU, kc=128.0)
    current = {**REGULAR, "current": 0.1}
    assert under(current) == law(period=1.5), "that of the bed"


def test_the_period_of_a_sea_is_that_of_its_energy():
    """T_m-1,0 of JONSWAP with gamma = 3.3 is 0.904 T_p (0.9 in the design manuals); a group has the square of it."""
    sea, group = (load(body().to_dict() | {"waves": w}).drag_period for w in (SEA, GROUP))
    assert sea == pytest.approx(0.904 * 1.5, rel=5e-3)
    assert sea < group < 1.5, "narrower, nearer to the peak"


def test_the_drag_sheet_says_what_the_added_mass_stands_before():
    from io import StringIO

    from rich.console import Console

    from houle.check.drag import drag_of
    from houle.check.report import _drag

    for on, words in (("motion", "C_r = 1.354 "), ("rate", "C_r = 1.354 before du/dt alone")):
        case = body(added_mass_on=on)
        out = StringIO()
        Console(file=out, width=200).print(_drag(drag_sheet(case.porous[0], case.fluid)))
        assert words in out.getvalue() and drag_of(case)[0]["added_mass_on"] == on


def test_run_theory_and_drag_sheet_have_the_same_drag():
    from houle.case.build import build
    from houle.check.drag import drag_of
    from houle.flow.simulation import Simulation
    from houle.results.reflection import block_theory

    waves = {**REGULAR, "zone": {"x": [0.0, 2.4]}}
    tables = body(box=[[3.5, 0.0], [4.0, 0.4]], resistance={"law": "van-gent-1995"}).to_dict()
    tables |= {"waves": waves, "domain": {"size": [6.5, 0.4], "spacing": 0.05}}
    case = load(tables)
    a, b = LAWS["van-gent-1995"](*ROCK, NU, period=1.5)
    medium = Simulation(build(case), 1).medium
    assert medium.on_faces(1)[0].max() == pytest.approx(a) and medium.on_faces(2)[0].max() == pytest.approx(b)
    told = drag_of(case)[0]
    assert (told["a"], told["b"], told["period"]) == (a, b, 1.5)
    assert told["oscillating"] == pytest.approx(7.5 * 1.1 * 0.51 / (0.49**2 * 1.5))
    steady = load(case, {"porous.dam.resistance": {"law": "van-gent-1995", "kc": 1e9}})
    friction = [block_theory(c, c.porous[0], c.wave.omega, 0.02, False).friction for c in (case, steady)]
    share = 0.49 * told["oscillating"] / case.wave.omega  # n a / omega
    assert 0.6 * share < friction[0] - friction[1] < share, "less quadratic drag, for the water is slower"
