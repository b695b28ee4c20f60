"""`houle reproduce`, from the first word to the page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from houle.case.model import Case
from houle.check import rules
from houle.reproduction import page
from houle.reproduction.measured import gather
from houle.reproduction.plan import choose, folder_of, read
from houle.reproduction.work import compute
from houle.results.run import Run
from houle.results.seconds import duration
from houle.running.progress import reporter

REPORT = "report.md"


def reproduce(
    paper: str,
    out: Path | str | None = None,
    *,
    once: Callable[[Case, Path], Run],
    file: Path | str | None = None,
    quick: bool = False,
    spacing: float | None = None,
    only: Sequence[str] = (),
    progress: bool = False,
) -> int:
    """Computes the runs of the plan of a paper that are not there yet, then writes the page with its figures.

    once     computes a case in a folder, as `houle.running.runner.once` does
    out      folder of the runs; reproduction-PAPER if not given
    file     the page; out/report.md if not given; its figures go to `figures` beside it
    quick    only the runs marked so, on coarser grids: minutes
    spacing  spacing of all runs [m], instead of the plan's
    only     the runs of these names, or patterns (wave-*); the page says what is missing
    Returns the exit status: 0, or 3 if a run failed (the others are on the page). Raises CaseError before anything is
    written, and what houle.run raises but SimulationError.
    """
    says, folder = reporter(progress), folder_of(paper)
    plan = read(folder)
    chosen = [(job, job.load(spacing, quick)) for job in choose(plan, only, quick)]
    for _, case in chosen:
        rules.require(case)
    here = Path(out or f"reproduction-{paper}")
    done = compute(chosen, here, says, once)
    says.say("houle: figures and page")
    found = gather(folder, plan, done.runs)
    written = page.write(Path(file) if file else here / REPORT, folder, found, done, quick)
    seconds = sum(run.summary["cpu_seconds"] for run in done.runs.values())
    says.say(f"houle: {written}; {len(done.runs)} runs, {duration(seconds)} of processor time")
    for name, why in done.failed.items():
        says.say(f"failed  {name}: {why}")
    return 3 if done.failed else 0
