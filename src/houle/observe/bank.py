"""[[bank]]: heads in and on the face of a porous bank, and the velocity along it, from which its stability follows.

Along a stretch of the face stand pairs of points on its normal: one `depth` inside the bank, on a plane parallel to the
face on which it might slide, and one `above` the face in the water. `houle.results.bank` makes the answers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from houle.fields import Field, Stations
from houle.flow.observer import Instrument, Now, Observer, Remark, Sample, Site, along, outside
from houle.flow.state import Flow
from houle.grid import axes
from houle.observe.faces import ABOVE, STEEPEST, Face, WaterOn, face_of, sensors

FEWEST = 2.0  # spacings of `depth` below which the gradient through the face is not resolved


@dataclass(frozen=True)
class Bank(Instrument):
    """A stretch of the face of a porous body, from x[0] to x[1] [m].

    points          number of places, evenly spaced along x, in the middle of as many parts of the stretch
    depth           of the plane on which the bank might slide, along the normal of its face [m]
    above           height over the face at which pressure and velocity of the water are taken [m]; 1.5 spacings
    friction_angle  of the grains [degrees]; grain_density [kg/m3]: for what is made of the results
    y               in 3D, the upright plane in which the stretch lies [m]
    """

    name: str
    body: str
    x: tuple[float, float]
    depth: float
    friction_angle: float
    grain_density: float = 2650.0
    points: int = 8
    above: float | None = None
    y: float | None = None

    def height(self, site: Site) -> float:
        """Height over the face at which the water is observed [m]."""
        return self.above or ABOVE * max(site.grid.spacing)

    def face(self, site: Site) -> Face:
        """The places on the face; points with no level, NaN, lie beside the body."""
        low, high = sorted(self.x)
        x = low + (np.arange(self.points) + 0.5) * (high - low) / self.points
        return face_of(site, self.body, x, self.y, 1e-3 * (high - low) / self.points)

    def check(self, site: Site) -> Iterator[Remark]:
        """The stretch lies on the body, the plane inside it, and the depth is resolved."""
        for end in self.x:
            yield from outside(site, "x", end, 0)
        if self.y is not None:
            yield from outside(site, "y", self.y, 1)
        face, h = self.face(site), max(site.grid.spacing)
        if np.isnan(face.slope).any():
            low, high = (float(corner[0]) for corner in site.porous[self.body].bounds)
            text = f"= {list(self.x)} reaches beside porous.{self.body}, {low:.4g} <= x <= {high:.4g} m"
            yield Remark("error", "x", text)
            return
        if face.slope.max() > STEEPEST:
            steep = np.degrees(face.slope.max())
            yield Remark("error", "x", f"= {list(self.x)} holds a face of {steep:.3g} degrees: 80 at most")
        elif (steep := float(np.degrees(face.slope.max()))) > self.friction_angle:
            text = (
                f"= {self.friction_angle:g} degrees is less than the {steep:.3g} of the face: "
                "in still water the factor of safety is below 1 and it slides"
            )
            yield Remark("warning", "friction_angle", text)
        yield from self._placed(site, face)
        if self.depth < FEWEST * h * (1 - 1e-9):
            text = (
                f"= {self.depth:g} m is {self.depth / h:.2g} spacings: the gradient through the face needs {FEWEST:g}, "
                f"depth = {FEWEST * h:.3g} or domain.spacing = {self.depth / FEWEST:.3g}"
            )
            yield Remark("warning", "depth", text)

    def _placed(self, site: Site, face: Face) -> Iterator[Remark]:
        """The points inside lie in the body, neither they nor those outside in a solid; the grains sink."""
        inside, over = face.off(-self.depth), face.off(self.height(site))
        if (beside := site.porous[self.body].distance(inside) > 0).any():
            x, z = inside[int(np.argmax(beside)), [0, -1]]
            text = f"= {self.depth:g} m: at x = {x:.3g}, z = {z:.3g} m it is no longer in porous.{self.body}; less"
            yield Remark("error", "depth", f"{text}, or another x")
        for name, solid in site.solid.items():
            if (buried := solid.distance(np.concatenate([inside, over])) < 0).any():
                x, z = np.concatenate([inside, over])[int(np.argmax(buried)), [0, -1]]
                text = (
                    f"= {list(self.x)}: what is observed at x = {x:.3g}, z = {z:.3g} m lies in solid.{name}; another x"
                )
                yield Remark("error", "x", text)
        if self.grain_density <= site.density:
            text = f"= {self.grain_density:g} kg/m3 floats in water of {site.density:g} kg/m3: 2650 is usual"
            yield Remark("error", "grain_density", text)


class Banks(Observer[Bank]):
    """Pressures at the faces of banks and inside them, and speeds along the faces, one bank after the other.

    Those at the face are of `houle.observe.faces.WaterOn`.
    """

    table = "bank"
    instrument = Bank
    fields = (
        Field(
            "bank_pressure_face",
            "p_f",
            "Pa",
            "bank",
            "pressure of the water on the face of the bank, 0 where it is dry",
            instant="pressure",
        ),
        Field(
            "bank_pressure_inside",
            "p_i",
            "Pa",
            "bank",
            "pressure of the water in the pores of the bank, at its depth below the face",
            instant="pressure",
        ),
        Field(
            "bank_speed",
            "u_f",
            "m s-1",
            "bank",
            "speed of the water parallel to the face of the bank, at its height above it, 0 where that is dry",
            instant="velocity",
        ),
    )

    def __init__(self, instruments: Sequence[Bank], site: Site, flow: Flow) -> None:
        faces = [one.face(site) for one in instruments]
        points, normals = (np.concatenate([getattr(face, key) for face in faces]) for key in ("points", "normals"))
        over = [face.off(one.height(site)) for one, face in zip(instruments, faces, strict=True)]
        under = [face.off(-one.depth) for one, face in zip(instruments, faces, strict=True)]
        self.water = WaterOn(points, normals, np.concatenate(over), site, flow)
        self.pores, self.density = sensors(np.concatenate(under), site, flow), site.density

    @classmethod
    def stations(cls, instruments: Sequence[Bank], site: Site) -> Stations:
        places = [one.face(site).points for one in instruments]
        names = [one.name for one, at in zip(instruments, places, strict=True) for _ in at]
        letters = axes(site.grid.dimension)
        return Stations(names, along("face of the bank", np.concatenate(places), letters), cls.fields)

    def sample(self, now: Now) -> Sample:
        face, speed = self.water.sample(now.flow)
        return {
            "bank_pressure_face": self.density * face,
            "bank_pressure_inside": self.density * self.pores.pressure(now.flow),
            "bank_speed": speed,
        }
