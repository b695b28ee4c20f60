"""The public headers of the core as Markdown: what each says about itself, and its types and functions.

A header is read as it is written: the comment at its head, and in namespace `houle` the comment above each declaration.
What stands in an inner namespace, or in a class after `private:`, is not public.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

WIDTH = 88  # of a line of code on a page
SHORT = 24  # lines: a struct up to this length is shown whole, with the comments of its members
MACRO = re.compile(r"[A-Z_]+\([\w, ]*\)")  # a macro that stands for declarations


@dataclass
class Item:
    """One declaration: its comment, its text, and the members of a class that are shown by themselves."""

    comment: str
    text: str
    members: tuple[Item, ...] = ()

    @property
    def name(self) -> str:
        """What it declares: the word before the first parenthesis, or the name of the type."""
        text = re.sub(r"template\s*<.*?>\s*(?=\w)", "", self.text, flags=re.DOTALL)
        kind = re.match(r"\s*(?:struct|class|enum class|enum|using|constexpr \w+)\s+(\w+)", text)
        if kind:
            return kind[1]
        found = re.search(r"([\w~]+|operator\S+)\s*(?:\(|=|\[|;|$)", text)
        return found[1] if found else text.strip()


@dataclass
class Header:
    path: Path
    comment: str
    items: tuple[Item, ...]


def public(core: Path) -> list[Path]:
    """Headers of the library, in the rooms below core/houle."""
    return sorted(core.glob("houle/**/*.hpp"))


def read(path: Path) -> Header:
    lines = path.read_text(encoding="utf-8").splitlines()
    head = _comment(lines, 0)
    start = next((i for i, line in enumerate(lines) if re.match(r"namespace houle\b.*\{", line)), len(lines))
    return Header(path, _prose(lines[: len(head)]), tuple(_items(lines[start + 1 :])))


def markdown(header: Header, title: str, level: int) -> str:
    """Section of a page about one header."""
    blocks = [f"{'#' * level} `{title}`", escaped(header.comment)]
    for item in header.items:
        blocks += _shown(item)
    return "\n\n".join(block for block in blocks if block)


def _shown(item: Item) -> list[str]:
    blocks = [f"```cpp\n{item.text}\n```", escaped(item.comment)]
    for member in item.members:
        blocks.append(f"```cpp\n{member.text}\n```")
        blocks.append(escaped(member.comment))
    return blocks


def escaped(text: str) -> str:
    """Comment text as Markdown: what stands in backticks stays code, nothing else is markup."""
    pieces = re.split(r"(`[^`\n]+`)", text)
    return "".join(p if p.startswith("`") else re.sub(r"([\\*_<>|$\[\]{}#~])", r"\\\1", p) for p in pieces)


def _comment(lines: list[str], start: int) -> list[str]:
    """The lines of the comment that begins at a line; empty if none does."""
    stop = start
    while stop < len(lines) and lines[stop].lstrip().startswith("//"):
        stop += 1
    return lines[start:stop]


def _prose(comment: list[str]) -> str:
    """Text of a comment: its lines joined to paragraphs, indented lines kept apart as a list."""
    bare = [re.sub(r"^\s*// ?", "", line) for line in comment]
    text = "\n".join(line if not line.startswith("  ") else f"\n{line.strip()}" for line in bare)
    return re.sub(r"\n{3,}", "\n\n", text).strip()


def _items(lines: list[str]) -> list[Item]:
    """Declarations of a namespace or class, from the line after its brace to the one that closes it."""
    found: list[Item] = []
    comment: list[str] = []
    i = 0
    while i < len(lines):
        line = lines[i].strip()
        if line.startswith(("private:", "protected:", "}")):
            break
        if line.startswith("//"):
            comment = _comment(lines, i)
            i += len(comment)
            continue
        if not line or line.startswith(("#", "public:")) or MACRO.fullmatch(line):
            comment, i = [], i + 1
            continue
        size = _length(lines[i:])
        body = lines[i : i + size]
        if not re.match(r"\s*(namespace|static_assert|template struct|extern|friend)\b", body[0]):
            found.append(_item(_prose(comment), body))
        comment, i = [], i + size
    return found


def _length(lines: list[str]) -> int:
    """Number of lines of the declaration that begins here: to its semicolon, or to the brace that closes it."""
    depth, opened = 0, False
    for count, line in enumerate(lines, start=1):
        code = re.sub(r'"(?:\\.|[^"\\])*"', '""', line.split("//")[0])
        depth += code.count("{") + code.count("(") - code.count("}") - code.count(")")
        opened = opened or "{" in code
        ended = code.rstrip().endswith((";", "}", "};"))
        if depth == 0 and ended and not code.strip().startswith("template"):
            return count
    return len(lines)


def _item(comment: str, body: list[str]) -> Item:
    text = "\n".join(body)
    kind = re.search(r"^\s*(?:template\s*<[^{;]*>\s*)?(struct|class|enum)\b", text, re.DOTALL)
    if kind and (kind[1] != "class" and len(body) <= SHORT):
        return Item(comment, _tidy(body))
    opening = next((k for k, line in enumerate(body) if "{" in line.split("//")[0]), None)
    if kind and opening is not None:
        inner = [line for line in body[opening + 1 :] if True]
        start = next((k for k, line in enumerate(inner) if line.strip() == "public:"), -1)
        members = [m for m in _items(inner[start + 1 :]) if m.comment]
        return Item(comment, _signature(text), tuple(members))
    return Item(comment, _signature(text))


def _tidy(lines: list[str]) -> str:
    margin = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    return "\n".join(line[margin:].rstrip() for line in lines)


def _signature(text: str) -> str:
    """The declaration without its body and what only the compiler needs."""
    bare = re.sub(r"//[^\n]*", "", text)
    depth = 0
    for place, sign in enumerate(bare):
        depth += (sign == "(") - (sign == ")")
        if sign in "{;" and depth == 0:
            bare = bare[:place]
            break
    bare = re.sub(r"\)\s*:\s*\w+[_({].*", ")", bare, flags=re.DOTALL)  # members that a constructor sets
    bare = re.sub(r"\b(inline|HOULE_NOINLINE|explicit) ", "", bare)
    lines = [line.strip() for line in bare.splitlines() if line.strip()]
    first = 1 if lines[0].startswith("template") and len(lines) > 1 and lines[0].endswith(">") else 0
    return "\n".join([*lines[:first], *_wrapped(" ".join(lines[first:]))])


def _wrapped(text: str) -> list[str]:
    """A declaration in lines that fit the page, broken at commas between parameters."""
    if len(text) <= WIDTH or "(" not in text:
        return [text]
    place = text.index("(") + 1
    pieces = re.split(r"(?<=,) (?![^<(]*[>)])|(?<=,) (?=const |[a-z])", text[place:])
    lines = [text[:place], ""]
    for piece in pieces:
        if lines[-1].strip() and len(lines[-1]) + len(piece) >= WIDTH:
            lines.append("")
        lines[-1] += f" {piece}" if lines[-1] else f"    {piece}"
    return lines
