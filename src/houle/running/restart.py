"""Restart of a run from its folder: from the newest checkpoint that is whole, sound and of this case."""

from __future__ import annotations

import datetime
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from houle.case.model import Case, load
from houle.errors import CaseError, HouleError
from houle.output import Checkpoint, checkpoints, read_manifest, write_manifest
from houle.output.atomic import DAMAGES, OutputError, told, write_text
from houle.output.checkpoint import load as load_checkpoint
from houle.running.progress import Silent
from houle.running.recorder import Nowhere, Recorder

if TYPE_CHECKING:
    from houle.flow.simulation import Simulation

CASE_FILE = "case.toml"
PARTICLES = ("flow/particles/position", "flow/particles/velocity", "flow/particles/volume")
ON_CELLS = ("flow/pressure", "flow/psi")  # arrays of a state, (nx, [ny,] rows)


def existing(directory: Path) -> tuple[Case, dict[str, Any], set[str]]:
    """The case of a run folder, its run.json, and the hashes that the case has and had before it was prolonged.

    run.json is {} if the run was killed before it wrote one. Raises CaseError if there is no run.
    """
    try:
        manifest = read_manifest(directory)
    except OutputError as error:
        if (directory / "run.json").exists():
            raise CaseError(str(error)) from None
        if not checkpoints(directory):
            raise CaseError(
                f"{directory} holds no run (no run.json). Give the folder that houle run wrote to"
            ) from None
        manifest = {}
    case = load(directory / CASE_FILE)
    former = {entry["case_hash"]: entry["to"] for entry in manifest.get("prolonged", [])}
    if case.hash in former and manifest["case"]["hash"] != case.hash:  # killed between run.json and case.toml
        case = _kept(directory, prolonged(case, manifest["prolonged"][-1]["to"]))
    return case, manifest, {case.hash, *former}


def prolonged(case: Case, until: float) -> Case:
    """The case with a later end [s], however sure its answers are before."""
    return load(case, {"time.end": float(until)} | ({} if case.time.until is None else {"time.until": None}))


def reached(case: Case, manifest: Mapping[str, Any]) -> float:
    """Time [s] at which a finished run ended: that of its case, or an earlier one if its answers were sure enough."""
    return case.time.end if case.time.until is None else float(manifest["summary"]["time"])


def prolong(
    directory: Path, case: Case, longer: Case, manifest: Mapping[str, Any], hashes: Collection[str]
) -> tuple[Case, dict[str, Any], set[str]]:
    """Writes the later end into run.json and case.toml, and returns what `existing` gives from then on."""
    now = datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")
    entry = {"from": reached(case, manifest), "to": longer.time.end, "case_hash": case.hash, "started": now}
    changed = {**manifest["case"], "hash": longer.hash, "text": longer.to_toml()}
    entries = [*manifest.get("prolonged", []), entry]
    found = {**manifest, "finished": False, "case": changed, "prolonged": entries}
    write_manifest(directory, found)
    return _kept(directory, longer), found, {longer.hash, *hashes}


def _kept(directory: Path, case: Case) -> Case:
    """Writes the case into the folder and returns it as read from there."""
    write_text(directory / CASE_FILE, case.to_toml())
    return load(directory / CASE_FILE)


def restored(
    directory: Path, case: Case, hashes: Collection[str], threads: int | None, says: Silent
) -> tuple[Simulation, Checkpoint]:
    """A simulation that stands where the newest good checkpoint does. CaseError if there is none."""
    others = False
    for path in checkpoints(directory):
        checkpoint = load_checkpoint(path)
        if checkpoint is None:
            says.say(f"warning: {path.name} is passed over: it is damaged, or another version of houle wrote it")
            continue
        if checkpoint.meta.get("case_hash") not in list(hashes):
            others = True
            says.say(f"warning: {path.name} is that of another case and passed over")
            continue
        simulation, problem = _restored(case, checkpoint, threads)
        if simulation is not None and problem is None:
            return simulation, checkpoint
        says.say(f"warning: {path.name} is passed over: {problem}")
    if others:
        raise CaseError(
            f"{directory / CASE_FILE} is not the case that was run (it was changed, or houle is another version). "
            "Put it back, or run the new case into a new folder: houle run CASE --out DIR"
        )
    raise CaseError(
        f"{directory} holds no good checkpoint. Start again in another folder (houle run CASE --out DIR), or remove it"
    )


def _restored(case: Case, checkpoint: Checkpoint, threads: int | None) -> tuple[Simulation | None, str | None]:
    """The simulation restored from a checkpoint, and in words what is wrong with that, None if nothing is."""
    from houle.case.build import build
    from houle.flow.simulation import Simulation

    state = {k: v for k, v in checkpoint.state.items() if not k.startswith("recorder.")}
    try:
        if (problem := problem_of(state, case)) is not None:
            return None, problem
        meta = checkpoint.meta
        spent = [meta["wall_seconds"], meta["cpu_seconds"]]
        spent += [seconds for name in ("operations", "stages") for seconds in meta[name].values()]
        if meta["time"] != float(state["flow/time"]) or not all(0 <= seconds < np.inf for seconds in spent):
            return None, "it does not agree with itself about the time"
        simulation = Simulation(build(case), threads)
        simulation.restore(state)
        known = simulation.state()
        recorder = Recorder(Nowhere(), case.time.end, case.output.every, case.output.series_every)
        recorder.restore(checkpoint.state)
        agrees = recorder.agrees(simulation)
    except HouleError:
        raise
    except DAMAGES as error:
        return None, f"its state is not that of this case ({told(error)})"
    if wrong := {name for name in known.keys() | state.keys() if _shape(known, name) != _shape(state, name)}:
        return None, f"its state is not that of this case ({', '.join(sorted(wrong))})"
    return simulation, None if agrees else "what it has observed is not of this run"


def _shape(state: Mapping[str, Any], name: str) -> tuple[int, ...] | None:
    return np.shape(state[name]) if name in state else None


def problem_of(state: Mapping[str, Any], case: Case) -> str | None:
    """The reason, in words, why a state cannot be one of this case; None if it can. It only looks at the arrays."""
    grid, size = case.domain.grid, np.array(case.domain.grid.size)
    position, velocity, volume = (np.asarray(state[name]) for name in PARTICLES)
    count, d = len(volume), grid.dimension
    if position.shape != (count, d) or velocity.shape != (count, d) or volume.shape != (count,):
        return "its particles do not agree about their number"
    for name in (*PARTICLES, *ON_CELLS):
        if name in state and not (np.asarray(state[name]).dtype.kind == "f" and np.isfinite(state[name]).all()):
            return f"{name} holds values that are not finite numbers"
    if not ((position >= -1e-9 * size).all() and (position <= (1 + 1e-9) * size).all()):
        return "it has particles outside the domain"
    if not ((volume > 0).all() and volume.sum() <= (1 + 1e-9) * np.prod(size)):
        return "it has more water than the domain can hold, or less than none"
    time, steps = float(state["flow/time"]), int(state["steps"])
    if not (0 <= time < np.inf and steps >= 0):
        return f"it is of t = {time:g} s, step {steps}"
    for name in ON_CELLS:
        shape = np.shape(state[name]) if name in state else grid.shape
        if shape[:-1] != grid.shape[:-1] or not 1 <= shape[-1] <= grid.shape[-1]:
            return f"{name} is not on the grid of this case"
    return None
