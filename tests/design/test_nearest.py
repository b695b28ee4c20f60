"""The nearest laboratory tests: the table, the distance, what lies outside, and how well they predict."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from houle import design
from houle.design.formula import FORMULAS
from houle.design.nearest import NEEDED, TABLE, LaboratoryTest, cloud, far, others

COUNTS = {"slope": 400, "wall": 103, "mound": 532}
TESTS = [test for kind in NEEDED for test in cloud(kind).tests]
MOUND = FORMULAS["nearest-tests"].example


def as_case(test: LaboratoryTest, length: float = 1.0, time: float = 1.0) -> dict:
    """The case that is a test, or a model of it."""
    slope = {} if test.kind == "wall" else {"cot_slope": test.cot_slope}
    rubble = {"roughness": test.roughness, "crest_width": test.crest_width * length} if test.kind == "mound" else {}
    return {
        "kind": test.kind, "wave_height": test.wave_height * length, "period": test.period * time,
        "depth": test.depth * length, "freeboard": test.freeboard * length,
        "armour_crest": test.armour_crest * length, **slope, **rubble,
    }  # fmt: skip


def share(error: np.ndarray) -> float:
    """Percentage of logarithmic errors within a factor of two."""
    return 100 * float(np.mean(np.abs(error) <= math.log(2)))


# The table


def test_the_table_is_what_its_head_says():
    assert {kind: len(cloud(kind).tests) for kind in NEEDED} == COUNTS
    assert len({test.row for test in TESTS}) == len(TESTS)
    head = "".join(line for line in TABLE.read_text(encoding="utf-8").splitlines() if line.startswith("#"))
    assert "Steendam" in head and all(f"{number} " in head for number in COUNTS.values())
    assert min(test.q_star for test in TESTS) >= 0.995e-5  # q* from 1e-5 on, q rounded


def test_sizes_are_those_of_a_laboratory_in_metres_and_seconds():
    for test in TESTS:
        assert 0.04 < test.wave_height < 0.3 and 0.9 < test.period < 2.6 and 0.1 < test.depth < 1.5
        assert 0.008 < test.ratios["s"] < 0.09 and 0 < test.q_star < 0.05 and 0 <= test.freeboard < 0.7
        assert test.roughness == 1 or test.kind == "mound"
        assert (test.cot_slope == 0) == (test.kind == "wall")
        assert math.isnan(test.peak_period) or 0.5 < test.peak_period / test.period < 1.4


def test_a_peak_period_that_the_database_lacks_is_nan_and_matters_to_nobody():
    lacking = [test for test in TESTS if math.isnan(test.peak_period)]
    assert len(lacking) == 19 and {test.kind for test in lacking} == {"slope"}
    found = design.nearest_tests(**as_case(lacking[0]))
    assert found.distance == 0 and math.isfinite(found.q)


def test_numbers_of_a_row_by_hand():
    """Row 1591: Hm0 93 mm, T 1.309 s, Rc 0.2 m, depth 0.5 m, 1:2, 0.1231 l/s/m."""
    test = next(test for test in TESTS if test.row == 1591)
    assert test.kind == "slope" and test.foreshore == 52
    assert test.ratios["Rc/Hm0"] == pytest.approx(0.2 / 0.093) and test.ratios["h/Hm0"] == pytest.approx(0.5 / 0.093)
    assert test.ratios["s"] == pytest.approx(0.093 * 2 * math.pi / (9.81 * 1.309**2))
    assert test.q_star == pytest.approx(1.231e-4 / math.sqrt(9.81 * 0.093**3))


# Neighbours


@pytest.mark.parametrize("kind", NEEDED)
def test_every_test_finds_itself(kind):
    """And those with the same numbers, up to seven others."""
    for test in cloud(kind).tests:
        found = design.nearest_tests(**as_case(test), count=12)
        same = [one for one in found.tests if one.distance == found.distance]
        assert found.distance == 0 and test in [one.test for one in same]
        assert all(one.q == pytest.approx(one.test.q_star / test.q_star * test.q) for one in same)
        assert found.outside == ()


@pytest.mark.parametrize("kind", NEEDED)
def test_a_model_finds_the_same_tests(kind):
    """Froude's law, lengths by 4: times by 2, discharges per metre by 8."""
    for test in cloud(kind).tests[::10]:
        small, large = (design.nearest_tests(**as_case(test, length, time)) for length, time in ((1, 1), (4, 2)))
        assert {one.test.row for one in small.tests[:4]} <= {one.test.row for one in large.tests}  # ties may swap
        assert large.q == pytest.approx(8 * small.q, rel=1e-6) and large.q_star == pytest.approx(small.q_star, rel=1e-6)
        assert [one.distance for one in large.tests] == pytest.approx([one.distance for one in small.tests], abs=1e-9)
        assert large.outside == ()


def test_neighbours_come_in_order_and_the_band_is_theirs():
    found = design.nearest_tests(**MOUND, count=12)
    distances, q = ([getattr(one, name) for one in found.tests] for name in ("distance", "q"))
    assert len(found.tests) == 12 and distances == sorted(distances) and found.distance == distances[0]
    assert (found.low, found.high) == (min(q), max(q)) and "12 nearest" in found.band
    assert found.q == pytest.approx(math.exp(np.mean(np.log(q))))
    assert found.q_star == pytest.approx(found.q / math.sqrt(9.81 * 4.0**3))
    assert found.tests[:5] == design.nearest_tests(**MOUND).tests
    assert all(f"row {one.test.row}" in str(found) for one in found.tests)


def test_a_distance_of_one_is_a_standard_deviation_of_the_tests():
    test = cloud("mound").tests[0]
    case = as_case(test)
    freeboards = [t.freeboard / t.wave_height for t in cloud("mound").tests]
    steps = [math.log(t.depth / t.wave_height) for t in cloud("mound").tests]
    higher = test.wave_height * float(np.std(freeboards))
    changed = (
        {"freeboard": case["freeboard"] + higher, "armour_crest": case["armour_crest"] + higher},
        {"armour_crest": case["armour_crest"] + higher},
        {"depth": case["depth"] * math.exp(float(np.std(steps)))},
    )
    place = cloud("mound").tests.index(test)
    for change in changed:
        moved = design.nearest_tests(**case | change, count=532)
        assert {one.test.row: one.distance for one in moved.tests}[test.row] == pytest.approx(1.0)
    assert cloud("mound").apart()[place].min() < 1


def test_tests_around_in_the_database_can_be_left_out():
    row = np.array([test.row for test in cloud("wall").tests])
    for rows in (0, 100):
        nearest = others("wall", 5, rows)
        assert np.all(np.abs(row[nearest] - row[:, None]) > rows) and nearest.shape == (103, 5)


# What lies outside


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"freeboard": 20.0, "armour_crest": 20.0}, "Rc/Hm0 = 5 is above 2.576, the most of the 532 tests"),
        ({"depth": 2.0}, "h/Hm0 = 0.5 is below 1.475, the least of the 532 tests of the kind 'mound'"),
        ({"cot_slope": 4.0}, "cot a = 4 is above 2, the most"),
        ({"roughness": 0.7}, "gamma_f = 0.7 is above 0.5, the most"),
        ({"crest_width": 20.0}, "Gc/Hm0 = 5 is above 2.912, the most"),
        ({"armour_crest": 2.4}, "(Ac - Rc)/Hm0 = -0.5 is below -0.0"),
        ({"period": 30.0}, "s = 0.002847 is below 0.0114, the least"),
    ],
)
def test_a_number_that_no_test_reaches_is_named(change, said):
    found = design.nearest_tests(**MOUND | change)
    assert len([sentence for sentence in found.outside if said in sentence]) == 1
    assert found.q > 0 and f"outside: {found.outside[0]}" in str(found)


def test_a_case_far_from_every_test_is_said_to_be():
    """Each number lies between the least and the most, and no test is like it."""
    lonely = MOUND | {"freeboard": 10.0, "crest_width": 0.0, "period": 13.0, "depth": 7.0, "roughness": 0.5}
    found = design.nearest_tests(**lonely)
    assert found.distance > far("mound") and len(found.outside) == 1
    assert re.match(r"the nearest test lies [\d.]+ away; 95 % of the 532 tests .* within 0\.874", found.outside[0])


@pytest.mark.parametrize("kind", NEEDED)
def test_one_test_in_twenty_lies_far_from_the_others(kind):
    nearest = cloud(kind).apart().min(axis=1)
    pair = 2 / len(nearest)  # two tests may be nearest to each other
    assert np.mean(nearest > far(kind)) == pytest.approx(0.05, abs=pair)


def test_a_rough_slope_is_outside_as_all_tests_are_smooth():
    smooth = {"kind": "slope", "wave_height": 2.0, "period": 6.0, "depth": 6.0, "freeboard": 2.0, "cot_slope": 3.0}
    rough = design.nearest_tests(**smooth, roughness=0.7)
    assert rough.outside == ("gamma_f = 0.7 is below 1, the least of the 400 tests of the kind 'slope'",)
    assert rough.tests == design.nearest_tests(**smooth).tests


# Errors


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"roughness": None}, "roughness is missing: .*'mound'.*roughness factor gamma_f"),
        ({"crest_width": None}, "crest_width is missing"),
        ({"cot_slope": None}, "cot_slope is missing.*2 for 1:2"),
        ({"kind": "slope", "cot_slope": None}, "cot_slope is missing"),
        ({"kind": "dike"}, "kind = 'dike' is none of 'slope', 'wall', 'mound'"),
        ({"roughness": 40}, "roughness = 40 must be above 0 and at most 1: .*; a fraction, not a percentage"),
        ({"freeboard": -1}, "freeboard = -1 must be at least 0: .*R_c.*; lengths are in metres"),
        ({"count": 533}, "count = 533 must be a whole number from 1 to 532"),
        ({"count": 2.5}, "count = 2.5 must be a whole number"),
        ({"count": 0}, "count = 0 must be at least 1"),
    ],
)
def test_an_input_that_makes_no_sense_is_refused(change, said):
    with pytest.raises(design.DesignError, match=f"^{said}"):
        design.nearest_tests(**MOUND | change)


# How well they predict, and EurOtop beside: what the documents and the scatter of the formulas say


@pytest.mark.parametrize(
    ("kind", "rule", "told"),
    [
        ("slope", "eurotop-2018", 77),
        ("wall", "eurotop-2018", 80),
        ("mound", "eurotop-2018", 29),
        ("mound", "taw-2002", 50),
    ],
)
def test_eurotop_is_as_far_from_the_tests_as_its_formulas_say(kind, rule, told):
    error = np.log([test.by_formula(rule).q / test.q for test in cloud(kind).tests])
    assert round(share(error)) == told
    for test in cloud(kind).tests[::40]:
        assert f"{told} %" in test.by_formula(rule).scatter


@pytest.mark.parametrize(
    ("kind", "near", "beyond"), [("slope", 74, 52), ("wall", 53, 39), ("mound", 60, 39)]
)  # fmt: skip
def test_the_nearest_tests_predict_as_well_as_they_say(kind, near, beyond):
    measured = np.log(cloud(kind).q_star)
    for rows, told in ((0, near), (100, beyond)):
        error = measured[others(kind, 5, rows)].mean(axis=1) - measured
        assert round(share(error)) == told
        assert str(told) in FORMULAS["nearest-tests"].scatter


def test_mounds_with_the_same_numbers_differ_as_the_documents_say():
    mounds = cloud("mound")
    first, second = mounds.twins()
    error = np.log(mounds.q_star[first] / mounds.q_star[second])
    assert len(first) == 162 and round(share(error)) == 62 and round(math.exp(np.abs(error).max())) == 32
    assert all(
        mounds.tests[i].ratios == pytest.approx(mounds.tests[j].ratios) for i, j in zip(first, second, strict=True)
    )
    assert "62 %" in FORMULAS["nearest-tests"].status


def test_the_page_prints_what_the_benchmark_does():
    """Its table, the distances that count as far, the ratio to the formula carried over."""
    page = (Path(__file__).parents[2] / "docs" / "design.md").read_text(encoding="utf-8")
    carried: dict[int, list[int]] = {0: [], 100: []}
    for kind, name in (("slope", "smooth slopes"), ("wall", "vertical walls"), ("mound", "rubble mounds")):
        measured = np.log(cloud(kind).q_star)
        ratio = np.log([test.q / test.by_formula().q for test in cloud(kind).tests])
        shares, held = [], []
        for rows in carried:
            nearest = others(kind, 5, rows)
            found = measured[nearest]
            shares.append(f"{share(found.mean(axis=1) - measured):.0f} %")
            held.append(f"{100 * np.mean((found.min(axis=1) <= measured) & (measured <= found.max(axis=1))):.0f} %")
            carried[rows].append(round(share(ratio[nearest].mean(axis=1) - ratio)))
        line = next(line for line in page.splitlines() if line.startswith(f"| {name} |"))
        assert line.endswith(f"| {shares[0]} | {shares[1]} | {', '.join(held)} |")
        assert f"{far(kind):.2f} for {kind}s" in page
    told = ["{}, {} and {} %".format(*numbers) for numbers in carried.values()]
    assert f"{told[0]}, and {told[1]} without the\nrows around" in page
