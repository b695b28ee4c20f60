"""What a run says when it ends: where the time went, what was conserved, how far it is from the laboratory."""

from __future__ import annotations

import base64
import os
import sys
from dataclasses import asdict
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from houle.data import laboratory
from houle.results import impacts, reflection, wave_energy, wave_quality
from houle.running.progress import duration

if TYPE_CHECKING:
    from houle.running.runner import Run

Rows = list[tuple[str, str]]


def reference(run: Run) -> dict[str, Any] | None:
    """The score against the laboratory points of the case, in plain numbers; None if there are none to compare with."""
    from houle.output import surface_table

    file = run.case.laboratory
    if file is None or run.case.reference is None:
        return None
    score = laboratory.score(laboratory.read(file), surface_table(run.directory))
    given = run.case.reference
    return None if score is None else {"label": given.label, "error": given.error, **asdict(score)}


def overview(summary: dict[str, Any]) -> Rows:
    """The run in a few lines."""
    s, inside = summary, sum(summary["operations"].values())  # s spent inside the steps
    speed = f"{s['steps'] / inside:.3g} steps/s, " if inside > 0 else ""
    per_particle = 1e6 * inside / max(1, s["steps"] * s["particles"])
    return [
        ("simulated time", f"{s['time']:g} s in {s['steps']} steps"),
        ("wall time, CPU time", f"{duration(s['wall_seconds'])}, {duration(s['cpu_seconds'])}"),
        ("particles at the end", f"{s['particles']}"),
        ("speed of the steps", f"{speed}{per_particle:.2f} us per particle and step"),
        ("volume drift", f"{s['volume_drift']:+.1e}"),
    ]


def operations(summary: dict[str, Any]) -> Rows:
    """Seconds and share of the wall time: operations of the steps, largest first, then what is beside the steps."""
    wall = max(1e-9, summary["wall_seconds"])
    steps, beside = summary["operations"], summary["stages"]
    rest = {"loading the program, the rest": max(0.0, wall - sum(steps.values()) - sum(beside.values()))}
    pairs = [pair for group in (steps, beside | rest) for pair in sorted(group.items(), key=lambda p: -p[1])]
    return [(name, f"{duration(value)}  {100 * value / wall:3.0f} %") for name, value in pairs]


def energy(summary: dict[str, Any]) -> Rows:
    """The energy budget since the start [J], per metre of width in 2D.

    With waves without the operations of the steps: they know the potential energy of the particles, which changes with
    their packing, and not that of the levels.
    """
    waves = "wave_energy" in summary
    shown = {n: value for n, value in summary["energy"].items() if not (waves and n.startswith("energy_"))}
    return [(name.replace("_", " "), f"{value:+.4g}") for name, value in shown.items()]


def waves(summary: dict[str, Any]) -> tuple[str, Rows]:
    """Title and rows of the energy budget of waves."""
    entry = summary.get("wave_energy") or {}
    over = f" (mean of the last {entry['periods']} periods)" if entry else ""
    return f"Energy of the waves{over}", wave_energy.rows(entry)


def against_laboratory(summary: dict[str, Any]) -> Rows:
    """rms in millimetres at every laboratory time and over all, beside the measurement error."""
    found = summary.get("reference")
    if not found:
        return []
    rows = [(f"t = {t:g} s", f"{1e3 * r:.1f} mm") for t, r in zip(found["times"], found["rms"], strict=True)]
    rows.append(("all points, t > 0", f"{1e3 * found['overall']:.1f} mm"))
    if found["error"]:
        rows.append(("measurement error", f"{1e3 * found['error']:.1f} mm"))
    return rows


def sections(summary: dict[str, Any]) -> list[tuple[str, Rows]]:
    """Title and rows of every table that has something to say."""
    label = (summary.get("reference") or {}).get("label", "laboratory")
    everything = [
        ("Run", overview(summary)),
        ("Where the time went", operations(summary)),
        ("Energy [J] (per metre of width in 2D)", energy(summary)),
        waves(summary),
        (f"Surface, rms against {label}", against_laboratory(summary)),
        ("Largest pressure at the sensors", impacts.rows(summary.get("pressure", []))),
        ("Reflection", reflection.rows(found) if (found := summary.get("reflection")) else []),
        (
            "Wave quality (the same flume without the structure)",
            wave_quality.rows(card) if (card := summary.get("wave_quality")) else [],
        ),
    ]
    return [(title, rows) for title, rows in everything if rows]


def show(run: Run) -> None:
    """Prints the tables on standard output, if it is open."""
    if sys.stdout is None:
        return
    bold, plain = ("\033[1m", "\033[0m") if sys.stdout.isatty() and os.name != "nt" else ("", "")
    for title, rows in sections(run.summary):
        right = title.startswith(("Where", "Energy", "Surface"))
        first = max(30, *(len(name) for name, _ in rows))
        last = max(len(value) for _, value in rows)
        print(f"{bold}{title}{plain}")
        for name, value in rows:
            print(f"{name:{first}}  {value:{'>' if right else '<'}{last}}".rstrip())
        print()
    for picture in run.pictures:
        print(f"picture  {picture}")
    for film in sorted(run.directory.glob("*.mp4")):
        print(f"film     {film}")


def as_html(run: Run) -> str:
    """For notebooks: the first table, the laboratory, and the picture of the surface."""
    chosen = [
        (title, rows) for title, rows in sections(run.summary) if title.startswith(("Run", "Surface", "Reflection"))
    ]
    tables = "".join(_html_table(title, rows) for title, rows in chosen)
    return f"<div><b>{escape(str(run.directory))}</b>{tables}{_html_picture(run.directory / 'surface.png')}</div>"


def _html_table(title: str, rows: Rows) -> str:
    body = "".join(f"<tr><td>{escape(name)}</td><td>{escape(value)}</td></tr>" for name, value in rows)
    return f"<table><caption>{escape(title)}</caption>{body}</table>"


def _html_picture(file: Path) -> str:
    if not file.exists():
        return ""
    return f'<img style="max-width: 100%" src="data:image/png;base64,{base64.b64encode(file.read_bytes()).decode()}">'
