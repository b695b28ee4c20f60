"""The description of a quantity in the results: name, symbol, unit, place, and a sentence for the reader of the file.

A `Field` stands beside the code that observes the quantity, in `houle.observe`; the writers, `houle describe fields`
and the plots read it there. Units are SI, in the spelling of CF and UDUNITS. Volumes, forces and energies have another
unit in 2D, where they are per metre of width: see `Field.unit_in`. Sums over the run (works, energy of operations)
start at 0, so that rows of the series can be interpolated and subtracted from each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

Instant = Literal["position", "velocity", "pressure", "middle"]

RUN = "run"  # place of a quantity with one value for all of the water
LEVEL = "water_surface_height_above_reference_datum"  # standard name of a level in the CF table


@dataclass(frozen=True)
class Field:
    """A quantity that a run writes.

    place          where a value of it stands: "particle", "face", "centre", "surface", "run" (one value for all of the
                   water), or the dimension of series.nc that its observer names
    description    a sentence fragment for `long_name`
    unit_2d        unit in 2D, per metre of width, where it is another
    vector         whether there is one value per axis
    standard_name  name in the CF table, only if that table has exactly this quantity
    instant        instant of a step to which a sample belongs: that of the "position" of particles (its end), of the
                   "velocity" or the "pressure" (the scheme says when), or the "middle" of the step
    """

    name: str
    symbol: str
    unit: str
    place: str
    description: str
    unit_2d: str | None = None
    vector: bool = False
    standard_name: str | None = None
    instant: Instant = "position"

    def unit_in(self, dimension: int) -> str:
        """The unit in a run of 2 or 3 dimensions."""
        return self.unit_2d if dimension == 2 and self.unit_2d else self.unit

    def attributes(self, dimension: int) -> dict[str, str]:
        """The CF attributes of the quantity in a file of a run of 2 or 3 dimensions."""
        found = {"units": self.unit_in(dimension), "long_name": self.description, "symbol": self.symbol}
        return found | ({"standard_name": self.standard_name} if self.standard_name else {})


TIME = Field("time", "t", "s", "run", "simulated time since the start of the run")


@dataclass(frozen=True)
class Stations:
    """Names and coordinates of the values of an observer in series.nc.

    names        one for each value along the dimension
    coordinates  word -> (sentence, values [m]): the variable gauge_x of the dimension gauge has the word x
    fields       the quantities that stand there; all have the same place
    """

    names: Sequence[str]
    coordinates: Mapping[str, tuple[str, Sequence[float]]]
    fields: Sequence[Field]

    @property
    def dimension(self) -> str:
        """The name of the dimension along which the values stand; RUN where there is one value for the whole run."""
        return self.fields[0].place
