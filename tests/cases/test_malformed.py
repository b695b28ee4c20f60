"""What no case file should hold ends in a CaseError: a slice of the campaign, and what users have written."""

import os
import runpy
from pathlib import Path

import pytest
from rich.console import Console

from houle.case import describe
from houle.case.model import load
from houle.check import rules
from houle.errors import CaseError

CAMPAIGN = runpy.run_path(str(Path(__file__).parent.parent / "campaigns" / "case_files.py"))
BASE = {
    "case": {"name": "a"},
    "domain": {"size": [4.0, 0.5], "spacing": 0.05},
    "water": [{"below": 0.3}],
    "time": {"end": 1.0},
}


@pytest.mark.parametrize("seed", [1, 2])
def test_mutated_files_are_read_or_refused(seed):
    said = []
    assert CAMPAIGN["campaign"](100, seed, say=said.append) == 0, "\n".join(said)


def test_the_campaign_finds_a_fault(monkeypatch, tmp_path):
    """It would be of no use otherwise: an exception that is no CaseError, and a loop without end."""

    def spoiled(*_):
        raise KeyError("x")

    def endless(*_):
        while True:
            pass

    try_one = CAMPAIGN["try_one"]
    monkeypatch.setitem(try_one.__globals__, "look", spoiled)
    assert "KeyError" in try_one(b"", tmp_path, False)
    monkeypatch.setitem(try_one.__globals__, "look", endless)
    monkeypatch.setitem(try_one.__globals__, "LIMIT", 0.1)
    assert "more than 0.1 s" in try_one(b"", tmp_path, False)


@pytest.mark.parametrize("title", ["a\0b", "\x1b[31mred", "half \ud800", "\x7f"])
def test_a_title_with_a_control_character_is_refused(title):
    with pytest.raises(CaseError, match=r"case.title = .* holds a control character"):
        load({**BASE, "case": {"name": "a", "title": title}})
    assert load({**BASE, "case": {"name": "a", "title": "Éperon, 5 µm, 波"}}).case.title


@pytest.mark.parametrize(
    ("tables", "key"),
    [
        ({"open": [{"side": "left", "file": "FILE"}]}, r"open\.left\.file"),
        ({"waves": {"kind": "series", "depth": 0.3, "file": "FILE", "zone": {"x": [0.0, 2.0]}}}, r"waves\.file"),
        ({"reference": {"surface": "FILE"}}, r"reference\.surface"),
    ],
)
@pytest.mark.parametrize("file", ["/dev/zero", "/dev/null", "fifo", "folder", "a" * 5000, "no.csv"])
def test_what_is_no_file_is_refused_and_not_read_for_ever(tmp_path, tables, key, file):
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "folder").mkdir()
    name = file if file.startswith(("/", "a", "no")) else str(tmp_path / file)
    text = load({**BASE, **tables}).to_toml().replace("FILE", name)
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(CaseError, match=rf"^{key} = "):  # no blank inside the key
        rules.require(load(tmp_path / "a.toml"))


@pytest.mark.parametrize("source", ["x" * 5000, "a\0b", "/dev/zero", "/dev/null"])
def test_a_case_that_is_no_file_is_refused(source):
    with pytest.raises(CaseError) as error:
        load(source)
    assert len(str(error.value)) < 700


def test_names_and_titles_of_thousands_of_letters_are_refused_with_their_length():
    for head in ({"name": "a" * 5000}, {"name": "a", "title": "b" * 5000}):
        with pytest.raises(CaseError, match="has 5000 letters: at most"):
            load({**BASE, "case": head})


def test_names_in_brackets_are_printed():
    console = Console(record=True, width=200)
    describe.makers(console)
    text = console.export_text()
    assert "[[absorber]]" in text and "[[sponge]]" in text
