"""What the site is made of: keys from the models, headers from their comments, docstrings, commands that are run.

None of this needs Sphinx; .ci/run builds the site itself, without warnings.
"""

import copy
import re
import sys
from importlib import import_module
from pathlib import Path

import headers
import keys
import pages
import pytest
import shell
from docstrings import rst

from houle.case import describe
from houle.fields import Field
from houle.registry import choices

CASE_FILE = pages.DOCS / "case-file.md"


def page_of(name: str, tmp_path: Path) -> tuple[str, pages.Page]:
    """A page of docs/ as the site shows it."""
    page = pages.Page(pages.DOCS / name, tmp_path)
    return pages.filled(page.path.read_text(encoding="utf-8"), page), page


def test_every_table_and_key_of_the_case_file_is_shown_once(tmp_path):
    text, page = page_of("case-file.md", tmp_path)
    everything = [*keys.tables(), *keys.parts()]
    assert sorted(page.tables) == sorted(everything)
    rows = [line.split("|")[1].strip() for line in text.splitlines() if line.startswith("| `")]
    assert sorted(rows) == sorted(f"`{key}`" for table in everything for key in keys.keys_of(table))


def test_values_units_and_defaults_are_those_of_the_models():
    table = keys.markdown("time")
    assert "| `end` | number above 0, up to 1e+06 | s | – |" in table
    assert "| `courant` | number above 0, up to 1 |  | `0.5` |" in table
    assert "| `step` | number above 0 | s | *none* |" in table
    waves = keys.markdown("waves")
    assert '`"regular"`, `"solitary"`, `"jonswap"`' in waves
    assert "| `direction` | number above -90, below 90 | degrees | `0.0` |" in waves
    assert '| `walls` | `"slip"`, `"no-slip"` or table |  | `"slip"` |' in keys.markdown("domain")
    assert "| `box` | two lists of 2 or 3 numbers | m |" in keys.markdown("sponge")
    assert "m³, in 2D m²" in keys.markdown("reference")


@pytest.mark.parametrize("key", ["scheme", "transfer", "kernel", "remesh"])
def test_every_choice_of_the_numerics_is_named(key):
    row = next(line for line in keys.markdown("numerics").splitlines() if line.startswith(f"| `{key}` |"))
    named = re.findall(r'`"([a-z0-9-]+)"`', row.split(" | ")[1])
    assert named == list(choices(key))


def test_a_new_table_and_a_new_key_appear_by_themselves(tmp_path, monkeypatch):
    schema = copy.deepcopy(keys.schema())
    probe = {"type": "number", "description": "where it stands [m]"}
    schema["$defs"]["Probe"] = {
        "description": "[[probe]]: salinity at a point.", "properties": {"x": probe}, "required": ["x"],
    }  # fmt: skip
    schema["properties"]["probe"] = {"type": "array", "items": {"$ref": "#/$defs/Probe"}}
    schema["$defs"]["Gauge"]["properties"]["filter"] = {"type": "boolean", "default": False, "description": "smooth it"}
    monkeypatch.setattr(keys, "schema", lambda: schema)
    text, _ = page_of("case-file.md", tmp_path)
    assert "### [[probe]]\n\nsalinity at a point.\n\n" in text
    assert "| `x` | number | m | – | where it stands |" in text
    assert "| `filter` | `true` or `false` |  | `false` | smooth it |" in text


def test_a_note_about_a_key_that_is_not_there_is_an_error():
    with pytest.raises(ValueError, match=r"\[gate\] has no key 'colour': it has x, speed, start"):
        keys.markdown("gate", {"colour": "green"})


def test_every_variable_that_a_run_writes_is_shown(tmp_path, monkeypatch):
    probe = Field("salinity", "S", "1", "sensor", "share of salt")
    known = [*describe.everything_written(), probe]
    monkeypatch.setattr(describe, "everything_written", lambda: known)
    text, _ = page_of("conventions.md", tmp_path)
    for field in known:
        assert f"`{field.name}`" in text or field.place == "face" or field.name == "time", field.name
    assert "| `salinity` | sensor | 1 | share of salt |" in text


def test_every_public_name_is_on_a_page():
    for module, name in (
        ("houle", "api/houle.md"),
        ("houle.analysis", "api/analysis.md"),
        ("houle.design", "api/design.md"),
    ):
        page = pages.Page(pages.DOCS / name, Path())
        pages.filled(page.path.read_text(encoding="utf-8"), page)
        assert sorted(page.names) == sorted(f"{module}.{n}" for n in import_module(module).__all__)


def test_every_design_formula_is_in_the_table(tmp_path):
    text, _ = page_of("design.md", tmp_path)
    for row in choices("formula").values():
        line = next(line for line in text.splitlines() if line.startswith(f"| `{row.call}` |"))
        assert len(re.findall(r"(?<!\\)\|", line)) == 5  # four cells
        assert ("RECALLED" in line) == ("RECALLED" in row.status)


def test_every_public_header_is_on_a_page_and_says_what_it_is(tmp_path):
    shown = "".join(page_of(f"api/core/{room.stem}.md", tmp_path)[0] for room in pages.DOCS.glob("api/core/*.md"))
    found = headers.public(pages.ROOT / "core")
    assert len(found) > 20
    for path in found:
        assert f"## `{path.relative_to(pages.ROOT / 'core').as_posix()}`" in shown
        assert headers.read(path).comment, path


def test_a_header_is_read_as_it_is_written(tmp_path):
    source = """// Waves in a box.
//
// Two paragraphs.
#pragma once

#include "grid.hpp"

namespace houle {

// A box of `cells`, none of them * or _ as markup.
struct Box {
  double size;  // [m]
};

// Height [m] at x.
template <int D, class Real = float>
inline Real height(const Box& box, double x, int order = {}) {
  if (x < 0.0) {
    return Real{};  // }
  }
  return box.size;
}

namespace detail {
inline int hidden() { return 1; }
}  // namespace detail

// Solves it.
template <int D>
class Solver {
 public:
  explicit Solver(const Box& box) : box_(box) {}

  // Once more.
  void again(int times) { times_ = times; }

 private:
  Box box_;
  int times_ = 0;
};

}  // namespace houle
"""
    path = tmp_path / "box.hpp"
    path.write_text(source)
    header = headers.read(path)
    assert header.comment == "Waves in a box.\n\nTwo paragraphs."
    box, height, solver = header.items
    assert [item.name for item in header.items] == ["Box", "height", "Solver"]
    assert box.text == "struct Box {\n  double size;  // [m]\n};"
    assert height.text == (
        "template <int D, class Real = float>\nReal height(const Box& box, double x, int order = {})"
    )
    assert [member.text for member in solver.members] == ["void again(int times)"]
    text = headers.markdown(header, "box.hpp", 2)
    assert text.startswith("## `box.hpp`\n\nWaves in a box.")
    assert r"A box of `cells`, none of them \* or \_ as markup." in text


def test_docstrings_become_lists_and_code_and_nothing_else():
    lines = ["Sum of |u| over `cells`.", "", "depth     of still water [m]", "          at the gauges", "Raises it."]
    assert rst(lines) == [
        r"Sum of \|u\| over ``cells``.", "",
        "", "* ``depth``: of still water [m] at the gauges", "", "", "Raises it.",
    ]  # fmt: skip
    assert rst(["height  of it [m]     target  of that [m]"]) == [
        "", "* ``height``: of it [m]", "* ``target``: of that [m]", "",
    ]  # fmt: skip


def test_parts_of_other_documents_lead_where_they_led(tmp_path):
    text, _ = page_of("get-started.md", tmp_path)
    assert "(pictures/dam-break-rock-35-pressure.png)" in text
    assert "(conventions.md)" in text and "(docs/" not in text
    assert "(../LICENSE)" in text and "(contributing.md)" in text


@pytest.mark.skipif(sys.platform == "win32", reason="pages are built where there is a POSIX shell")
def test_commands_of_a_page_are_run_and_shown(tmp_path):
    page = pages.Page(CASE_FILE, tmp_path / "work")
    text = pages.filled("```{file} a.txt\none\ntwo\n```\n\n```{run}\n:after: t\ncat a.txt\n```\n", page)
    assert "```console\n$ cat a.txt\n```\n\n```text\ntwo\n```" in text
    with pytest.raises(ValueError, match="status 3"):
        pages.filled("```{run}\nexit 3\n```\n", pages.Page(CASE_FILE, tmp_path / "other"))
    with pytest.raises(ValueError, match="status 0"):
        pages.filled("```{run}\n:fails: yes\ntrue\n```\n", pages.Page(CASE_FILE, tmp_path / "third"))
    with pytest.raises(ValueError, match=r"left no b\.png"):
        pages.filled("```{picture} b.png\n```\n", pages.Page(CASE_FILE, tmp_path / "fourth"))


@pytest.mark.skipif(sys.platform == "win32", reason="pages are built where there is a POSIX shell")
def test_what_was_run_is_kept_only_for_the_same_commands(tmp_path):
    def drawn(script: str) -> str:
        return shell.Shell(tmp_path, script, kept=True).run("echo $RANDOM$RANDOM$RANDOM").output

    first = drawn("a")
    assert drawn("a") == first
    assert drawn("b") != first
