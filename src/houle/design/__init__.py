"""Published design formulas, one function each, with source, range and what lies outside of it.

    from houle import design

    found = design.overtopping_slope(wave_height=2.0, period=5.0, freeboard=5.0, cot_slope=3.0)
    print(found)               # mean discharge, band, surf similarity, source
    found.q, found.q_design    # m3/s/m
    found.outside              # sentences, empty where all inputs lie inside the range

Importing this is cheap: each name below is loaded when it is first used. All units are SI, angles are in radians.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from houle.design.armour import (
        Damage,
        StoneSize,
        armour_damage_van_der_meer,
        armour_damage_van_gent,
        armour_van_der_meer,
        armour_van_gent,
    )
    from houle.design.drag import DragRange, drag_range
    from houle.design.errors import DesignError
    from houle.design.formula import FORMULAS, Answer, Formula
    from houle.design.mound import CoreScale, PorePressure, core_scale, pore_pressure
    from houle.design.nearest import LaboratoryTest, NearestTests, Neighbour, nearest_tests
    from houle.design.overtopping import (
        Overtopping,
        overtopping_mound,
        overtopping_slope,
        overtopping_wall,
        overtopping_wall_foreshore,
    )
    from houle.design.reflection import ReflectionOfSlope, reflection_slope
    from houle.design.roughness import ROUGHNESS
    from houle.design.runup import RunUpLevel, SolitaryRunUp, run_up_slope, run_up_solitary
    from houle.design.seepage import Seepage, seepage_dam
    from houle.design.share import OvertoppingShare, overtopping_share
    from houle.design.ships import (
        BankDrawdown,
        Drawdown,
        LimitSpeed,
        SecondaryWaves,
        ship_drawdown,
        ship_drawdown_at_bank,
        ship_limit_speed,
        ship_waves,
    )
    from houle.design.transmission import Transmission, transmission_low_crest
    from houle.design.walls import StandingPressure, WallPressure, wall_goda, wall_sainflou, wall_takahashi

__all__ = [
    "FORMULAS",
    "ROUGHNESS",
    "Answer",
    "BankDrawdown",
    "CoreScale",
    "Damage",
    "DesignError",
    "DragRange",
    "Drawdown",
    "Formula",
    "LaboratoryTest",
    "LimitSpeed",
    "NearestTests",
    "Neighbour",
    "Overtopping",
    "OvertoppingShare",
    "PorePressure",
    "ReflectionOfSlope",
    "RunUpLevel",
    "SecondaryWaves",
    "Seepage",
    "SolitaryRunUp",
    "StandingPressure",
    "StoneSize",
    "Transmission",
    "WallPressure",
    "armour_damage_van_der_meer",
    "armour_damage_van_gent",
    "armour_van_der_meer",
    "armour_van_gent",
    "core_scale",
    "drag_range",
    "nearest_tests",
    "overtopping_mound",
    "overtopping_share",
    "overtopping_slope",
    "overtopping_wall",
    "overtopping_wall_foreshore",
    "pore_pressure",
    "reflection_slope",
    "run_up_slope",
    "run_up_solitary",
    "seepage_dam",
    "ship_drawdown",
    "ship_drawdown_at_bank",
    "ship_limit_speed",
    "ship_waves",
    "transmission_low_crest",
    "wall_goda",
    "wall_sainflou",
    "wall_takahashi",
]

_MODULES = {
    "armour": (
        "Damage",
        "StoneSize",
        "armour_damage_van_der_meer",
        "armour_damage_van_gent",
        "armour_van_der_meer",
        "armour_van_gent",
    ),
    "drag": ("DragRange", "drag_range"),
    "errors": ("DesignError",),
    "formula": ("FORMULAS", "Answer", "Formula"),
    "mound": ("CoreScale", "PorePressure", "core_scale", "pore_pressure"),
    "nearest": ("LaboratoryTest", "NearestTests", "Neighbour", "nearest_tests"),
    "overtopping": (
        "Overtopping",
        "overtopping_mound",
        "overtopping_slope",
        "overtopping_wall",
        "overtopping_wall_foreshore",
    ),
    "reflection": ("ReflectionOfSlope", "reflection_slope"),
    "roughness": ("ROUGHNESS",),
    "runup": ("RunUpLevel", "SolitaryRunUp", "run_up_slope", "run_up_solitary"),
    "share": ("OvertoppingShare", "overtopping_share"),
    "seepage": ("Seepage", "seepage_dam"),
    "ships": (
        "BankDrawdown",
        "Drawdown",
        "LimitSpeed",
        "SecondaryWaves",
        "ship_drawdown",
        "ship_drawdown_at_bank",
        "ship_limit_speed",
        "ship_waves",
    ),
    "transmission": ("Transmission", "transmission_low_crest"),
    "walls": ("StandingPressure", "WallPressure", "wall_goda", "wall_sainflou", "wall_takahashi"),
}
_HOME = {name: f"houle.design.{module}" for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'houle.design' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
