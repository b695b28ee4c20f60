"""Runs the shipped cases, and compares their results with the targets and with other codes."""

from __future__ import annotations

import importlib.util
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from time import perf_counter

from rich.console import Console
from rich.table import Table

from houle.case.model import Case, load
from houle.errors import CaseError, HouleError
from houle.results.run import Run
from houle.validation import tables
from houle.validation.check import Check, Variant

FOLDER = Path(__file__).parent
Once = Callable[[Case, Path], Run]  # makes the run of a case in a folder, goes on with it, or finds it finished


@dataclass(frozen=True)
class Comparison:
    """The contents of the compare.py of a case: see `houle.validation`."""

    compare: Callable[[Run], list[Check]]
    variants: tuple[Variant, ...] = (Variant(),)
    across: Callable[[Mapping[str, Run]], list[Check]] | None = None
    overview: Callable[[Mapping[str, Run], Path], None] | None = None


def cases() -> list[str]:
    """Names of the shipped cases that come with a comparison."""
    return sorted(p.parent.name for p in FOLDER.glob("*/compare.py"))


def comparison(name: str) -> Comparison:
    """The comparison of a shipped case. CaseError when there is none of that name."""
    path = FOLDER / name / "compare.py"
    if name not in cases():
        raise CaseError(f"{name} is not a shipped case with a comparison. There are: {', '.join(cases())}")
    module_name = "houle.validation." + name.replace("-", "_")
    spec = importlib.util.spec_from_file_location(module_name, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[module_name] = module
    spec.loader.exec_module(module)
    more = {name: getattr(module, name, None) for name in ("across", "overview")}
    return Comparison(module.compare, getattr(module, "VARIANTS", (Variant(),)), **more)


def validate(
    names: Sequence[str] | None = None,
    *,
    once: Once,
    quick: bool = False,
    out: Path | str | None = None,
    console: Console | None = None,
    variants: Sequence[str] | None = None,
) -> int:
    """Runs shipped cases (all, or these), prints a table for each, returns the exit status: 1 if a target is missed.

    once      computes a variant in a folder, as `houle.running.runner.once` does
    quick     only the variants marked so (minutes instead of the better part of an hour)
    out       folder that keeps the runs, the tables as CASE.csv and CASE.md, and the pictures of a comparison. Runs
              that are finished there are not computed again, interrupted ones go on. By default a temporary folder
    variants  only those whose names match one of these patterns, as in a shell ("T-1.5-s-*-wall"); "" is the case as
              it stands
    Raises CaseError for an unknown name or pattern, before anything runs. A run that fails is a line of the table.
    """
    console = console or Console()
    chosen = {name: comparison(name) for name in (names or cases())}
    asked = {name: _choose(found.variants, quick, variants) for name, found in chosen.items()}
    if not any(asked.values()):
        known = ", ".join(v.name for found in chosen.values() for v in found.variants if v.name)
        raise CaseError(f"no variant is called {' or '.join(variants or [])}. There are: {known}")
    missed = 0
    with ExitStack() as stack:
        folder = Path(out) if out else Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="houle-validate-")))
        for name, compared in chosen.items():
            table, rows = _table(name), list[tuple[str, Check]]()
            for label, checks, seconds in _results(name, compared, asked[name], folder, once, console):
                for row, check in enumerate(checks):
                    table.add_row(f"{label or '-'} ({seconds:.0f} s)" if row == 0 else "", *_cells(check))
                table.add_section()
                rows += [(label, check) for check in checks]
                if out:
                    tables.write(folder / name, load(name).case.title, rows)
            if rows:
                console.print(table)
            missed += sum(not check.passed for _, check in rows)
    console.print(f"[red]{missed} below target[/red]" if missed else "[green]all targets reached[/green]")
    return int(missed > 0)


def _choose(variants: Sequence[Variant], quick: bool, patterns: Sequence[str] | None) -> list[Variant]:
    fitting = [v for v in variants if v.quick or not quick]
    return [v for v in fitting if patterns is None or any(fnmatchcase(v.name, p) for p in patterns)]


def _results(
    name: str, compared: Comparison, variants: Sequence[Variant], folder: Path, once: Once, console: Console
) -> Iterator[tuple[str, list[Check], float]]:
    """Label, checks and wall seconds of every variant, then those of all variants together."""
    runs: dict[str, Run] = {}
    for number, variant in enumerate(variants, start=1):
        start = perf_counter()
        console.print(f"{name} {variant.name} ({number} of {len(variants)})", style="dim", highlight=False)
        try:
            case = load(name, overrides=dict(variant.overrides))
            run = once(case, folder / "-".join(filter(None, (name, variant.name))))
            checks = compared.compare(run)
            runs[variant.name] = run
            if compared.overview:
                compared.overview(runs, folder)
        except HouleError as error:
            checks = [Check("runs to the end", float("nan"), note=str(error))]
        yield variant.name, checks, perf_counter() - start
    if compared.across and (checks := compared.across(runs)):
        yield "all variants", checks, 0.0


def _table(name: str) -> Table:
    table = Table(title=load(name).case.title, title_justify="left", title_style="bold")
    for head in ("variant", "what", "measured", "target", "others"):
        table.add_column(head, justify="right" if head in ("measured", "target") else "left")
    table.add_column("")
    return table


def _cells(check: Check) -> tuple[str, ...]:
    others = ", ".join(f"{who} {what}" for who, what in check.peers.items())
    status = "" if not check.target and check.passed else "[green]ok[/green]" if check.passed else "[red]missed[/red]"
    text = "; ".join(filter(None, (others, check.note)))
    return check.name, f"{check.value:.4g} {check.unit}".strip(), check.target, text, status
