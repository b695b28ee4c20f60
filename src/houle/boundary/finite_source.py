"""The internal source for regular waves of finite height: pushes with the gradient of the potential of finite.py."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from houle.grid import Faces, FloatArray, Grid
from houle.waves.finite import Potential, Spectrum, potential
from houle.waves.wave import Wave, ramp

REACH = 1.25  # widths to each side of the source where its force is not negligible: exp(-20 * 1.25^2) = 3e-14
FADE = 1.0  # widths from where what an oblique wave asks for further out (1e-3 of the force) is led to 0


@dataclass
class FiniteSource:
    """Adds sum_n r^n Re(F_n(x) exp(-i n tau)), tau = omega t - k_y y - psi, r the ramp; the mean, n = 0, grows as r^2.

    That is how the harmonics of a wave grow with its height, so that it is nearly right already while it grows.

    first     number of the first face along x that it pushes, and of the first cell
    along_x   F_n on these faces (faces, M); along_y on the cells between (cells, M), none in 2D [m/s2]
    phase     k_y y + psi at the cell centres along y (ny,), on the faces across (ny + 1,) [rad]; one and none in 2D
    """

    first: int
    along_x: Spectrum
    along_y: Spectrum
    omega: float
    phase: tuple[FloatArray, FloatArray]
    duration: float  # of the ramp [s]

    @staticmethod
    def force(wave: Wave, width: float, side: str) -> Potential:
        """side: "both", "left" or "right". Raises WaveError."""
        return potential(wave, width, (side != "left", side != "right"))

    @classmethod
    def of(cls, wave: Wave, grid: Grid, place: float, width: float, side: str, duration: float) -> FiniteSource:
        """At x = place [m]."""
        from scipy.interpolate import CubicSpline

        found = cls.force(wave, width, side)
        h, count = grid.spacing[0], grid.shape[0]
        first, last = (round((place + s * REACH * width) / h) for s in (-1, 1))
        first, last = max(1, first), min(count - 1, last)
        faces: FloatArray = np.arange(first, last + 1, dtype=float) * h - place
        k_x, k_y = wave.k * np.cos(wave.direction), wave.k * np.sin(wave.direction)
        psi = k_x * place * (-1.0 if side == "left" else 1.0) + wave.phase
        along_x = CubicSpline(found.x, found.along.T)(faces)
        along_y, phase = np.zeros((0, along_x.shape[1]), complex), (np.array([psi]), np.zeros(0))
        if grid.dimension == 3:
            phase = (k_y * grid.axis_points(1) + psi, k_y * grid.axis_points(1, on_faces=True) + psi)
        if grid.dimension == 3 and k_y:
            n, value = np.arange(along_x.shape[1]), CubicSpline(found.x, found.value.T)
            centres, oblique = faces[:-1] + h / 2, n > 0
            along_y = 1j * k_y * n * value(centres) * _share(centres, width)[:, None]
            slope = (_share(faces + h / 2, width) - _share(faces - h / 2, width)) / h
            led = along_x * _share(faces, width)[:, None] + value(faces) * slope[:, None]
            along_x = np.where(oblique, led, along_x)
        return cls(first, along_x, along_y, wave.omega, phase, duration)

    def resist(self, rate: Faces) -> None:
        """It damps nothing."""

    def touches(self) -> dict[int, slice]:
        across = {1: slice(self.first, self.first + len(self.along_y))} if self.along_y.size else {}
        return {0: slice(self.first, self.first + len(self.along_x))} | across

    def push(self, t: float, acceleration: Faces) -> None:
        force = self._force(self.along_x, self.phase[0], t)
        here = acceleration[0][self.first : self.first + len(force)]
        here += force[..., None] if here.ndim == 3 else force
        if self.along_y.size:
            force = self._force(self.along_y, self.phase[1], t)
            acceleration[1][self.first : self.first + len(force)] += force[..., None]

    def _force(self, shapes: Spectrum, phase: FloatArray, t: float) -> FloatArray:
        """(places, phases)"""
        n = np.arange(shapes.shape[1])
        grown = float(ramp(t, self.duration)) ** np.where(n == 0, 2, n)
        beat = grown[:, None] * np.exp(-1j * n[:, None] * (self.omega * t - phase))
        return np.asarray(np.einsum("xn,ny->xy", shapes, beat, optimize=False).real)


def _share(x: FloatArray, width: float) -> FloatArray:
    """1 inside of FADE widths, 0 outside of REACH, half a cosine between."""
    way = np.clip((np.abs(x) / width - FADE) / (REACH - FADE), 0.0, 1.0)
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * way))
