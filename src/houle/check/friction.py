"""Checks of friction: what it would take from the water that slips along beds, walls and solids, and too coarse grains.

Waves: the energy that a bed takes per area is rho f_w u_b^3 2 / (3 pi) with the orbital velocity u_b above it, that of
linear theory (Jonsson 1966, Proc. 10th Conf. Coastal Eng.). f_w is the largest of laminar layers, 2 Re^-1/2, of smooth
turbulent ones, 0.0521 Re^-0.187, and of rough ones, exp(5.213 (k_s/A)^0.194 - 5.977) (Swart 1974, Delft Hydraulics
publ. 131), Re = u_b A / nu with the amplitude A of the orbit. Streams: the shear over a smooth plate of length x is
c_f U^2/2, c_f = 0.0592 (U x / nu)^-1/5, beneath a layer 0.37 x (U x / nu)^-1/5 thick (Schlichting, Boundary-Layer
Theory); its mean over the plate is 5/4 of that.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import exp, pi, sinh, sqrt

import numpy as np

from houle.case.section import CrossSection
from houle.case.tables.tank import Rough
from houle.case.tables.waves import PASSING
from houle.check.finding import Finding
from houle.errors import CaseError
from houle.waves.dispersion import group_velocity

TURBULENT = 1e5  # Reynolds number of a plate from which its boundary layer is turbulent
SHEET = 0.25  # depth of the stream of a dam break, as a share of that of the water behind it
FLOOR = "walls = {bottom = {roughness = 0}}"


def friction_counts(s: CrossSection) -> Iterator[Finding]:
    """Grains are smaller than cells, and who lets the water slip knows what it costs."""
    yield from _coarse(s)
    key, cure = _slips(s)
    if key and s.case.fluid.viscosity > 0.0:
        told = _waves(s) if s.case.waves is not None else _stream(s)
        if told:
            yield Finding("info", key, f"lets the water slip: {told}. {cure} lets it rub, k_s > 0 [m] is a rough one")


def _coarse(s: CrossSection) -> Iterator[Finding]:
    """The law of the wall holds above the grains: k_s is no larger than a cell."""
    h, walls = max(s.grid.spacing), s.case.domain.walls.rough(s.case.dimension, smooth=False)
    rough = {f"domain.walls.{side}.roughness": k for side, k in walls.items()}
    rough |= {f"{entry.key}.roughness": entry.row.roughness or 0.0 for entry in s.solid}
    for key, k in rough.items():
        if k > h:
            text = (
                f"= {k:g} m is more than the spacing of {h:.3g} m: the law of the wall holds above the grains, and "
                "larger ones take no more. Draw them, or make them a [[porous]] layer"
            )
            yield Finding("warning", key, text)


def _slips(s: CrossSection) -> tuple[str, str]:
    """The key of the bed that the water slips along, and what lets it rub; empty where none does."""
    slipping = [entry.key for entry in s.solid if entry.row.roughness is None]
    if slipping:
        return slipping[0], f"roughness = 0 in its table{' and the others' if len(slipping) > 1 else ''}"
    if not isinstance(bottom := s.case.domain.walls.bottom, Rough) and bottom == "slip":
        return "domain.walls", FLOOR
    return "", ""


def _waves(s: CrossSection) -> str:
    """The share of their energy that a smooth bed takes from the waves, as words; empty where it is not known."""
    case = s.case
    if case.waves is None or case.waves.kind in PASSING:
        return ""
    try:
        wave = case.wave
        assert wave is not None
    except CaseError:
        return ""
    height = wave.height / (sqrt(2.0) if case.waves.kind == "irregular" else 1.0)
    size = (height, wave.period, wave.depth, wave.length)
    share, thick = lost_per_wavelength(*size, case.fluid.gravity, case.fluid.viscosity)
    along = 100.0 * (1.0 - (1.0 - share) ** (case.domain.size[0] / wave.length))
    return (
        f"a smooth bed in {wave.depth:g} m of water takes about {100.0 * share:.2g} % of the energy of the waves per "
        f"wavelength, {along:.2g} % on the {case.domain.size[0]:g} m of the tank, in a layer of {1e3 * thick:.2g} mm "
        f"(spacing {1e3 * s.grid.spacing[-1]:.3g} mm)"
    )


def lost_per_wavelength(
    height: float, period: float, depth: float, length: float, gravity: float, viscosity: float, roughness: float = 0.0
) -> tuple[float, float]:
    """Share of the energy of waves that a bed takes per wavelength [-], and thickness of its boundary layer [m].

    Airy waves of this height, depth and length [m] and period [s]; viscosity [m2/s], roughness k_s [m].
    """
    k, omega = 2.0 * pi / length, 2.0 * pi / period
    speed = pi * height / (period * sinh(k * depth))
    f = wave_friction(speed, omega, viscosity, roughness)
    energy = gravity * height**2 / 8.0 * float(group_velocity(np.float64(k), depth, gravity))  # its flux over rho
    return min(2.0 / (3.0 * pi) * f * speed**3 * length / energy, 1.0), 5.0 * sqrt(viscosity / omega)


def wave_friction(speed: float, omega: float, viscosity: float, roughness: float = 0.0) -> float:
    """Friction factor f_w of a bed under an orbital velocity of this amplitude [m/s]: see the module."""
    reynolds = speed**2 / (omega * viscosity)
    smooth = max(2.0 * reynolds**-0.5, 0.0521 * reynolds**-0.187 if reynolds > 1e5 else 0.0)
    if roughness <= 0.0:
        return smooth
    return max(smooth, min(0.3, exp(5.213 * (roughness * omega / speed) ** 0.194 - 5.977)))


def _stream(s: CrossSection) -> str:
    """The boundary layer of water that falls and runs along the tank, as words; empty for a laminar one and at rest."""
    case, length = s.case, s.case.domain.size[0]
    over_all = [e for e in s.water if e.shape.bounds[0][0] <= 0.0 and e.shape.bounds[1][0] >= length]
    level = max((e.shape.bounds[1][-1] for e in over_all), default=0.0)
    fall = max(e.shape.bounds[1][-1] for e in s.water) - level  # height of water above or beside the rest
    given = [abs(v) for entry in s.water for v in entry.row.velocity or ()]
    speed = max(sqrt(case.fluid.gravity * max(fall, 0.0)), *given, 0.0)
    depth = SHEET * fall if fall > 0.0 else level
    reynolds = speed * length / case.fluid.viscosity
    if reynolds < TURBULENT:
        return ""
    layer, friction = 0.37 * length * reynolds**-0.2, 1.25 * 0.0592 * reynolds**-0.2
    taken = min(100.0 * friction * length / depth, 100.0)
    return (
        f"at {speed:.2g} m/s a smooth bed has a boundary layer {1e3 * layer:.2g} mm thick after {length:g} m (spacing "
        f"{1e3 * s.grid.spacing[-1]:.3g} mm), and takes {taken:.2g} % of the energy of a stream {depth:.2g} m deep"
    )
