"""Wave quality card: the quality of the waves of a case in the flume without its structure.

That flume (the twin of the case) is computed by itself, with a sponge in place of the structure and gauges of its own.
This is done once for all cases with the same flume and waves; the card is kept in the user's cache folder.
"""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from houle import analysis
from houle.case.model import Case, load
from houle.errors import HouleError
from houle.output.atomic import write_text
from houle.results.reflection import ReflectionFlume, first_harmonic, wave_of

if TYPE_CHECKING:
    from houle.case.tables.tank import Solid
    from houle.flow.simulation import Simulation
    from houle.waves.wave import Wave

GAUGES = 16
SPONGE = 1.5  # length of the sponge [wavelengths]
STRETCH = 1.2  # least length of the row of gauges [wavelengths]
SETTLE, PERIODS = 1.0, 5  # periods to wait after the sponge has answered, and periods that are measured
SAMPLES = 50  # samples in a period


class Says(Protocol):
    """A reporter of the progress of a computation, such as those of `houle.running.progress`."""

    def say(self, text: str) -> None: ...

    def start(self, simulation: Simulation, end: float) -> None: ...

    def step(self, simulation: Simulation) -> None: ...

    def stop(self) -> None: ...


def card(case: Case, says: Says) -> dict[str, Any]:
    """The card in plain numbers, with the file that keeps it; {} if not asked for, {"problem": ...} if it fails.

    A failure of the card does not touch the run that it belongs to.
    """
    asked = case.reflection
    if asked is None or not asked.twin:
        return {}
    try:
        empty = empty_flume(case)
        kept = folder() / f"{empty.hash}-{_version()}.json"
        if kept.is_file():
            return {**json.loads(kept.read_text(encoding="utf-8")), "kept": str(kept)}
        says.say(
            f"houle: wave quality: the same flume without the structure, {empty.domain.size[0]:g} m, to t = "
            f"{empty.time.end:g} s (once; the card is kept in {kept.parent})"
        )
        found = asdict(measure(empty, says))
        write_text(kept, json.dumps(found, indent=2) + "\n")
        return {**found, "kept": str(kept)}
    except (HouleError, analysis.AnalysisError, OSError) as error:
        return {"problem": str(error)}
    except KeyboardInterrupt:
        return {"problem": "interrupted; the run itself is complete"}


def folder() -> Path:
    """Folder of the cards: houle/twins in the user's cache folder (XDG_CACHE_HOME, or .cache in the home folder)."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "houle" / "twins"


def empty_flume(case: Case) -> Case:
    """The flume without porous bodies, without solids at or behind the structure's face, and with a sponge there.

    Solids that begin before the face are the bed. Raises CaseError or AnalysisError if this cannot be done.
    """
    assert case.waves is not None and case.reflection is not None
    if case.waves.kind != "regular":
        raise analysis.AnalysisError("the card of wave quality is for regular waves")
    flume, wave = ReflectionFlume.of(case), wave_of(case)
    if flume.towards < 0 or case.dimension == 3:
        raise analysis.AnalysisError("the empty flume is computed for 2D cases with waves towards +x")
    first = min(gauge.x for gauge in case.gauge if gauge.name in case.reflection.gauges)
    sponge = max(flume.front, first + STRETCH * wave.length)
    end = sponge + SPONGE * wave.length
    data = case.to_dict()
    bed = [s.model_dump(mode="json", exclude_none=True) for s in case.solid if _begins(s) < flume.front - 1e-9]
    kept = [s.model_dump(mode="json", exclude_none=True) for s in case.sponge if s.box[1][0] <= flume.maker]
    spacing, top = case.domain.grid.spacing[0], case.domain.size[-1]
    length = spacing * np.ceil(end / spacing - 1e-9)
    data |= {
        "case": {"name": "twin", "title": "the flume without structure"},
        "domain": {**data["domain"], "size": [round(float(length), 9), top]},
        "absorber": [a.model_dump(mode="json", exclude_none=True) for a in case.absorber if a.side == "left"],
        "porous": [], "gate": [], "solid": bed,
        "sponge": [*kept, {"name": "behind", "box": [[round(sponge, 9), 0.0], [round(float(length), 9), top]]}],
        "gauge": [{"x": round(float(x), 9)} for x in np.linspace(first, sponge, GAUGES)],
        "time": {**data["time"], "end": round(_start(wave, flume, first, sponge) + (PERIODS + 0.1) * wave.period, 6)},
    }  # fmt: skip
    for key in ("reflection", "reference", "output", *case.observed().keys() - {"gauge"}):
        data.pop(key, None)
    empty = load(data)
    empty._path = case.path
    return empty


def _begins(solid: Solid) -> float:
    from houle.case.shapes import shape_of

    return float(shape_of(solid, 2).bounds[0][0])


def _start(wave: Wave, flume: ReflectionFlume, first: float, sponge: float) -> float:
    """Time [s] from which the waves that the sponge sends back, half-way into it, are steady at the first gauge."""
    turn = sponge + 0.5 * SPONGE * wave.length
    return (2 * turn - first - flume.maker) / wave.group_velocity + (2.0 + SETTLE) * wave.period


def measure(empty: Case, says: Says) -> analysis.QualityCard:
    """Computes the empty flume and returns its card."""
    from houle.case.build import build
    from houle.flow.simulation import Simulation

    assert empty.waves is not None and empty.waves.height is not None
    simulation, wave = Simulation(build(empty)), wave_of(empty)
    places: list[tuple[float, ...]] = [(gauge.x,) for gauge in empty.gauge]
    rows, end = [(0.0, simulation.sample()["eta"])], empty.time.end
    says.start(simulation, end)
    try:
        while simulation.time < end:
            simulation.advance(end)
            rows.append((simulation.time, simulation.sample()["eta"]))
            says.step(simulation)
    finally:
        says.stop()
    then, levels = np.array([row[0] for row in rows]), np.array([row[1] for row in rows]).T
    time = np.arange(0.0, end, wave.period / SAMPLES)
    eta = np.array([np.interp(time, then, level) for level in levels])
    return analysis.quality_card(
        (time, np.array([place[0] for place in places]), eta),
        depth=empty.waves.depth,
        period=wave.period,
        height=first_harmonic(wave),
        window=(end - PERIODS * wave.period - wave.period / SAMPLES, end),
        still_water=float(levels[:, 0].mean()),
        reference=wave.k,
        gravity=empty.fluid.gravity,
    )


def _version() -> str:
    import houle

    return houle.__version__
