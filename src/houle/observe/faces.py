"""Places on the face of a porous body, and the pressure of the water on it.

A face is the top of a body over x. The pressure on it is that of the water outside: of the head at a point a little off
the face, where no pores are between it and the grid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from houle.flow.observer import Site
from houle.flow.state import Flow
from houle.grid import FloatArray
from houle.medium.sections import layers, section
from houle.observe.levels import around, crossings, layer_at, mean_of_known
from houle.observe.points import velocity_at
from houle.observe.sensor import Sensor, Sensors

ABOVE = 1.5  # spacings above the face at which the water is observed, by default
STEEPEST = np.radians(80.0)  # slope from which on a face has no levels over x


@dataclass(frozen=True)
class Face:
    """Points on the face of a body (N, d) [m], its unit normals out of the body (N, d), and its slope (N,) [rad]."""

    points: FloatArray
    normals: FloatArray
    slope: FloatArray

    def off(self, way: float) -> FloatArray:
        """The points (N, d) at a way [m] along the normals: outside the body, or inside if it is negative."""
        return self.points + way * self.normals

    @property
    def down(self) -> FloatArray:
        """Unit vectors (N, d) along the face and down it; of a level face to the right."""
        way = np.zeros_like(self.normals)
        right = np.where(self.normals[:, 0] < 0.0, -1.0, 1.0)
        way[:, 0], way[:, -1] = right * self.normals[:, -1], -right * self.normals[:, 0]
        return way

    def at(self, chosen: FloatArray) -> Face:
        """The face at some of its places, by a mask or numbers."""
        return Face(self.points[chosen], self.normals[chosen], self.slope[chosen])


def face_of(site: Site, body: str, x: FloatArray, y: float | None, step: float) -> Face:
    """The face of a body at x (N,) [m], in 3D in the plane y; NaN beside it. The slope is that over 2 step [m]."""
    level = [top_of(site, body, x + shift, y) for shift in (0.0, -step, step)]
    steepness = (level[2] - level[1]) / (2 * step)
    size = np.hypot(steepness, 1.0)
    flat = [] if y is None else [np.full(len(x), y)]
    still = [np.zeros(len(x))] * len(flat)
    points, normals = [x, *flat, level[0]], [-steepness / size, *still, 1.0 / size]
    return Face(np.stack(points, axis=1), np.stack(normals, axis=1), np.arctan(np.abs(steepness)))


def top_of(site: Site, body: str, x: FloatArray, y: float | None) -> FloatArray:
    """Top (N,) [m] of a body at x (N,) [m]; NaN beside it."""
    shape = site.porous[body]
    spans = layers(site.grid, [shape])
    return crossings(section(site.grid, [shape], spans[layer_at(spans, y or 0.0)]), x)[1]


class WaterOn:
    """The water on faces: kinematic pressure (N,) [m2/s2] and speed along them (N,) [m/s].

    The pressure follows from the head of the water at a point off the face; where that is dry, from the level of the
    water over the face. Where there is none it is 0. The speed is 0 where the outer point is dry.
    """

    def __init__(self, points: FloatArray, normals: FloatArray, over: FloatArray, site: Site, flow: Flow) -> None:
        self.points, self.normals, self.over = points, normals, over
        self.water = sensors(over, site, flow)
        self.column, self.weight = around(points[:, :-1], flow.grid)

    def sample(self, flow: Flow) -> tuple[FloatArray, FloatArray]:
        """Pressure and speed in the present flow."""
        g, height = -flow.gravity[-1], self.points[:, -1]
        outer, dz = self.water.pressure(flow), self.over[:, -1] - height
        level = mean_of_known(flow.eta.ravel()[self.column], self.weight)
        below = np.nan_to_num(level - height, nan=0.0)
        face = np.where(outer > 0.0, outer + g * dz, np.maximum(g * below, 0.0))
        velocity = velocity_at(flow, self.over)
        parallel = velocity - (velocity * self.normals).sum(axis=1, keepdims=True) * self.normals
        return face, np.where(outer > 0.0, np.linalg.norm(parallel, axis=1), 0.0)


def sensors(at: FloatArray, site: Site, flow: Flow) -> Sensors:
    """Sensors at points (N, d) [m]."""
    return Sensors([Sensor("", tuple(float(v) for v in point)) for point in at], site, flow)
