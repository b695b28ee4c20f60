"""A laboratory beside its prototype, `houle check --scale 40`: Reynolds and KC numbers in pores, and the grain to take.

Waves follow Froude's law: with lengths times S go times and velocities times sqrt(S). Water in pores does not, as its
viscosity stays: a core scaled by length lets through too little. Burcharth, Liu & Troch (1999), Coastal Engineering in
Developing Countries, choose the grain of a model core so that the velocity, averaged over core and period, is that of
the prototype over sqrt(S) under the gradients of the prototype. These come from the decay of wave pressure in a core,
`houle.design.pore_pressure`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, pi, sqrt

import numpy as np
import shapely
from rich.markup import escape
from rich.table import Table

from houle.case.model import Case
from houle.case.porous import coefficients
from houle.case.section import CrossSection, Entry
from houle.case.tables.tank import Porous
from houle.check.drag import expected_gradient
from houle.design.mound import pore_pressure, similar_grain
from houle.errors import CaseError
from houle.grid import FloatArray
from houle.waves.ship import ShipWave

MOST = 1000.0  # largest scale that is taken: models are larger
POINTS = 20  # places in a body, and moments of a quarter of a period, over which the velocity is averaged
NOTICED = 1.02  # growth of the grain that is worth ordering another
DENSITY = 1000.0  # fresh water [kg/m3]; it cancels


@dataclass(frozen=True)
class Flow:
    """Flow in the pores of a body: Darcy velocity [m/s], Reynolds number u_d d50/nu, KC number u_d T/(n d50) [-].

    A number is None where the grain diameter or the period that it needs is not known.
    """

    velocity: float
    reynolds: float | None
    keulegan_carpenter: float | None


@dataclass(frozen=True)
class Layer:
    """A porous body in the laboratory and in the prototype, under the same hydraulic gradients.

    gradient  their mean [-], from `cause`
    own       grain diameter [m] in the case, None where none is given
    grain     grain diameter [m] with which the laboratory's velocity is the prototype's over sqrt(scale); None where
              the drag is given by its coefficients, which say nothing of the prototype
    """

    name: str
    gradient: float
    cause: str
    laboratory: Flow
    prototype: Flow | None
    own: float | None
    grain: float | None


def layers(case: Case, scale: float) -> list[Layer]:
    """Every porous body of a case beside a prototype `scale` times as large. Raises CaseError for the scale."""
    if not 1 < scale <= MOST:
        raise CaseError(
            f"--scale {scale:g}: the prototype is that many times as large as the case, above 1 and at most {MOST:g}: "
            "40 for a model of 1:40"
        )
    section = CrossSection(case)
    return [_layer(case, section, body, scale) for body in section.porous]


def froude(scale: float) -> str:
    """The factors of Froude's law from laboratory to prototype, in words."""
    factors = {
        "lengths": 1.0, "times and velocities": 0.5, "pressures": 1.0, "discharges per metre": 1.5,
        "forces per metre": 2.0, "moments per metre": 3.0,
    }  # fmt: skip
    return ", ".join(f"{what} x {scale**power:.4g}" for what, power in factors.items())


def _layer(case: Case, section: CrossSection, body: Entry[Porous], scale: float) -> Layer:
    """One body in the laboratory and in the prototype."""
    row, nu, period = body.row, case.fluid.viscosity, case.drag_period
    gradients, cause = _gradients(case, section, body)

    def velocity(d: float | None, slower: float) -> float:
        a, b = coefficients(row.resistance, row.porosity, d, nu, period * sqrt(scale) / slower)
        return _mean_velocity(a, b, gradients, case.fluid.gravity)

    def flow(speed: float, d: float | None, time: float) -> Flow:
        reynolds = speed * d / nu if d is not None and nu else None
        return Flow(speed, reynolds, speed * time / (row.porosity * d) if d is not None and time < inf else None)

    d = row.grain_diameter
    here = flow(velocity(d, sqrt(scale)), d, period)
    if d is None or row.resistance.law is None:
        return Layer(row.name, float(gradients.mean()), cause, here, None, d, None)
    full, grain = similar_grain(velocity, d * scale, scale)
    there = flow(full, d * scale, period * sqrt(scale))
    return Layer(row.name, float(gradients.mean()), cause, here, there, d, grain)


def _mean_velocity(a: float, b: float, gradients: FloatArray, gravity: float) -> float:
    """Mean Darcy velocity [m/s] under the gradients [-]: a u + b u^2 = g i for each; inf without drag."""
    if a == 0 and b == 0:
        return inf
    drive = gravity * gradients
    return float(np.mean(2 * drive / (a + np.sqrt(a * a + 4 * b * drive))))


def _gradients(case: Case, section: CrossSection, body: Entry[Porous]) -> tuple[FloatArray, str]:
    """Hydraulic gradients [-] over a body and a quarter of a period, and where they come from, in words.

    In waves on level water they are those of a pressure that falls off from rho g H/2 at the face of the body.
    """
    drop = section.drop()
    wave = case.wave
    passes = isinstance(wave, ShipWave)  # its length is that of the record, and no wave of that length comes
    if wave is None or passes or wave.height <= 0 or drop >= section.grid.spacing[-1]:
        known = drop >= section.grid.spacing[-1]
        cause = f"drop of the water level, {drop:.3g} m" if known else "assumed: waves make one of this order"
        return np.array([expected_gradient(section, body, drop)]), cause
    width = _width(section, body)

    def largest(x: float) -> float:
        return pore_pressure(
            pressure=DENSITY * 9.81 * wave.height / 2, x=x, wave_height=wave.height, wave_length=wave.length,
            porosity=row.porosity, core_width=width,
        ).gradient  # fmt: skip

    row = body.row
    middles = (np.arange(POINTS) + 0.5) / POINTS
    over_body = np.array([largest(x) for x in middles * width])
    cause = f"decay of the wave pressure over {width:.3g} m, H = {wave.height:.3g} m, L = {wave.length:.3g} m"
    return np.outer(over_body, np.cos(middles * pi / 2)).ravel(), cause


def _width(section: CrossSection, body: Entry[Porous]) -> float:
    """Longest stretch of a body in the plane of still water [m]; its length along x where it does not reach there."""
    level, (x0, _, x1, _) = section.depth(), section.window
    plane = shapely.LineString([(x0, level), (x1, level)])
    cuts = [shapely.intersection(plane, section.area([body], y)) for y in section.layers]
    longest = max((shapely.length(part) for cut in cuts for part in shapely.get_parts(cut)), default=0.0)
    return float(longest) or section.extent(body)[0]


def sheet(case: Case, scale: float) -> Table:
    """The table of `houle check --scale`: each body in the laboratory and in the prototype, and the grain to take."""
    table = Table(title=f"beside a prototype {scale:g} times as large", title_justify="left", caption_justify="left")
    for column in ("porous body", "", "laboratory", "prototype", "by Froude's law"):
        table.add_column(column)
    for layer in layers(case, scale):
        for row in _rows(layer, scale):
            table.add_row(*map(escape, row))
        table.add_section()
    table.caption = f"From here to there: {froude(scale)}"
    return table


def _rows(layer: Layer, scale: float) -> Iterator[tuple[str, str, str, str, str]]:
    """Rows of the table about a body: gradient, velocity, Reynolds and KC number, and the grain to take."""
    here, there = layer.laboratory, layer.prototype
    yield layer.name, "gradient", f"{layer.gradient:.3g}", "the same", layer.cause
    if there is None:
        yield "", "u_d [m/s]", f"{here.velocity:.3g}", "not known", "the drag is given by its coefficients: give a law"
        return
    share = here.velocity * sqrt(scale) / there.velocity
    yield "", "u_d [m/s]", f"{here.velocity:.3g}", f"{there.velocity:.3g}", f"{share:.2f} of the prototype's"
    yield "", "u_d d50/nu", _number(here.reynolds), _number(there.reynolds), ""
    yield "", "u_d T/(n d50)", _number(here.keulegan_carpenter), _number(there.keulegan_carpenter), ""
    if layer.grain is not None and layer.own is not None:
        grown = layer.grain / layer.own
        advice = f"take {1000 * layer.grain:.3g} mm in the laboratory" if grown > NOTICED else "the grain will do"
        yield "", "d50 [mm]", f"{1000 * layer.own:.4g}", f"{1000 * layer.own * scale:.4g}", f"{advice}, x {grown:.2f}"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"
