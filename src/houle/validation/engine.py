"""Runs the shipped cases and sets what they measured beside the targets and the other codes."""

from __future__ import annotations

import importlib.util
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from houle.case import load
from houle.errors import CaseError, HouleError
from houle.validation.check import Check, Variant

if TYPE_CHECKING:
    from houle.runner import Run

FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Comparison:
    """The compare.py of a case."""

    compare: Callable[[Run], list[Check]]
    variants: tuple[Variant, ...] = (Variant(),)
    across: Callable[[Mapping[str, Run]], list[Check]] | None = None


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
    return Comparison(module.compare, getattr(module, "VARIANTS", (Variant(),)), getattr(module, "across", None))


def validate(
    names: Sequence[str] | None = None,
    quick: bool = False,
    threads: int | None = None,
    out: Path | str | None = None,
    console: Console | None = None,
) -> int:
    """Run shipped cases (all, or these), print one table per case, and give the exit status: 1 when a target is missed.

    quick  only the variants marked so (minutes instead of the better part of an hour)
    out    folder that keeps the runs; without it they go to a temporary one
    Raises CaseError for an unknown name, before anything runs. A run that fails is a line of the table.
    """
    console = console or Console()
    chosen = {name: comparison(name) for name in (names or cases())}
    missed = 0
    with ExitStack() as stack:
        folder = Path(out) if out else Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="houle-validate-")))
        for name, compared in chosen.items():
            table = _table(name)
            for label, checks, seconds in _results(name, compared, folder, quick, threads):
                for row, check in enumerate(checks):
                    table.add_row(f"{label or '-'} ({seconds:.0f} s)" if row == 0 else "", *_cells(check))
                table.add_section()
                missed += sum(not check.passed for check in checks)
            console.print(table)
    console.print(f"[red]{missed} below target[/red]" if missed else "[green]all targets reached[/green]")
    return int(missed > 0)


def _results(
    name: str, compared: Comparison, folder: Path, quick: bool, threads: int | None
) -> Iterator[tuple[str, list[Check], float]]:
    """Label, checks and wall seconds of every variant, then of what they say together."""
    runs: dict[str, Run] = {}
    for variant in compared.variants:
        if quick and not variant.quick:
            continue
        start = perf_counter()
        try:
            run = _run(name, variant, folder, threads)
            checks = compared.compare(run)
            runs[variant.name] = run
        except HouleError as error:
            checks = [Check("runs to the end", float("nan"), note=str(error))]
        yield variant.name, checks, perf_counter() - start
    if compared.across and (checks := compared.across(runs)):
        yield "all variants", checks, 0.0


def _run(name: str, variant: Variant, folder: Path, threads: int | None) -> Run:
    from houle.runner import run

    case = load(name, overrides=dict(variant.overrides))
    return run(case, out=folder / "-".join(filter(None, (name, variant.name))), threads=threads)


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
