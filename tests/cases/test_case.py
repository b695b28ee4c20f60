"""The case file: what it accepts, what it fills in, and what it says when something is wrong."""

import copy
import json
import sys
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from houle.case.model import Case, load, schema
from houle.case.reading import find, parse_override, shipped
from houle.errors import CaseError
from houle.flow.schemes import SCHEMES

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

DAM = {
    "case": {"name": "dam-break"},
    "domain": {"size": [0.892, 0.58], "spacing": 0.005, "walls": "slip"},
    "water": [{"box": [[0.0, 0.0], [0.29, 0.35]]}, {"below": 0.025}],
    "porous": [
        {
            "name": "dam",
            "box": [[0.30, 0.0], [0.59, 0.37]],
            "porosity": 0.49,
            "grain_diameter": 0.0159,
            "resistance": {"law": "jensen-2014"},
        }
    ],
    "gauge": [{"x": 0.4}, {"name": "end", "x": 0.8}],
    "sensor": [{"at": [0.45, 0.05]}],
    "time": {"end": 2},
}


def dam(**overrides):
    return load(copy.deepcopy(DAM), {k.replace("__", "."): v for k, v in overrides.items()})


def test_defaults_and_names_are_filled_in():
    case = dam()
    assert case.case.name == "dam-break" and case.time.end == 2.0 and isinstance(case.time.end, float)
    assert (case.fluid.density, case.fluid.viscosity, case.fluid.gravity) == (1000.0, 1e-6, 9.81)
    assert [g.name for g in case.gauge] == ["G1", "end"] and case.sensor[0].name == "P1"
    assert (
        case.porous[0].added_mass == 0.34
        and case.porous[0].added_mass_on == "motion"
        and case.reference is None
        and case.path is None
    )
    assert case.acceleration == (0.0, -9.81)
    assert case.domain.grid.shape == (178, 116)


def test_a_case_cannot_be_changed():
    with pytest.raises(Exception, match="frozen"):
        dam().domain.spacing = 0.01


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_scheme_sets_its_keys_and_single_keys_override(scheme):
    numerics = dam(numerics__scheme=scheme).numerics
    assert {k: getattr(numerics, k) for k in SCHEMES[scheme].takes} == SCHEMES[scheme].takes
    changed = dam(numerics__scheme=scheme, numerics__transfer="apic", numerics__remesh_every=7).numerics
    assert (changed.transfer, changed.remesh_every, changed.kernel) == ("apic", 7, SCHEMES[scheme].takes["kernel"])


def test_the_default_scheme_is_houle():
    assert dam().numerics == dam(numerics__scheme="houle").numerics


def test_walls_are_one_word_for_all_or_a_table():
    case = dam()
    assert case.domain.walls.no_slip(2) == ((False, False), (False, False)) and case.domain.periodic == (False, False)
    case = dam(domain__walls={"bottom": "no-slip", "x": "periodic"})
    assert case.domain.walls.no_slip(2) == ((False, False), (True, False)) and case.domain.periodic == (True, False)
    assert dam(domain__walls="no-slip").domain.walls.no_slip(3) == ((True, True),) * 3


def test_the_toml_it_writes_gives_the_same_case():
    for case in (dam(), dam(domain__walls={"x": "periodic"}), dam(time={"end": 1.0, "step": 0.01})):
        again = load(tomllib.loads(case.to_toml()))
        assert again == case and again.hash == case.hash


def test_the_hash_follows_the_numbers():
    assert dam().hash == dam(fluid__density=1000).hash != dam(porous__dam__porosity=0.48).hash
    assert len(dam().hash) == 16


def test_overrides_reach_bodies_by_name_and_by_number():
    case = dam(porous__dam__porosity=0.4, gauge__0__x=0.1, gauge__end__x=0.7, domain__size=[1.0, 0.6])
    assert case.porous[0].porosity == 0.4 and [g.x for g in case.gauge] == [0.1, 0.7]
    assert load(case, {"porous[0].added_mass": 0.5}).porous[0].added_mass == 0.5
    assert load(copy.deepcopy(DAM), {"domain.size[0]": 2.0}).domain.size == (2.0, 0.58)


def test_numbers_of_numpy_and_paths_are_taken():
    case = dam(
        domain__spacing=np.float32(0.25),
        domain__size=np.array([0.75, 0.5]),
        numerics__order=np.int64(3),
        reference={"surface": Path("lab.csv")},
    )
    assert (case.domain.spacing, case.domain.size, case.numerics.order) == (0.25, (0.75, 0.5), 3)
    assert case.reference.surface == "lab.csv" and load({**DAM, "time": {"end": np.float32(2.0)}}).time.end == 2.0


@pytest.mark.parametrize(
    ("source", "overrides", "words"),
    [
        (3, None, r"case = 3: give a file, the name of a shipped case, a dict"),
        (None, None, r"case = None: give a file"),
        (DAM, ["domain.spacing=0.01"], r"overrides = .*: give a dict of keys and values"),
        (DAM, {3: 0.01}, r"overrides = \{3: 0.01\}: give a dict"),
    ],
)
def test_what_is_no_case_and_no_override_is_told_as_such(source, overrides, words):
    with pytest.raises(CaseError, match=words):
        load(source, overrides)


def test_overrides_of_a_case_replace_what_excludes_them():
    case = dam(numerics__flip=0.5)
    assert (
        load(case, {"numerics.scheme": "jh2020"}).numerics
        == dam(numerics__scheme="jh2020", numerics__flip=0.5).numerics
    )
    fixed = load(case, {"time.step": 0.01})
    assert fixed.time.step == 0.01 and load(fixed, {"time.courant": 0.3}).time.step is None


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("domain.spacing=0.01", ("domain.spacing", 0.01)),
        ("time.end = 3", ("time.end", 3)),
        ("domain.size=[1, 2]", ("domain.size", [1, 2])),
        ("numerics.transfer=pic", ("numerics.transfer", "pic")),
        ('case.title="a b"', ("case.title", "a b")),
        ("output.movie=true", ("output.movie", True)),
    ],
)
def test_set_takes_toml_values(text, expected):
    assert parse_override(text) == expected


@pytest.mark.parametrize("text", ["domain.spacing", "=3", "domain.spacing=", "time.end=2 s"])
def test_set_refuses_what_is_not_a_value(text):
    with pytest.raises(CaseError, match="--set"):
        parse_override(text)


# key set, and what the one message must hold: the key and its value, the range, the cure
BAD = [
    ("porous.dam.porosity", 39, ["porous.dam.porosity = 39", "0 < porosity <= 1", "Did you mean 0.39?"]),
    ("porous.dam.porosity", 0, ["porous.dam.porosity = 0", "0 < porosity <= 1"]),
    ("porous.dam.porosity", -0.2, ["porosity = -0.2", "0 < porosity <= 1"]),
    ("porous.dam.porosity", "0.4", ['porosity = "0.4"', "a number", "without quotes"]),
    ("porous.dam.porosity", float("nan"), ["porosity = nan", "finite", "0 < porosity <= 1"]),
    ("porous.dam.grain_diameter", 15.9, ["= 15.9", "[m]", "Did you mean 0.0159 (15.9 mm)?"]),
    ("porous.dam.porosty", 0.4, ["porous.dam.porosty", 'Did you mean "porosity"?']),
    ("porous.dam.d50", 0.02, ["porous.dam.d50", 'Did you mean "grain_diameter"?']),
    ("porous.dam.resistance.law", "ergun", ['"ergun"', 'Did you mean "ergun-1952"?', "van-gent-1995"]),
    ("porous.dam.resistance.law", "Jensen-2014", ['"Jensen-2014"', 'Did you mean "jensen-2014"?']),
    ("porous.dam.added_mass_on", "rat", ['"rat"', 'Did you mean "rate"?']),
    ("porous.dam.resistance", {"a": 1.0}, ["porous.dam.resistance", "both a and b"]),
    ("porous.dam.resistance", {"law": "ergun-1952", "kc": 10.0}, ["kc does not belong to ergun-1952"]),
    ("porous.dam.resistance", {"law": "olaflow", "a": 1.0, "b": 2.0}, ["law, a, b given"]),
    ("porous.dam.box", [[0.59, 0.0], [0.3, 0.37]], ["porous.dam.box", "empty", "lower corner"]),
    ("porous.dam.below", 0.1, ["porous.dam", "box and below are given together", "exactly one"]),
    ("domain.spacing", 5, ["domain.spacing = 5", "0.892 x 0.58 m", "Did you mean 0.005 (5 mm)?"]),
    ("domain.spacing", 0.0, ["domain.spacing = 0.0", "0 < spacing [m]"]),
    ("domain.spacing", float("inf"), ["domain.spacing = inf", "finite"]),
    ("domain.spacing", 1e-9, ["spacing = 1e-09 makes 5.2e+17 cells", "at most 1e+15", "from spacing = 2.3e-08 m on"]),
    ("domain.spacing", 1e-300, ["domain.spacing = 1e-300 is beyond any measure", "between 1e-20 and 1e+20"]),
    ("domain.size", [0.892], ["domain.size", "at least 2"]),
    ("domain.size", [0.892, -0.58], ["domain.size[1] = -0.58", "0 < size"]),
    ("domain.walls", "open", ['domain.walls = "open"', '"slip", "no-slip"', "[[open]]"]),
    ("domain.walls", {"x": "periodic", "left": "slip"}, ["domain.walls.left", "periodic"]),
    ("domain.walls", {"y": "periodic"}, ["domain.walls", "3D only"]),
    ("fluid.viscosity", 1.0, ["fluid.viscosity = 1.0", "[m2/s]", "Did you mean 1e-06 (1 mm2/s)?"]),
    ("fluid.density", 1.0, ["fluid.density = 1.0", "Did you mean 1000.0 (1 g/cm3)?"]),
    ("fluid.gravity", -9.81, ["fluid.gravity = -9.81", "Did you mean 9.81?"]),
    ("water", [], ["water", "at least 1"]),
    ("sensor.0.at", [0.4, 0.1, 0.2], ["sensor.P1.at has 3 numbers", "give 2"]),
    ("gauge.0.y", 0.1, ["gauge.G1.y", "2D"]),
    ("gauge.0.name", "end", ["gauge", "end is given twice"]),
    ("gauge.1.name", "my gauge", ['gauge[1].name = "my gauge" is not a name']),
    (
        "waves",
        {"kind": "regular", "height": 0.04, "depth": 0.25, "source": {"x": 0.4}},
        ["waves.period is missing", "1.2"],
    ),
    (
        "waves",
        {"kind": "regular", "height": 0.04, "period": 1.0, "depth": 0.25, "direction": 20.0, "source": {"x": 0.4}},
        ["waves.direction = 20 degrees in 2D", "remove it"],
    ),
    ("sponge", [{}], ["sponge[0].box is missing", "one end at a side"]),
    ("sponge", [{"box": [[0.8, 0.0], [0.5, 0.58]]}], ["sponge[0].box", "is empty", "lower corner"]),
    ("sponge", [{"box": [[0.5, 0.0, 0.0], [0.8, 0.1, 0.58]]}], ["sponge.sponge-1.box has corners of 3", "give 2"]),
    ("numerics.transfer", "flop", ['"flop"', '"fmpm"', 'Did you mean "flip"?']),
    ("numerics.order", 2.5, ["numerics.order = 2.5", "whole number", "1 <= order <= 20"]),
    ("numerics.scheme", "paper", ['numerics.scheme = "paper"', '"houle", "jh2020"']),
    ("time", {"end": 2.0, "step": 0.01, "courant": 0.5}, ["time.step", "courant", "keep one"]),
    ("time", {}, ["time.end is missing", "[s]"]),
    ("time.end", "2 s", ['time.end = "2 s"', "a number", "[s]"]),
    ("time.end", 10**400, ["time.end = 1000", " ... 000"]),
    ("time.end", ".", ['time.end = "." is of the wrong kind: a number is needed, 0 < end <= 1e+06 [s].']),
    ("numerics.flip", 1.5, ["numerics.flip = 1.5 is outside 0 <= flip <= 1."]),
    ("numerics.flip", 95, ["numerics.flip = 95 is outside 0 <= flip <= 1. Did you mean 0.95?"]),
    ("output.movie", 1, ["output.movie = 1", "true or false"]),
    ("porous", {"box": []}, ["porous", "Write [[porous]] instead of [porous]"]),
    ("case.name", "my case", ['case.name = "my case"', "letters, digits"]),
    ("fluid.acceleration", [1.0], ["fluid.acceleration", "at least 2"]),
    ("colour", "blue", ["colour is not a key", "domain"]),
]


@pytest.mark.parametrize(("key", "value", "words"), BAD, ids=[f"{k}-{v}"[:40] for k, v, _ in BAD])
def test_bad_input_is_one_message_with_key_value_range_and_cure(key, value, words):
    with pytest.raises(CaseError) as caught:
        load(copy.deepcopy(DAM), {key: value})
    message = str(caught.value)
    assert "\n" not in message
    assert all(word in message for word in words), message


def test_several_findings_are_told_at_once_but_not_all():
    with pytest.raises(CaseError) as caught:
        dam(porous__dam__porosity=49, domain__spacing="5 mm", fluid__densty=3)
    assert len(str(caught.value).split("\n")) == 3
    with pytest.raises(CaseError, match=r"\.\.\. and 4 more"):
        load(copy.deepcopy(DAM), {f"fluid.wrong{i}": 1 for i in range(9)})


def test_a_porous_body_without_a_name_is_called_by_its_number():
    tables = copy.deepcopy(DAM)
    del tables["porous"][0]["name"]
    assert load(tables).porous[0].name == "porous-1"
    with pytest.raises(CaseError, match=r"^porous\[0\]\.porosity = 39 "):
        load(tables, {"porous.0.porosity": 39})


def test_a_law_needs_grains():
    tables = copy.deepcopy(DAM)
    del tables["porous"][0]["grain_diameter"]
    with pytest.raises(CaseError, match=r"porous\.dam\.grain_diameter is missing"):
        load(tables)
    assert load(tables, {"porous.dam.resistance": {"a": 1.0, "b": 100.0}}).porous[0].grain_diameter is None


@pytest.mark.parametrize("key", ["porous.wall.porosity", "porous.3.porosity", "gauge.none.x", "case.name.first"])
def test_an_override_that_finds_nothing_says_what_there_is(key):
    with pytest.raises(CaseError, match="--set"):
        load(copy.deepcopy(DAM), {key: 1})


def test_invalid_toml_is_told_with_its_line(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text('[case]\nname = "x"\nsize = [1, 2\n[time]\n')
    with pytest.raises(CaseError, match=r"not valid TOML.*line 4.*\[time\]"):
        load(file)


def test_files_as_windows_writes_them(tmp_path):
    file = tmp_path / "case.toml"
    file.write_bytes(b"\xef\xbb\xbf" + dam().to_toml().replace("\n", "\r\n").encode())
    assert load(file).hash == dam().hash


def test_what_makes_waves_needs_gravity():
    with pytest.raises(CaseError, match=r"fluid.gravity = 0 m/s2: .*\[open\] needs them: gravity >= 0.001"):
        dam(fluid__gravity=0.0, open=[{"side": "left", "level": 0.1}])


def test_files_that_cannot_be_read(tmp_path):
    (tmp_path / "latin.toml").write_bytes(b'[case]\ntitle = "d\xe9bit"\n')
    with pytest.raises(CaseError, match="UTF-8"):
        load(tmp_path / "latin.toml")
    with pytest.raises(CaseError, match="is a folder"):
        load(tmp_path)
    with pytest.raises(CaseError, match="no such file"):
        load(tmp_path / "none.toml")
    with pytest.raises(CaseError, match='Did you mean "dam-break-rock-35"'):
        load("dam-break-rock35")


def test_a_file_is_remembered(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(dam().to_toml())
    assert load(file).path == file and load(str(file), {"time.end": 1.0}).path == file


@pytest.mark.parametrize("name", shipped())
def test_shipped_cases_load_and_fit_their_schema(name):
    case = load(name)
    assert isinstance(case, Case) and case.case.name == name and case.path == find(name)
    jsonschema.validate(tomllib.loads(case.path.read_text(encoding="utf-8")), schema())


def test_the_schema_knows_units_ranges_and_refuses_what_we_refuse():
    published = json.loads(json.dumps(schema()))
    jsonschema.Draft202012Validator.check_schema(published)
    jsonschema.validate(DAM, published)
    for key, value in (("porosity", 39), ("porosty", 0.3)):
        wrong = copy.deepcopy(DAM)
        wrong["porous"][0][key] = value
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(wrong, published)
    numbers = [
        (table, key, entry)
        for table, definition in published["$defs"].items()
        for key, entry in definition.get("properties", {}).items()
        if entry.get("type") == "number"
    ]
    assert len(numbers) > 15
    assert all("[" in entry["description"] for _, _, entry in numbers)
