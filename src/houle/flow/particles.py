"""Water particles: named columns with one row for each particle, which carries a volume of water and moves with it.

Every particle has a position, a Darcy velocity and a volume. Whatever else a run keeps for each particle is a column
that its owner (the flow, a transfer, a boundary, a feature of yours) declares once, in one place:

    flow.particles.declare(Column("salinity", "water"))      # then: flow.particles["salinity"], (N,)

From then on the column is sorted with the particles, kept and thinned out with them, filled for new particles and saved
in checkpoints, as its kind says:

    kind     belongs to                sorted   where water joins   after remeshing         saved
    water    the water                 yes      mean by volume      handed on with it       yes
    grid     the fields on the grid    yes      stays               its owner makes it      yes
    place    where the particle is     no       stays               its owner reads it      no

A column of the water is an amount per volume (a temperature, a concentration): the sum of volume times value is
conserved by remeshing to round-off. The transfer fills the columns that it makes from the grid in `Transfer.renew`. A
column of the place is read by its owner from the medium after every motion and sorting (`Flow.sample_medium`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from houle import _core
from houle.flow.component import Component, State
from houle.grid import FloatArray, Grid

OWN = ("position", "velocity", "volume")  # the columns that every particle has

Nodes = tuple[int, int]  # first node along x of the lattice of new particles, and the one after the last; -1: all
EVERYWHERE: Nodes = (0, -1)


@dataclass(frozen=True)
class Column:
    """Declaration of a quantity that each particle has besides its position, velocity and volume.

    shape  of the value of one particle: () a number, (d,) a vector, (d, d) a matrix
    new    value of new particles that nobody gives one: those at the start, and those that enter at an open side
    """

    name: str
    kind: Literal["water", "grid", "place"]
    shape: tuple[int, ...] = ()
    new: float = 0.0
    dtype: type[np.floating[Any]] = np.float64

    def values(self, count: int) -> FloatArray:
        """The column of `count` new particles, (count, *shape)."""
        return np.full((count, *self.shape), self.new, self.dtype)


class Particles(Component):
    """N particles: position (N, d) [m]; velocity (N, d), Darcy [m/s]; volume (N,) of water [m^d]; declared columns.

    The volume of a particle is constant between remeshings, unless water joins it or is taken from it at an open side.
    `select`, `append` and `replaced` give new particles with the same columns; the other methods change these.
    """

    def __init__(self, position: FloatArray, velocity: FloatArray, volume: FloatArray) -> None:
        self.position, self.velocity, self.volume = position, velocity, volume
        self.declared: dict[str, Column] = {}
        self._further: dict[str, FloatArray] = {}

    def __len__(self) -> int:
        return len(self.volume)

    # ---- columns -------------------------------------------------------------------------------------------------

    def declare(self, *columns: Column) -> None:
        """Gives every particle these columns too, with the value of new particles; a column that exists stays."""
        for column in columns:
            if self.declared.get(column.name) == column:
                continue
            if column.name in self.declared or column.name in OWN:
                raise ValueError(f"particles have another column {column.name} already")
            self.declared[column.name] = column
            self._further[column.name] = column.values(len(self))

    def __contains__(self, name: str) -> bool:
        return name in self.declared

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A declared column, (N, *shape): the array itself."""
        return self._further[name]

    def get(self, name: str) -> NDArray[Any] | None:
        """A declared column, or None where no such column was declared."""
        return self._further.get(name)

    def of_kind(self, kind: str) -> list[str]:
        """Names of the declared columns of a kind, in the order in which they were declared."""
        return [name for name, column in self.declared.items() if column.kind == kind]

    # ---- other particles -----------------------------------------------------------------------------------------

    def select(self, chosen: NDArray[np.bool_] | NDArray[np.integer[Any]]) -> Particles:
        """The particles for which a mask (N,) is true, or those with these numbers, in that order."""
        some = Particles(self.position[chosen], self.velocity[chosen], self.volume[chosen])
        return self._same_columns(some, {name: values[chosen] for name, values in self._further.items()})

    def append(self, position: FloatArray, velocity: FloatArray, volume: FloatArray, **given: FloatArray) -> Particles:
        """These particles, then M more. given: values (M, *shape) of declared columns for those, `new` otherwise."""
        own = zip((self.position, self.velocity, self.volume), (position, velocity, volume), strict=True)
        more = Particles(*(np.concatenate(both) for both in own))
        values = {
            name: np.concatenate([values, given.get(name, self.declared[name].values(len(volume)))])
            for name, values in self._further.items()
        }
        return self._same_columns(more, values)

    def replaced(self, position: FloatArray, velocity: FloatArray, volume: FloatArray) -> Particles:
        """Other particles with the same declared columns as these; the values in them are `new`."""
        others = Particles(position, velocity, volume)
        return self._same_columns(others, {name: column.values(len(others)) for name, column in self.declared.items()})

    def _same_columns(self, others: Particles, values: dict[str, FloatArray]) -> Particles:
        others.declared, others._further = dict(self.declared), values
        return others

    @classmethod
    def together(cls, parts: Sequence[Particles]) -> Particles:
        """All particles of several groups without declared columns, one group after the other."""
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in OWN))

    # ---- the same particles --------------------------------------------------------------------------------------

    def sort(self, grid: Grid, spare: FloatArray, order: NDArray[np.int32], start: NDArray[np.int32]) -> None:
        """Brings the particles into the order of their cells, in place; columns of the place are to be read again.

        spare (N, d): work space. On return order (N,) holds where each particle was before, start (cells + 1,) the
        number of the first particle of each cell. FloatingPointError where a particle is outside the grid.
        """
        _core.sort_particles(grid.core, self.position, self.velocity, self.volume, spare, order, start)
        for name, column in self.declared.items():
            if column.kind != "place":
                self._further[name] = self._further[name][order]

    def join(
        self,
        host: NDArray[np.intp],
        position: FloatArray,
        velocity: FloatArray,
        volume: FloatArray,
        **given: FloatArray,
    ) -> None:
        """Water joins the particles numbered `host` (M,), none of them twice: volumes add up.

        Position, velocity and each column of the water become means by volume. given: (M, *shape), as in `append`.
        """
        share = volume / (self.volume[host] + volume)
        pairs = [(self.position, position), (self.velocity, velocity)]
        for name in self.of_kind("water"):
            pairs.append((self[name], given.get(name, self.declared[name].values(len(host)))))
        for values, joins in pairs:
            values[host] += share.reshape(-1, *(1,) * (values.ndim - 1)) * (joins - values[host])
        self.volume[host] += volume

    # ---- checkpoints ---------------------------------------------------------------------------------------------

    def state(self) -> State:
        """All that a checkpoint needs: every column but those of the place."""
        saved = {name: self._further[name] for name, column in self.declared.items() if column.kind != "place"}
        return {**{name: getattr(self, name) for name in OWN}, **saved}

    def restore(self, state: Mapping[str, FloatArray]) -> None:
        """Takes the columns of a state(), whatever the number of its particles; those of the place get `new`."""
        for name in OWN:
            setattr(self, name, np.array(state[name], dtype=float, order="C"))
        for name, column in self.declared.items():
            if column.kind == "place":
                self._further[name] = column.values(len(self))
            else:
                self._further[name] = np.array(state[name], dtype=column.dtype, order="C")

    # ---- what they hold together ---------------------------------------------------------------------------------

    @property
    def total_volume(self) -> float:
        """Volume of all the water [m^d]."""
        return _core.total(self.volume)

    def depths(self, grid: Grid) -> FloatArray:
        """Water over the plan area of each column of cells, grid.shape[:-1] [m]."""
        plan = grid.spacing[:-1]
        bins = [np.arange(n + 1) * h for n, h in zip(grid.shape, plan, strict=False)]
        held = np.histogramdd(self.position[:, :-1], bins, weights=self.volume)[0]
        return held / math.prod(plan)
