"""Blocks in the Markdown of docs/ that are filled when the site is built.

A block is fenced like code, so that a page can be read in the repository as it is:

    ```{keys} sponge            the keys of a table of the case file; the lines of the block are notes, "key: what else"
    ```{other-tables}           tables of the case file that the page does not show by themselves
    ```{other-fields}           variables that a run writes and the page does not name
    ```{part} ../README.md      sections of another document, one title a line
    ```{names} houle            documentation of public names, one or more a line
    ```{formulas}               the table of design formulas
    ```{headers} grid           public headers of a room of core/houle
    ```{cases}                  shipped cases, each with its README and its case file
    ```{decisions}              the list of decisions
    ```{file} crib.toml         a file in the page's own folder, from where its commands are run
    ```{run}                    commands, run in that folder; their output is shown
    ```{output}                 another part of what the commands before printed
    ```{picture} a.png          a picture that they left; the lines of the block are its caption
    ```{took}                   how long the commands of the page took

Each is a function of Page and Block that returns Markdown.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import dataclass, field, is_dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path

import headers
import keys
import shell

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
CASES = ROOT / "src" / "houle" / "validation"
FENCE = re.compile(r"^(`{3,})\{([\w-]+)\}[ \t]*(.*)\n((?:.*\n)*?)\1[ \t]*$", re.MULTILINE)
# Documents outside docs/ and the pages that take them up.
HOMES = {
    "README.md#validation": "validation.md#measured",
    "README.md": "get-started.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}


@dataclass
class Block:
    argument: str
    options: dict[str, str]
    lines: list[str]


@dataclass
class Page:
    """A page that is being read: its path, what it has shown so far, and the folder of its commands."""

    path: Path
    work: Path
    tables: list[str] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    sources: list[Path] = field(default_factory=list)
    output: str = ""
    seconds: float = 0.0

    @cached_property
    def shell(self) -> shell.Shell:
        text = self.path.read_text(encoding="utf-8")
        blocks = (found for found in FENCE.finditer(text) if found[2] in ("file", "run"))
        script = "".join(f"{found[3]}\n" + re.sub(r"^:.*\n", "", found[4], flags=re.MULTILINE) for found in blocks)
        return shell.Shell(self.work, script, kept="HOULE_SITE_KEEP" in os.environ)

    def relative(self, path: Path) -> str:
        """A path as the page writes it."""
        return Path(*[".."] * len(self.path.parent.relative_to(DOCS).parts), path.relative_to(DOCS)).as_posix()


def filled(text: str, page: Page) -> str:
    """The text of a page with its blocks filled, top to bottom. Raises ValueError with the block that is wrong."""
    return FENCE.sub(lambda found: _fill(found, page), at_home(text, page))


def _fill(found: re.Match[str], page: Page) -> str:
    make = BLOCKS.get(found[2])
    if make is None:
        return found[0]
    lines = found[4].splitlines()
    options = {}
    while lines and (option := re.match(r":([\w-]+):\s*(.*)$", lines[0])):
        options[option[1]] = option[2]
        lines.pop(0)
    return make(page, Block(found[3].strip(), options, lines))


def at_home(text: str, page: Page) -> str:
    """The text with links to documents that have a page here led to that page."""
    up = "../" * (len(page.path.parent.relative_to(DOCS).parts) + 1)
    for document, home in HOMES.items():
        text = text.replace(f"]({up}{document})", f"]({page.relative(DOCS / home)})")
    return text


def _keys(page: Page, block: Block) -> str:
    notes: dict[str, str] = {}
    key = ""
    for line in block.lines:
        if found := re.match(r"(\w+): (.*)", line):
            key = found[1]
            notes[key] = found[2]
        elif line.strip():
            notes[key] += f" {line.strip()}"
    only = block.options["only"].split() if "only" in block.options else None
    page.tables.append(block.argument)
    return keys.markdown(block.argument, notes, only)


def _other_tables(page: Page, block: Block) -> str:
    shown = []
    for table in [*keys.tables(), *keys.parts()]:
        if table not in page.tables:
            title = f"### [{table}]" if table in keys.parts() else f"### [[{table}]]"
            shown.append(f"{title}\n\n{keys.meaning_of(table)}\n\n{keys.markdown(table)}")
            page.tables.append(table)
    return "\n\n".join(shown)


def _other_fields(page: Page, block: Block) -> str:
    text = page.path.read_text(encoding="utf-8")
    rows = [
        f"| `{row.name}` | {row.place} | {row.unit}{f' ({row.unit_2d})' if row.unit_2d else ''} | {row.description} |"
        for row in import_module("houle.case.describe").everything_written()
        if f"`{row.name}`" not in text and row.place != "face" and row.name != "time"
    ]
    return "\n".join(["| variable | place | unit (2D) | meaning |", "|---|---|---|---|", *rows]) if rows else ""


def _part(page: Page, block: Block) -> str:
    """Sections of another document: `*` is what stands before its first section. Links lead to what they meant."""
    source = (page.path.parent / block.argument).resolve()
    page.sources.append(source)
    text = source.read_text(encoding="utf-8")
    pieces = re.split(r"^(?=## )", text, flags=re.MULTILINE)
    head = re.sub(r"^# .*\n", "", pieces[0]).strip()
    sections = {piece.splitlines()[0].removeprefix("## "): piece.strip() for piece in pieces[1:]}
    wanted = [line.strip() for line in block.lines if line.strip()] or ["*", *sections]
    if strange := [title for title in wanted if title != "*" and title not in sections]:
        raise ValueError(f"{block.argument} has no section {strange[0]!r}")
    found = "\n\n".join(head if title == "*" else sections[title] for title in wanted)
    if "bare" in block.options:
        found = re.sub(r"^## .*\n", "", found).strip()
    return _moved(found, source.parent, page)


def _moved(text: str, folder: Path, page: Page) -> str:
    """The text of a document in `folder` with its relative links as the page has to write them."""

    def moved(found: re.Match[str]) -> str:
        target, _, anchor = found[1].partition("#")
        if "://" in target or not target:
            return found[0]
        path = (folder / target).resolve()
        home = HOMES.get(path.relative_to(ROOT).as_posix())
        path = DOCS / home if home else path
        path = path / "index.md" if (path / "index.md").is_file() else path
        inside = path.is_relative_to(DOCS)
        up = "../" * (len(page.path.parent.relative_to(DOCS).parts) + 1)
        where = page.relative(path) if inside else up + path.relative_to(ROOT).as_posix()
        return f"]({where}{'#' + anchor if anchor else ''})"

    return re.sub(r"\]\(([^)\s]+)\)", moved, text)


def _names(page: Page, block: Block) -> str:
    module = import_module(block.argument)
    shown = []
    for name in " ".join(block.lines).split():
        kind = _kind(getattr(module, name))
        page.names.append(f"{block.argument}.{name}")
        options = "\n   :members:" if kind == "class" else ""
        options += "\n   :undoc-members:" if is_dataclass(getattr(module, name)) else ""
        shown.append(f".. auto{kind}:: {block.argument}.{name}{options}")
    return "```{eval-rst}\n" + "\n\n".join(shown) + "\n```"


def _kind(value: object) -> str:
    if isinstance(value, type):
        return "exception" if issubclass(value, BaseException) else "class"
    return "function" if callable(value) else "data"


def _formulas(page: Page, block: Block) -> str:
    rows = ["| formula | what it gives | range | source |", "|---|---|---|---|"]
    for row in import_module("houle.registry").choices("formula").values():
        checked = f"{row.source}. {row.status}"
        cells = (f"`{row.call}`", row.what, row.range or "–", f"{checked}. {row.scatter}" if row.scatter else checked)
        rows.append("| " + " | ".join(headers.escaped(cell) for cell in cells) + " |")
    return "\n".join(rows)


def _headers(page: Page, block: Block) -> str:
    core = ROOT / "core"
    found = [path for path in headers.public(core) if path.is_relative_to(core / "houle" / block.argument)]
    page.sources += found
    level = int(block.options.get("level", "3"))
    shown = [headers.markdown(headers.read(path), path.relative_to(core).as_posix(), level) for path in found]
    return "\n\n".join(shown)


def _cases(page: Page, block: Block) -> str:
    folders = sorted(path.parent for path in CASES.glob("*/case.toml"))
    return "\n\n".join(_case(page, folder) for folder in folders)


def _case(page: Page, folder: Path) -> str:
    text = (folder / "README.md").read_text(encoding="utf-8")
    case = (folder / "case.toml").read_text(encoding="utf-8")
    page.sources += [folder / "README.md", folder / "case.toml"]
    title, _, rest = text.partition("\n")
    rest = re.sub(r"^#", "###", rest, flags=re.MULTILINE)
    file = f"````{{dropdown}} case.toml\n```toml\n{case.strip()}\n```\n````"
    head = f"## {folder.name}\n\n**{title.removeprefix('# ')}**"
    return f"{head}\n\n{_moved(rest.strip(), folder, page)}\n\n{file}"


def _decisions(page: Page, block: Block) -> str:
    rows = []
    for path in sorted(page.path.parent.glob("[0-9]*.md")):
        title = path.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ")
        rows.append(f"{title} <{path.stem}>")
    return "```{toctree}\n:maxdepth: 1\n\n" + "\n".join(rows) + "\n```"


def _file(page: Page, block: Block) -> str:
    content = "\n".join(block.lines)
    page.shell.write(block.argument, content + "\n")
    language = Path(block.argument).suffix.removeprefix(".") or "text"
    return f"```{{code-block}} {language}\n:caption: {block.argument}\n\n{content}\n```"


def _run(page: Page, block: Block) -> str:
    commands = "\n".join(block.lines)
    result = page.shell.run(commands, fails="fails" in block.options)
    page.seconds += result.seconds
    page.output = result.output
    shown = f"```console\n{_prompted(block.lines)}\n```"
    return shown if "quiet" in block.options else f"{shown}\n\n{_output(page, block)}"


def _prompted(commands: list[str]) -> str:
    """Commands as a terminal shows them; what belongs to the line above has another prompt."""
    return "\n".join(f"{'>' if line.startswith((' ', 'done')) else '$'} {line}" for line in commands)


def _output(page: Page, block: Block) -> str:
    """What the last commands printed: all, or from the line that begins with `after` to the one with `until`, or so
    many `lines` of that."""
    text = shell.cut(page.output, block.options.get("after", ""), block.options.get("until", ""))
    lines = text.replace(f"{page.work}/", "").splitlines()
    most = int(block.options.get("lines", len(lines)))
    shown = [shell.wrapped(line) for line in lines[:most]] + ["..."] * (len(lines) > most)
    return "```text\n" + "\n".join(shown) + "\n```"


def _picture(page: Page, block: Block) -> str:
    path = page.work / block.argument
    if not path.is_file():
        raise ValueError(f"the commands of {page.path.name} left no {block.argument}")
    caption = " ".join(block.lines)
    where = Path(os.path.relpath(path, page.path.parent)).as_posix()
    return f"```{{figure}} {where}\n:alt: {caption}\n\n{caption}\n```"


def _took(page: Page, block: Block) -> str:
    return f"All commands of this page together took {page.seconds:.0f} s on the machine that built it."


BLOCKS: dict[str, Callable[[Page, Block], str]] = {
    "keys": _keys,
    "other-tables": _other_tables,
    "other-fields": _other_fields,
    "part": _part,
    "names": _names,
    "formulas": _formulas,
    "headers": _headers,
    "cases": _cases,
    "decisions": _decisions,
    "file": _file,
    "run": _run,
    "output": _output,
    "picture": _picture,
    "took": _took,
}
