"""What `houle describe TOPIC` prints: every choice the case file offers, in words, with its source.

The texts are rows of tables, name -> (what it is, where it comes from); the numbers stand where they are used (SCHEMES
in tables/control.py, LAWS in medium/resistance.py, FIELDS in fields.py). A test checks that every choice of the case
file has its row.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from math import inf

from rich.console import Console
from rich.markup import escape
from rich.table import Table

Rows = Mapping[str, tuple[str, str]]

PAPER = "Ramos Ortega, Beaudoin & Huberson (2020), 17emes Journees de l'Hydrodynamique (JH2020)"

SCHEMES: Rows = {
    "houle": (
        "Particles carry the Darcy velocity and a water volume; the grid solves the pressure with p = 0 on the true "
        "surface inside the cells. The drag is implicit inside the projection, the change of porosity acts as a force "
        "on the faces, particles move with the pore velocity u_d/n. Transfer by the full mass matrix (fmpm) with the "
        "linear kernel, positions corrected towards uniform volume, remeshing that conserves volume and momentum.",
        "docs/theory.md and docs/decisions",
    ),
    "jh2020": (
        "The combination of the founding paper: second-order Taylor Gaussian as kernel with particles of size "
        "dx/n^(1/d), pressure gradient added to the particles' own velocity, M'4 remeshing as in (6)-(7) every 200 "
        "steps, time stepping (12)-(17), with the "
        "corrections without which it does not hold (pore velocity in (12), (17); powers of n in (13); tensor product "
        "in (7)). Kept to quantify its defect at the free surface, not for work.",
        PAPER,
    ),
}
KERNELS: Rows = {
    "linear": ("Tent over two nodes per axis.", "Harlow's cloud in cell; Brackbill & Ruppel (1986)"),
    "quadratic": (
        "Quadratic B-spline over three nodes per axis, smooth first derivative.",
        "Steffen, Kirby & Berzins (2008)",
    ),
    "m4prime": (
        "Monaghan's M'4 as a tensor product over four nodes per axis: third order, has negative lobes.",
        "Monaghan (1985), J. Comput. Phys. 60; Cottet & Koumoutsakos (2000)",
    ),
    "gaussian": ("Gaussian at the particle's centre.", f"{PAPER}, (8)"),
    "gaussian-taylor2": (
        "Gaussian with the second moments of the particle's own square, of side dx/n^(1/d), by a Taylor series; one "
        "wider than 1.7 cells counts as one of 1.7, beyond which the series has negative weights.",
        f"{PAPER}, (8)-(11); after Beaudoin, Huberson & Rivoalen (2003)",
    ),
    "gaussian-cell": (
        "Gaussian integrated exactly over the particle's own square: a difference of error functions per axis, what "
        "the Taylor series approaches.",
        "docs/theory.md",
    ),
}
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
    """The laws with their published coefficients and ranges."""
    from houle.medium.resistance import LAWS

    console.print(RESISTANCE, highlight=False, soft_wrap=True, markup=False)
    table = _table("law", "formula and coefficients", "range measured", "source")
    for name, law in LAWS.items():
        values = ", ".join(f"{k} = {'steady' if v == inf else f'{v:g}'}" for k, v in law.coefficients.items())
        spans = (
            ("n", law.porosity, (0.0, 1.0)),
            ("d", law.diameter, (0.0, inf)),
            ("u_d d/nu", law.reynolds, (0.0, inf)),
        )
        measured = "\n".join(f"{w} {low:g}-{high:g}" for w, (low, high), all_of_it in spans if (low, high) != all_of_it)
        what = "\n".join(t for t in (law.words, values, law.note) if t)
        table.add_row(name, escape(what), measured or "-", escape(f"{law.source}\n{law.status}"))
    console.print(table)


def numerics(console: Console) -> None:
    """The two schemes key by key, then every choice."""
    from houle.case.tables.control import SCHEMES as VALUES

    console.print(_rows("scheme", SCHEMES))
    keys = list(VALUES["houle"])
    table = _table(escape("key of [numerics]"), *(f'scheme = "{name}"' for name in VALUES), "meaning")
    meaning = {**dict.fromkeys(keys, ""), **{k: words for k, (words, _) in OTHERS.items()}}
    meaning |= {"transfer": "see `houle describe transfers`", "kernel": "see `houle describe kernels`"}
    meaning |= {"remesh": "see `houle describe remeshing`"}
    for key in keys:
        table.add_row(key, *(str(values[key]) for values in VALUES.values()), meaning[key])
    console.print(table)
    console.print(escape("A key given in [numerics] overrides the scheme's."), highlight=False)
    console.print(_rows("method", {k: row for k, row in OTHERS.items() if row[1] != "-"}))


def fields(console: Console) -> None:
    """Everything a run writes."""
    from houle.fields import FIELDS

    table = _table("name", "symbol", "unit", "place", "what it is")
    for f in FIELDS:
        unit = f.unit + (f" (2D: {f.unit_2d})" if f.unit_2d else "")
        table.add_row(f.name, f.symbol, unit, f.place, escape(f.description))
    console.print(table)


def schema(console: Console) -> None:
    """JSON Schema of the case file, nothing else on the output."""
    from houle.case.model import schema as make

    console.file.write(json.dumps(make(), indent=2) + "\n")


def transfers(console: Console) -> None:
    from houle.flow.transfer import TRANSFERS

    console.print(_rows("transfer", {name: (t.what, t.source) for name, t in TRANSFERS.items()}))


def kernels(console: Console) -> None:
    console.print(_rows("kernel", KERNELS))


def remeshing(console: Console) -> None:
    from houle.flow.remeshers import REMESHERS

    console.print(_rows("remesh", {name: (r.what, r.source) for name, r in REMESHERS.items()}))


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


def theories(console: Console) -> None:
    """Wave theories and the waves that a case can have, with range and source."""
    from houle.waves.theories import PASSPORTS

    table = _table("wave", "what it is", "where it holds", "source")
    for name, p in PASSPORTS.items():
        table.add_row(name, escape(p.what), escape(p.range), escape(p.source))
    console.print(table)
    words = (
        "Down to solitary-5: values of theory in [waves]; below: kinds other than regular. Equations: docs/waves.md."
    )
    console.print(escape(words), highlight=False)


MAKERS: Rows = {
    "source": (
        "A force inside the water: regular waves and sums of cosines, to one side or both, oblique in 3D. Wants a "
        "sponge behind it.",
        "Wei, Kirby & Sinha (1999); the paper's (4), (5)",
    ),
    "zone": (
        "Relaxation zone at the left wall, one and a half wavelengths: every wave of theory along x, takes up what "
        "comes back.",
        "after Jacobsen, Fuhrman & Fredsoe (2012)",
    ),
    "piston": (
        "A wall that moves: every wave along x; regular ones to second order, long and solitary ones follow the water. "
        "absorb = true takes up what comes back.",
        "Biesel & Suquet (1951); Schaffer (1996); Goring (1979)",
    ),
    "[[absorber]]": (
        "A wall that moves with the waves that reach it: active absorption at an end of the water.",
        "Schaffer & Klopman (2000); pressure on the face, docs/theory.md, section 14",
    ),
    "[[sponge]]": ("A linear resistance that grows towards a side of the tank.", "docs/theory.md, section 14"),
}


def makers(console: Console) -> None:
    console.print(_rows("makers", MAKERS))


TOPICS: dict[str, Callable[[Console], None]] = {
    "resistance": resistance,
    "theories": theories,
    "makers": makers,
    "kernels": kernels,
    "transfers": transfers,
    "remeshing": remeshing,
    "numerics": numerics,
    "fields": fields,
    "schema": schema,
}
