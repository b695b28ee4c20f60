"""run.json, the manifest of a run: case, machine, versions, outcome. A second run from it gives the same numbers."""

from __future__ import annotations

import datetime
import json
import math
import os
import platform
import sys
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from houle.output.atomic import OutputError, regular, write_text

NAME = "run.json"
PACKAGES = ("numpy", "h5py", "h5netcdf", "xarray", "pydantic", "shapely", "matplotlib")


def about(identity: Mapping[str, str | None]) -> dict[str, str]:
    """Global attributes of every file of results: title, houle and its version, name and hash of the case.

    identity: that of the case (`Case.identity`).
    """
    import houle

    return {
        "title": str(identity["title"] or identity["name"]),
        "source": f"houle {houle.__version__}",
        "case": str(identity["name"]),
        "case_hash": str(identity["hash"]),
    }


def collect(identity: Mapping[str, str | None], threads: int | None) -> dict[str, Any]:
    """The manifest at the start of a run: identity of the case, houle and its build, machine, packages, time.

    `finished` is False until `summarise`.
    """
    import houle

    return {
        "finished": False,
        "case": dict(identity),
        "houle": {"version": houle.__version__, "build": _build()},
        "machine": {"cpu": _cpu(), "cores": os.cpu_count(), "threads": threads, "platform": platform.platform()},
        "python": {"version": platform.python_version(), "packages": _packages()},
        "command": sys.argv[:],
        "started": _now(),
    }


def summarise(
    manifest: Mapping[str, Any],
    *,
    finished: bool,
    time: float,
    steps: int,
    particles: int,
    wall_seconds: float,
    cpu_seconds: float,
    operations: Mapping[str, float],
    volume_drift: float,
    energy: Mapping[str, float],
    **more: Any,
) -> dict[str, Any]:
    """The manifest with the outcome: simulated time [s], seconds in all and per operation, budgets."""
    summary = {
        "time": time,
        "steps": steps,
        "particles": particles,
        "wall_seconds": wall_seconds,
        "cpu_seconds": cpu_seconds,
        "operations": dict(operations),
        "volume_drift": volume_drift,
        "energy": dict(energy),
    }
    return {**manifest, "finished": finished, "ended": _now(), "summary": {**summary, **more}}


def write_manifest(directory: Path, manifest: Mapping[str, Any]) -> Path:
    """run.json, whole or not at all. Strict JSON: numbers that are not finite become null."""
    path = Path(directory) / NAME
    write_text(path, json.dumps(_plain(manifest), indent=2, ensure_ascii=False, allow_nan=False) + "\n")
    return path


def read_manifest(directory: Path) -> dict[str, Any]:
    """run.json of a run; OutputError when it is not there or not ours."""
    path = Path(directory) / NAME
    try:
        found = json.loads(regular(path).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise OutputError(path, str(error), "is this the folder of a run?", verb="read") from error
    if missing := _missing(found):
        raise OutputError(path, f"it is not what a run of houle writes ({missing})", "put it back", verb="read")
    return found


def _missing(found: Any) -> str:
    """Names of the entries that the manifest of a run must have and this lacks; "" if it is one."""
    kinds: dict[str, Any] = {"finished": bool, "case": dict, "started": str, "summary": dict}
    within: dict[str, Any] = {"time": Real, "steps": Real, "particles": Real, "wall_seconds": Real, "cpu_seconds": Real}
    within |= {"operations": dict, "energy": dict}
    if not isinstance(found, dict):
        return "no table"
    wrong = [key for key, kind in kinds.items() if not isinstance(found.get(key), kind)]
    if wrong:
        return ", ".join(wrong)
    wrong = [f"summary.{key}" for key, kind in within.items() if not isinstance(found["summary"].get(key), kind)]
    wrong += [f"case.{key}" for key in ("name", "hash", "text") if not isinstance(found["case"].get(key), str)]
    lists = [key for key in ("resumed", "prolonged", "lost") if not isinstance(found.get(key, []), list)]
    for entry in found.get("prolonged", []) if not lists else []:
        if not (isinstance(entry, dict) and isinstance(entry.get("case_hash"), str) and _finite(entry.get("to"))):
            lists.append("prolonged")
    return ", ".join([*wrong, *lists])


def _finite(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def _plain(value: Any) -> Any:
    """A value that JSON can hold, made of dicts, sequences, NumPy numbers and arrays, and paths."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, set)):
        return [_plain(item) for item in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return _plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, int):
        return value
    return str(value).encode("utf-8", "backslashreplace").decode("utf-8")  # names of files may be no text


def _now() -> str:
    return datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")


def _build() -> dict[str, Any]:
    """Compiler and flags of the C++ core, and threads in use; empty if it does not tell."""
    from houle import _core

    info = getattr(_core, "build_info", None)
    return dict(info() if callable(info) else info or {})


def _packages() -> dict[str, str]:
    found = {}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def _cpu() -> str:
    """The name of the processor, as well as the system tells it."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
