"""Answers from gauges about waves, be the gauges those of a run of houle, of another program or of a laboratory.

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
    from houle.analysis.coefficients import reflection
    from houle.analysis.decay import Decay, pressure_decay
    from houle.analysis.erosion import Exit, Shields, critical_gradient, exit_gradient, lag, shields
    from houle.analysis.errors import AnalysisError
    from houle.analysis.events import Events, interval, load_events, mean_interval, per_wave
    from houle.analysis.impact import Impact, largest_pressure
    from houle.analysis.levels import Gauges
    from houle.analysis.overtopping import Overtopping, overtopping_events
    from houle.analysis.paper import Jh2020, jh2020
    from houle.analysis.quality import QualityCard, quality_card
    from houle.analysis.records import as_gauges, gauges, read_csv
    from houle.analysis.result import Reflection
    from houle.analysis.runup import RunUp, run_up
    from houle.analysis.separation import (
        Components,
        fit_wave_number,
        goda_suzuki,
        mansard_funke,
        separate_xt,
        zelt_skjelbreia,
    )
    from houle.analysis.slope import Layer, along_layer, excess_pore_pressure
    from houle.analysis.theory import Scatter, long_wave, porous_block, porous_block_lorentz
    from houle.analysis.volumes import Volumes, wave_volumes
    from houle.analysis.waves import Spectrum, Waves, find_omega, harmonics, spectrum, zero_crossing
    from houle.analysis.weibull import Weibull, weibull_fit
    from houle.analysis.window import Window, choose_window
    from houle.waves.dispersion import celerity, group_velocity, wave_number

__all__ = [
    "AnalysisError",
    "Components",
    "Decay",
    "Events",
    "Exit",
    "Gauges",
    "Impact",
    "Jh2020",
    "Layer",
    "Overtopping",
    "QualityCard",
    "Reflection",
    "RunUp",
    "Scatter",
    "Shields",
    "Spectrum",
    "Volumes",
    "Waves",
    "Weibull",
    "Window",
    "along_layer",
    "as_gauges",
    "celerity",
    "choose_window",
    "critical_gradient",
    "excess_pore_pressure",
    "exit_gradient",
    "find_omega",
    "fit_wave_number",
    "gauges",
    "goda_suzuki",
    "group_velocity",
    "harmonics",
    "interval",
    "jh2020",
    "lag",
    "largest_pressure",
    "load_events",
    "long_wave",
    "mansard_funke",
    "mean_interval",
    "overtopping_events",
    "per_wave",
    "porous_block",
    "porous_block_lorentz",
    "pressure_decay",
    "quality_card",
    "read_csv",
    "reflection",
    "run_up",
    "separate_xt",
    "shields",
    "spectrum",
    "wave_number",
    "wave_volumes",
    "weibull_fit",
    "zelt_skjelbreia",
    "zero_crossing",
]

_MODULES = {
    "coefficients": ("reflection",),
    "decay": ("Decay", "pressure_decay"),
    "erosion": (
        "Exit",
        "Shields",
        "critical_gradient",
        "exit_gradient",
        "lag",
        "shields",
    ),
    "errors": ("AnalysisError",),
    "events": ("Events", "interval", "load_events", "mean_interval", "per_wave"),
    "impact": (
        "Impact",
        "largest_pressure",
    ),
    "levels": ("Gauges",),
    "overtopping": (
        "Overtopping",
        "overtopping_events",
    ),
    "paper": (
        "Jh2020",
        "jh2020",
    ),
    "quality": (
        "QualityCard",
        "quality_card",
    ),
    "records": (
        "as_gauges",
        "gauges",
        "read_csv",
    ),
    "result": ("Reflection",),
    "runup": (
        "RunUp",
        "run_up",
    ),
    "separation": (
        "Components",
        "fit_wave_number",
        "goda_suzuki",
        "mansard_funke",
        "separate_xt",
        "zelt_skjelbreia",
    ),
    "slope": (
        "Layer",
        "along_layer",
        "excess_pore_pressure",
    ),
    "theory": (
        "Scatter",
        "long_wave",
        "porous_block",
        "porous_block_lorentz",
    ),
    "volumes": ("Volumes", "wave_volumes"),
    "waves": (
        "Spectrum",
        "Waves",
        "find_omega",
        "harmonics",
        "spectrum",
        "zero_crossing",
    ),
    "weibull": ("Weibull", "weibull_fit"),
    "window": (
        "Window",
        "choose_window",
    ),
}
_HOME = {name: f"houle.analysis.{module}" for module, names in _MODULES.items() for name in names}
_HOME |= dict.fromkeys(("celerity", "group_velocity", "wave_number"), "houle.waves.dispersion")


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'houle.analysis' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
