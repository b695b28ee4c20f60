"""Inside a rubble mound: how wave pressure decays in the core, and which grain models a core at small scale.

Oumeraci & Partenscky (1990), Proc. 22nd ICCE; Burcharth, Liu & Troch (1999), Coastal Engineering in Developing
Countries; Troch (2000), PhD thesis, Ghent University.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, pi, sqrt
from typing import Annotated

from scipy.optimize import brentq

from houle.design.drag import LawName, beyond, drag_of
from houle.design.formula import Answer, Input, formula, quantity
from houle.design.inputs import Diameter, Porosity, Viscosity
from houle.medium.resistance import steady_velocity
from houle.waves.dispersion import GRAVITY

DECAY = 0.0141  # coefficient of delta
SLOWER = 1.4  # square of the length in water over that in the core


@dataclass(frozen=True, kw_only=True)
class PorePressure(Answer):
    """Amplitude of the wave pressure in the core of a mound."""

    p: float = quantity("amplitude of the pressure at x", "Pa")
    delta: float = quantity("coefficient of decay", "-")
    length: float = quantity("length of the wave in the core, L'", "m")
    gradient: float = quantity("largest hydraulic gradient along x, there", "-")


@dataclass(frozen=True, kw_only=True)
class CoreScale(Answer):
    """Grain of a model core in which water moves as in the prototype's."""

    grain_diameter: float = quantity("grain diameter of the core in the model", "m")
    distortion: float = quantity("that over the grain that the length scale alone gives", "-")
    velocity: float = quantity("Darcy velocity in the core of the prototype", "m/s")
    reynolds: float = quantity("its Reynolds number with the grain diameter", "-")
    reynolds_model: float = quantity("Reynolds number in the core of the model", "-")


@formula(
    "pore-pressure",
    "Decay of the wave pressure in the core of a rubble mound.",
    source="Oumeraci & Partenscky (1990), Burcharth, Liu & Troch (1999), Troch (2000)",
    status="RECALLED; the gradient is derived from it",
    holds="core of one material, x from its seaward face at one level",
    example={
        "pressure": 10000.0, "x": 5.0, "wave_height": 3.0, "wave_length": 60.0, "porosity": 0.4, "core_width": 20.0,
    },
)  # fmt: skip
def pore_pressure(
    *,
    pressure: Annotated[float, Input("amplitude of the pressure at the face of the core, p0", "Pa", above=0)],
    x: Annotated[float, Input("distance from the face of the core", "m", least=0)],
    wave_height: Annotated[float, Input("significant wave height H_s", "m", above=0)],
    wave_length: Annotated[float, Input("length of the waves of the peak period in front, L_p", "m", above=0)],
    porosity: Porosity,
    core_width: Annotated[float, Input("width of the core at the level, b", "m", above=0)],
) -> PorePressure:
    """Pressure p = p0 exp(-delta 2 pi x/L'), L' = L_p/sqrt(1.4), delta = 0.0141 sqrt(n) L_p^2/(Hs b).

    The gradient is the largest of the damped wave p cos(2 pi x/L' - omega t): p 2 pi/L' sqrt(1 + delta^2)/(rho g), with
    rho = 1000 kg/m3.
    """
    delta = DECAY * sqrt(porosity) * wave_length**2 / (wave_height * core_width)
    length = wave_length / sqrt(SLOWER)
    p = pressure * exp(-delta * 2 * pi * x / length)
    gradient = p * 2 * pi / length * sqrt(1 + delta**2) / (1000.0 * GRAVITY)
    return PorePressure(p=p, delta=delta, length=length, gradient=gradient, ratios={"x/b": x / core_width})


def similar_grain(
    velocity: Callable[[float, float], float], grain_diameter: float, scale: float
) -> tuple[float, float]:
    """Darcy velocity [m/s] in the prototype, and the model's grain diameter [m] that gives it over sqrt(scale).

    velocity        the Darcy velocity [m/s] that a grain diameter [m] gives, and a scale of time: 1 in the prototype,
                    sqrt(scale) in the model
    grain_diameter  of the prototype [m]; that of the model lies between it and it over the scale
    """
    full, slow, small = velocity(grain_diameter, 1.0), sqrt(scale), grain_diameter / scale

    def excess(d: float) -> float:
        return velocity(d, slow) - full / slow

    if excess(small) >= 0:
        return full, small
    return full, float(brentq(excess, small, grain_diameter, xtol=1e-12 * small, rtol=1e-12))


@formula(
    "core-scale",
    "Grain of the core of a laboratory model in which the gradients are those of the prototype.",
    source="after Burcharth, Liu & Troch (1999), with one gradient instead of their mean over the core and the period",
    status="RECALLED",
    holds="inside the range of the law of resistance, in prototype and model",
    example={
        "scale": 5.0, "gradient": 0.2, "porosity": 0.4, "grain_diameter": 0.07, "period": 10.0,
    },
)  # fmt: skip
def core_scale(
    *,
    scale: Annotated[float, Input("length in the prototype over that in the model: 40 for 1:40", "-", above=1)],
    gradient: Annotated[float, Input("hydraulic gradient in the core, the same in both", "-", above=0)],
    porosity: Porosity,
    grain_diameter: Diameter,
    law: LawName = "van-gent-1995",
    period: Annotated[float, Input("period of the waves in the prototype", "s", above=0)] | None = None,
    viscosity: Viscosity = 1.0e-6,
) -> CoreScale:
    """Grain of a model core, for which the velocity is that of the prototype over sqrt(scale) at the same gradient.

    The velocity follows from g I = a u + b u^2, with a and b of the law. Scaled by length alone a core resists too
    much, as its laminar part a grows; this grain is larger. A law that knows the period counts it where it is given.
    """

    def flow(d: float, time_scale: float) -> float:
        drag = drag_of(law, porosity, d, viscosity, None if period is None else period / time_scale)
        return steady_velocity(*drag, gradient)

    velocity, model = similar_grain(flow, grain_diameter, scale)
    slow, small = sqrt(scale), grain_diameter / scale
    reynolds, reynolds_model = velocity * grain_diameter / viscosity, velocity / slow * model / viscosity
    return CoreScale(
        grain_diameter=model,
        distortion=model / small,
        velocity=velocity,
        reynolds=reynolds,
        reynolds_model=reynolds_model,
        ratios={"n": porosity},
        branch=f"law {law}",
        outside=(
            *beyond(law, porosity, grain_diameter, "prototype", reynolds),
            *beyond(law, porosity, model, "model", reynolds_model),
        ),
    )
