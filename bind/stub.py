"""Writes src/houle/_core.pyi, the types of the compiled core, from the module that Python imports: nanobind's stubgen,
with the functions of 2 and 3 dimensions in one.

    python bind/stub.py                 writes it, after a change of what is bound
    python bind/stub.py --print         prints it

The stub is kept with the sources, so that mypy checks a checkout in which nothing is built, and a change of what is
bound shows in review. tests/core/test_stub.py compares it with the module.
"""

from __future__ import annotations

import argparse
import ast
from itertools import groupby
from pathlib import Path

from nanobind.stubgen import StubGen

from houle import _core

STUB = Path(__file__).parents[1] / "src" / "houle" / "_core.pyi"
HEAD = "# Written by bind/stub.py from the compiled module. Do not edit.\n"
WIDTH = 120


def raw() -> str:
    """The stub as nanobind writes it."""
    generator = StubGen(_core, recursive=False, include_docstrings=True, quiet=True)
    generator.put(_core)
    return generator.get()


def explains(function: ast.FunctionDef) -> bool:
    """True for the overload that takes anything and says which argument of a call does not fit."""
    return function.args.vararg is not None


def docstring(functions: list[ast.FunctionDef]) -> str | None:
    """The docstring that one of the overloads has."""
    return next((text for f in functions if (text := ast.get_docstring(f))), None)


def parameters(function: ast.FunctionDef) -> list[str]:
    """The parameters as they are written, defaults included."""
    assert not function.args.posonlyargs, f"{function.name}: an argument has no name"
    names, defaults = function.args.args, function.args.defaults
    written = []
    for name, default in zip(names, [None] * (len(names) - len(defaults)) + list(defaults), strict=True):
        kind = f": {ast.unparse(name.annotation)}" if name.annotation else ""
        written.append(f"{name.arg}{kind}" + (f" = {ast.unparse(default)}" if default else ""))
    return written


def merged(functions: list[ast.FunctionDef]) -> list[list[str]]:
    """The parameters of each overload that is left, Grid2 and Grid3 in one where all else is the same."""
    every = [parameters(f) for f in functions if not explains(f)]
    both = [[p.replace("Grid2", "Grid3") for p in one] for one in every]
    if len(every) == 2 and every[0] != every[1] and both[0] == both[1]:
        return [[p.replace("Grid2", "Grid2 | Grid3") for p in every[0]]]
    return every[:1] if all(one == every[0] for one in every) else every


def signature(name: str, given: list[str], returns: str, indent: str) -> str:
    """The line `def name(...) -> ...:`, broken where it is too long."""
    line = f"{indent}def {name}({', '.join(given)}) -> {returns}:"
    if len(line) + 4 <= WIDTH:
        return line
    return f"{indent}def {name}(\n" + "".join(f"{indent}    {p},\n" for p in given) + f"{indent}) -> {returns}:"


def written(functions: list[ast.FunctionDef], indent: str = "") -> str:
    """The functions of one name."""
    text = ""
    overloads = merged(functions)
    for given in overloads:
        first = functions[0]
        marks = [ast.unparse(d) for d in first.decorator_list if ast.unparse(d) != "overload"]
        marks += ["overload"] * (len(overloads) > 1)
        text += "".join(f"{indent}@{mark}\n" for mark in marks)
        text += signature(first.name, given, ast.unparse(first.returns) if first.returns else "None", indent)
        if doc := docstring(functions):
            lines = doc.splitlines()
            rest = "".join(f"\n{indent}    {line}".rstrip() for line in lines[1:])
            text += f'\n{indent}    """{lines[0]}{rest}"""\n'
        else:
            text += " ...\n"
    return text


def stub() -> str:
    """The whole stub."""
    tree = ast.parse(raw())
    imports = [ast.unparse(node) for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    text = HEAD + f'"""{ast.get_docstring(tree)}"""\n\n'
    body = ""
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            members = [f for f in node.body if isinstance(f, ast.FunctionDef)]
            body += f"\nclass {node.name}:\n"
            if doc := ast.get_docstring(node):
                body += f'    """{doc}"""\n\n'
            groups = [list(group) for _, group in groupby(members, key=lambda f: f.name)]
            body += "\n".join(written(group, "    ") for group in groups)
    body += "".join(f"\n{ast.unparse(node)}\n" for node in tree.body if isinstance(node, ast.AnnAssign))
    for _, group in groupby(functions, key=lambda f: f.name):
        body += "\n" + written(list(group))
    return text + "\n".join(line for line in imports if "overload" not in line or "@overload" in body) + "\n" + body


def main() -> None:
    """The command line above."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--print", action="store_true")
    if parser.parse_args().print:
        print(stub(), end="")
    else:
        STUB.write_text(stub(), encoding="utf-8")


if __name__ == "__main__":
    main()
