"""Stability of a bank along its face: excess pore pressure, and the factor of safety of an infinite slope.

A layer of grains of thickness D, along the normal of a face that is inclined by beta, may slide on the plane under it.
Its weight, grains and the water in their pores, is gamma D on each m2 of the plane. The water presses with p_f on the
face and with p_i in the pores on the plane; along the layer its pressure grows downwards by dp/ds. Forces across and
along the plane give its effective stress and its shear stress,

    sigma' = gamma D cos(beta) + p_f - p_i          tau = gamma D sin(beta) - D dp/ds

and the factor of safety F = sigma' tan(phi) / tau (Coulomb, no cohesion). With heads, p = rho g (h - z), this is the
infinite slope of the textbooks (Taylor 1948, Fundamentals of Soil Mechanics; Lambe & Whitman 1969, Soil Mechanics;
RECALLED): F = tan(phi) / tan(beta) in still water and in a dry bank, (gamma - gamma_w) / gamma times that with flow
along the face, and F = 0 where water that comes out through the face lifts the grains, at the gradient
(s - 1) (1 - n) cos(beta).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError
from houle.waves.dispersion import GRAVITY

Real = NDArray[np.float64]


def excess_pore_pressure(
    inside: ArrayLike, level: ArrayLike, height: ArrayLike, *, density: float = 1000.0, gravity: float = GRAVITY
) -> Real:
    """Pore pressure [Pa] less that of water at rest with the level outside [m], at points of this height [m].

    The arrays broadcast against each other. Points above the level have no pressure of water at rest.
    """
    at_rest = density * gravity * np.maximum(np.asarray(level, dtype=float) - np.asarray(height, dtype=float), 0.0)
    return np.asarray(np.asarray(inside, dtype=float) - at_rest)


@dataclass(frozen=True)
class Layer:
    """A layer of grains along a face.

    thickness  along the normal of the face [m]        slope  of the face [rad], (N,) or one number
    porosity   [-]                                     friction_angle  [rad]
    grain_density, density  of grains and water [kg/m3]
    """

    thickness: float
    slope: float | Real
    porosity: float
    friction_angle: float
    grain_density: float = 2650.0
    density: float = 1000.0
    gravity: float = GRAVITY

    def __post_init__(self) -> None:
        slope = np.asarray(self.slope)
        if not (self.thickness > 0 and 0 < self.porosity < 1 and self.grain_density > self.density > 0):
            raise AnalysisError(
                f"thickness = {self.thickness:g} m, porosity = {self.porosity:g}, grain_density = "
                f"{self.grain_density:g} kg/m3: thickness > 0, 0 < porosity < 1, and grains heavier than water"
            )
        if not (0 < self.friction_angle < np.pi / 2 and bool(np.all((slope >= 0) & (slope < np.pi / 2)))):
            raise AnalysisError(
                f"friction_angle = {self.friction_angle:g} and slope must lie between 0 and pi/2 rad; 35 degrees are "
                "0.611"
            )

    @property
    def still(self) -> float | Real:
        """Factor of safety in still water, and without any: tan(phi) / tan(beta); infinite of a level bed."""
        with np.errstate(divide="ignore"):
            return np.tan(self.friction_angle) / np.tan(np.asarray(self.slope))

    def weight(self, wet: ArrayLike) -> Real:
        """Weight [N/m3] with this share of the pores full of water."""
        n = self.porosity
        return np.asarray(self.gravity * ((1 - n) * self.grain_density + n * self.density * np.asarray(wet)))

    def wet(self, face: ArrayLike, inside: ArrayLike) -> Real:
        """Share of the pores that is full: all under water, else up to where the pressure on the plane says."""
        face, inside = np.asarray(face, dtype=float), np.asarray(inside, dtype=float)
        full = self.density * self.gravity * self.thickness * np.cos(self.slope)  # pressure of water along the face
        return np.asarray(np.where(face > 0, 1.0, np.clip(inside / full, 0.0, 1.0)))

    def safety(self, face: ArrayLike, inside: ArrayLike, downwards: ArrayLike) -> Real:
        """Factor of safety for pressures [Pa] on the face and on the plane, and dp/ds [Pa/m] down along the layer.

        0 where the grains are lifted, infinite where nothing drives the layer down.
        """
        face, inside = np.asarray(face, dtype=float), np.asarray(inside, dtype=float)
        weight = self.thickness * self.weight(self.wet(face, inside))
        effective = np.maximum(weight * np.cos(self.slope) + face - inside, 0.0)
        driving = weight * np.sin(self.slope) - self.thickness * np.asarray(downwards, dtype=float)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = effective * np.tan(self.friction_angle) / driving
        return np.asarray(np.where(driving > 0, found, np.inf))


def along_layer(place: ArrayLike, face: ArrayLike, inside: ArrayLike) -> Real:
    """Mean of dp/ds [Pa/m] over the thickness of a layer, from pressures (T, N) at places s (N,) [m] down its face.

    Central differences; one-sided at the ends. Raises AnalysisError for less than two places, or places that do not
    follow each other.
    """
    s = np.asarray(place, dtype=float)
    if s.size < 2 or not (np.all(np.diff(s) > 0) or np.all(np.diff(s) < 0)):
        raise AnalysisError("pressures at two places or more, one after the other along the face, are needed")
    mean = (np.asarray(face, dtype=float) + np.asarray(inside, dtype=float)) / 2
    return np.asarray(np.gradient(mean, s, axis=-1))
