"""`houle check`: findings, grid, passports and price on the terminal, the section as a picture."""

from __future__ import annotations

from math import inf
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from houle.case.model import Case
from houle.check import cost, wave_report
from houle.check.open_sides import open_rows
from houle.check.passport import REFERENCE_VELOCITY, Passport
from houle.check.rules import require
from houle.grid import axes


def show(case: Case, picture: Path, threads: int | None = None, console: Console | None = None) -> None:
    """Raises CaseError when the case cannot be run: nothing is printed or drawn then."""
    console = console or Console(highlight=False)
    findings = require(case)
    console.print(f"[bold]{escape(case.case.title or case.case.name)}[/]")
    window = wave_report.steady(case)
    for finding in findings if window is None else [*findings, window]:
        colour = "yellow" if finding.level == "warning" else "cyan"
        console.print(f"[{colour}]{finding.level}[/] {escape(str(finding))}", soft_wrap=True)
    console.print(_grid(case), soft_wrap=True)
    tables = (
        ("waves", wave_report.wave_rows(case)),
        ("absorbers", wave_report.absorber_rows(case)),
        ("sponges", wave_report.sponge_rows(case)),
        ("open sides", open_rows(case)),
    )
    for name, rows in tables:
        if rows:
            console.print(_rows(name, rows))
    for body in cost.passports(case):
        console.print(_passport(body))
        for warning in body.warnings:
            console.print(f"[yellow]warning[/] porous.{escape(body.name)}: {escape(warning)}", soft_wrap=True)
    console.print(_price(case, threads or 1), soft_wrap=True)
    cost.draw(case, picture)
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


def _passport(p: Passport) -> Table:
    """Every convention side by side, so that a coefficient can be compared with any paper."""
    table = Table(title=f"porous body {p.name}", title_justify="left", show_header=False)
    grain = f", d50 = {p.grain_diameter * 1000:g} mm" if p.grain_diameter else ""
    table.add_row("law", escape(p.words))
    table.add_row("source", escape(f"{p.source}; {p.status}" if p.status else p.source))
    alone = " before du/dt alone" if p.added_mass_on == "rate" else ""
    table.add_row("material", f"n = {p.porosity:g}{grain}, C_r = {p.inertia:.4g}{alone}")
    table.add_row("drag per unit mass", f"a u_d + b |u_d| u_d with a = {p.a:.4g} 1/s, b = {p.b:.4g} 1/m")
    if p.period is not None:
        table.add_row("to and fro", _to_and_fro(p))
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


def _to_and_fro(p: Passport) -> str:
    """What the Keulegan-Carpenter number does to the drag, at the expected velocity."""
    if p.period == inf:
        return "steady flow, KC infinite: no waves, or a single one; period = ... in resistance changes it"
    assert p.period is not None and p.grain_diameter is not None
    words = (
        f"period {p.period:.4g} s: 7.5/KC with KC = |u_d| T/(n d50) where the water is, {p.oscillating:.4g} 1/s of a"
    )
    if p.velocity < inf:
        kc = p.velocity * p.period / (p.porosity * p.grain_diameter)
        words += f"; KC = {kc:.3g} at {p.velocity:.3g} m/s, b as large as {1 + 7.5 / kc:.3g} times the steady one"
    return words


def _price(case: Case, threads: int) -> str:
    p = cost.price(case, threads)
    minutes = f"{p.minutes:.0f} min" if p.minutes >= 1.5 else f"{max(1.0, 60 * p.minutes):.0f} s"
    work = f"{p.particles} particles, {p.steps} steps of {1000 * p.step:.2g} ms"
    on = f"{minutes} on {threads} thread{'s' if threads > 1 else ''}"
    least, most = p.memory / 1e6, p.most_memory / 1e6
    grows = f" (up to {most:.0f} MB if water gets to the top)" if most > 1.05 * least else ""
    space = f"{least:.0f} MB of memory{grows}, {p.disk / 1e6:.0f} MB of results"
    return f"Cost, a guess within a factor of 3: {work}, {on}, {space}"
