"""`houle run` and `houle resume`, from the first word to the last file, and the Run that they return."""

from __future__ import annotations

import functools
import os
import shutil
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib.util import find_spec
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

from houle.errors import CaseError
from houle.results.run import CASE_FILE, Run, checked_path, open_run
from houle.running.progress import Silent, reporter
from houle.running.signals import as_interrupts

if TYPE_CHECKING:
    from houle.case.model import Case
    from houle.results.answers.table import Answer
    from houle.running.session import Session

P = ParamSpec("P")
MOST_THREADS = 1 << 16
PRICE_ACCURACY = 3.0  # a run is refused if the free disk space is less than a third of the estimate


def stoppable(action: Callable[P, Run]) -> Callable[P, Run]:
    """Signals that ask a run to stop raise KeyboardInterrupt, also while it is not marching (there: signals.noted)."""

    @functools.wraps(action)
    def wrapped(*args: P.args, **options: P.kwargs) -> Run:
        with as_interrupts():
            return action(*args, **options)

    return wrapped


@stoppable
def run(
    case: Case | str | Path | dict[str, Any],
    out: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    until: float | None = None,
    progress: bool = False,
    overrides: Mapping[str, Any] | None = None,
) -> Run:
    """Computes a case and returns its run.

    case       a Case, a file, the name of a shipped case, or a dict of its tables; overrides are
               {"domain.spacing": 0.01}, as in houle.load
    out        the folder to write; if not given runs/<case name>, or runs/<case name>-2 and so on if that holds a run
    threads    number of threads; by default, and at most, one for each core that this process may use. The results do
               not depend on it
    until      stop after the first step that reaches this time [s]; houle.resume goes on
    progress   report the progress on standard error, and print the summary on standard output at the end

    Raises CaseError (the input is wrong, nothing was written), OutputError (a file could not be written),
    SimulationError (the run failed; DIR/failure says why), houle.running.session.Interrupted (Ctrl-C; a checkpoint was
    written).
    """
    says = reporter(progress)
    says.say(f"houle: reading {_called(case)}")
    from houle.case.model import load
    from houle.check import rules
    from houle.data import laboratory
    from houle.running.session import Clock, Session

    clock = Clock()
    if not isinstance(overrides, Mapping | None):
        raise CaseError(f"overrides = {overrides!r}: give a dictionary, such as {{'domain.spacing': 0.01}}")
    case = load(case, overrides=dict(overrides or {}))
    check_until(until, 0.0)
    directory = new_folder(case.case.name, out)
    check_place(case, directory)
    check_outputs(case, directory)
    for finding in rules.require(case):
        if finding.level == "warning":
            says.say(f"warning: {finding}")
    if (points := case.laboratory) is not None:
        laboratory.read(points)  # raises now rather than at the end
    threads = usable_threads(threads, says)
    if case.waves is not None and case.waves.seeds is not None:
        return _seeds(case, directory, threads, until, progress)
    says.say(f"houle: setting up {case.case.name}, spacing {case.domain.spacing:g} m, to t = {case.time.end:g} s")
    from houle.case.build import build
    from houle.flow.simulation import Simulation
    from houle.output.atomic import remove_leftovers
    from houle.output.lock import exclusive
    from houle.running.goal import Goal

    with clock.stage("set-up"):
        simulation = Simulation(build(case), threads)
    says.say(f"houle: writing to {directory}")
    with exclusive(directory):
        new_folder(case.case.name, directory)  # raises if another run was made there meanwhile
        remove_leftovers(directory)
        kept = keep_case(case, directory)
        session = Session(directory, kept, Goal(kept, _sure), simulation, threads, clock, says)
        session.manifest["case"]["file"] = None if case.path is None else str(case.path)
        return finish(session.begin(), until, progress)


@stoppable
def resume(
    directory: str | os.PathLike[str], threads: int | None = None, until: float | None = None, progress: bool = False
) -> Run:
    """Goes on from the newest good checkpoint of a run folder, bit for bit as if it had not stopped.

    Other files that are lost or damaged are reported and noted in run.json, and the run goes on without them. A
    finished run is returned as it is, or goes on past its end to a later `until` [s]. Arguments and errors are
    otherwise those of run().
    """
    says, directory = reporter(progress), checked_path(directory, "directory")
    says.say(f"houle: reading {directory}")
    from houle.check import rules
    from houle.output.atomic import remove_leftovers
    from houle.output.lock import exclusive
    from houle.running.goal import Goal
    from houle.running.restart import existing, prolong, prolonged, reached, restored
    from houle.running.session import Clock, Session

    clock, (case, manifest, hashes) = Clock(), existing(directory)
    check_until(until, None)
    if case.waves is not None and case.waves.seeds is not None:
        return _seeds(case, directory, threads, until, progress, manifest)
    finished = bool(manifest.get("finished"))
    if finished and not (until is not None and until > reached(case, manifest)):
        time = manifest["summary"]["time"]
        says.say(f"houle: {directory} is finished (t = {time:g} s); there is nothing to do")
        return Run(directory)
    with exclusive(directory):
        remove_leftovers(directory)
        if finished and until is not None:
            longer = prolonged(case, until)
            rules.require(longer)  # its record of waves may be too short, for example
            check_outputs(longer, directory)
        threads = usable_threads(threads, says)
        with clock.stage("set-up"):
            simulation, checkpoint = restored(directory, case, hashes, threads, says)
        check_until(until, checkpoint.meta["time"])
        if finished and until is not None:
            says.say(f"houle: prolonged from {reached(case, manifest):g} s to {until:g} s")
            case, manifest, hashes = prolong(directory, case, longer, manifest, hashes)
        says.say(f"houle: going on from {checkpoint.path.name}, t = {checkpoint.meta['time']:g} s")
        session = Session(directory, case, Goal(case, _sure), simulation, threads, clock, says)
        return finish(session.restore(checkpoint, manifest, hashes), until, progress)


def _seeds(
    case: Case,
    directory: Path,
    threads: int | None,
    until: float | None,
    progress: bool,
    earlier: dict[str, Any] | None = None,
) -> Run:
    """All runs of a case with seeds: begun, or gone on with where run.json, `earlier`, is there."""
    from houle.output.lock import exclusive
    from houle.results import summary
    from houle.running.seeds import Realisations

    if until is not None:
        raise CaseError(f"until = {until:g} s: with waves.seeds each run goes to time.end. Leave it out")
    says = reporter(progress)
    if earlier and earlier["finished"]:
        says.say(f"houle: all seeds of {directory} are finished; there is nothing to do")
        return Run(directory)
    says.say(f"houle: writing to {directory}")
    with exclusive(directory):
        kept = case
        if earlier is None:
            new_folder(case.case.name, directory)  # raises if another run was made there meanwhile
            kept = keep_case(case, directory)
        one, more = (functools.partial(action, progress=progress) for action in (run, resume))
        seeds = Realisations(directory, kept, one, more, functools.partial(_pooled, kept, directory, says), says)
        seeds.begin(threads, earlier)
        seeds.march(threads)
    found = Run(directory)
    if progress:
        with suppress(OSError, ValueError):  # nobody reads it
            summary.show(found.summary, directory)
    return found


def once(case: Case, directory: Path, threads: int | None = None, progress: bool = False) -> Run:
    """The run of this case in this folder: computed, gone on with, or as it lies there finished.

    Raises what run() and resume() raise; CaseError if the folder holds the run of another case.
    """
    if not (directory / "run.json").exists() or open_run(directory).case.hash != case.hash:
        return run(case, directory, threads, progress=progress)
    try:
        return resume(directory, threads, progress=progress)
    except CaseError as error:
        raise CaseError(f"{error}\nTo compute it anew, remove {directory}") from None


def finish(session: Session, until: float | None, progress: bool) -> Run:
    """Marches, then leaves pictures, the score against the laboratory and run.json; prints the summary."""
    from houle.running.session import Interrupted

    at_end = session.march(until)
    try:
        return _evaluate(session, at_end, progress)
    except KeyboardInterrupt as stop:
        raise Interrupted(
            f"{stop or 'Ctrl-C'} at t = {session.simulation.time:.4g} s, while the pictures were made; the water is "
            f"computed. Make what is missing with: houle resume {session.directory}"
        ) from None


def _evaluate(session: Session, at_end: bool, progress: bool) -> Run:
    """Makes the pictures, the score, the analyses and run.json of a run that has been marched; returns it."""
    from houle.output import write_manifest
    from houle.results import armour, bank, impacts, laboratory, reflection, summary, wave_energy, wave_quality

    run = Run(session.directory)
    with session.clock.stage("pictures"):
        draw(run, session)
    more = laboratory.record(run)
    if at_end:
        more |= reflection.record(run) | wave_energy.record(run) | impacts.record(run)
        more |= bank.record(run) | armour.record(run)
        with session.clock.stage("answers"):
            more |= _answers(run, session, more)
    write_manifest(run.directory, session.summarise(finished=at_end, **more))
    if "reflection" in more:
        with session.clock.stage("wave quality"):
            card = wave_quality.card(run.case, session.says)
        write_manifest(run.directory, session.summarise(finished=at_end, **more, wave_quality=card))
    run = Run(session.directory)
    if progress:
        with suppress(OSError, ValueError):  # nobody reads it
            summary.show(run.summary, run.directory)
    if not at_end:
        time = session.simulation.time
        session.says.say(f"houle: stopped at t = {time:g} s; go on with: houle resume {run.directory}")
    return run


def _sure(directory: Path) -> bool:
    """True if the answers of the run in this folder are as sure as time.until asks, by what its files hold."""
    from houle.results import reflection
    from houle.results.answers import record

    run = Run(directory)
    until = run.case.time.until
    return record.sure(run, reflection.look(run) if until is not None and until.reflection is not None else {})


def _pooled(case: Case, directory: Path, says: Silent, runs: list[Run]) -> tuple[dict[str, Any], bool]:
    """Writes the answers of several runs together; the entries of run.json, and true if they are sure enough."""
    from houle.results.answers import record

    rows = record.pooled(case, runs)
    found = record.record(directory, rows) | record.until(case, runs, rows) | record.reflection_entry(runs)
    _draw_answers(directory, case, rows, says)
    return found, case.time.until is not None and record.met(case, runs, rows)


def _draw_answers(directory: Path, case: Case, rows: list[Answer], says: Silent) -> None:
    """Draws answers.png. A picture that fails does not fail the run."""
    from houle.results.answers import record

    try:
        record.draw(directory, case.title, rows)
    except Exception as error:
        says.say(f"warning: no {record.PICTURE} ({type(error).__name__}: {error})")


def _answers(run: Run, session: Session, more: dict[str, Any]) -> dict[str, Any]:
    """Writes the answers of a run, and returns their entry of run.json. A picture that fails does not fail the run."""
    from houle.results.answers import record

    rows = record.answers(run, more)
    found = record.record(run.directory, rows) | record.until(run.case, [run], rows)
    _draw_answers(run.directory, run.case, rows, session.says)
    return found


def draw(run: Run, session: Session) -> None:
    """The pictures of the run, and the film if the case asks for one. A picture that fails does not fail the run."""
    session.says.say("houle: drawing pictures")
    grid = session.simulation.grid
    try:
        from houle.output import movie, pictures, series_table, surface_table

        series, surface = series_table(run.directory), surface_table(run.directory)
        pictures.write_pictures(run.directory, run.case, grid, series, surface, run.fields)
        if run.case.output.movie:
            session.says.say("houle: drawing the film")
            movie.write_movie(run.directory / movie.NAME, run.case, run.fields)
    except Exception as error:
        session.says.say(f"warning: no pictures ({type(error).__name__}: {error})")


def new_folder(name: str, out: str | os.PathLike[str] | None) -> Path:
    """The folder of a new run, not yet created: `out`, or the first of runs/name, runs/name-2, ... that is free."""
    directory = checked_path(Path("runs", name) if out is None else out, "out")
    if out is None:
        number = 2
        while holds_run(directory):
            directory, number = Path("runs", f"{name}-{number}"), number + 1
    elif holds_run(directory):
        raise CaseError(
            f"out = {directory} already holds a run. Go on with it (houle resume {directory}), "
            "give another folder, or delete this one"
        )
    there = next(p for p in (directory.absolute(), *directory.absolute().parents) if p.exists())
    if not there.is_dir() or not os.access(there, os.W_OK):
        problem = "is not writable" if there.is_dir() else "is a file"
        raise CaseError(f"out = {directory} cannot be written: {there} {problem}. Give another folder")
    return directory


def holds_run(directory: Path) -> bool:
    return (directory / "run.json").exists() or any(directory.glob("checkpoint-*.h5"))


def check_place(case: Case, directory: Path) -> None:
    """Refuses a folder where the run would write over the case file that it is made from."""
    if case.path is not None and case.path.absolute() == (directory / CASE_FILE).absolute():
        raise CaseError(
            f"out = {directory} holds {case.path}, which the run would write anew, without its comments: give another "
            "folder, or another name to the case file"
        )


def check_outputs(case: Case, directory: Path) -> None:
    """Refuses a run that would fail hours later: a film without its encoder, a disk that is far too small."""
    from houle.check.cost import price

    if case.output.movie and find_spec("imageio_ffmpeg") is None:
        raise CaseError('output.movie = true needs an encoder: pip install "houle[movie]", or leave it out')
    there = next(p for p in directory.absolute().parents if p.exists())
    estimate, free = price(case), shutil.disk_usage(there).free
    needed = estimate.disk / PRICE_ACCURACY
    if needed > free:
        key = "every" if estimate.frames > estimate.rows else "series_every"
        raise CaseError(
            f"output.{key} = {getattr(case.output, key):g} s writes at least {needed / 1e9:.2g} GB, {there} has "
            f"{free / 1e9:.2g} GB free: free some space, write elsewhere with --out, or set a longer output.{key}"
        )


def usable_threads(threads: int | None, says: Silent) -> int | None:
    """The number of threads to use, None for the default: no more than this process has cores, or they would wait."""
    from houle import _core
    from houle.running.cores import usable

    cores, whole = usable(), isinstance(threads, Integral) and not isinstance(threads, bool)
    if threads is not None and (not whole or not 1 <= threads <= MOST_THREADS):
        wanted = repr(threads) if len(repr(threads)) < 40 else f"{repr(threads)[:8]}..."
        raise CaseError(
            f"threads = {wanted}: give a whole number from 1 to {MOST_THREADS}, {cores} is best here, or leave it out"
        )
    asked = threads or _core.get_threads()  # the number in OMP_NUM_THREADS, or the one that was set before
    if asked <= cores:
        return threads
    there = os.cpu_count() or cores
    those = f"{there} cores" if there <= cores else f"{there} cores, of which this process may use {cores}"
    says.say(f"warning: threads = {asked} on a machine of {those}: {cores} are taken, more would wait for each other")
    return cores


def check_until(until: float | None, time: float | None) -> None:
    """Refuses an `until` that is no number, or not after the start of this stretch at `time` [s], if that is known."""
    if until is not None and (not isinstance(until, Real) or isinstance(until, bool) or until != until):
        raise CaseError(f"until = {until!r} is not a number: give a time [s]")
    if until is not None and time is not None and not until > time:
        raise CaseError(f"until = {until:g} s is not after t = {time:g} s, where this run begins. Give a later time")


def _called(case: Case | str | Path | dict[str, Any]) -> str:
    """Name of a case before it is read."""
    if isinstance(case, Mapping):
        head = case.get("case")
        return str(head.get("name", "a dict")) if isinstance(head, Mapping) else "a dict"
    return case.case.name if hasattr(case, "case") else str(case)


def keep_case(case: Case, directory: Path) -> Case:
    """Makes the folder with case.toml and copies of the files that it names, and returns the case read from there.

    A run needs no other file to be resumed or drawn again, so its folder can be moved.
    """
    from houle.case.model import load
    from houle.output.atomic import reported, write_text

    named = {f"open.{i}.file": side.file for i, side in enumerate(case.open)}
    named["waves.file"] = case.waves.file if case.waves is not None else None
    named["reference.surface"] = case.reference.surface if case.reference is not None else None
    moved = {}
    for key, name in named.items():
        if name is None:
            continue
        source, inside = case.folder / name, Path(name)
        if inside.is_absolute() or ".." in inside.parts:
            inside = Path(key + source.suffix)
            moved[key] = inside.name
        with reported(directory / inside):
            (directory / inside).parent.mkdir(parents=True, exist_ok=True)
            with suppress(shutil.SameFileError):
                shutil.copyfile(source, directory / inside)
    write_text(directory / CASE_FILE, load(case, moved).to_toml())
    return load(directory / CASE_FILE)
