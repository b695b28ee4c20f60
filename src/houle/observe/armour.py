"""[[armour]]: gradients of the head in the outer stones of an armour layer, and the water over them and in them.

Along the top of a porous body stand places a stone apart. At each the outer stone reaches from the face to one nominal
diameter inside along the normal. The gradient of the head across it pushes it out of the slope, that along it down the
slope; `houle.results.armour` makes the answers. No stone moves in a run: they are indicators.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from houle.fields import Field, Stations
from houle.flow.observer import Instrument, Now, Observer, Remark, Sample, Site, along, outside
from houle.flow.state import Flow
from houle.grid import axes
from houle.observe.faces import ABOVE, STEEPEST, Face, WaterOn, face_of, sensors, top_of
from houle.observe.points import velocity_at

NOMINAL = 0.84  # D_n50 over d50 of rock (CIRIA/CUR/CETMEF 2007, The Rock Manual)
FEWEST = 2.0  # spacings of a stone below which the gradient across it is not resolved
MOST = 200  # places of one table: of smaller stones only some are looked at
LINES = 2000  # upright lines on which the length of the face is measured


@dataclass(frozen=True)
class Armour(Instrument):
    """The face of a porous body that armours a slope, stone by stone.

    x      stretch of its top [m]; all of it when left out, as far as a whole stone lies in the body
    stone  nominal diameter D_n50 of the stones [m]; 0.84 times the grain diameter of the body when left out
    stone_density  [kg/m3]
    y      in 3D, the upright plane in which the places lie [m]
    """

    name: str
    body: str
    x: tuple[float, float] | None = None
    stone: float | None = None
    stone_density: float = 2650.0
    y: float | None = None

    def size(self, site: Site) -> float:
        """Nominal diameter of the stones [m]; 0 where nothing gives it."""
        return self.stone or NOMINAL * site.grains.get(self.body, 0.0)

    def face(self, site: Site) -> Face:
        """The places of the outer stones, from left to right; none where there is no face."""
        every, size = self._every(site), self.size(site)
        stands = every.slope <= STEEPEST  # false of NaN, beside the body
        inside = np.nan_to_num(every.off(-size))
        stands &= site.porous[self.body].distance(inside) <= 1e-9
        for solid in site.solid.values():
            stands &= (solid.distance(inside) > 0) & (solid.distance(np.nan_to_num(every.off(1e-3 * size))) > 0)
        return every.at(stands)

    def _every(self, site: Site) -> Face:
        """Places a stone apart along the whole stretch, or as many as are looked at."""
        low, high = self._stretch(site)
        x = np.linspace(low, high, LINES + 1)
        rise = np.nan_to_num(np.diff(top_of(site, self.body, x, self.y)))
        way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), rise))])
        count = int(min(max(1.0, round(way[-1] / self.size(site))), MOST))
        at = np.interp((np.arange(count) + 0.5) * way[-1] / count, way, x)
        return face_of(site, self.body, at, self.y, 0.25 * (high - low) / max(count, 4))

    def _stretch(self, site: Site) -> tuple[float, float]:
        if self.x is not None:
            return self.x
        lower, upper = site.porous[self.body].bounds
        return max(float(lower[0]), 0.0), min(float(upper[0]), site.size[0])

    def check(self, site: Site) -> Iterator[Remark]:
        """There is a face with stones in the body, they sink, and the gradient across them is resolved."""
        if self.y is not None:
            yield from outside(site, "y", self.y, 1)
        if (size := self.size(site)) == 0.0:
            yield Remark("error", "stone", f"is missing, and porous.{self.body} has no grain_diameter: give D_n50 [m]")
            return
        if self.stone_density <= site.density:
            text = f"= {self.stone_density:g} kg/m3 floats in water of {site.density:g} kg/m3: 2650 is usual"
            yield Remark("error", "stone_density", text)
        low, high = (float(corner[0]) for corner in site.porous[self.body].bounds)
        if self.x is not None and not low - 1e-9 <= self.x[0] < self.x[1] <= high + 1e-9:
            text = f"= {list(self.x)} reaches beside porous.{self.body}, {low:.4g} <= x <= {high:.4g} m"
            yield Remark("error", "x", text)
        elif len(self.face(site).slope) == 0:
            text = f": no stone of {size:.3g} m lies under a face of at most 80 degrees in porous.{self.body}"
            yield Remark("error", "", f"{text}: a smaller stone, or another x")
        if size < FEWEST * (h := max(site.grid.spacing)) * (1 - 1e-9):
            text = (
                f": a stone of {size:.3g} m is {size / h:.2g} spacings: the gradient across it needs {FEWEST:g}, "
                f"domain.spacing = {size / FEWEST:.2g}"
            )
            yield Remark("warning", "stone" if self.stone else "", text)


class Armours(Observer[Armour]):
    """Gradients and speeds at the outer stones of all armours, one after the other.

    The gradient of the head h = p/(rho g) + z across a stone is that from the pore water at its inner end to the water
    on the face, along it that between two points half a stone above and below its middle. Where the inner end is dry,
    or one of the two points, it is 0. A stone whose face is dry is counted when the head inside lies above the face.
    """

    table = "armour"
    instrument = Armour
    fields = (
        Field(
            "armour_gradient",
            "i_n",
            "1",
            "armour",
            "gradient of the head across the outer stone, positive out of the slope",
            instant="pressure",
        ),
        Field(
            "armour_gradient_down",
            "i_s",
            "1",
            "armour",
            "gradient of the head along the outer stone, positive down the slope",
            instant="pressure",
        ),
        Field(
            "armour_speed",
            "u_a",
            "m s-1",
            "armour",
            "speed of the water along the face, 1.5 spacings above it, 0 where that is dry",
            instant="velocity",
        ),
        Field(
            "armour_velocity",
            "u_s",
            "m s-1",
            "armour",
            "Darcy velocity in the middle of the outer stone, 0 where that is dry",
            vector=True,
            instant="velocity",
        ),
    )

    def __init__(self, instruments: Sequence[Armour], site: Site, flow: Flow) -> None:
        faces = [one.face(site) for one in instruments]
        self.size = np.concatenate(
            [np.full(len(face.slope), one.size(site)) for one, face in zip(instruments, faces, strict=True)]
        )
        points, normals, down = (
            np.concatenate([getattr(face, key) for face in faces]) for key in ("points", "normals", "down")
        )
        size, self.upright, self.falls = self.size[:, None], normals[:, -1], -down[:, -1]
        self.middle = points - 0.5 * size * normals
        over = points + ABOVE * max(site.grid.spacing) * normals
        self.water = WaterOn(points, normals, over, site, flow)
        places = (points - size * normals, self.middle - 0.5 * size * down, self.middle + 0.5 * size * down)
        self.inner, self.above, self.below = (sensors(at, site, flow) for at in places)

    @classmethod
    def stations(cls, instruments: Sequence[Armour], site: Site) -> Stations:
        places = [one.face(site).points for one in instruments]
        names = [one.name for one, at in zip(instruments, places, strict=True) for _ in at]
        return Stations(names, along("outer stone", np.concatenate(places), axes(site.grid.dimension)), cls.fields)

    def sample(self, now: Now) -> Sample:
        flow, weight = now.flow, -now.flow.gravity[-1] * self.size
        face, speed = self.water.sample(flow)
        inner, above, below = (at.pressure(flow) for at in (self.inner, self.above, self.below))
        out = (inner - face) / weight - self.upright
        out = np.where(inner > 0.0, np.where(face > 0.0, out, np.maximum(out, 0.0)), 0.0)
        wet = (above > 0.0) & (below > 0.0)
        return {
            "armour_gradient": out,
            "armour_gradient_down": np.where(wet, (above - below) / weight + self.falls, 0.0),
            "armour_speed": speed,
            "armour_velocity": np.where(wet[:, None], velocity_at(flow, self.middle), 0.0),
        }
