"""The failure bundle: one folder with all that is needed to find out why a run failed.

failure/diagnosis.txt      one paragraph: what, when, where, and what to try
failure/worst.json         the worst particles as dicts
failure/checkpoint-*.h5    the last good state, to run up to the failure again
failure/case.toml          the case
failure/versions.json      program, compiler, packages, machine
"""

from __future__ import annotations

import json
import shutil
import textwrap
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from houle.errors import SimulationError

if TYPE_CHECKING:
    from houle.flow.particles import Particles

WORST = 20


def as_failure(error: Exception, step: int, time: float) -> SimulationError:
    """The error itself if it is a SimulationError; else a SimulationError with its text and traceback.

    step, time: number of the step in which it came up, and the time [s] at which that step began.
    """
    if isinstance(error, SimulationError):
        return error
    kind = type(error).__name__
    text = "".join(traceback.format_exception(error)).rstrip()
    diagnosis = f"An error that houle did not foresee; please report it with this folder. {kind}: {error}\n\n{text}"
    return SimulationError(f"unexpected {kind}: {error}", step=step, time=time, diagnosis=diagnosis)


def write_bundle(
    directory: Path, particles: Particles, error: SimulationError, checkpoint: Path, versions: dict[str, str]
) -> Path:
    """Writes DIR/failure, in place of an older one, and returns it. `checkpoint` is the last good one."""
    folder, building = directory / "failure", directory / "failure.tmp"
    for old in (building, folder):
        shutil.rmtree(old, ignore_errors=True)
    building.mkdir()
    worst = worst_particles(particles)
    record = {"message": str(error), "step": error.step, "time": error.time, "place": error.place, "worst": worst}
    (building / "worst.json").write_text(json.dumps(_plain(record), indent=2) + "\n")
    (building / "versions.json").write_text(json.dumps(_plain(versions), indent=2) + "\n")
    (building / "diagnosis.txt").write_text(diagnose(error, checkpoint) + "\n", encoding="utf-8")
    shutil.copy2(directory / "case.toml", building)
    shutil.copy2(checkpoint, building)
    building.rename(folder)
    return folder


def diagnose(error: SimulationError, checkpoint: Path) -> str:
    """The diagnosis of a failure in one paragraph, and a traceback if the error was unexpected."""
    where = "" if error.place is None else f" at ({', '.join(f'{x:.4g}' for x in error.place)}) m"
    first, _, rest = error.diagnosis.partition("\n")
    text = (
        f"Step {error.step}, t = {error.time:.6g} s{where}: {str(error).rstrip('.')}. {first} "
        f"The last good state is {checkpoint.name}; worst.json lists the worst particles."
    )
    return textwrap.fill(text, 100) + ("\n" + rest if rest else "")


def worst_particles(particles: Particles) -> list[dict]:
    """The particles that are not finite, then the fastest, WORST in all."""
    speed = np.sqrt(np.sum(particles.velocity**2, axis=1))
    finite = np.isfinite(speed) & np.isfinite(particles.position).all(axis=1) & np.isfinite(particles.volume)
    order = np.argsort(np.where(finite, -speed, -np.inf), kind="stable")[:WORST]
    return [
        {
            "particle": int(i),
            "position": particles.position[i].tolist(),
            "velocity": particles.velocity[i].tolist(),
            "volume": float(particles.volume[i]),
        }
        for i in order
    ]


def _plain(value: Any) -> Any:
    """A value that JSON can hold: NumPy becomes Python, and a number that is not finite its name, "nan" or "inf"."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    return value if isinstance(value, str | int | float | None) else str(value)
