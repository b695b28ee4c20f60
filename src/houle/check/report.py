"""The output of `houle check`: findings, grid, waves, boundaries, drag and cost; and the section as a picture."""

from __future__ import annotations

from math import inf, pi, sqrt
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from houle.boundary.open_side import CROSSINGS
from houle.boundary.sponge import sides
from houle.case.acting import law_of_piston, reach, source_of
from houle.case.messages import place
from houle.case.model import Case
from houle.case.section import CrossSection
from houle.case.tables.boundaries import Open, Sponge, records
from houle.case.tables.waves import Piston, Source
from houle.check import gauges
from houle.check.boundaries import inflow, water_beside
from houle.check.cost import price
from houle.check.drag import REFERENCE_VELOCITY, DragSheet, drag_sheets
from houle.check.rules import require
from houle.check.scale import sheet
from houle.check.ship import ship_rows
from houle.check.wave_theory import assess, bound
from houle.check.waves import absorbed
from houle.data.history import Record
from houle.errors import CaseError
from houle.grid import axes
from houle.output.section import draw
from houle.waves import dispersion
from houle.waves.piston import Reading, reading_of
from houle.waves.wave import Wave


def show(
    case: Case,
    picture: Path,
    threads: int | None = None,
    console: Console | None = None,
    scale: float | None = None,
) -> None:
    """Prints what `houle check` says about a case, and draws its section to the file `picture`.

    threads: number of threads for which the cost of the run is estimated. scale: size of a prototype over that of the
    case, to be compared. Raises CaseError when the case cannot be run: then nothing is printed or drawn.
    """
    if not picture.resolve().parent.is_dir():
        raise CaseError(f"--picture {picture}: there is no folder {picture.parent}, make it or name another file")
    console = console or Console(highlight=False)
    findings = require(case)
    compared = None if scale is None else sheet(case, scale)
    console.print(f"[bold]{escape(case.case.title or case.case.name)}[/]")
    window = gauges.steady(case)
    for finding in findings if window is None else [*findings, window]:
        colour = "yellow" if finding.level == "warning" else "cyan"
        console.print(f"[{colour}]{finding.level}[/] {escape(str(finding))}", soft_wrap=True)
    console.print(_grid(case), soft_wrap=True)
    tables = (
        ("waves", wave_rows(case)),
        ("ship", ship_rows(case)),
        ("absorbers", absorber_rows(case)),
        ("sponges", sponge_rows(case)),
        ("open sides", open_rows(case)),
    )
    for name, rows in tables:
        if rows:
            console.print(_rows(name, rows))
    for body in drag_sheets(case):
        console.print(_drag(body))
        for warning in body.warnings:
            console.print(f"[yellow]warning[/] porous.{escape(body.name)}: {escape(warning)}", soft_wrap=True)
    if compared is not None:
        console.print(compared)
    console.print(_price(case, threads or 1), soft_wrap=True)
    draw(case, picture)
    console.print(f"Section drawn: {picture}", soft_wrap=True)


def _grid(case: Case) -> str:
    grid = case.domain.grid
    cells = " x ".join(map(str, grid.shape))
    sizes = zip(grid.spacing, axes(grid.dimension), strict=True)
    spacing = ", ".join(f"{h * 1000:.5g} mm in {axis}" for h, axis in sizes)
    return f"Grid: {cells} cells; spacing {spacing} (asked for {case.domain.spacing * 1000:g} mm)"


def _rows(title: str, rows: list[tuple[str, str]]) -> Table:
    table = Table(title=title, title_justify="left", show_header=False)
    for name, words in rows:
        table.add_row(escape(name), escape(words))
    return table


def _drag(p: DragSheet) -> Table:
    """The drag of a body in every convention, so that its coefficients can be compared with any paper."""
    table = Table(title=f"porous body {p.name}", title_justify="left", show_header=False)
    grain = f", d50 = {p.grain_diameter * 1000:g} mm" if p.grain_diameter else ""
    table.add_row("law", escape(p.words))
    table.add_row("source", escape(f"{p.source}; {p.status}" if p.status else p.source))
    alone = " before du/dt alone" if p.added_mass_on == "rate" else ""
    table.add_row("material", f"n = {p.porosity:g}{grain}, C_r = {p.inertia:.4g}{alone}")
    table.add_row("drag per unit mass", f"a u_d + b |u_d| u_d with a = {p.a:.4g} 1/s, b = {p.b:.4g} 1/m")
    if p.period is not None:
        table.add_row("oscillating flow", _oscillating(p))
    table.add_row("the same as", f"K_p = nu/a = {p.permeability:.4g} m2, C_f = b sqrt(K_p) = {p.forchheimer:.4g}")
    table.add_row(f"at u_d = {REFERENCE_VELOCITY:g} m/s", f"drag = {p.reference_gradient:.3g} g")
    if p.velocity < inf:
        number = "" if p.reynolds is None else f", u_d d50/nu = {p.reynolds:.0f}"
        table.add_row(
            "expected",
            f"u_d = {p.velocity:.3g} m/s, steady flow under a hydraulic gradient of {p.gradient:.2g} (level drop / "
            f"length, at most 1); linear share of the drag {100 * p.linear_share:.0f} %{number}",
        )
    return table


def _oscillating(p: DragSheet) -> str:
    """Effect of the Keulegan-Carpenter number on the drag, at the expected velocity, in words."""
    if p.period == inf:
        return "steady flow, KC infinite: no waves, or a single one; period = ... in resistance changes it"
    assert p.period is not None and p.grain_diameter is not None
    words = f"period {p.period:.4g} s: 7.5/KC with the local KC = |u_d| T/(n d50) makes {p.oscillating:.4g} 1/s of a"
    if p.velocity < inf:
        kc = p.velocity * p.period / (p.porosity * p.grain_diameter)
        words += f"; KC = {kc:.3g} at {p.velocity:.3g} m/s, as if b were {1 + 7.5 / kc:.3g} times that of steady flow"
    return words


def _price(case: Case, threads: int) -> str:
    p = price(case, threads)
    minutes = f"{p.minutes:.0f} min" if p.minutes >= 1.5 else f"{max(1.0, 60 * p.minutes):.0f} s"
    work = f"{p.particles} particles, {p.steps} steps of {1000 * p.step:.2g} ms"
    on = f"{minutes} on {threads} thread{'s' if threads > 1 else ''}"
    least, most = p.memory / 1e6, p.most_memory / 1e6
    grows = f" (up to {most:.0f} MB if water gets to the top)" if most > 1.05 * least else ""
    space = f"{least:.0f} MB of memory{grows}, {p.disk / 1e6:.0f} MB of results"
    return f"Cost, a guess within a factor of 3: {work}, {on}, {space}"


def wave_rows(case: Case) -> list[tuple[str, str]]:
    """Rows (name, words) about the wave of the case and its maker, with the numbers of `wave_theory.assess`."""
    wave = case.wave
    if wave is None:
        return []
    assert case.waves is not None
    numbers = [text for level, text in assess(wave, max(case.domain.grid.spacing)) if level == "info"]
    names = ("theory", "size", "limits", "on the grid") if len(numbers) == 4 else ("theory", *[""] * (len(numbers) - 1))
    told = [("bound waves", words)] if (words := bound(wave)) else []
    rows = [("wave", _wave(case)), *zip(names, numbers, strict=True), *told, ("made by", _maker(case, wave))]
    return [rows[0], ("current", _current(case.waves.current, wave)), *rows[1:]] if case.waves.current else rows


def _current(speed: float, wave: Wave) -> str:
    """Effect of a current [m/s] on the period and length of the wave, in words."""
    own = wave.celerity - speed
    words = f"{speed:g} m/s; crests run at {own:.4g} m/s in the water, {wave.celerity:.4g} m/s seen from the bed"
    if wave.name.startswith("solitary"):
        return words
    still = 2 * pi / float(dispersion.wave_number(wave.omega, wave.depth, wave.gravity))
    relative = wave.length / own
    return f"{words}; period {relative:.4g} s in the water; length {wave.length / still:.3f} of that in still water"


def _wave(case: Case) -> str:
    waves = case.waves
    assert waves is not None
    sizes = (("height", waves.height, "m"), ("period", waves.period, "s"), ("depth", waves.depth, "m"))
    given = [f"{name} = {value:g} {unit}" for name, value, unit in sizes if value is not None]
    return ", ".join([str(waves.kind), *given, *([waves.file] if waves.file else [])])


def _maker(case: Case, wave: Wave) -> str:
    waves = case.waves
    assert waves is not None
    then = f"; full after {waves.ramp_time():.3g} s; the front runs at {wave.group_velocity:.3g} m/s"
    if isinstance(waves.maker, Source):
        width, (low, high) = source_of(waves, wave).width, reach(case, wave)
        side = {"both": "to both sides", "left": "to the left", "right": "to the right"}[waves.maker.side]
        at = f"source at x = {waves.maker.x:g} m, {width:.3g} m wide, acts from {low:.3g} to {high:.3g} m"
        return f"{at}; {side}{then}"
    if isinstance(waves.maker, Piston):
        return f"{_piston(case, wave)}{then}"
    start, end = waves.maker.x
    long = f"{(end - start) / wave.length:.2f} wavelengths"
    return f"relaxation zone, x {start:g} to {end:g} m, {long}; absorbs the waves that come back{then}"


def _piston(case: Case, wave: Wave) -> str:
    """The piston in words: stroke, wave height over stroke, the places between which it moves, the theory."""
    law, read, rest = law_of_piston(case, wave)
    low, high = law.reach
    compared = f"H/stroke = {wave.height / (high - low):.3g}, " if high - low > 1e-9 else ""
    told = (
        f"piston at x = {rest:g} m, stroke {high - low:.3g} m, {compared}moves from "
        f"{rest + low:.3g} to {rest + high:.3g} m; {law.theory}"
    )
    assert case.waves is not None and case.waves.piston is not None
    return f"{told}; absorbs, {_back(read, wave.period)}" if case.waves.piston.absorb else told


def _back(read: Reading, period: float) -> str:
    """Share of some waves that an absorbing wall sends back by linear theory, in words."""
    shares = [f"{100 * read.comes_back(2 * pi / t):.2g} % at T = {t:.3g} s" for t in (period / 2, period, 2 * period)]
    return f"sends back {', '.join(shares)}"


def absorber_rows(case: Case) -> list[tuple[str, str]]:
    """Rows (name, words) about every absorbing wall."""
    wave, depth = case.wave, CrossSection(case).depth()
    rows = []
    for i, table in enumerate(case.absorber):
        read = reading_of(wave, depth, case.fluid.gravity, table.period)
        rest = case.domain.grid.nearest_face(table.x)
        at = f"{table.side} end, at rest at x = {rest:g} m"
        rows.append((place(("absorber", i), case.__dict__), f"{at}; {_back(read, _tuned(read, wave, table.period))}"))
    return rows


def _tuned(read: Reading, wave: Wave | None, period: float | None) -> float:
    """Period at which an absorbing wall is described [s]: its own, that of the waves, or the one it is tuned to."""
    return period or (wave.period if wave is not None else 2 * pi / read.omega)


def sponge_rows(case: Case) -> list[tuple[str, str]]:
    """Rows (name, words) about every sponge: place, length, strength, share of the waves that come back."""
    wave = case.wave
    return [(place(("sponge", i), case.__dict__), _sponge(case, s, wave)) for i, s in enumerate(case.sponge)]


def _sponge(case: Case, sponge: Sponge, wave: Wave | None) -> str:
    axis, far = sides(sponge.box, case.domain.size, min(case.domain.grid.spacing) / 2)[0]
    long, strength, back = absorbed(case, sponge, wave, axis)
    side = (("left", "right"), ("front", "back"))[axis][far]
    waves = f" ({long / wave.length:.2f} wavelengths)" if wave is not None else ""
    return f"{side} side, {long:.3g} m long{waves}, up to {strength:.3g} 1/s: {100 * back:.1f} % of the waves come back"


def open_rows(case: Case) -> list[tuple[str, str]]:
    """Rows (name, words) about every open side: what the case prescribes, with speed and Froude number."""
    s = CrossSection(case)
    return [(f"{table.side} side", _words(s, table)) for table in case.open]


def _words(s: CrossSection, table: Open) -> str:
    known, (depth, _) = records(table, s.case.folder), water_beside(s, table)
    units = {"velocity": "m/s", "discharge": "m2/s", "level": "m"}
    said = [f"{key} {_span(record)} {units[key]}" for key, record in known.items()]
    wave = sqrt(max(s.case.fluid.gravity, 1e-12) * depth)
    speeds = inflow(known, depth)
    if speeds is not None:
        fastest = float(np.abs(speeds).max())
        said.append(f"{fastest:.3g} m/s in {depth:.3g} m of water, Froude number {fastest / wave:.2g}")
    if table.ramp:
        said.append(f"grows in {table.ramp:g} s")
    if "level" in known:
        response = table.response or CROSSINGS * s.case.domain.size[0] / wave
        said.append("waves leave" + (f"; the level is found in some {response:.3g} s" if len(known) == 1 else ""))
    if table.file:
        said.append(table.file)
    return ", ".join(said)


def _span(record: Record) -> str:
    low, high = float(record.value.min()), float(record.value.max())
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"
