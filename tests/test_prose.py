"""Comments and docstrings are read by people who have not read the name above: none opens with a relative clause."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCES = ("src/houle", "bind", "core")
CLAUSE = re.compile(r"(of|whether|what|where|which|that|how|who|whose)\b", re.IGNORECASE)


def comments(text: str, cpp: bool) -> Iterator[tuple[int, str]]:
    """Line and words of every comment; of a block of whole lines, those of its first line."""
    found = _cpp_comments(text) if cpp else _python_comments(text)
    last = -1
    for number, words, whole in found:
        if not (whole and last == number - 1):
            yield number, words
        last = number if whole else -1


def _cpp_comments(text: str) -> Iterator[tuple[int, str, bool]]:
    for number, line in enumerate(text.splitlines(), start=1):
        code, mark, words = line.partition("//")
        if mark:
            yield number, words.strip(), not code.strip()


def _python_comments(text: str) -> Iterator[tuple[int, str, bool]]:
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string.lstrip("# "), token.line.lstrip().startswith("#")


def docstrings(text: str) -> Iterator[tuple[int, str]]:
    """Line and words of every docstring."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and (words := ast.get_docstring(node)):
            yield getattr(node, "lineno", 1), words.splitlines()[0]


def clauses(path: Path, text: str) -> list[str]:
    """The comments and docstrings of a file that open with a relative clause."""
    cpp = path.suffix != ".py"
    every = [*comments(text, cpp), *([] if cpp else docstrings(text))]
    return [f"{path}:{line}: {words}" for line, words in every if CLAUSE.match(words)]


def test_the_clauses_are_found():
    python = 'def f():\n    """Whether it floats."""\n    x = 1  # of the water\n\n    # a block\n    # that goes on\n'
    assert len(clauses(Path("a.py"), python)) == 2
    cpp = "// What floats.\nint x;  // of the water\n// A block\n// of two lines.\n"
    assert len(clauses(Path("a.hpp"), cpp)) == 2


def test_no_comment_or_docstring_opens_with_a_relative_clause():
    files = [f for s in SOURCES for f in sorted((ROOT / s).rglob("*")) if f.suffix in (".py", ".hpp", ".cpp")]
    found = [line for f in files for line in clauses(f.relative_to(ROOT), f.read_text(encoding="utf-8"))]
    assert not found, "\n".join(found)
