"""[[force]]: force and moment of the water on a solid, a side of the tank, or the grains of a porous body.

On a surface the water presses; on grains it acts by buoyancy, drag and inertia (docs/theory.md, section 15).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from houle.fields import Field, Stations
from houle.flow.observer import Instrument, Now, Observer, Sample, Site
from houle.flow.state import Flow
from houle.grid import FloatArray, axes
from houle.medium.integrals import Measure, over_cells
from houle.medium.patches import SIDES, Patches, Surfaces
from houle.medium.rough_walls import number_of_side
from houle.medium.sections import partition
from houle.observe.levels import wet_share
from houle.observe.points import cell_below, still_gravity

Load = tuple[FloatArray, FloatArray]  # force / rho, moment / rho


@dataclass(frozen=True)
class Force(Instrument):
    """The structure that the water acts on: the porous body or solid of this name, or a side of the tank.

    about  point of the moments [m]; the foot of the wall, or the middle of the base of the body, when left out
    """

    name: str
    body: str | None = None
    side: str | None = None
    about: tuple[float, ...] | None = None

    def centre(self, site: Site) -> tuple[float, ...]:
        """The point of the moments (d,) [m]."""
        if self.about is not None:
            return self.about
        low, high = np.zeros(site.grid.dimension), np.array(site.grid.size)
        if self.side is not None:
            axis, end = SIDES[self.side]
            low[axis] = high[axis] = high[axis] * end
        elif self.body is not None:
            lower, upper = {**site.solid, **site.porous}[self.body].bounds
            low, high = np.maximum(lower, low), np.minimum(upper, high)
        return (*map(float, 0.5 * (low + high)[:-1]), float(low[-1]))

    def place(self, site: Site, flow: Flow) -> SurfaceLoad | BodyLoad:
        """The structure in a flow: a surface or a body, which gives its load."""
        about, body, medium = np.array(self.centre(site)), self.body or "", flow.medium
        surfaces = Surfaces(flow.grid, medium.open_cells, medium.bodies, medium.solids)
        if self.side is not None:
            return SurfaceLoad(flow, surfaces.of_side(self.side), about, number_of_side(self.side))
        if body in site.porous:
            return BodyLoad(flow, list(site.porous).index(body), about)
        number = list(site.solid).index(body)
        return SurfaceLoad(flow, surfaces.of_solid(medium.solids[number]), about, number)


class Forces(Observer[Force]):
    """Force and moment on each structure, and the part of the force that is drag."""

    table = "force"
    instrument = Force
    fields = (
        Field(
            "force",
            "F",
            "N",
            "structure",
            "force of the water on the structure: its pressure and friction, and inside a porous body buoyancy, "
            "drag and inertia",
            unit_2d="N m-1",
            vector=True,
            instant="pressure",
        ),
        Field(
            "drag_force",
            "F_d",
            "N",
            "structure",
            "part of the force on the structure that is drag on the grains of a porous body",
            unit_2d="N m-1",
            vector=True,
            instant="pressure",
        ),
        Field(
            "friction_force",
            "F_f",
            "N",
            "structure",
            "part of the force on the structure that is friction of the water along a surface that rubs",
            unit_2d="N m-1",
            vector=True,
            instant="velocity",
        ),
        Field(
            "moment",
            "M",
            "N m",
            "structure",
            "moment of the force on the structure about the point given, in 2D about the y axis, positive when it tips "
            "the structure towards larger x",
            unit_2d="N",
            instant="pressure",
        ),
    )

    def __init__(self, instruments: Sequence[Force], site: Site, flow: Flow) -> None:
        self.density = site.density
        self.loads = [one.place(site, flow) for one in instruments]

    @classmethod
    def stations(cls, instruments: Sequence[Force], site: Site) -> Stations:
        about = np.array([one.centre(site) for one in instruments])
        places = {
            f"about_{axis}": (
                f"position along {axis} of the point of the moment",
                about[:, a].tolist(),
            )
            for a, axis in enumerate(axes(site.grid.dimension))
        }
        return Stations([one.name for one in instruments], places, cls.fields)

    def sample(self, now: Now) -> Sample:
        found = [load.load(now.flow) for load in self.loads]
        rubbed = [load.friction(now.flow) for load in self.loads]
        rho = self.density
        return {
            "force": rho * (np.array([force for (force, _), _ in found]) + np.array([force for force, _ in rubbed])),
            "drag_force": rho * np.array([drag for _, drag in found]),
            "friction_force": rho * np.array([force for force, _ in rubbed]),
            "moment": rho * (np.array([one for (_, one), _ in found]) + np.array([one for _, one in rubbed])),
        }


class SurfaceLoad:
    """Force and moment of the water's pressure on patches, per density: sum of the integrals of p n and r x p n.

    Where the surface rubs, the friction of the water comes to it. wall: number of the surface in `RoughWalls.wall`.
    """

    def __init__(self, flow: Flow, patches: Patches, about: FloatArray, wall: int) -> None:
        grid, g = flow.grid, still_gravity(flow)
        self.planes = np.empty(0, np.intp) if flow.walls is None else np.flatnonzero(flow.walls.wall == wall)
        self.planes_arm = np.empty((0, grid.dimension)) if flow.walls is None else flow.walls.foot[self.planes] - about
        self.cell, self.area = patches.cell, patches.area
        self.below, self.above = cell_below(self.cell, grid), cell_below(self.cell, grid, -1)
        centres = grid.points().reshape(-1, grid.dimension)
        self.a, self.step = patches.a - about, patches.b - patches.a
        self.rest_a, self.rest_b = ((e - centres[self.cell]) @ g for e in (patches.a, patches.b))
        self.rest_below = (centres[self.cell] - centres[self.below]) @ g

    def friction(self, flow: Flow) -> Load:
        """Force and moment of the friction in the last step."""
        force = flow.impulse[self.planes] / flow.kick
        return force.sum(axis=0), moment(self.planes_arm, force)

    def load(self, flow: Flow) -> tuple[Load, FloatArray]:
        """Force and moment of the pressure, and the part of the force that is drag: none on a surface."""
        p = flow.pressure.ravel()
        here, below = p[self.cell], p[self.below]
        wet = here != 0.0
        here = np.where(wet, here, np.where(below != 0.0, below + self.rest_below, -np.inf))
        first, last = here + self.rest_a, here + self.rest_b
        at_surface = ~wet | (p[self.above] == 0.0)
        start, end, first, last = positive_part(first, last, at_surface)
        mean, size = 0.5 * (first + last), end - start
        middle = self.a + self.step * (0.5 * (start + end))[:, None]
        arm = middle * (mean * size)[:, None] + self.step * (size**2 * (last - first) / 12.0)[:, None]
        force = ((mean * size)[:, None] * self.area).sum(axis=0)
        return (force, moment(arm, self.area)), np.zeros(self.area.shape[1])


class BodyLoad:
    """Force and moment on the grains of a porous body, -(1 - n) g + (a + b|u_d|) u_d + (C_r/n - 1) D u_d/Dt.

    That is per unit of volume, over the density of water; it is summed over the cells, each with the volume of the body
    in it that is wet. u_d is the mean of the velocities before and after the forces of the step and D u_d/Dt their
    difference over its length: both are of the instant of the pressure. Where the added mass stands before du/dt alone
    that difference is the acceleration less its share 1 - 1/C_r of (u . grad) u_d, which the water has besides: so much
    less is left for the grains.
    """

    def __init__(self, flow: Flow, number: int, about: FloatArray) -> None:
        grid, medium = flow.grid, flow.medium
        self.body = medium.bodies[number]
        parts = partition(grid, medium.bodies, medium.solids)
        share = Measure.of(grid, [(s, areas[number]) for s, _, areas in parts]).mean([over_cells] * grid.dimension)
        reach = [
            np.flatnonzero(share.max(axis=tuple(b for b in range(share.ndim) if b != a))) for a in range(share.ndim)
        ]
        self.cells = tuple(slice(int(r[0]), int(r[-1]) + 1) if len(r) else slice(0, 0) for r in reach)
        self.spacing = grid.spacing
        self.volume = share[self.cells] * grid.cell_volume
        self.arm = (grid.points()[self.cells] - about).reshape(-1, grid.dimension)

    def friction(self, flow: Flow) -> Load:
        """No force and no moment: the water rubs along no surface inside, and the drag of the grains is in `load`."""
        d = flow.grid.dimension
        return np.zeros(d), np.zeros(3 if d == 3 else ())

    def load(self, flow: Flow) -> tuple[Load, FloatArray]:
        """Force and moment, and the part of the force that is drag."""
        body, d = self.body, flow.grid.dimension
        before, after = (self._at_centres(u) for u in (flow.old_velocity, flow.velocity))
        u = 0.5 * (before + after)
        drag = (body.a + body.b * np.sqrt((u * u).sum(axis=0))) * u
        total = drag + (body.inertia / body.porosity - 1.0) / flow.kick * (after - before)
        if body.convective != body.inertia:
            total -= (1.0 - body.convective / body.inertia) / body.porosity * self._convection(u)
        total -= (1.0 - body.porosity) * np.reshape(flow.gravity, (d,) + (1,) * d)
        wet = (wet_share(flow, self.cells[:-1])[..., self.cells[-1]] * self.volume).ravel()
        force = (total.reshape(d, -1) * wet).T
        return (force.sum(axis=0), moment(self.arm, force)), (drag.reshape(d, -1) * wet).sum(axis=1)

    def _convection(self, u: FloatArray) -> FloatArray:
        """(u . grad) u of a field (d, ...) of the cells."""
        found = np.zeros_like(u)
        for b, h in enumerate(self.spacing):
            if u.shape[1 + b] > 1:
                found += u[b] * np.gradient(u, h, axis=1 + b)
        return found

    def _at_centres(self, velocity: list[FloatArray]) -> FloatArray:
        """Velocity (d, ...) at the centres of the cells, the mean of the two faces of each axis."""
        found = []
        for a, u in enumerate(velocity):
            s = self.cells[a]
            above = tuple(slice(s.start + 1, s.stop + 1) if b == a else c for b, c in enumerate(self.cells))
            found.append(0.5 * (u[self.cells] + u[above]))
        return np.stack(found)


def positive_part(first: FloatArray, last: FloatArray, cut_off: np.ndarray) -> tuple[FloatArray, ...]:
    """The part of each patch on which a pressure, linear from `first` to `last`, is above 0.

    Returns where that part starts and ends, as shares 0..1 of the length of the patch, and the pressure at both.
    Patches that are not `cut_off` keep their suction: deep in the water it is real.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = np.where(first != last, first / (first - last), 0.0)
    start = np.where(cut_off & (first < 0), np.where(last > 0, zero, 0.0), 0.0)
    end = np.where(cut_off & (last < 0), np.where(first > 0, zero, start), 1.0)
    none = cut_off & (first <= 0) & (last <= 0)
    start, end = np.where(none, 0.0, start), np.where(none, 0.0, end)
    return start, end, np.where(cut_off, np.maximum(first, 0.0), first), np.where(cut_off, np.maximum(last, 0.0), last)


def moment(arm: FloatArray, force: FloatArray) -> FloatArray:
    """Sum of r x f: (3,) in 3D; in 2D the component about y, (): positive when it tips things towards larger x."""
    if arm.shape[1] == 3:
        return np.cross(arm, force).sum(axis=0)
    return np.asarray(np.sum(arm[:, 1] * force[:, 0] - arm[:, 0] * force[:, 1]))
