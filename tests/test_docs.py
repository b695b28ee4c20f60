"""The documents tell what is there: links that lead somewhere, a case file that works."""

import re
from pathlib import Path

import pytest

from houle.case.model import load
from houle.case.reading import shipped, tomllib
from houle.check import rules
from houle.cli import app

ROOT = Path(__file__).parent.parent
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("src/**/*.md")])
README = (ROOT / "README.md").read_text(encoding="utf-8")


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
    assert len(blocks) == 3
    for command in " && ".join(blocks).split(" && "):
        assert command in script or command == "pip install .", command  # done by the install of the tests
