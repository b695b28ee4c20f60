"""Computes the runs of a plan one after another, each once: one that is finished in the folder is not run again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from time import perf_counter

from houle.case.model import Case
from houle.check.cost import price
from houle.errors import SimulationError
from houle.reproduction.measured import Done
from houle.reproduction.plan import Job
from houle.results.run import Run, open_run
from houle.results.seconds import duration
from houle.running.progress import Silent

RUNS = "runs"


def compute(jobs: Sequence[tuple[Job, Case]], folder: Path, says: Silent, once: Callable[[Case, Path], Run]) -> Done:
    """Computes the runs that are missing and resumes interrupted ones; a run that fails does not stop the others.

    once: makes the run of a case in a folder, or goes on with the one that lies there

    The folder of a run is named after the job and the hash of its case, so that another spacing, or a new version of
    the case, does not meet an old result. Raises what houle.run raises but SimulationError.
    """
    done = Done()
    places = {job.name: folder / RUNS / f"{job.name}-{case.hash[:8]}" for job, case in jobs}
    left = {job.name: price(case).minutes for job, case in jobs if not finished(places[job.name])}
    pace: float | None = None  # seconds of wall time for an estimated minute
    spent = bought = 0.0  # wall time [s] so far, and the minutes that were estimated for it
    for number, (job, case) in enumerate(jobs, start=1):
        place, head = places[job.name], f"run {number} of {len(jobs)}, {job.name}"
        if job.name not in left:
            says.say(f"houle: {head}: is finished")
            done.runs[job.name] = open_run(place)
            continue
        rest = "" if pace is None else f"; all that is left: about {duration(pace * sum(left.values()))}"
        says.say(f"houle: {head}, spacing {1e3 * case.domain.spacing:g} mm{rest}")
        start = perf_counter()
        try:
            done.runs[job.name] = once(case, place)
        except SimulationError as error:
            says.say(f"warning: {job.name} failed: {error}")
            done.failed[job.name] = str(error).splitlines()[0]
        spent, bought = spent + perf_counter() - start, bought + left.pop(job.name)
        pace = spent / bought
    return done


def finished(place: Path) -> bool:
    return (place / "run.json").exists() and bool(open_run(place).manifest["finished"])
