"""Runs of one case in seas that differ by their seed, `[waves] seeds`, one after the other, and their answers together.

DIR holds the case, run.json, answers.csv and answers.png of all; DIR/seed-K is the folder of a run, the same as that of
`[waves] seed = K` alone. `time.until` is asked of all runs so far, after each of them, and no further one is begun when
it is met.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from houle.case.model import load
from houle.errors import CaseError
from houle.output import checkpoints, collect, summarise, write_manifest

if TYPE_CHECKING:
    from houle.case.model import Case
    from houle.results.run import Run
    from houle.running.progress import Silent

SUMS = ("steps", "wall_seconds", "cpu_seconds")


def seeds_of(case: Case) -> range:
    """The seeds of a case; none where it is one run."""
    waves = case.waves
    return range(0) if waves is None or waves.seeds is None else range(waves.seed, waves.seed + waves.seeds)


def realisation(case: Case, seed: int) -> Case:
    """The case of one seed. It runs to its end: how sure the answers are is asked of all seeds together."""
    goal: dict[str, Any] = {} if case.time.until is None else {"time.until": None}
    return load(case, {"waves.seeds": None, "waves.seed": seed, **goal})


class Realisations:
    """All runs of a case with seeds in their folder.

    run, resume  compute a case into a folder; go on in one. Each returns the Run
    answers      writes the answers of some of the runs together; the entries of run.json, and true if they are as sure
                 as time.until asks
    """

    def __init__(
        self,
        directory: Path,
        case: Case,
        run: Callable[..., Run],
        resume: Callable[..., Run],
        answers: Callable[[list[Run]], tuple[dict[str, Any], bool]],
        says: Silent,
    ) -> None:
        self.directory, self.case, self.run, self.resume, self.says = directory, case, run, resume, says
        self.answers = answers
        self.manifest: dict[str, Any] = {}

    def begin(self, threads: int | None, earlier: dict[str, Any] | None = None) -> None:
        """Writes run.json: from here on it can be resumed. earlier: run.json as it lies there."""
        self.manifest = collect(self.case.identity, threads)
        if earlier:
            self.manifest |= {key: earlier[key] for key in ("case", "started") if key in earlier}
        self._write([], {}, finished=False)

    def march(self, threads: int | None) -> None:
        """Computes seed after seed until all are there, or are sure enough, and writes run.json after each."""
        runs: list[Run] = []
        for number, seed in enumerate(seeds := seeds_of(self.case), start=1):
            self.says.say(f"houle: seed {seed}, {number} of {len(seeds)}")
            runs.append(self._one(seed, threads))
            found, met = self.answers(runs)
            if met and number < len(seeds):
                self.says.say(f"houle: the answers of {number} seeds are as sure as asked")
            self._write(runs, found, finished=met or number == len(seeds))
            if met:
                break

    def _one(self, seed: int, threads: int | None) -> Run:
        """The finished run of a seed: computed, gone on with, or as it lies there. Raises what runs raise."""
        folder, case = self.directory / f"seed-{seed}", realisation(self.case, seed)
        try:
            if not ((folder / "run.json").exists() or checkpoints(folder)):
                return self.run(case, folder, threads)
            if load(folder / "case.toml").hash != case.hash:
                raise CaseError(
                    f"{folder} holds the run of another case. Remove it, or run into another folder: houle run CASE "
                    "--out DIR"
                )
            return self.resume(folder, threads)
        except KeyboardInterrupt as stop:  # its message says how to go on
            raise type(stop)(str(stop).replace(str(folder), str(self.directory))) from None

    def _write(self, runs: list[Run], found: dict[str, Any], finished: bool) -> None:
        """run.json: steps and seconds of all runs so far, and the answers that were found."""
        summaries = [run.summary for run in runs]
        sums: dict[str, Any] = {key: sum(summary[key] for summary in summaries) for key in SUMS}
        each = [
            {"seed": seed, "directory": run.directory.name, "time": summary["time"]}
            for seed, run, summary in zip(seeds_of(self.case), runs, summaries, strict=False)
        ]
        outcome = summarise(
            self.manifest,
            finished=finished,
            time=summaries[-1]["time"] if summaries else 0.0,
            particles=summaries[-1]["particles"] if summaries else 0,
            volume_drift=max((summary["volume_drift"] for summary in summaries), key=abs, default=0.0),
            energy={},
            operations=_added(summary["operations"] for summary in summaries),
            stages=_added(summary["stages"] for summary in summaries),
            seeds=each,
            **sums,
            **found,
        )
        write_manifest(self.directory, outcome)


def _added(tables: Iterable[dict[str, float]]) -> dict[str, float]:
    """The sums of tables of seconds."""
    found: dict[str, float] = {}
    for table in tables:
        for name, seconds in table.items():
            found[name] = found.get(name, 0.0) + seconds
    return found
