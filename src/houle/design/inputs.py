"""Numbers that several formulas take, each with its meaning, its unit and the values that make sense."""

from __future__ import annotations

from math import pi
from typing import Annotated

from houle.design.formula import Choice, Input
from houle.design.roughness import ROUGHNESS

Height = Annotated[float, Input("significant wave height H_m0 at the toe", "m", above=0)]
EnergyPeriod = Annotated[float, Input("spectral period T_m-1,0 at the toe; T_p/1.1 in a sea of one peak", "s", above=0)]
Freeboard = Annotated[float, Input("height of the crest above still water, R_c", "m", least=0)]
CotSlope = Annotated[float, Input("cotangent of the angle of the slope: 2 for 1:2", "-", above=0)]
Factor = Annotated[float, Input("influence factor, 1 for none", "-", above=0, most=1)]
_ROUGH = (
    f"roughness factor gamma_f: 1 smooth, {ROUGHNESS['rock, two layers, permeable core']:g} two layers of rock on a "
    "permeable core; all in houle.design.ROUGHNESS"
)
Roughness = Annotated[float, Input(_ROUGH, "-", above=0, most=1)]
Obliquity = Annotated[float, Input("angle between the waves and the normal", "rad", least=-pi / 2, most=pi / 2)]
Depth = Annotated[float, Input("depth of still water at the toe", "m", above=0)]
Porosity = Annotated[float, Input("porosity", "-", above=0, below=1)]
Diameter = Annotated[float, Input("grain diameter d_50", "m", above=0)]
Density = Annotated[float, Input("density of the water", "kg/m3", least=100, most=20000)]
Viscosity = Annotated[float, Input("kinematic viscosity of the water", "m2/s", above=0)]
Permeable = Annotated[bool, Choice("whether the core is permeable", (True, False))]
