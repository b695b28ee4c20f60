"""checkpoint-<step>.h5: all that a run needs to go on bitwise as if it had not stopped. The newest two are kept.

A checkpoint is on the disk before it gets its name, and carries a SHA-256 of its content: what a power cut, a full disk
or a copy spoiled is found out and passed over, and the one before is taken.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from houle.output.atomic import new_hdf5, reported

KEPT = 2
FORMAT = 1


@dataclass(frozen=True)
class Checkpoint:
    """state: arrays and scalars by name, bitwise as saved; meta: what JSON holds (time, hash of the case, ...)."""

    path: Path
    step: int
    state: dict[str, NDArray]
    meta: dict[str, Any]


def save_checkpoint(directory: Path, step: int, state: Mapping[str, Any], meta: Mapping[str, Any]) -> Path:
    """Write the file whole, then remove all but the newest two, and those of later steps (the run was cut back)."""
    path = Path(directory) / f"checkpoint-{step}.h5"
    arrays = {name: np.asarray(value) for name, value in state.items()}
    text = json.dumps(dict(meta), sort_keys=True)
    with new_hdf5(path, durable=True) as file:
        file.attrs.update(format=FORMAT, step=step, sha256=_digest(arrays, text))
        file["meta"] = text
        group = file.create_group("state")
        for name, array in arrays.items():
            group.create_dataset(name, data=array)
    _prune(Path(directory), step)
    return path


def checkpoints(directory: Path) -> list[Path]:
    """The files, newest step first, good or not."""
    found = [path for path in Path(directory).glob("checkpoint-*.h5") if _step(path) is not None]
    return sorted(found, key=lambda path: _step(path) or 0, reverse=True)


def load_newest(directory: Path) -> Checkpoint | None:
    """The newest checkpoint that is whole, or None."""
    return next(filter(None, map(load, checkpoints(directory))), None)


def load(path: Path) -> Checkpoint | None:
    """One checkpoint, or None when it is damaged or of a format this version does not know."""
    try:
        with h5py.File(path) as file:
            if file.attrs["format"] != FORMAT:
                return None
            state = {name: np.asarray(dataset[()]) for name, dataset in file["state"].items()}
            text = file["meta"].asstr()[()]
            step, digest = int(file.attrs["step"]), file.attrs["sha256"]
    except (OSError, KeyError, RuntimeError, ValueError, TypeError):
        return None
    return Checkpoint(Path(path), step, state, json.loads(text)) if digest == _digest(state, text) else None


def _digest(arrays: Mapping[str, NDArray], text: str) -> str:
    """SHA-256 of names, types, shapes, bytes, and the meta text."""
    total = hashlib.sha256(text.encode())
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        total.update(f"{name} {array.dtype.str} {arrays[name].shape} ".encode())
        total.update(array.reshape(-1).view(np.uint8).data)
    return total.hexdigest()


def _step(path: Path) -> int | None:
    digits = path.stem.removeprefix("checkpoint-")
    return int(digits) if digits.isdigit() else None


def _prune(directory: Path, step: int) -> None:
    with reported(directory):
        files = checkpoints(directory)
        current = [path for path in files if (_step(path) or 0) <= step]
        for path in set(files) - set(current[:KEPT]):
            with contextlib.suppress(FileNotFoundError):
                path.unlink()
