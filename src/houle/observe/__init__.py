"""What is observed while a case runs. Everything is placed once; a sample is a few operations on slices of the grid.

    Observers(case, flow)      .sample() -> arrays by name; .after_step(dt); .lag(step); .state(), .restore(state)
    stations(case, grid)       names and coordinates of what is observed, by dimension of the results

Levels of the surface and volumes are those of the positions, at the ends of steps. A force is that of the instant of
the pressure. To add an observable: a class like `levels.Gauges`, a line in `Observers`, its fields in fields.py.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from houle.flow.component import Component, State
from houle.flow.state import Flow
from houle.grid import FloatArray, Grid, axes
from houle.medium.shapes import Shape, shape_of
from houle.observe.bodies import BodyLoad
from houle.observe.levels import Gauges, Phreatic, Profile
from houle.observe.points import Sensors, at_points
from houle.observe.runup import RunUp
from houle.observe.sections import Overtopping, Section
from houle.observe.surfaces import SIDES, SurfaceLoad, patches_of_side, patches_of_solid

__all__ = ["Gauges", "Observers", "Profile", "at_points", "levels_at", "stations"]

Stations = dict[str, tuple[list[str], dict[str, list[float]]]]  # dimension: names, coordinates


def levels_at(flow: Flow, places: list[tuple[float, ...]]) -> FloatArray:
    """Level of the free surface [m] above z = 0 at places in plan, linear between columns; NaN when dry."""
    return Gauges(flow, places).levels(flow)


class Observers(Component):
    """Everything a case observes, placed in its flow. `case` has .gauge, .sensor, .runup, ... as in tables/."""

    def __init__(self, case: Any, flow: Flow) -> None:
        self.case, self.flow, grid = case, flow, flow.grid
        d = grid.dimension
        self.gauges = Gauges(flow, [_plan(g, d) for g in case.gauge])
        self.sensors = Sensors(flow, np.array([s.at for s in case.sensor], float))
        self.runups = [RunUp(flow, r.x, r.threshold or 0.5 * flow.grid.spacing[0]) for r in case.runup]
        self.overtoppings = [Overtopping(flow, o.x, o.level, o.to == "right") for o in case.overtopping]
        self.sections = [Section(flow, f.x, *(f.between or (-np.inf, np.inf))) for f in case.flux]
        self.phreatics = [Phreatic(flow, _body_shape(case, p.body), _line(case, p, grid)) for p in case.phreatic]
        self.loads = [self._load(entry) for entry in case.force]

    def _load(self, entry: Any) -> SurfaceLoad | BodyLoad:
        case, flow = self.case, self.flow
        about = np.array(_about(case, entry, flow.grid))
        if entry.side is not None:
            return SurfaceLoad(flow, patches_of_side(flow, entry.side), about)
        names = [b.name for b in case.porous]
        if entry.body in names:
            return BodyLoad(flow, names.index(entry.body), about)
        solid = flow.medium.solids[[b.name for b in case.solid].index(entry.body)]
        return SurfaceLoad(flow, patches_of_solid(flow, solid), about)

    def sample(self) -> dict[str, FloatArray]:
        """What is observed now; names and units in fields.py. Without gauges or sensors theirs are empty."""
        flow, rho = self.flow, self.case.fluid.density
        row: dict[str, FloatArray] = {
            "eta": self.gauges.levels(flow),
            "pressure": rho * self.sensors.pressure(flow),
            "velocity": self.sensors.velocity(flow),
        }
        if self.runups:
            tips = np.array([r.tip(flow) for r in self.runups])
            row |= {"runup_x": tips[:, 0], "runup_level": tips[:, 1]}
        if self.overtoppings:
            row["overtopping_volume"] = np.array([o.volume for o in self.overtoppings])
            row["overtopping_discharge"] = np.array([o.discharge for o in self.overtoppings])
        if self.sections:
            row["discharge"] = np.array([s.discharge(flow) for s in self.sections])
        if self.phreatics:
            row["phreatic_level"] = np.concatenate([p.levels(flow) for p in self.phreatics])
        if flow.boundaries.walls is not None:
            row["paddle_position"] = flow.boundaries.walls[:, 0].copy()
        return row | (self._forces(rho) if self.loads else {})

    def _forces(self, rho: float) -> dict[str, FloatArray]:
        forces: list[FloatArray] = []
        moments: list[FloatArray] = []
        drags: list[FloatArray] = []
        for load in self.loads:
            if isinstance(load, BodyLoad):
                (force, moment), drag = load.load(self.flow)
            else:
                (force, moment), drag = load.load(self.flow), np.zeros(self.flow.grid.dimension)
            for rows, value in ((forces, force), (moments, moment), (drags, drag)):
                rows.append(value)
        return {
            "force": rho * np.array(forces), "drag_force": rho * np.array(drags), "moment": rho * np.array(moments),
        }  # fmt: skip

    @staticmethod
    def lag(velocity: float, pressure: float) -> dict[str, float]:
        """By how much of a step each name is older than the positions, given that of velocity and pressure."""
        loads = dict.fromkeys(("pressure", "force", "drag_force", "moment"), pressure)
        return {**loads, "velocity": velocity, "discharge": velocity, "overtopping_discharge": 0.5}

    def after_step(self, dt: float) -> None:
        """Books what has passed in a step of dt [s]."""
        for o in self.overtoppings:
            o.after_step(dt)

    def state(self) -> State:
        return {f"overtopping.{i}": o.state for i, o in enumerate(self.overtoppings)}

    def restore(self, state: Mapping[str, FloatArray]) -> None:
        for i, o in enumerate(self.overtoppings):
            o.state = state[f"overtopping.{i}"]


def stations(case: Any, grid: Grid) -> Stations:
    """Names and coordinates [m] of what is observed, beside gauges and sensors, by dimension of the results."""
    d, end = grid.dimension, grid.size[-1]
    letters = axes(d)
    between = [f.between or (0.0, end) for f in case.flux]
    lines = [_line(case, p, grid) for p in case.phreatic]
    about = np.array([_about(case, f, grid) for f in case.force]).reshape(-1, d)
    found: Stations = {
        "runup": (_names(case.runup), {"from": [r.x[0] for r in case.runup], "to": [r.x[1] for r in case.runup]}),
        "overtopping": (
            _names(case.overtopping),
            {"x": [o.x for o in case.overtopping], "level": [o.level or 0.0 for o in case.overtopping]},
        ),
        "flux": (
            _names(case.flux),
            {"x": [f.x for f in case.flux], "from": [b[0] for b in between], "to": [b[1] for b in between]},
        ),
        "phreatic": (
            [p.name for p, line in zip(case.phreatic, lines, strict=True) for _ in line],
            {axis: [float(at[a]) for line in lines for at in line] for a, axis in enumerate(letters[:-1])},
        ),
        "paddle": _paddles(case),
        "structure": (_names(case.force), {f"about_{axis}": about[:, a].tolist() for a, axis in enumerate(letters)}),
    }
    return {kind: entry for kind, entry in found.items() if entry[0]}


def _paddles(case: Any) -> tuple[list[str], dict[str, list[float]]]:
    piston = case.waves.piston if case.waves is not None else None
    places = ([("piston", piston.x)] if piston is not None else []) + [(a.name, a.x) for a in case.absorber]
    return [name for name, _ in places], {"rest": [x for _, x in places]}


def _names(rows: Any) -> list[str]:
    return [row.name for row in rows]


def _plan(entry: Any, dimension: int) -> tuple[float, ...]:
    return (entry.x,) if dimension == 2 else (entry.x, entry.y)


def _body_shape(case: Any, name: str) -> Shape:
    return shape_of(next(b for b in (*case.porous, *case.solid) if b.name == name), case.dimension)


def _line(case: Any, entry: Any, grid: Grid) -> FloatArray:
    """Places (N, d - 1) in plan of a phreatic line: the x it names, or every column of the grid in the body."""
    x = np.array(entry.x or _columns(case, entry.body, grid))
    return x[:, None] if grid.dimension == 2 else np.stack([x, np.full(len(x), entry.y)], axis=1)


def _columns(case: Any, name: str, grid: Grid) -> FloatArray:
    lower, upper = _body_shape(case, name).bounds
    x = grid.axis_points(0)
    inside = x[(x >= lower[0]) & (x <= upper[0])]
    return inside if len(inside) else np.array([0.5 * (lower[0] + upper[0])])


def _about(case: Any, entry: Any, grid: Grid) -> tuple[float, ...]:
    """The point of the moments: as given, or the foot of the wall, or the middle of the body's base."""
    if entry.about is not None:
        return entry.about
    low, high = np.zeros(grid.dimension), np.array(grid.size)
    if entry.side is not None:
        axis, end = SIDES[entry.side]
        low[axis] = high[axis] = high[axis] * end
    else:
        lower, upper = _body_shape(case, entry.body).bounds
        low, high = np.maximum(lower, low), np.minimum(upper, high)
    return (*map(float, 0.5 * (low + high)[:-1]), float(low[-1]))
