"""Imports go one way, and the numerical core knows nothing above it: docs/architecture.md."""

import ast
import re
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "src" / "houle"
CORE = ROOT / "core" / "houle"
BIND = ROOT / "bind"
ROOMS = ("exec", "grid", "water", "pressure")  # of the core, from the bottom up
HEADERS = {path.relative_to(CORE.parent).as_posix(): path for path in CORE.glob("*/*.hpp")}

# From the bottom up. A module imports from its own layer or from those below it, wherever in the file the import
# stands; imports for type checking only do not count.
LAYERS = (
    {"_core", "errors", "registry", "flow.component"},
    {
        "grid",
        "flow.particles",
        "medium.shapes",
        "medium.sections",
        "medium.integrals",
        "fields",
        "data",
    }
    | {"medium.interfaces"}
    | {"case.messages", "case.reading"},
    {
        "medium.resistance",
        "medium.solids",
        "medium.thin_solids",
        "medium.plate_sides",
        "medium.medium",
        "flow.seeding",
        "medium.columns",
        "flow.crest",
        "flow.remeshers",
        "flow.viscosity",
    }
    | {"flow.workspace", "flow.kernels", "flow.schemes"}
    | {
        "case.tables",
        "case.wave",
        "waves",
    },
    {"flow.tank", "flow.boundaries"},
    {"flow.state", "flow.transfer", "flow.ledger"},
    {
        "flow.surface",
        "flow.forces",
        "flow.projection",
        "flow.motion",
        "flow.correction",
        "flow.start",
        "flow.remeshing_schedule",
        "observe",
        "flow.budget",
    },
    {"flow.step", "flow.setup"},
    {"boundary"},
    {
        "case.consistency",
        "case.model",
        "case.build",
        "case.instruments",
        "flow.rows",
        "check.waves",
        "check.boundaries",
        "check.cost",
        "check.drag",
        "check.wave_theory",
        "check.rules",
    },
    {"flow.simulation"},
    {"output"},
    {"analysis"},
    {
        "running.progress",
        "running.recorder",
        "running.signals",
        "running.cores",
        "running.restart",
        "running.failure",
        "running.session",
        "check.gauges",
    }
    | {
        "results.reflection",
        "results.wave_energy",
        "results.impacts",
        "results.wave_quality",
        "results.summary",
        "running.runner",
    },
    {"validation", "reproduction", "bench", "check.report", "case.describe", "case.new"},
    {"cli"},
)
RANK = {name: rank for rank, layer in enumerate(LAYERS) for name in layer}
ENTRIES = {"__init__", "__main__"}  # the package's own names, looked up when first used; and the command


def module_name(path: Path) -> str:
    """errors, output.series, validation.exact, ..."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)


def imports(tree: ast.AST) -> set[str]:
    """Modules of houle that are imported when the program runs."""
    found = set()
    pending = [tree]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            pending += node.orelse
            continue
        if isinstance(node, ast.Import):
            found |= {a.name.removeprefix("houle.") for a in node.names if a.name.startswith("houle.")}
        elif isinstance(node, ast.ImportFrom) and node.module == "houle":
            found |= {a.name for a in node.names if a.name in MODULES or a.name == "_core"}
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("houle."):
            module = str(node.module).removeprefix("houle.")
            found |= {name if (name := f"{module}.{a.name}") in MODULES else module for a in node.names}
        pending += ast.iter_child_nodes(node)
    return found


MODULES = {module_name(path): path for path in PACKAGE.rglob("*.py")}
IMPORTS = {name: imports(ast.parse(path.read_text(encoding="utf-8"))) for name, path in MODULES.items()}


def layer_of(module: str) -> str:
    """The module, or the package that stands for it in LAYERS."""
    while module not in RANK and "." in module:
        module = module.rpartition(".")[0]
    return module


def test_every_module_has_its_layer():
    rooms = {name.partition(".")[0] for name in MODULES if "." in name and layer_of(name) != name.partition(".")[0]}
    there = {layer_of(name) for name in MODULES} - ENTRIES - rooms | {"_core"}
    assert there == set(RANK), "add a new module to LAYERS, and take out one that is gone"


def test_the_architecture_page_tells_the_layers_and_the_headers():
    """In this order, from the top down."""
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    lines = page.partition("```\n")[2].partition("```")[0].splitlines()
    told = [name for line in lines for name in re.split(r" {3,}", line)[0].split()]
    assert sorted(told) == sorted(RANK)
    ranks = [RANK[name] for name in told]
    assert ranks == sorted(ranks, reverse=True)
    headers = {path.name for path in HEADERS.values()}
    assert headers == set(re.findall(r"`(\w+\.hpp)`", page.partition("## The core")[2].partition("## Where")[0]))


@pytest.mark.parametrize("module", sorted(name for name in MODULES if layer_of(name) in RANK))
def test_imports_go_down(module):
    here = RANK[layer_of(module)]
    above = {name for name in IMPORTS[module] if RANK[layer_of(name)] > here}
    assert not above, f"houle.{module} imports from a layer above it"


def test_the_flow_knows_no_kind_of_boundary():
    """It has the protocol and a list; the text of its modules names none of `houle.boundary`, not even for types."""
    for name, path in MODULES.items():
        if name.startswith("flow"):
            assert "houle.boundary" not in path.read_text(encoding="utf-8").replace("`houle.boundary`", ""), name


def test_no_import_comes_round():
    list(TopologicalSorter(IMPORTS).static_order())  # raises CycleError, which names the cycle


def test_the_solver_knows_no_case_file():
    """Not by an import that its types alone need, either; and what reads case files is not loaded with it."""
    solver = ("flow", "medium", "boundary", "waves", "observe")
    above = re.compile(r"houle\.(case|output|running|check|results)\b|\bpydantic\b")
    for name, path in MODULES.items():
        if name.partition(".")[0] in solver:
            assert not above.search("\n".join(import_lines(path))), name
    told = "import sys, houle.flow.step, houle.flow.simulation; print('pydantic' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", told], capture_output=True, text=True).stdout.split() == ["False"]


def import_lines(path: Path) -> list[str]:
    """Every import of a module, wherever it stands."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [ast.unparse(node) for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]


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
