"""The documents tell what is there: every key, every field, links that lead somewhere, a case file that works."""

import re
from pathlib import Path

import pytest
from pydantic import BaseModel

from houle import fields
from houle.case.model import Case, load
from houle.case.reading import shipped, tomllib
from houle.case.tables import control, observed, results, sides, tank
from houle.case.tables.waves import Focus, Piston, Source, Waves, Zone
from houle.check import rules
from houle.cli import app
from houle.registry import choices

ROOT = Path(__file__).parent.parent
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("src/**/*.md")])
README = (ROOT / "README.md").read_text(encoding="utf-8")
KEYS = (ROOT / "docs" / "case-file.md").read_text(encoding="utf-8")
CONVENTIONS = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8")

TABLES = {
    "case": tank.Head, "domain": tank.Domain, "fluid": tank.Fluid, "water": tank.Water, "porous": tank.Porous,
    "solid": tank.Solid, "gate": tank.Gate, "open": sides.Open, "waves": Waves, "absorber": tank.Absorber,
    "sponge": tank.Sponge, "gauge": observed.Gauge, "sensor": observed.Sensor, 
    "runup": observed.RunUp, "overtopping": observed.Overtopping, "force": observed.Force,
    "phreatic": observed.Phreatic, "flux": observed.Flux, "time": control.Time, "numerics": control.Numerics,
    "output": control.Output, "reflection": results.Reflection, "reference": results.Reference,
}  # fmt: skip


def test_every_table_and_key_of_the_case_file_is_described():
    assert TABLES.keys() == Case.model_fields.keys()
    for name, model in TABLES.items():
        assert f"[{name}]" in KEYS
        for key in model.model_fields:
            assert f"`{key}`" in KEYS, f"{name}.{key} is missing in docs/case-file.md"
    for model in (Source, Zone, Piston, Focus):
        for key in model.model_fields:
            assert f"{model.__name__.lower()} `{key}`" in KEYS or f"| `{key}` |" in KEYS, (
                f"waves.{model.__name__}.{key}"
            )
    for key in [*tank.Resistance.model_fields, *tank.Walls.model_fields]:
        assert re.search(rf"\b{key}\b", KEYS), key


@pytest.mark.parametrize("name", sorted(set(TABLES) - {"numerics"}))  # those are the scheme's
def test_defaults_are_those_of_the_program(name):
    model: type[BaseModel] = TABLES[name]
    for key, field in model.model_fields.items():
        if isinstance(field.default, bool | int | float):
            text = str(field.default).lower()
            assert re.search(rf"\| `{key}` \| `{re.escape(text)}` \|", KEYS), f"{name}.{key}: default {text}"


def test_every_choice_of_the_numerics_is_named():
    section = KEYS.partition("### [numerics]")[2].partition("\n### ")[0]
    for key in ("scheme", "transfer", "kernel", "remesh"):
        row = next(line for line in section.splitlines() if line.startswith(f"| `{key}` |"))
        named = set(re.findall(r'`"([a-z0-9-]+)"`', row))
        assert named == set(choices(key)), key


def test_every_field_is_described():
    for field in fields.FIELDS:
        assert f"`{field.name}`" in CONVENTIONS or field.place == "face" or field.name == "time", field.name


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(document):
    for target in re.findall(r"\]\(([^)#\s]+)\)", document.read_text(encoding="utf-8")):
        assert "://" in target or (document.parent / target).exists(), target


def test_the_case_file_of_the_readme_is_a_good_case():
    example = re.search(r"```toml\n(.*?)```", README, re.DOTALL)
    assert example
    rules.require(load(tomllib.loads(example.group(1))))  # raises CaseError


def test_the_readme_names_every_command_and_case():
    commands = {info.name or info.callback.__name__ for info in app.registered_commands if info.callback}
    assert commands == set(re.findall(r"\| `houle (\w+)", README))
    assert set(shipped()) <= set(re.findall(r"`([a-z0-9-]+)`", README))


def test_the_ci_runs_the_commands_of_the_readme():
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    blocks = re.findall(r"```\n(pip install .*?)\n```", README)
    assert len(blocks) == 2
    for command in " && ".join(blocks).split(" && "):
        assert command in script or command == "pip install .", command  # done by the install of the tests
