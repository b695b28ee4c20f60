"""checkpoint-<step>.h5: all that a run needs to go on bitwise as if it had not stopped. The newest two are kept.

A checkpoint is on the disk before it gets its name. It carries a SHA-256 of its content and, in a block in front of the
HDF5 file, one of its bytes. So a file that a power cut, a full disk or a copy has spoiled is found out before HDF5
reads it, and the checkpoint before it is taken.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from houle.output.atomic import DAMAGES, Sink, regular, replacing, reported

KEPT = 2  # checkpoints in a folder
BLOCK = 512  # bytes in front of the HDF5 file, which it leaves to the user
WORDS = "houle checkpoint, HDF5 after this block of 512 bytes\nsha256 of the rest: "
FORMAT = 2  # the first format had no groups


@dataclass(frozen=True)
class Checkpoint:
    """A checkpoint as it was saved.

    state  arrays and scalars by their paths in the tree of components, bitwise as saved
    meta   values that JSON can hold: time, hash of the case, ...
    """

    path: Path
    step: int
    state: dict[str, NDArray]
    meta: dict[str, Any]


def save_checkpoint(directory: Path, step: int, state: Mapping[str, Any], meta: Mapping[str, Any]) -> Path:
    """Writes a checkpoint, whole or not at all. Then removes all but the newest two, and those of later steps.

    There are later ones when a run was taken up again from an earlier step.
    """
    path = Path(directory) / f"checkpoint-{step}.h5"
    arrays = {name: np.asarray(value) for name, value in state.items()}
    text = json.dumps(dict(meta), sort_keys=True)
    with replacing(path, durable=True) as temporary:
        with Sink(temporary) as sink, h5py.File(sink, "w", userblock_size=BLOCK) as file:
            file.attrs.update(format=FORMAT, step=step, sha256=_digest(arrays, text))
            file["meta"] = text
            group = file.create_group("state")
            for name, array in arrays.items():
                group.create_dataset(name, data=array)
        with open(temporary, "r+b") as whole:
            whole.write(_seal(temporary))
    _prune(Path(directory), step)
    return path


def checkpoints(directory: Path) -> list[Path]:
    """Paths of the checkpoints, newest step first, damaged ones too."""
    found = [path for path in Path(directory).glob("checkpoint-*.h5") if _step(path) is not None]
    return sorted(found, key=lambda path: _step(path) or 0, reverse=True)


def load_newest(directory: Path) -> Checkpoint | None:
    """The newest checkpoint that is whole, or None."""
    return next(filter(None, map(load, checkpoints(directory))), None)


def load(path: Path) -> Checkpoint | None:
    """One checkpoint, or None when it is damaged or of a format this version does not know."""
    try:
        if not _unbroken(regular(path)):
            return None
        with h5py.File(path) as file:
            if file.attrs["format"] != FORMAT:
                return None
            state = _leaves(file["state"])
            text = file["meta"].asstr()[()]
            step, digest = int(file.attrs["step"]), file.attrs["sha256"]
        if digest != _digest(state, text):
            return None
        meta = json.loads(text)
    except (*DAMAGES, RecursionError):
        return None
    return Checkpoint(Path(path), step, state, meta) if isinstance(meta, dict) and step == _step(path) else None


def _leaves(tree: h5py.Group) -> dict[str, NDArray]:
    """The arrays of a tree of groups by their paths in it; links are not followed."""
    found = {}

    def leaf(name: str, node: h5py.Group | h5py.Dataset) -> None:
        if isinstance(node, h5py.Dataset):
            found[name] = _values(node)

    tree.visititems(leaf)
    return found


def _values(dataset: h5py.Dataset) -> NDArray:
    """Numbers of a dataset. Raises ValueError if the file does not hold them all, before memory is taken for them."""
    if dataset.size and dataset.id.get_storage_size() != dataset.size * dataset.dtype.itemsize:
        raise ValueError(f"{dataset.name} holds less than its shape says")
    return np.asarray(dataset[()])


def _seal(path: Path) -> bytes:
    """The block in front: a line that says what the file is, and the SHA-256 of the bytes behind the block."""
    total = hashlib.sha256()
    with open(path, "rb") as file:
        file.seek(BLOCK)
        while piece := file.read(1 << 20):
            total.update(piece)
    return f"{WORDS}{total.hexdigest()}\n".encode().ljust(BLOCK, b"\0")


def _unbroken(path: Path) -> bool:
    """True if the bytes are those that were written, or the file is of an earlier version, which has no block."""
    with open(path, "rb") as file:
        start = file.read(BLOCK)
    return start.startswith(b"\x89HDF") or start == _seal(path)


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
            if not path.is_dir():  # a folder is not ours
                path.unlink(missing_ok=True)
