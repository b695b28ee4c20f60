"""The output of `houle describe TOPIC`: every choice of the case file and every design formula, with its source.

The description of a choice stands in its row (`houle.registry`), that of a quantity with its observer
(`houle.observe`).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from math import inf
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table

from houle.fields import Field
from houle.registry import choices

Rows = Mapping[str, tuple[str, str]]  # name -> description, source

OTHERS: Rows = {
    "correction": (
        "Second pressure solve that moves particles towards the volume of their cells; the share of the error removed "
        "by a step in which the fastest particle crosses a quarter of a cell, less by shorter ones, more by longer; "
        "0 = off.",
        "Kugelstadt, Longva, Thuerey & Bender (2019), IEEE Trans. Vis. Comput. Graph.",
    ),
    "tolerance": ("Largest relative volume change max |div u_d| dt that the pressure solve may leave.", "-"),
    "remesh_every": ("Least number of steps between two remeshings; water that has hardly moved is left alone.", "-"),
    "order": ("Number of terms of fmpm.", "-"),
    "flip": ("Share of FLIP in its blend with PIC; transfer flip only.", "-"),
}


RESISTANCE = """Drag per unit mass of water: a u_d + b |u_d| u_d, with the Darcy velocity u_d = n u. Every law has its
own powers of n. Below, d is the grain_diameter d50, nu the viscosity, KC the Keulegan-Carpenter number. A law with a
period takes that of [waves] (T_m-1,0 of seas) unless the case gives period or kc: its share 7.5/KC is then linear.
Or directly: resistance = {a = ..., b = ...}, or {permeability = ..., forchheimer = ...}; a = nu/K_p, b = C_f/sqrt(K_p).
Inertia: C_r = 1 + added_mass (1-n)/n; 0.34: van Gent (1995). added_mass_on = "motion": before all of Du/Dt; energy is
conserved, p + rho C_r u^2/2 continuous. "rate": before du/dt at a place alone (Jensen, Jacobsen & Christensen 2014);
p + rho u^2/2 is continuous, and water that enters a body without friction gains energy. u is the pore velocity."""


def resistance(console: Console) -> None:
    """Prints the laws of resistance with their published coefficients and ranges."""
    console.print(RESISTANCE, highlight=False, soft_wrap=True, markup=False)
    table = _table("law", "formula and coefficients", "range measured", "source")
    for name, law in choices("law").items():
        values = ", ".join(f"{k} = {'steady' if v == inf else f'{v:g}'}" for k, v in law.coefficients.items())
        what = "\n".join(t for t in (law.what, values, law.note) if t)
        measured = law.range.replace(", ", "\n")
        table.add_row(name, escape(what), measured or "-", escape(f"{law.source}\n{law.status}"))
    console.print(table)


def numerics(console: Console) -> None:
    """Prints the schemes key by key, then every choice of [numerics]."""
    schemes = choices("scheme")
    console.print(_table_of("scheme"))
    keys = list(schemes["houle"].takes)
    table = _table(escape("key of [numerics]"), *(f'scheme = "{name}"' for name in schemes), "meaning")
    meaning = {**dict.fromkeys(keys, ""), **{k: words for k, (words, _) in OTHERS.items()}}
    meaning |= {"transfer": "see `houle describe transfers`", "kernel": "see `houle describe kernels`"}
    meaning |= {"remesh": "see `houle describe remeshing`"}
    for key in keys:
        table.add_row(key, *(str(scheme.takes[key]) for scheme in schemes.values()), meaning[key])
    console.print(table)
    console.print(escape("A key given in [numerics] overrides the scheme's."), highlight=False)
    console.print(_rows("method", {k: row for k, row in OTHERS.items() if row[1] != "-"}))


def everything_written() -> Iterator[Field]:
    """Every quantity that a run can write: on particles, on the grid, over the plan, in the series."""
    from houle.case.build import ALWAYS, asked_by_tables
    from houle.case.model import Case
    from houle.fields import TIME
    from houle.flow import snapshot

    yield from (*snapshot.PARTICLES, *snapshot.FACES, *snapshot.CELLS, snapshot.ETA, TIME)
    asked = asked_by_tables()
    for observer in (*(asked[key] for key in Case.observed()), *ALWAYS):
        yield from observer.fields


def fields(console: Console) -> None:
    """Prints every quantity that a run writes."""
    table = _table("name", "symbol", "unit", "place", "what it is")
    for f in everything_written():
        unit = f.unit + (f" (2D: {f.unit_2d})" if f.unit_2d else "")
        table.add_row(f.name, f.symbol, unit, f.place, escape(f.description))
    console.print(table)


def schema(console: Console) -> None:
    """Prints the JSON Schema of the case file and nothing else, for programs that read it."""
    from houle.case.model import schema as make

    console.file.write(json.dumps(make(), indent=2) + "\n")


def transfers(console: Console) -> None:
    console.print(_table_of("transfer"))


def kernels(console: Console) -> None:
    console.print(_table_of("kernel"))


def remeshing(console: Console) -> None:
    console.print(_table_of("remesh"))


def _table(*columns: str) -> Table:
    table = Table(show_lines=True)
    for column in columns:
        table.add_column(column, no_wrap=column == columns[0], overflow="fold")
    return table


def _rows(key: str, rows: Rows) -> Table:
    table = _table(key, "what it is", "source")
    for name, (words, source) in rows.items():
        table.add_row(escape(name), escape(words), escape(source))
    return table


def _table_of(kind: str) -> Table:
    """A table of a kind of choice: name, description, source."""
    return _rows(kind, {name: (row.what, row.source) for name, row in choices(kind).items()})


def theories(console: Console) -> None:
    """Prints wave theories, and the kinds of waves that a case can have, with range and source."""
    table = _table("wave", "what it is", "where it holds", "source")
    for name, row in (*choices("theory").items(), *choices("waves").items()):
        table.add_row(name, escape(row.what), escape(row.range), escape(row.source))
    console.print(table)
    words = "Down to solitary-5: values of theory in [waves]; below: kinds of waves. Equations: docs/waves.md."
    console.print(escape(words), highlight=False)


def makers(console: Console) -> None:
    """Prints the boundaries: makers of waves, dampers, open sides and moving walls, by their tables."""
    from houle.case.model import Case

    named = {f"[[{name}]]" if name in Case.model_fields else name: row for name, row in choices("boundary").items()}
    console.print(_rows("boundaries", {name: (row.what, row.source) for name, row in named.items()}))


FORMULAS = (
    "Published formulas for design, in Python as functions of houle.design; units are SI, angles in radians. An answer "
    "says what lies outside the range of its formula. Those that are RECALLED were not compared with their source: "
    "verify them before a number is printed as a fact. Inputs and an example: houle describe formulas NAME"
)


def formulas(console: Console) -> None:
    """Prints the design formulas with description, range and source."""
    console.print(FORMULAS, highlight=False, markup=False)
    for name, row in choices("formula").items():
        console.print(f"\n[bold]{name}[/]", highlight=False)
        _indented(console, row.what, {"range": row.range, "source": row.source, "checked": row.status})


def formula(console: Console, name: str) -> None:
    """Prints one design formula in full: equations, inputs with their units, result, and an example."""
    row = choices("formula")[name]
    console.print(f"[bold]{name}[/]: houle.design.{row.call}", highlight=False)
    facts = {"range": row.range, "source": row.source, "checked": row.status, "scatter": row.scatter}
    _indented(console, row.equations, facts)
    table = _table("input", "unit", "meaning", "if not given")
    for key, given in row.inputs.items():
        default = row.defaults().get(key)
        table.add_row(key, given.unit or "-", escape(given.told), _left_out(key in row.defaults(), default))
    console.print(table)
    table = _table("gives", "unit", "meaning")
    for key, (what, unit) in row.outputs.items():
        table.add_row(key, unit, escape(what))
    console.print(table)
    console.print(escape(f"design.{row.call}({row.said(row.example)})"), highlight=False)
    first, *lines = str(row.function(**row.example)).splitlines()
    console.print(escape(first), highlight=False)
    _indented(console, "\n\n".join(line.strip() for line in lines), {})


def _left_out(optional: bool, default: Any) -> str:
    """The default of an input in words; "needed" for one that cannot be left out."""
    if not optional:
        return "needed"
    return "-" if default is None else str(default)


def _indented(console: Console, what: str, facts: Mapping[str, str]) -> None:
    """A paragraph, and what is known of it, each with its word before it."""
    told = (f"{word}: {text}" for word, text in facts.items() if text)
    for text in (*what.split("\n\n"), *told):
        console.print(Padding(escape(text.replace("\n", " ")), (0, 0, 0, 4), expand=False), highlight=False)


TOPICS: dict[str, Callable[[Console], None]] = {
    "resistance": resistance,
    "theories": theories,
    "makers": makers,
    "kernels": kernels,
    "transfers": transfers,
    "remeshing": remeshing,
    "numerics": numerics,
    "fields": fields,
    "formulas": formulas,
    "schema": schema,
}
