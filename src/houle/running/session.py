"""One stretch of a run, between a start of the program and its end: the loop, checkpoints, and every way to stop.

The sequence of steps depends on the case alone. Steps are shortened only to land on frames (multiples of output.every,
and the instants of the laboratory); checkpoints, `until`, signals and the wall clock decide when the loop stops, never
how long a step is. A run that was stopped and resumed, or killed and resumed, therefore equals the uninterrupted one
bit for bit.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Any, NoReturn

from houle.case.build import instruments
from houle.check.drag import drag_of
from houle.data import laboratory
from houle.flow.ledger import WORKS
from houle.output import Checkpoint, Outputs, about, collect, save_checkpoint, summarise, write_manifest
from houle.running import signals
from houle.running.failure import as_failure, write_bundle
from houle.running.goal import Goal
from houle.running.progress import Silent
from houle.running.recorder import Recorder

if TYPE_CHECKING:
    from houle.case.model import Case
    from houle.flow.simulation import Simulation

CHECKPOINT_EVERY = 60.0  # wall time between two checkpoints [s]
COMMIT_EVERY = 15.0  # wall time between two commits of rows and frames [s]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C or a polite kill, after the checkpoint was written; the message says how to go on. Exit status 130."""


class Clock:
    """Seconds of a run over all its stretches: wall, CPU, per operation of a step and per stage beside the steps."""

    def __init__(self) -> None:
        self.wall, self.cpu = -perf_counter(), -process_time()
        self.operations: dict[str, float] = {}
        self.stages: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Counts the time spent inside for this stage."""
        begin = perf_counter()
        try:
            yield
        finally:
            self.stages[name] = self.stages.get(name, 0.0) + perf_counter() - begin

    def add(self, earlier: Mapping[str, Any]) -> None:
        """Adds the seconds of earlier stretches, as read() gave them."""
        self.wall, self.cpu = self.wall + earlier["wall_seconds"], self.cpu + earlier["cpu_seconds"]
        self.operations, self.stages = earlier["operations"], _sum(self.stages, earlier["stages"])

    def read(self, operations: Mapping[str, float]) -> dict[str, Any]:
        """The totals of all stretches; operations: seconds per operation of this one."""
        return {
            "wall_seconds": self.wall + perf_counter(),
            "cpu_seconds": self.cpu + process_time(),
            "operations": _sum(self.operations, operations),
            "stages": dict(self.stages),
        }


def _sum(one: Mapping[str, float], other: Mapping[str, float]) -> dict[str, float]:
    return {name: one.get(name, 0.0) + other.get(name, 0.0) for name in {**one, **other}}


class Session:
    """A stretch of a run in its folder: begin() or restore(), then march()."""

    def __init__(
        self,
        directory: Path,
        case: Case,
        goal: Goal,
        simulation: Simulation,
        threads: int | None,
        clock: Clock,
        says: Silent,
    ) -> None:
        self.directory, self.case, self.simulation, self.clock, self.says = directory, case, simulation, clock, says
        stations = [kind.stations for kind in instruments(case)]
        self.outputs = Outputs(directory, simulation.grid, stations, about(case.identity))
        intervals = (case.output.every, case.output.series_every)
        self.recorder = Recorder(self.outputs, case.time.end, *intervals, laboratory.instants(case.laboratory))
        self.manifest = {**collect(case.identity, threads), "porous": drag_of(case)}
        self.newest = Path()  # newest checkpoint
        self.goal, self.met = goal, False

    def begin(self) -> Session:
        """Writes the first row, frame and checkpoint: from here on the run can be resumed, whatever happens."""
        with self.clock.stage("writing"):
            self.recorder.start(self.simulation)
        self.checkpoint()
        return self

    def restore(self, checkpoint: Checkpoint, manifest: Mapping[str, Any], hashes: Collection[str]) -> Session:
        """Brings files and clock to the checkpoint from which the simulation has been restored.

        manifest: run.json as it is; hashes: those that the case has, and had before it was prolonged. Rows and frames
        that the files have lost are reported and noted in run.json; the run goes on without them.
        """
        meta, recorder = checkpoint.meta, self.recorder
        recorder.restore(checkpoint.state)
        with self.clock.stage("writing"):
            lost = self.outputs.truncate_after(
                recorder.last.time, recorder.last_row, recorder.written, recorder.last.values, hashes
            )
        for text in lost:
            self.says.say(f"warning: {text}")
        self.clock.add(meta)
        self.newest = checkpoint.path
        resumed = [*manifest.get("resumed", []), {"step": checkpoint.step, "started": self.manifest["started"]}]
        self.manifest |= {k: manifest[k] for k in ("case", "started", "prolonged", "lost") if k in manifest}
        self.manifest["resumed"] = resumed
        if lost:
            self.manifest["lost"] = list(dict.fromkeys([*manifest.get("lost", []), *lost]))
        return self

    def march(self, until: float | None) -> bool:
        """Makes steps until the end of the case, or until the time is at or past `until` [s].

        The end is that of the case, or earlier where its answers are as sure as it asks. Returns True there. A
        checkpoint is written either way, from which the run can be resumed.
        """
        target = min(self.case.time.end, until if until is not None else self.case.time.end)
        self.says.start(self.simulation, target)
        try:
            with signals.noted() as reasons:
                due = perf_counter() + CHECKPOINT_EVERY
                while self.simulation.time < target and not reasons and not self.sure():
                    self.step()
                    if perf_counter() >= due:
                        self.checkpoint()
                        due = perf_counter() + CHECKPOINT_EVERY
                self.checkpoint(last=True)
        finally:
            self.says.stop()
        if reasons and not self.ended:
            raise Interrupted(
                f"{reasons[0]} at t = {self.simulation.time:.4g} s of {self.case.time.end:g} s; "
                f"a checkpoint is written. Go on with: houle resume {self.directory}"
            )
        return self.ended

    def sure(self) -> bool:
        """True if the answers are as sure as time.until asks; it looks at them only at frames some waves apart.

        The files hold the same rows then whether the run came here in one go or was resumed, so it ends at the same
        step either way.
        """
        if not self.goal.due(self.recorder):
            return False
        with self.clock.stage("answers"):
            self.outputs.commit()
            self.met = self.goal.sure(self.directory)
        if self.met:
            self.says.say(f"houle: the answers are as sure as asked at t = {self.simulation.time:g} s")
        return self.met

    @property
    def ended(self) -> bool:
        """True at the end of the case, or where its answers are as sure as it asks."""
        return self.met or self.simulation.time >= self.case.time.end

    def step(self) -> None:
        """Makes one time step, and writes the rows and the frame that it completes."""
        try:
            self.simulation.advance(self.recorder.stop)
            with self.clock.stage("gauges, sensors, ledger"):
                values = self.simulation.sample()
        except Exception as error:  # whatever it is, the user gets the bundle
            self.fail(error)
        with self.clock.stage("writing"):
            self.recorder.step(self.simulation, values)
            self.outputs.commit_if_due(COMMIT_EVERY)
        self.says.step(self.simulation)

    def fail(self, error: Exception) -> NoReturn:
        """Writes the failure bundle and raises SimulationError; its message says where the bundle is."""
        failure = as_failure(error, self.simulation.steps + 1, self.simulation.time)
        folder = write_bundle(self.directory, self.simulation.particles, failure, self.newest, self.manifest)
        self.outputs.close()
        write_manifest(self.directory, self.summarise(finished=False, failure=str(failure)))
        failure.args = (f"{failure}\nWhat is known about it is in {folder}; read diagnosis.txt first",)
        raise failure from error

    def checkpoint(self, last: bool = False) -> None:
        """Commits rows and frames to their files, then saves the state, then writes run.json: in this order."""
        with self.clock.stage("writing"):
            self._checkpoint(last)

    def _checkpoint(self, last: bool) -> None:
        recorded = self.recorder.state()
        if last and self.ended:
            self.recorder.finish(self.simulation)
        if last:
            self.outputs.close()
        else:
            self.outputs.commit()
        manifest = self.summarise(finished=False)
        names = ("time", "wall_seconds", "cpu_seconds", "operations", "stages")
        meta = {"case_hash": self.case.hash, **{n: manifest["summary"][n] for n in names}}
        state = {**self.simulation.state(), **recorded}
        self.newest = save_checkpoint(self.directory, self.simulation.steps, state, meta)
        write_manifest(self.directory, manifest)

    def summarise(self, finished: bool, **more: Any) -> dict[str, Any]:
        """The content of run.json; finished: every file of the run is complete."""
        simulation, last = self.simulation, self.recorder.last.values
        budget = ("kinetic_energy", "potential_energy", *WORKS)
        return summarise(
            self.manifest,
            finished=finished,
            time=simulation.time,
            steps=simulation.steps,
            particles=len(simulation.particles),
            volume_drift=simulation.volume_drift,
            energy={k: float(v) for k, v in last.items() if k in budget or k.startswith("energy_")},
            **self.clock.read(simulation.timings),
            **more,
        )
