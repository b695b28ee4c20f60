"""Imports go one way, and the numerical core knows nothing above it: docs/architecture.md."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "src" / "houle"
CORE = ROOT / "core" / "houle"
BIND = ROOT / "bind"
ROOMS = ("exec", "grid", "water", "pressure", "compiled")  # of the core, each of which knows those before it
HEADERS = {path.relative_to(CORE.parent).as_posix(): path for path in CORE.glob("*/*.hpp")}

# The rooms of the house from the bottom up: folders of src/houle, and the files that stand beside them. A module
# imports from its own room and from those below it, wherever in the file the import stands and whatever it is for: what
# only the types need counts as well.
ORDER = (
    "_core", "errors", "registry", "grid", "fields", "data", "waves", "medium", "flow", "boundary", "observe", "design",
    "case", "output", "analysis", "results", "check", "running", "validation", "reproduction", "bench", "cli",
)  # fmt: skip
RANK = {room: rank for rank, room in enumerate(ORDER)}
ENTRIES = {"__init__", "__main__"}  # the names of the package, looked up when first used; and the command
HALL = 8  # files beside the rooms, at most
LONGEST = 14  # modules of an import chain, at most: from the command line through a run and a step down to the grid
OURS = {"body", "fields"}  # names of what is an object of ours, besides those that a class of ours has in snake case
ORDINARY = {"data", "found", "kind", "points", "rows", "source", "stored", "time"}  # but these may be anything


def module_name(path: Path) -> str:
    """errors, output.series, validation.exact, ..."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)


def imports(tree: ast.AST) -> set[str]:
    """Modules of houle that are named in an import, at run time or for the types alone."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {a.name.removeprefix("houle.") for a in node.names if a.name.startswith("houle.")}
        elif isinstance(node, ast.ImportFrom) and node.module == "houle":
            found |= {a.name for a in node.names if a.name in MODULES or a.name == "_core"}
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("houle."):
            module = str(node.module).removeprefix("houle.")
            found |= {name if (name := f"{module}.{a.name}") in MODULES else module for a in node.names}
    return found


MODULES = {module_name(path): path for path in PACKAGE.rglob("*.py")}
TREES = {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in MODULES.items()}
IMPORTS = {name: imports(tree) for name, tree in TREES.items()}


def room_of(module: str) -> str:
    return module.partition(".")[0]


def test_every_room_has_its_place():
    assert {room_of(name) for name in MODULES} - ENTRIES | {"_core"} == set(ORDER)


def test_the_hall_is_small():
    hall = {path.stem for path in PACKAGE.glob("*.py")}
    assert len(hall) <= HALL, f"move one of {sorted(hall)} into a room"


def test_the_architecture_page_tells_the_rooms_and_the_headers():
    """In this order, from the top down."""
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    lines = page.partition("```\n")[2].partition("```")[0].splitlines()
    told = [name for line in lines for name in re.split(r" {3,}", line)[0].split()]
    assert told == list(reversed(ORDER))
    headers = {path.name for path in HEADERS.values()}
    assert headers == set(re.findall(r"`(\w+\.hpp)`", page.partition("## The core")[2].partition("## Where")[0]))


@pytest.mark.parametrize("module", sorted(set(MODULES) - ENTRIES))
def test_imports_go_down(module):
    here = RANK[room_of(module)]
    above = {name for name in IMPORTS[module] if RANK[room_of(name)] > here}
    assert not above, f"houle.{module} imports from a room above it"


def test_no_import_comes_round():
    list(TopologicalSorter(IMPORTS).static_order())  # raises CycleError, which names the cycle


def test_no_chain_of_imports_is_long():
    chains: dict[str, list[str]] = {}
    for module in TopologicalSorter(IMPORTS).static_order():
        below = [chains[name] for name in sorted(IMPORTS.get(module, ())) if name in MODULES]
        chains[module] = [module, *max(below, key=len, default=[])]
    longest = max((chains[name] for name in MODULES), key=len)
    assert len(longest) <= LONGEST, " -> ".join(longest)


def test_the_solver_knows_no_case_file():
    """What reads case files is not loaded with it."""
    solver = ("flow", "medium", "boundary", "waves", "observe")
    for name, tree in TREES.items():
        if room_of(name) in solver:
            used = {ast.unparse(n) for n in ast.walk(tree) if isinstance(n, ast.Import | ast.ImportFrom)}
            assert not any("pydantic" in line for line in used), name
    told = "import sys, houle.flow.step, houle.flow.simulation; print('pydantic' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", told], capture_output=True, text=True).stdout.split() == ["False"]


def typed(tree: ast.AST) -> Iterator[tuple[int, str, str]]:
    """Line, name and type of each argument, variable, attribute and function with a type: that which it returns."""
    for node in ast.walk(tree):
        if isinstance(node, ast.arguments):  # *args and **options hold several things
            for one in (*node.posonlyargs, *node.args, *node.kwonlyargs):
                if one.annotation is not None:
                    yield one.lineno, one.arg.strip("_"), ast.unparse(one.annotation)
        elif isinstance(node, ast.AnnAssign):
            name = ast.unparse(node.target).removeprefix("self.").strip("_")
            yield node.lineno, name, ast.unparse(node.annotation)
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.returns is not None:
            yield node.lineno, node.name, ast.unparse(node.returns)


def hidden(tree: ast.AST, ours: set[str]) -> list[tuple[int, str, str]]:
    """What has the name of an object of ours and the type of anything."""
    return [
        (line, name, kind)
        for line, name, kind in typed(tree)
        if name in ours and {"Any", "object"} & set(kind.split(" | "))
    ]


def test_no_any_stands_for_a_class_of_ours():
    """case: Any hides from mypy, and from the reader, what a function takes, and from the tests above an import."""
    classes = {node.name for tree in TREES.values() for node in ast.walk(tree) if isinstance(node, ast.ClassDef)}
    names = {re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower().strip("_") for name in classes}
    assert names >= ORDINARY, f"no class is called so: {ORDINARY - names}"
    ours = (OURS | names) - ORDINARY
    found = [
        f"houle.{module}, line {line}: {name}: {kind}"
        for module, tree in TREES.items()
        for line, name, kind in hidden(tree, ours)
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "text",
    ["def f(case: Any): ...", "self.flow: Any | None = None", "def medium(self) -> object: ...", "_grid: Any = None"],
)
def test_what_is_hidden_is_found(text):
    assert len(hidden(ast.parse(text), {"case", "flow", "medium", "grid"})) == 1


def test_relative_imports_are_not_used():
    for name, path in MODULES.items():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        assert not [n for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) and n.level], name


def includes(path: Path) -> set[str]:
    return set(re.findall(r'^#include ["<](.+?)[">]', path.read_text(encoding="utf-8"), re.MULTILINE))


def test_the_core_knows_no_python():
    for path in CORE.rglob("*.[ch]pp"):
        assert not {u for u in includes(path) if "nanobind" in u or u == "Python.h"}, path


def test_rooms_of_the_core_include_downward():
    """A header names what it needs as <houle/room/name.hpp>, from its own room or one below it; none comes round."""
    assert {path.name for path in CORE.iterdir()} == set(ROOMS)
    own = {name: includes(path) for name, path in HEADERS.items()}
    for path in CORE.glob("*/*.[ch]pp"):
        here = ROOMS.index(path.parent.name)
        for used in includes(path):
            assert not used.endswith(".hpp") or used in HEADERS, f"{path.name} includes {used}"
            assert used not in HEADERS or ROOMS.index(used.split("/")[1]) <= here, f"{path.name} includes {used}"
    list(TopologicalSorter({name: used & own.keys() for name, used in own.items()}).static_order())


def test_threads_have_one_home():
    """Loops are written in exec/ and run by threads.hpp: a build for another kind of machine replaces these."""
    threads = re.compile(r"#pragma omp|omp_\w+\(|<omp\.h>|std::(j?thread|async|atomic|\w*mutex)\b|tbb/")
    sources = [*CORE.rglob("*.[ch]pp"), *BIND.glob("*.[ch]pp")]
    named = {path.name for path in sources if threads.search(path.read_text(encoding="utf-8"))}
    assert named == {"threads.cpp"}
    users = {path.name for path in HEADERS.values() if "houle/exec/threads.hpp" in includes(path)}
    assert users == {"loop.hpp"}


def test_the_core_does_not_call_back():
    """Bindings take arrays and numbers: no case, no file, no option of the package."""
    for path in BIND.glob("*.[ch]pp"):
        assert not re.search(r'import_?\("houle|module_::import', path.read_text(encoding="utf-8")), path.name
