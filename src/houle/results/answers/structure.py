"""The sea, the section and the wall that answers are about, in numbers and arrays."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

from houle.grid import FloatArray


@dataclass(frozen=True)
class Sea:
    """The waves that come to a structure.

    height    H_m0 of a sea, height of a regular wave [m]; NaN where there is no steady sea
    period    T_m-1,0 of a sea, period of a regular wave [s]; mean: mean period between zero crossings [s]
    depth     where the waves are made [m]; level of still water above z = 0 [m]
    maker     end of the maker towards the structure, x [m]; speed: group velocity [m/s]; ramp, end: times [s]
    regular   true of waves that are all alike
    words     how the numbers were got
    lack      reason for which there is no sea in the sense of the formulas, "" if there is
    angle     between the waves and the x axis [rad]
    """

    height: float
    period: float
    mean: float
    depth: float
    level: float
    maker: float
    speed: float
    ramp: float
    end: float
    regular: bool = False
    words: str = ""
    lack: str = ""
    angle: float = 0.0

    def start(self, x: float) -> float:
        """Time [s] from which the waves have arrived at x [m]: the ramp, and the way with the group velocity."""
        return self.ramp + abs(x - self.maker) / self.speed

    def waves(self, x: float) -> float:
        """Number of waves between their arrival at x [m] and the end of the run, by the mean period."""
        return (self.end - self.start(x)) / self.mean


@dataclass(frozen=True)
class Outline:
    """The section in front of a crest, seen from the sea; lengths in metres, heights above still water.

    kind         "slope" (impermeable), "mound" (permeable armour) or "wall"
    x            where the structure begins at still water: the face of a wall
    freeboard    R_c, of the highest top in front of the water that is counted
    cot_slope    of the front between 1.5 H_m0 below and above still water, without berms; 0 of a wall
    depth        at the toe; foreshore: true where the bed before the toe is not level
    crest_width  G_c of the armour; armour_crest A_c, the freeboard where no wall stands above it
    permeable    true if no solid lies behind the armour at half a wave height below still water
    berm         length of flat parts of the front [m], which no formula here takes
    on_berm      depth in front of the face of a wall, above its berm; berm_width in front of the face
    foot         lower edge of the wall below still water
    words        the outline in a sentence
    """

    kind: str
    x: float
    freeboard: float
    cot_slope: float
    depth: float
    foreshore: bool
    crest_width: float
    armour_crest: float
    permeable: bool
    berm: float = 0.0
    on_berm: float = nan
    berm_width: float = 0.0
    foot: float = nan
    words: str = ""


@dataclass(frozen=True)
class Wall:
    """A structure, its place and its loads per metre; T rows of the series.

    front, crest   x of its face towards the waves, and of its highest part [m]
    width          of its base [m]; under: true if water is under it
    horizontal     (T,) force in the direction of the waves [N/m]
    upward         (T,) force upwards, buoyancy included [N/m]
    moment         (T,) about the heel, positive when it tips the structure in the direction of the waves [N]
    about          sentence on the point of the moment
    arm            distance of the middle of its area from the heel, seawards [m]
    outline        the section, of a side of the tank; of others it is looked at
    """

    name: str
    front: float
    crest: float
    width: float
    under: bool
    horizontal: FloatArray
    upward: FloatArray
    moment: FloatArray
    about: str
    arm: float
    outline: Outline | None = None
