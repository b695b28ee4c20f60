"""Docstrings of houle as reStructuredText.

They are plain text: sentences, and blocks of lines that each name a thing, leave two blanks or more, and say what it
is.
Such blocks become lists; code in backticks stays code; nothing else is markup.
"""

from __future__ import annotations

import re

ENTRY = re.compile(r"^(\S+(?: \S+)?)\s{2,}(\S.*)$")


def rst(lines: list[str]) -> list[str]:
    """The docstring's lines, without their margin, as lines of reStructuredText."""
    out: list[str] = []
    entries: list[tuple[str, str]] = []
    code = False
    for line in lines:
        if code and (line.startswith("    ") or not line.strip()):
            out.append(line)
            continue
        code = False
        if line.startswith("    ") and not entries and (not out or not out[-1].strip()):
            out += ["::", "", line]
            code = True
        elif found := ENTRY.match(line):
            entries += _pairs(line) or [(found[1], found[2])]
        elif entries and line.startswith("  ") and line.strip():
            entries[-1] = (entries[-1][0], f"{entries[-1][1]} {line.strip()}")
        else:
            out += [*_list(entries), *([""] if entries else []), escaped(line)]
            entries = []
    return [*out, *_list(entries)]


def escaped(text: str) -> str:
    """Plain text, in which what stands in backticks is code."""
    pieces = re.split(r"(`[^`]+`)", text)
    return "".join(f"`{p}`" if p.startswith("`") else re.sub(r"([\\*|]|_(?=\W|$))", r"\\\1", p) for p in pieces)


def _pairs(line: str) -> list[tuple[str, str]]:
    """Two things that one line names side by side, "height  of the wave [m]     target  what was asked for [m]"."""
    words = re.split(r"\s{2,}", line.strip())
    if len(words) != 4:
        return []
    return [(words[0], words[1]), (words[2], words[3])]


def _list(entries: list[tuple[str, str]]) -> list[str]:
    if not entries:
        return []
    return ["", *(f"* ``{name}``: {escaped(text)}" for name, text in entries), ""]
