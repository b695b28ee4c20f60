"""The rules of `houle check`: does the case make sense as a whole, before it is run?

Every finding quotes the two numbers that it compares and says what to change. An error stops the run (`require` raises
CaseError), a warning is printed, an info is printed by `houle check` only. The models of `case/tables/` have checked
single keys already; here shapes are compared with the domain, with each other and with the grid. Sections are compared
exactly, as polygons (shapely), layer by layer in y in 3D. To add a check, write a function that yields findings and add
it to CHECKS. The docstring of a check says what has to hold.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt
from typing import Literal

import numpy as np
import shapely

from houle.case.build import asked_for, first_rows, site_of, viscous_step
from houle.case.messages import guess, place, several
from houle.case.model import Case
from houle.case.reading import is_file
from houle.case.section import CrossSection
from houle.check.answers import answers_come, overtopping_resolved
from houle.check.boundaries import gates_fit, moving_walls_fit, open_sides_fit
from houle.check.finding import Finding
from houle.check.friction import friction_counts
from houle.check.machine import memory_suffices
from houle.check.ship import ship_fits
from houle.check.waves import sponges_fit, waves_fit
from houle.errors import CaseError, metres
from houle.flow.schemes import SCHEMES
from houle.flow.setup import SHORTEST, WAVE_SHARE
from houle.grid import axes
from houle.medium.sections import layers, section
from houle.medium.shapes import enclosed
from houle.medium.thin_solids import closed_passage

FEWEST = 2.0  # spacings across a porous body: fewer are an error
ENOUGH = 4.0  # spacings across a porous body: fewer are warned of
SELDOM = 50  # least steps between remeshings that add water: with 5 a dam break has half as much again after 0.4 s


def check(case: Case) -> list[Finding]:
    """All findings about a case, errors first."""
    if shapes := list(simple_polygons(case)):
        return shapes
    section = CrossSection(case)
    if outside := list(inside_domain(section)):
        return outside  # nothing more can be said about shapes that are not there
    found = [finding for look in CHECKS for finding in look(section)]
    order = ("error", "warning", "info")
    return sorted(found, key=lambda f: order.index(f.level))


def require(case: Case) -> list[Finding]:
    """The warnings and infos about a case. Raises CaseError, one line per error, when it cannot be run."""
    found = check(case)
    errors = [str(f) for f in found if f.level == "error"]
    if errors:
        raise CaseError(several(errors))
    return found


def simple_polygons(case: Case) -> Iterator[Finding]:
    """No polygon crosses itself: it would enclose no definite area."""
    for key in ("water", "porous", "solid"):
        for i, row in enumerate(getattr(case, key)):
            if row.polygon is not None:
                try:
                    enclosed(row.polygon)
                except ValueError as error:
                    yield Finding("error", place((key, i, "polygon"), case.__dict__), str(error))


def inside_domain(s: CrossSection) -> Iterator[Finding]:
    """No shape reaches out of the domain, and no level lies above it. Reports the side of a shape that is worst."""
    size, slack = s.case.domain.size, 1e-6 * s.case.domain.spacing
    for body in s.entries:
        kind = next(k for k in ("box", "polygon", "below") if getattr(body.row, k) is not None)
        ends = [(axis, float(v)) for corner in body.shape.bounds for axis, v in enumerate(corner) if np.isfinite(v)]
        beyond, axis, value = max((max(-v, v - size[a]) / size[a], a, v) for a, v in ends)
        if beyond * size[axis] > slack:
            name, hint = axes(s.case.dimension)[axis], metres(value, size[axis])
            yield Finding(
                "error",
                f"{body.key}.{kind}",
                f"reaches {name} = {value:g}, outside the domain 0 <= {name} <= {size[axis]:g} m: cut it there, or "
                f"change domain.size.{hint}",
            )


def water_is_somewhere(s: CrossSection) -> Iterator[Finding]:
    """There is water, none of it is asked for inside a solid, and its depth is resolved."""
    area = max(s.open_water(y).area for y in s.layers)
    if area <= s.speck:
        yield Finding("error", "water", "covers nothing of the open domain: give water where no solid is")
        return
    for body in s.water:
        common, (x0, z0, x1, z1) = s.overlap([body], s.solid)
        if not body.free and common > s.speck:
            yield Finding(
                "error",
                body.key,
                f"lies in a solid over {common:.3g} m2 (x {x0:g} to {x1:g}, z {z0:g} to {z1:g}): cut the shape, or "
                "write below = level, which fills what is open",
            )
    deep, h = s.depth(), s.grid.spacing[-1]
    if deep < 10 * h and deep < s.grid.size[-1] - h / 2:
        yield Finding(
            "warning",
            "domain.spacing",
            f"= {h:g} m gives {deep / h:.1f} cells over the water depth {deep:g} m: 10 or more carry waves, "
            f"spacing = {deep / 10:.2g}",
        )


def bodies_agree(s: CrossSection) -> Iterator[Finding]:
    """Porous bodies that overlap are of the same material; a solid wins over a porous body."""
    for i, one in enumerate(s.porous):
        for other in s.porous[:i]:
            common, (x0, z0, x1, z1) = s.overlap([one], [other])
            alike = ("porosity", "grain_diameter", "resistance", "added_mass", "added_mass_on")
            unlike = next((k for k in alike if getattr(one.row, k) != getattr(other.row, k)), None)
            if common > s.speck and unlike:
                a, b = getattr(other.row, unlike), getattr(one.row, unlike)
                values = f"{a:g} against {b:g}" if isinstance(a, float) and isinstance(b, float) else "they differ"
                yield Finding(
                    "error",
                    one.key,
                    f"overlaps {other.key} over {common:.3g} m2 (x {x0:g} to {x1:g}, z {z0:g} to {z1:g}) with another "
                    f"{unlike}, {values}: let them touch without overlap",
                )
        common, _ = s.overlap([one], s.solid)
        if common > s.speck:
            whole = max(s.area([one], y).area for y in s.layers)
            level: Literal["error", "info"] = "error" if common > whole - s.speck else "info"
            cure = "remove one of them" if level == "error" else "the solid holds there"
            yield Finding(level, one.key, f"lies in a solid over {common:.3g} of its {whole:.3g} m2: {cure}")


def grid_resolves(s: CrossSection) -> Iterator[Finding]:
    """Porous bodies, solids and water are some spacings thick, and porous bodies some grains."""
    h = max(s.grid.spacing)
    for body in s.porous:
        thick = s.thickness(body)
        across = thick / h
        if across < ENOUGH:
            yield Finding(
                "error" if across < FEWEST * (1 - 1e-9) else "warning",
                body.key,
                f"is {thick:.3g} m thick, {across:.1f} spacings of {h:.3g} m: {FEWEST:g} are needed, {ENOUGH:g} are "
                f"good; domain.spacing = {thick / ENOUGH:.2g}",
            )
        d = body.row.grain_diameter
        if d is not None and d > thick / 3:
            hint = guess("grain_diameter", d, upper=thick / 3) if d > thick else ""
            yield Finding(
                "error" if d > thick else "warning",
                f"{body.key}.grain_diameter",
                f"= {d:g} m against a thickness of {thick:.3g} m: a law averages over several grains, give "
                f"grain_diameter <= {thick / 3:.2g} m, or a and b measured on the body.{hint}",
            )
    for shape in (*s.solid, *s.water):
        thick, solid = s.thickness(shape), shape.row in s.case.solid
        what = "keep its form, below 1 it is made one thick" if solid else "flow as water does"
        if thick < FEWEST * h * (1 - 1e-9):
            yield Finding(
                "warning",
                shape.key,
                f"is {thick:.3g} m thick, {thick / h:.1f} spacings of {h:.3g} m: {FEWEST:g} or more {what}, "
                f"domain.spacing = {thick / FEWEST:.2g}",
            )


def thin_solids(s: CrossSection) -> Iterator[Finding]:
    """The windows that count as solid around thin solids (`medium.thin_solids`) leave water and close no passage."""
    windows = s.windows
    if not windows:
        return
    h, passage = max(s.grid.spacing), None
    dry = True
    for y in layers(s.grid, [*(b.shape for b in s.entries), *windows]):
        thickening = section(s.grid, windows, y)
        dry &= shapely.difference(s.open_water(y), thickening).area <= s.speck
        open_ = shapely.difference(shapely.box(*s.window), s.area(s.solid, y))
        passage = passage or closed_passage(s.grid, open_, thickening)
    if dry:
        yield Finding(
            "error",
            "domain.spacing",
            f"= {h:g} m leaves no water: all of it lies in cells that thin solids part, which count as solid; give "
            f"domain.spacing = {h / 4:.2g}",
        )
    elif passage:
        yield Finding(
            "warning",
            "domain.spacing",
            f"= {h:g} m closes the passage at x = {passage[0]:.4g}, z = {passage[1]:.4g}, as cells that thin solids "
            f"part count as solid: domain.spacing = {h / 2:.2g} or less keeps it open if it is as wide as two cells",
        )


def spacing_divides(s: CrossSection) -> Iterator[Finding]:
    """The spacing used along each axis is within 10 % of domain.spacing."""
    asked = s.case.domain.spacing
    for name, used, size in zip(axes(s.case.dimension), s.grid.spacing, s.grid.size, strict=True):
        if abs(change := used / asked - 1) > 0.1:
            yield Finding(
                "warning",
                "domain.spacing",
                f"= {asked:g} m does not divide the length {size:g} m along {name}: {used:.4g} m is used, "
                f"{100 * change:+.0f} %; choose a spacing that divides it",
            )


def observables(s: CrossSection) -> Iterator[Finding]:
    """Every instrument lies in the tank, where there is something to observe."""
    site = site_of(s.case)
    for key in s.case.observed():
        for i, remark in asked_for(s.case, key, site).check():
            where = ".".join(part for part in (place((key, i), s.case.__dict__), remark.key) if part)
            yield Finding(remark.level, where, remark.text)


def times(s: CrossSection) -> Iterator[Finding]:
    """Output is written within the run, and steps are neither too long nor too short for the water."""
    t, out = s.case.time, s.case.output
    if out.every > t.end:
        text = f"= {out.every:g} s is longer than time.end = {t.end:g} s: only the start is written, shorten it"
        yield Finding("warning", "output.every", text)
    if out.series_every > out.every:
        text = f"= {out.series_every:g} s is longer than output.every = {out.every:g} s: 0.005 is usual"
        yield Finding("warning", "output.series_every", text)
    speed, h = s.expected_speed(), min(s.grid.spacing)
    natural = sqrt(s.grid.spacing[-1] / max(9.81, *map(abs, s.case.acceleration)))  # time of fall through a cell [s]
    asked = {"output.every": out.every, "time.step": t.step, "time.courant": t.courant * WAVE_SHARE * natural}
    for key, step in asked.items():
        if step is not None and step < 10 * SHORTEST * natural:
            text = f"makes steps of {step:.2g} s, the water needs some {0.5 * WAVE_SHARE * natural:.1g} s"
            yield Finding("error", key, f"{text}: give a larger value, or leave it out")
    if t.step is not None and (cells := t.step * speed / h) > 1:
        yield Finding(
            "warning",
            "time.step",
            f"= {t.step:g} s moves water at {speed:.2g} m/s over {cells:.1f} cells of {h:.3g} m a step: below 1 is "
            f"accurate, step = {0.5 * t.step / cells:.1g}, or courant = 0.5",
        )
    nu, viscous = s.case.fluid.viscosity, viscous_step(s.case)
    if t.step is not None and t.step > viscous:
        text = f"= {t.step:g} s is unstable with fluid.viscosity = {nu:g} m2/s: at most {0.99 * viscous:.3g}"
        yield Finding("error", "time.step", f"{text}, or courant = 0.5, which finds it")


def materials(s: CrossSection) -> Iterator[Finding]:
    """Viscosity and porosities are not unusual: values far off are wrong units more often than meant so."""
    nu = s.case.fluid.viscosity
    if nu > 1e-5:
        hint = " 0.001 is the dynamic viscosity of water [Pa s]; divide by the density." if 5e-4 < nu < 2e-3 else ""
        text = f"= {nu:g} m2/s is {nu / 1e-6:.0f} times that of water, 1e-06 m2/s.{hint}"
        yield Finding("warning", "fluid.viscosity", text)
    for body in s.porous:
        n = body.row.porosity
        if not 0.2 <= n <= 0.9:
            text = f"= {n:g} is unusual: rubble and sand lie between 0.3 and 0.6; 1 is clear water"
            yield Finding("warning", f"{body.key}.porosity", text)


def remeshing(s: CrossSection) -> Iterator[Finding]:
    """The paper's remeshing, which adds water each time, is not asked for too often."""
    n = s.case.numerics
    if n.remesh == "paper" and n.remesh_every < SELDOM:
        text = (
            f'= {n.remesh_every}: remesh = "paper" adds water wherever there is a surface, each time; the paper takes '
            f'{SCHEMES["jh2020"].takes["remesh_every"]}, or take remesh = "conservative"'
        )
        yield Finding("warning", "numerics.remesh_every", text)


def reference_is_there(s: CrossSection) -> Iterator[Finding]:
    """The file with laboratory data that the case names is there."""
    r, path = s.case.reference, s.case.laboratory
    if r is not None and path is not None and not is_file(path):
        text = (
            f'= "{r.surface}" is not a file beside the case file, in {s.case.folder}: put it there, or remove '
            "[reference]"
        )
        yield Finding("error", "reference.surface", text)


def fits_the_machine(s: CrossSection) -> Iterator[Finding]:
    """This machine has the memory that the run takes, and every cell and particle can be numbered."""
    yield from memory_suffices(s, first_rows(s.case))


CHECKS = (
    water_is_somewhere,
    bodies_agree,
    grid_resolves,
    thin_solids,
    spacing_divides,
    observables,
    gates_fit,
    times,
    materials,
    remeshing,
    fits_the_machine,
    waves_fit,
    ship_fits,
    sponges_fit,
    open_sides_fit,
    moving_walls_fit,
    friction_counts,
    overtopping_resolved,
    answers_come,
    reference_is_there,
)
