"""houle: waves and dam-break flow through porous structures.

    import houle

    run = houle.run("dam-break-rock-35", overrides={"domain.spacing": 0.01})
    run.surface.eta.sel(time=0.8).plot()

Importing houle is cheap: NumPy and the numerical core are loaded when one of the names below is first used. (The code
of a run is in `houle.running.runner`: a module called `houle.run` would hide the function of this name.)
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from houle.case.model import Case, load
    from houle.errors import CaseError, HouleError, SimulationError
    from houle.results.run import Run, open_run
    from houle.running.runner import resume, run

__all__ = ["Case", "CaseError", "HouleError", "Run", "SimulationError", "load", "open_run", "resume", "run"]

_HOME = {
    "Case": "houle.case.model",
    "load": "houle.case.model",
    "CaseError": "houle.errors",
    "HouleError": "houle.errors",
    "SimulationError": "houle.errors",
    "Run": "houle.results.run",
    "open_run": "houle.results.run",
    "resume": "houle.running.runner",
    "run": "houle.running.runner",
}


def __getattr__(name: str) -> Any:
    value: Any
    if name == "__version__":
        value = _version()
    elif name in ("analysis", "design"):
        value = import_module(f"houle.{name}")
    elif name == "_core":
        value = _compiled_core()
    elif name in _HOME:
        value = getattr(import_module(_HOME[name]), name)
    else:
        raise AttributeError(f"module 'houle' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


def _compiled_core() -> ModuleType:
    """The compiled core (`bind/`, `core/`) with the widest vectors that this processor runs.

    A wheel holds two variants, which compute the same bits: `v3` for processors with AVX2, which refuses to be imported
    on others, and `portable`. A build for one machine holds one. HOULE_CORE in the environment takes another by name.
    """
    import os
    from contextlib import suppress
    from importlib.util import find_spec

    wanted = os.environ.get("HOULE_CORE")
    modules = [f"houle._core_{variant}" for variant in ([wanted] if wanted else ("own", "v3", "portable"))]
    built = [module for module in modules if find_spec(module)]
    if not built:
        raise ModuleNotFoundError(f"houle has no compiled core: no module {' or '.join(modules)}")
    for module in built[:-1]:
        with suppress(ImportError):
            return import_module(module)
    return import_module(built[-1])


def _version() -> str:
    """The installed version; "unknown" when the sources are on the path and nothing is installed."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("houle")
    except PackageNotFoundError:
        return "unknown"
