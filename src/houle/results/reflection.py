"""Reflection, transmission and dissipation of the structure of a run: [reflection], measured at its end.

`houle.analysis.reflection` separates the waves at the gauges; beside it stands linear theory, its drag made linear by
equal work (Lorentz): in closed form for a vertical porous block over the full depth, else on a grid (linear_theory.py).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from houle.analysis.coefficients import reflection
from houle.analysis.errors import AnalysisError
from houle.analysis.theory import porous_block, porous_block_lorentz
from houle.case.porous import coefficients
from houle.case.shapes import shape_of
from houle.medium.resistance import inertia_coefficient
from houle.results import linear_theory

if TYPE_CHECKING:
    from pathlib import Path

    from houle.analysis.result import Reflection
    from houle.analysis.theory import Scatter
    from houle.case.model import Case
    from houle.case.tables.tank import Porous
    from houle.results.run import Run
    from houle.waves.wave import Wave

PICTURE = "reflection.png"
CONFIDENCE = 0.90  # share that the intervals hold, as all answers of a run
NEAR = 1e-6  # two places nearer to each other than this are the same [m]


@dataclass(frozen=True)
class ReflectionFlume:
    """Places along the flume as [reflection] names them [m]; the waves go from `maker` to `front`.

    front  face of the structure towards the maker
    back   place from which the wave that entered the structure comes back last: its back, or the wall behind it
    wall   side of the tank behind the structure
    absorbed  true if a sponge or an absorbing wall takes the transmitted wave
    quiet     true if nothing at the maker sends the reflected wave back
    """

    maker: float
    front: float
    back: float
    wall: float
    absorbed: bool
    quiet: bool

    @property
    def towards(self) -> float:
        return 1.0 if self.front > self.maker else -1.0

    @classmethod
    def of(cls, case: Case) -> ReflectionFlume:
        assert case.reflection is not None and case.waves is not None
        waves, structure, end = case.waves, case.reflection.structure, case.domain.size[0]
        ends = waves.zone.x if waves.zone is not None else (waves.place,)
        maker = min(ends, key=lambda x: abs(structure[0] - x))
        towards = 1.0 if structure[0] > maker else -1.0
        wall = end if towards > 0 else 0.0
        spans = [(s.box[0][0], s.box[1][0]) for s in case.sponge]
        spans += [(a.x, a.x) for a in case.absorber]
        behind = any(towards * (max(span, key=lambda x: towards * x) - structure[-1]) > 0 for span in spans)
        before = any(towards * (maker - min(span, key=lambda x: towards * x)) > 0 for span in spans)
        before = before or (waves.piston is not None and waves.piston.absorb)
        open_back = len(structure) == 2 and (behind or bool(case.reflection.behind))
        back = structure[1] if open_back else wall
        return cls(maker, structure[0], back, wall, behind, waves.zone is not None or before)


def measure(run: Run, confidence: float = 0.95) -> Reflection:
    """C_R, C_T, C_D of the run with their intervals of this confidence and window. Raises AnalysisError."""
    case = run.case
    asked, waves = case.reflection, case.waves
    assert asked is not None and waves is not None
    wave = wave_of(case)
    given = {"window": asked.window, "towards": ReflectionFlume.of(case).towards}
    place = limits(case, wave) if asked.window is None else given
    regular = waves.kind == "regular"
    levels = run.series.eta.sel(gauge=asked.gauges[0])
    return reflection(
        run,
        depth=waves.depth,
        period=wave.period,
        kind="regular" if regular else "irregular",
        method=asked.method,
        gauges=asked.gauges,
        behind=asked.behind,
        wave_number=wave.k if regular and asked.method != "jh2020" else None,
        bed=float(levels[0]) - waves.depth,
        gravity=case.fluid.gravity,
        confidence=confidence,
        **place,
    )


def limits(case: Case, wave: Wave) -> dict[str, Any]:
    """Bounds for `choose_window`, which finds when gauges hold the incident wave and its reflection alone."""
    asked, waves, flume = case.reflection, case.waves, ReflectionFlume.of(case)
    assert asked is not None and waves is not None
    reflector = None if flume.quiet or waves.zone is not None else case.domain.size[0] - flume.wall
    reflector = flume.maker if reflector is not None and waves.piston is not None else reflector
    return {
        "maker": flume.maker, "structure": flume.front, "rear": flume.back, "absorbing": flume.quiet,
        "reflector": reflector, "far_end": flume.wall if asked.behind and not flume.absorbed else None,
        "ramp": waves.ramp_time() / wave.period,
    }  # fmt: skip


def theory(case: Case, height: float) -> Scatter | None:
    """Linear theory of a block for incident waves of this height [m]; None if the structure is none (`no_block`)."""
    asked = case.reflection
    if asked is None or not asked.theory or no_block(case) is not None:
        return None
    flume, body = ReflectionFlume.of(case), case.porous[0]
    low, high = shape_of(body, case.dimension).bounds
    wall = abs((high if flume.towards > 0 else low)[0] - flume.wall) < NEAR
    return block_theory(case, body, wave_of(case).omega, height, wall)


def block_theory(case: Case, body: Porous, omega: float, height: float, wall: bool) -> Scatter:
    """Linear theory of the block `body` in this flume, for waves of this frequency [rad/s] and height [m]."""
    assert case.waves is not None
    low, high = shape_of(body, case.dimension).bounds
    a, b = coefficients(body.resistance, body.porosity, body.grain_diameter, case.fluid.viscosity, case.drag_period)
    n, depth, width = body.porosity, case.waves.depth, float(high[0] - low[0])
    inertia = inertia_coefficient(n, body.added_mass)
    more: dict[str, Any] = {"inertia": inertia, "wall": wall, "gravity": case.fluid.gravity}
    if b == 0.0:
        return porous_block(omega, depth, width, n, n * a / omega, **more)
    return porous_block_lorentz(omega, depth, width, n, height, a, b, **more)


def as_made(case: Case, found: Reflection) -> float:
    """H_m0 [m] of the sea by theory at the gauges in the window, analysed in the same way; NaN for other waves.

    A random sea has the height asked for in the long run only, not within some tens of waves, and the band of the
    analysis leaves out the shortest waves. For irregular waves in 2D.
    """
    waves = case.waves
    if waves is None or found.kind != "irregular" or case.dimension == 3:
        return float("nan")
    wave, record = wave_of(case), found.record
    x, time = found.towards * record.x, record.time
    eta = [wave.elevation(place, time) for place in x]
    window = (found.window.start, found.window.end)
    sea = reflection(
        (time, x, eta), depth=found.depth, period=found.period, kind="irregular", method=found.method, window=window,
        towards=found.towards, gravity=case.fluid.gravity,
    )  # fmt: skip
    return sea.H_I


def no_block(case: Case) -> str | None:
    """Reason, in words, why the structure is no block with a theory in closed form; None if it is one.

    That holds for regular waves and one porous rectangle, from the bottom through the surface, at the place named in
    [reflection]. Nothing else may stand in the way, and behind it there is a wall, or an absorber of what it transmits.
    """
    assert case.reflection is not None and case.waves is not None
    if case.waves.kind != "regular":
        return f'waves.kind = "{case.waves.kind}", it is for regular waves'
    if len(case.porous) != 1:
        return f"{len(case.porous)} porous bodies, it is for one"
    if case.solid:
        return f"solid.{case.solid[0].name} stands in the flume, it is for a porous block alone"
    body, flume, depth = case.porous[0], ReflectionFlume.of(case), case.waves.depth
    shape = shape_of(body, case.dimension)
    (x0, z0), (x1, z1) = ((float(corner[0]), float(corner[-1])) for corner in shape.bounds)
    area = shape.section((x0, z0, x1, z1)).area if body.below is None else math.nan
    if not abs(area - (x1 - x0) * (z1 - z0)) <= 1e-9 * (x1 - x0) * (z1 - z0):
        return f"porous.{body.name} is no upright rectangle"
    level = max((w.below or 0.0 for w in case.water), default=0.0)
    if abs(level - depth) >= NEAR:
        return f"the water is not below = {depth:g} m everywhere"
    if z0 > NEAR or z1 <= level:
        return (
            f"porous.{body.name} goes from z = {z0:g} to {z1:g} m, not from the bed through the surface at {level:g} m"
        )
    front, back = (x0, x1) if flume.towards > 0 else (x1, x0)
    if abs(front - flume.front) >= NEAR:
        return f"its face is at x = {front:g} m, reflection.structure begins at {flume.front:g} m"
    if not flume.absorbed and abs(back - flume.wall) >= NEAR:
        return f"from its back, x = {back:g} m, to the wall at {flume.wall:g} m nothing absorbs the waves that pass"
    return None


def wave_of(case: Case) -> Wave:
    """The wave of a case that has one."""
    wave = case.wave
    assert wave is not None
    return wave


def first_harmonic(wave: Wave) -> float:
    """Height [m], crest to trough, of the first harmonic of a regular wave: the analysis of gauges measures that."""
    parts = wave.components()
    return wave.height if parts is None else 2.0 * float(parts.amplitude[0])


def record(run: Run) -> dict[str, Any]:
    """Measures, draws reflection.png, and returns the entry "reflection" of run.json: numbers, or the problem met.

    It is {} if the case does not ask for it.
    """
    if run.case.reflection is None:
        return {}
    try:
        found = measure(run, CONFIDENCE)
    except AnalysisError as error:
        return _problem(error)
    draw(found, run.directory / PICTURE)
    entry = measured(found) | asked_for(run.case)
    if found.kind == "irregular":
        entry["H_made"] = as_made(run.case, found)
    if run.case.reflection.theory and found.method != "jh2020":
        entry |= beside(run.case, found.H_I)
    return {"reflection": entry}


def beside(case: Case, height: float) -> dict[str, Any]:
    """The entries that tell linear theory for incident waves of this height [m], or why there is none."""
    if (known := theory(case, height)) is not None:
        return {"theory": {name: getattr(known, name) for name in ("C_R", "C_T", "C_D", "friction")}}
    flume = ReflectionFlume.of(case)
    try:
        solved = linear_theory.solve(case, height, flume.towards, flume.front, None if flume.absorbed else flume.wall)
    except AnalysisError as error:
        return {"no_theory": str(error)}
    return {"theory": {name: getattr(solved, name) for name in ("C_R", "C_T", "C_D", "error")}}


def look(run: Run) -> dict[str, Any]:
    """The entry "reflection" of a run that goes on: what the gauges say up to now, nothing drawn or compared."""
    if run.case.reflection is None:
        return {}
    try:
        return {"reflection": measured(measure(run, CONFIDENCE))}
    except AnalysisError as error:
        return _problem(error)


def _problem(error: AnalysisError) -> dict[str, Any]:
    return {"reflection": {"problem": str(error)}}


def measured(found: Reflection) -> dict[str, Any]:
    """Numbers and words of an analysis for the entry of run.json."""
    names = ("method", "kind", "period", "depth", "wave_number", "C_R", "C_T", "C_D")
    more = ("interval_R", "interval_T", "interval_D", "H_I", "H_R", "H_T", "confidence", "covers", "residual", "notes")
    entry = {name: getattr(found, name) for name in (*names, *more)}
    window = {"start": found.window.start, "end": found.window.end, "periods": found.window.periods}
    return entry | {"window": {**window, "reason": found.window.reason}}


def asked_for(case: Case) -> dict[str, float]:
    """Height [m] of the waves asked for, H or H_s; for regular ones also that of their first harmonic, as in H_I."""
    wave = wave_of(case)
    if case.waves is not None and case.waves.kind == "regular":
        return {"H_asked": float(wave.height), "H_asked_1": first_harmonic(wave)}
    return {"H_asked": float(wave.height)}


def draw(found: Reflection, path: Path) -> None:
    """Draws the picture of the analysis."""
    found.plot(path)
