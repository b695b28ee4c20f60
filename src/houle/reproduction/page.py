"""The page of a reproduction: the words of page.md, with tables, figures and numbers in their places."""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from string import Template

import numpy as np

from houle.output.atomic import write_text
from houle.reproduction import figures
from houle.reproduction.measured import INSTANTS, Done, Found, Pair, Printed, WaveRun
from houle.reproduction.pack import pack
from houle.results.reflection import block_theory, first_harmonic, wave_of
from houle.results.run import Run
from houle.results.seconds import duration

FIGURES = "figures"
PERIODS = (0.8, 1.0, 1.2, 1.5, 2.0)  # periods in the table of theory [s]
GRAINS = (0.003, 0.0159, 0.05)  # grain diameters in it [m]
MAIN = 5  # length of the flume of the figures [m]
ABSENT = "*Not computed: the runs for it are missing.*"
NONE = "–"


def write(file: Path, folder: Path, found: Found, done: Done, quick: bool) -> Path:
    """Writes the page of the paper in `folder`, and the figures beside it. Raises OutputError."""
    import houle

    (file.parent / FIGURES).mkdir(parents=True, exist_ok=True)
    words = Template((folder / "page.md").read_text(encoding="utf-8"))
    command = shlex.join(["houle", "reproduce", folder.name, *(["--quick"] if quick else [])])
    places = {"command": command, "version": _version(houle.__version__), "state": _state(done, quick)}
    curves = _curves(found)
    places |= _figures(file, folder.name, found, curves) | _tables(found, curves) | _words(found)
    places["table_runs"] = _runs(done)
    places["seconds"] = duration(sum(run.summary["cpu_seconds"] for run in done.runs.values()))
    write_text(file, words.substitute(places))
    return file


def _version(number: str) -> str:
    """The version in words; "" if houle is not installed, but run from a checkout."""
    return f" (houle {number})" if number[0].isdigit() else ""


def _state(done: Done, quick: bool) -> str:
    words = ["These are the coarse runs of `--quick`."] if quick else []
    words += [f"Failed: {name}: {why}." for name, why in done.failed.items()]
    return "".join(f" {word}" for word in words)


def _figures(file: Path, paper: str, found: Found, curves: dict[float, list[tuple[float, float]]]) -> dict[str, str]:
    """Draws the figures for which there are runs; returns by place on the page the line that shows one."""

    def show(name: str, words: str, draw: Callable[[Path], Path]) -> str:
        path = file.parent / FIGURES / f"{paper}-{name}.png"
        pack(draw(path))
        return f"![{words}]({FIGURES}/{path.name})"

    pairs = {pair.name: pair for pair in found.pairs}
    placed = dict.fromkeys(("figure_beads", "figure_rock", "figure_profiles", "figure_offsets"), ABSENT)
    for name, pair in pairs.items():
        title = pair.ours.case.case.title or name

        def fields(path: Path, pair: Pair = pair, title: str = title) -> Path:
            return figures.pressures(path, pair, title)

        def surface(path: Path, pair: Pair = pair, title: str = title) -> Path:
            return figures.profiles(path, pair, title)

        placed[f"figure_{name}"] = show(name, f"Pressure at {len(INSTANTS)} instants, both schemes: {title}", fields)
        if pair.scores():
            placed["figure_profiles"] = show(f"{name}-surface", f"Surface of both schemes: {title}", surface)
    if pairs:
        placed["figure_offsets"] = show(
            "offset",
            "Water and mean level gained by the paper's scheme",
            lambda path: figures.offsets(path, found.pairs),
        )
    rows = [(p, w) for p in found.table if (w := found.row(p, MAIN)) is not None]
    fastest = {p.height: max(figures.speed(w) for q, w in rows if q.height == p.height) for p, _ in rows}
    shown = []
    for p, w in rows:

        def field(path: Path, p: Printed = p, w: WaveRun = w) -> Path:
            return figures.velocities(path, w, p, fastest[p.height])

        words = f"Horizontal velocity at three instants, face at {p.slope} degrees, H_0 = {p.height:g} m"
        shown.append(show(f"wave-{p.slope}-{1e3 * p.height:.0f}mm", words, field))
    placed["figures_waves"] = "\n\n".join(shown) or ABSENT
    placed["figure_coefficients"] = ABSENT
    if rows:
        placed["figure_coefficients"] = show(
            "coefficients",
            "C_R by formula, by separation and by theory",
            lambda path: figures.coefficients(path, found, MAIN, curves),
        )
    return placed


def _tables(found: Found, curves: dict[float, list[tuple[float, float]]]) -> dict[str, str]:
    return {
        "table_dam": _dam(found.pairs),
        "table_score": _scores(found.pairs),
        "table_one": _one(found),
        "table_printed": _printed(found),
        "table_instants": _instants(found),
        "table_changed": _changed(found),
        "table_theory": _theory(curves),
        "scheme": _scheme(found),
    }


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown, the first column left, the others right; ABSENT without rows."""
    body = list(rows)
    if not body:
        return ABSENT
    rule = ("---", *["---:"] * (len(head) - 1))
    return "\n".join(f"| {' | '.join(row)} |" for row in (head, rule, *body))


def _dam(pairs: Sequence[Pair]) -> str:
    head = (
        "dam break",
        "t [s]",
        "water: houle",
        "water: jh2020",
        "mean level of jh2020 above houle",
        "rms between them",
    )
    rows = []
    for pair in pairs:
        for t in INSTANTS:
            ours, papers = pair.gain(pair.ours, t), pair.gain(pair.papers, t)
            rows.append((pair.name, f"{t:g}", _change(ours), _change(papers),
                         f"{1e3 * pair.offset(t):+.1f} mm", f"{1e3 * pair.distance(t):.1f} mm"))  # fmt: skip
    return _table(head, rows)


def _scores(pairs: Sequence[Pair]) -> str:
    rows = []
    for pair in pairs:
        scores = [s for s in pair.scores() if s[0] > 0]
        rows += [(f"{pair.name}, t = {t:g} s", f"{1e3 * a:.1f} mm", f"{1e3 * b:.1f} mm") for t, a, b in scores]
        if scores:
            one, other = pair.overall()
            rows.append((f"{pair.name}, all points", f"{1e3 * one:.1f} mm", f"{1e3 * other:.1f} mm"))
    return _table(("rms against the laboratory", "houle", "jh2020"), rows)


def _one(found: Found) -> str:
    head = ("face, H_0", "flume", "A", "B", "printed", "formula", "heights", "separated", "H_I", "theory")
    rows = []
    for flume in sorted({w.job.flume for w in found.of_part("table")}):
        for p in found.table:
            if (w := found.row(p, flume)) is None:
                continue
            rows.append(
                (f"{p.slope}°, {p.height:g} m", f"{flume} m", f"{w.highest:.3f}", f"{w.lowest:.3f}", f"{p.C_R:.3f}",
                 f"{w.formula.C_R:.3f}", f"{w.envelope:.3f}", _sure(w), _height_of(w), _number(w.theory))
            )  # fmt: skip
    return _table(head, rows)


def _printed(found: Found) -> str:
    depths = [w.run.case.waves.depth for w in found.waves if w.run.case.waves is not None]
    if not depths:
        return ABSENT
    d = depths[0]
    head = ("face, H_0", "A", "B", "C_R printed", "(A - B)/(A + B)", "(A - B)/2d", "(A - B)/H_0", "from still water")
    return _table(
        head,
        [
            (f"{p.slope}°, {p.height:g} m", f"{p.A:.3f}", f"{p.B:.3f}", f"{p.C_R:.3f}",
             f"{(p.A - p.B) / (p.A + p.B):.3f}", f"{(p.A - p.B) / (2 * d):.3f}", f"{(p.A - p.B) / p.height:.2f}",
             f"{(p.A - p.B) / (p.A + p.B - 2 * d):.2f}")
            for p in found.table
        ],
    )  # fmt: skip


def _instants(found: Found) -> str:
    head = ("face, H_0", "t [s]", "A printed", "A", "B printed", "B", "C printed", "C", "C_R printed", "formula")
    rows = []
    for p in found.table:
        if (w := found.row(p, MAIN)) is not None:
            r = w.read(p.instants[1])
            (_, a), (_, b), (_, c) = r.A, r.B, r.C
            rows.append((f"{p.slope}°, {p.height:g} m", f"{p.instants[1]:g}", f"{p.A:.3f}", f"{a:.3f}", f"{p.B:.3f}",
                         f"{b:.3f}", f"{p.C:.3f}", f"{c:.3f}", f"{p.C_R:.3f}", f"{(a - b) / (a + b):.3f}"))  # fmt: skip
    return _table(head, rows)


def _changed(found: Found) -> str:
    head = ("face, H_0", "changed", "formula", "separated", "H_I", "theory")
    rows = []
    for p in found.table:
        first = found.row(p, MAIN)
        others = [w for w in found.of_part("sensitivity", p.slope, p.height) if w.entry]
        for w in ([first] if first else []) + others:
            rows.append((f"{p.slope}°, {p.height:g} m", w.job.changed or "as in table 1", f"{w.formula.C_R:.3f}",
                         _sure(w), _height_of(w), _number(w.theory)))  # fmt: skip
    return _table(head, rows)


def _curves(found: Found) -> dict[float, list[tuple[float, float]]]:
    """Periods [s] and C_R of theory by grains [m], for the upright block and the lowest waves of the table."""
    upright = [w for w in found.waves if w.run.case.porous[0].box is not None]
    if not upright:
        return {}
    height = min(p.height for p in found.table)
    return {d: [(t, _lorentz(upright[0].run, t, d, height)) for t in PERIODS] for d in GRAINS}


def _lorentz(run: Run, period: float, diameter: float, height: float) -> float:
    """C_R of linear theory for the upright block of a run with another period [s], grains and height [m]."""
    body = run.case.porous[0].model_copy(update={"grain_diameter": diameter})
    return block_theory(run.case, body, 2 * np.pi / period, height, wall=True).C_R


def _theory(curves: dict[float, list[tuple[float, float]]]) -> str:
    head = ("C_R", *(f"T = {t:g} s" for t in PERIODS))
    return _table(head, [(f"d50 = {1e3 * d:g} mm", *(f"{c:.3f}" for _, c in line)) for d, line in curves.items()])


def _scheme(found: Found) -> str:
    """Table of the paper's scheme and ours under waves: volume, level, height at a gauge in the last period."""
    lines = []
    for w in found.of_part("scheme"):
        ours = next((o for o in found.of_part("sensitivity", w.job.slope, w.job.height) if _same_grid(o, w)), None)
        ours = ours or next((o for o in found.of_part("table", w.job.slope, w.job.height) if _same_grid(o, w)), None)
        if ours is None:
            continue
        assert w.run.case.waves is not None and w.run.case.waves.period is not None
        end, period = float(w.run.series.time.values[-1]), w.run.case.waves.period
        drift = float(w.run.series.volume_drift.values[-1])
        eta = [run.surface.eta.sel(time=end, method="nearest").values for run in (w.run, ours.run)]
        heights = [_height(run, end, period) for run in (w.run, ours.run)]
        lines.append(
            f'The row {w.job.slope}°, {w.job.height:g} m with `scheme = "jh2020"`, spacing '
            f"{1e3 * w.run.case.domain.spacing:g} mm, to {end:g} s, against our scheme on the same grid: water "
            f"{100 * drift:+.2f} %, mean level {1e3 * float(np.nanmean(eta[0] - eta[1])):+.2f} mm, wave height at the "
            f"first gauge in the last period {1e3 * heights[0]:.1f} mm (ours {1e3 * heights[1]:.1f} mm), processor "
            f"time {duration(w.run.summary['cpu_seconds'])} (ours, for {ours.run.summary['time']:g} s, "
            f"{duration(ours.run.summary['cpu_seconds'])})."
        )
    return "\n\n".join(lines) or ABSENT


def _same_grid(one: WaveRun, other: WaveRun) -> bool:
    same = one.run.case.domain == other.run.case.domain and one.run.case.waves == other.run.case.waves
    return same and one.run.case.porous == other.run.case.porous


def _height(run: Run, end: float, period: float) -> float:
    """Highest less lowest level [m] at the first gauge in the period before `end` [s]."""
    eta = run.series.eta.isel(gauge=0).sel(time=slice(end - period, end)).values
    return float(np.ptp(eta))


def _runs(done: Done) -> str:
    head = ("run", "spacing", "to", "particles", "steps", "processor time")
    rows = []
    for name, run in done.runs.items():
        s = run.summary
        rows.append((name, f"{1e3 * run.case.domain.spacing:g} mm", f"{s['time']:g} s", f"{s['particles']}",
                     f"{s['steps']}", duration(s["cpu_seconds"])))  # fmt: skip
    return _table(head, rows)


def _words(found: Found) -> dict[str, str]:
    """The numbers that stand in the sentences of the page, by name."""
    first = found.table[0]
    low = min(p.height for p in found.table)
    c40 = {p.slope: p.C_R for p in found.table if p.height == low}
    words = {"fall40": f"{100 * (c40[45] / c40[90] - 1):.0f}", "height40": f"{1e3 * low:.0f} mm"}
    words |= {"defect": _defect(found.pairs), "trend": _trend(found), "spread": _spread(found)}
    words |= dict.fromkeys(("period", "grains", "spacing", "periods", "fastest", "seventy", "odd"), NONE)
    rows = [w for p in found.table if (w := found.row(p, MAIN)) is not None]
    if rows:
        case = rows[0].run.case
        body = case.porous[0]
        assert case.waves is not None and case.waves.period is not None and body.grain_diameter is not None
        a, b = body.resistance.a, body.resistance.b
        law = f"{body.resistance.law}" if body.resistance.law else f"a = {a}, b = {b}"
        kd = rows[0].entry["wave_number"] * case.waves.depth
        words |= {
            "period": f"T = {case.waves.period:g} s, kd = {kd:.2f}",
            "grains": f"d50 = {1e3 * body.grain_diameter:g} mm, law {law}",
            "spacing": " and ".join(f"{1e3 * s:.3g} mm" for s in sorted({w.run.case.domain.spacing for w in rows})),
            "periods": f"{rows[0].entry['window']['periods']}",
            "fastest": f"{math.sqrt(case.fluid.gravity * case.waves.depth):.2f}",
            "odd": _odd(found.table, case.waves.depth),
            "seventy": f"{abs(first.C - case.waves.depth) / first.height:.2f}",
        }
    return words


def _spread(found: Found) -> str:
    """Ranges of the two columns of the upright block with the lowest waves."""
    low = min(p.height for p in found.table)
    runs = [w for part in ("table", "sensitivity") for w in found.of_part(part, 90, low) if w.entry]
    if not runs:
        return "Not computed."
    by_formula, separated = [w.formula.C_R for w in runs], [w.C_R for w in runs]
    return (
        f"Over the {len(runs)} runs with the upright face and {1e3 * low:.0f} mm waves the formula goes from "
        f"{min(by_formula):.3f} to {max(by_formula):.3f}, the separated C_R from {min(separated):.3f} to "
        f"{max(separated):.3f}."
    )


def _odd(table: Sequence[Printed], depth: float) -> str:
    """Rows of the paper whose crest lies below still water, or whose trough lies above it."""
    low = [f"{p.slope}°, {p.height:g} m" for p in table if depth > p.A]
    high = [f"{p.slope}°, {p.height:g} m" for p in table if depth < p.B]
    words = [f"The crest A lies below still water ({depth:g} m) in: {'; '.join(low)}."] if low else []
    return " ".join([*words, *([f"The trough B lies above it in: {'; '.join(high)}."] if high else [])])


def _defect(pairs: Sequence[Pair]) -> str:
    t = INSTANTS[-1]
    parts = [
        f"{pair.name} {_change(pair.gain(pair.papers, t))} of water and {1e3 * pair.offset(t):+.1f} mm of mean "
        f"level at {t:g} s (ours {_change(pair.gain(pair.ours, t))})"
        for pair in pairs
    ]
    return "; ".join(parts) or "not computed"


def _trend(found: Found) -> str:
    """C_R upright less C_R at 45 degrees, with the intervals of both."""
    parts = []
    for height in sorted({p.height for p in found.table}):
        by = {p.slope: found.row(p, MAIN) for p in found.table if p.height == height}
        one, other = by.get(90), by.get(45)
        if one is None or other is None:
            continue
        sure = math.hypot(*(0.5 * (w.interval[1] - w.interval[0]) for w in (one, other)))
        parts.append(f"{height:g} m: separated C_R falls by {one.C_R - other.C_R:.3f} ± {sure:.3f}")
    return "; ".join(parts) or "not computed"


def _height_of(w: WaveRun) -> str:
    wanted = first_harmonic(wave_of(w.run.case))
    return f"{1e3 * w.H_I:.1f} of {1e3 * wanted:.1f} mm"


def _change(value: float) -> str:
    """A relative change of the volume in per cent, round-off as 0."""
    return f"{0.0 if abs(value) < 1e-13 else 100 * value:+.1f} %"


def _sure(w: WaveRun) -> str:
    low, high = w.interval
    return f"{w.C_R:.3f} ({low:.3f}–{high:.3f})"


def _number(value: float) -> str:
    return f"{value:.3f}" if math.isfinite(value) else NONE
