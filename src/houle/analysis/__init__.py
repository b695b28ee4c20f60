"""What waves did, from gauges: of a run of ours, of another program, or of a laboratory.

    from houle import analysis

    found = analysis.reflection("flume.csv", depth=0.25, period=1.5, window=(20, 35))
    print(found)                     # C_R, C_T, C_D, each with its interval
    found.plot("reflection.png")

Importing this is cheap: each name below is loaded when it is first used. No module has the name of a function.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from houle.analysis.coefficients import Reflection, reflection
    from houle.analysis.errors import AnalysisError
    from houle.analysis.linear import celerity, group_velocity, wave_number
    from houle.analysis.paper import Jh2020, jh2020
    from houle.analysis.records import Gauges, as_gauges, gauges, read_csv
    from houle.analysis.separation import (
        Components,
        fit_wave_number,
        goda_suzuki,
        mansard_funke,
        separate_xt,
        zelt_skjelbreia,
    )
    from houle.analysis.theory import Scatter, long_wave, porous_block, porous_block_lorentz
    from houle.analysis.waves import Spectrum, Waves, find_omega, harmonics, spectrum, zero_crossing
    from houle.analysis.window import Window, choose_window

_MODULES = {
    "coefficients": ("Reflection", "reflection"),
    "errors": ("AnalysisError",),
    "records": ("Gauges", "as_gauges", "gauges", "read_csv"),
    "linear": ("celerity", "group_velocity", "wave_number"),
    "paper": ("Jh2020", "jh2020"),
    "separation": ("Components", "fit_wave_number", "goda_suzuki", "mansard_funke", "separate_xt", "zelt_skjelbreia"),
    "theory": ("Scatter", "long_wave", "porous_block", "porous_block_lorentz"),
    "waves": ("Spectrum", "Waves", "find_omega", "harmonics", "spectrum", "zero_crossing"),
    "window": ("Window", "choose_window"),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'houle.analysis' has no attribute {name!r}")
    value = getattr(import_module(f"houle.analysis.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
