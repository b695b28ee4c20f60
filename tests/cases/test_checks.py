"""Pre-flight checks: what does not fit together is found, with both numbers; what fits is left in peace."""

import copy

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from houle.case.build import build
from houle.case.model import load
from houle.case.reading import shipped
from houle.case.section import CrossSection
from houle.check import cost, drag, machine, rules
from houle.errors import CaseError
from houle.output.drawing import INK, SHADE, SOLID, STONE
from houle.output.section import draw

RESISTANCE = {"law": "ergun-1952"}


def tank(spacing=0.01, size=(1.0, 0.5), **tables):
    """A tank with water 0.3 m deep; extra tables as in a case file."""
    base = {
        "case": {"name": "tank"},
        "domain": {"size": list(size), "spacing": spacing},
        "water": [{"below": 0.3}],
        "time": {"end": 1.0},
    }
    return load(base | tables)


def rock(**changes):
    return {
        "box": [[0.3, 0.0], [0.6, 0.4]],
        "porosity": 0.45,
        "grain_diameter": 0.015,
        "resistance": RESISTANCE,
        **changes,
    }


def levels(case):
    """Level and key of all findings but the advice on walls along which a falling water slips, as in these tanks."""
    return {(f.level, f.key) for f in rules.check(case) if not f.text.startswith("lets the water slip")}


def error(case):
    """The message of the one error of a case."""
    with pytest.raises(CaseError) as caught:
        rules.require(case)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_sound_case_has_no_findings():
    assert rules.check(tank(porous=[rock()], gauge=[{"x": 0.5}], sensor=[{"at": [0.1, 0.1]}])) == []


@pytest.mark.parametrize("name", shipped())
def test_shipped_cases_can_be_run(name):
    assert all(f.level != "error" for f in rules.require(load(name)))


# what is wrong with the case, and the words of the one message
ERRORS = {
    "box outside": (
        {"porous": [rock(box=[[0.8, 0.0], [1.2, 0.4]])]},
        ["porous.porous-1.box", "x = 1.2", "0 <= x <= 1 m"],
    ),
    "box in mm": ({"porous": [rock(box=[[300, 0], [600, 400]])]}, ["z = 400", "mm given"]),
    "polygon outside": (
        {"solid": [{"polygon": [[0.5, -0.1], [0.9, 0.0], [0.9, 0.3]]}]},
        ["solid.solid-1.polygon", "z = -0.1"],
    ),
    "level above": ({"water": [{"below": 0.7}]}, ["water[0].below", "0.7", "0 <= z <= 0.5 m"]),
    "crossing polygon": (
        {"solid": [{"polygon": [[0.1, 0.0], [0.4, 0.3], [0.4, 0.0], [0.1, 0.3]]}]},
        ["solid.solid-1.polygon", "crosses itself"],
    ),
    "water in a solid": (
        {"water": [{"box": [[0.0, 0.0], [0.5, 0.3]]}], "solid": [{"box": [[0.4, 0.0], [0.7, 0.2]]}]},
        ["water[0]", "0.02 m2", "x 0.4 to 0.5", "below = level"],
    ),
    "a solid everywhere": ({"solid": [{"below": 0.5}]}, ["water covers nothing"]),
    "no water": (
        {"water": [{"box": [[0.4, 0.0], [0.5, 0.3]]}], "solid": [{"box": [[0.4, 0.0], [0.5, 0.3]]}]},
        ["water covers nothing"],
    ),
    "overlap": (
        {"porous": [rock(name="armour"), rock(name="core", box=[[0.5, 0.0], [0.8, 0.3]], porosity=0.3)]},
        ["porous.core", "overlaps porous.armour", "0.03 m2", "0.45 against 0.3", "touch"],
    ),
    "overlap of laws": (
        {"porous": [rock(name="one"), rock(name="two", resistance={"a": 1.0, "b": 9.0})]},
        ["porous.two", "another resistance"],
    ),
    "overlap of forms of the added mass": (
        {"porous": [rock(name="one"), rock(name="two", added_mass_on="rate")]},
        ["porous.two", "another added_mass_on"],
    ),
    "body in a solid": (
        {"porous": [rock()], "solid": [{"box": [[0.2, 0.0], [0.7, 0.45]]}]},
        ["porous-1", "remove one"],
    ),
    "thin layer": (
        {"porous": [rock(box=[[0.3, 0.0], [0.6, 0.015]], grain_diameter=0.002)]},
        ["porous.porous-1", "0.015 m thick", "1.5 spacings of 0.01 m", "domain.spacing = 0.0037"],
    ),
    "grains larger than the body": (
        {"porous": [rock(grain_diameter=1.5)]},
        ["grain_diameter = 1.5", "thickness of 0.3 m", "Did you mean 0.0015 (1.5 mm)?"],
    ),
    "gauge outside": ({"gauge": [{"x": 1.2}]}, ["gauge.G1.x = 1.2", "0 <= x <= 1 m"]),
    "gauge in mm": ({"gauge": [{"x": 450.0}]}, ["gauge.G1.x = 450", "mm given"]),
    "sensor outside": ({"sensor": [{"name": "toe", "at": [0.2, 0.6]}]}, ["sensor.toe.at = 0.6", "0 <= z <= 0.5 m"]),
    "sensor in a solid": (
        {"solid": [{"box": [[0.8, 0.0], [1.0, 0.5]]}], "sensor": [{"at": [0.9, 0.1]}]},
        ["sensor.P1.at = [0.9, 0.1]", "solid.solid-1"],
    ),
    "step too long for the viscosity": (
        {"fluid": {"viscosity": 0.01}, "time": {"end": 1.0, "step": 0.004}},
        ["time.step = 0.004 s", "fluid.viscosity = 0.01", "at most 0.00124"],
    ),
    "frames without end": (
        {"output": {"every": 1e-9}},
        ["output.every makes steps of 1e-09 s, the water needs some 0.005"],
    ),
    "step in the wrong unit": ({"time": {"end": 1.0, "step": 1e-9}}, ["time.step makes steps of 1e-09 s", "leave it"]),
    "courant": ({"time": {"end": 1.0, "courant": 1e-9}}, ["time.courant makes steps of 1", "or leave it out"]),
    "gate outside": ({"gate": [{"x": 1.3, "speed": 1.0}]}, ["gate[0].x = 1.3", "0 < x < 1 m"]),
}


@pytest.mark.parametrize("wrong", ERRORS)
def test_errors_quote_the_numbers_and_the_cure(wrong):
    tables, words = ERRORS[wrong]
    message = error(tank(**tables))
    assert all(word in message for word in words), message


WARNINGS = {
    "layer barely resolved": (
        {"porous": [rock(box=[[0.3, 0.0], [0.6, 0.03]], grain_diameter=0.002)]},
        "porous.porous-1",
    ),
    "few grains": ({"porous": [rock(grain_diameter=0.12)]}, "porous.porous-1.grain_diameter"),
    "dynamic viscosity": ({"fluid": {"viscosity": 1e-3}}, "fluid.viscosity"),
    "shallow": ({"water": [{"below": 0.05}]}, "domain.spacing"),
    "unusual porosity": ({"porous": [rock(porosity=0.95)]}, "porous.porous-1.porosity"),
    "thin film": ({"water": [{"box": [[0.0, 0.0], [0.3, 0.3]]}, {"below": 0.015}]}, "water[1]"),
    "thin wall": ({"solid": [{"box": [[0.5, 0.0], [0.51, 0.2]]}]}, "solid.solid-1"),
    "remeshing that adds water": ({"numerics": {"remesh": "paper"}}, "numerics.remesh_every"),
    "long interval": ({"output": {"every": 5.0}}, "output.every"),
    "long step": ({"time": {"end": 1.0, "step": 0.5}}, "time.step"),
    "spacing does not divide": (
        {"domain": {"size": [0.25, 0.5], "spacing": 0.1}, "water": [{"below": 0.5}]},
        "domain.spacing",
    ),
}


@pytest.mark.parametrize("doubt", WARNINGS)
def test_doubts_are_warnings(doubt):
    tables, key = WARNINGS[doubt]
    assert levels(tank(**tables)) == {("warning", key)}


def test_what_touches_or_agrees_is_fine():
    touching = [rock(name="a"), rock(name="b", box=[[0.6, 0.0], [0.8, 0.4]], porosity=0.3)]
    assert levels(tank(porous=touching)) == set()
    alike = [rock(name="a"), rock(name="b", box=[[0.5, 0.0], [0.8, 0.4]])]
    assert levels(tank(porous=alike)) == set()
    slope = {"polygon": [[0.6, 0.0], [1.0, 0.0], [1.0, 0.4]]}
    assert levels(tank(solid=[slope])) == set()  # a level stops at the slope


def test_a_layer_from_wall_to_wall_counts_by_its_height_alone():
    def bed(top, spacing):
        return tank(spacing, porous=[rock(box=[[0.0, 0.0], [1.0, top]], grain_diameter=0.001)])

    assert levels(bed(0.04, 0.01)) == set()
    assert levels(bed(0.03, 0.01)) == {("warning", "porous.porous-1")}
    assert levels(bed(0.01, 0.01)) == {("error", "porous.porous-1")}


def test_a_sloping_layer_counts_across_not_along():
    # 45 degrees, 0.02 m across: its bounding box is 0.3 m by 0.3 m
    thick = 0.02 * 2**0.5
    layer = {"polygon": [[0.3, 0.0], [0.6, 0.3], [0.6 - thick, 0.3], [0.3 - thick, 0.0]]}
    case = tank(porous=[rock(**layer, box=None, grain_diameter=0.002)])
    section = CrossSection(case)
    assert section.thickness(section.porous[0]) == pytest.approx(0.02, rel=0.03)


def test_the_drop_of_the_level():
    assert CrossSection(tank()).drop() == 0
    dam = tank(water=[{"box": [[0.0, 0.0], [0.3, 0.3]]}, {"below": 0.1}])
    assert CrossSection(dam).drop() == pytest.approx(0.2)
    beach = tank(solid=[{"polygon": [[0.5, 0.0], [1.0, 0.0], [1.0, 0.45]]}])
    assert CrossSection(beach).drop() == pytest.approx(0)  # the dry beach is no drop


def test_a_column_of_water_thinner_than_what_is_sampled_is_seen():
    case = tank(water=[{"box": [[0.0005, 0.0], [0.0015, 0.3]]}])
    assert CrossSection(case).depth() == pytest.approx(0.3)
    assert cost.price(case).steps > 100


def test_three_dimensions_are_looked_at_layer_by_layer():
    def block(y0, y1):
        return {"box": [[0.4, y0, 0.0], [0.6, y1, 0.2]]}

    tables = {
        "domain": {"size": [1.0, 0.5, 0.5], "spacing": 0.05},
        "water": [{"box": [[0.5, 0.0, 0.0], [1.0, 0.2, 0.3]]}],
    }
    assert rules.check(tank(**tables, solid=[block(0.3, 0.5)]))[0].level == "warning"  # beside it, only shallow
    assert "water[0] lies in a solid" in error(tank(**tables, solid=[block(0.1, 0.5)]))


def test_a_gate_stands_on_the_nearest_face():
    case = tank(size=(0.892, 0.5), gate=[{"x": 0.29, "speed": 3.0}])
    (finding,) = rules.check(case)
    h = 0.892 / 89
    assert finding.level == "info" and f"{29 * h:.6g}" in finding.text


def test_the_reference_file_must_be_there(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(tank(reference={"surface": "lab.csv"}).to_toml())
    assert 'reference.surface = "lab.csv"' in error(load(file))
    (tmp_path / "lab.csv").write_text("t_s,x_m,eta_m\n")
    assert rules.require(load(file)) == []


def test_a_spacing_that_the_machine_cannot_hold_is_an_error(monkeypatch):
    monkeypatch.setattr(machine, "machine_memory", lambda: 8e9)
    message = error(tank(1e-6))  # 3e11 cells of water: must be told before anything is allocated
    assert "domain.spacing = 1e-06 m makes 1.2e+12 particles" in message and "8 GB" in message


@pytest.mark.parametrize("memory", [None, 1e15])
def test_cells_and_particles_that_cannot_be_numbered_are_an_error(monkeypatch, memory):
    """On any machine, and told before anything is allocated: 1.2e10 half cells, where 32 bits number 2.1e9."""
    monkeypatch.setattr(machine, "machine_memory", lambda: memory)
    message = error(tank(1e-5))
    assert (
        "domain.spacing = 1e-05 m makes 1.2e+10 half cells" in message and "at most 2.15e+09 can be numbered" in message
    )
    better = float(message.partition("from ")[2].split()[0])
    assert 2e-5 < better < 3e-5
    with pytest.raises(CaseError, match="can be numbered"):
        build(tank(1e-5))


def test_expected_velocity_of_a_drag_sheet_follows_the_drop():
    still = drag.drag_sheets(tank(porous=[rock()]))[0]
    assert still.gradient == pytest.approx(drag.STILL)
    water = [{"box": [[0.0, 0.0], [0.3, 0.3]]}, {"below": 0.15}]
    dam = drag.drag_sheets(tank(porous=[rock()], water=water))[0]
    assert dam.gradient == pytest.approx(0.5)  # 0.15 m over 0.3 m
    assert drag.drag_sheets(tank(porous=[rock(box=[[0.3, 0.0], [0.4, 0.4]])], water=water))[0].gradient == 1.0


def test_the_price_counts_particles_and_follows_the_spacing():
    coarse, fine = cost.price(tank()), cost.price(tank(0.005))
    assert coarse.particles == 4 * 100 * 30 and coarse.cells == 5000
    assert fine.particles == 4 * coarse.particles
    assert fine.steps == pytest.approx(2**0.5 * coarse.steps, abs=2)  # still water: the shortest wave sets the step
    assert cost.price(tank(time={"end": 1.0, "step": 0.01})).steps == 100
    block = {"domain": {"size": [1.0, 0.4, 0.5], "spacing": 0.1}}
    assert cost.price(tank(**block)).particles == 8 * 10 * 4 * 3


def test_the_picture_shows_the_section(tmp_path):
    case = tank(
        porous=[rock(polygon=[[0.3, 0.0], [0.6, 0.0], [0.5, 0.4]], box=None)],
        solid=[{"box": [[0.8, 0.0], [0.9, 0.2]]}],
        gauge=[{"x": 0.2}],
        sensor=[{"at": [0.1, 0.1]}],
        gate=[{"x": 0.25, "speed": 1.0}],
    )
    draw(case, tmp_path / "section.png")
    picture = imread(tmp_path / "section.png")
    pixels = picture[..., :3].reshape(-1, 3)
    for colour in (SHADE, SOLID, STONE, INK):  # water, solid, body, gate and words
        share = (abs(pixels - np.array(to_rgb(colour))).max(axis=1) < 0.008).mean()
        assert share > 0.001, colour


ODD = [
    None,
    True,
    "",
    "5 mm",
    -1,
    0,
    1e-9,
    1e9,
    float("nan"),
    float("inf"),
    10**400,
    [],
    {},
    [[]],
    [{}],
    [1.0, "a"],
    {"a": 1},
]


def leaves(table, path=()):
    """Every place of nested tables and lists, with the containers themselves."""
    if path:
        yield path
    items = table.items() if isinstance(table, dict) else enumerate(table) if isinstance(table, list) else ()
    for key, value in items:
        yield from leaves(value, (*path, key))


def test_whatever_stands_anywhere_is_a_case_or_a_message(tmp_path):
    (tmp_path / "lab.csv").write_text("t_s,x_m,eta_m\n")
    whole = tank(
        porous=[rock(), rock(box=None, polygon=[[0.7, 0.0], [0.9, 0.0], [0.9, 0.2]], resistance={"a": 1.0, "b": 10.0})],
        solid=[{"box": [[0.95, 0.0], [1.0, 0.2]]}],
        gauge=[{"x": 0.5}],
        sensor=[{"at": [0.1, 0.1]}],
        gate=[{"x": 0.3, "speed": 1.0}],
        reference={"surface": str(tmp_path / "lab.csv")},
    ).to_dict()
    good = 0
    for path in leaves(whole):
        for odd in ODD:
            tables = copy.deepcopy(whole)
            target = tables
            for key in path[:-1]:
                target = target[key]
            target[path[-1]] = odd
            try:
                rules.require(load(tables))
                good += 1
            except CaseError as error:
                assert str(error) and "pydantic" not in str(error)
    assert good > 20


def test_a_title_is_shown_as_it_is(tmp_path):
    case = tank(case={"name": "tank", "title": r"$\undefined and 50 % of $"})
    draw(case, tmp_path / "section.png")
    assert (tmp_path / "section.png").exists()
