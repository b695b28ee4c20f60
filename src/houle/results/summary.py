"""The summary of a run as tables of words. They hold nothing but the entries of its run.json."""

from __future__ import annotations

import base64
import math
import os
import sys
from html import escape
from pathlib import Path
from typing import Any

from houle.results.answers import table as answers
from houle.results.answers import until
from houle.results.seconds import duration

Rows = list[tuple[str, str]]
FEW = 1.5  # steps: a pressure that lasts no longer is an impulse


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
    """Seconds and share of the wall time: operations of the steps, largest first, then the stages beside the steps."""
    wall = max(1e-9, summary["wall_seconds"])
    steps, beside = summary["operations"], summary["stages"]
    rest = {"loading the program, the rest": max(0.0, wall - sum(steps.values()) - sum(beside.values()))}
    pairs = [pair for group in (steps, beside | rest) for pair in sorted(group.items(), key=lambda p: -p[1])]
    return [(name, f"{duration(value)}  {100 * value / wall:3.0f} %") for name, value in pairs]


def energy(summary: dict[str, Any]) -> Rows:
    """The energy budget since the start [J], per metre of width in 2D.

    For runs with waves the operations of the steps are left out: their potential energy is that of the particles, which
    changes with the packing, and not that of the levels.
    """
    waves = "wave_energy" in summary
    shown = {n: value for n, value in summary["energy"].items() if not (waves and n.startswith("energy_"))}
    return [(name.replace("_", " "), f"{value:+.4g}") for name, value in shown.items()]


def waves(summary: dict[str, Any]) -> tuple[str, Rows]:
    """Title and rows of the energy budget of waves."""
    entry = summary.get("wave_energy") or {}
    over = f" (mean of the last {entry['periods']} periods)" if entry else ""
    return f"Energy of the waves{over}", _wave_energy(entry)


def _wave_energy(entry: dict[str, Any]) -> Rows:
    """Rows of the energy budget of waves, from the entry of run.json; rows of next to nothing are left out."""
    if not entry:
        return []
    unit = entry["unit"]
    words = {
        "source_work": "work of the maker", "open_work": "work at open sides",
        "energy_exchange": "carried through open sides", "sponge_work": "taken by sponges and zone",
        "drag_work": "taken by the porous drag", "viscous_work": "taken by viscosity",
        "friction_work": "taken by the friction of beds and walls", "stored": "stored",
    }  # fmt: skip
    least = 1e-9 * max(abs(entry[n]) for n in words if n in entry)
    lines = [(word, f"{entry[n]:+.4g} {unit}") for n, word in words.items() if abs(entry.get(n, 0.0)) > least]
    lines.append(("lost in numbers", f"{entry['lost']:+.4g} {unit}"))
    if _number(entry["lost_per_wavelength"]):  # none where the water holds less energy than at the start
        lines.append(("  of the energy, per wavelength", f"{100 * entry['lost_per_wavelength']:.2f} %"))
    return lines


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


def pressures(found: list[dict[str, Any]]) -> Rows:
    """A row for each sensor: the largest pressure on it, from the entry of run.json."""
    return [(entry["sensor"], _impact(entry)) for entry in found]


def _impact(entry: dict[str, Any]) -> str:
    if entry["largest"] <= 0.0:
        return "dry"
    brief = ", one step: an impulse" if entry["steps"] <= FEW else ""
    largest, lasting = (_pascal(entry[name]) for name in ("largest", "lasting"))
    duration, window = (f"{1e3 * entry[name]:.3g} ms" for name in ("duration", "window"))
    return (
        f"{largest} at {entry['time']:.4g} s for {duration} ({entry['impulse']:.3g} Pa s{brief}); "
        f"over {window} {lasting}"
    )


def _pascal(value: float) -> str:
    return f"{value:.0f} Pa" if abs(value) < 1e4 else f"{value / 1e3:.1f} kPa"


def reflection(entry: dict[str, Any]) -> Rows:
    """Rows of the reflection analysis, from its entry in run.json: coefficients, heights, window, notes."""
    if not entry:
        return []
    if "problem" in entry:
        return [("none", entry["problem"])]
    known, lines = entry.get("theory") or {}, []
    for name in ("C_R", "C_T", "C_D"):
        value, (low, high) = entry[name], entry[f"interval_{name[-1]}"]
        if _number(value):
            sure = f" ({low:.3f} to {high:.3f}, numerics not included)" if _number(low) else ""
            beside = f"   linear theory {known[name]:.3f}" if _number(known.get(name)) else ""
            lines.append((name, f"{value:.3f}{sure}{beside}"))
    heights = [("incident", "H_I"), ("reflected", "H_R"), ("transmitted", "H_T")]
    shown = ", ".join(f"{word} {1e3 * entry[key]:.4g} mm" for word, key in heights if _number(entry[key]))
    lines.append(("height" if entry["kind"] == "regular" else "H_m0", shown + _asked_for(entry)))
    if _number(entry.get("H_made")):
        lines.append(
            ("H_m0 by theory", f"{1e3 * entry['H_made']:.4g} mm for the sea as made, at the gauges in this window")
        )
    w = entry["window"]
    lines.append(("window", f"{w['start']:.4g} to {w['end']:.4g} s, {w['periods']} periods: {w['reason']}"))
    lines.append((f"interval ({100 * entry['confidence']:g} %)", entry["covers"]))
    if _number(entry["residual"]):
        lines.append(("unexplained", f"{100 * entry['residual']:.2g} % of the amplitude at the gauges"))
    if known:
        lines.append(("linear theory", _theory(known)))
    if entry.get("no_theory"):
        lines.append(("linear theory", f"none: {entry['no_theory']}"))
    return [*lines, *(("note", note) for note in entry["notes"])]


def _theory(known: dict[str, Any]) -> str:
    """Words for what linear theory was taken of."""
    if "friction" in known:
        return f"vertical porous block, Lorentz friction f = {known['friction']:.3g}"
    return f"the section, with drag of equal work; no run-up, no breaking; C_R to {known['error']:.2g}"


def _asked_for(entry: dict[str, Any]) -> str:
    """Words behind the heights: the height asked for, and for regular waves that all are first harmonics."""
    asked, first = (1e3 * (entry.get(key) or math.nan) for key in ("H_asked", "H_asked_1"))
    if entry["method"] == "jh2020" or not _number(asked):
        return ""
    if not _number(first):
        return f" (asked for {asked:.4g} mm)"
    return f": first harmonics, crest to trough; the wave asked for, {asked:.4g} mm high, has one of {first:.4g} mm"


def _number(value: Any) -> bool:
    return value is not None and math.isfinite(value)


def wave_quality(found: dict[str, Any]) -> Rows:
    """Rows of the card of the waves in the flume without its structure, from its entry in run.json."""
    if not found:
        return []
    if "problem" in found:
        return [("none", found["problem"])]
    c = found
    return [
        (
            "height",
            f"first harmonic {1e3 * c['height']:.4g} mm, {100 * (c['height'] / c['target'] - 1):+.2f} % of the target",
        ),
        ("decay", f"{100 * c['decay']:.2f} % per wavelength"),
        (
            "celerity, phase",
            f"{100 * c['celerity']:+.2f} % off theory, {math.degrees(c['phase']):+.2f} degrees a wave",
        ),
        ("spurious C_R", f"{c['reflection']:.4f} (of the sponge that stands in for the structure)"),
        ("mean level", f"drift {1e3 * c['drift']:+.3f} mm, {1e3 * c['set_down']:+.3f} mm from still water"),
        ("steadiness", f"{100 * c['steadiness']:.2f} % between {c['periods']} periods"),
        ("kept in", c["kept"]),
    ]


def sections(summary: dict[str, Any]) -> list[tuple[str, Rows]]:
    """Title and rows of every table that has something to say."""
    label = (summary.get("reference") or {}).get("label", "laboratory")
    everything = [
        ("Run", overview(summary)),
        ("Where the time went", operations(summary)),
        ("Energy [J] (per metre of width in 2D)", energy(summary)),
        waves(summary),
        (f"Surface, rms against {label}", against_laboratory(summary)),
        (
            f"Answers (in brackets: intervals of {100 * answers.CONFIDENCE:g} %, of formulas their own band)",
            answers.lines(summary.get("answers") or {}),
        ),
        ("How sure time.until asks the answers to be", until.lines(summary.get("until", []))),
        ("Largest pressure at the sensors", pressures(summary.get("pressure", []))),
        ("Reflection", reflection(found) if (found := summary.get("reflection")) else []),
        (
            "Wave quality (the same flume without the structure)",
            wave_quality(card) if (card := summary.get("wave_quality")) else [],
        ),
    ]
    return [(title, rows) for title, rows in everything if rows]


def show(summary: dict[str, Any], directory: Path) -> None:
    """Prints the tables of a run on standard output, if it is open, and the pictures and films in its folder."""
    if sys.stdout is None:
        return
    bold, plain = ("\033[1m", "\033[0m") if sys.stdout.isatty() and os.name != "nt" else ("", "")
    for title, rows in sections(summary):
        right = title.startswith(("Where", "Energy", "Surface"))
        first = max(30, *(len(name) for name, _ in rows))
        last = max(len(value) for _, value in rows)
        print(f"{bold}{title}{plain}")
        for name, value in rows:
            print(f"{name:{first}}  {value:{'>' if right else '<'}{last}}".rstrip())
        print()
    for picture in sorted(directory.glob("*.png")):
        print(f"picture  {picture}")
    for film in sorted(directory.glob("*.mp4")):
        print(f"film     {film}")


def as_html(summary: dict[str, Any], directory: Path) -> str:
    """A run in a notebook: its first table, the laboratory, and the picture of the surface."""
    chosen = [(title, rows) for title, rows in sections(summary) if title.startswith(("Run", "Surface", "Reflection"))]
    tables = "".join(_html_table(title, rows) for title, rows in chosen)
    return f"<div><b>{escape(str(directory))}</b>{tables}{_html_picture(directory / 'surface.png')}</div>"


def _html_table(title: str, rows: Rows) -> str:
    body = "".join(f"<tr><td>{escape(name)}</td><td>{escape(value)}</td></tr>" for name, value in rows)
    return f"<table><caption>{escape(title)}</caption>{body}</table>"


def _html_picture(file: Path) -> str:
    if not file.exists():
        return ""
    return f'<img style="max-width: 100%" src="data:image/png;base64,{base64.b64encode(file.read_bytes()).decode()}">'
